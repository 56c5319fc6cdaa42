#include "log/state_pack.h"

#include <algorithm>
#include <bit>
#include <string>
#include <zstd.h>

namespace lockwind {

namespace {

/// Window that a file may ask for, as a power of two: two states of kStateBytesMax.
constexpr int kWindowLogMax = 27;
static_assert((std::size_t{1} << kWindowLogMax) >= 2 * kStateBytesMax);

/// A block of at most 128 KiB takes at least 4 bytes, so no frame expands more than this.
constexpr std::uint64_t kExpansionMax = 32768;

struct FreeCompressor {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};
struct FreeDecompressor {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};
using Compressor = std::unique_ptr<ZSTD_CCtx, FreeCompressor>;
using Decompressor = std::unique_ptr<ZSTD_DCtx, FreeDecompressor>;

void set(const Compressor& context, ZSTD_cParameter parameter, int value) {
    LOCKWIND_ASSERT(ZSTD_isError(ZSTD_CCtx_setParameter(context.get(), parameter, value)) == 0);
}

int window_log_of(std::size_t size_bytes) {
    return std::clamp(static_cast<int>(std::bit_width(size_bytes)), 10, kWindowLogMax);
}

std::vector<std::byte> compress(const Compressor& context, std::span<const std::byte> state) {
    LOCKWIND_ASSERT(state.size() <= kStateBytesMax);
    std::vector<std::byte> packed(ZSTD_compressBound(state.size()));
    const std::size_t size =
        ZSTD_compress2(context.get(), packed.data(), packed.size(), state.data(), state.size());
    LOCKWIND_ASSERT(ZSTD_isError(size) == 0);
    packed.resize(size);
    packed.shrink_to_fit();
    return packed;
}

Result<std::vector<std::byte>> decompress(const Decompressor& context,
                                          std::span<const std::byte> packed) {
    const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
    if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN) {
        return Error{"packed state: not a zstd frame with its content's size"};
    }
    if (size > kStateBytesMax || size > packed.size() * kExpansionMax) {
        return Error{"packed state: claims " + std::to_string(size) + " bytes"};
    }
    std::vector<std::byte> state(static_cast<std::size_t>(size));
    const std::size_t done = ZSTD_decompressDCtx(
        context.get(), state.data(), state.size(), packed.data(), packed.size());
    if (ZSTD_isError(done) != 0) {
        return Error{std::string("packed state: ") + ZSTD_getErrorName(done)};
    }
    if (done != state.size()) {
        return Error{"packed state: shorter than it claims"};
    }
    return state;
}

Decompressor make_decompressor() {
    Decompressor context(ZSTD_createDCtx());
    LOCKWIND_ASSERT(context != nullptr);
    ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, kWindowLogMax);
    return context;
}

} // namespace

std::vector<std::byte> pack_state(std::span<const std::byte> state) {
    const Compressor context(ZSTD_createCCtx());
    LOCKWIND_ASSERT(context != nullptr);
    // zstd 1.5.4 hashes 4-byte matches in the machine's byte order, and picks its row match finder
    // by what the processor has: dfast with matches of 5 has neither.
    set(context, ZSTD_c_strategy, ZSTD_dfast);
    set(context, ZSTD_c_minMatch, 5);
    set(context, ZSTD_c_windowLog, window_log_of(state.size()));
    set(context, ZSTD_c_hashLog, 17);
    set(context, ZSTD_c_chainLog, 16);
    set(context, ZSTD_c_searchLog, 1);
    set(context, ZSTD_c_targetLength, 1);
    return compress(context, state);
}

Result<std::vector<std::byte>> unpack_state(std::span<const std::byte> packed) {
    return decompress(make_decompressor(), packed);
}

struct StateChainPacker::Impl {
    Compressor context{ZSTD_createCCtx()};
    std::vector<std::byte> previous;
};

StateChainPacker::StateChainPacker() : impl_(std::make_unique<Impl>()) {
    LOCKWIND_ASSERT(impl_->context != nullptr);
}
StateChainPacker::~StateChainPacker() = default;
StateChainPacker::StateChainPacker(StateChainPacker&&) noexcept = default;
StateChainPacker& StateChainPacker::operator=(StateChainPacker&&) noexcept = default;

std::vector<std::byte> StateChainPacker::pack(std::span<const std::byte> state) {
    const Compressor& context = impl_->context;
    set(context, ZSTD_c_compressionLevel, 3);
    set(context, ZSTD_c_windowLog, window_log_of(state.size() + impl_->previous.size()));
    ZSTD_CCtx_refPrefix(context.get(), impl_->previous.data(), impl_->previous.size());
    std::vector<std::byte> packed = compress(context, state);
    impl_->previous.assign(state.begin(), state.end());
    return packed;
}

struct StateChainUnpacker::Impl {
    Decompressor context = make_decompressor();
    std::vector<std::byte> previous;
    bool broken = false;
};

StateChainUnpacker::StateChainUnpacker() : impl_(std::make_unique<Impl>()) {}
StateChainUnpacker::~StateChainUnpacker() = default;
StateChainUnpacker::StateChainUnpacker(StateChainUnpacker&&) noexcept = default;
StateChainUnpacker& StateChainUnpacker::operator=(StateChainUnpacker&&) noexcept = default;

Result<std::span<const std::byte>> StateChainUnpacker::unpack(std::span<const std::byte> packed) {
    if (impl_->broken) {
        return Error{"packed state: one before it is broken"};
    }
    ZSTD_DCtx_refPrefix(impl_->context.get(), impl_->previous.data(), impl_->previous.size());
    Result<std::vector<std::byte>> state = decompress(impl_->context, packed);
    if (!state) {
        impl_->broken = true;
        return state.error();
    }
    impl_->previous = std::move(state).value();
    return std::span<const std::byte>(impl_->previous);
}

} // namespace lockwind

#pragma once

#include "lockwind/result.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lockwind {

/// Largest state that a file or a peer may make us unpack.
inline constexpr std::size_t kStateBytesMax = 64U << 20U;

/// One zstd frame with the content's size. The same bytes on every architecture: fixed parameters,
/// one thread, and only those match finders of zstd that hash in little-endian order.
std::vector<std::byte> pack_state(std::span<const std::byte> state);
/// An Error where `packed` is not such a frame, or unpacks to more than kStateBytesMax.
Result<std::vector<std::byte>> unpack_state(std::span<const std::byte> packed);

/// Packs a chain of similar states: each as one zstd frame whose dictionary is the state before it,
/// so that what did not change costs almost nothing.
class StateChainPacker {
public:
    StateChainPacker();
    ~StateChainPacker();
    StateChainPacker(StateChainPacker&&) noexcept;
    StateChainPacker& operator=(StateChainPacker&&) noexcept;

    std::vector<std::byte> pack(std::span<const std::byte> state);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Unpacks what a StateChainPacker packed, in the same order.
class StateChainUnpacker {
public:
    StateChainUnpacker();
    ~StateChainUnpacker();
    StateChainUnpacker(StateChainUnpacker&&) noexcept;
    StateChainUnpacker& operator=(StateChainUnpacker&&) noexcept;

    /// The state stays valid until the next call. After an Error the chain is broken: every later
    /// call is an Error too.
    Result<std::span<const std::byte>> unpack(std::span<const std::byte> packed);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace lockwind

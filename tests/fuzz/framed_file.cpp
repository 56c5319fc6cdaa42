#include "tests/fuzz/framed_file.h"

#include "base/state_hash.h"
#include "log/record_file.h"

#include "lockwind/assert.h"

#include <sys/mman.h>
#include <unistd.h>
#include <vector>

namespace lockwind::fuzz {
namespace {

constexpr std::size_t kSizeBytes = 4;
constexpr std::size_t kHashBytes = 8;

void correct_checksums(std::vector<std::byte>& bytes) {
    std::size_t at = kMagicSizeBytes;
    while (at + kRecordOverheadBytes <= bytes.size()) {
        std::size_t payload = 0;
        for (std::size_t index = 0; index < kSizeBytes; ++index) {
            payload |= std::to_integer<std::size_t>(bytes[at + index]) << (8 * index);
        }
        if (payload > bytes.size() - at - kRecordOverheadBytes) {
            return; // torn
        }
        const std::size_t hashed = kSizeBytes + payload;
        const std::uint64_t hash = hash_bytes(std::span(bytes).subspan(at, hashed));
        for (std::size_t index = 0; index < kHashBytes; ++index) {
            bytes[at + hashed + index] = static_cast<std::byte>((hash >> (8 * index)) & 0xffU);
        }
        at += kRecordOverheadBytes + payload;
    }
}

} // namespace

FramedFile::FramedFile(std::span<const std::byte> bytes)
    : descriptor_(::memfd_create("fuzz", 0)),
      path_("/proc/self/fd/" + std::to_string(descriptor_)) {
    LOCKWIND_ASSERT(descriptor_ >= 0);
    std::vector<std::byte> framed(bytes.begin(), bytes.end());
    correct_checksums(framed);
    const auto written = ::write(descriptor_, framed.data(), framed.size());
    LOCKWIND_ASSERT(written == static_cast<ssize_t>(framed.size()));
}

FramedFile::~FramedFile() {
    ::close(descriptor_);
}

} // namespace lockwind::fuzz

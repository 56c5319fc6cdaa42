#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace lockwind::fuzz {

/// A file in memory with the given bytes. Checksums of whole records are put right first: else a
/// fuzzer would never get behind them.
class FramedFile {
public:
    explicit FramedFile(std::span<const std::byte> bytes);
    FramedFile(const FramedFile&) = delete;
    FramedFile& operator=(const FramedFile&) = delete;
    ~FramedFile();

    /// Opens it, as long as this lives.
    const std::string& path() const { return path_; }

private:
    int descriptor_;
    std::string path_;
};

} // namespace lockwind::fuzz

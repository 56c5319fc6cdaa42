#pragma once

#include "lockwind/result.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lockwind {

/// Every file the tools write is 8 magic bytes, then records:
///   u32 little-endian  payload size, bytes
///   payload            one protobuf message
///   u64 little-endian  XXH3-64 of size and payload
enum class FileKind : std::uint8_t { log = 0, trace = 1, bundle = 2, snapshot = 3 };

inline constexpr std::size_t kMagicSizeBytes = 8;
inline constexpr std::size_t kRecordOverheadBytes = 12;
/// Largest payload; a larger size in a file is damage.
inline constexpr std::size_t kRecordPayloadBytesMax = 128U << 20U;

std::string_view to_text(FileKind kind);
/// The kind whose magic `bytes` begin with.
std::optional<FileKind> detect_kind(std::span<const std::byte> bytes);
/// Kind of the file at `path`; an Error where it cannot be read or is none of ours.
Result<FileKind> detect_file_kind(const std::string& path);

/// Appends records to a new file.
class RecordWriter {
public:
    /// The file must not exist. `first`: written with the magic by one write(2).
    static Result<RecordWriter>
    create(const std::string& path, FileKind kind, std::string_view first);
    RecordWriter(RecordWriter&& other) noexcept;
    RecordWriter& operator=(RecordWriter&& other) noexcept;
    ~RecordWriter();

    /// One write(2) of this record and the staged ones before it. Where it fails (disk full) the
    /// file is cut back to the last whole record.
    Status write(std::string_view payload);
    /// A record that goes out with the next write(), in the same write(2).
    Status stage(std::string_view payload);
    /// Makes what was written survive a crash of the machine.
    Status sync();

    const std::string& path() const { return path_; }
    std::uint64_t size_bytes() const { return size_bytes_; }

private:
    RecordWriter(std::string path, int descriptor)
        : path_(std::move(path)), descriptor_(descriptor) {}
    Status write_buffer();

    std::string path_;
    int descriptor_ = -1;
    std::uint64_t size_bytes_ = 0;
    std::vector<std::byte> buffer_;
};

enum class RecordRead : std::uint8_t {
    record = 0,
    end = 1,     // the file ends at a record boundary
    damaged = 2, // torn, too large, or its checksum is wrong: see damage()
};

/// Reads records one at a time; holds one payload. Never trusts a size before it is checked against
/// the file's.
class RecordReader {
public:
    /// An Error where the file cannot be opened or is not of `kind`.
    static Result<RecordReader> open(const std::string& path, FileKind kind);
    RecordReader(RecordReader&& other) noexcept;
    RecordReader& operator=(RecordReader&& other) noexcept;
    ~RecordReader();

    /// Fills `payload` where it returns `record`. After end or damage it returns the same again.
    RecordRead next(std::string& payload);
    /// Start of the next record, bytes from the file's start: all before it is good.
    std::uint64_t offset() const { return offset_; }
    std::uint64_t file_bytes() const { return file_bytes_; }
    const std::string& damage() const { return damage_; }
    const std::string& path() const { return path_; }
    /// Goes on at `offset`, which must be a value that offset() had.
    void seek(std::uint64_t offset);

private:
    RecordReader(std::string path, int descriptor, std::uint64_t file_bytes)
        : path_(std::move(path)), descriptor_(descriptor), file_bytes_(file_bytes) {}
    bool read_at(std::uint64_t offset, std::span<std::byte> out);
    RecordRead fail(std::string what);

    std::string path_;
    int descriptor_ = -1;
    std::uint64_t file_bytes_ = 0;
    std::uint64_t offset_ = kMagicSizeBytes;
    std::string damage_;
    std::vector<std::byte> window_; // read ahead: file bytes [window_start_, + window_.size())
    std::uint64_t window_start_ = 0;
};

/// A name beside `path` for a file that is being written; renamed to `path` when it is whole.
std::string temporary_path(const std::string& path);
/// Renames `from` to `to`; an existing `to` is an Error.
Status publish_file(const std::string& from, const std::string& to);

} // namespace lockwind

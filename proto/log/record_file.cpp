#include "log/record_file.h"

#include "base/state_hash.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace lockwind {

namespace {

constexpr std::size_t kSizeFieldBytes = 4;
constexpr std::size_t kChecksumBytes = 8;
static_assert(kSizeFieldBytes + kChecksumBytes == kRecordOverheadBytes);
constexpr std::size_t kWindowBytes = 64U << 10U;
static_assert(sizeof(off_t) == 8, "a log may be larger than 2 GiB");

/// As in PNG: the high bit and the line ends show transfers that mangle binary files.
constexpr std::array<std::string_view, 4> kMagics{
    "\x89LWLOG\r\n", "\x89LWTRC\r\n", "\x89LWBUN\r\n", "\x89LWSNP\r\n"};
constexpr std::array<std::string_view, 4> kKindNames{"log", "trace", "bundle", "snapshot"};

std::string_view magic_of(FileKind kind) {
    return kMagics[static_cast<std::size_t>(kind)];
}

Error system_error(const std::string& path, std::string_view what, int code) {
    return Error{path + ": " + std::string(what) + ": " + std::generic_category().message(code)};
}

Error exists_error(const std::string& path) {
    return Error{path + ": exists, and is not overwritten; move it or name another file"};
}

void append_bytes(std::vector<std::byte>& out, std::string_view bytes) {
    const std::span<const std::byte> source = std::as_bytes(std::span(bytes.data(), bytes.size()));
    out.insert(out.end(), source.begin(), source.end());
}

void append_little_endian(std::vector<std::byte>& out, std::uint64_t value, std::size_t size) {
    for (std::size_t index = 0; index < size; ++index) {
        out.push_back(static_cast<std::byte>((value >> (8 * index)) & 0xffU));
    }
}

std::uint64_t read_little_endian(std::span<const std::byte> bytes) {
    std::uint64_t value = 0;
    for (std::size_t index = 0; index < bytes.size(); ++index) {
        value |= std::to_integer<std::uint64_t>(bytes[index]) << (8 * index);
    }
    return value;
}

void append_record(std::vector<std::byte>& out, std::string_view payload) {
    LOCKWIND_ASSERT(payload.size() <= kRecordPayloadBytesMax);
    const std::size_t start = out.size();
    append_little_endian(out, payload.size(), kSizeFieldBytes);
    append_bytes(out, payload);
    append_little_endian(out, hash_bytes(std::span(out).subspan(start)), kChecksumBytes);
}

/// Reads as many of `out`'s bytes as the file has at `offset`.
std::size_t read_fully(int descriptor, std::uint64_t offset, std::span<std::byte> out) {
    std::size_t done = 0;
    while (done < out.size()) {
        const ssize_t count = ::pread(
            descriptor, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
        if (count < 0 && errno == EINTR) {
            continue;
        }
        if (count <= 0) {
            break;
        }
        done += static_cast<std::size_t>(count);
    }
    return done;
}

} // namespace

std::string_view to_text(FileKind kind) {
    return kKindNames[static_cast<std::size_t>(kind)];
}

std::optional<FileKind> detect_kind(std::span<const std::byte> bytes) {
    for (std::size_t index = 0; index < kMagics.size(); ++index) {
        if (bytes.size() >= kMagicSizeBytes &&
            std::memcmp(bytes.data(), kMagics[index].data(), kMagicSizeBytes) == 0) {
            return static_cast<FileKind>(index);
        }
    }
    return std::nullopt;
}

Result<FileKind> detect_file_kind(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        return system_error(path, "cannot be opened", errno);
    }
    std::array<std::byte, kMagicSizeBytes> bytes{};
    const std::size_t count = read_fully(descriptor, 0, bytes);
    ::close(descriptor);
    const std::optional<FileKind> kind = detect_kind(std::span(bytes).first(count));
    if (!kind) {
        return Error{path + ": not a file of ours: no log, trace, bundle or snapshot begins so"};
    }
    return *kind;
}

Result<RecordWriter>
RecordWriter::create(const std::string& path, FileKind kind, std::string_view first) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (descriptor < 0 && errno == EEXIST) {
        return exists_error(path);
    }
    if (descriptor < 0) {
        return system_error(path, "cannot be created", errno);
    }
    RecordWriter writer(path, descriptor);
    append_bytes(writer.buffer_, magic_of(kind));
    append_record(writer.buffer_, first);
    if (Status status = writer.write_buffer(); !status) {
        ::unlink(path.c_str());
        return status.error();
    }
    return writer;
}

RecordWriter::RecordWriter(RecordWriter&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)),
      size_bytes_(other.size_bytes_), buffer_(std::move(other.buffer_)) {}

RecordWriter& RecordWriter::operator=(RecordWriter&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(size_bytes_, other.size_bytes_);
    std::swap(buffer_, other.buffer_);
    return *this;
}

RecordWriter::~RecordWriter() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
}

Status RecordWriter::write(std::string_view payload) {
    if (Status staged = stage(payload); !staged) {
        return staged;
    }
    return write_buffer();
}

Status RecordWriter::stage(std::string_view payload) {
    if (payload.size() > kRecordPayloadBytesMax) {
        return Error{path_ + ": a record of " + std::to_string(payload.size()) +
                     " bytes is larger than the format's " +
                     std::to_string(kRecordPayloadBytesMax)};
    }
    append_record(buffer_, payload);
    return Success{};
}

Status RecordWriter::write_buffer() {
    std::size_t done = 0;
    int code = 0;
    while (done < buffer_.size() && code == 0) {
        const ssize_t count = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
        if (count < 0 && errno != EINTR) {
            code = errno;
        } else if (count > 0) {
            done += static_cast<std::size_t>(count);
        }
    }
    const std::size_t size = buffer_.size();
    buffer_.clear();
    if (code == 0) {
        size_bytes_ += size;
        return Success{};
    }
    const auto good_bytes = static_cast<off_t>(size_bytes_);
    if (::ftruncate(descriptor_, good_bytes) == 0) {
        ::lseek(descriptor_, good_bytes, SEEK_SET);
    }
    return system_error(path_, "cannot be written", code);
}

Status RecordWriter::sync() {
    if (::fsync(descriptor_) != 0) {
        return system_error(path_, "cannot be synced", errno);
    }
    return Success{};
}

Result<RecordReader> RecordReader::open(const std::string& path, FileKind kind) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        return system_error(path, "cannot be opened", errno);
    }
    RecordReader reader(path, descriptor, 0);
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) {
        return system_error(path, "cannot be read", errno);
    }
    if (!S_ISREG(status.st_mode)) {
        return Error{path + ": not a regular file"};
    }
    reader.file_bytes_ = static_cast<std::uint64_t>(status.st_size);
    std::array<std::byte, kMagicSizeBytes> bytes{};
    if (!reader.read_at(0, bytes) || detect_kind(bytes) != kind) {
        return Error{path + ": not a lockwind " + std::string(to_text(kind))};
    }
    return reader;
}

RecordReader::RecordReader(RecordReader&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)),
      file_bytes_(other.file_bytes_), offset_(other.offset_), damage_(std::move(other.damage_)),
      window_(std::move(other.window_)), window_start_(other.window_start_) {}

RecordReader& RecordReader::operator=(RecordReader&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(file_bytes_, other.file_bytes_);
    std::swap(offset_, other.offset_);
    std::swap(damage_, other.damage_);
    std::swap(window_, other.window_);
    std::swap(window_start_, other.window_start_);
    return *this;
}

RecordReader::~RecordReader() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
}

bool RecordReader::read_at(std::uint64_t offset, std::span<std::byte> out) {
    if (offset > file_bytes_ || out.size() > file_bytes_ - offset) {
        return false;
    }
    if (out.size() > kWindowBytes) {
        return read_fully(descriptor_, offset, out) == out.size();
    }
    const bool inside =
        offset >= window_start_ && offset + out.size() <= window_start_ + window_.size();
    if (!inside) {
        window_.resize(
            static_cast<std::size_t>(std::min<std::uint64_t>(kWindowBytes, file_bytes_ - offset)));
        window_start_ = offset;
        window_.resize(read_fully(descriptor_, offset, window_));
    }
    if (window_.size() < offset - window_start_ + out.size()) {
        return false;
    }
    std::memcpy(out.data(), window_.data() + (offset - window_start_), out.size());
    return true;
}

RecordRead RecordReader::fail(std::string what) {
    damage_ = "at byte " + std::to_string(offset_) + ": " + std::move(what);
    return RecordRead::damaged;
}

RecordRead RecordReader::next(std::string& payload) {
    if (!damage_.empty()) {
        return RecordRead::damaged;
    }
    if (offset_ == file_bytes_) {
        return RecordRead::end;
    }
    std::array<std::byte, kSizeFieldBytes> size_field{};
    if (!read_at(offset_, size_field)) {
        return fail("a torn record, " + std::to_string(file_bytes_ - offset_) + " bytes");
    }
    const std::uint64_t size = read_little_endian(size_field);
    if (size > kRecordPayloadBytesMax) {
        return fail("a record that claims " + std::to_string(size) + " bytes");
    }
    if (size + kRecordOverheadBytes > file_bytes_ - offset_) {
        return fail("a torn record: " + std::to_string(file_bytes_ - offset_) + " bytes of " +
                    std::to_string(size + kRecordOverheadBytes));
    }
    std::vector<std::byte> record(static_cast<std::size_t>(size) + kRecordOverheadBytes);
    if (!read_at(offset_, record)) {
        return fail("cannot be read");
    }
    const std::span<const std::byte> checked =
        std::span(record).first(record.size() - kChecksumBytes);
    if (hash_bytes(checked) != read_little_endian(std::span(record).last(kChecksumBytes))) {
        return fail("a record whose checksum is wrong");
    }
    payload.assign(reinterpret_cast<const char*>(record.data()) + kSizeFieldBytes,
                   static_cast<std::size_t>(size));
    offset_ += record.size();
    return RecordRead::record;
}

void RecordReader::seek(std::uint64_t offset) {
    LOCKWIND_ASSERT(offset >= kMagicSizeBytes && offset <= file_bytes_);
    offset_ = offset;
    damage_.clear();
}

std::string temporary_path(const std::string& path) {
    return path + ".partial-" + std::to_string(::getpid());
}

Status publish_file(const std::string& from, const std::string& to) {
    int code = ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0
                   ? 0
                   : errno;
    if (code == EINVAL || code == ENOSYS) { // a file system that cannot refuse to replace
        code = ::access(to.c_str(), F_OK) == 0 ? EEXIST : 0;
        if (code == 0 && ::rename(from.c_str(), to.c_str()) != 0) {
            code = errno;
        }
    }
    if (code == 0) {
        return Success{};
    }
    ::unlink(from.c_str());
    return code == EEXIST ? exists_error(to) : system_error(to, "cannot be created", code);
}

} // namespace lockwind

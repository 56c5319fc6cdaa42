#include "log/published_file.h"

#include "log/record_file.h"

#include <filesystem>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/message_lite.h>

namespace lockwind {

PublishedFile::PublishedFile(const std::string& path)
    : path_(path), partial_(temporary_path(path)), out_(partial_, std::ios::binary) {}

PublishedFile::~PublishedFile() {
    if (!published_) {
        out_.close();
        std::error_code ignored;
        std::filesystem::remove(partial_, ignored);
    }
}

void PublishedFile::write(std::string_view bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void PublishedFile::write_field(int number, const google::protobuf::MessageLite& message) {
    constexpr std::uint32_t kLengthDelimited = 2;
    std::string head;
    {
        google::protobuf::io::StringOutputStream stream(&head);
        google::protobuf::io::CodedOutputStream coded(&stream);
        coded.WriteTag(static_cast<std::uint32_t>(number) << 3U | kLengthDelimited);
        coded.WriteVarint32(static_cast<std::uint32_t>(message.ByteSizeLong()));
    }
    write(head);
    write(message.SerializeAsString());
}

Status PublishedFile::close() {
    out_.close();
    return out_ ? Status(Success{}) : Error{path_ + ": cannot be written"};
}

Status PublishedFile::publish() {
    if (Status closed = close(); !closed) {
        return closed;
    }
    published_ = true; // publish_file removes the partial file where it fails
    return publish_file(partial_, path_);
}

Status PublishedFile::replace() {
    if (Status closed = close(); !closed) {
        return closed;
    }
    std::error_code code;
    std::filesystem::rename(partial_, path_, code);
    published_ = !code;
    return published_ ? Status(Success{}) : Error{path_ + ": " + code.message()};
}

} // namespace lockwind

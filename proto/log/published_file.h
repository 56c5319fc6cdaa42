#pragma once

#include "lockwind/result.h"

#include <fstream>
#include <string>
#include <string_view>

namespace google::protobuf {
class MessageLite;
}

namespace lockwind {

/// A file that appears under its name when it is whole.
class PublishedFile {
public:
    explicit PublishedFile(const std::string& path);
    PublishedFile(const PublishedFile&) = delete;
    PublishedFile& operator=(const PublishedFile&) = delete;
    /// Without publish() nothing stays.
    ~PublishedFile();

    /// Appends; what goes wrong is told by publish().
    void write(std::string_view bytes);
    /// Appends `message` as field `number` (a message or one of repeated ones) of a larger message.
    void write_field(int number, const google::protobuf::MessageLite& message);
    /// Never in place of another file.
    Status publish();
    /// In place of what was there: for reports that are made again and again.
    Status replace();

private:
    Status close();

    std::string path_;
    std::string partial_;
    std::ofstream out_;
    bool published_ = false;
};

} // namespace lockwind

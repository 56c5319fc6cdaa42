#pragma once

#include <string_view>

namespace google::protobuf {
class MessageLite;
}

namespace lockwind {

/// Parses bytes that may be anything. Protobuf would print to stderr what it finds wrong, once a
/// text: a peer's or a file's bytes are not to fill a log.
bool parse_quietly(std::string_view payload, google::protobuf::MessageLite& message);

} // namespace lockwind

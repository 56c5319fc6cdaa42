#include "log/quiet_parse.h"

#include <google/protobuf/message_lite.h>
#include <google/protobuf/stubs/logging.h>

namespace lockwind {

bool parse_quietly(std::string_view payload, google::protobuf::MessageLite& message) {
    const google::protobuf::LogSilencer silencer;
    return message.ParseFromArray(payload.data(), static_cast<int>(payload.size()));
}

} // namespace lockwind

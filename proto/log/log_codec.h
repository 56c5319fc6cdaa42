#pragma once

#include "log/log_reader.h"

#include "lockwind/result.h"

#include <string>
#include <string_view>
#include <variant>

namespace lockwind {

namespace log_format {
class MatchConfig;
}

/// Payloads of log records. The only code of the layer that sees log.pb.h, with log_export.

void encode_config(const MatchConfig& config, log_format::MatchConfig& out);
/// Checks nothing: see check_readable.
MatchConfig decode_config(const log_format::MatchConfig& message);
/// The settings that readers count and divide by. Less than a session asks for: what a match of
/// another version was run with can still be read and compared.
Status check_readable(const MatchConfig& config);

std::string encode_header(const LogHeader& header);
/// An Error says which rule the payload breaks.
Result<LogHeader> decode_header(std::string_view payload);

/// `input_size_bytes` of each slot's input are written.
std::string encode_record(const LogRecord& record, std::uint32_t input_size_bytes);
/// Of any record but the header, which tells the sizes.
Result<LogRecord> decode_record(std::string_view payload, const LogHeader& header);

} // namespace lockwind

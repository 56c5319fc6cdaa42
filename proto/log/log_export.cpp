#include "log/log_export.h"

#include "log.pb.h"
#include "log/log_codec.h"
#include "log/published_file.h"
#include "log/state_pack.h"

namespace lockwind {

namespace {

/// One that does not unpack is exported as it is.
void unpack_keyframe(log_format::Record& record) {
    if (!record.has_keyframe()) {
        return;
    }
    const std::string& packed = record.keyframe().packed_state();
    if (const Result<std::vector<std::byte>> state =
            unpack_state(std::as_bytes(std::span(packed.data(), packed.size())))) {
        record.mutable_keyframe()->set_state(state.value().data(), state.value().size());
        record.mutable_keyframe()->clear_packed_state();
    }
}

} // namespace

Status export_log(const std::string& path, const std::string& to) {
    Result<LogReader> reader = LogReader::open(path);
    if (!reader) {
        return reader.error();
    }
    const LogHeader& header = reader.value().header();
    PublishedFile out(to);
    log_format::Record record;
    record.ParseFromString(encode_header(header));
    out.write_field(log_format::Log::kRecordsFieldNumber, record);
    while (const std::optional<LogRecord> next = reader.value().next()) {
        record.ParseFromString(encode_record(*next, header.input_size_bytes));
        unpack_keyframe(record);
        out.write_field(log_format::Log::kRecordsFieldNumber, record);
    }
    return out.publish();
}

} // namespace lockwind

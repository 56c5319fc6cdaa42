#include "log/log_export.h"

#include "log.pb.h"
#include "log/log_codec.h"
#include "log/state_pack.h"

#include <filesystem>
#include <fstream>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

namespace lockwind {

namespace {

/// Appends one element of Log.records to `out`.
void append_element(const log_format::Record& record, std::string& out) {
    constexpr std::uint32_t kLengthDelimited = 2;
    google::protobuf::io::StringOutputStream stream(&out);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.WriteTag(log_format::Log::kRecordsFieldNumber << 3U | kLengthDelimited);
    coded.WriteVarint32(static_cast<std::uint32_t>(record.ByteSizeLong()));
    record.SerializeToCodedStream(&coded);
}

void unpack_keyframe(log_format::Record& record) {
    if (!record.has_keyframe()) {
        return;
    }
    const std::string& packed = record.keyframe().packed_state();
    const Result<std::vector<std::byte>> state =
        unpack_state(std::as_bytes(std::span(packed.data(), packed.size())));
    if (state) { // one that does not unpack is exported as it is
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
    const std::string partial = temporary_path(to);
    std::ofstream out(partial, std::ios::binary);
    std::string element;
    log_format::Record record;
    bool whole = record.ParseFromString(encode_header(reader.value().header()));
    append_element(record, element);
    out << element;
    while (const std::optional<LogRecord> next = reader.value().next()) {
        whole = whole && record.ParseFromString(
                             encode_record(*next, reader.value().header().input_size_bytes));
        unpack_keyframe(record);
        element.clear();
        append_element(record, element);
        out << element;
    }
    out.close();
    if (!out || !whole) {
        std::error_code ignored;
        std::filesystem::remove(partial, ignored);
        return Error{to + ": cannot be written"};
    }
    return publish_file(partial, to);
}

} // namespace lockwind

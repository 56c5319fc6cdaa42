#include "forensics/forensics_codec.h"
#include "forensics/trace.h"
#include "log/quiet_parse.h"

#include <unistd.h>
#include <utility>

namespace lockwind {

Result<TraceWriter> TraceWriter::create(const std::string& path, const TraceHeader& header) {
    if (::access(path.c_str(), F_OK) == 0) {
        return Error{path + ": exists, and is not overwritten; move it or name another file"};
    }
    forensics_format::TraceRecord record;
    encode_trace_header(header, *record.mutable_header());
    Result<RecordWriter> file =
        RecordWriter::create(temporary_path(path), FileKind::trace, record.SerializeAsString());
    if (!file) {
        return file.error();
    }
    return TraceWriter(path, std::move(file).value());
}

TraceWriter::TraceWriter(std::string path, RecordWriter file)
    : path_(std::move(path)), file_(std::move(file)) {}

TraceWriter::TraceWriter(TraceWriter&& other) noexcept
    : path_(std::move(other.path_)), file_(std::move(other.file_)), entries_(other.entries_),
      finished_(std::exchange(other.finished_, true)) {}

TraceWriter::~TraceWriter() {
    if (!finished_) {
        ::unlink(file_.path().c_str());
    }
}

Status TraceWriter::add(TraceEntry entry) {
    forensics_format::TraceRecord record;
    encode_trace_entry(entry, *record.mutable_entry());
    ++entries_;
    return file_.write(record.SerializeAsString());
}

Status TraceWriter::finish() {
    LOCKWIND_ASSERT(!finished_);
    forensics_format::TraceRecord record;
    record.mutable_end()->set_entries(entries_);
    Status status = file_.write(record.SerializeAsString());
    if (!status) {
        return status;
    }
    finished_ = true;
    return publish_file(file_.path(), path_);
}

Result<TraceReader> TraceReader::open(const std::string& path) {
    Result<RecordReader> file = RecordReader::open(path, FileKind::trace);
    if (!file) {
        return file.error();
    }
    std::string payload;
    forensics_format::TraceRecord record;
    if (file.value().next(payload) != RecordRead::record || !parse_quietly(payload, record) ||
        !record.has_header()) {
        return Error{path + ": the header is not whole: nothing can be read"};
    }
    Result<TraceHeader> header = decode_trace_header(record.header());
    if (!header) {
        return Error{path + ": " + header.error().message};
    }
    return TraceReader(std::move(file).value(), std::move(header).value());
}

Error TraceReader::damaged(const std::string& what) const {
    return Error{file_.path() + ": " + what + "; " + std::to_string(entries_) +
                 " entries before it are good"};
}

Result<std::optional<TraceEntry>> TraceReader::next() {
    if (ended_) {
        return std::optional<TraceEntry>();
    }
    switch (file_.next(payload_)) {
    case RecordRead::end:
        return damaged("ends before its last record");
    case RecordRead::damaged:
        return damaged(file_.damage());
    case RecordRead::record:
        break;
    }
    forensics_format::TraceRecord record;
    if (!parse_quietly(payload_, record)) {
        return damaged("a record that does not parse");
    }
    if (record.has_end() && record.end().entries() == entries_) {
        ended_ = true;
        return std::optional<TraceEntry>();
    }
    if (!record.has_entry()) {
        return damaged("a record of the wrong kind");
    }
    Result<TraceEntry> entry = decode_trace_entry(
        record.entry(), header_.phases.size(), state_section_count(header_.schema.view()));
    if (!entry) {
        return damaged(entry.error().message);
    }
    ++entries_;
    return std::optional<TraceEntry>(std::move(entry).value());
}

} // namespace lockwind

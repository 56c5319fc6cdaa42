#include "forensics/forensics_codec.h"
#include "forensics/info.h"
#include "log/log_export.h"
#include "log/published_file.h"

#include <utility>

namespace lockwind {

namespace {

/// States beyond this stay packed, so that an export fits in memory.
constexpr std::uint64_t kUnpackedBytesMax = 512U << 20U;

/// Unpacks the states of a trace's entries, one after the other.
class EntryUnpacker {
public:
    void unpack(forensics_format::TraceEntry& entry) {
        if (entry.packed_state().empty() || unpacked_bytes_ > kUnpackedBytesMax) {
            return;
        }
        if (const Result<std::span<const std::byte>> state =
                unpacker_.unpack(to_bytes(entry.packed_state()))) {
            entry.set_state(to_string(state.value()));
            entry.clear_packed_state();
            unpacked_bytes_ += state.value().size();
        }
    }

    /// For entries that are written out as they come.
    void forget_size() { unpacked_bytes_ = 0; }

private:
    StateChainUnpacker unpacker_;
    std::uint64_t unpacked_bytes_ = 0;
};

void unpack_trace(forensics_format::Trace& trace) {
    EntryUnpacker unpacker;
    for (forensics_format::TraceEntry& entry : *trace.mutable_entries()) {
        unpacker.unpack(entry);
    }
}

Status write_message(const std::string& to, const google::protobuf::MessageLite& message) {
    PublishedFile out(to);
    out.write(message.SerializeAsString());
    return out.publish();
}

Status export_trace(const std::string& path, const std::string& to) {
    Result<TraceReader> trace = TraceReader::open(path);
    if (!trace) {
        return trace.error();
    }
    PublishedFile out(to);
    forensics_format::TraceHeader header;
    encode_trace_header(trace.value().header(), header);
    out.write_field(forensics_format::Trace::kHeaderFieldNumber, header);
    EntryUnpacker unpacker;
    while (true) {
        const Result<std::optional<TraceEntry>> entry = trace.value().next();
        if (!entry) {
            return entry.error();
        }
        if (!entry.value()) {
            return out.publish();
        }
        forensics_format::TraceEntry message;
        encode_trace_entry(*entry.value(), message);
        unpacker.unpack(message);
        unpacker.forget_size();
        out.write_field(forensics_format::Trace::kEntriesFieldNumber, message);
    }
}

Status export_bundle(const std::string& path, const std::string& to) {
    const Result<Bundle> bundle = read_bundle(path);
    if (!bundle) {
        return bundle.error();
    }
    forensics_format::Bundle message;
    encode_bundle(bundle.value(), message);
    message.clear_packed_agreed_state();
    message.clear_packed_server_state();
    message.set_agreed_state(to_string(bundle.value().agreed_state));
    message.set_server_state(to_string(bundle.value().server_state));
    unpack_trace(*message.mutable_server_trace());
    if (bundle.value().client) {
        forensics_format::DesyncReport& client = *message.mutable_client();
        client.clear_packed_agreed_state();
        client.clear_packed_reported_state();
        client.set_agreed_state(to_string(bundle.value().client->agreed_state));
        client.set_reported_state(to_string(bundle.value().client->reported_state));
        unpack_trace(*client.mutable_trace());
    }
    return write_message(to, message);
}

Status export_snapshot(const std::string& path, const std::string& to) {
    const Result<Snapshot> snapshot = read_snapshot(path);
    if (!snapshot) {
        return snapshot.error();
    }
    forensics_format::Snapshot message;
    encode_snapshot(snapshot.value(), message);
    message.clear_packed_state();
    message.set_state(to_string(snapshot.value().state));
    return write_message(to, message);
}

} // namespace

Status export_file(const std::string& path, const std::string& to) {
    const Result<FileKind> kind = detect_file_kind(path);
    if (!kind) {
        return kind.error();
    }
    switch (kind.value()) {
    case FileKind::log:
        return export_log(path, to);
    case FileKind::trace:
        return export_trace(path, to);
    case FileKind::bundle:
        return export_bundle(path, to);
    case FileKind::snapshot:
        break;
    }
    return export_snapshot(path, to);
}

} // namespace lockwind

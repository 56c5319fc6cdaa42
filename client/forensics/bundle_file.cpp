#include "forensics/bundle.h"
#include "forensics/forensics_codec.h"
#include "forensics/snapshot_file.h"
#include "log/quiet_parse.h"
#include "session/match_config.h"

#include <unistd.h>
#include <utility>

namespace lockwind {

namespace {

/// A file of one record.
Status
write_file(const std::string& path, FileKind kind, const google::protobuf::MessageLite& message) {
    if (::access(path.c_str(), F_OK) == 0) {
        return Error{path + ": exists, and is not overwritten; move it or name another file"};
    }
    if (message.ByteSizeLong() > kRecordPayloadBytesMax) {
        return Error{path + ": " + std::to_string(message.ByteSizeLong()) +
                     " bytes are more than the format's " + std::to_string(kRecordPayloadBytesMax)};
    }
    const std::string partial = temporary_path(path);
    const Result<RecordWriter> file =
        RecordWriter::create(partial, kind, message.SerializeAsString());
    return file ? publish_file(partial, path) : Status(file.error());
}

Status read_file(const std::string& path, FileKind kind, google::protobuf::MessageLite& message) {
    Result<RecordReader> file = RecordReader::open(path, kind);
    if (!file) {
        return file.error();
    }
    std::string payload;
    if (file.value().next(payload) != RecordRead::record) {
        return Error{path + ": torn or damaged: nothing can be read"};
    }
    if (!parse_quietly(payload, message)) {
        return Error{path + ": its record does not parse"};
    }
    std::string more;
    if (file.value().next(more) != RecordRead::end) {
        return Error{path + ": something stands behind its only record"};
    }
    return Success{};
}

Status decode_states(const forensics_format::Bundle& message, Bundle& bundle) {
    Result<std::vector<std::byte>> agreed = unpack_state(to_bytes(message.packed_agreed_state()));
    Result<std::vector<std::byte>> server = unpack_state(to_bytes(message.packed_server_state()));
    if (!agreed || !server) {
        return agreed ? server.error() : agreed.error();
    }
    bundle.agreed_state = std::move(agreed).value();
    bundle.server_state = std::move(server).value();
    return Success{};
}

Result<Bundle> decode_bundle(const forensics_format::Bundle& message) {
    Result<Party> server = decode_party(message.server());
    if (!server) {
        return server.error();
    }
    Bundle bundle;
    bundle.slot = message.slot();
    bundle.agreed_tick = message.agreed_tick();
    bundle.bad_tick = message.bad_tick();
    bundle.server_hash = message.server_hash();
    bundle.client_hash = message.client_hash();
    bundle.server = std::move(server).value();
    bundle.reason = message.reason();
    bundle.server_at_fault = message.server_at_fault();
    const std::optional<Verdict> verdict = verdict_from_text(message.verdict());
    if (!verdict) {
        return Error{"unknown verdict"};
    }
    bundle.verdict = *verdict;
    Result<std::vector<std::vector<SlotInput>>> inputs =
        decode_inputs(message.inputs(), bundle.server.config.players);
    if (!inputs) {
        return inputs.error();
    }
    bundle.inputs = std::move(inputs).value();
    if (bundle.agreed_tick > kMatchTicksMax ||
        bundle.bad_tick != bundle.agreed_tick + bundle.inputs.size()) {
        return Error{"the ticks do not fit the inputs"};
    }
    if (Status status = decode_states(message, bundle); !status) {
        return status.error();
    }
    Result<Trace> trace =
        decode_trace(message.server_trace(), bundle.agreed_tick, bundle.inputs.size());
    if (!trace) {
        return trace.error();
    }
    bundle.server_trace = std::move(trace).value();
    if (message.has_client()) {
        Result<DesyncReport> client = decode_report(message.client());
        if (!client) {
            return client.error();
        }
        bundle.client = std::move(client).value();
    }
    return bundle;
}

} // namespace

void encode_bundle(const Bundle& bundle, forensics_format::Bundle& out) {
    out.set_slot(bundle.slot);
    out.set_agreed_tick(bundle.agreed_tick);
    out.set_bad_tick(bundle.bad_tick);
    out.set_server_hash(bundle.server_hash);
    out.set_client_hash(bundle.client_hash);
    encode_party(bundle.server, *out.mutable_server());
    encode_inputs(bundle.inputs, *out.mutable_inputs());
    out.set_packed_agreed_state(to_string(pack_state(bundle.agreed_state)));
    out.set_packed_server_state(to_string(pack_state(bundle.server_state)));
    encode_trace(bundle.server_trace, *out.mutable_server_trace());
    if (bundle.client) {
        encode_report(*bundle.client, *out.mutable_client());
    }
    out.set_verdict(std::string(to_text(bundle.verdict)));
    out.set_reason(bundle.reason);
    out.set_server_at_fault(bundle.server_at_fault);
}

void encode_snapshot(const Snapshot& snapshot, forensics_format::Snapshot& out) {
    encode_party(snapshot.party, *out.mutable_party());
    out.set_tick(snapshot.tick);
    out.set_hash(snapshot.hash);
    snapshot.schema.encode(*out.mutable_schema());
    out.set_packed_state(to_string(pack_state(snapshot.state)));
}

Status write_bundle(const std::string& path, const Bundle& bundle) {
    forensics_format::Bundle message;
    encode_bundle(bundle, message);
    return write_file(path, FileKind::bundle, message);
}

Result<Bundle> read_bundle(const std::string& path) {
    forensics_format::Bundle message;
    if (Status status = read_file(path, FileKind::bundle, message); !status) {
        return status.error();
    }
    Result<Bundle> bundle = decode_bundle(message);
    return bundle ? std::move(bundle) : Error{path + ": " + bundle.error().message};
}

Status write_snapshot(const std::string& path, const Snapshot& snapshot) {
    forensics_format::Snapshot message;
    encode_snapshot(snapshot, message);
    return write_file(path, FileKind::snapshot, message);
}

Result<Snapshot> read_snapshot(const std::string& path) {
    forensics_format::Snapshot message;
    if (Status status = read_file(path, FileKind::snapshot, message); !status) {
        return status.error();
    }
    Result<Party> party = decode_party(message.party());
    if (!party) {
        return Error{path + ": " + party.error().message};
    }
    Result<OwnedSchema> schema = OwnedSchema::decode(message.schema());
    if (!schema) {
        return Error{path + ": " + schema.error().message};
    }
    Result<std::vector<std::byte>> state = unpack_state(to_bytes(message.packed_state()));
    if (!state) {
        return Error{path + ": " + state.error().message};
    }
    return Snapshot{std::move(party).value(),
                    message.tick(),
                    message.hash(),
                    std::move(schema).value(),
                    std::move(state).value()};
}

} // namespace lockwind

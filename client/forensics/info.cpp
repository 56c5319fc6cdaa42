#include "forensics/info.h"

#include "base/canonical.h"
#include "forensics/bundle.h"
#include "forensics/snapshot_file.h"
#include "forensics/trace.h"
#include "log/log_reader.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace lockwind {

namespace {

using Json = nlohmann::ordered_json;

Json text_or_null(const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(text);
}

std::string value_text(const Json& value) {
    return value.is_string() ? value.get<std::string>()
                             : value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// The JSON object's fields, one a line.
FileInfo make_info(FileKind kind, const Json& json, bool damaged) {
    FileInfo info;
    info.kind = kind;
    info.damaged = damaged;
    info.json = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::size_t width = 0;
    for (const auto& [name, value] : json.items()) {
        width = std::max(width, name.size());
    }
    for (const auto& [name, value] : json.items()) {
        if (!value.is_null()) {
            info.text +=
                name + std::string(width - name.size() + 2, ' ') + value_text(value) + "\n";
        }
    }
    return info;
}

void add_party(Json& json, const Party& party) {
    json["sim_version"] = party.sim_version;
    json["build_info"] = party.build_info;
    json["scene"] = party.config.scene_name;
    json["seed"] = party.config.seed;
    json["mode"] = party.config.mode;
    json["players"] = party.config.players;
}

Result<FileInfo> inspect_log(const std::string& path) {
    Result<LogReader> log = LogReader::open(path);
    if (!log) {
        return log.error();
    }
    const LogIndex index = index_log(log.value());
    const LogHeader& header = log.value().header();
    Json json;
    json["kind"] = "log";
    json["ticks"] = index.ticks;
    json["ended"] = to_text(index.ended);
    json["valid_bytes"] = index.valid_bytes;
    json["file_bytes"] = index.file_bytes;
    json["verified_to_tick"] = index.hashed_to_tick;
    add_party(json, {header.sim_version, header.build_info, header.config});
    json["tick_rate_hz"] = header.config.tick_rate_hz;
    json["match"] = header.config.match;
    json["format_version"] = header.format_version;
    json["started_unix_us"] = header.started_unix_us;
    json["hashes"] = index.hashes;
    json["keyframes"] = index.keyframes.size();
    json["substituted_inputs"] = index.substituted_inputs;
    json["joins"] = index.joins;
    json["leaves"] = index.leaves;
    json["pauses"] = index.pauses;
    json["events"] = index.events;
    json["desyncs"] = index.desyncs;
    json["state_hash"] = nullptr;
    json["message"] = nullptr;
    if (index.summary) {
        json["desyncs"] = index.summary->desyncs;
        json["state_hash"] = hash_text(index.summary->state_hash);
        json["message"] = text_or_null(index.summary->message);
    }
    json["damage"] = text_or_null(index.damage);
    return make_info(FileKind::log, json, index.ended == LogEnd::damaged);
}

Result<FileInfo> inspect_trace(const std::string& path) {
    Result<TraceReader> trace = TraceReader::open(path);
    if (!trace) {
        return trace.error();
    }
    std::uint64_t entries = 0;
    Tick first_tick = 0;
    Tick last_tick = 0;
    std::string damage;
    while (true) {
        Result<std::optional<TraceEntry>> entry = trace.value().next();
        if (!entry || !entry.value()) {
            damage = entry ? "" : entry.error().message;
            break;
        }
        last_tick = entry.value()->tick;
        first_tick = entries == 0 ? last_tick + 1 : first_tick;
        ++entries;
    }
    const TraceHeader& header = trace.value().header();
    Json json;
    json["kind"] = "trace";
    json["first_tick"] = first_tick;
    json["last_tick"] = last_tick;
    json["entries"] = entries;
    json["states"] = header.states;
    json["phases"] = header.phases;
    add_party(json, header.party);
    json["valid_bytes"] = trace.value().valid_bytes();
    json["damage"] = text_or_null(damage);
    return make_info(FileKind::trace, json, !damage.empty());
}

Result<FileInfo> inspect_bundle(const std::string& path) {
    const Result<Bundle> bundle = read_bundle(path);
    if (!bundle) {
        return bundle.error();
    }
    const Bundle& content = bundle.value();
    Json json;
    json["kind"] = "bundle";
    json["slot"] = content.slot;
    json["agreed_tick"] = content.agreed_tick;
    json["bad_tick"] = content.bad_tick;
    json["verdict"] = to_text(content.verdict);
    json["reason"] = content.reason;
    json["server_hash"] = hash_text(content.server_hash);
    json["client_hash"] = hash_text(content.client_hash);
    json["recomputed_hash"] = nullptr;
    json["client_build_info"] = nullptr;
    if (content.client) {
        json["recomputed_hash"] = hash_text(content.client->recomputed_hash());
        json["client_build_info"] = content.client->client.build_info;
    }
    add_party(json, content.server);
    return make_info(FileKind::bundle, json, false);
}

Result<FileInfo> inspect_snapshot(const std::string& path) {
    const Result<Snapshot> snapshot = read_snapshot(path);
    if (!snapshot) {
        return snapshot.error();
    }
    const Snapshot& content = snapshot.value();
    Json json;
    json["kind"] = "snapshot";
    json["tick"] = content.tick;
    json["state_hash"] = hash_text(content.hash);
    json["state_bytes"] = content.state.size();
    const StateSchema schema = content.schema.view();
    if (const auto sections = split_canonical(schema, content.state)) {
        Json rows;
        for (std::size_t section = 0; section < sections.value().size(); ++section) {
            rows[std::string(schema[section].name)] =
                sections.value()[section].size() / schema[section].stride_bytes;
        }
        json["rows"] = rows;
    }
    add_party(json, content.party);
    return make_info(FileKind::snapshot, json, false);
}

} // namespace

Result<FileInfo> inspect_file(const std::string& path) {
    const Result<FileKind> kind = detect_file_kind(path);
    if (!kind) {
        return kind.error();
    }
    switch (kind.value()) {
    case FileKind::log:
        return inspect_log(path);
    case FileKind::trace:
        return inspect_trace(path);
    case FileKind::bundle:
        return inspect_bundle(path);
    case FileKind::snapshot:
        break;
    }
    return inspect_snapshot(path);
}

} // namespace lockwind

#include "forensics/diff.h"

#include "forensics/diff_fields.h"

#include <algorithm>
#include <utility>

namespace lockwind {

namespace {

FieldValue number_value(std::uint64_t value) {
    return {std::to_string(value), std::to_string(value)};
}

void add_slot_diffs(Slot slot, const SlotInput& a, const SlotInput& b, DiffResult& result) {
    const std::string entity = "slot " + std::to_string(slot);
    if (a.status != b.status) {
        result.fields.push_back({"input",
                                 entity,
                                 "status",
                                 "",
                                 number_value(static_cast<std::uint64_t>(a.status)),
                                 number_value(static_cast<std::uint64_t>(b.status))});
    }
    for (std::size_t index = 0; index < a.bytes.size(); ++index) {
        if (a.bytes[index] != b.bytes[index]) {
            result.fields.push_back({"input",
                                     entity,
                                     "bytes[" + std::to_string(index) + "]",
                                     "",
                                     number_value(a.bytes[index]),
                                     number_value(b.bytes[index])});
        }
    }
}

/// A reader of the ticks and hashes of a log only.
std::optional<LogRecord> next_comparable(LogReader& log) {
    while (std::optional<LogRecord> record = log.next()) {
        if (std::holds_alternative<TickRecord>(*record) ||
            std::holds_alternative<HashRecord>(*record)) {
            return record;
        }
    }
    return std::nullopt;
}

/// Place in the order of a log: a tick's hash stands behind its inputs.
std::pair<Tick, int> place_of(const LogRecord& record) {
    if (const auto* tick = std::get_if<TickRecord>(&record)) {
        return {tick->tick, 0};
    }
    return {std::get<HashRecord>(record).tick, 1};
}

/// Settings that change a state.
bool changes_state(const ConfigDiff& setting) {
    return setting.field != "ticks" && setting.field != "hash_interval_ticks" &&
           setting.field != "input_delay_ticks" && setting.field != "mode" &&
           setting.field != "scene_name";
}

void compare_records(const LogReader& a,
                     const LogReader& b,
                     const LogRecord& record_a,
                     const LogRecord& record_b,
                     DiffResult& result) {
    if (const auto* tick = std::get_if<TickRecord>(&record_a)) {
        const auto& other = std::get<TickRecord>(record_b);
        if (tick->inputs != other.inputs) {
            DiffResult inputs =
                diff_inputs(tick->tick, std::span(&tick->inputs, 1), std::span(&other.inputs, 1));
            inputs.name_a = result.name_a;
            inputs.name_b = result.name_b;
            inputs.verdict = Verdict::inputs_differ;
            inputs.reason = "the logs hold other inputs from here on";
            result = std::move(inputs);
        }
        return;
    }
    const auto& hash_a = std::get<HashRecord>(record_a);
    const auto& hash_b = std::get<HashRecord>(record_b);
    if (hash_a.hash == hash_b.hash) {
        return;
    }
    const bool builds = a.header().sim_version != b.header().sim_version ||
                        a.header().build_info != b.header().build_info;
    const std::string tick = std::to_string(hash_a.tick);
    result.same = false;
    result.first_tick = hash_a.tick;
    set_hashes(result, hash_a.hash, hash_b.hash);
    result.verdict = builds ? Verdict::build_differs : Verdict::nondeterminism;
    result.reason = "equal inputs gave other states; to see the field, run `lockwind replay LOG "
                    "--from " +
                    tick + " --to " + tick +
                    " --trace FILE --trace-states` with both programs and diff the traces";
}

} // namespace

void set_fields(DiffResult& result, StateDiff diff) {
    result.fields = std::move(diff.fields);
    result.field_count = diff.count;
    result.section = result.fields.empty() ? "" : result.fields.front().section;
}

void set_hashes(DiffResult& result, std::uint64_t a, std::uint64_t b) {
    const std::string text_a = hash_text(a);
    const std::string text_b = hash_text(b);
    result.section.clear();
    result.fields = {{"", "", "state_hash", "", {text_a, text_a}, {text_b, text_b}}};
    result.field_count = 1;
}

void set_settings(DiffResult& result, const std::vector<ConfigDiff>& differing) {
    result.same = false;
    result.first_tick = 0;
    result.section = "config";
    result.field_count = differing.size();
    for (const ConfigDiff& setting : differing) {
        result.fields.push_back(
            {"config", "", setting.field, "", {setting.a, setting.a}, {setting.b, setting.b}});
    }
}

DiffResult diff_inputs(Tick first_tick,
                       std::span<const std::vector<SlotInput>> a,
                       std::span<const std::vector<SlotInput>> b) {
    DiffResult result;
    for (std::size_t index = 0; index < std::min(a.size(), b.size()) && result.same; ++index) {
        for (Slot slot = 0; slot < std::min(a[index].size(), b[index].size()); ++slot) {
            add_slot_diffs(slot, a[index][slot], b[index][slot], result);
        }
        if (!result.fields.empty()) {
            result.same = false;
            result.first_tick = first_tick + index;
            result.section = "input";
        }
    }
    constexpr std::size_t kFieldsMax = 20;
    result.field_count = result.fields.size();
    result.fields.resize(std::min(result.fields.size(), kFieldsMax));
    return result;
}

Result<DiffResult> diff_snapshots(const Snapshot& a, const Snapshot& b) {
    DiffResult result;
    if (!(a.schema == b.schema)) {
        result.same = false;
        result.verdict = Verdict::build_differs;
        result.reason = "the snapshots are of programs with other state schemas";
        return result;
    }
    if (a.state == b.state && a.tick == b.tick) {
        return result;
    }
    Result<StateDiff> diff = diff_states(a.schema.view(), a.state, b.state);
    if (!diff) {
        return diff.error();
    }
    result.same = false;
    result.first_tick = std::min(a.tick, b.tick);
    result.phase = kOutsideStep;
    set_fields(result, std::move(diff).value());
    if (a.tick != b.tick) {
        result.reason = "the snapshots are of tick " + std::to_string(a.tick) + " and tick " +
                        std::to_string(b.tick);
    }
    return result;
}

DiffResult diff_logs(LogReader& a, LogReader& b) {
    DiffResult result;
    result.name_a = a.path();
    result.name_b = b.path();
    std::vector<ConfigDiff> settings = diff_configs(a.header().config, b.header().config);
    if (std::any_of(settings.begin(), settings.end(), changes_state)) {
        set_settings(result, settings);
        result.verdict = Verdict::settings_differ;
        result.reason = "the matches were started with other settings";
        return result;
    }
    std::optional<LogRecord> record_a = next_comparable(a);
    std::optional<LogRecord> record_b = next_comparable(b);
    while (record_a && record_b && result.same) {
        const std::pair<Tick, int> place_a = place_of(*record_a);
        const std::pair<Tick, int> place_b = place_of(*record_b);
        if (place_a == place_b) {
            compare_records(a, b, *record_a, *record_b, result);
        }
        record_a = place_a <= place_b ? next_comparable(a) : std::move(record_a);
        record_b = place_b <= place_a ? next_comparable(b) : std::move(record_b);
    }
    if (result.same && record_a.has_value() != record_b.has_value()) {
        result.reason = (record_a ? b.path() : a.path()) + " ends earlier";
    }
    return result;
}

} // namespace lockwind

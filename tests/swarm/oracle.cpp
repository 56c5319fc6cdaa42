#include "tests/swarm/oracle.h"

#include "forensics/match_simulation.h"
#include "forensics/replay.h"
#include "log/log_reader.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace lockwind::swarm {

namespace {

constexpr std::size_t kFailuresKept = 4;
/// Nobody holds a match of the swarm to be longer; what is beyond is a failure, not memory.
constexpr Tick kTickMax = 10'000'000;

/// The world that a replay steps: tells the oracle of every tick of which somebody spoke.
class WatchedSimulation final : public Simulation {
public:
    WatchedSimulation(WorldSimulation& world, Oracle& oracle) : world_(world), oracle_(oracle) {}

    std::uint32_t slot_count() const override { return world_.slot_count(); }
    std::uint32_t input_size_bytes() const override { return world_.input_size_bytes(); }
    Tick tick() const override { return world_.tick(); }
    Status advance(std::span<const SlotInput> inputs) override {
        Status stepped = world_.advance(inputs);
        hash_.reset();
        contacts_ += world_.world().counts().contacts;
        if (stepped && oracle_.hash_of(tick())) {
            oracle_.hashed(kReplayParty, tick(), state_hash());
        }
        return stepped;
    }
    std::uint64_t state_hash() const override {
        hash_ = hash_ ? *hash_ : world_.state_hash();
        return *hash_;
    }
    HashTree hash_tree() const override { return world_.hash_tree(); }
    void save(std::vector<std::byte>& out) const override { world_.save(out); }
    Status load(std::span<const std::byte> bytes) override {
        hash_.reset();
        return world_.load(bytes);
    }
    StateSchema schema() const override { return world_.schema(); }
    std::span<const std::string_view> phases() const override { return world_.phases(); }
    void observe(PhaseObserver* observer) override { world_.observe(observer); }
    bool corrupt(std::string_view field) override {
        hash_.reset();
        return world_.corrupt(field);
    }

    std::uint64_t contacts() const { return contacts_; }

private:
    WorldSimulation& world_;
    Oracle& oracle_;
    mutable std::optional<std::uint64_t> hash_; // of the state as it is now
    std::uint64_t contacts_ = 0;
};

template <class Table>
bool make_room(Table& table, Tick tick) {
    if (tick > kTickMax) {
        return false;
    }
    table.resize(std::max(table.size(), static_cast<std::size_t>(tick) + 1));
    return true;
}

} // namespace

std::string party_name(Party party) {
    switch (party) {
    case kServerParty:
        return "the server";
    case kLogParty:
        return "the log";
    case kReplayParty:
        return "the replay";
    default:
        return fmt::format("client {}", party - kFirstClientParty);
    }
}

void Oracle::fail(std::string what) {
    ++failures_;
    if (first_failures_.size() < kFailuresKept) {
        first_failures_.push_back(std::move(what));
    }
}

std::optional<std::uint64_t> Oracle::hash_of(Tick tick) const {
    if (tick >= hashes_.size() || !hashes_[static_cast<std::size_t>(tick)]) {
        return std::nullopt;
    }
    return hashes_[static_cast<std::size_t>(tick)]->value;
}

void Oracle::confirmed(Party who, Tick tick, std::span<const SlotInput> inputs) {
    if (!make_room(inputs_, tick)) {
        fail(fmt::format("{} has a tick {}", party_name(who), tick));
        return;
    }
    auto& claim = inputs_[static_cast<std::size_t>(tick)];
    if (!claim) {
        claim = Claim<std::vector<SlotInput>>{who, {inputs.begin(), inputs.end()}};
    } else if (!std::ranges::equal(claim->value, inputs)) {
        fail(fmt::format("tick {}: {} has other inputs than {} had",
                         tick,
                         party_name(who),
                         party_name(claim->who)));
    }
}

void Oracle::hashed(Party who, Tick tick, std::uint64_t hash) {
    if (!make_room(hashes_, tick)) {
        fail(fmt::format("{} has a hash of tick {}", party_name(who), tick));
        return;
    }
    auto& claim = hashes_[static_cast<std::size_t>(tick)];
    if (!claim) {
        claim = Claim<std::uint64_t>{who, hash};
    } else if (claim->value != hash) {
        fail(fmt::format("tick {}: {} has hash {}, {} had {}",
                         tick,
                         party_name(who),
                         hash_text(hash),
                         party_name(claim->who),
                         hash_text(claim->value)));
    }
}

void Oracle::told(const Confirmation& confirmation, Tick logged_tick) {
    const Tick newest = std::max(
        confirmation.confirmed_tick,
        confirmation.ticks.empty() ? 0 : confirmation.first_tick + confirmation.ticks.size() - 1);
    if (newest > logged_tick) {
        fail(fmt::format(
            "tick {} is told of before it is in the log, which ends at {}", newest, logged_tick));
    }
    for (std::size_t index = 0; index < confirmation.ticks.size(); ++index) {
        confirmed(kServerParty, confirmation.first_tick + index, confirmation.ticks[index].inputs);
    }
}

void Oracle::reported(Party who, const HashReport& report, Tick confirmed_tick) {
    for (const HashReport::Entry& entry : report.entries) {
        if (entry.tick > confirmed_tick) {
            fail(fmt::format("{} reports a hash of tick {}, but only {} is confirmed to it",
                             party_name(who),
                             entry.tick,
                             confirmed_tick));
        }
        hashed(who, entry.tick, entry.hash);
    }
}

void Oracle::read_log(const std::string& path) {
    Result<LogReader> log = LogReader::open(path);
    if (!log) {
        fail(log.error().message);
        return;
    }
    Tick last_tick = 0;
    while (const std::optional<LogRecord> record = log.value().next()) {
        if (const auto* tick = std::get_if<TickRecord>(&*record)) {
            confirmed(kLogParty, tick->tick, tick->inputs);
            last_tick = tick->tick;
        } else if (const auto* hash = std::get_if<HashRecord>(&*record)) {
            hashed(kLogParty, hash->tick, hash->hash);
        } else if (std::holds_alternative<DesyncRecord>(*record)) {
            fail("the log has a desync");
        }
    }
    if (inputs_.size() > last_tick + 1) {
        fail(fmt::format(
            "tick {} was seen, but the log ends at tick {}", inputs_.size() - 1, last_tick));
    }
}

LogFindings Oracle::check_log(const std::string& path, const MatchConfig& config) {
    LogFindings findings;
    read_log(path);
    Result<LogReader> log = LogReader::open(path);
    Result<std::unique_ptr<WorldSimulation>> world = create_match_simulation(config);
    if (!log || !world) {
        fail("the log cannot be replayed");
        return findings;
    }
    WatchedSimulation simulation(*world.value(), *this);
    ReplayOptions options;
    options.verify = true;
    const Result<ReplayResult> replayed = replay(log.value(), simulation, options);
    if (!replayed) {
        fail(replayed.error().message);
        return findings;
    }
    const ReplayResult& result = replayed.value();
    const bool verified = !result.first_bad_tick && result.failure.empty() &&
                          result.hashes_checked > 0 && result.verified_to_tick == result.ticks;
    if (!verified || result.ended != LogEnd::summary) {
        fail(fmt::format("the log does not verify: {}", replay_text(result)));
    }
    findings.contacts = simulation.contacts();
    findings.last_hash = result.state_hash;
    return findings;
}

} // namespace lockwind::swarm

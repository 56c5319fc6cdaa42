#include "tests/swarm/swarm_match.h"

#include "program/console.h"
#include "session/match_config.h"
#include "tests/swarm/digest.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <system_error>
#include <utility>

namespace lockwind::swarm {

namespace {

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
/// After the heal: beside the ticks that are left, a reconnect (3 s), stalls and the end (3 s).
constexpr std::uint64_t kHealedSlackUs = 10'000'000;
/// A party that asks for this many polls in a match spins.
constexpr std::uint64_t kPollsATickMax = 1'000;

LinkConditions good_conditions() {
    LinkConditions conditions;
    conditions.latency_us = 5'000;
    conditions.jitter_us = 1'000;
    return conditions;
}

} // namespace

struct SwarmMatch::Client {
    std::uint32_t index = 0;
    ClientPlan plan;
    std::uint32_t address = 0;
    std::unique_ptr<WatchedTransport> transport;
    std::unique_ptr<ClientTap> tap;
    std::unique_ptr<WireTap> plant;
    std::unique_ptr<Bot> bot; // none before it arrives, and while it is dead
    bool frozen = false;
    Tick seen_tick = 0; // newest confirmed one that the oracle was told

    Party party() const { return kFirstClientParty + index; }
};

class SwarmMatch::ServerTap final : public WireTap {
public:
    ServerTap(Oracle& oracle, const std::unique_ptr<MatchServer>& server)
        : oracle_(oracle), server_(server) {}
    bool on_send(Message& message) override {
        if (const auto* confirmation = std::get_if<Confirmation>(&message)) {
            oracle_.told(*confirmation, server_->log().last_tick());
        }
        return false;
    }

private:
    Oracle& oracle_;
    const std::unique_ptr<MatchServer>& server_;
};

class SwarmMatch::ClientTap final : public WireTap {
public:
    ClientTap(Oracle& oracle, Client& client) : oracle_(oracle), client_(client) {}
    bool on_send(Message& message) override {
        if (const auto* report = std::get_if<HashReport>(&message)) {
            oracle_.reported(client_.party(), *report, client_.bot->session().confirmed_tick());
        }
        return false;
    }

private:
    Oracle& oracle_;
    Client& client_;
};

SwarmMatch::SwarmMatch(std::uint64_t seed, const SwarmSettings& settings)
    : seed_(seed), settings_(settings),
      scenario_(draw_scenario(seed, settings.ticks, settings.scene_name, settings.scene_text)),
      log_path_((std::filesystem::path(settings.folder) / fmt::format("{}.log", seed)).string()),
      network_(clock_, ~seed) {
    for (const std::string& line : describe(scenario_)) {
        note(line);
    }
    for (std::uint32_t index = 0; index < scenario_.clients.size(); ++index) {
        clients_.push_back(std::make_unique<Client>());
        clients_.back()->index = index;
        clients_.back()->plan = scenario_.clients[index];
    }
    plan_steps();
    open_server();
}

SwarmMatch::~SwarmMatch() {
    std::error_code ignored;
    std::filesystem::remove(log_path_, ignored);
}

void SwarmMatch::note(const std::string& text) {
    const std::uint64_t now_us = clock_.now_us();
    timeline_.push_back(fmt::format("{:4}.{:06} {}", now_us / 1'000'000, now_us % 1'000'000, text));
}

void SwarmMatch::plan_steps() {
    for (std::uint32_t index = 0; index < scenario_.clients.size(); ++index) {
        steps_.push_back({scenario_.clients[index].arrival_us, Step::Kind::arrive, index});
    }
    for (std::uint32_t index = 0; index < scenario_.faults.size(); ++index) {
        steps_.push_back({scenario_.faults[index].begin_us, Step::Kind::begin, index});
        steps_.push_back({scenario_.faults[index].end_us, Step::Kind::end, index});
    }
    steps_.push_back({scenario_.heal_us, Step::Kind::heal, 0});
    std::stable_sort(steps_.begin(), steps_.end(), [](const Step& a, const Step& b) {
        return a.at_us < b.at_us;
    });
}

void SwarmMatch::open_server() {
    server_transport_ = std::make_unique<WatchedTransport>(network_.open(kServerPeer), ClockSkew{});
    server_tap_ = std::make_unique<ServerTap>(oracle_, server_);
    server_transport_->add_outgoing(server_tap_.get());
    MatchSettings match;
    match.config = scenario_.config;
    match.stall_policy = scenario_.stall_policy;
    match.join_timeout_ms = scenario_.join_timeout_ms;
    match.log_path = log_path_;
    Result<std::unique_ptr<MatchServer>> server = MatchServer::create(match, *server_transport_);
    if (!server) {
        oracle_.fail(server.error().message);
        return;
    }
    server_ = std::move(server).value();
    server_->listen([this](const SessionEvent& event) {
        note("server: " + lockwind::describe(event));
        const bool first_time = event.kind == SessionEventKind::joined;
        figures_.late_joins += first_time && event.tick > 1 ? 1 : 0;
    });
}

SeedResult SwarmMatch::run() {
    if (server_) {
        play();
        check_server();
        for (const std::unique_ptr<Client>& client : clients_) {
            check_client(*client);
        }
    }
    return result();
}

void SwarmMatch::play() {
    while (!all_ended() && !take_too_long()) {
        clock_.advance_to(next_us());
        for (; next_step_ < steps_.size() && steps_[next_step_].at_us <= clock_.now_us();
             ++next_step_) {
            execute(steps_[next_step_]);
        }
        poll_server();
        for (const std::unique_ptr<Client>& client : clients_) {
            poll_client(*client);
        }
    }
}

bool SwarmMatch::all_ended() const {
    return server_->ended() && next_step_ == steps_.size() &&
           std::ranges::all_of(clients_, [](const std::unique_ptr<Client>& client) {
               return !client->bot || client->bot->ended();
           });
}

bool SwarmMatch::take_too_long() {
    if (end_by_us_ != 0 && clock_.now_us() >= end_by_us_) {
        oracle_.fail(fmt::format("no end within {} ms of the heal",
                                 (end_by_us_ - scenario_.heal_us) / 1000));
        return true;
    }
    if (polls_ >= kPollsATickMax * settings_.ticks * clients_.size()) {
        oracle_.fail("somebody spins: so many polls in so few ticks");
        return true;
    }
    return false;
}

std::uint64_t SwarmMatch::next_us() const {
    std::uint64_t next = network_.next_arrival_us().value_or(kNever);
    if (next_step_ < steps_.size()) {
        next = std::min(next, steps_[next_step_].at_us);
    }
    if (end_by_us_ != 0) {
        next = std::min(next, end_by_us_);
    }
    if (!server_frozen_) {
        next = std::min(next, server_->next_deadline_us());
    }
    for (const std::unique_ptr<Client>& client : clients_) {
        if (client->bot && !client->frozen) {
            next = std::min(next, client->transport->network_us(client->bot->next_deadline_us()));
        }
    }
    // A deadline in the past means now; time still has to move.
    return std::max(next, clock_.now_us() + 1);
}

void SwarmMatch::poll_server() {
    const bool arrived = server_transport_->fetch();
    if (server_frozen_ || (!arrived && server_->next_deadline_us() > clock_.now_us())) {
        return;
    }
    ++polls_;
    server_->poll();
    oracle_.hashed(
        kServerParty, server_->session().state_hash_tick(), server_->session().state_hash());
}

void SwarmMatch::poll_client(Client& client) {
    if (!client.bot) {
        return;
    }
    const bool arrived = client.transport->fetch();
    if (client.frozen || (!arrived && client.transport->network_us(client.bot->next_deadline_us()) >
                                          clock_.now_us())) {
        return;
    }
    ++polls_;
    client.bot->poll();
    const LockstepClient& session = client.bot->session();
    for (; client.seen_tick < session.confirmed_tick(); ++client.seen_tick) {
        const Tick tick = client.seen_tick + 1;
        const std::span<const SlotInput> inputs = session.confirmed_inputs(tick);
        if (!inputs.empty()) { // a snapshot stands for the others
            oracle_.confirmed(client.party(), tick, inputs);
        }
    }
    if (session.state_hash_tick() > 0) { // before, it may have no world yet
        oracle_.hashed(client.party(), session.state_hash_tick(), session.state_hash());
    }
}

void SwarmMatch::execute(const Step& step) {
    switch (step.kind) {
    case Step::Kind::arrive:
        start_client(*clients_[step.index]);
        break;
    case Step::Kind::begin:
        begin(scenario_.faults[step.index]);
        break;
    case Step::Kind::end:
        end(scenario_.faults[step.index]);
        break;
    case Step::Kind::heal:
        heal();
        break;
    }
}

void SwarmMatch::begin(const Fault& fault) {
    Client& client = *clients_[fault.client];
    const bool of_server = fault.kind == FaultKind::server_freeze;
    note(fmt::format("fault: {}{} for {} ms",
                     to_string(fault.kind),
                     of_server ? "" : fmt::format(" of client {}", client.index),
                     (fault.end_us - fault.begin_us) / 1000));
    switch (fault.kind) {
    case FaultKind::partition:
        ++figures_.partitions;
        network_.set_link_up(client.address, false);
        break;
    case FaultKind::deaf:
        ++figures_.partitions;
        ++figures_.one_way_partitions;
        network_.set_direction_up(kServerPeer, client.address, false);
        break;
    case FaultKind::mute:
        ++figures_.partitions;
        ++figures_.one_way_partitions;
        network_.set_direction_up(client.address, kServerPeer, false);
        break;
    case FaultKind::storm:
        ++figures_.storms;
        set_conditions(client, &fault.conditions);
        break;
    case FaultKind::freeze:
        ++figures_.freezes;
        client.frozen = true;
        break;
    case FaultKind::kill:
        ++figures_.kills;
        stop_client(client, "is killed");
        break;
    case FaultKind::leave:
        ++figures_.leaves;
        client.bot->leave();
        client.bot->poll();
        stop_client(client, "has left");
        break;
    case FaultKind::server_freeze:
        ++figures_.freezes;
        server_frozen_ = true;
        break;
    }
}

void SwarmMatch::end(const Fault& fault) {
    Client& client = *clients_[fault.client];
    switch (fault.kind) {
    case FaultKind::partition:
    case FaultKind::deaf:
    case FaultKind::mute:
        network_.set_link_up(client.address, true);
        break;
    case FaultKind::storm:
        set_conditions(client, nullptr);
        break;
    case FaultKind::freeze:
        client.frozen = false;
        break;
    case FaultKind::kill:
    case FaultKind::leave:
        start_client(client);
        return;
    case FaultKind::server_freeze:
        server_frozen_ = false;
        break;
    }
    note(fmt::format(
        "fault over: {}{}",
        to_string(fault.kind),
        fault.kind == FaultKind::server_freeze ? "" : fmt::format(" of client {}", client.index)));
}

void SwarmMatch::heal() {
    const MatchConfig& config = scenario_.config;
    const Tick left = config.ticks - server_->session().confirmed_tick();
    end_by_us_ = clock_.now_us() + left * tick_period_us(config) + kHealedSlackUs;
    note(fmt::format("healed, {} ticks are left", left));
    const LinkConditions good = good_conditions();
    for (const std::unique_ptr<Client>& client : clients_) {
        client->plan.up = client->plan.down = good;
        if (client->bot) {
            set_conditions(*client, nullptr);
        }
    }
}

void SwarmMatch::set_conditions(const Client& client, const LinkConditions* both) {
    network_.set_conditions(client.address, kServerPeer, both != nullptr ? *both : client.plan.up);
    network_.set_conditions(
        kServerPeer, client.address, both != nullptr ? *both : client.plan.down);
}

void SwarmMatch::start_client(Client& client) {
    client.address = next_address_++; // clients draw theirs at random
    client.seen_tick = 0;
    client.transport = std::make_unique<WatchedTransport>(
        network_.open(client.address),
        ClockSkew{client.plan.clock_offset_us, client.plan.clock_drift_ppm});
    set_conditions(client, nullptr);
    BotSettings settings;
    settings.token = client.index + 1;
    settings.seed = seed_ + client.index;
    settings.behaviour = client.plan.behaviour;
    client.bot = Bot::create(settings, *client.transport).value();
    client.plant = make_plant(settings_.plant, scenario_.config, *client.bot);
    if (client.plant) {
        client.transport->add_outgoing(client.plant.get());
        client.transport->add_incoming(client.plant.get());
    }
    client.tap = std::make_unique<ClientTap>(oracle_, client);
    client.transport->add_outgoing(client.tap.get());
    note(fmt::format("client {} starts at address {}", client.index, client.address));
    client.bot->listen([this, index = client.index](const SessionEvent& event) {
        note(fmt::format("client {}: {}", index, lockwind::describe(event)));
    });
}

void SwarmMatch::stop_client(Client& client, const std::string& how) {
    note(fmt::format("client {} {}", client.index, how));
    check_violations(party_name(client.party()), client.bot->session().counters().violations);
    client.bot.reset();
    client.plant.reset();
    client.tap.reset();
    client.transport.reset();
}

void SwarmMatch::check_server() {
    const LockstepServer& session = server_->session();
    if (!server_->ended() || session.end_reason() != EndReason::complete ||
        session.confirmed_tick() != settings_.ticks) {
        oracle_.fail(fmt::format("the server is at tick {} of {}, {}",
                                 session.confirmed_tick(),
                                 settings_.ticks,
                                 server_->ended() ? session.end_message() : "not ended"));
    }
    if (session.counters().desyncs > 0) {
        oracle_.fail(fmt::format("{} desyncs", session.counters().desyncs));
    }
    check_violations("the server", session.counters().violations);
}

void SwarmMatch::check_client(const Client& client) {
    if (!client.bot) {
        oracle_.fail(fmt::format("client {} never came", client.index));
        return;
    }
    const LockstepClient& session = client.bot->session();
    if (!session.ended() || session.end_reason() != EndReason::complete ||
        session.state_hash_tick() != settings_.ticks) {
        oracle_.fail(fmt::format("client {} is at tick {} of {}, {}",
                                 client.index,
                                 session.advanced_tick(),
                                 settings_.ticks,
                                 session.ended() ? session.end_message() : "not ended"));
    }
    if (client.bot->packets_malformed() > 0) {
        oracle_.fail(fmt::format("client {} could not read a packet", client.index));
    }
    check_violations(party_name(client.party()), session.counters().violations);
}

/// Whatever the network does, who keeps the rules is never taken for one who breaks them; but last
/// words come late, a player who comes back twice in a moment has to wait, and inputs that were cut
/// off for long are too old where others did not wait for them.
void SwarmMatch::check_violations(const std::string& who, const ViolationCounts& violations) {
    for (std::size_t index = 0; index < kViolationCount; ++index) {
        const auto violation = static_cast<Violation>(index);
        const bool harmless = violation == Violation::unknown_peer ||
                              violation == Violation::hello_flood ||
                              violation == Violation::input_too_old;
        if (!harmless && violations.of(violation) > 0) {
            oracle_.fail(fmt::format("{} counted {} x {}",
                                     who,
                                     violations.of(violation),
                                     lockwind::to_string(violation)));
        }
    }
}

SeedResult SwarmMatch::result() {
    Digest digest;
    if (server_) {
        const LockstepServer& session = server_->session();
        const LockstepServerCounters& counters = session.counters();
        figures_.ticks = session.confirmed_tick();
        figures_.hashes_agreed = counters.hashes_agreed;
        figures_.joins = counters.joins;
        figures_.drops = counters.drops;
        figures_.reconnects = counters.reconnects;
        figures_.stalls = counters.stalls;
        figures_.late_inputs = counters.late_inputs;
        figures_.substituted_inputs = counters.substituted_inputs;
        const LogFindings findings = oracle_.check_log(log_path_, scenario_.config);
        figures_.contacts = findings.contacts;
        digest.add(findings.last_hash);
    }
    figures_.packets_lost = network_.stats().lost;
    figures_.packets_duplicated = network_.stats().duplicated;
    figures_.packets_reordered = network_.stats().reordered;
    figures_.virtual_us = clock_.now_us();
    for (Tick tick = 0; tick <= settings_.ticks; ++tick) {
        digest.add(oracle_.hash_of(tick).value_or(0));
    }
    for (const std::string& line : timeline_) {
        digest.add(line);
    }
    digest.add(polls_);
    digest.add(figures_.packets_lost);
    return {seed_, figures_, digest.value(), oracle_.failures(), timeline_};
}

SwarmFigures& SwarmFigures::operator+=(const SwarmFigures& other) {
    ticks += other.ticks;
    contacts += other.contacts;
    hashes_agreed += other.hashes_agreed;
    joins += other.joins;
    drops += other.drops;
    reconnects += other.reconnects;
    stalls += other.stalls;
    late_inputs += other.late_inputs;
    substituted_inputs += other.substituted_inputs;
    late_joins += other.late_joins;
    partitions += other.partitions;
    one_way_partitions += other.one_way_partitions;
    storms += other.storms;
    freezes += other.freezes;
    kills += other.kills;
    leaves += other.leaves;
    packets_lost += other.packets_lost;
    packets_duplicated += other.packets_duplicated;
    packets_reordered += other.packets_reordered;
    virtual_us += other.virtual_us;
    return *this;
}

SeedResult run_seed(std::uint64_t seed, const SwarmSettings& settings) {
    return SwarmMatch(seed, settings).run();
}

} // namespace lockwind::swarm

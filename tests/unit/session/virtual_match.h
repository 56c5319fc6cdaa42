#pragma once

#include "session/input_buffer.h"
#include "tests/support/counter_simulation.h"
#include "tests/support/dice.h"

#include "lockwind/session.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace lockwind::testing {

struct Conditions {
    std::uint64_t latency_us = 2'000; // one way
    std::uint64_t jitter_us = 0;      // 0 .. this is added; reorders what is best-effort
    std::uint32_t loss_per_mille = 0; // of best-effort messages
    std::uint32_t duplicate_per_mille = 0;
    std::uint32_t late_per_mille = 0;          // best-effort, 300 ms more
    std::uint32_t reliable_loss_per_mille = 0; // lost with a connection, as it were
};

/// Messages under way, in virtual time. Reliable ones keep their order between two peers.
class VirtualNetwork {
public:
    struct Packet {
        std::uint64_t arrival_us = 0;
        std::uint64_t number = 0;
        PeerId from = 0;
        PeerId to = 0;
        Message message;
        bool operator>(const Packet& other) const {
            return std::pair(arrival_us, number) > std::pair(other.arrival_us, other.number);
        }
    };

    VirtualNetwork(std::uint64_t seed, const Conditions& given) : conditions(given), dice_(seed) {}

    void
    send(std::uint64_t now_us, PeerId from, PeerId to, Delivery delivery, const Message& what) {
        if (to == kAllPeers) {
            for (const PeerId peer : peers) {
                send(now_us, from, peer, delivery, what);
            }
            return;
        }
        if (cut.contains(from) || cut.contains(to) || deaf.contains(to)) {
            ++lost;
            return;
        }
        const bool best_effort = delivery == Delivery::best_effort;
        if (dice_.chance(best_effort ? conditions.loss_per_mille
                                     : conditions.reliable_loss_per_mille)) {
            ++lost;
            return;
        }
        const auto extra = extra_latency_us.find(from == kServerPeer ? to : from);
        const std::uint64_t latency_us =
            conditions.latency_us + (extra == extra_latency_us.end() ? 0 : extra->second);
        const bool doubled = best_effort && dice_.chance(conditions.duplicate_per_mille);
        duplicated += doubled ? 1U : 0U;
        for (int copy = 0; copy < (doubled ? 2 : 1); ++copy) {
            std::uint64_t arrival = now_us + latency_us + dice_.below(conditions.jitter_us + 1);
            if (best_effort && dice_.chance(conditions.late_per_mille)) {
                arrival += 300'000;
                ++late;
            }
            std::uint64_t& last = last_arrival_[{from, to}];
            reordered += best_effort && arrival < last ? 1U : 0U;
            if (!best_effort) {
                arrival = std::max(arrival, last_reliable_[{from, to}]);
                last_reliable_[{from, to}] = arrival;
            }
            last = std::max(last, arrival);
            packets_.push(Packet{arrival, number_++, from, to, what});
        }
    }

    std::optional<Packet> receive(std::uint64_t now_us) {
        if (packets_.empty() || packets_.top().arrival_us > now_us) {
            return std::nullopt;
        }
        Packet packet = packets_.top();
        packets_.pop();
        return packet;
    }

    std::uint64_t next_arrival_us() const {
        return packets_.empty() ? UINT64_MAX : packets_.top().arrival_us;
    }

    Conditions conditions;
    std::vector<PeerId> peers;                        // all clients
    std::map<PeerId, std::uint64_t> extra_latency_us; // of a client, one way
    std::set<PeerId> deaf;                            // peers whom nothing reaches
    std::set<PeerId> cut; // peers whom nothing reaches, and who reach nobody
    std::uint64_t lost = 0;
    std::uint64_t duplicated = 0;
    std::uint64_t late = 0;
    std::uint64_t reordered = 0;

private:
    Dice dice_;
    std::uint64_t number_ = 0;
    std::map<std::pair<PeerId, PeerId>, std::uint64_t> last_arrival_;
    std::map<std::pair<PeerId, PeerId>, std::uint64_t> last_reliable_;
    std::priority_queue<Packet, std::vector<Packet>, std::greater<>> packets_;
};

using Inputs = std::vector<SlotInput>;

/// A server with its simulation, doing what lockstep_server.h asks of a driver.
class ServerDriver {
public:
    ServerDriver(const LockstepServerSettings& settings, VirtualNetwork& network)
        : session(settings), simulation(settings.config.players), history(512), network_(network) {
        history.save(simulation, simulation.state_hash());
    }

    void pass(std::uint64_t now_us) {
        now_us_ = now_us;
        for (bool busy = true; busy;) {
            session.update(now_us);
            const std::vector<Request> requests = session.take_requests();
            failed_ = false;
            for (const Request& request : requests) {
                if (!failed_) {
                    execute(request);
                }
            }
            busy = !requests.empty();
        }
        history.discard_before(session.oldest_needed_tick());
    }

    std::size_t count(SessionEventKind kind) const {
        return static_cast<std::size_t>(
            std::count_if(events.begin(), events.end(), [kind](const SessionEvent& event) {
                return event.kind == kind;
            }));
    }
    const SessionEvent* find(SessionEventKind kind) const {
        for (const SessionEvent& event : events) {
            if (event.kind == kind) {
                return &event;
            }
        }
        return nullptr;
    }

    LockstepServer session;
    CounterSimulation simulation;
    StateHistory history;
    std::map<Tick, Inputs> log; // persisted
    std::map<Tick, std::uint64_t> chain;
    std::vector<SessionEvent> events;
    std::vector<BundleRequest> bundles;
    std::uint64_t confirmations_sent = 0;
    std::uint64_t confirmed_ticks_checked = 0;
    std::size_t snapshots = 0;

private:
    void execute(const Request& request) {
        if (const auto* send = std::get_if<SendRequest>(&request)) {
            check_persisted(send->message);
            network_.send(now_us_, kServerPeer, send->to, send->delivery, send->message);
        } else if (const auto* persist = std::get_if<PersistRequest>(&request)) {
            EXPECT_EQ(persist->tick, log.size() + 1);
            EXPECT_TRUE(chain.contains(persist->tick)); // its hash goes with it
            log[persist->tick] = persist->inputs;
        } else if (const auto* advance = std::get_if<AdvanceRequest>(&request)) {
            EXPECT_EQ(advance->tick, log.size() + 1);
            if (const Status stepped = simulation.advance(advance->inputs); !stepped) {
                session.fail(stepped.error().message, advance->tick - 1);
                failed_ = true;
                return;
            }
            chain[advance->tick] = simulation.state_hash();
            if (advance->hash_due) {
                history.save(simulation, simulation.state_hash());
            }
            session.advanced(advance->tick, simulation.state_hash(), now_us_);
        } else if (const auto* snapshot = std::get_if<SnapshotRequest>(&request)) {
            EXPECT_EQ(snapshot->tick, simulation.tick());
            ++snapshots;
            std::vector<std::byte> bytes;
            simulation.save(bytes);
            session.snapshot_saved(
                snapshot->slot, snapshot->tick, simulation.state_hash(), std::move(bytes));
        } else if (const auto* bundle = std::get_if<BundleRequest>(&request)) {
            EXPECT_NE(history.find(bundle->desync.agreed_tick), nullptr);
            for (Tick tick = bundle->desync.agreed_tick + 1; tick <= bundle->desync.bad_tick;
                 ++tick) {
                EXPECT_FALSE(session.confirmed_inputs(tick).empty());
            }
            bundles.push_back(*bundle);
        } else if (const auto* notify = std::get_if<NotifyRequest>(&request)) {
            events.push_back(notify->event);
        } else {
            ADD_FAILURE() << "a client's request";
        }
    }

    /// Nobody hears of a tick that is not in the log.
    void check_persisted(const Message& message) {
        const auto* confirmation = std::get_if<Confirmation>(&message);
        if (confirmation == nullptr) {
            return;
        }
        ++confirmations_sent;
        EXPECT_LE(confirmation->confirmed_tick, log.size());
        for (std::size_t i = 0; i < confirmation->ticks.size(); ++i) {
            const auto entry = log.find(confirmation->first_tick + i);
            ASSERT_NE(entry, log.end());
            EXPECT_EQ(entry->second, confirmation->ticks[i].inputs);
            ++confirmed_ticks_checked;
        }
    }

    VirtualNetwork& network_;
    std::uint64_t now_us_ = 0;
    bool failed_ = false; // the rest of the list is dropped
};

/// A player with its simulation, doing what lockstep_client.h asks of a driver.
class ClientDriver {
public:
    ClientDriver(PeerId own_peer, const LockstepClientSettings& settings, VirtualNetwork& network)
        : peer(own_peer), session(settings), dice_(settings.token * 977 + own_peer), history_(512),
          network_(network) {}

    void pass(std::uint64_t now_us) {
        now_us_ = now_us;
        for (bool busy = true; busy;) {
            while (gives_inputs && session.wants_input()) {
                SlotInput input;
                input.bytes[0] = static_cast<std::uint8_t>(dice_.next());
                input.bytes[1] = static_cast<std::uint8_t>(dice_.next());
                inputs_given[session.next_input_tick()] = input;
                session.add_local_input(session.next_input_tick(), input);
            }
            session.update(now_us);
            const std::vector<Request> requests = session.take_requests();
            for (const Request& request : requests) {
                execute(request);
            }
            busy = !requests.empty();
        }
        history_.discard_before(session.oldest_needed_tick());
    }

    std::size_t count(SessionEventKind kind) const {
        return static_cast<std::size_t>(
            std::count_if(events.begin(), events.end(), [kind](const SessionEvent& event) {
                return event.kind == kind;
            }));
    }

    PeerId peer;
    LockstepClient session;
    std::unique_ptr<CounterSimulation> simulation;
    std::map<Tick, std::uint64_t> chain;
    std::map<Tick, Inputs> seen; // confirmed ticks as they were stepped
    std::map<Tick, SlotInput> inputs_given;
    std::vector<SessionEvent> events;
    std::vector<Message> sent;
    std::vector<DesyncReportRequest> report_requests;

    bool alive = true;
    bool gives_inputs = true;
    bool sends_hashes = true;
    bool builds_another_world = false;
    bool keeps_sent = false;
    std::optional<Tick> corrupt_at;
    std::size_t report_size_bytes = 1000;

private:
    void execute(const Request& request) {
        if (const auto* send = std::get_if<SendRequest>(&request)) {
            if (sends_hashes || !std::holds_alternative<HashReport>(send->message)) {
                network_.send(now_us_, peer, send->to, send->delivery, send->message);
            }
            if (keeps_sent) {
                sent.push_back(send->message);
            }
        } else if (const auto* advance = std::get_if<AdvanceRequest>(&request)) {
            step(*advance);
        } else if (const auto* create = std::get_if<CreateRequest>(&request)) {
            simulation = std::make_unique<CounterSimulation>(create->config.players);
            if (builds_another_world) {
                simulation->corrupt("");
            }
            keep_only_present();
            session.created(simulation->state_hash(), simulation->input_size_bytes());
        } else if (const auto* restore = std::get_if<RestoreRequest>(&request)) {
            const Status loaded = simulation->load(restore->bytes);
            ASSERT_TRUE(loaded.ok()) << loaded.error().message;
            EXPECT_EQ(simulation->tick(), restore->tick);
            keep_only_present();
            session.restored(simulation->state_hash());
        } else if (const auto* report = std::get_if<DesyncReportRequest>(&request)) {
            report_requests.push_back(*report);
            EXPECT_NE(history_.find(report->desync.agreed_tick), nullptr);
            EXPECT_NE(history_.find(report->desync.bad_tick), nullptr);
            session.send_blob(BlobKind::desync_report,
                              std::vector<std::byte>(report_size_bytes, std::byte{0x5a}));
        } else if (const auto* notify = std::get_if<NotifyRequest>(&request)) {
            events.push_back(notify->event);
        } else {
            ADD_FAILURE() << "a server's request";
        }
    }

    void step(const AdvanceRequest& advance) {
        if (session.phase() != ClientPhase::playing) {
            return;
        }
        ASSERT_TRUE(simulation->advance(advance.inputs).ok());
        EXPECT_EQ(simulation->tick(), advance.tick);
        if (corrupt_at == advance.tick) {
            simulation->corrupt("");
        }
        if (const auto before = seen.find(advance.tick); before != seen.end()) {
            EXPECT_EQ(before->second, advance.inputs) << "a confirmed tick changed";
        }
        seen[advance.tick] = advance.inputs;
        chain[advance.tick] = simulation->state_hash();
        if (advance.hash_due) {
            history_.save(*simulation, simulation->state_hash());
        }
        session.advanced(advance.tick, simulation->state_hash());
    }

    void keep_only_present() {
        history_.clear();
        history_.save(*simulation, simulation->state_hash());
    }

    Dice dice_;
    StateHistory history_;
    VirtualNetwork& network_;
    std::uint64_t now_us_ = 0;
};

/// A server and its clients over a VirtualNetwork, in virtual time.
class VirtualMatch {
public:
    static LockstepServerSettings server_settings(std::uint32_t players, Tick ticks) {
        LockstepServerSettings settings;
        settings.config.match = "test";
        settings.config.mode = "lockstep";
        settings.config.players = players;
        settings.config.ticks = ticks;
        settings.sim_version = "v1";
        settings.build_info = "server build";
        settings.input_size_bytes = CounterSimulation::kInputSizeBytes;
        settings.initial_state_hash = CounterSimulation(players).state_hash();
        return settings;
    }

    static LockstepClientSettings client_settings(std::uint64_t token) {
        LockstepClientSettings settings;
        settings.token = token;
        settings.sim_version = "v1";
        settings.build_info = "client build";
        return settings;
    }

    explicit VirtualMatch(const LockstepServerSettings& settings,
                          const Conditions& conditions = {},
                          std::uint64_t seed = 1)
        : network(seed, conditions), server(settings, network) {}

    ClientDriver& add_client(std::uint64_t token) { return add_client(client_settings(token)); }
    ClientDriver& add_client(const LockstepClientSettings& settings) {
        network.peers.push_back(next_peer_);
        clients.push_back(std::make_unique<ClientDriver>(next_peer_++, settings, network));
        return *clients.back();
    }
    void add_clients(std::uint32_t count) {
        for (std::uint32_t i = 0; i < count; ++i) {
            add_client(100 + i);
        }
    }

    /// Until `done` holds; false where limit_us of virtual time passed before.
    bool run(const std::function<bool()>& done, std::uint64_t limit_us = 120'000'000) {
        const std::uint64_t end_us = now_us + limit_us;
        int passes_at_this_time = 0;
        while (true) {
            deliver();
            if (!server_stopped) {
                server.pass(now_us);
            }
            for (const auto& client : clients) {
                if (client->alive) {
                    client->pass(now_us);
                }
            }
            if (done()) {
                return true;
            }
            const std::uint64_t next_us = next_time_us();
            passes_at_this_time = next_us > now_us ? 0 : passes_at_this_time + 1;
            if (passes_at_this_time > 200) {
                ADD_FAILURE() << "a session asks for update() again and again at " << now_us;
                return false;
            }
            now_us = std::max(now_us, next_us);
            if (now_us > end_us) {
                now_us = end_us;
                return false;
            }
        }
    }
    bool run_to_end() {
        return run([this] { return server.session.ended(); });
    }
    bool run_to_tick(Tick tick) {
        return run([this, tick] { return server.session.confirmed_tick() >= tick; });
    }
    void run_for(std::uint64_t duration_us) {
        run([] { return false; }, duration_us);
    }

    /// From nobody in particular, or in somebody's name.
    void inject(PeerId from, const Message& message) {
        network.send(now_us, from, kServerPeer, Delivery::reliable, message);
    }

    /// The log, run straight through, gives the server's chain; every client's chain is part of it.
    void expect_one_chain() const {
        CounterSimulation straight(server.session.config().players);
        ASSERT_EQ(server.log.size(), server.chain.size());
        ASSERT_FALSE(server.log.empty());
        for (const auto& [tick, inputs] : server.log) {
            ASSERT_TRUE(straight.advance(inputs).ok());
            ASSERT_EQ(straight.state_hash(), server.chain.at(tick)) << "tick " << tick;
        }
        for (const auto& client : clients) {
            for (const auto& [tick, hash] : client->chain) {
                ASSERT_EQ(hash, server.chain.at(tick))
                    << "peer " << client->peer << " tick " << tick;
                ASSERT_EQ(client->seen.at(tick), server.log.at(tick));
            }
            EXPECT_EQ(client->session.counters().violations.total(), 0U);
        }
    }

    VirtualNetwork network;
    ServerDriver server;
    std::vector<std::unique_ptr<ClientDriver>> clients;
    std::uint64_t now_us = 1'000'000;
    bool server_stopped = false; // what arrives meanwhile waits in its sockets

private:
    void deliver() {
        for (; !server_stopped && !unheard_.empty(); unheard_.pop_front()) {
            server.session.receive(unheard_.front().from, unheard_.front().message, now_us);
        }
        while (const auto packet = network.receive(now_us)) {
            if (packet->to == kServerPeer && server_stopped) {
                unheard_.push_back(*packet);
            } else if (packet->to == kServerPeer) {
                server.session.receive(packet->from, packet->message, now_us);
            }
            for (const auto& client : clients) {
                const bool reached = client->alive && !network.cut.contains(client->peer);
                if (packet->to == client->peer && reached) {
                    client->session.receive(packet->from, packet->message, now_us);
                }
            }
        }
    }

    std::uint64_t next_time_us() const {
        std::uint64_t next = network.next_arrival_us();
        if (!server_stopped) {
            next = std::min(next, server.session.next_deadline_us());
        }
        for (const auto& client : clients) {
            if (client->alive) {
                next = std::min(next, client->session.next_deadline_us());
            }
        }
        return next;
    }

    PeerId next_peer_ = 11;
    std::deque<VirtualNetwork::Packet> unheard_;
};

} // namespace lockwind::testing

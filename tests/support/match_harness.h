#pragma once

#include "bot/bot.h"
#include "match/match_server.h"
#include "scene/scene.h"
#include "tests/support/temporary_folder.h"
#include "transport/sim/simulated_network.h"
#include "transport/sim/virtual_clock.h"

#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

namespace lockwind::testing {

/// The shipped server and bots in one process, over a simulated network in virtual time.
class SimulatedMatch {
public:
    struct Settings {
        std::string scene = "swarm_small";
        std::uint32_t players = 2;
        Tick ticks = 120;
        std::uint64_t seed = 1;
        std::uint32_t hash_interval_ticks = 1;
        StallPolicy stall_policy = StallPolicy::pause;
        LinkConditions link = {};
    };

    SimulatedMatch(const Settings& settings, const std::string& log_path)
        : network_(clock_, settings.seed, settings.link), transport_(network_.open(kServerPeer)) {
        MatchSettings match;
        match.config.match = "test";
        match.config.mode = "lockstep";
        match.config.scene_name = settings.scene;
        match.config.scene_text = load_scene_text(settings.scene).value();
        match.config.seed = settings.seed;
        match.config.players = settings.players;
        match.config.ticks = settings.ticks;
        match.config.hash_interval_ticks = settings.hash_interval_ticks;
        match.stall_policy = settings.stall_policy;
        match.log_path = log_path;
        Result<std::unique_ptr<MatchServer>> server = MatchServer::create(match, *transport_);
        EXPECT_TRUE(server.ok()) << server.error().message;
        server_ = std::move(server).value();
    }

    /// Adds a bot with the next address; returns its index.
    std::size_t add_bot(BotSettings settings) {
        Seat seat;
        seat.address = next_address_++;
        seat.transport = network_.open(seat.address);
        Result<std::unique_ptr<Bot>> bot = Bot::create(settings, *seat.transport);
        EXPECT_TRUE(bot.ok()) << bot.error().message;
        seat.bot = std::move(bot).value();
        seats_.push_back(std::move(seat));
        return seats_.size() - 1;
    }

    /// One fighting bot a player, with tokens 1, 2 ...
    void add_fighters(std::uint32_t count) {
        for (std::uint32_t index = 0; index < count; ++index) {
            BotSettings settings;
            settings.token = settings.seed = index + 1;
            add_bot(settings);
        }
    }

    /// The process is gone, without a word.
    void kill_bot(std::size_t index) {
        seats_[index].bot.reset();
        seats_[index].transport.reset();
    }

    /// Runs until `done()` or everybody has ended; false where that takes more than `seconds` of
    /// virtual time.
    template <class Done>
    bool run_until(Done done, std::uint64_t seconds = 120) {
        const std::uint64_t end_us = clock_.now_us() + seconds * 1'000'000;
        while (!done() && !all_ended()) {
            if (clock_.now_us() >= end_us) {
                return false;
            }
            clock_.advance_to(std::max(clock_.now_us(), std::min(next_us(), end_us)));
            server_->poll();
            for (Seat& seat : seats_) {
                if (seat.bot) {
                    seat.bot->poll();
                }
            }
        }
        return true;
    }
    bool run() {
        return run_until([] { return false; });
    }

    MatchServer& server() { return *server_; }
    Bot& bot(std::size_t index) { return *seats_[index].bot; }
    SimulatedNetwork& network() { return network_; }
    std::uint32_t address(std::size_t index) const { return seats_[index].address; }

private:
    struct Seat {
        std::uint32_t address = 0;
        std::unique_ptr<Transport> transport;
        std::unique_ptr<Bot> bot;
    };

    bool all_ended() const {
        return server_->ended() && std::all_of(seats_.begin(), seats_.end(), [](const Seat& seat) {
                   return !seat.bot || seat.bot->ended();
               });
    }

    std::uint64_t next_us() const {
        std::uint64_t next =
            std::min(server_->next_deadline_us(), network_.next_arrival_us().value_or(UINT64_MAX));
        for (const Seat& seat : seats_) {
            next = std::min(next, seat.bot ? seat.bot->next_deadline_us() : UINT64_MAX);
        }
        // A deadline in the past means now; time still has to move.
        return std::max(next, clock_.now_us() + 1);
    }

    VirtualClock clock_;
    SimulatedNetwork network_;
    std::unique_ptr<Transport> transport_;
    std::unique_ptr<MatchServer> server_;
    std::vector<Seat> seats_;
    std::uint32_t next_address_ = 1;
};

} // namespace lockwind::testing

#include "bots_command.h"

#include "bot/bot.h"
#include "bots_report.h"
#include "program/console.h"
#include "program/exit_code.h"
#include "program/progress.h"
#include "program/stop_signal.h"
#include "transport/dds/dds_participant.h"
#include "transport/dds/dds_transport.h"
#include "transport/sim/conditioned_transport.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <random>
#include <vector>

namespace lockwind {

namespace {

/// Longest sleep, so that a stop signal is heard soon.
constexpr std::uint64_t kWaitUsMax = 50'000;

/// One bot with the endpoint that it borrows.
struct Seat {
    std::unique_ptr<Transport> transport;
    ConditionedTransport* conditioned = nullptr; // the transport, where --net is given
    std::unique_ptr<Bot> bot;
};

int fail(int code, const std::string& message) {
    say_error(message);
    return code;
}

/// Mixes a bot's number into the seed (SplitMix64's finalizer); never 0.
std::uint64_t draw(std::uint64_t seed, std::uint64_t purpose) {
    std::uint64_t state = seed + (purpose + 1) * 0x9e3779b97f4a7c15ULL;
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9ULL;
    state = (state ^ (state >> 27)) * 0x94d049bb133111ebULL;
    return std::max<std::uint64_t>(state ^ (state >> 31), 1);
}

/// A peer's address must be its own even where two processes share a seed.
PeerId draw_address(std::random_device& device) {
    PeerId address = 0;
    while (address == kServerPeer || address == kAllPeers) {
        address = device();
    }
    return address;
}

/// What the flags ask of every bot, or the Error of the first wrong one.
Result<BotSettings> bot_settings(const BotsOptions& options) {
    BotSettings settings;
    settings.behaviour = options.behaviour;
    settings.connect_timeout_ms = options.connect_timeout_s * 1000;
    settings.corrupt_phase = options.corrupt_phase;
    if (options.corrupt) {
        const Result<Corruption> corruption = parse_corruption(*options.corrupt);
        if (!corruption) {
            return corruption.error();
        }
        settings.corruption = corruption.value();
    }
    return settings;
}

Status take_seats(const BotsOptions& options,
                  BotSettings settings,
                  const std::optional<LinkConditions>& conditions,
                  const std::shared_ptr<DdsParticipant>& participant,
                  std::vector<Seat>& seats) {
    std::random_device device;
    const std::uint64_t seed = options.seed.value_or((std::uint64_t{device()} << 32U) | device());
    for (std::uint32_t index = 0; index < options.count; ++index) {
        Result<std::unique_ptr<DdsTransport>> opened =
            DdsTransport::open(participant, options.match, draw_address(device));
        if (!opened) {
            return opened.error();
        }
        Seat seat;
        seat.transport = std::move(opened).value();
        if (conditions) {
            auto conditioned = std::make_unique<ConditionedTransport>(
                std::move(seat.transport), *conditions, draw(~seed, index));
            seat.conditioned = conditioned.get();
            seat.transport = std::move(conditioned);
        }
        settings.seed = settings.token = draw(seed, index);
        Result<std::unique_ptr<Bot>> bot = Bot::create(settings, *seat.transport);
        if (!bot) {
            return bot.error();
        }
        seat.bot = std::move(bot).value();
        seat.bot->listen([](const SessionEvent& event) { say_info(describe(event)); });
        seats.push_back(std::move(seat));
    }
    return Success{};
}

void play(std::vector<Seat>& seats, DdsParticipant& participant) {
    bool stopping = false;
    std::unique_ptr<Progress> progress;
    while (!std::all_of(seats.begin(), seats.end(), [](auto& seat) { return seat.bot->ended(); })) {
        std::uint64_t deadline_us = DdsParticipant::clock_us() + kWaitUsMax;
        for (const Seat& seat : seats) {
            deadline_us = std::min(deadline_us, seat.bot->next_deadline_us());
            if (seat.conditioned != nullptr) {
                deadline_us = std::min(deadline_us, seat.conditioned->next_due_us());
            }
        }
        participant.wait_until(deadline_us);
        const bool leave_now = stop_requested() && !stopping;
        stopping = stopping || leave_now;
        for (const Seat& seat : seats) {
            if (leave_now) {
                seat.bot->leave();
            }
            seat.bot->poll();
        }
        const LockstepClient& first = seats.front().bot->session();
        if (!progress && first.phase() == ClientPhase::playing) {
            progress = std::make_unique<Progress>("tick", first.config().ticks);
        }
        if (progress) {
            progress->update(first.advanced_tick());
        }
    }
}

std::vector<const Bot*> bots_of(const std::vector<Seat>& seats) {
    std::vector<const Bot*> bots;
    bots.reserve(seats.size());
    for (const Seat& seat : seats) {
        bots.push_back(seat.bot.get());
    }
    return bots;
}

int exit_code_of(const std::vector<const Bot*>& bots, const std::string& place) {
    int code = kExitDone;
    for (const Bot* bot : bots) {
        const LockstepClient& session = bot->session();
        if (session.counters().desyncs > 0) {
            return kExitDiverged;
        }
        if (session.end_reason() == EndReason::failed ||
            session.end_reason() == EndReason::dropped) {
            code = fail(kExitNetwork,
                        bot->found_server() ? session.end_message()
                                            : "no server was found of " + place);
        }
    }
    return code;
}

} // namespace

int run_bots(const BotsOptions& options) {
    catch_stop_signals();
    const Result<BotSettings> settings = bot_settings(options);
    if (!settings) {
        return fail(kExitUsage, settings.error().message);
    }
    std::optional<LinkConditions> conditions;
    if (options.net) {
        const Result<LinkConditions> parsed = parse_link_conditions(*options.net);
        if (!parsed) {
            return fail(kExitUsage, "--net: " + parsed.error().message);
        }
        conditions = parsed.value();
    }
    DdsSettings dds;
    dds.role = DdsRole::client;
    dds.domain = options.domain;
    dds.server_address = options.server;
    const Result<std::shared_ptr<DdsParticipant>> participant = DdsParticipant::open(dds);
    if (!participant) {
        return fail(kExitNetwork, participant.error().message);
    }
    std::vector<Seat> seats;
    const Status seated =
        take_seats(options, settings.value(), conditions, participant.value(), seats);
    if (!seated) {
        return fail(options.behaviour.starts_with("log:") ? kExitFile : kExitUsage,
                    seated.error().message);
    }
    const std::string place =
        fmt::format("match '{}' at {}, domain {}", options.match, options.server, options.domain);
    say_info("looking for " + place);
    play(seats, *participant.value());
    const std::vector<const Bot*> bots = bots_of(seats);
    fmt::print("{}", options.json ? bots_json(bots) : bots_text(bots));
    std::fflush(stdout);
    return exit_code_of(bots, place);
}

} // namespace lockwind

#include "match/match_server.h"
#include "options.h"
#include "program/console.h"
#include "program/exit_code.h"
#include "program/output_path.h"
#include "program/progress.h"
#include "program/stop_signal.h"
#include "report.h"
#include "scene/scene.h"
#include "transport/dds/dds_participant.h"
#include "transport/dds/dds_transport.h"

#include <chrono>
#include <cstdio>
#include <exception>
#include <fmt/chrono.h>
#include <fmt/format.h>

namespace lockwind {

namespace {

/// Longest sleep, so that a stop signal is heard soon.
constexpr std::uint64_t kWaitUsMax = 50'000;

int fail(int code, const std::string& message) {
    say_error(message);
    return code;
}

std::string default_log_path(const MatchConfig& config) {
    return fmt::format("lockwind-{}-{:%Y%m%dT%H%M%SZ}.log",
                       config.match,
                       fmt::gmtime(std::chrono::system_clock::now()));
}

void play(MatchServer& match, Transport& transport) {
    const MatchConfig& config = match.session().config();
    Progress progress("tick", config.ticks);
    bool stopping = false;
    while (!match.ended()) {
        transport.wait_until(std::min(match.next_deadline_us(), transport.clock_us() + kWaitUsMax));
        if (stop_requested() && !stopping) {
            stopping = true;
            match.stop("stopped by a signal");
        }
        match.poll();
        progress.update(match.session().advanced_tick(),
                        fmt::format("{} contacts, {} bodies",
                                    match.simulation().world().counts().contacts,
                                    match.simulation().world().body_count()));
    }
}

int exit_code_of(const MatchServer& match) {
    if (match.session().counters().desyncs > 0) {
        return kExitDiverged;
    }
    if (!match.log_trouble().empty()) {
        return fail(kExitFile, match.log_trouble());
    }
    if (match.session().end_reason() == EndReason::failed) {
        return fail(kExitNetwork, match.session().end_message());
    }
    return kExitDone;
}

int run(ServerOptions options) {
    catch_stop_signals(); // a stop during the preparations ends the match when it begins
    Result<std::string> scene = load_scene_text(options.config.scene_name);
    if (!scene) {
        return fail(kExitFile, scene.error().message);
    }
    options.config.scene_text = std::move(scene).value();
    if (const Status valid = MatchServer::check_settings(options.config); !valid) {
        return fail(kExitUsage, valid.error().message);
    }
    DdsSettings dds;
    dds.role = DdsRole::server;
    dds.domain = options.domain;
    dds.interface = options.listen;
    Result<std::shared_ptr<DdsParticipant>> participant = DdsParticipant::open(dds);
    if (!participant) {
        return fail(kExitNetwork, participant.error().message);
    }
    Result<std::unique_ptr<DdsTransport>> transport =
        DdsTransport::open(participant.value(), options.config.match, kServerPeer);
    if (!transport) {
        return fail(kExitUsage, transport.error().message);
    }
    if (options.log_path.empty()) {
        options.log_path = default_log_path(options.config);
    }
    if (const auto trouble = output_path_trouble("--log", options.log_path, Existing::refused)) {
        return *trouble;
    }
    MatchSettings settings;
    settings.config = options.config;
    settings.join_timeout_ms = options.join_timeout_s * 1000;
    settings.log_path = options.log_path;
    Result<std::unique_ptr<MatchServer>> match = MatchServer::create(settings, *transport.value());
    if (!match) {
        return fail(kExitFile, match.error().message);
    }
    match.value()->listen([](const SessionEvent& event) { say_info(describe(event)); });
    say_info(fmt::format("match '{}' on domain {}: waiting for {} players",
                         options.config.match,
                         options.domain,
                         options.config.players));
    play(*match.value(), *transport.value());
    if (options.json) {
        fmt::print("{}\n", report_json(*match.value()));
    } else {
        fmt::print("{}", report_text(*match.value()));
    }
    std::fflush(stdout);
    return exit_code_of(*match.value());
}

} // namespace

} // namespace lockwind

int main(int argc, char** argv) try {
    lockwind::set_up_messages();
    const lockwind::ParsedOptions parsed = lockwind::parse_options(argc, argv);
    return parsed.options ? lockwind::run(*parsed.options) : parsed.exit_code;
} catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return lockwind::kExitFile;
}

#include "tests/support/match_harness.h"

#include <cstdio>
#include <gtest/gtest.h>

// The shipped server and four bots play `arena` over bad links in virtual time and leave their log:
// what scripts/check_architectures carries from one architecture to the next.
// Usage: record_match FILE [TICKS]
int main(int argc, char** argv) try {
    testing::InitGoogleTest(&argc, argv);
    if (argc < 2 || argc > 3) {
        std::fprintf(stderr, "usage: record_match FILE [TICKS]\n");
        return 2;
    }
    lockwind::testing::SimulatedMatch::Settings settings;
    settings.scene = "arena";
    settings.players = 4;
    settings.ticks = argc > 2 ? std::stoul(argv[2]) : lockwind::kKeyframeIntervalTicks + 60;
    settings.link.latency_us = 40'000;
    settings.link.jitter_us = 20'000;
    settings.link.loss_ppm = 50'000;
    settings.link.reorder_ppm = 20'000;
    lockwind::testing::SimulatedMatch match(settings, argv[1]);
    match.add_fighters(settings.players);
    const bool ended = match.run();
    const lockwind::LockstepServer& server = match.server().session();
    std::printf("%llu ticks, state hash %s, contacts up to %llu, %llu created\n",
                static_cast<unsigned long long>(server.state_hash_tick()),
                lockwind::hash_text(server.state_hash()).c_str(),
                static_cast<unsigned long long>(match.server().figures().contacts.max()),
                static_cast<unsigned long long>(match.server().figures().created));
    const bool good =
        ended && server.state_hash_tick() == settings.ticks && server.counters().desyncs == 0 &&
        match.server().figures().contacts.max() > 0 && match.server().figures().created > 0;
    return good ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 3;
}

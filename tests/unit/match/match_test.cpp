#include "forensics/diff.h"
#include "forensics/match_simulation.h"
#include "forensics/replay.h"
#include "forensics/rerecord.h"
#include "log/log_codec.h"
#include "log/log_writer.h"
#include "tests/support/full_disk.h"
#include "tests/support/match_harness.h"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace lockwind {
namespace {

using testing::SimulatedMatch;
using testing::TemporaryFolder;

ReplayResult verify(const std::string& path) {
    Result<LogReader> log = LogReader::open(path);
    EXPECT_TRUE(log.ok()) << log.error().message;
    const MatchConfig& config = log.value().header().config;
    const Result<WorldDefinition> definition = parse_scene(
        config.scene_text, config.scene_name, {config.players, config.seed, config.tick_rate_hz});
    std::unique_ptr<WorldSimulation> simulation =
        WorldSimulation::create(definition.value()).value();
    ReplayOptions options;
    options.verify = true;
    return replay(log.value(), *simulation, options).value();
}

TEST(Match, AllPartiesAndTheReplayReachTheSameState) {
    TemporaryFolder folder;
    SimulatedMatch match({.players = 3, .ticks = 300}, folder.file("match.log"));
    match.add_fighters(3);
    ASSERT_TRUE(match.run());

    const LockstepServer& server = match.server().session();
    EXPECT_EQ(server.end_reason(), EndReason::complete) << server.end_message();
    EXPECT_EQ(server.state_hash_tick(), 300U);
    for (std::size_t index = 0; index < 3; ++index) {
        EXPECT_EQ(match.bot(index).session().state_hash_tick(), 300U);
        EXPECT_EQ(match.bot(index).session().state_hash(), server.state_hash());
    }
    const ReplayResult replayed = verify(folder.file("match.log"));
    EXPECT_FALSE(replayed.first_bad_tick.has_value());
    EXPECT_GE(replayed.hashes_checked, 300U);
    EXPECT_EQ(replayed.state_hash, server.state_hash());
    EXPECT_EQ(replayed.ended, LogEnd::summary);

    EXPECT_GE(server.counters().hashes_agreed, 3 * 300U);
    EXPECT_GT(match.server().figures().contacts.max(), 0U);
    EXPECT_GT(match.server().figures().created, 0U) << "nobody shot";
    EXPECT_GT(match.server().figures().destroyed, 0U);
}

RerecordResult record_again(const std::string& from, const std::string& to) {
    LogReader log = LogReader::open(from).value();
    const std::unique_ptr<WorldSimulation> simulation =
        create_match_simulation(log.header().config).value();
    const Result<RerecordResult> result = rerecord(log, *simulation, to);
    EXPECT_TRUE(result.ok()) << result.error().message;
    return result.value();
}

std::string content(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Match, ALogRecordedAgainHasTheSameBytes) {
    TemporaryFolder folder;
    const std::string path = folder.file("match.log");
    // Past a keyframe, with a drop, a reconnection and ticks without a hash.
    SimulatedMatch match({.ticks = kKeyframeIntervalTicks + 30, .hash_interval_ticks = 7}, path);
    match.add_fighters(2);
    ASSERT_TRUE(match.run_until([&] { return match.server().session().confirmed_tick() > 100; }));
    match.kill_bot(1);
    ASSERT_TRUE(match.run_until([&] { return match.server().session().counters().drops == 1; }));
    BotSettings again;
    again.token = again.seed = 2;
    match.add_bot(again);
    ASSERT_TRUE(match.run());
    EXPECT_GT(match.server().figures().created, 0U) << "no events in the log";

    const RerecordResult result = record_again(path, folder.file("again.log"));
    EXPECT_EQ(result.first_different_byte, std::nullopt);
    EXPECT_EQ(result.ticks, kKeyframeIntervalTicks + 30);
    EXPECT_EQ(result.ended, LogEnd::summary);
    EXPECT_EQ(rerecord_exit_code(result), 0);
    EXPECT_TRUE(content(path) == content(folder.file("again.log")));

    // An existing file is never overwritten.
    LogReader log = LogReader::open(path).value();
    EXPECT_FALSE(rerecord(log, *create_match_simulation(log.header().config).value(), path).ok());
}

TEST(Match, ALogWithAnotherHashIsRecordedAgainWithTheRightOne) {
    TemporaryFolder folder;
    const std::string path = folder.file("false.log");
    const MatchConfig config =
        SimulatedMatch({.ticks = 1}, folder.file("true.log")).server().session().config();
    std::unique_ptr<WorldSimulation> simulation = create_match_simulation(config).value();
    LogHeader header;
    header.config = config;
    header.input_size_bytes = simulation->input_size_bytes();
    const std::unique_ptr<LogWriter> log = LogWriter::create(path, header).value();
    ASSERT_TRUE(log->write_start_hash(simulation->state_hash()));
    const std::uint64_t good_bytes = log->size_bytes();
    const std::vector<SlotInput> inputs(config.players);
    ASSERT_TRUE(simulation->advance(inputs));
    ASSERT_TRUE(log->write_tick(1, inputs, simulation->state_hash() + 1));

    const RerecordResult result = record_again(path, folder.file("again.log"));
    ASSERT_TRUE(result.first_different_byte.has_value());
    EXPECT_GT(*result.first_different_byte, good_bytes);
    EXPECT_EQ(result.bytes, log->size_bytes());
    EXPECT_EQ(rerecord_exit_code(result), 1);
    EXPECT_FALSE(verify(folder.file("again.log")).first_bad_tick.has_value());
}

TEST(Match, ARecordOfASlotThatTheMatchHasNotIsNotRecordedAgain) {
    TemporaryFolder folder;
    LogHeader header;
    header.config =
        SimulatedMatch({.ticks = 1}, folder.file("true.log")).server().session().config();
    header.config.players = 8;
    header.input_size_bytes = create_match_simulation(header.config).value()->input_size_bytes();
    const std::string path = folder.file("forged.log");
    {
        std::string payload = encode_header(header);
        RecordWriter file = RecordWriter::create(path, FileKind::log, payload).value();
        ASSERT_TRUE(file.write(encode_record(JoinRecord{1, 63, false, ""}, 1)));
    }
    LogReader log = LogReader::open(path).value();
    const std::unique_ptr<WorldSimulation> simulation =
        create_match_simulation(header.config).value();
    const Result<RerecordResult> result = rerecord(log, *simulation, folder.file("again.log"));
    ASSERT_FALSE(result.ok());
    EXPECT_NE(result.error().message.find("slot 63"), std::string::npos) << result.error().message;
}

TEST(Match, AnotherSeedGivesAnotherState) {
    TemporaryFolder folder;
    std::vector<std::uint64_t> hashes;
    for (const std::uint64_t seed : {1U, 2U}) {
        SimulatedMatch match({.ticks = 60, .seed = seed},
                             folder.file(std::to_string(seed) + ".log"));
        match.add_fighters(2);
        ASSERT_TRUE(match.run());
        hashes.push_back(match.server().session().state_hash());
    }
    EXPECT_NE(hashes[0], hashes[1]);
}

TEST(Match, HoldsUnderLossJitterReorderingAndDuplication) {
    TemporaryFolder folder;
    LinkConditions link;
    link.latency_us = 40'000;
    link.jitter_us = 20'000;
    link.loss_ppm = 50'000;
    link.duplicate_ppm = 20'000;
    link.reorder_ppm = 20'000;
    SimulatedMatch match({.players = 4, .ticks = 300, .link = link}, folder.file("match.log"));
    match.add_fighters(4);
    ASSERT_TRUE(match.run());
    EXPECT_EQ(match.server().session().end_reason(), EndReason::complete);
    EXPECT_EQ(match.server().session().counters().desyncs, 0U);
    EXPECT_EQ(match.server().session().confirmed_tick(), 300U);
    EXPECT_FALSE(verify(folder.file("match.log")).first_bad_tick.has_value());
}

TEST(Match, WritesEveryTickBeforeAnybodyHearsOfIt) {
    TemporaryFolder folder;
    const std::string path = folder.file("match.log");
    SimulatedMatch match({.ticks = 90}, path);
    match.add_fighters(2);
    Tick heard = 0;
    std::uint64_t looks = 0;
    ASSERT_TRUE(match.run_until([&] {
        const Tick newest = std::max(match.bot(0).session().confirmed_tick(),
                                     match.bot(1).session().confirmed_tick());
        if (newest > heard) {
            heard = newest;
            ++looks;
            Result<LogReader> log = LogReader::open(path);
            Tick written = 0;
            while (std::optional<LogRecord> record = log.value().next()) {
                if (const auto* tick = std::get_if<TickRecord>(&*record)) {
                    written = tick->tick;
                }
            }
            EXPECT_GE(written, heard);
        }
        return false;
    }));
    EXPECT_EQ(heard, 90U);
    EXPECT_GT(looks, 45U);
}

TEST(Match, AFullDiskEndsTheMatchAsItStandsInTheLog) {
    TemporaryFolder folder;
    const std::string path = folder.file("match.log");
    SimulatedMatch match({.ticks = 600}, path);
    match.add_fighters(2);
    ASSERT_TRUE(match.run_until([&] { return match.server().session().confirmed_tick() >= 100; }));
    {
        const testing::FullDisk full(std::filesystem::file_size(path) + 400);
        ASSERT_TRUE(match.run());
    }
    const LockstepServer& server = match.server().session();
    EXPECT_NE(match.server().log_trouble(), "");
    EXPECT_EQ(server.end_reason(), EndReason::failed);
    EXPECT_NE(server.end_message().find(path), std::string::npos) << server.end_message();
    EXPECT_GT(server.confirmed_tick(), 100U);
    const ReplayResult replayed = verify(path);
    EXPECT_EQ(replayed.ticks, server.confirmed_tick());
    EXPECT_EQ(server.state_hash_tick(), server.confirmed_tick());
    EXPECT_EQ(replayed.state_hash, server.state_hash());
    EXPECT_FALSE(replayed.first_bad_tick.has_value());
    for (std::size_t index = 0; index < 2; ++index) {
        EXPECT_LE(match.bot(index).session().confirmed_tick(), server.confirmed_tick());
    }
}

TEST(Match, ASummaryThatCannotBeWrittenIsTold) {
    TemporaryFolder folder;
    const std::string path = folder.file("match.log");
    SimulatedMatch match({.ticks = 60}, path);
    match.add_fighters(2);
    ASSERT_TRUE(match.run_until([&] { return match.server().session().confirmed_tick() >= 60; }));
    {
        const testing::FullDisk full(std::filesystem::file_size(path) + 8);
        ASSERT_TRUE(match.run());
    }
    EXPECT_EQ(match.server().session().end_reason(), EndReason::complete);
    EXPECT_NE(match.server().log_trouble().find(path), std::string::npos);
    EXPECT_EQ(verify(path).ended, LogEnd::interrupted);
}

TEST(Match, AKilledBotComesBackIntoItsSlotAndReachesTheSameState) {
    TemporaryFolder folder;
    SimulatedMatch match({.players = 2, .ticks = 900}, folder.file("match.log"));
    match.add_fighters(2);
    const LockstepServer& server = match.server().session();
    ASSERT_TRUE(match.run_until([&] { return server.confirmed_tick() >= 100; }));
    const Slot slot = match.bot(1).session().slot();
    match.kill_bot(1);
    ASSERT_TRUE(match.run_until([&] { return server.counters().drops == 1; }));

    BotSettings again;
    again.token = again.seed = 2;
    const std::size_t back = match.add_bot(again);
    ASSERT_TRUE(match.run());
    EXPECT_EQ(server.counters().reconnects, 1U);
    EXPECT_EQ(match.bot(back).session().slot(), slot);
    EXPECT_EQ(match.bot(back).session().state_hash_tick(), 900U);
    EXPECT_EQ(match.bot(back).session().state_hash(), server.state_hash());
    EXPECT_EQ(server.counters().desyncs, 0U);
    EXPECT_FALSE(verify(folder.file("match.log")).first_bad_tick.has_value());
}

std::size_t desyncs_logged(const std::string& path) {
    LogReader log = LogReader::open(path).value();
    std::size_t count = 0;
    while (const std::optional<LogRecord> record = log.next()) {
        count += std::holds_alternative<DesyncRecord>(*record) ? 1U : 0U;
    }
    EXPECT_EQ(log.ended(), LogEnd::summary);
    return count;
}

DiffResult desync_of(SimulatedMatch& match) {
    EXPECT_TRUE(match.run());
    EXPECT_EQ(match.server().session().end_reason(), EndReason::desync);
    EXPECT_EQ(match.server().desyncs().size(), 1U);
    const DesyncOutcome& outcome = match.server().desyncs().front();
    EXPECT_EQ(outcome.problem, "");
    return diff_bundle(read_bundle(outcome.bundle).value());
}

TEST(Match, ADesyncRightAfterAReconnectBetweenDueHashesIsTraced) {
    TemporaryFolder folder;
    SimulatedMatch match({.ticks = 600, .hash_interval_ticks = 30}, folder.file("match.log"));
    match.add_fighters(2);
    const LockstepServer& server = match.server().session();
    ASSERT_TRUE(match.run_until([&] { return server.confirmed_tick() >= 100; }));
    match.kill_bot(1);
    ASSERT_TRUE(match.run_until([&] { return server.counters().drops == 1; }));
    BotSettings again;
    again.token = 2;
    again.corrupt_phase = "solve";
    match.add_bot(again);
    const DiffResult diff = desync_of(match);
    const DesyncOutcome& outcome = match.server().desyncs().front();
    EXPECT_EQ(server.counters().reconnects, 1U);
    EXPECT_NE(outcome.desync.agreed_tick % 30, 0U);
    EXPECT_EQ(outcome.verdict, "nondeterminism");
    EXPECT_EQ(diff.first_tick, outcome.desync.agreed_tick + 1);
    EXPECT_EQ(diff.phase, "solve");
}

TEST(Match, CorruptedStateIsCaughtAtItsTickAndTracedToItsField) {
    TemporaryFolder folder;
    for (const std::uint32_t interval : {1U, 8U}) {
        SimulatedMatch match({.ticks = 300, .hash_interval_ticks = interval},
                             folder.file(std::to_string(interval) + ".log"));
        match.add_fighters(1);
        BotSettings corrupted;
        corrupted.token = 2;
        corrupted.corruption = Corruption{1, 104, "body.position.y"};
        match.add_bot(corrupted);
        const DiffResult diff = desync_of(match);
        EXPECT_EQ(match.server().desyncs().front().desync.bad_tick, 104U);
        EXPECT_EQ(match.server().desyncs().front().verdict, "corrupted_state");
        EXPECT_EQ(diff.first_tick, 104U);
        EXPECT_EQ(desyncs_logged(folder.file(std::to_string(interval) + ".log")), 1U);
        EXPECT_EQ(diff.phase, "outside_step");
        EXPECT_EQ(diff.section, "body");
        EXPECT_EQ(diff.fields.at(0).field, "position.y");
    }
}

TEST(Match, AFaultInAPhaseIsTracedToThatPhase) {
    TemporaryFolder folder;
    for (const std::string_view phase : World::phases()) {
        SimulatedMatch match({.ticks = 120}, folder.file(std::string(phase) + ".log"));
        match.add_fighters(1);
        BotSettings faulty;
        faulty.token = 2;
        faulty.corrupt_phase = phase;
        match.add_bot(faulty);
        const DiffResult diff = desync_of(match);
        EXPECT_EQ(match.server().desyncs().front().verdict, "nondeterminism") << phase;
        EXPECT_EQ(match.server().desyncs().front().desync.bad_tick, 1U) << phase;
        EXPECT_EQ(diff.first_tick, 1U);
        EXPECT_EQ(diff.phase, phase);
        EXPECT_EQ(diff.section, "body");
        EXPECT_EQ(diff.fields.at(0).field, "linear_velocity.x");
    }
}

TEST(Match, RefusesAnExistingLogAndAWrongConfiguration) {
    TemporaryFolder folder;
    SimulatedMatch match({.ticks = 1}, folder.file("match.log"));
    VirtualClock clock;
    SimulatedNetwork network(clock, 1);
    const std::unique_ptr<Transport> transport = network.open(kServerPeer);
    MatchSettings settings;
    settings.config = match.server().session().config();
    settings.log_path = folder.file("match.log");
    const Result<std::unique_ptr<MatchServer>> twice = MatchServer::create(settings, *transport);
    ASSERT_FALSE(twice.ok());
    EXPECT_NE(twice.error().message.find("match.log"), std::string::npos);

    settings.config.players = 1000;
    EXPECT_FALSE(MatchServer::check_settings(settings.config).ok());
    settings.config.players = 2;
    settings.config.tick_rate_hz = 0;
    EXPECT_FALSE(MatchServer::check_settings(settings.config).ok());
}

} // namespace
} // namespace lockwind

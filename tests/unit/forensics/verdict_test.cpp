#include "tests/unit/forensics/desync_fixture.h"

#include <random>

namespace lockwind::test {
namespace {

class VerdictTest : public LogFixture {};

/// From tick 5 on, phase "move" adds one to a body's velocity.
void faulty_move(FakeSimulation& simulation, std::uint32_t phase) {
    if (phase == 1 && simulation.tick() >= 4) {
        simulation.row<FakeBody>(body, 7).velocity[1] += 1;
    }
}

TEST_F(VerdictTest, CallsAOneTimeChangeCorruptedState) {
    Desync desync;
    desync.play([](FakeSimulation& client) { client.row<FakeBody>(body, 3).position[1] += 5; });
    desync.answer();
    const Bundle bundle = desync.judge();
    EXPECT_EQ(bundle.verdict, Verdict::corrupted_state);
    EXPECT_FALSE(bundle.server_at_fault);
    const DiffResult diff = diff_bundle(bundle);
    EXPECT_FALSE(diff.same);
    EXPECT_EQ(diff.first_tick, Desync::kBadTick);
    EXPECT_EQ(diff.phase, "outside_step");
    EXPECT_EQ(diff.slot, 1U);
    ASSERT_EQ(diff.field_count, 1U);
    EXPECT_EQ(diff.fields[0].section, "body");
    EXPECT_EQ(diff.fields[0].entity, "19");
    EXPECT_EQ(diff.fields[0].field, "position.y");
    EXPECT_EQ(diff.fields[0].a.raw, "-1");
    EXPECT_EQ(diff.fields[0].b.raw, "4");
    EXPECT_EQ(diff.fields[0].b.decimal, "0.000000000931322574615478515625");
}

TEST_F(VerdictTest, NamesThePhaseOfAFaultThatRepeats) {
    Desync desync;
    desync.client.fault = faulty_move;
    desync.play();
    desync.answer();
    const Bundle bundle = desync.judge();
    EXPECT_EQ(bundle.verdict, Verdict::nondeterminism);
    const DiffResult diff = diff_bundle(bundle);
    EXPECT_EQ(diff.first_tick, 5U);
    EXPECT_EQ(diff.phase, "move");
    ASSERT_EQ(diff.field_count, 1U);
    EXPECT_EQ(diff.fields[0].entity, "31");
    EXPECT_EQ(diff.fields[0].field, "velocity.y");
    EXPECT_EQ(diff.fields[0].a.raw, "0");
    EXPECT_EQ(diff.fields[0].b.raw, "1");
}

TEST_F(VerdictTest, NamesThePhaseOfAFaultThatNeverRepeatsAlike) {
    Desync desync;
    std::int32_t runs = 0;
    desync.client.fault = [&runs](FakeSimulation& simulation, std::uint32_t phase) {
        if (phase == 0 && simulation.tick() == 4) {
            simulation.row<FakeBody>(body, 0).velocity[1] = ++runs;
        }
    };
    desync.play();
    desync.answer();
    const Bundle bundle = desync.judge();
    EXPECT_EQ(bundle.verdict, Verdict::nondeterminism);
    const DiffResult diff = diff_bundle(bundle);
    EXPECT_EQ(diff.first_tick, 5U);
    EXPECT_EQ(diff.phase, "apply_inputs");
}

TEST_F(VerdictTest, BlamesTheBuildWhereBuildsDiffer) {
    Desync desync;
    desync.client_party = Desync::party("clang 14");
    desync.client.fault = faulty_move;
    desync.play();
    desync.answer();
    const Bundle bundle = desync.judge();
    EXPECT_EQ(bundle.verdict, Verdict::build_differs);
    EXPECT_EQ(diff_bundle(bundle).phase, "move");
}

TEST_F(VerdictTest, DoesNotBlameTheBuildForACorruptedState) {
    Desync desync;
    desync.client_party = Desync::party("clang 14");
    desync.play([](FakeSimulation& client) { client.corrupt(""); });
    desync.answer();
    EXPECT_EQ(desync.judge().verdict, Verdict::corrupted_state);
}

TEST_F(VerdictTest, FindsOtherInputs) {
    Desync desync;
    desync.client_inputs[1][0].bytes[0] ^= 0x10U;
    desync.play();
    desync.answer();
    const Bundle bundle = desync.judge();
    EXPECT_EQ(bundle.verdict, Verdict::inputs_differ);
    const DiffResult diff = diff_bundle(bundle);
    EXPECT_EQ(diff.first_tick, 5U);
    EXPECT_EQ(diff.section, "input");
    ASSERT_EQ(diff.fields.size(), 1U);
    EXPECT_EQ(diff.fields[0].entity, "slot 0");
    EXPECT_EQ(diff.fields[0].field, "bytes[0]");
    EXPECT_EQ(diff.fields[0].a.raw, std::to_string(fake_inputs(5)[0].bytes[0]));
}

TEST_F(VerdictTest, FindsOtherSettings) {
    Desync desync;
    desync.client_party.config.seed = 43;
    desync.play([](FakeSimulation& client) { client.corrupt(""); });
    desync.answer();
    const Bundle bundle = desync.judge();
    EXPECT_EQ(bundle.verdict, Verdict::settings_differ);
    const DiffResult diff = diff_bundle(bundle);
    EXPECT_EQ(diff.section, "config");
    ASSERT_EQ(diff.fields.size(), 1U);
    EXPECT_EQ(diff.fields[0].field, "seed");
    EXPECT_EQ(diff.fields[0].a.raw, "42");
    EXPECT_EQ(diff.fields[0].b.raw, "43");
}

TEST_F(VerdictTest, TellsAKeptStateThatIsNoLongerTheAgreedOne) {
    Desync desync;
    desync.play([](FakeSimulation& client) { client.corrupt(""); });
    FakeSimulation other;
    ASSERT_TRUE(other.load(desync.client_agreed).ok());
    other.row<FakeBody>(body, 0).flags[1] = 9;
    desync.client_agreed = other.saved();
    desync.answer();
    const Bundle bundle = desync.judge();
    EXPECT_EQ(bundle.verdict, Verdict::corrupted_state);
    const DiffResult diff = diff_bundle(bundle);
    EXPECT_EQ(diff.first_tick, Desync::kAgreedTick);
    EXPECT_EQ(diff.fields[0].field, "flags[1]");
}

TEST_F(VerdictTest, CallsAnotherStartOtherSettings) {
    FakeSimulation server(2, 1);
    FakeSimulation client(2, 2);
    const std::vector<std::byte> server_start = server.saved();
    const std::vector<std::byte> client_start = client.saved();
    const std::vector<std::vector<SlotInput>> inputs{fake_inputs(1)};
    ASSERT_TRUE(server.advance(inputs[0]).ok() && client.advance(inputs[0]).ok());
    const auto report = build_desync_report(client,
                                            {0, client_start, inputs},
                                            Desync::party("g++ 12"),
                                            {1, client.state_hash(), client.saved()});
    ASSERT_TRUE(report.ok());
    const std::vector<std::byte> server_state = server.saved();
    const auto bundle = make_bundle(server,
                                    {1,
                                     {0, server_start, inputs},
                                     server.state_hash(),
                                     client.state_hash(),
                                     server_state,
                                     Desync::party("g++ 12")},
                                    report.value());
    ASSERT_TRUE(bundle.ok());
    EXPECT_EQ(bundle.value().verdict, Verdict::settings_differ);
    const DiffResult diff = diff_bundle(bundle.value());
    EXPECT_EQ(diff.fields[0].section, "globals");
    EXPECT_EQ(diff.fields[0].field, "seed");
}

TEST_F(VerdictTest, CallsAHashWithoutItsStateFalse) {
    Desync desync;
    desync.play();
    desync.client_hash ^= 1U;
    desync.answer();
    const Bundle bundle = desync.judge();
    EXPECT_EQ(bundle.verdict, Verdict::false_hash);
    const DiffResult diff = diff_bundle(bundle);
    EXPECT_EQ(diff.fields[0].field, "state_hash");
    EXPECT_EQ(diff.fields[0].a.raw, hash_text(desync.server_hash));
    EXPECT_EQ(diff.fields[0].b.raw, hash_text(desync.client_hash));
}

TEST_F(VerdictTest, CallsAHashThatIsNotBackedFalse) {
    Desync desync;
    desync.play([](FakeSimulation& client) { client.corrupt(""); });
    EXPECT_EQ(desync.judge().verdict, Verdict::false_hash) << "no report at all";
    desync.report.assign(100, std::byte{0x5a});
    EXPECT_EQ(desync.judge().verdict, Verdict::false_hash) << "no report's bytes";
    desync.answer();
    desync.client_hash ^= 1U;
    EXPECT_EQ(desync.judge().verdict, Verdict::false_hash) << "now another hash";
    const std::vector<std::byte> nothing;
    desync.client_state = nothing;
    desync.answer();
    EXPECT_EQ(desync.judge().verdict, Verdict::false_hash) << "no state";
}

TEST_F(VerdictTest, FindsTheServersOwnCorruption) {
    Desync desync;
    desync.play({}, [](FakeSimulation& server) { server.corrupt("body.group"); });
    desync.answer();
    const Bundle bundle = desync.judge();
    EXPECT_EQ(bundle.verdict, Verdict::corrupted_state);
    EXPECT_TRUE(bundle.server_at_fault);
    const DiffResult diff = diff_bundle(bundle);
    EXPECT_EQ(diff.fields[0].field, "group");
    EXPECT_EQ(diff.fields[0].a.raw, "1");
    EXPECT_EQ(diff.fields[0].b.raw, "0");
}

TEST_F(VerdictTest, LeavesBothSimulationsAsTheyWere) {
    Desync desync;
    desync.play([](FakeSimulation& client) { client.corrupt(""); });
    const std::vector<std::byte> client_before = desync.client.saved();
    const std::vector<std::byte> server_before = desync.server.saved();
    desync.answer();
    desync.judge();
    EXPECT_EQ(desync.client.saved(), client_before);
    EXPECT_EQ(desync.server.saved(), server_before);
    EXPECT_EQ(desync.client.observer(), nullptr);
}

TEST_F(VerdictTest, RefusesToTraceWhatItCannot) {
    Desync desync;
    desync.play();
    const Party party = Desync::party("g++ 12");
    EXPECT_FALSE(trace_interval(desync.client, {3, {}, desync.client_inputs}, party).ok());
    EXPECT_FALSE(trace_interval(desync.client, {3, desync.client_agreed, {}}, party).ok());
    EXPECT_FALSE(
        trace_interval(desync.client, {2, desync.client_agreed, desync.client_inputs}, party).ok());
    desync.client.fails_after = 4;
    const auto failed =
        trace_interval(desync.client, {3, desync.client_agreed, desync.client_inputs}, party);
    ASSERT_FALSE(failed.ok());
    EXPECT_NE(failed.error().message.find("body_capacity ran out"), std::string::npos);
    EXPECT_EQ(desync.client.saved(), desync.client_state);
}

TEST_F(VerdictTest, SurvivesThousandsOfAlteredReports) {
    Desync desync;
    desync.client.fault = faulty_move;
    desync.play();
    desync.answer();
    const std::vector<std::byte> report = desync.report;
    std::mt19937 random(1);
    std::size_t readable = 0;
    for (int round = 0; round < 2000; ++round) {
        desync.report = report;
        for (std::size_t change = 0; change <= random() % 4; ++change) {
            desync.report[random() % report.size()] = static_cast<std::byte>(random() & 0xffU);
        }
        desync.report.resize(round % 10 == 0 ? random() % report.size() : report.size());
        const Bundle bundle = desync.judge();
        readable += bundle.client ? 1U : 0U;
        diff_bundle(bundle);
    }
    EXPECT_GT(readable, 100U);
}

TEST_F(VerdictTest, GivesTheSameBundleBackFromItsFile) {
    Desync desync;
    desync.client.fault = faulty_move;
    desync.play();
    desync.answer();
    const Bundle bundle = desync.judge();
    const std::string file = bundle_path(path("match.log"), 1, 6);
    EXPECT_EQ(file, path("match-desync-slot1-tick6.bundle"));
    ASSERT_TRUE(write_bundle(file, bundle).ok());
    EXPECT_FALSE(write_bundle(file, bundle).ok()) << "never over a file";
    EXPECT_EQ(
        std::distance(
            std::filesystem::directory_iterator(std::filesystem::path(file).parent_path()), {}),
        1);
    const Result<Bundle> read = read_bundle(file);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read.value().verdict, bundle.verdict);
    EXPECT_EQ(read.value().reason, bundle.reason);
    EXPECT_EQ(read.value().inputs, bundle.inputs);
    EXPECT_EQ(read.value().server_state, bundle.server_state);
    ASSERT_TRUE(read.value().client.has_value());
    EXPECT_EQ(read.value().client->reported_state, bundle.client->reported_state);
    EXPECT_EQ(diff_bundle(read.value()).fields[0].field, "velocity.y");
}

TEST_F(VerdictTest, ReadsNoDamagedBundle) {
    Desync desync;
    desync.play([](FakeSimulation& client) { client.corrupt(""); });
    desync.answer();
    ASSERT_TRUE(write_bundle(path("a.bundle"), desync.judge()).ok());
    const std::string bytes = read_file(path("a.bundle"));
    std::mt19937 random(1);
    for (int round = 0; round < 500; ++round) {
        std::string changed = bytes;
        const std::size_t place = random() % bytes.size();
        changed[place] = static_cast<char>(changed[place] ^ (1 << random() % 8));
        write_file(path("b.bundle"), round % 2 == 0 ? changed : bytes.substr(0, place));
        EXPECT_FALSE(read_bundle(path("b.bundle")).ok());
    }
}

TEST(VerdictNames, ReadBackAsThemselves) {
    for (const Verdict verdict : {Verdict::inputs_differ,
                                  Verdict::settings_differ,
                                  Verdict::false_hash,
                                  Verdict::build_differs,
                                  Verdict::nondeterminism,
                                  Verdict::corrupted_state}) {
        EXPECT_EQ(verdict_from_text(to_text(verdict)), verdict);
    }
    EXPECT_FALSE(verdict_from_text("no verdict").has_value());
}

} // namespace
} // namespace lockwind::test

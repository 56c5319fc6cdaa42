#include "base/state_hash.h"
#include "forensics/info.h"
#include "forensics/replay.h"
#include "forensics/trace.h"
#include "tests/unit/forensics/fake_simulation.h"
#include "tests/unit/log/log_fixture.h"

#include <nlohmann/json.hpp>

namespace lockwind::test {
namespace {

constexpr Tick kTicks = 40;

/// A log of the fake simulation with a keyframe every ten ticks. Tests may falsify what is written.
struct Recording {
    std::function<void(Tick, std::vector<SlotInput>&)> falsify_inputs;
    std::function<void(Tick, std::uint64_t&)> falsify_hash;
    std::function<void(Tick, std::vector<std::byte>&)> falsify_keyframe;
    bool summary = true;
    std::uint64_t last_hash = 0;

    void write(const std::string& path) {
        LogHeader header = golden_header();
        header.input_size_bytes = FakeSimulation::kInputSizeBytes;
        Result<std::unique_ptr<LogWriter>> log = LogWriter::create(path, header);
        ASSERT_TRUE(log.ok());
        FakeSimulation simulation;
        bool ok = true;
        for (Tick tick = 1; tick <= kTicks; ++tick) {
            const std::vector<SlotInput> inputs = fake_inputs(tick);
            ok = ok && simulation.advance(inputs).ok();
            ok = ok && write_tick(*log.value(), simulation, inputs);
        }
        last_hash = simulation.state_hash();
        if (summary) {
            ok = ok &&
                 log.value()
                     ->write_summary({kTicks, kTicks, last_hash, 0, EndReason::complete, "", 0})
                     .ok();
        }
        ASSERT_TRUE(ok);
    }

private:
    bool write_tick(LogWriter& log, FakeSimulation& simulation, std::vector<SlotInput> inputs) {
        const Tick tick = simulation.tick();
        std::uint64_t hash = simulation.state_hash();
        std::vector<std::byte> state = simulation.saved();
        if (falsify_inputs) {
            falsify_inputs(tick, inputs);
        }
        if (falsify_hash) {
            falsify_hash(tick, hash);
        }
        if (falsify_keyframe) {
            falsify_keyframe(tick, state);
        }
        return log.write_tick(tick, inputs, hash).ok() &&
               (tick % 10 != 0 || log.write_keyframe(tick, simulation.state_hash(), state).ok());
    }
};

class ReplayTest : public LogFixture {
protected:
    ReplayResult run(const ReplayOptions& options, FakeSimulation& simulation) {
        Result<LogReader> log = LogReader::open(path("match.log"));
        EXPECT_TRUE(log.ok());
        Result<ReplayResult> result = replay(log.value(), simulation, options);
        EXPECT_TRUE(result.ok());
        return std::move(result).value();
    }
    ReplayResult run(const ReplayOptions& options) {
        FakeSimulation simulation;
        return run(options, simulation);
    }
    static ReplayOptions verify() {
        ReplayOptions options;
        options.verify = true;
        return options;
    }
};

TEST_F(ReplayTest, VerifiesEveryHashOfAGoodLog) {
    Recording recording;
    recording.write(path("match.log"));
    const ReplayResult result = run(verify());
    EXPECT_EQ(result.ticks, kTicks);
    EXPECT_EQ(result.hashes_checked, kTicks);
    EXPECT_EQ(result.hashes_wrong, 0U);
    EXPECT_FALSE(result.first_bad_tick.has_value());
    EXPECT_EQ(result.verified_to_tick, kTicks);
    EXPECT_EQ(result.state_hash, recording.last_hash);
    EXPECT_EQ(result.ended, LogEnd::summary);
    EXPECT_GT(result.realtime_factor, 0);
    EXPECT_EQ(replay_exit_code(result), 0);
}

TEST_F(ReplayTest, FindsAWrongHashAtItsTick) {
    Recording recording;
    recording.falsify_hash = [](Tick tick, std::uint64_t& hash) { hash ^= tick == 17 ? 4U : 0U; };
    recording.write(path("match.log"));
    const ReplayResult result = run(verify());
    EXPECT_EQ(result.first_bad_tick, 17U);
    EXPECT_EQ(result.verified_to_tick, 16U);
    EXPECT_EQ(result.hashes_wrong, 1U);
    EXPECT_EQ(result.expected_hash, result.actual_hash ^ 4U);
    EXPECT_EQ(replay_exit_code(result), 1);
}

TEST_F(ReplayTest, FindsAFlippedInputAtItsTickAndNeverCorrectsIt) {
    Recording recording;
    recording.falsify_inputs = [](Tick tick, std::vector<SlotInput>& inputs) {
        inputs[1].bytes[0] ^= tick == 23 ? 1U : 0U;
    };
    recording.write(path("match.log"));
    const ReplayResult result = run(verify());
    EXPECT_EQ(result.first_bad_tick, 23U);
    EXPECT_EQ(result.verified_to_tick, 22U);
    // The keyframe of tick 30 is right, and is not taken over: all that follows stays wrong.
    EXPECT_GE(result.hashes_wrong, kTicks - 22);
    EXPECT_NE(result.state_hash, recording.last_hash);
}

TEST_F(ReplayTest, FindsAKeyframeThatIsNotTheState) {
    Recording recording;
    recording.falsify_keyframe = [](Tick tick, std::vector<std::byte>& state) {
        state.back() ^= static_cast<std::byte>(tick == 20 ? 1 : 0);
    };
    recording.write(path("match.log"));
    EXPECT_EQ(run(verify()).first_bad_tick, 20U);
    ReplayOptions seeking = verify();
    seeking.from = 25;
    EXPECT_EQ(run(seeking).first_bad_tick, 20U);
}

TEST_F(ReplayTest, ChecksNothingUnlessAsked) {
    Recording recording;
    recording.falsify_hash = [](Tick, std::uint64_t& hash) { hash = 0; };
    recording.write(path("match.log"));
    const ReplayResult result = run({});
    EXPECT_EQ(result.hashes_checked, 0U);
    EXPECT_FALSE(result.first_bad_tick.has_value());
    EXPECT_EQ(result.state_hash, recording.last_hash);
}

TEST_F(ReplayTest, SeeksByKeyframeToTheSameState) {
    Recording().write(path("match.log"));
    for (Tick tick = 1; tick <= kTicks; ++tick) {
        ReplayOptions straight;
        straight.to = tick;
        ReplayOptions seeking = verify();
        seeking.from = seeking.to = tick;
        const ReplayResult result = run(seeking);
        EXPECT_EQ(result.state_hash, run(straight).state_hash) << tick;
        EXPECT_EQ(result.ticks, tick);
        // From the keyframe before, not from the start.
        EXPECT_EQ(result.hashes_checked, tick - (tick - 1) / 10 * 10) << tick;
    }
}

TEST_F(ReplayTest, TakesAnEarlierKeyframeWhereOneDoesNotLoad) {
    Recording recording;
    recording.falsify_keyframe = [](Tick tick, std::vector<std::byte>& state) {
        state.resize(tick == 20 ? 3 : state.size());
    };
    recording.write(path("match.log"));
    ReplayOptions seeking;
    seeking.from = 25;
    EXPECT_EQ(run(seeking).state_hash, recording.last_hash);
}

TEST_F(ReplayTest, RefusesATickBehindTheEnd) {
    Recording().write(path("match.log"));
    Result<LogReader> log = LogReader::open(path("match.log"));
    FakeSimulation simulation;
    ReplayOptions options;
    options.from = kTicks + 1;
    EXPECT_FALSE(replay(log.value(), simulation, options).ok());
}

TEST_F(ReplayTest, RefusesASimulationThatDoesNotFit) {
    Recording().write(path("match.log"));
    Result<LogReader> log = LogReader::open(path("match.log"));
    FakeSimulation simulation(3);
    EXPECT_FALSE(replay(log.value(), simulation, {}).ok());
}

TEST_F(ReplayTest, TellsAStepThatFails) {
    Recording().write(path("match.log"));
    FakeSimulation simulation;
    simulation.fails_after = 11;
    const ReplayResult result = run(verify(), simulation);
    EXPECT_EQ(result.first_bad_tick, 12U);
    EXPECT_EQ(result.verified_to_tick, 11U);
    EXPECT_NE(result.failure.find("body_capacity"), std::string::npos);
    EXPECT_EQ(replay_exit_code(result), 1);
}

TEST_F(ReplayTest, ReplaysAnInterruptedLogToItsEndAndATornOneToTheTear) {
    Recording recording;
    recording.summary = false;
    recording.write(path("match.log"));
    const ReplayResult interrupted = run(verify());
    EXPECT_EQ(interrupted.ended, LogEnd::interrupted);
    EXPECT_EQ(replay_exit_code(interrupted), 0);
    EXPECT_EQ(interrupted.verified_to_tick, kTicks);
    const std::string bytes = read_file(path("match.log"));
    write_file(path("match.log"), bytes.substr(0, bytes.size() - 1));
    const ReplayResult torn = run(verify());
    EXPECT_EQ(torn.ended, LogEnd::damaged);
    EXPECT_EQ(replay_exit_code(torn), 3);
    // The last record is the keyframe of the last tick; its hash stands before it.
    EXPECT_EQ(torn.verified_to_tick, kTicks);
    EXPECT_LT(torn.valid_bytes, bytes.size());
}

TEST_F(ReplayTest, ReportsTheContractsFields) {
    Recording recording;
    recording.falsify_hash = [](Tick tick, std::uint64_t& hash) { hash += tick == 9 ? 1 : 0; };
    recording.write(path("match.log"));
    const nlohmann::json json = nlohmann::json::parse(replay_json(run(verify())));
    EXPECT_EQ(json["ticks"], kTicks);
    EXPECT_EQ(json["hashes_checked"], kTicks);
    EXPECT_EQ(json["first_bad_tick"], 9);
    EXPECT_EQ(json["state_hash"], hash_text(recording.last_hash));
    EXPECT_EQ(json["ended"], "summary");
    EXPECT_EQ(json["valid_bytes"], std::filesystem::file_size(path("match.log")));
    EXPECT_EQ(json["verified_to_tick"], 8);
    EXPECT_TRUE(json["realtime_factor"].is_number());
}

TEST_F(ReplayTest, HashesAfterEveryPhaseAreThoseOfASecondRun) {
    Recording().write(path("match.log"));
    std::vector<Trace> traces(2);
    for (Trace& trace : traces) {
        ReplayOptions options;
        options.trace = &trace;
        run(options);
    }
    ASSERT_EQ(traces[0].entries.size(), 1 + kTicks * kFakePhases.size());
    for (std::size_t index = 0; index < traces[0].entries.size(); ++index) {
        EXPECT_EQ(traces[0].entries[index].hash, traces[1].entries[index].hash);
        EXPECT_EQ(traces[0].entries[index].tick, (index + 2) / 3);
    }
    EXPECT_NE(traces[0].entries[1].hash, traces[0].entries[2].hash);
}

TEST_F(ReplayTest, TracesTheTicksThatWereAskedForOnly) {
    Recording().write(path("match.log"));
    Trace trace;
    ReplayOptions options;
    options.trace = &trace;
    options.from = 12;
    options.to = 13;
    run(options);
    ASSERT_EQ(trace.entries.size(), 1 + 2 * kFakePhases.size());
    EXPECT_EQ(trace.entries.front().tick, 11U);
    EXPECT_EQ(trace.entries.front().phase, kTraceStart);
    EXPECT_EQ(trace.entries.back().tick, 13U);
}

TEST_F(ReplayTest, InfoTellsTheContractsFieldsOfALog) {
    Recording().write(path("match.log"));
    const Result<FileInfo> info = inspect_file(path("match.log"));
    ASSERT_TRUE(info.ok());
    EXPECT_FALSE(info.value().damaged);
    const nlohmann::json json = nlohmann::json::parse(info.value().json);
    EXPECT_EQ(json["ticks"], kTicks);
    EXPECT_EQ(json["ended"], "summary");
    EXPECT_EQ(json["valid_bytes"], std::filesystem::file_size(path("match.log")));
    EXPECT_EQ(json["verified_to_tick"], kTicks);
    EXPECT_EQ(json["sim_version"], golden_header().sim_version);
    EXPECT_EQ(json["build_info"], golden_header().build_info);
    EXPECT_EQ(json["scene"], "counter");
    EXPECT_EQ(json["seed"], 42);
    EXPECT_EQ(json["mode"], "lockstep");
    EXPECT_EQ(json["players"], 2);
}

} // namespace
} // namespace lockwind::test

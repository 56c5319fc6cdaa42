#include "forensics/diff.h"
#include "forensics/diff_output.h"
#include "forensics/info.h"
#include "forensics/snapshot_file.h"
#include "forensics/trace.h"
#include "tests/unit/forensics/fake_simulation.h"
#include "tests/unit/log/log_fixture.h"

#include <nlohmann/json.hpp>
#include <random>

namespace lockwind::test {
namespace {

class TraceTest : public LogFixture {
protected:
    static Party party() { return {"sim 1", "g++ 12", golden_header().config}; }

    /// Traces `ticks` ticks of a simulation, with a fault or without.
    static Trace trace(bool states,
                       const std::function<void(FakeSimulation&, std::uint32_t)>& fault = {},
                       Tick skipped = 0) {
        FakeSimulation simulation;
        simulation.fault = fault;
        Trace trace;
        trace.header = trace_header(simulation, party(), states);
        TraceRecorder recorder(simulation, trace, {states});
        for (Tick tick = 1; tick <= 8; ++tick) {
            if (tick == skipped + 1) {
                recorder.start();
                simulation.observe(&recorder);
            }
            EXPECT_TRUE(simulation.advance(fake_inputs(tick)).ok());
        }
        EXPECT_TRUE(recorder.status().ok());
        return trace;
    }

    static Status write(const std::string& path, const Trace& trace) {
        Result<TraceWriter> writer = TraceWriter::create(path, trace.header);
        if (!writer) {
            return writer.error();
        }
        for (const TraceEntry& entry : trace.entries) {
            if (Status status = writer.value().add(entry); !status) {
                return status;
            }
        }
        return writer.value().finish();
    }

    static DiffResult compare(const Trace& a, const Trace& b) {
        TraceView view_a(a);
        TraceView view_b(b);
        Result<DiffResult> diff = diff_traces(view_a, view_b);
        EXPECT_TRUE(diff.ok());
        return std::move(diff).value();
    }
};

void fault_in_move(FakeSimulation& simulation, std::uint32_t phase) {
    if (phase == 1 && simulation.tick() == 5) {
        simulation.row<FakeBody>(body, 1).position[2] -= 1;
    }
}

TEST_F(TraceTest, NamesTickPhaseAndField) {
    const DiffResult diff = compare(trace(true), trace(true, fault_in_move));
    EXPECT_FALSE(diff.same);
    EXPECT_EQ(diff.first_tick, 6U);
    EXPECT_EQ(diff.phase, "move");
    ASSERT_EQ(diff.field_count, 1U);
    EXPECT_EQ(diff.fields[0].entity, "13");
    EXPECT_EQ(diff.fields[0].field, "position.z");
    EXPECT_EQ(diff.fields[0].b.raw, "-1");
    EXPECT_EQ(diff.fields[0].b.decimal, "-0.00000000023283064365386962890625");
}

TEST_F(TraceTest, NamesTheSectionFromHashesAlone) {
    const DiffResult diff = compare(trace(false), trace(true, fault_in_move));
    EXPECT_EQ(diff.first_tick, 6U);
    EXPECT_EQ(diff.phase, "move");
    EXPECT_EQ(diff.section, "body");
    EXPECT_TRUE(diff.fields.empty());
}

TEST_F(TraceTest, ComparesWhereTracesOverlap) {
    EXPECT_TRUE(compare(trace(true), trace(true, {}, 5)).same);
    const DiffResult diff = compare(trace(true, fault_in_move), trace(true, {}, 3));
    EXPECT_EQ(diff.first_tick, 6U);
    EXPECT_EQ(diff.phase, "move");
    EXPECT_EQ(diff.fields[0].a.raw, "-1");
}

TEST_F(TraceTest, RefusesTracesWithNothingInCommon) {
    Trace early = trace(false);
    Trace late = trace(false, {}, 5);
    early.entries.resize(4);
    TraceView a(early);
    TraceView b(late);
    EXPECT_FALSE(diff_traces(a, b).ok());
}

TEST_F(TraceTest, SaysWhenProgramsDiffer) {
    Trace other = trace(false);
    other.header.phases[1] = "moved";
    const DiffResult diff = compare(trace(false), other);
    EXPECT_FALSE(diff.same);
    EXPECT_EQ(diff.verdict, Verdict::build_differs);
}

TEST_F(TraceTest, ReadsBackFromItsFile) {
    const Trace written = trace(true, fault_in_move);
    ASSERT_TRUE(write(path("a.trace"), written).ok());
    Result<TraceReader> read = TraceReader::open(path("a.trace"));
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read.value().header().phases, written.header.phases);
    std::size_t index = 0;
    while (true) {
        const Result<std::optional<TraceEntry>> entry = read.value().next();
        ASSERT_TRUE(entry.ok());
        if (!entry.value()) {
            break;
        }
        ASSERT_LT(index, written.entries.size());
        EXPECT_EQ(entry.value()->hash, written.entries[index].hash);
        EXPECT_EQ(entry.value()->sections, written.entries[index].sections);
        EXPECT_EQ(entry.value()->packed_state, written.entries[index].packed_state);
        ++index;
    }
    EXPECT_EQ(index, written.entries.size());
}

TEST_F(TraceTest, AppearsOnlyWholeAndNeverOverAFile) {
    {
        Result<TraceWriter> writer = TraceWriter::create(path("a.trace"), trace(false).header);
        ASSERT_TRUE(writer.ok());
        EXPECT_FALSE(std::filesystem::exists(path("a.trace")));
    }
    EXPECT_TRUE(std::filesystem::is_empty(path(".")));
    write_file(path("a.trace"), "precious");
    EXPECT_FALSE(TraceWriter::create(path("a.trace"), trace(false).header).ok());
    EXPECT_EQ(read_file(path("a.trace")), "precious");
}

TEST_F(TraceTest, TellsEveryKindOfDamage) {
    ASSERT_TRUE(write(path("a.trace"), trace(true)).ok());
    const std::string bytes = read_file(path("a.trace"));
    std::mt19937 random(1);
    for (int round = 0; round < 1000; ++round) {
        std::string changed = bytes;
        const std::size_t place = random() % bytes.size();
        changed[place] = static_cast<char>(changed[place] ^ (1 << random() % 8));
        write_file(path("b.trace"), round % 2 == 0 ? changed : bytes.substr(0, place));
        const Result<FileInfo> info = inspect_file(path("b.trace"));
        EXPECT_TRUE(!info || info.value().damaged) << "byte " << place;
    }
}

TEST_F(TraceTest, StopsRecordingStatesAtItsLimit) {
    FakeSimulation simulation;
    Trace trace;
    TraceRecorder recorder(simulation, trace, {true, 1, nullptr});
    recorder.start();
    simulation.observe(&recorder);
    ASSERT_TRUE(simulation.advance(fake_inputs(1)).ok());
    EXPECT_FALSE(trace.entries[0].packed_state.empty());
    EXPECT_TRUE(trace.entries[1].packed_state.empty());
    EXPECT_EQ(trace.entries.size(), 4U);
}

class SnapshotTest : public TraceTest {
protected:
    static Snapshot snapshot(const FakeSimulation& simulation) {
        return {party(),
                simulation.tick(),
                simulation.state_hash(),
                OwnedSchema(simulation.schema()),
                simulation.saved()};
    }
};

TEST_F(SnapshotTest, ReadsBackFromItsFile) {
    FakeSimulation simulation;
    ASSERT_TRUE(simulation.advance(fake_inputs(1)).ok());
    const Snapshot written = snapshot(simulation);
    ASSERT_TRUE(write_snapshot(path("a.snapshot"), written).ok());
    EXPECT_FALSE(write_snapshot(path("a.snapshot"), written).ok());
    const Result<Snapshot> read = read_snapshot(path("a.snapshot"));
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read.value().tick, 1U);
    EXPECT_EQ(read.value().hash, written.hash);
    EXPECT_EQ(read.value().state, written.state);
    EXPECT_EQ(read.value().party.config, written.party.config);
    const auto diff = diff_snapshots(written, read.value());
    EXPECT_TRUE(diff.ok() && diff.value().same);
}

TEST_F(SnapshotTest, DiffsToTheField) {
    FakeSimulation a;
    FakeSimulation b;
    b.row<FakeBody>(body, 0).velocity[0] = -(1 << 20);
    const auto diff = diff_snapshots(snapshot(a), snapshot(b));
    ASSERT_TRUE(diff.ok());
    EXPECT_EQ(diff.value().first_tick, 0U);
    EXPECT_EQ(diff.value().fields[0].field, "velocity.x");
    EXPECT_EQ(diff.value().fields[0].b.decimal, "-1");
}

TEST_F(SnapshotTest, ReadsNoDamagedFile) {
    ASSERT_TRUE(write_snapshot(path("a.snapshot"), snapshot(FakeSimulation())).ok());
    const std::string bytes = read_file(path("a.snapshot"));
    std::mt19937 random(1);
    for (int round = 0; round < 500; ++round) {
        std::string changed = bytes;
        const std::size_t place = random() % bytes.size();
        changed[place] = static_cast<char>(changed[place] ^ (1 << random() % 8));
        write_file(path("b.snapshot"), round % 2 == 0 ? changed : bytes.substr(0, place));
        EXPECT_FALSE(read_snapshot(path("b.snapshot")).ok());
    }
}

TEST_F(SnapshotTest, EveryFileTellsItsKindAndExports) {
    ASSERT_TRUE(write_snapshot(path("a.snapshot"), snapshot(FakeSimulation())).ok());
    ASSERT_TRUE(write(path("a.trace"), trace(true)).ok());
    for (const char* kind : {"snapshot", "trace"}) {
        const std::string file = path(std::string("a.") + kind);
        const Result<FileInfo> info = inspect_file(file);
        ASSERT_TRUE(info.ok());
        EXPECT_EQ(nlohmann::json::parse(info.value().json)["kind"], kind);
        ASSERT_TRUE(export_file(file, file + ".pb").ok());
        // The plain file holds the states as they are.
        const std::vector<std::byte> state = FakeSimulation().saved();
        const std::string text(reinterpret_cast<const char*>(state.data()), state.size());
        EXPECT_NE(read_file(file + ".pb").find(text), std::string::npos) << kind;
        EXPECT_FALSE(export_file(file, file + ".pb").ok()) << "never over a file";
    }
    write_file(path("other"), "no file of ours");
    EXPECT_FALSE(inspect_file(path("other")).ok());
}

} // namespace
} // namespace lockwind::test

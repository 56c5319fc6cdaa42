#pragma once

#include "log/log_writer.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>
#include <unistd.h>
#include <vector>

namespace lockwind::test {

/// A folder of its own for each test, removed behind it.
class LogFixture : public ::testing::Test {
protected:
    LogFixture() {
        const ::testing::TestInfo* info = ::testing::UnitTest::GetInstance()->current_test_info();
        // Memory, where there is such a folder: tests rewrite files by the thousand.
        const std::filesystem::path memory = "/dev/shm";
        const bool fast = ::access(memory.c_str(), W_OK) == 0;
        folder_ = (fast ? memory : std::filesystem::temp_directory_path()) /
                  ("lockwind-" + std::string(info->test_suite_name()) + "-" + info->name() + "-" +
                   std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
    }
    ~LogFixture() override {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

private:
    std::filesystem::path folder_;
};

inline std::string read_file(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void write_file(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

inline LogHeader golden_header() {
    LogHeader header;
    header.sim_version = "0123456789abcdef";
    header.build_info = "g++ 12; -O2; x86_64";
    header.started_unix_us = 1'700'000'000'000'000;
    header.config.match = "golden";
    header.config.mode = "lockstep";
    header.config.scene_name = "counter";
    header.config.scene_text = "name: \"counter\"\n";
    header.config.seed = 42;
    header.config.players = 2;
    header.config.ticks = 4;
    header.input_size_bytes = 3;
    return header;
}

inline std::vector<SlotInput> golden_inputs(Tick tick) {
    std::vector<SlotInput> inputs(2);
    inputs[0].status = tick % 2 == 0 ? InputStatus::substituted : InputStatus::confirmed;
    inputs[0].bytes = {static_cast<std::uint8_t>(tick), 0xfe, 3};
    inputs[1].status = tick > 2 ? InputStatus::disconnected : InputStatus::confirmed;
    if (tick <= 2) {
        inputs[1].bytes = {0, static_cast<std::uint8_t>(tick * 100), 0xff};
    }
    return inputs;
}

inline std::uint64_t golden_hash(Tick tick) {
    return 0x9e3779b97f4a7c15U * (tick + 1);
}

/// 10,000 bytes that neither are all alike nor look random.
inline std::vector<std::byte> golden_state() {
    std::vector<std::byte> state(10'000);
    for (std::size_t index = 0; index < state.size(); ++index) {
        state[index] = static_cast<std::byte>((index % 112 < 20 ? index * index : 0) & 0xffU);
    }
    return state;
}

/// A match with a record of each kind.
inline std::unique_ptr<LogWriter> write_golden_match(const std::string& path, bool summary) {
    Result<std::unique_ptr<LogWriter>> log = LogWriter::create(path, golden_header());
    EXPECT_TRUE(log.ok());
    LogWriter& writer = *log.value();
    bool ok = true;
    const auto expect = [&](const Status& status) { ok = ok && status.ok(); };
    expect(writer.write_start_hash(golden_hash(0)));
    expect(writer.write_join({1, 0, false, "g++ 12"}));
    expect(writer.write_join({1, 1, true, "clang 14"}));
    for (Tick tick = 1; tick <= 4; ++tick) {
        expect(writer.write_tick(tick, golden_inputs(tick), golden_hash(tick)));
        if (tick == 2) {
            const std::vector<Event> events{{EventType::created, 7, 1, 0},
                                            {EventType::score, 1, 2, -5}};
            expect(writer.write_keyframe(tick, golden_hash(tick), golden_state()));
            expect(writer.write_events(tick, events));
            expect(writer.write_leave({3, 1, LeaveReason::dropped}));
            expect(writer.write_pause({3, 250'000, "slot 1 is silent"}));
            expect(writer.write_setting({3, "input_delay_ticks", "3"}));
            expect(writer.write_desync({2, 1, golden_hash(2), golden_hash(2) + 1}));
        }
    }
    if (summary) {
        expect(writer.write_summary(
            {4, 4, golden_hash(4), 1, EndReason::complete, "", 1'700'000'000'066'667}));
    }
    EXPECT_TRUE(ok);
    return std::move(log).value();
}

} // namespace lockwind::test

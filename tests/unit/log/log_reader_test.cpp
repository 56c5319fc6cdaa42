#include "base/state_hash.h"
#include "log/log_export.h"
#include "log/log_reader.h"
#include "log/log_writer.h"
#include "log/state_pack.h"
#include "tests/unit/log/log_fixture.h"

#include <algorithm>
#include <random>

namespace lockwind::test {
namespace {

class LogReaderTest : public LogFixture {
protected:
    /// What a log of these bytes is; nothing where it does not open.
    std::optional<LogIndex> index_of(const std::string& bytes) {
        write_file(path("damaged.log"), bytes);
        Result<LogReader> reader = LogReader::open(path("damaged.log"));
        return reader ? std::optional(index_log(reader.value())) : std::nullopt;
    }
};

/// Ends of the magic and of every record.
std::vector<std::size_t> boundaries(const std::string& bytes) {
    std::vector<std::size_t> ends{kMagicSizeBytes};
    while (ends.back() < bytes.size()) {
        std::size_t size = 0;
        for (std::size_t index = 0; index < 4; ++index) {
            size |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[ends.back() + index]))
                    << (8 * index);
        }
        ends.push_back(ends.back() + size + kRecordOverheadBytes);
    }
    return ends;
}

/// A whole record of `payload`.
std::string frame(const std::string& payload) {
    std::string record;
    for (std::size_t index = 0; index < 4; ++index) {
        record += static_cast<char>((payload.size() >> (8 * index)) & 0xffU);
    }
    record += payload;
    const std::uint64_t hash = hash_bytes(std::as_bytes(std::span(record.data(), record.size())));
    for (std::size_t index = 0; index < 8; ++index) {
        record += static_cast<char>((hash >> (8 * index)) & 0xffU);
    }
    return record;
}

TEST_F(LogReaderTest, CutAtEveryByteGivesAllWholeRecords) {
    write_golden_match(path("match.log"), true);
    const std::string bytes = read_file(path("match.log"));
    const std::vector<std::size_t> ends = boundaries(bytes);
    ASSERT_EQ(ends.back(), bytes.size());
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        const std::optional<LogIndex> index = index_of(bytes.substr(0, size));
        if (size < ends[1]) {
            EXPECT_FALSE(index.has_value()) << "header cut at " << size;
            continue;
        }
        ASSERT_TRUE(index.has_value()) << "cut at " << size;
        const auto next = std::upper_bound(ends.begin(), ends.end(), size);
        const bool at_boundary = *(next - 1) == size;
        EXPECT_EQ(index->valid_bytes, *(next - 1)) << "cut at " << size;
        EXPECT_EQ(index->ended, at_boundary ? LogEnd::interrupted : LogEnd::damaged)
            << "cut at " << size;
        EXPECT_EQ(index->damage.empty(), at_boundary);
    }
    EXPECT_EQ(index_of(bytes)->ended, LogEnd::summary);
}

TEST_F(LogReaderTest, DetectsTwoThousandFlippedBits) {
    write_golden_match(path("match.log"), true);
    const std::string bytes = read_file(path("match.log"));
    const std::vector<std::size_t> ends = boundaries(bytes);
    std::mt19937 random(1);
    for (int round = 0; round < 2000; ++round) {
        const std::size_t place = random() % bytes.size();
        std::string flipped = bytes;
        flipped[place] = static_cast<char>(flipped[place] ^ (1 << random() % 8));
        const std::optional<LogIndex> index = index_of(flipped);
        if (place < ends[1]) {
            EXPECT_FALSE(index.has_value()) << "bit of byte " << place;
            continue;
        }
        ASSERT_TRUE(index.has_value()) << "bit of byte " << place;
        EXPECT_EQ(index->ended, LogEnd::damaged) << "bit of byte " << place;
        EXPECT_EQ(index->valid_bytes, *(std::upper_bound(ends.begin(), ends.end(), place) - 1));
    }
}

TEST_F(LogReaderTest, SurvivesRecordsOfAnyContentWithARightChecksum) {
    write_golden_match(path("match.log"), false);
    const std::string bytes = read_file(path("match.log"));
    const std::vector<std::size_t> ends = boundaries(bytes);
    std::mt19937 random(2);
    for (int round = 0; round < 2000; ++round) {
        const std::size_t record = 1 + random() % (ends.size() - 2);
        std::string payload = bytes.substr(ends[record] + 4, ends[record + 1] - ends[record] - 12);
        for (std::size_t change = 0; change <= random() % 3; ++change) {
            payload[random() % payload.size()] = static_cast<char>(random());
        }
        const std::optional<LogIndex> index =
            index_of(bytes.substr(0, ends[record]) + frame(payload));
        ASSERT_TRUE(index.has_value());
        EXPECT_GE(index->valid_bytes, ends[record]);
    }
}

TEST_F(LogReaderTest, RefusesWhatBreaksTheOrderOfALog) {
    write_golden_match(path("match.log"), true);
    const std::string bytes = read_file(path("match.log"));
    const std::vector<std::size_t> ends = boundaries(bytes);
    const auto record = [&](std::size_t index) {
        return bytes.substr(ends[index], ends[index + 1] - ends[index]);
    };
    const std::size_t last = ends.size() - 2;
    struct Case {
        const char* what;
        std::string bytes;
    };
    const std::vector<Case> cases{
        {"tick 3 twice", bytes.substr(0, ends[last - 2]) + record(last - 4)},
        {"tick 2 behind no tick 1", bytes.substr(0, ends[4]) + record(6)},
        {"a hash of another tick", bytes.substr(0, ends[last - 1]) + record(5)},
        {"a second header", bytes + record(0)},
        {"a record behind the summary", bytes + record(last - 1)},
        {"a summary of another tick", bytes.substr(0, ends[5]) + record(last)},
        {"an empty record", bytes.substr(0, ends[last]) + frame("")},
    };
    for (const Case& wrong : cases) {
        const std::optional<LogIndex> index = index_of(wrong.bytes);
        ASSERT_TRUE(index.has_value()) << wrong.what;
        EXPECT_EQ(index->ended, LogEnd::damaged) << wrong.what;
        EXPECT_FALSE(index->damage.empty()) << wrong.what;
    }
}

TEST_F(LogReaderTest, RefusesAHeaderOutOfRange) {
    const auto opens = [&](const auto& change) {
        LogHeader header = golden_header();
        change(header);
        std::filesystem::remove(path("match.log"));
        return LogWriter::create(path("match.log"), header).ok();
    };
    EXPECT_TRUE(opens([](LogHeader&) {}));
    EXPECT_FALSE(opens([](LogHeader& header) { header.config.players = 0; }));
    EXPECT_FALSE(opens([](LogHeader& header) { header.config.players = kPlayersMax + 1; }));
    EXPECT_FALSE(opens([](LogHeader& header) { header.config.tick_rate_hz = 0; }));
    EXPECT_FALSE(opens([](LogHeader& header) { header.input_size_bytes = 33; }));
    EXPECT_FALSE(opens([](LogHeader& header) { header.format_version = kLogFormatVersion + 1; }));
}

TEST_F(LogReaderTest, NeverAllocatesWhatASizeClaims) {
    write_golden_match(path("match.log"), false);
    const std::string bytes = read_file(path("match.log"));
    const std::optional<LogIndex> index = index_of(bytes + "\xff\xff\xff\xff" + "some bytes");
    ASSERT_TRUE(index.has_value());
    EXPECT_EQ(index->ended, LogEnd::damaged);
    EXPECT_EQ(index->valid_bytes, bytes.size());
}

TEST_F(LogReaderTest, FindsKeyframesThatItCanGoOnFrom) {
    write_golden_match(path("match.log"), true);
    Result<LogReader> reader = LogReader::open(path("match.log"));
    ASSERT_TRUE(reader.ok());
    const LogIndex index = index_log(reader.value());
    ASSERT_EQ(index.keyframes.size(), 1U);
    EXPECT_EQ(index.keyframes[0].tick, 2U);
    reader.value().seek(index.keyframes[0].offset, index.keyframes[0].tick);
    const std::optional<LogRecord> record = reader.value().next();
    ASSERT_TRUE(record && std::holds_alternative<KeyframeRecord>(*record));
    const auto state = unpack_state(std::get<KeyframeRecord>(*record).packed_state);
    ASSERT_TRUE(state.ok());
    EXPECT_EQ(state.value(), golden_state());
    Tick last = 0;
    while (const std::optional<LogRecord> next = reader.value().next()) {
        const auto* tick = std::get_if<TickRecord>(&*next);
        last = tick == nullptr ? last : tick->tick;
    }
    EXPECT_EQ(last, 4U);
    EXPECT_EQ(reader.value().ended(), LogEnd::summary);
}

TEST_F(LogReaderTest, ReadsWhatLiesBeyondFourGiB) {
    write_golden_match(path("match.log"), true);
    Result<LogReader> reader = LogReader::open(path("match.log"));
    ASSERT_TRUE(reader.ok());
    const LogIndex index = index_log(reader.value());
    const std::string records =
        read_file(path("match.log")).substr(static_cast<std::size_t>(reader.value().offset()));
    constexpr std::uint64_t kFar = std::uint64_t{5} << 30U;
    std::filesystem::resize_file(path("match.log"), kFar); // a hole: takes no room
    std::ofstream(path("match.log"), std::ios::binary | std::ios::app) << records;

    reader = LogReader::open(path("match.log"));
    ASSERT_TRUE(reader.ok());
    EXPECT_EQ(reader.value().file_bytes(), kFar + records.size());
    reader.value().seek(kFar, 0);
    Tick ticks = 0;
    while (const std::optional<LogRecord> record = reader.value().next()) {
        ticks += std::holds_alternative<TickRecord>(*record) ? 1 : 0;
    }
    EXPECT_EQ(reader.value().ended(), LogEnd::summary) << reader.value().damage();
    EXPECT_EQ(reader.value().valid_bytes(), kFar + records.size());
    EXPECT_EQ(ticks, index.ticks);
}

TEST_F(LogReaderTest, CountsWhatALogHolds) {
    write_golden_match(path("match.log"), true);
    Result<LogReader> reader = LogReader::open(path("match.log"));
    ASSERT_TRUE(reader.ok());
    const LogIndex index = index_log(reader.value());
    EXPECT_EQ(index.ticks, 4U);
    EXPECT_EQ(index.hashed_to_tick, 4U);
    EXPECT_EQ(index.hashes, 5U);
    EXPECT_EQ(index.substituted_inputs, 2U);
    EXPECT_EQ(index.joins, 2U);
    EXPECT_EQ(index.leaves, 1U);
    EXPECT_EQ(index.events, 2U);
    EXPECT_EQ(index.desyncs, 1U);
}

TEST_F(LogReaderTest, SaysWhatIsNoLog) {
    EXPECT_FALSE(LogReader::open(path("missing.log")).ok());
    EXPECT_FALSE(LogReader::open(path(".")).ok());
    EXPECT_FALSE(index_of("").has_value());
    EXPECT_FALSE(index_of("\x89LWTRC\r\n").has_value());
    EXPECT_FALSE(index_of(std::string(1000, 'x')).has_value());
}

TEST_F(LogReaderTest, ExportsAllWholeRecordsAndNeverOverAFile) {
    write_golden_match(path("match.log"), true);
    ASSERT_TRUE(export_log(path("match.log"), path("match.pb")).ok());
    const std::string plain = read_file(path("match.pb"));
    const std::vector<std::byte> state = golden_state();
    const std::string state_text(reinterpret_cast<const char*>(state.data()), state.size());
    EXPECT_NE(plain.find(state_text), std::string::npos);
    EXPECT_FALSE(export_log(path("match.log"), path("match.pb")).ok());
    EXPECT_EQ(read_file(path("match.pb")), plain);
}

} // namespace
} // namespace lockwind::test

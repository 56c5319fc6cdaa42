#include "log/log_reader.h"
#include "log/log_writer.h"
#include "log/state_pack.h"
#include "tests/support/full_disk.h"
#include "tests/unit/log/golden_log.h"
#include "tests/unit/log/log_fixture.h"

#include <sys/stat.h>

namespace lockwind::test {
namespace {

class LogWriterTest : public LogFixture {};

std::string to_hex(const std::string& bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string hex;
    for (std::size_t index = 0; index < bytes.size(); ++index) {
        const auto byte = static_cast<unsigned char>(bytes[index]);
        hex += index > 0 && index % 40 == 0 ? "\n" : "";
        hex += {kDigits[byte >> 4U], kDigits[byte & 15U]};
    }
    return hex + "\n";
}

std::vector<LogRecord> read_all(LogReader& reader) {
    std::vector<LogRecord> records;
    while (std::optional<LogRecord> record = reader.next()) {
        records.push_back(*std::move(record));
    }
    return records;
}

TEST_F(LogWriterTest, WritesTheFormatsGoldenBytes) {
    write_golden_match(path("match.log"), true);
    EXPECT_EQ(to_hex(read_file(path("match.log"))), kGoldenLogHex);
}

TEST_F(LogWriterTest, GivesBackEveryRecordAsItWasWritten) {
    write_golden_match(path("match.log"), true);
    Result<LogReader> reader = LogReader::open(path("match.log"));
    ASSERT_TRUE(reader.ok());
    EXPECT_EQ(reader.value().header(), golden_header());
    const std::vector<LogRecord> records = read_all(reader.value());
    const std::vector<std::byte> packed = pack_state(golden_state());
    const std::vector<LogRecord> expected{
        HashRecord{0, golden_hash(0)},
        JoinRecord{1, 0, false, "g++ 12"},
        JoinRecord{1, 1, true, "clang 14"},
        TickRecord{1, golden_inputs(1)},
        HashRecord{1, golden_hash(1)},
        TickRecord{2, golden_inputs(2)},
        HashRecord{2, golden_hash(2)},
        KeyframeRecord{2, golden_hash(2), packed},
        EventsRecord{2, {{EventType::created, 7, 1, 0}, {EventType::score, 1, 2, -5}}},
        LeaveRecord{3, 1, LeaveReason::dropped},
        PauseRecord{3, 250'000, "slot 1 is silent"},
        SettingRecord{3, "input_delay_ticks", "3"},
        DesyncRecord{2, 1, golden_hash(2), golden_hash(2) + 1},
        TickRecord{3, golden_inputs(3)},
        HashRecord{3, golden_hash(3)},
        TickRecord{4, golden_inputs(4)},
        HashRecord{4, golden_hash(4)},
        LogSummary{4, 4, golden_hash(4), 1, EndReason::complete, "", 1'700'000'000'066'667}};
    EXPECT_EQ(records, expected);
    EXPECT_EQ(reader.value().ended(), LogEnd::summary);
    EXPECT_EQ(reader.value().valid_bytes(), reader.value().file_bytes());
}

TEST_F(LogWriterTest, CountsTheBytesOfTheFile) {
    const std::unique_ptr<LogWriter> writer = write_golden_match(path("match.log"), true);
    EXPECT_EQ(writer->size_bytes(), std::filesystem::file_size(path("match.log")));
    EXPECT_EQ(writer->last_tick(), 4U);
}

TEST_F(LogWriterTest, HasATickInTheFileWhenWriteTickReturns) {
    const std::unique_ptr<LogWriter> writer = write_golden_match(path("match.log"), false);
    ASSERT_TRUE(writer->write_tick(5, golden_inputs(5), std::nullopt).ok());
    Result<LogReader> reader = LogReader::open(path("match.log"));
    ASSERT_TRUE(reader.ok());
    EXPECT_EQ(index_log(reader.value()).ticks, 5U);
}

TEST_F(LogWriterTest, NeverOverwritesAFile) {
    write_file(path("match.log"), "precious");
    const auto log = LogWriter::create(path("match.log"), golden_header());
    ASSERT_FALSE(log.ok());
    EXPECT_NE(log.error().message.find("exists"), std::string::npos);
    EXPECT_EQ(read_file(path("match.log")), "precious");
}

TEST_F(LogWriterTest, SaysWhyAFileCannotBeCreated) {
    const auto log = LogWriter::create(path("no-such-folder/match.log"), golden_header());
    ASSERT_FALSE(log.ok());
    EXPECT_NE(log.error().message.find("No such file or directory"), std::string::npos);
}

TEST_F(LogWriterTest, LeavesAReadOnlyFolderAlone) {
    std::filesystem::create_directory(path("locked"));
    ASSERT_EQ(::chmod(path("locked").c_str(), 0555), 0);
    // Root may write everywhere: be nobody for a moment.
    const bool root = ::geteuid() == 0;
    ASSERT_TRUE(!root || ::seteuid(65534) == 0);
    const auto log = LogWriter::create(path("locked/match.log"), golden_header());
    ASSERT_TRUE(!root || ::seteuid(0) == 0);
    ASSERT_FALSE(log.ok());
    EXPECT_NE(log.error().message.find("Permission denied"), std::string::npos);
}

TEST_F(LogWriterTest, RefusesASceneTextThatIsNoUtf8) {
    LogHeader header = golden_header();
    header.config.scene_text = "\xff\xfe";
    EXPECT_FALSE(LogWriter::create(path("match.log"), header).ok());
    EXPECT_FALSE(std::filesystem::exists(path("match.log")));
}

TEST_F(LogWriterTest, CutsAHalfWrittenRecordOffAFullDisk) {
    const std::unique_ptr<LogWriter> writer = write_golden_match(path("match.log"), false);
    const std::uint64_t size = writer->size_bytes();
    {
        const testing::FullDisk full(size + 5);
        EXPECT_FALSE(writer->write_tick(5, golden_inputs(5), golden_hash(5)).ok());
    }
    EXPECT_EQ(std::filesystem::file_size(path("match.log")), size);
    EXPECT_EQ(writer->last_tick(), 4U);
}

TEST_F(LogWriterTest, DiffersOnlyInBuildAndClockBetweenEqualMatches) {
    write_golden_match(path("a.log"), true);
    write_golden_match(path("b.log"), true);
    EXPECT_EQ(read_file(path("a.log")), read_file(path("b.log")));
}

} // namespace
} // namespace lockwind::test

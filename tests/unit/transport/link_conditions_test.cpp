#include "transport/sim/link_conditions.h"

#include <gtest/gtest.h>
#include <string>

namespace lockwind {
namespace {

LinkConditions parsed(std::string_view text) {
    const Result<LinkConditions> result = parse_link_conditions(text);
    EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
    return result.ok() ? result.value() : LinkConditions{};
}

std::string error_of(std::string_view text) {
    const Result<LinkConditions> result = parse_link_conditions(text);
    return result.ok() ? "accepted" : result.error().message;
}

/// `value` is no quantity of `key`, and the error says what would be.
void expect_refused(const std::string& key, const std::string& value, const char* expected) {
    std::string text = key;
    text.append("=").append(value);
    std::string error = key;
    error.append(" \"").append(value).append("\": expected a number ").append(expected);
    EXPECT_EQ(error_of(text), error);
}

TEST(LinkConditions, ReadsEveryKey) {
    LinkConditions expected;
    expected.latency_us = 40'000;
    expected.jitter_us = 10'000;
    expected.loss_ppm = 20'000;
    expected.duplicate_ppm = 10'000;
    expected.reorder_ppm = 5'000;
    expected.bandwidth_bytes_per_s = 500'000;
    EXPECT_EQ(parsed("latency=40ms,jitter=10ms,loss=2%,duplicate=1%,reorder=0.5%,"
                     "bandwidth=500kB/s"),
              expected);
    EXPECT_EQ(parsed("bandwidth=0.5MB/s,reorder=0.50%,duplicate=1.0%,loss=2%,jitter=10000us,"
                     "latency=0.04s"),
              expected);
}

TEST(LinkConditions, LeavesWhatIsNotNamedPerfect) {
    LinkConditions expected;
    expected.loss_ppm = 1;
    EXPECT_EQ(parsed("loss=0.0001%"), expected);
    EXPECT_EQ(parsed("loss=0%"), LinkConditions{});
    EXPECT_EQ(parsed("loss=100%").loss_ppm, 1'000'000U);
    EXPECT_EQ(parsed("latency=60s").latency_us, 60'000'000U);
}

TEST(LinkConditions, SaysWhatIsWrong) {
    EXPECT_EQ(error_of(""), "link condition \"\": expected key=value, as in latency=40ms,loss=2%");
    EXPECT_EQ(error_of("loss=1%,"),
              "link condition \"\": expected key=value, as in latency=40ms,loss=2%");
    EXPECT_EQ(error_of("lossy"),
              "link condition \"lossy\": expected key=value, as in latency=40ms,loss=2%");
    EXPECT_EQ(error_of("delay=1ms"),
              "unknown link condition \"delay\"; known are latency, jitter, "
              "loss, duplicate, reorder, bandwidth");
    EXPECT_EQ(error_of("loss=1%,loss=2%"), "link condition loss is given twice");
    EXPECT_EQ(error_of("latency=5ms,jitter=6ms"),
              "jitter is above latency: packets would arrive before they are sent");
    for (const char* value : {"",
                              "40",
                              "ms",
                              "40 ms",
                              "-1ms",
                              "1e3ms",
                              ".5ms",
                              "5.ms",
                              "1.2.3ms",
                              "0.0001ms",
                              "40kB/s",
                              "60.000001s",
                              "99999999999999999999s"}) {
        expect_refused("latency", value, "in us, ms or s, at most 60s");
    }
    for (const char* value : {"2", "101%", "0.00001%", "100.0001%", "2ms", "-2%"}) {
        expect_refused("loss", value, "in %, at most 100%");
    }
    EXPECT_EQ(error_of("bandwidth=0kB/s"),
              "bandwidth \"0kB/s\": expected a number in kB/s or MB/s, at least 1kB/s");
}

} // namespace
} // namespace lockwind

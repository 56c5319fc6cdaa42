#include "forensics/diff.h"
#include "forensics/diff_output.h"
#include "tests/unit/log/log_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <regex>

namespace lockwind::test {
namespace {

DiffResult sample() {
    DiffResult result;
    result.same = false;
    result.first_tick = 300;
    result.phase = "outside_step";
    result.section = "body";
    result.fields = {{"body",
                      "17",
                      "linear_velocity.x",
                      "m/s",
                      {"262144", "0.25"},
                      {"-9223372036854775808", "-8796093022208"}},
                     {"pair", "1-17", "row_count", "", {"4", "4"}, {}}};
    result.field_count = 2;
    result.verdict = Verdict::corrupted_state;
    result.slot = 2;
    result.name_a = "server";
    result.name_b = "slot 2";
    result.reason = "a < b & \"c\"";
    return result;
}

/// True where every tag is closed in order: enough to tell XML that parses from XML that does not.
bool well_formed(const std::string& xml) {
    const std::regex tag(R"(<(/?)([a-z]+)((?: [a-z]+="[^"<]*")*)(/?)>)");
    std::vector<std::string> open;
    std::string rest;
    auto at = xml.cbegin();
    for (std::sregex_iterator match(xml.begin(), xml.end(), tag), end; match != end; ++match) {
        rest.append(at, (*match)[0].first);
        at = (*match)[0].second;
        if ((*match)[1].length() > 0) {
            if (open.empty() || open.back() != (*match)[2]) {
                return false;
            }
            open.pop_back();
        } else if ((*match)[4].length() == 0) {
            open.push_back((*match)[2]);
        }
    }
    rest.append(at, xml.cend());
    rest = rest.substr(rest.find("?>") + 2);
    return open.empty() && rest.find('<') == std::string::npos;
}

TEST(DiffOutput, SaysItInLinesForAPerson) {
    EXPECT_EQ(diff_text(sample()),
              "diverged at tick 300, phase outside_step\n"
              "  verdict     corrupted_state\n"
              "  section     body\n"
              "  entity      17\n"
              "  field       linear_velocity.x\n"
              "  server      0.25 m/s (raw 262144)\n"
              "  slot 2      -8796093022208 m/s (raw -9223372036854775808)\n"
              "  because     a < b & \"c\"\n"
              "  1 more:\n"
              "    pair 1-17 row_count  4  |  (no such row)\n");
    EXPECT_EQ(diff_text(DiffResult{}), "same\n");
}

TEST(DiffOutput, HasTheContractsFieldsInJson) {
    const nlohmann::json json = nlohmann::json::parse(diff_json(sample()));
    EXPECT_EQ(json["same"], false);
    EXPECT_EQ(json["first_tick"], 300);
    EXPECT_EQ(json["phase"], "outside_step");
    EXPECT_EQ(json["section"], "body");
    EXPECT_EQ(json["entity"], "17");
    EXPECT_EQ(json["field"], "linear_velocity.x");
    EXPECT_EQ(json["a"]["raw"], 262144);
    EXPECT_EQ(json["a"]["decimal"], "0.25");
    EXPECT_EQ(json["b"]["raw"], INT64_MIN);
    EXPECT_EQ(json["verdict"], "corrupted_state");
    EXPECT_EQ(json["fields"].size(), 2U);
    EXPECT_TRUE(json["fields"][1]["b"].is_null());
    const nlohmann::json same = nlohmann::json::parse(diff_json(DiffResult{}));
    EXPECT_EQ(same["same"], true);
    for (const char* name :
         {"first_tick", "phase", "section", "entity", "field", "a", "b", "verdict"}) {
        EXPECT_TRUE(same.contains(name) && same[name].is_null()) << name;
    }
}

TEST(DiffOutput, KeepsHashesAsText) {
    DiffResult result = sample();
    result.fields[0].a.raw = "0000000000000012";
    result.fields[0].b.raw = "18446744073709551615";
    const nlohmann::json json = nlohmann::json::parse(diff_json(result));
    EXPECT_EQ(json["a"]["raw"], "0000000000000012");
    EXPECT_EQ(json["b"]["raw"], UINT64_MAX);
}

TEST(DiffOutput, WritesJUnitThatParses) {
    const std::string failing = diff_junit(sample(), "a \"quoted\" <name> & \x01 more");
    EXPECT_TRUE(well_formed(failing)) << failing;
    EXPECT_NE(failing.find("failures=\"1\""), std::string::npos);
    EXPECT_NE(failing.find("<failure type=\"corrupted_state\""), std::string::npos);
    EXPECT_NE(failing.find("a &lt; b &amp; &quot;c&quot;"), std::string::npos);
    const std::string passing = diff_junit(DiffResult{}, "a b");
    EXPECT_TRUE(well_formed(passing)) << passing;
    EXPECT_EQ(passing.find("<failure"), std::string::npos);
}

class LogDiffTest : public LogFixture {
protected:
    struct Change {
        std::function<void(LogHeader&)> header;
        std::function<void(Tick, std::vector<SlotInput>&)> inputs;
        std::function<void(Tick, std::uint64_t&)> hash;
        Tick ticks = 5;
    };

    std::string write(const std::string& name, const Change& change) {
        LogHeader header = golden_header();
        if (change.header) {
            change.header(header);
        }
        Result<std::unique_ptr<LogWriter>> log = LogWriter::create(path(name), header);
        EXPECT_TRUE(log.ok());
        for (Tick tick = 1; tick <= change.ticks; ++tick) {
            std::vector<SlotInput> inputs = golden_inputs(tick);
            std::uint64_t hash = golden_hash(tick);
            if (change.inputs) {
                change.inputs(tick, inputs);
            }
            if (change.hash) {
                change.hash(tick, hash);
            }
            EXPECT_TRUE(log.value()->write_tick(tick, inputs, hash).ok());
        }
        return path(name);
    }

    DiffResult compare(const Change& change) {
        std::filesystem::remove(path("a.log"));
        std::filesystem::remove(path("b.log"));
        Result<LogReader> a = LogReader::open(write("a.log", {}));
        Result<LogReader> b = LogReader::open(write("b.log", change));
        return diff_logs(a.value(), b.value());
    }
};

TEST_F(LogDiffTest, EqualMatchesAreTheSame) {
    EXPECT_TRUE(compare({}).same);
    Change shorter;
    shorter.ticks = 3;
    shorter.header = [](LogHeader& header) { header.build_info = "clang 14"; };
    const DiffResult diff = compare(shorter);
    EXPECT_TRUE(diff.same);
    EXPECT_NE(diff.reason.find("ends earlier"), std::string::npos);
}

TEST_F(LogDiffTest, NamesTheFirstInputThatDiffers) {
    Change change;
    change.inputs = [](Tick tick, std::vector<SlotInput>& inputs) {
        inputs[0].bytes[2] = tick >= 3 ? 77 : inputs[0].bytes[2];
    };
    change.hash = [](Tick tick, std::uint64_t& hash) { hash ^= tick >= 3 ? 1U : 0U; };
    const DiffResult diff = compare(change);
    EXPECT_EQ(diff.verdict, Verdict::inputs_differ);
    EXPECT_EQ(diff.first_tick, 3U);
    EXPECT_EQ(diff.fields[0].entity, "slot 0");
    EXPECT_EQ(diff.fields[0].field, "bytes[2]");
    EXPECT_EQ(diff.fields[0].b.raw, "77");
}

TEST_F(LogDiffTest, NamesTheFirstHashThatDiffers) {
    Change change;
    change.hash = [](Tick tick, std::uint64_t& hash) { hash ^= tick >= 4 ? 1U : 0U; };
    DiffResult diff = compare(change);
    EXPECT_EQ(diff.verdict, Verdict::nondeterminism);
    EXPECT_EQ(diff.first_tick, 4U);
    EXPECT_EQ(diff.fields[0].field, "state_hash");
    EXPECT_EQ(diff.fields[0].a.raw, hash_text(golden_hash(4)));
    change.header = [](LogHeader& header) { header.build_info = "clang 14"; };
    EXPECT_EQ(compare(change).verdict, Verdict::build_differs);
}

TEST_F(LogDiffTest, NamesTheSettingThatDiffers) {
    Change change;
    change.header = [](LogHeader& header) {
        header.config.scene_text = "name: \"other\"\n";
        header.config.tick_rate_hz = 30;
    };
    const DiffResult diff = compare(change);
    EXPECT_EQ(diff.verdict, Verdict::settings_differ);
    ASSERT_EQ(diff.fields.size(), 2U);
    EXPECT_EQ(diff.fields[0].field, "scene_text line 1");
    EXPECT_EQ(diff.fields[0].b.raw, "name: \"other\"");
    EXPECT_EQ(diff.fields[1].field, "tick_rate_hz");
}

} // namespace
} // namespace lockwind::test

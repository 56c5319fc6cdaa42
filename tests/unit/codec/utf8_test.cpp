#include "codec/utf8.h"

#include <gtest/gtest.h>

namespace lockwind {
namespace {

TEST(Utf8, AcceptsTheFirstAndLastCharacterOfEachLength) {
    using namespace std::string_view_literals;
    for (const std::string_view text : {""sv,
                                        "\0"sv,
                                        "\x7f"sv,
                                        "\xc2\x80"sv,
                                        "\xdf\xbf"sv,
                                        "\xe0\xa0\x80"sv,
                                        "\xed\x9f\xbf"sv,
                                        "\xee\x80\x80"sv,
                                        "\xef\xbf\xbf"sv,
                                        "\xf0\x90\x80\x80"sv,
                                        "\xf4\x8f\xbf\xbf"sv}) {
        EXPECT_TRUE(is_utf8(text)) << text;
    }
}

TEST(Utf8, RefusesWhatIsNotACharacter) {
    for (const std::string_view text : {"\x80",             // no lead byte
                                        "\xc2",             // cut off
                                        "\xe2\x82",         // cut off
                                        "\xc0\xaf",         // overlong
                                        "\xe0\x80\xaf",     // overlong
                                        "\xf0\x8f\xbf\xbf", // overlong
                                        "\xed\xa0\x80",     // surrogate
                                        "\xf4\x90\x80\x80", // above U+10FFFF
                                        "\xf5\x80\x80\x80", // above U+10FFFF
                                        "\xff"}) {
        EXPECT_FALSE(is_utf8(text));
        EXPECT_FALSE(is_utf8("ok " + std::string(text)));
    }
}

TEST(Utf8, CleansToUtf8AndCutsBetweenCharacters) {
    EXPECT_EQ(clean_text("h\xc3\xa9llo", 100), "h\xc3\xa9llo");
    EXPECT_EQ(clean_text("h\xc3\xa9llo", 2), "h");
    EXPECT_EQ(clean_text("h\xc3\xa9llo", 3), "h\xc3\xa9");
    EXPECT_EQ(clean_text("\xe2\x82z\xff", 100), "??z?");
    EXPECT_EQ(clean_text("abc", 0), "");
}

} // namespace
} // namespace lockwind

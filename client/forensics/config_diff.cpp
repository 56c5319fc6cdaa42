#include "forensics/config_diff.h"

#include <string_view>

namespace lockwind {

namespace {

constexpr std::size_t kLineBytesShown = 120;

/// The next line of `text`, which loses it and its end.
std::string_view take_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return line;
}

ConfigDiff diff_scene_texts(std::string_view a, std::string_view b) {
    std::string_view line_a;
    std::string_view line_b;
    std::size_t number = 0;
    while (line_a == line_b && (!a.empty() || !b.empty())) {
        ++number;
        line_a = take_line(a);
        line_b = take_line(b);
    }
    return {"scene_text line " + std::to_string(number),
            std::string(line_a.substr(0, kLineBytesShown)),
            std::string(line_b.substr(0, kLineBytesShown))};
}

} // namespace

std::vector<ConfigDiff> diff_configs(const MatchConfig& a, const MatchConfig& b) {
    std::vector<ConfigDiff> differing;
    const auto compare =
        [&](std::string_view field, const std::string& left, const std::string& right) {
            if (left != right) {
                differing.push_back({std::string(field), left, right});
            }
        };
    compare("mode", a.mode, b.mode);
    compare("scene_name", a.scene_name, b.scene_name);
    if (a.scene_text != b.scene_text) {
        differing.push_back(diff_scene_texts(a.scene_text, b.scene_text));
    }
    compare("seed", std::to_string(a.seed), std::to_string(b.seed));
    compare("tick_rate_hz", std::to_string(a.tick_rate_hz), std::to_string(b.tick_rate_hz));
    compare("players", std::to_string(a.players), std::to_string(b.players));
    compare("input_delay_ticks",
            std::to_string(a.input_delay_ticks),
            std::to_string(b.input_delay_ticks));
    compare("hash_interval_ticks",
            std::to_string(a.hash_interval_ticks),
            std::to_string(b.hash_interval_ticks));
    compare("ticks", std::to_string(a.ticks), std::to_string(b.ticks));
    return differing;
}

} // namespace lockwind

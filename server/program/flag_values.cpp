#include "program/flag_values.h"

#include <charconv>
#include <fmt/format.h>

namespace lockwind {

CLI::Validator not_empty() {
    return CLI::Validator(
        [](const std::string& text) { return std::string(text.empty() ? "is empty" : ""); },
        "",
        "not_empty");
}

CLI::Validator whole_number(std::uint64_t least, std::uint64_t most) {
    const auto check = [least, most](const std::string& text) -> std::string {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool is_number = error == std::errc{} && end == text.data() + text.size();
        if (is_number && value >= least && value <= most) {
            return "";
        }
        return fmt::format("'{}' is no whole number from {} to {}", text, least, most);
    };
    return CLI::Validator(check, "", "whole_number");
}

} // namespace lockwind

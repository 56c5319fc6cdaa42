#include "log/log_format.h"

#include <array>

namespace lockwind {

std::string_view to_text(LogEnd end) {
    constexpr std::array<std::string_view, 3> kNames{"summary", "interrupted", "damaged"};
    return kNames[static_cast<std::size_t>(end)];
}

bool is_logged(const Event& event) {
    return event.type == EventType::created || event.type == EventType::destroyed ||
           event.type == EventType::score;
}

std::string hash_text(std::uint64_t hash) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text(16, '0');
    for (std::size_t index = 0; index < text.size(); ++index) {
        text[text.size() - 1 - index] = kDigits[(hash >> (4 * index)) & 15U];
    }
    return text;
}

} // namespace lockwind

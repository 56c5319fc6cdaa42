#include "program/console.h"

#include <fmt/format.h>
#include <memory>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace lockwind {

void set_up_messages() {
    auto logger = spdlog::stderr_color_st("lockwind");
    logger->set_pattern("%H:%M:%S.%e %^%l%$ %v");
    spdlog::set_default_logger(std::move(logger));
}

void say_info(std::string_view text) {
    spdlog::info("{}", text);
}

void say_warning(std::string_view text) {
    spdlog::warn("{}", text);
}

void say_error(std::string_view text) {
    fmt::print(stderr, "error: {}\n", text);
}

std::string describe(const SessionEvent& event) {
    std::string line(to_string(event.kind));
    if (event.slot != kNoSlot) {
        line += fmt::format(", slot {}", event.slot);
    }
    line += fmt::format(", tick {}", event.tick);
    // Whoever comes is described by the build it runs: long, and in the log.
    const bool arrival = event.kind == SessionEventKind::synchronizing ||
                         event.kind == SessionEventKind::joined ||
                         event.kind == SessionEventKind::reconnected;
    if (!event.text.empty() && !arrival) {
        line += fmt::format(": {}", event.text);
    }
    return line;
}

} // namespace lockwind

#include "program/progress.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace lockwind {

namespace {

constexpr std::uint64_t kBarWidth = 30;
constexpr std::uint64_t kUnknownTotalStep =
    600; // one drawing every so many, where no total is known

} // namespace

Progress::Progress(std::string_view label, std::uint64_t total)
    : label_(label), total_(total), terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
    finish();
}

void Progress::update(std::uint64_t done, std::string_view note) {
    const std::uint64_t parts = terminal_ ? 100 : 10;
    const std::uint64_t reached =
        total_ > 0 ? std::min(done, total_) * parts / total_ : done / kUnknownTotalStep;
    done_ = done;
    if (finished_ || reached == drawn_) {
        return;
    }
    drawn_ = reached;
    draw(note);
}

void Progress::finish() {
    if (!finished_ && terminal_ && drawn_ > 0) {
        std::fputc('\n', stderr);
    }
    finished_ = true;
}

void Progress::draw(std::string_view note) {
    const std::string count =
        total_ > 0 ? fmt::format("{}/{}", done_, total_) : fmt::format("{}", done_);
    if (!terminal_) {
        fmt::print(stderr, "{} {}{}{}\n", label_, count, note.empty() ? "" : "  ", note);
        return;
    }
    const auto filled =
        static_cast<std::size_t>(total_ > 0 ? std::min(done_, total_) * kBarWidth / total_ : 0);
    const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
    fmt::print(stderr, "\r{} [{}] {}  {}\x1b[K", label_, bar, count, note);
    std::fflush(stderr);
}

} // namespace lockwind

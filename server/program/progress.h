#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lockwind {

/// How far something is, on stderr: a bar that redraws itself on a terminal, a line every tenth
/// elsewhere.
class Progress {
public:
    /// `total` 0: unknown; then only counts are shown.
    Progress(std::string_view label, std::uint64_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// `note` stands behind the numbers. Cheap to call often.
    void update(std::uint64_t done, std::string_view note = {});
    /// Draws the last state and ends the line; nothing is drawn afterwards.
    void finish();

private:
    void draw(std::string_view note);

    std::string label_;
    std::uint64_t total_;
    std::uint64_t done_ = 0;
    std::uint64_t drawn_ = 0; // hundredths (terminal) or tenths that are on the screen
    bool terminal_;
    bool finished_ = false;
};

} // namespace lockwind

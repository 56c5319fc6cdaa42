#pragma once

#include "session/request.h"

#include <string>
#include <string_view>

namespace lockwind {

/// Messages of a program go to stderr, a line each: time, level, text.
void set_up_messages();
void say_info(std::string_view text);
void say_warning(std::string_view text);
/// Prefixed by "error: "; the last thing a failing program says.
void say_error(std::string_view text);

/// An event of a session as a line.
std::string describe(const SessionEvent& event);

} // namespace lockwind

#pragma once

namespace lockwind {

/// Prints `what` with its place to stderr and aborts. Never returns.
[[noreturn]] void assert_failed(const char* what, const char* file, int line);

} // namespace lockwind

/// A caller's misuse or a broken invariant; stays on in every build. Bytes from a peer or a file
/// never reach it: they are checked and refused with an Error.
#define LOCKWIND_ASSERT(condition)                                                                 \
    (static_cast<bool>(condition) ? static_cast<void>(0)                                           \
                                  : ::lockwind::assert_failed(#condition, __FILE__, __LINE__))

#pragma once

namespace lockwind {

/// From now on SIGINT and SIGTERM are noted instead of ending the process; a second one ends it.
void catch_stop_signals();

/// True once one has come.
bool stop_requested();

} // namespace lockwind

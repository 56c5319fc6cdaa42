#include "bots_command.h"
#include "program/console.h"
#include "program/exit_code.h"

namespace lockwind {

/// In place of bots_command.cpp where LOCKWIND_DDS is off.
int run_bots(const BotsOptions& /*options*/) {
    say_error("this lockwind was built without DDS, which carries a match: it reads and verifies "
              "what matches leave behind; build with -DLOCKWIND_DDS=ON to play");
    return kExitUsage;
}

} // namespace lockwind

#include "lockwind/vector.h"

lockwind::Velocity scale(lockwind::Velocity speed, lockwind::Coefficient factor) {
#ifdef MISTAKE
    return speed * factor;
#else
    return lockwind::round_to<lockwind::Velocity>(lockwind::product(speed, factor));
#endif
}

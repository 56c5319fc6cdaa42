#include "lockwind/vector.h"

lockwind::Real convert_speed(double metres_per_second) {
#ifdef MISTAKE
    return lockwind::Real(metres_per_second);
#else
    return metres_per_second < 0 ? lockwind::Real(-0.5) : lockwind::Real(0.5);
#endif
}

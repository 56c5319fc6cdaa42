#define LOCKWIND_CHECKED 1
#include "lockwind/vector.h"

#ifdef MISTAKE
constexpr lockwind::Real kArea = lockwind::Real(46341) * lockwind::Real(46341);
#else
constexpr lockwind::Real kArea = lockwind::Real(46340) * lockwind::Real(46340);
#endif

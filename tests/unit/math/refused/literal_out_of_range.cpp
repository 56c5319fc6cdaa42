#include "lockwind/vector.h"

#ifdef MISTAKE
lockwind::Unit value() {
    return lockwind::Unit(2.0);
}
#else
lockwind::Unit value() {
    return lockwind::Unit(-2.0);
}
#endif

#include "geometry/shape_library.h"

#include <string>

namespace lockwind {

Result<ShapeLibrary> ShapeLibrary::create(std::span<const HullDefinition> hulls) {
    if (hulls.size() > kHullsMax) {
        return Error{"hulls: " + std::to_string(hulls.size()) + ", but there may be at most " +
                     std::to_string(kHullsMax)};
    }
    ShapeLibrary library;
    for (std::size_t index = 0; index < hulls.size(); ++index) {
        Result<Hull> hull = make_hull(hulls[index].points);
        if (!hull) {
            return Error{"hull " + std::to_string(index) + ": " + hull.error().message};
        }
        library.hulls_.push_back(hull.value());
    }
    return library;
}

} // namespace lockwind

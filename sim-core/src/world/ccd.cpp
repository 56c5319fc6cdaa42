#include "lockwind/ccd.h"

#include "dynamics/make_body.h"
#include "geometry/pair_kernels.h"
#include "world/impl.h"

#include "lockwind/assert.h"

#include <algorithm>

namespace lockwind {

namespace {

Real smallest_size(const BodyProperties& body, const ShapeLibrary& shapes) {
    constexpr std::int32_t kNotTurned[9] = {kUnitOne, 0, 0, 0, kUnitOne, 0, 0, 0, kUnitOne};
    const Girth girth = girth_of(shape_of(body, shapes, kNotTurned));
    return convert<Real>(Length::from_raw(girth.shortest)) * 2;
}

/// m/s; a ball's surface goes nowhere by its spin.
Real fastest_point(const BodyReading& reading, const BodyProperties& body) {
    const Real linear = length(reading.linear_velocity);
    return reading.shape.type == ShapeType::sphere
               ? linear
               : linear + length(reading.angular_velocity) *
                              convert<Real>(Length::from_raw(body.bounding_radius));
}

} // namespace

std::vector<FastBody> World::fast_bodies() const {
    const DynamicsTables tables = impl_->tables();
    std::vector<FastBody> fast;
    for (BodyRow row = 0; row < tables.motion.count(); ++row) {
        const BodyProperties& body = tables.properties[row];
        const BodyReading reading = read_body(tables.motion[row], body, impl_->shapes);
        if (reading.mode != BodyMode::dynamic) {
            continue;
        }
        const Real way = fastest_point(reading, body) / Real(impl_->settings.tick_rate_hz);
        const Real size = smallest_size(body, impl_->shapes);
        if (2 * way > size) {
            fast.push_back({tables.motion[row].id,
                            static_cast<CollisionMode>(body.collision_mode),
                            way,
                            size});
        }
    }
    return fast;
}

Real wall_thickness_min(CollisionMode mode, Real size, Real speed, std::uint32_t tick_rate_hz) {
    LOCKWIND_ASSERT(tick_rate_hz > 0 && size >= 0 && speed >= 0);
    if (mode != CollisionMode::discrete) {
        return 0;
    }
    const Real way = speed / Real(tick_rate_hz);
    return std::max(Real(0), 2 * way - size);
}

} // namespace lockwind

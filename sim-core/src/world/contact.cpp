#include "dynamics/activity.h"
#include "dynamics/make_body.h"
#include "dynamics/pair_parts.h"
#include "dynamics/pairing.h"
#include "dynamics/solver_format.h"
#include "dynamics/substep_classes.h"
#include "geometry/rotation.h"
#include "systems/motion.h"
#include "world/impl.h"

#include <algorithm>

namespace lockwind {

namespace {

/// Where a point of the body is now, m, that was at `arm` (Q9.22 m) from its centre when the body
/// was turned by `orientation`; the identity for a sphere, whose contacts do not turn with it.
Vec3 place_of(const BodyMotion& motion,
              const std::int32_t arm[3],
              const std::int32_t orientation[4],
              bool turns) {
    std::int32_t then[9];
    std::int32_t local[3];
    rotation_matrix(orientation, then);
    inverse_rotate(then, arm, local);
    const Vec3 place{convert<Real>(Length::from_raw(local[0])),
                     convert<Real>(Length::from_raw(local[1])),
                     convert<Real>(Length::from_raw(local[2]))};
    return read_position(motion) + (turns ? rotate(read_orientation(motion), place) : place);
}

/// N from an impulse x (1/m_a + 1/m_b) of one substep.
Real force_of(std::int32_t impulse, std::int64_t inverse_mass, std::int64_t substep_rate) {
    if (inverse_mass <= 0) {
        return 0;
    }
    // Q11.20 x 2^52 / Q24.40 = Q.32
    return Real::from_raw(
        multiply_divide(std::int64_t{impulse} * substep_rate, std::int64_t{1} << 52, inverse_mass));
}

ContactView view_of(const DynamicsTables& tables, const Pair& pair, std::int64_t substep_rate) {
    const Manifold& manifold = tables.manifolds[pair.manifold];
    const ContactImpulse& impulse = tables.impulses[pair.manifold];
    const BodyMotion& a = tables.motion[pair.row_a];
    const BodyMotion& b = tables.motion[pair.row_b];
    const BodyProperties& of_a = tables.properties[pair.row_a];
    const BodyProperties& of_b = tables.properties[pair.row_b];
    ContactView view{};
    view.body_a = a.id;
    view.body_b = b.id;
    if (pair.child != 0) {
        const PartIndices parts =
            parts_of(pair.child, is_surface(static_cast<ShapeType>(of_b.shape)));
        view.part_a = parts.a;
        view.part_b = parts.b;
    }
    view.sensor = is_sensing(of_a, of_b);
    view.normal = {convert<Real>(Unit::from_raw(manifold.normal[0])),
                   convert<Real>(Unit::from_raw(manifold.normal[1])),
                   convert<Real>(Unit::from_raw(manifold.normal[2]))};
    view.point_count = pair.point_count;
    constexpr auto kSphere = static_cast<std::uint8_t>(ShapeType::sphere);
    for (std::uint32_t index = 0; index < pair.point_count; ++index) {
        const std::int32_t* arm_a = manifold.anchor_a + 3 * index;
        std::int32_t arm_b[3];
        for (int axis = 0; axis < 3; ++axis) {
            arm_b[axis] = raw_subtract(arm_a[axis], manifold.centre_delta[axis]);
        }
        const Vec3 of_a_now = place_of(a, arm_a, manifold.orientation_a, of_a.shape != kSphere);
        const Vec3 of_b_now = place_of(b, arm_b, manifold.orientation_b, of_b.shape != kSphere);
        ContactView::Point& point = view.points[index];
        point.position = (of_a_now + of_b_now) / Real(2);
        point.separation = convert<Real>(Length::from_raw(manifold.separation[index])) +
                           dot(view.normal, of_b_now - of_a_now);
        point.normal_force =
            force_of(impulse.normal[index], of_a.inverse_mass + of_b.inverse_mass, substep_rate);
    }
    return view;
}

} // namespace

std::vector<ContactView> World::contacts() const {
    const DynamicsTables tables = impl_->tables();
    // Of those that sleep, too: their impulses are those of the last tick that they were awake in.
    std::vector<BodySleep> awake(tables.motion.count());
    std::uint32_t count = tables.motion.count();
    Activity all(impl_->capacities);
    all.read_rows({awake.data(), &count, count});
    all.read_pairs(tables.pairs);
    all.read_joints(tables.joints);
    SubstepClasses classes(impl_->capacities);
    const bool differ = classes.read(tables, all);
    const auto rate_of = [&](const Pair& pair) {
        constexpr auto kDynamic = static_cast<std::uint8_t>(BodyMode::dynamic);
        const bool a_moves = tables.properties[pair.row_a].mode == kDynamic;
        const std::uint32_t substeps =
            differ ? classes.of(a_moves ? pair.row_a : pair.row_b) : impl_->settings.substeps;
        return std::int64_t{impl_->settings.tick_rate_hz} * substeps;
    };
    std::vector<ContactView> views;
    for (const Pair& pair : tables.pairs.rows()) {
        if (pair.point_count != 0) {
            views.push_back(view_of(tables, pair, rate_of(pair)));
        }
    }
    return views;
}

} // namespace lockwind

#include "bullet_world.h"

#include <algorithm>
#include <btBulletDynamicsCommon.h>
#include <cmath>
#include <vector>

namespace lockwind::bench {
namespace {

btScalar to_scalar(Real value) {
    return static_cast<btScalar>(static_cast<double>(value.raw()) / 4294967296.0);
}

btVector3 to_vector(const Vec3& v) {
    return {to_scalar(v.x), to_scalar(v.y), to_scalar(v.z)};
}

btTransform to_transform(const BodyDefinition& body) {
    const RealQuat& q = body.orientation;
    const btQuaternion turn(to_scalar(q.x), to_scalar(q.y), to_scalar(q.z), to_scalar(q.w));
    return btTransform(turn.normalized(), to_vector(body.position));
}

/// Without a margin: btConvexHullShape's would be added to the points.
std::unique_ptr<btCollisionShape> make_hull_shape(const HullDefinition& hull) {
    auto shape = std::make_unique<btConvexHullShape>();
    for (const Vec3& point : hull.points) {
        shape->addPoint(to_vector(point), false);
    }
    shape->recalcLocalAabb();
    shape->optimizeConvexHull();
    shape->setMargin(0);
    return shape;
}

std::unique_ptr<btCollisionShape> make_shape(const ShapeDefinition& shape,
                                             const std::vector<HullDefinition>& hulls) {
    switch (shape.type) {
    case ShapeType::sphere:
        return std::make_unique<btSphereShape>(to_scalar(shape.radius));
    case ShapeType::capsule:
        return std::make_unique<btCapsuleShape>(to_scalar(shape.radius),
                                                2 * to_scalar(shape.half_height));
    case ShapeType::box:
        return std::make_unique<btBoxShape>(to_vector(shape.half_extents));
    case ShapeType::hull:
        return make_hull_shape(hulls[shape.hull]);
    default: // scenes that Bullet is measured with have no others
        break;
    }
    return std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), 0);
}

} // namespace

struct BulletWorld::Impl {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broad_phase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broad_phase, &solver, &configuration};
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    btScalar period = 0;

    void add(const BodyDefinition& body, const std::vector<HullDefinition>& hulls);
};

void BulletWorld::Impl::add(const BodyDefinition& body, const std::vector<HullDefinition>& hulls) {
    shapes.push_back(make_shape(body.shape, hulls));
    btCollisionShape* shape = shapes.back().get();
    const bool dynamic = body.mode == BodyMode::dynamic;
    const btScalar mass = dynamic ? to_scalar(body.mass) : 0;
    btVector3 inertia(0, 0, 0);
    if (dynamic) {
        shape->calculateLocalInertia(mass, inertia);
    }
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia);
    info.m_startWorldTransform = to_transform(body);
    info.m_friction = std::sqrt(to_scalar(body.friction)); // Bullet multiplies a pair's two
    info.m_restitution = to_scalar(body.restitution);
    bodies.push_back(std::make_unique<btRigidBody>(info));
    if (dynamic) {
        bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    }
    world.addRigidBody(bodies.back().get());
}

BulletWorld::BulletWorld(const WorldDefinition& definition) : impl_(std::make_unique<Impl>()) {
    impl_->world.setGravity(to_vector(definition.settings.gravity));
    impl_->world.getSolverInfo().m_numIterations = 10;
    impl_->world.getSolverInfo().m_splitImpulse = 1;
    impl_->period = btScalar(1) / static_cast<btScalar>(definition.settings.tick_rate_hz);
    for (const BodyDefinition& body : definition.bodies) {
        impl_->add(body, definition.hulls);
    }
}

BulletWorld::~BulletWorld() {
    for (const auto& body : impl_->bodies) {
        impl_->world.removeRigidBody(body.get());
    }
}

void BulletWorld::step() {
    impl_->world.stepSimulation(impl_->period, 0);
}

std::uint32_t BulletWorld::contact_count() const {
    std::uint32_t count = 0;
    for (int index = 0; index < impl_->dispatcher.getNumManifolds(); ++index) {
        const btPersistentManifold& manifold = *impl_->dispatcher.getManifoldByIndexInternal(index);
        count += static_cast<std::uint32_t>(manifold.getNumContacts());
    }
    return count;
}

double BulletWorld::penetration_mm() const {
    double deepest = 0;
    for (int index = 0; index < impl_->dispatcher.getNumManifolds(); ++index) {
        const btPersistentManifold& manifold = *impl_->dispatcher.getManifoldByIndexInternal(index);
        for (int point = 0; point < manifold.getNumContacts(); ++point) {
            deepest = std::max(deepest, -1000.0 * manifold.getContactPoint(point).getDistance());
        }
    }
    return deepest;
}

std::uint32_t BulletWorld::awake_count() const {
    return static_cast<std::uint32_t>(
        std::count_if(impl_->bodies.begin(), impl_->bodies.end(), [](const auto& body) {
            return !body->isStaticObject() && body->isActive();
        }));
}

} // namespace lockwind::bench

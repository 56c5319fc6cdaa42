#pragma once

#include "tests/support/code_scenes.h"

#include "lockwind/rng.h"

#include <cstdint>
#include <vector>

// Worlds full of every shape, and queries of every kind against them.
namespace lockwind::test {

/// Draws that follow from a seed.
class QueryDraws {
public:
    explicit QueryDraws(std::uint64_t seed) : seed_(seed) {}

    std::uint64_t bits() { return random_u64(seed_, 0, next_++); }
    /// -1 .. 1
    Real symmetric() { return random_symmetric(seed_, 1, next_++); }
    Real within(Real low, Real high) {
        return low + (high - low) * (symmetric() + Real(1)) * Real(0.5);
    }
    Vec3 vector(Real half) { return {half * symmetric(), half * symmetric(), half * symmetric()}; }
    RealQuat orientation() {
        return normalized(RealQuat{symmetric(), symmetric(), symmetric(), symmetric()});
    }
    ShapeDefinition shape(Real low, Real high) {
        ShapeDefinition made;
        constexpr ShapeType kTypes[] = {
            ShapeType::sphere, ShapeType::capsule, ShapeType::box, ShapeType::hull};
        made.type = kTypes[bits() % 4];
        made.radius = within(low, high);
        made.half_height = within(low, high);
        made.half_extents = {within(low, high), within(low, high), within(low, high)};
        return made;
    }

private:
    std::uint64_t seed_;
    std::uint64_t next_ = 0;
};

/// A lop-sided wedge: its centre of mass and principal axes are not those of its points.
inline HullDefinition wedge() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 0.25}}};
}

/// `count` bodies of ids 10, 11 ... that fly about in a box of `half`, m, over a ground and under a
/// long fixed beam; layers 0 .. 3, every fifth a sensor. All moved by `offset`.
inline WorldDefinition query_scene(std::uint32_t count, Real half, const Vec3& offset = {}) {
    WorldDefinition definition;
    definition.settings.gravity = {0, 0, 0};
    definition.settings.bounds = 16000;
    definition.hulls = {wedge()};
    BodyDefinition floor = ground(1);
    floor.position = offset - Vec3{0, half, 0};
    definition.bodies.push_back(floor);
    BodyDefinition beam = box(2, offset + Vec3{0, half, 0}, {150, 0.5, 0.5});
    beam.mode = BodyMode::fixed;
    beam.orientation = {0, 0.6, 0, 0.8};
    definition.bodies.push_back(beam);
    QueryDraws draws(7);
    for (std::uint32_t index = 0; index < count; ++index) {
        BodyDefinition body;
        body.id = 10 + index;
        body.shape = draws.shape(0.2, 0.8);
        body.position = draws.vector(half) + offset;
        body.orientation = draws.orientation();
        body.linear_velocity = draws.vector(10);
        body.angular_velocity = draws.vector(3);
        body.layer = index % 4;
        body.sensor = index % 5 == 0;
        definition.bodies.push_back(body);
    }
    return definition;
}

} // namespace lockwind::test

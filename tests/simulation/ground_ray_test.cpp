#include "tests/simulation/measures.h"

#include "lockwind/wide.h"

#include <gtest/gtest.h>
#include <iostream>

// Rays onto ground of two kilometres. An engine in float, whose step at 1 km is 61 um, is off by
// that; one that casts against a triangle or a box of that size falls through its seams.
namespace lockwind::test {
namespace {

/// Top at y = 0; sixteen boxes of 500 m, the largest that there are.
WorldPtr ground_of_two_kilometres() {
    WorldDefinition scene;
    for (int tile = 0; tile < 16; ++tile) {
        BodyDefinition body = box(1 + static_cast<BodyId>(tile),
                                  vec(tile % 4 * 500.0 - 750, -20, tile / 4 * 500.0 - 750),
                                  {250, 20, 250});
        body.mode = BodyMode::fixed;
        scene.bodies.push_back(body);
    }
    return make_world(scene);
}

struct Ray {
    Vec3 from;
    Vec3 to;
};

/// From up to 300 m above a place to up to 300 m below another.
Ray random_ray(std::uint64_t index) {
    const auto across = [&](std::uint64_t counter) {
        return random_symmetric(7, index, counter) * Real(999);
    };
    const Real above = random_unit(7, index, 4) * Real(300) + Real::from_raw(1);
    const Real below = random_unit(7, index, 5) * Real(300) + Real::from_raw(1);
    return {{across(0), above, across(1)}, {across(2), -below, across(3)}};
}

/// What a float makes of the same ray against the plane y = 0.
double float_height(const Ray& ray) {
    const auto from = static_cast<float>(to_double(ray.from.y));
    const auto to = static_cast<float>(to_double(ray.to.y));
    const float fraction = from / (from - to);
    return static_cast<double>(from + fraction * (to - from));
}

/// Whether `found` is within an ulp of where the ray meets y = 0 on one axis, in exact products.
bool is_met(Real from, Real to, Real found, const Ray& ray) {
    const Real drop = ray.from.y - ray.to.y;
    const auto off = product(found - from, drop) - product(to - from, ray.from.y);
    const auto ulp = product(Real::from_raw(1), drop);
    return off <= ulp && off + ulp >= product(Real(0), drop);
}

TEST(GroundRay, MeetsGroundOfTwoKilometresToTheLastBit) {
    const WorldPtr world = ground_of_two_kilometres();
    std::int64_t worst = 0;
    double worst_float = 0;
    for (std::uint64_t index = 0; index < 20'000; ++index) {
        const Ray ray = random_ray(index);
        const auto hit = world->ray_cast(ray.from, ray.to);
        ASSERT_TRUE(hit.has_value()) << index;
        worst = std::max(worst, std::abs(hit->point.y.raw()));
        ASSERT_TRUE(is_met(ray.from.x, ray.to.x, hit->point.x, ray)) << index;
        ASSERT_TRUE(is_met(ray.from.z, ray.to.z, hit->point.z, ray)) << index;
        ASSERT_EQ(hit->normal, (Vec3{0, 1, 0})) << index;
        worst_float = std::max(worst_float, std::abs(float_height(ray)));
    }
    std::cout << "off by at most " << worst << " x 2^-32 m; float by " << worst_float * 1e6
              << " um\n";
    EXPECT_LE(worst, 1);
    EXPECT_GT(worst_float, 1e-6) << "the rays are no trial";
}

TEST(GroundRay, FindsNoGapBetweenTheTiles) {
    const WorldPtr world = ground_of_two_kilometres();
    for (std::uint64_t index = 0; index < 4000; ++index) {
        Ray ray = random_ray(index);
        // Straight down onto a seam, or at a slant through one.
        const Real seam = Real(static_cast<std::int64_t>(index % 3)) * Real(500) - Real(500);
        ray.from.x = seam;
        ray.to.x = seam;
        ray.to.z = index % 2 == 0 ? ray.from.z : ray.to.z;
        const auto hit = world->ray_cast(ray.from, ray.to);
        ASSERT_TRUE(hit.has_value()) << index;
        ASSERT_LE(std::abs(hit->point.y.raw()), 1) << index;
        ASSERT_EQ(hit->point.x, seam);
    }
}

} // namespace
} // namespace lockwind::test

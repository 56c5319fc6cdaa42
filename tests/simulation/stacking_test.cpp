#include "scene/scene.h"
#include "tests/simulation/measures.h"

#include <gtest/gtest.h>
#include <iostream>
#include <numbers>

// Stacks are to stand for ever: what creeps falls in the end.
namespace lockwind::test {
namespace {

constexpr int kTicksAMinute = 3600;

WorldDefinition sleepless() {
    WorldDefinition scene;
    scene.settings.sleep_seconds = 0;
    scene.bodies.push_back(box(1, {0, -1, 0}, {100, 1, 100}));
    scene.bodies[0].mode = BodyMode::fixed;
    return scene;
}

/// Unit boxes of 1 kg one upon another, the last one of `top_mass` kg.
WorldDefinition column(int boxes, Real top_mass) {
    WorldDefinition scene = sleepless();
    for (int index = 0; index < boxes; ++index) {
        scene.bodies.push_back(
            box(2 + static_cast<BodyId>(index), {0, Real(index) + Real(0.5), 0}, {0.5, 0.5, 0.5}));
        scene.bodies.back().mass = index + 1 == boxes ? top_mass : Real(1);
    }
    return scene;
}

/// As pyramid_210, of another base.
WorldDefinition pyramid(int base) {
    WorldDefinition scene = sleepless();
    for (int level = 0; level < base; ++level) {
        for (int place = 0; place < base - level; ++place) {
            const double x = (place - (base - 1 - level) * 0.5) * 1.05;
            scene.bodies.push_back(box(static_cast<BodyId>(scene.bodies.size() + 1),
                                       vec(x, level + 0.5, 0),
                                       {0.5, 0.5, 0.5}));
            scene.bodies.back().mass = 1;
        }
    }
    return scene;
}

/// How far the top of `column(boxes, top_mass)` sinks, m: contacts are springs. A load W presses a
/// contact of effective mass m by W / (m (2 pi 30 Hz)^2), on what is fixed with twice the hertz
/// (Catto, "Soft Constraints", GDC 2011). Four corners of unit cubes of masses a and b: a corner's
/// impulse turns a cube thrice as much as it moves it, so m = 1 / (1/a + 1/b) in all. Box3D's own
/// columns sink by 106.3 (20 boxes), 68.4 (10x) and 495.6 mm (100x).
double sag(int boxes, double top_mass) {
    const double rate = 2 * std::numbers::pi * 30;
    double borne = top_mass;
    double below_top = top_mass;
    double sum = 0;
    for (int contact = boxes - 1; contact > 0; --contact) {
        sum += borne * kGravity * (1 / below_top + 1) / (rate * rate);
        below_top = 1;
        borne += 1;
    }
    return sum + borne * kGravity / (4 * rate * rate);
}

struct Stand {
    Drift settled; // after a tenth of the time, from the start
    Drift end;     // from the start
    Drift crept;   // in the second half of the time
};

Stand stand(const WorldDefinition& scene, int ticks) {
    const WorldPtr world = make_world(scene);
    const std::vector<Vector> start = places_of(*world);
    std::vector<Vector> middle;
    Stand stand;
    std::cout << ticks << " ticks, mm aside by tenths:";
    for (int tenth = 1; tenth <= 10; ++tenth) {
        step_idle(*world, ticks / 10);
        stand.end = drift_from(start, *world);
        stand.settled = tenth == 1 ? stand.end : stand.settled;
        middle = tenth == 5 ? places_of(*world) : middle;
        std::cout << " " << stand.end.horizontal * 1000;
    }
    stand.crept = drift_from(middle, *world);
    EXPECT_EQ(world->counts().awake, scene.bodies.size() - 1) << "who sleeps does not drift";
    std::cout << "; from the start " << stand.end.largest * 1000 << " mm (mean "
              << stand.end.mean * 1000 << "); in the second half " << stand.crept.largest * 1000
              << " mm\n";
    return stand;
}

/// What lies still goes nowhere by friction's roundings: Box3D's pyramid_210 moves by 0.06 mm in
/// nine minutes. Columns sway a little longer before they rest.
void expect_no_creep(const Stand& stand, double most = 0.0005) {
    EXPECT_LT(stand.crept.largest, most);
    EXPECT_LT(stand.end.largest, stand.settled.largest + most);
}

TEST(Standing, Pyramid210DriftsThreeCentimetresInTenSeconds) {
    const Result<WorldDefinition> scene = load_scene("pyramid_210");
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    const Stand stood = stand(scene.value(), long_tests() ? 10 * kTicksAMinute : 600);
    EXPECT_LE(stood.end.largest, long_tests() ? 0.04 : 0.035);
    EXPECT_LE(stood.end.horizontal, 0.02);
    EXPECT_NEAR(stood.end.horizontal, stood.settled.horizontal, 0.0002);
    expect_no_creep(stood, long_tests() ? 0.0005 : 0.002); // it settles for ten seconds
}

TEST(Standing, PyramidOf36DoesNotCreepInTenMinutes) {
    const Stand stood = stand(pyramid(8), 10 * kTicksAMinute);
    EXPECT_LE(stood.end.largest, 0.02);
    expect_no_creep(stood);
}

TEST(Standing, TwentyBoxesDoNotCreepInTenMinutes) {
    const Stand stood = stand(column(20, 1), 10 * kTicksAMinute);
    EXPECT_NEAR(stood.end.largest, sag(20, 1), 0.001);
    EXPECT_LE(stood.end.horizontal, 0.003);
    expect_no_creep(stood);
}

TEST(Standing, Pyramid210AndTwentyBoxesSleepWithinThreeSeconds) {
    const Result<WorldDefinition> pyramid_210 = load_scene("pyramid_210");
    ASSERT_TRUE(pyramid_210.ok()) << pyramid_210.error().message;
    for (WorldDefinition scene : {pyramid_210.value(), column(20, 1)}) {
        scene.settings.sleep_seconds = WorldSettings{}.sleep_seconds;
        const int ticks = ticks_till_asleep(*make_world(scene), 180);
        std::cout << scene.bodies.size() - 1 << " boxes: asleep after " << ticks << " ticks\n";
        EXPECT_GT(ticks, 0);
    }
}

TEST(Standing, TenBoxesBearATopOfTenTimesTheirMassForAMinute) {
    const Stand stood = stand(column(10, 10), kTicksAMinute);
    EXPECT_NEAR(stood.end.largest, sag(10, 10), 0.001);
    EXPECT_LE(stood.end.horizontal, 0.005);
    expect_no_creep(stood);
}

/// They sag by half a metre of ten and sway by a fifth of a metre, but stand.
TEST(Standing, TenBoxesBearATopOfAHundredTimesTheirMassForAMinute) {
    const Stand stood = stand(column(10, 100), kTicksAMinute);
    EXPECT_NEAR(stood.end.largest, sag(10, 100), 0.06);
    EXPECT_LE(stood.end.horizontal, 0.25);
}

} // namespace
} // namespace lockwind::test

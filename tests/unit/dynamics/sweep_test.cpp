#include "tests/support/dice.h"
#include "tests/unit/dynamics/dynamics_bench.h"

namespace lockwind {
namespace {

using testing::Dice; // NOLINT(misc-unused-using-decls): GoogleTest has a namespace of that name

WorldSettings fast_settings(bool weightless) {
    WorldSettings settings;
    settings.linear_speed_max = 1000;
    settings.angular_speed_max = 200;
    if (weightless) {
        settings.gravity = vec(0, 0, 0);
    }
    return settings;
}

double draw(Dice& dice, double low, double high) {
    return low + (high - low) * static_cast<double>(dice.below(1000001)) / 1e6;
}

/// A wall 0.2 m thick at x = 0, shot at from everywhere in front of it.
int passes(CollisionMode mode, int shots, double speed = 999.999) {
    int passed = 0;
    for (int shot = 0; shot < shots; ++shot) {
        Dice dice(static_cast<std::uint64_t>(shot) + 1);
        DynamicsBench bench(fast_settings(true), 8);
        bench.add(fixed(box(0.1, 20, 20, vec(0, 0, 0))));
        BodyDefinition bullet = ball(draw(dice, 0.02, 0.2), vec(draw(dice, -40, -0.5), 0, 0));
        const double yaw = draw(dice, -0.4, 0.4);
        const double pitch = draw(dice, -0.3, 0.3);
        bullet.linear_velocity = vec(speed * std::cos(yaw) * std::cos(pitch),
                                     speed * std::sin(pitch),
                                     speed * std::sin(yaw) * std::cos(pitch));
        bullet.position.y = real(-5 * std::sin(pitch));
        bullet.restitution = real(draw(dice, 0, 1));
        bullet.collision_mode = mode;
        const BodyRow row = bench.add(bullet);
        // Off the wall's rim at the latest after 20 m.
        for (int tick = 0; tick < 12 * 1000 / speed && std::abs(bench.position(row, 2)) < 19 &&
                           std::abs(bench.position(row, 1)) < 19;
             ++tick) {
            bench.step();
            if (bench.position(row, 0) > 0) {
                ++passed;
                break;
            }
        }
    }
    return passed;
}

TEST(Sweep, NoShotPassesAWall) {
    EXPECT_EQ(passes(CollisionMode::swept, 10000), 0);
    EXPECT_EQ(passes(CollisionMode::continuous, 200), 0);
    EXPECT_EQ(passes(CollisionMode::speculative, 200), 0);
    EXPECT_GT(passes(CollisionMode::discrete, 200), 150); // or it would prove nothing
}

/// A rod 1 m long and 10 cm thick spins at up to 190 rad/s (3.2 rad a tick) below a plate.
/// In how many tries the plate's middle comes to lie behind the rod's centre line.
int plates_passed(CollisionMode mode, double thickness, int tries) {
    int passed = 0;
    for (int index = 0; index < tries; ++index) {
        Dice dice(static_cast<std::uint64_t>(index) + 1);
        DynamicsBench bench(fast_settings(true), 8);
        const double height = draw(dice, 0.2, 0.42);
        bench.add(fixed(box(0.15, thickness / 2, 1, vec(0, height, 0))));
        BodyDefinition rod = box(0.5, 0.05, 0.05, vec(draw(dice, -0.05, 0.05), 0, 0));
        rod.angular_velocity = vec(0, 0, draw(dice, 60, 190));
        rod.collision_mode = mode;
        const BodyRow row = bench.add(rod);
        bool through = false;
        for (int tick = 0; tick < 4; ++tick) {
            bench.step();
            const std::int32_t* turn = bench.motion(row).orientation;
            const double angle = 2 * std::atan2(turn[2], turn[3]);
            const double x = -bench.position(row, 0);
            const double y = height - bench.position(row, 1);
            const double along = x * std::cos(angle) + y * std::sin(angle);
            const double before = y * std::cos(angle) - x * std::sin(angle);
            through = before < 0 && std::abs(along) < 0.45 && std::hypot(x, y) < 0.5;
            if (through) {
                break;
            }
        }
        passed += through ? 1 : 0;
    }
    return passed;
}

TEST(Sweep, NoRodTurnsThroughAPlate) {
    EXPECT_EQ(plates_passed(CollisionMode::swept, 0.02, 1000), 0);
    EXPECT_EQ(plates_passed(CollisionMode::continuous, 0.02, 100), 0);
    EXPECT_EQ(plates_passed(CollisionMode::speculative, 0.02, 100), 0);
    EXPECT_GT(plates_passed(CollisionMode::discrete, 0.12, 200), 50);
}

/// Two balls head on at 400 m/s each: 13 m a tick between them.
TEST(Sweep, ContinuousBodiesMeetEachOther) {
    for (const CollisionMode mode :
         {CollisionMode::discrete, CollisionMode::swept, CollisionMode::continuous}) {
        DynamicsBench bench(fast_settings(true), 8);
        BodyDefinition left = ball(0.1, vec(-10, 0, 0));
        left.linear_velocity = vec(400, 0, 0);
        left.collision_mode = mode;
        BodyDefinition right = ball(0.1, vec(10.3, 0, 0));
        right.linear_velocity = vec(-400, 0, 0);
        const BodyRow a = bench.add(left);
        const BodyRow b = bench.add(right);
        bench.run(10);
        const bool apart = bench.position(a, 0) < bench.position(b, 0);
        EXPECT_EQ(apart, mode == CollisionMode::continuous);
    }
}

/// A ball that glances off a wall without friction at 30 m/s across and 60 m/s along it.
class Glance {
public:
    explicit Glance(CollisionMode mode) : bench_(fast_settings(true), 8) {
        BodyDefinition wall = fixed(box(0.1, 20, 20, vec(0.1, 0, 0)));
        wall.friction = 0;
        bench_.add(wall);
        BodyDefinition bullet = ball(0.1, vec(-1.2, -10, 0));
        bullet.linear_velocity = vec(30, 60, 0);
        bullet.friction = 0;
        bullet.collision_mode = mode;
        row_ = bench_.add(bullet);
    }
    void run(int ticks) {
        for (int tick = 0; tick < ticks; ++tick) {
            bench_.step();
            nearest_ = std::max(nearest_, bench_.position(row_, 0) + 0.1);
            most_manifolds_ = std::max(most_manifolds_, bench_.state().manifold_count);
        }
    }
    double along() const { return bench_.position(row_, 1) + 10; }
    double across() const { return bench_.position(row_, 0); }
    double speed_across() const { return bench_.velocity(row_, 0); }
    double nearest() const { return nearest_; }
    std::uint32_t most_manifolds() const { return most_manifolds_; }

private:
    DynamicsBench bench_;
    BodyRow row_;
    double nearest_ = -1; // how far its surface got into the wall, m
    std::uint32_t most_manifolds_ = 0;
};

/// It touches in the third tick, after 1.1 m: 0.1 m of 0.5 m. Along the wall nothing holds it.
TEST(Sweep, ASpeculativeBodyKeepsTheRestOfItsTick) {
    Glance speculative(CollisionMode::speculative);
    speculative.run(3);
    EXPECT_NEAR(speculative.along(), 3.0, 1e-4);
    EXPECT_NEAR(speculative.across(), -0.1, 0.002);
    EXPECT_NEAR(speculative.nearest(), 0, 0.002);
    EXPECT_EQ(speculative.most_manifolds(), 0U); // none outlives the tick, until it touches
    speculative.run(1);
    EXPECT_EQ(speculative.most_manifolds(), 1U);

    Glance swept(CollisionMode::swept);
    swept.run(3);
    EXPECT_NEAR(swept.along(), 2.2, 0.01);
    EXPECT_LT(swept.nearest(), 0);
    Glance discrete(CollisionMode::discrete);
    discrete.run(3);
    EXPECT_NEAR(discrete.nearest(), 0.4, 0.01);
}

/// A ball that passes a box 4 cm above it at 120 m/s. What lies ahead of it is the plane across
/// the shortest way to the edge, and it takes that for a wall: the known limit.
TEST(Sweep, ASpeculativeBodyHitsGhosts) {
    for (const CollisionMode mode : {CollisionMode::swept, CollisionMode::speculative}) {
        DynamicsBench bench(fast_settings(true), 8);
        bench.add(fixed(cube(1, vec(0, 0, 0))));
        BodyDefinition bullet = ball(0.1, vec(-2.4, 1.14, 0));
        bullet.linear_velocity = vec(120, 0, 0);
        bullet.collision_mode = mode;
        const BodyRow row = bench.add(bullet);
        int begins = 0;
        for (int tick = 0; tick < 5; ++tick) {
            bench.step();
            for (const ContactChange& change : bench.dynamics().contact_changes()) {
                begins += change.begin ? 1 : 0;
            }
        }
        EXPECT_EQ(begins, 0); // it never touches, whatever it does
        if (mode == CollisionMode::swept) {
            EXPECT_EQ(bench.velocity(row, 0), 120);
            EXPECT_EQ(bench.velocity(row, 1), 0);
        } else {
            EXPECT_LT(bench.velocity(row, 0), 119);
            EXPECT_GT(bench.velocity(row, 1), 1);
        }
    }
}

/// Each speed a different way: 1.7 m a tick is foreseen, 8 m is swept.
TEST(Sweep, ASpeculativeBodyPassesNoWallAtAnySpeed) {
    for (const double speed : {2.0, 20.0, 100.0, 235.0, 250.0, 480.0}) {
        EXPECT_EQ(passes(CollisionMode::speculative, 100, speed), 0) << speed;
    }
    EXPECT_GT(passes(CollisionMode::discrete, 100, 100), 20);
}

} // namespace
} // namespace lockwind

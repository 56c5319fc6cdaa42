#include "scene/scene.h"
#include "tests/simulation/measures.h"

#include <cmath>
#include <gtest/gtest.h>

// The scene `bullets`: what is in a closed room stays there, at any speed, unless it is discrete.
namespace lockwind::test {
namespace {

constexpr int kTicks = 600;
constexpr std::uint32_t kFixed = 24;  // walls
constexpr std::uint32_t kColumn = 12; // dynamic bodies that are hit
constexpr std::uint32_t kPerRoom = 12;

struct Count {
    int outside = 0;
    int hits = 0;
    double fastest = 0; // m/s
};

/// Of one room's bullets over the whole run: how many were ever outside, or destroyed there.
std::array<Count, 4> run_rooms() {
    const Result<WorldDefinition> scene = load_scene("bullets");
    EXPECT_TRUE(scene.ok());
    const WorldPtr world = make_world(scene.value());
    std::array<Count, 4> counts;
    std::vector<bool> outside(4 * kPerRoom);
    for (int tick = 0; tick < kTicks; ++tick) {
        step_idle(*world);
        for (std::uint32_t index = 0; index < 4 * kPerRoom; ++index) {
            const BodyId id = kFixed + kColumn + 1 + index;
            const std::size_t room = index / kPerRoom;
            const auto body = world->body(id);
            if (!body) {
                outside[index] = true;
                continue;
            }
            const Vector place = vector_of(body->position);
            const double x = place.x - (-18.0 + 12.0 * static_cast<double>(room));
            outside[index] = outside[index] || std::abs(x) > 5 || std::abs(place.z) > 5 ||
                             std::abs(place.y - 5) > 5;
            counts[room].fastest =
                std::max(counts[room].fastest, length(vector_of(body->linear_velocity)));
        }
        for (const Event& event : world->events()) {
            if (event.type == EventType::hit && event.b > kFixed + kColumn) {
                ++counts[(event.b - kFixed - kColumn - 1) / kPerRoom].hits;
            }
        }
    }
    for (std::uint32_t index = 0; index < 4 * kPerRoom; ++index) {
        counts[index / kPerRoom].outside += outside[index] ? 1 : 0;
    }
    return counts;
}

TEST(Bullets, StayInTheirRoomUnlessTheyAreDiscrete) {
    const std::array<Count, 4> counts = run_rooms();
    EXPECT_GE(counts[0].outside, 8);
    for (const auto mode :
         {CollisionMode::swept, CollisionMode::continuous, CollisionMode::speculative}) {
        const Count& room = counts[static_cast<std::size_t>(mode)];
        EXPECT_EQ(room.outside, 0) << static_cast<int>(mode);
        EXPECT_GT(room.hits, 100) << static_cast<int>(mode);
        EXPECT_GT(room.fastest, 300) << static_cast<int>(mode);
        EXPECT_LT(room.fastest, 1000) << static_cast<int>(mode);
    }
}

} // namespace
} // namespace lockwind::test

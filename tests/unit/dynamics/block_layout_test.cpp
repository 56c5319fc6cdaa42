#include "dynamics/block_layout.h"
#include "tests/unit/dynamics/dynamics_bench.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace lockwind {
namespace {

constexpr auto kDynamicMode = static_cast<std::uint8_t>(BodyMode::dynamic);

/// Tables with made-up touching pairs: only modes, shapes and pairs matter.
class PairTables {
public:
    PairTables(std::uint32_t bodies, std::uint32_t pairs, std::uint32_t seed) : bench_({}, bodies) {
        std::mt19937 random(seed);
        DynamicsState& state = bench_.state();
        state.motion_count = bodies;
        state.properties_count = bodies;
        state.sleep_count = bodies;
        for (BodyProperties& body : state.properties) {
            body.mode = random() % 6 == 0 ? static_cast<std::uint8_t>(random() % 2) : kDynamicMode;
            body.shape =
                static_cast<std::uint8_t>(random() % 2 == 0 ? ShapeType::sphere : ShapeType::box);
        }
        state.properties[1].mode = kDynamicMode;
        std::set<std::pair<BodyRow, BodyRow>> rows;
        while (rows.size() < pairs) {
            // Row 1 meets many.
            const auto a = static_cast<BodyRow>(random() % 3 == 0 ? 1 : random() % bodies);
            const auto b = static_cast<BodyRow>(random() % bodies);
            if (a != b) {
                rows.insert({std::min(a, b), std::max(a, b)});
            }
        }
        std::uint32_t index = 0;
        for (const auto& [a, b] : rows) {
            const auto points = static_cast<std::uint8_t>(random() % 5);
            state.pairs[index] = {a, b, 0, points != 0 ? index : kNoIndex, 0, points, {0, 0}};
            ++index;
        }
        state.pair_count = index;
        state.manifold_count = index;
    }
    DynamicsTables tables() { return bench_.tables(); }
    Activity activity() { return bench_.activity(); }
    bool is_dynamic(BodyRow row) { return bench_.properties(row).mode == kDynamicMode; }
    std::uint32_t pair_capacity() const { return bench_.pair_capacity(); }
    std::uint32_t manifold_capacity() const { return bench_.manifold_capacity(); }

private:
    DynamicsBench bench_;
};

TEST(Colouring, NoDynamicBodyMeetsTwiceInAColour) {
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
        PairTables made(120, 700, seed);
        const DynamicsTables tables = made.tables();
        Colouring colouring(120, made.pair_capacity());
        colouring.run(tables, made.activity());
        std::set<std::pair<int, BodyRow>> seen;
        std::size_t overflow = 0;
        for (const ColouredContact& contact : colouring.contacts()) {
            if (contact.colour == kColours) {
                ++overflow;
                continue;
            }
            const Pair& pair = tables.pairs[contact.pair];
            const bool both = made.is_dynamic(pair.row_a) && made.is_dynamic(pair.row_b);
            EXPECT_EQ(both, contact.colour < kDynamicColours);
            for (const BodyRow row : {pair.row_a, pair.row_b}) {
                if (made.is_dynamic(row)) {
                    EXPECT_TRUE(seen.insert({contact.colour, row}).second);
                }
            }
        }
        EXPECT_GT(overflow, 0U) << "row 1 has more contacts than there are colours";
    }
}

TEST(Colouring, TakesEveryTouchingPairThatMovesOnceInOrder) {
    PairTables made(100, 500, 42);
    const DynamicsTables tables = made.tables();
    Colouring colouring(100, made.pair_capacity());
    colouring.run(tables, made.activity());
    std::vector<std::uint32_t> expected;
    for (std::uint32_t index = 0; index < tables.pairs.count(); ++index) {
        const Pair& pair = tables.pairs[index];
        if (pair.point_count != 0 && (made.is_dynamic(pair.row_a) || made.is_dynamic(pair.row_b))) {
            expected.push_back(index);
        }
    }
    std::vector<std::uint32_t> taken;
    for (const ColouredContact& contact : colouring.contacts()) {
        taken.push_back(contact.pair);
    }
    EXPECT_EQ(taken, expected);
}

/// The first colour that neither body has used yet, in pair order: nothing of earlier ticks enters.
TEST(Colouring, IsTheGreedyOneOfPairOrder) {
    PairTables made(60, 200, 3);
    const DynamicsTables tables = made.tables();
    Colouring colouring(60, made.pair_capacity());
    PairTables other(60, 300, 99);
    colouring.run(other.tables(), other.activity());
    colouring.run(tables, made.activity());
    std::map<BodyRow, std::set<std::uint32_t>> used;
    for (const ColouredContact& contact : colouring.contacts()) {
        const Pair& pair = tables.pairs[contact.pair];
        const bool both = made.is_dynamic(pair.row_a) && made.is_dynamic(pair.row_b);
        const std::uint32_t end = both ? kDynamicColours : kColours;
        std::uint32_t colour = both ? 0 : kDynamicColours;
        const auto is_used = [&](BodyRow row) {
            return made.is_dynamic(row) && used[row].count(colour) != 0;
        };
        while (colour < end && (is_used(pair.row_a) || is_used(pair.row_b))) {
            ++colour;
        }
        EXPECT_EQ(contact.colour, colour < end ? colour : kColours);
        if (colour < end) {
            used[pair.row_a].insert(colour);
            used[pair.row_b].insert(colour);
        }
    }
}

TEST(BlockLayout, HoldsEveryContactOnceByColourWorkAndPair) {
    PairTables made(120, 700, 6);
    const DynamicsTables tables = made.tables();
    Colouring colouring(120, made.pair_capacity());
    colouring.run(tables, made.activity());
    BlockLayout layout(made.manifold_capacity());
    layout.run(tables, colouring.contacts());
    std::map<std::uint32_t, std::uint8_t> colour_of;
    std::uint32_t central = 0;
    std::uint32_t central_overflow = 0;
    for (const ColouredContact& contact : colouring.contacts()) {
        colour_of[contact.pair] = contact.colour;
        const Pair& pair = tables.pairs[contact.pair];
        const bool is_central_one =
            contact.point_count == 1 &&
            lockwind::is_central(tables.properties[pair.row_a], tables.properties[pair.row_b]);
        EXPECT_EQ(contact.is_central, is_central_one);
        central += is_central_one ? 1 : 0;
        central_overflow += is_central_one && contact.colour == kColours ? 1 : 0;
    }
    EXPECT_GT(central, 20U);
    EXPECT_GT(central_overflow, 0U);
    using Key = std::array<std::uint32_t, 3>;
    std::vector<Key> order;
    std::uint32_t index = 0;
    for (const ContactBlock& block : layout.blocks()) {
        ASSERT_GT(block.lane_count, 0);
        ASSERT_LE(block.lane_count, kBlockLanes);
        for (int lane = 0; lane < block.lane_count; ++lane) {
            const std::uint8_t colour = colour_of.at(block.pair[lane]);
            EXPECT_EQ(colour, colour_of.at(block.pair[0])) << "a block has one colour";
            EXPECT_EQ(index >= layout.overflow_first(), colour == kColours);
            EXPECT_LE(block.point_count[lane], block.point_count_max);
            const auto points = static_cast<std::uint32_t>(block.point_count[lane]);
            const std::uint32_t light = block.is_central ? kBlockPoints : kBlockPoints - points;
            central -= block.is_central ? 1 : 0;
            order.push_back({colour, light, block.pair[lane]});
        }
        ++index;
    }
    EXPECT_EQ(central, 0U) << "all in blocks of their own, and nothing else there";
    EXPECT_EQ(order.size(), colouring.contacts().size());
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
    EXPECT_EQ(std::set<Key>(order.begin(), order.end()).size(), order.size());
}

/// A block for each kind of contact in each colour is the most that contacts can be spread over.
TEST(BlockLayout, HasRoomForBothKindsInEveryColour) {
    constexpr std::uint32_t kContacts = 2 * (kColours + 1);
    PairTables made(60, kContacts, 1);
    const DynamicsTables tables = made.tables();
    std::vector<ColouredContact> contacts;
    for (std::uint32_t index = 0; index < kContacts; ++index) {
        contacts.push_back({index, static_cast<std::uint8_t>(index / 2), 1, index % 2 == 0});
    }
    BlockLayout layout(kContacts);
    layout.run(tables, contacts);
    ASSERT_EQ(layout.blocks().size(), kContacts);
    EXPECT_EQ(layout.overflow_first(), kContacts - 2);
    std::uint32_t central = 0;
    for (const ContactBlock& block : layout.blocks()) {
        EXPECT_EQ(block.lane_count, 1);
        central += block.is_central ? 1 : 0;
    }
    EXPECT_EQ(central, kContacts / 2);
}

TEST(IsCentral, OfSpheresAndWhatDoesNotTurn) {
    const auto body = [](ShapeType shape, BodyMode mode) {
        BodyProperties made{};
        made.shape = static_cast<std::uint8_t>(shape);
        made.mode = static_cast<std::uint8_t>(mode);
        return made;
    };
    const BodyProperties ball = body(ShapeType::sphere, BodyMode::dynamic);
    const BodyProperties moved = body(ShapeType::sphere, BodyMode::kinematic);
    const BodyProperties floor = body(ShapeType::plane, BodyMode::fixed);
    const BodyProperties lift = body(ShapeType::box, BodyMode::kinematic);
    const BodyProperties crate = body(ShapeType::box, BodyMode::dynamic);
    EXPECT_TRUE(is_central(ball, ball));
    EXPECT_TRUE(is_central(ball, floor));
    EXPECT_TRUE(is_central(floor, ball));
    EXPECT_TRUE(is_central(moved, ball));
    EXPECT_FALSE(is_central(ball, crate));
    EXPECT_FALSE(is_central(lift, ball)) << "it turns, and carries along what it touches";
    EXPECT_FALSE(is_central(crate, floor));
}

TEST(BlockLayout, ContactsBeyondTheColoursAreStillSolved) {
    DynamicsBench bench;
    bench.add(ground());
    bench.add(box(8, 0.5, 8, vec(0, 0.5, 0)));
    for (int index = 0; index < 100; ++index) {
        bench.add(cube(0.3, vec((index % 10 - 4.5) * 0.7, 1.3, (index / 10 - 4.5) * 0.7)));
    }
    bench.run(120);
    for (BodyRow row = 2; row < 102; ++row) {
        EXPECT_NEAR(bench.position(row, 1), 1.3, 0.02) << "box " << row;
        EXPECT_LT(bench.speed(row), 0.01);
    }
}

} // namespace
} // namespace lockwind

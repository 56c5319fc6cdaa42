#include "dynamics/bounds_grid.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace lockwind {
namespace {

Bounds bounds_at(std::int32_t x, std::int32_t y, std::int32_t z, std::int32_t half) {
    return {{x - half, y - half, z - half}, {x + half, y + half, z + half}};
}

std::vector<BodyRow> found_by(const BoundsGrid& grid, const Bounds& query) {
    std::vector<BodyRow> rows;
    grid.query(query, [&](BodyRow row) { rows.push_back(row); });
    std::sort(rows.begin(), rows.end());
    return rows;
}

std::vector<BodyRow> by_brute_force(const std::vector<Bounds>& all, const Bounds& query) {
    std::vector<BodyRow> rows;
    for (BodyRow row = 0; row < all.size(); ++row) {
        if (overlaps(all[row], query)) {
            rows.push_back(row);
        }
    }
    return rows;
}

void expect_finds_all_once(const std::vector<Bounds>& all) {
    BoundsGrid grid(static_cast<std::uint32_t>(all.size()));
    grid.build(all);
    std::size_t found = 0;
    for (const Bounds& query : all) {
        const std::vector<BodyRow> rows = by_brute_force(all, query);
        ASSERT_EQ(found_by(grid, query), rows);
        found += rows.size();
    }
    EXPECT_GT(found, all.size()) << "no two bounds overlap: the test says nothing";
}

constexpr std::int32_t kMetre = 1 << 16;

TEST(BoundsGrid, FindsWhatBruteForceFindsForEverySize) {
    std::mt19937 random(7);
    for (int trial = 0; trial < 20; ++trial) {
        std::vector<Bounds> all;
        for (int index = 0; index < 300; ++index) {
            const auto place = [&] {
                return static_cast<std::int32_t>(random() % (6 * kMetre)) - 3 * kMetre;
            };
            const auto half = static_cast<std::int32_t>((random() % kMetre) >> (random() % 12)) + 1;
            all.push_back(bounds_at(place(), place(), place(), half));
        }
        expect_finds_all_once(all);
    }
}

TEST(BoundsGrid, FindsAcrossFloorsWallsPlanesAndFarBodies) {
    std::mt19937 random(11);
    std::vector<Bounds> all{kUnbounded,
                            bounds_at(0, 0, 0, 100 * kMetre),
                            bounds_at(50 * kMetre, 0, 0, 30 * kMetre),
                            bounds_at(32000 * kMetre, 32000 * kMetre, -32000 * kMetre, kMetre)};
    for (int index = 0; index < 200; ++index) {
        const auto place = [&] {
            return static_cast<std::int32_t>(random() % (8 * kMetre)) - 4 * kMetre;
        };
        all.push_back(bounds_at(place(), place(), place(), kMetre / 2));
    }
    expect_finds_all_once(all);
}

TEST(BoundsGrid, FindsBoundsThatOnlyTouch) {
    const std::vector<Bounds> all{bounds_at(0, 0, 0, 100),
                                  bounds_at(200, 0, 0, 100),
                                  bounds_at(0, -200, 0, 100),
                                  bounds_at(201, 201, 201, 100)};
    BoundsGrid grid(4);
    grid.build(all);
    EXPECT_EQ(found_by(grid, all[0]), (std::vector<BodyRow>{0, 1, 2}));
}

TEST(BoundsGrid, SurvivesBoundsAtTheEndOfTheFormat) {
    constexpr std::int32_t kEnd = std::numeric_limits<std::int32_t>::max();
    const std::vector<Bounds> all{{{-kEnd, -kEnd, -kEnd}, {kEnd, kEnd, kEnd}},
                                  {{kEnd - 5, kEnd - 5, kEnd - 5}, {kEnd, kEnd, kEnd}},
                                  bounds_at(0, 0, 0, 3)};
    BoundsGrid grid(3);
    grid.build(all);
    EXPECT_EQ(found_by(grid, all[0]), (std::vector<BodyRow>{0, 1, 2}));
    EXPECT_EQ(found_by(grid, all[1]), (std::vector<BodyRow>{0, 1}));
}

} // namespace
} // namespace lockwind

#pragma once

#include "geometry/axis_bounds.h"

#include "lockwind/types.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace lockwind {

/// Bounds by the place of their centre, in one hashed grid for each size class (a factor of four),
/// so that neither a large floor nor a body far off spoils the cells of the others. Built anew from
/// the bounds; its layout decides only what a query costs, never what it finds.
class BoundsGrid {
public:
    explicit BoundsGrid(std::uint32_t capacity);
    void build(std::span<const Bounds> bounds);
    /// Calls visit(row) once for each row whose bounds overlap `query`.
    template <class Visit>
    void query(const Bounds& query, Visit&& visit) const;

private:
    static constexpr std::uint32_t kLevels = 16;

    struct Item {
        Bounds bounds;
        BodyRow row;
        std::uint32_t line; // y and z of its cell, 16 bits each
    };
    struct Level {
        std::uint32_t item_count;
        std::uint32_t first_bucket;
        std::uint32_t bucket_mask;
        std::int32_t extent_max; // half of the longest side, Q15.16 m
        int cell_shift;
    };
    struct Cell {
        std::int32_t x, y, z;
    };

    static std::int32_t half_extent(const Bounds& bounds);
    static std::uint32_t level_of(std::int32_t extent);
    static Cell cell_of(const Bounds& bounds, int shift);
    static std::uint32_t line_of(std::int32_t y, std::int32_t z) {
        return (static_cast<std::uint32_t>(y) & 0xffffU) | (static_cast<std::uint32_t>(z) << 16U);
    }
    /// Cells that follow each other along x have buckets that do.
    static std::uint32_t bucket_of(std::int32_t x, std::int32_t y, std::int32_t z) {
        return static_cast<std::uint32_t>(x) + static_cast<std::uint32_t>(y) * 0x9e3779b1U +
               static_cast<std::uint32_t>(z) * 0x85ebca77U;
    }
    void size_levels(std::span<const Bounds> bounds);

    template <class Visit>
    void
    visit_items(std::uint32_t begin, std::uint32_t end, const Bounds& query, Visit&& visit) const;
    template <class Visit>
    void query_level(const Level& level, const Bounds& query, Visit&& visit) const;

    Level levels_[kLevels] = {};
    std::uint32_t bucket_count_ = 0;
    std::vector<Item> items_;                 // by level and bucket
    std::vector<std::uint32_t> bucket_start_; // one more than buckets
    std::vector<std::uint32_t> bucket_of_row_;
    std::vector<BodyRow> unbounded_;
};

template <class Visit>
void BoundsGrid::query(const Bounds& query, Visit&& visit) const {
    for (const BodyRow row : unbounded_) {
        visit(row);
    }
    for (const Level& level : levels_) {
        if (level.item_count != 0) {
            query_level(level, query, visit);
        }
    }
}

template <class Visit>
void BoundsGrid::visit_items(std::uint32_t begin,
                             std::uint32_t end,
                             const Bounds& query,
                             Visit&& visit) const {
    for (std::uint32_t index = begin; index < end; ++index) {
        if (overlaps(items_[index].bounds, query)) {
            visit(items_[index].row);
        }
    }
}

template <class Visit>
void BoundsGrid::query_level(const Level& level, const Bounds& query, Visit&& visit) const {
    std::int64_t first[3];
    std::int64_t last[3];
    for (int axis = 0; axis < 3; ++axis) {
        first[axis] = (std::int64_t{query.low[axis]} - level.extent_max) >> level.cell_shift;
        last[axis] = (std::int64_t{query.high[axis]} + level.extent_max) >> level.cell_shift;
    }
    const std::int64_t run = last[0] - first[0] + 1;
    const std::int64_t lines_y = last[1] - first[1] + 1;
    const std::int64_t lines_z = last[2] - first[2] + 1;
    const std::int64_t count = level.item_count;
    const std::uint32_t* start = bucket_start_.data() + level.first_bucket;
    if (run > level.bucket_mask || lines_y > count || lines_z > count ||
        lines_y * lines_z > count) {
        visit_items(start[0], start[level.bucket_mask + 1], query, visit);
        return;
    }
    const auto visit_on_line = [&](std::uint32_t line, std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t index = begin; index < end; ++index) {
            const Item& item = items_[index];
            if (item.line == line && overlaps(item.bounds, query)) {
                visit(item.row);
            }
        }
    };
    for (std::int64_t z = first[2]; z <= last[2]; ++z) {
        for (std::int64_t y = first[1]; y <= last[1]; ++y) {
            const auto cell_y = static_cast<std::int32_t>(y);
            const auto cell_z = static_cast<std::int32_t>(z);
            const std::uint32_t line = line_of(cell_y, cell_z);
            const std::uint32_t bucket =
                bucket_of(static_cast<std::int32_t>(first[0]), cell_y, cell_z) & level.bucket_mask;
            const std::uint32_t end = bucket + static_cast<std::uint32_t>(run);
            const std::uint32_t buckets = level.bucket_mask + 1;
            visit_on_line(line, start[bucket], start[std::min(end, buckets)]);
            if (end > buckets) {
                visit_on_line(line, start[0], start[end - buckets]);
            }
        }
    }
}

} // namespace lockwind

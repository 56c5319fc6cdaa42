#include "dynamics/bounds_grid.h"

namespace lockwind {

namespace {

constexpr std::uint32_t kNoBucket = 0xffffffffU;

} // namespace

BoundsGrid::BoundsGrid(std::uint32_t capacity)
    : items_(capacity), bucket_start_(4 * std::size_t{capacity} + 2 * kLevels + 1),
      bucket_of_row_(capacity) {
    unbounded_.reserve(capacity);
}

std::int32_t BoundsGrid::half_extent(const Bounds& bounds) {
    std::int64_t side = 0;
    for (int axis = 0; axis < 3; ++axis) {
        side = std::max(side, std::int64_t{bounds.high[axis]} - bounds.low[axis]);
    }
    // Rounded up twice: for the halving here, and for that of the centre.
    return static_cast<std::int32_t>((side + 3) >> 1);
}

std::uint32_t BoundsGrid::level_of(std::int32_t extent) {
    return static_cast<std::uint32_t>(std::bit_width(static_cast<std::uint32_t>(extent)) - 1) / 2;
}

BoundsGrid::Cell BoundsGrid::cell_of(const Bounds& bounds, int shift) {
    std::int32_t centre[3];
    for (int axis = 0; axis < 3; ++axis) {
        centre[axis] =
            static_cast<std::int32_t>((std::int64_t{bounds.low[axis]} + bounds.high[axis]) >> 1);
    }
    return {centre[0] >> shift, centre[1] >> shift, centre[2] >> shift};
}

void BoundsGrid::size_levels(std::span<const Bounds> bounds) {
    for (Level& level : levels_) {
        level = Level{};
    }
    unbounded_.clear();
    for (BodyRow row = 0; row < bounds.size(); ++row) {
        if (bounds[row] == kUnbounded) {
            unbounded_.push_back(row);
            continue;
        }
        const std::int32_t extent = half_extent(bounds[row]);
        Level& level = levels_[level_of(extent)];
        ++level.item_count;
        level.extent_max = std::max(level.extent_max, extent);
    }
    std::uint32_t buckets = 0;
    for (Level& level : levels_) {
        level.first_bucket = buckets;
        if (level.item_count != 0) {
            level.bucket_mask = std::bit_ceil(2 * level.item_count) - 1;
            const auto extent = static_cast<std::uint32_t>(level.extent_max);
            level.cell_shift = std::min(static_cast<int>(std::bit_width(extent + extent / 2)), 31);
            buckets += level.bucket_mask + 1;
        }
    }
    bucket_count_ = buckets;
}

void BoundsGrid::build(std::span<const Bounds> bounds) {
    size_levels(bounds);
    const std::span<std::uint32_t> starts(bucket_start_.data(), std::size_t{bucket_count_} + 1);
    std::fill(starts.begin(), starts.end(), 0U);
    // A level's last bucket is followed by the next level's first: one running sum serves all.
    for (BodyRow row = 0; row < bounds.size(); ++row) {
        if (bounds[row] == kUnbounded) {
            bucket_of_row_[row] = kNoBucket;
            continue;
        }
        const Level& level = levels_[level_of(half_extent(bounds[row]))];
        const Cell cell = cell_of(bounds[row], level.cell_shift);
        const std::uint32_t bucket =
            level.first_bucket + (bucket_of(cell.x, cell.y, cell.z) & level.bucket_mask);
        bucket_of_row_[row] = bucket;
        ++bucket_start_[bucket];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts) {
        sum += start;
        start = sum;
    }
    // Filled from each bucket's end, so that the ends become the starts.
    for (auto row = static_cast<BodyRow>(bounds.size()); row-- > 0;) {
        if (bucket_of_row_[row] == kNoBucket) {
            continue;
        }
        const Level& level = levels_[level_of(half_extent(bounds[row]))];
        const Cell cell = cell_of(bounds[row], level.cell_shift);
        Item& item = items_[--bucket_start_[bucket_of_row_[row]]];
        item = {bounds[row], row, line_of(cell.y, cell.z)};
    }
}

} // namespace lockwind

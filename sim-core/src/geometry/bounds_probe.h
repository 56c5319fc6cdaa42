#pragma once

#include "geometry/axis_bounds.h"

#include <cstdint>

namespace lockwind {

// What queries ask of a BoundsTree's bounds: below 0 for no, else a cost by which nearer comes
// first. Coordinates are rounded to 2^-10 m, bounds grown by 3 of them, 3 mm: more than rounding
// and the queries' own errors add up to, so that no probe refuses what the query itself would find.

/// What may be met by a box that moves along a segment.
class SegmentProbe {
public:
    /// Q31.32 m within 2^18 m, half extents Q9.22 m.
    SegmentProbe(const std::int64_t from[3],
                 const std::int64_t way[3],
                 const std::int32_t half_extents[3]);
    /// Ends the segment at a fraction (Q.32) of what it was given as.
    void shorten(std::int64_t fraction);
    std::int64_t operator()(const Bounds& bounds) const;

private:
    void set_end(const std::int64_t end[3]);

    std::int64_t from_raw_[3];
    std::int64_t way_raw_[3];
    std::int64_t half_extents_[3];
    std::int64_t from_[3];
    std::int64_t sum_[3] = {}; // of both ends
    std::int64_t way_[3] = {};
};

/// What may be nearer to a point than a distance.
class PointProbe {
public:
    /// Q31.32 m, both within 2^18 m.
    PointProbe(const std::int64_t point[3], std::int64_t distance);
    void shorten(std::int64_t distance);
    std::int64_t operator()(const Bounds& bounds) const;

private:
    std::int64_t point_[3];
    std::int64_t square_ = 0;
};

/// What overlaps other bounds.
class OverlapProbe {
public:
    explicit OverlapProbe(const Bounds& bounds) : bounds_(bounds) {}
    std::int64_t operator()(const Bounds& bounds) const {
        return overlaps(bounds, bounds_) ? 0 : -1;
    }

private:
    Bounds bounds_;
};

} // namespace lockwind

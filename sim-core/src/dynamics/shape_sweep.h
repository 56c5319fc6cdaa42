#pragma once

#include "geometry/shape_instance.h"

#include <cstdint>

namespace lockwind {

/// 0.98 mm, Q31.32: a shape that is swept stops this far from what it meets, well inside the
/// speculative margin, so that the next narrow phase finds the contact.
inline constexpr std::int64_t kSweepGap = std::int64_t{1} << 22;
/// It is taken to be there when it is this near.
inline constexpr std::int64_t kSweepGapMost = 2 * kSweepGap;

/// Of ShapePath::level.
inline constexpr int kSweepLevelMost = 3;

inline constexpr int kSweepTimeFraction = 62;
inline constexpr std::int64_t kSweepTimeEnd = std::int64_t{1} << kSweepTimeFraction;

/// A shape's way from one pose to another: straight, and at a constant angular velocity.
struct ShapePath {
    ShapeInstance shape;         // its rotation is not read; of a body with parts its part alone
    std::int64_t start[3];       // Q31.32 m, world
    std::int64_t way[3];         // Q31.32 m
    std::int32_t orientation[4]; // Q2.30 x y z w, at the start
    std::int64_t turn[3];        // Q.30 rad, world, each within +-4: the whole way's
    /// Sweeps what lies deep within the shape alone: below 1 - 2^-level of its least half width (of
    /// a hull: the hull at 2^-level of its size). What touches at the start may then sink in so far
    /// before its way ends, but does not pass.
    int level;
};

/// The pose at a time of the way, Q1.62.
void place_on_path(const ShapePath& path, std::int64_t time, std::int64_t place[3]);
void turn_on_path(const ShapePath& path, std::int64_t time, std::int32_t orientation[4]);

/// The first time (Q1.62, of both ways, which pass at once) at which A and B are within
/// kSweepGapMost of each other, where they are not so at the start.
/// At most one is a plane. Starts and ends within 2^17 m of each other.
///
/// Conservative advancement (Mirtich 1996) on the separation that shape_distance() certifies: while
/// the shapes move, what keeps them apart along its normal shrinks no faster than they near each
/// other along it plus what their turns sweep, |turn x normal| times the reach. It never passes a
/// touch, however thin and fast the shapes are; where it does not end in 64 steps the time that it
/// came to is taken for the touch.
enum class SweepResult : std::uint8_t { apart, met, near_at_start };
SweepResult shape_sweep(const ShapePath& a, const ShapePath& b, std::int64_t& time);

} // namespace lockwind

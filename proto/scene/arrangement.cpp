#include "scene/arrangement.h"

#include "lockwind/trig.h"

namespace lockwind {
namespace {

/// Numerical Recipes' 32-bit linear congruential generator: the draws of the benchmark scenes.
class Draws {
public:
    explicit Draws(std::uint32_t start) : state_(start) {}

    /// -1 .. 1 - 2^-31, exact.
    Real next() {
        state_ = state_ * 1664525U + 1013904223U;
        return Real::from_raw(2 * std::int64_t{state_} - (std::int64_t{1} << Real::kFraction));
    }

private:
    std::uint32_t state_;
};

/// Offset of place `index` among `count` that stand `pitch` apart about 0.
Real centred(std::uint32_t index, std::uint32_t count, Real pitch) {
    return (Real(2 * index) - Real(count - 1)) * pitch / Real(2);
}

std::uint32_t ceil_cube_root(std::uint32_t count) {
    std::uint64_t side = 1;
    while (side * side * side < count) {
        ++side;
    }
    return static_cast<std::uint32_t>(side);
}

} // namespace

std::vector<Placement> arrange_grid(const GridLayout& layout) {
    const auto [count_x, count_y, count_z] = layout.count;
    std::vector<Placement> places;
    places.reserve(std::size_t{count_x} * count_y * count_z);
    Draws draws(layout.draws);
    for (std::uint32_t y = 0; y < count_y; ++y) {
        for (std::uint32_t z = 0; z < count_z; ++z) {
            for (std::uint32_t x = 0; x < count_x; ++x) {
                const Real draw_x = draws.next();
                const Real draw_z = draws.next();
                Placement place;
                place.offset.x = centred(x, count_x, layout.pitch.x) + layout.jitter * draw_x;
                place.offset.y = Real(y) * layout.pitch.y;
                place.offset.z = centred(z, count_z, layout.pitch.z) + layout.jitter * draw_z;
                places.push_back(place);
            }
        }
    }
    return places;
}

std::vector<Placement> arrange_pyramid(std::uint32_t base, Real pitch_x, Real pitch_y) {
    std::vector<Placement> places;
    for (std::uint32_t row = 0; row < base; ++row) {
        const std::uint32_t length = base - row;
        for (std::uint32_t index = 0; index < length; ++index) {
            Placement place;
            place.offset.x = centred(index, length, pitch_x);
            place.offset.y = Real(row) * pitch_y;
            places.push_back(place);
        }
    }
    return places;
}

std::vector<Placement> arrange_heap(const HeapLayout& layout) {
    const std::uint32_t side = ceil_cube_root(layout.count);
    std::vector<Placement> places;
    places.reserve(layout.count);
    Draws draws(layout.draws);
    for (std::uint32_t index = 0; index < layout.count; ++index) {
        Placement place;
        place.offset.x = centred(index % side, side, layout.pitch);
        place.offset.y = Real(index / (side * side)) * layout.pitch;
        place.offset.z = centred(index / side % side, side, layout.pitch);
        RealQuat drawn;
        drawn.x = draws.next();
        drawn.y = draws.next();
        drawn.z = draws.next();
        drawn.w = draws.next();
        place.orientation = normalized(drawn);
        places.push_back(place);
    }
    return places;
}

std::vector<Placement> arrange_ring(std::uint32_t players, Real radius) {
    constexpr Angle kHalfTurn = Angle::from_turns(0.5);
    std::vector<Placement> places;
    for (std::uint32_t slot = 0; slot < players; ++slot) {
        const Angle angle = Angle::from_turns(Real(slot) / Real(players));
        const SinCos<Real> circle = sincos(angle);
        Placement place;
        place.offset = {radius * circle.sin, 0, radius * circle.cos};
        place.orientation = from_axis_angle({0, 1, 0}, angle + kHalfTurn);
        places.push_back(place);
    }
    return places;
}

} // namespace lockwind

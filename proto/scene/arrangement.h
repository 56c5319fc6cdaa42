#pragma once

#include "lockwind/vector.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lockwind {

/// Where one body of an arrangement stands, relative to the arrangement's position.
struct Placement {
    Vec3 offset; // m
    RealQuat orientation;
};

struct GridLayout {
    std::array<std::uint32_t, 3> count{};
    Vec3 pitch;
    Real jitter;
    std::uint32_t draws = 0;
};

struct HeapLayout {
    std::uint32_t count = 0;
    Real pitch;
    std::uint32_t draws = 0;
};

/// Layers from below; in a layer rows along z, in a row bodies along x, x and z centred. A jittered
/// body is moved by jitter * draw along x, then by jitter * draw along z.
std::vector<Placement> arrange_grid(const GridLayout& layout);

/// Rows of base, base - 1 ... 1 from below, centred on x.
std::vector<Placement> arrange_pyramid(std::uint32_t base, Real pitch_x, Real pitch_y);

/// A grid of ceil(cbrt(count)) a side, filled from below; four draws a body make its orientation.
std::vector<Placement> arrange_heap(const HeapLayout& layout);

/// `players` places on a circle about y, facing its middle with +z; slot 0 at +z.
std::vector<Placement> arrange_ring(std::uint32_t players, Real radius);

} // namespace lockwind

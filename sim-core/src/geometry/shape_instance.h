#pragma once

#include "lockwind/shape.h"

#include <cstdint>

namespace lockwind {

struct Hull;

/// A shape in the world, without its place.
struct ShapeInstance {
    ShapeType type;
    std::int32_t size[3]; // Q9.22 m: sphere radius; capsule radius, half height; box half extents
    const std::int32_t* rotation; // row-major 3x3, Q2.30; identity for a sphere
    const Hull* hull = nullptr;   // of a ShapeLibrary; of a hull only
};

} // namespace lockwind

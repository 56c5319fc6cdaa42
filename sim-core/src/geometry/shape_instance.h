#pragma once

#include "lockwind/shape.h"
#include "lockwind/types.h"

#include <cstdint>

namespace lockwind {

struct Compound;
struct Hull;
class Surface;

/// A shape in the world, without its place.
struct ShapeInstance {
    ShapeType type;
    std::int32_t size[3]; // Q9.22 m: sphere radius; capsule radius, half height; box half extents
    const std::int32_t* rotation; // row-major 3x3, Q2.30; identity for a sphere
    // Of a ShapeLibrary; null but for that type.
    const Hull* hull = nullptr;
    const Compound* compound = nullptr;
    const Surface* surface = nullptr; // of a height field or mesh
    std::uint32_t part = kNoIndex;    // the triangle of a surface that collide() looks at
};

/// Triangles, one side of which is touched.
constexpr bool is_surface(ShapeType type) {
    return type == ShapeType::height_field || type == ShapeType::mesh;
}

/// What is no convex shape, but made of them.
constexpr bool is_composite(ShapeType type) {
    return type == ShapeType::compound || is_surface(type);
}

} // namespace lockwind

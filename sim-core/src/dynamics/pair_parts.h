#pragma once

#include "dynamics/body.h"
#include "geometry/axis_bounds.h"
#include "geometry/bounds_probe.h"
#include "geometry/shape_instance.h"
#include "geometry/shape_library.h"
#include "geometry/surface.h"

#include <cstdint>

namespace lockwind {

// A pair of bodies of which one is made of parts (a compound's children, a surface's triangles) has
// a row for each two parts that may touch: Pair::child says which.

/// Parts of A and B; 0 of a body that is one shape.
struct PartIndices {
    std::uint32_t a;
    std::uint32_t b;
};

/// Pair::child is 0 where neither body is made of parts, else 1 + (part << 5 | child of a
/// compound): of a surface and a compound the surface's part comes first, of two compounds A's.
constexpr std::uint32_t child_of(const PartIndices& parts, bool b_is_surface) {
    const std::uint32_t wide = b_is_surface ? parts.b : parts.a;
    const std::uint32_t narrow = b_is_surface ? parts.a : parts.b;
    return 1 + (wide * kCompoundChildrenMax + narrow);
}
constexpr PartIndices parts_of(std::uint32_t child, bool b_is_surface) {
    const std::uint32_t wide = (child - 1) / kCompoundChildrenMax;
    const std::uint32_t narrow = (child - 1) % kCompoundChildrenMax;
    return b_is_surface ? PartIndices{narrow, wide} : PartIndices{wide, narrow};
}

/// A row's shape, of a body with that rotation; a sphere where there is no such shape (in damaged
/// tables), or `shapes` is null.
ShapeInstance
shape_of_row(const BodyProperties& body, const ShapeLibrary* shapes, const std::int32_t* rotation);

/// World bounds as a surface's own frame has them, Q15.16 m: about the turned box.
Bounds bounds_in_frame(const Bounds& bounds, const BodyMotion& motion);

/// How many parts a shape other than a surface has: children, or itself.
std::uint32_t child_count(const ShapeInstance& shape);

/// A pair of bodies, at least one of which is made of parts. Which of them may touch follows from
/// the bodies' places, where they are fixed, and their fat bounds.
class PartedPair {
public:
    PartedPair(const BodyMotion& motion_a,
               const ShapeInstance& a,
               const BodyMotion& motion_b,
               const ShapeInstance& b)
        : b_is_surface_(is_surface(b.type)), has_surface_(b_is_surface_ || is_surface(a.type)),
          surface_motion_(b_is_surface_ ? motion_b : motion_a), surface_(b_is_surface_ ? b : a),
          other_(b_is_surface_ ? a : b) {}

    bool has_surface() const { return has_surface_; }
    /// Whether a row may touch what has these fat bounds, of the body that is no surface. All rows
    /// of compounds may.
    bool is_near(std::uint32_t child, const Bounds& bounds) const;
    /// Calls visit(child) for each that may.
    template <class Visit>
    void visit(const Bounds& bounds, Visit&& visit) const;

private:
    bool b_is_surface_;
    bool has_surface_;
    const BodyMotion& surface_motion_; // of A where neither is one
    const ShapeInstance& surface_;
    const ShapeInstance& other_;
};

template <class Visit>
void PartedPair::visit(const Bounds& bounds, Visit&& visit) const {
    const auto visit_children = [&](std::uint32_t part) {
        for (std::uint32_t child = 0; child < child_count(other_); ++child) {
            visit(1 + part * kCompoundChildrenMax + child);
        }
    };
    if (has_surface_) {
        surface_.surface->tree().visit(OverlapProbe(bounds_in_frame(bounds, surface_motion_)),
                                       visit_children);
        return;
    }
    for (std::uint32_t part = 0; part < child_count(surface_); ++part) {
        visit_children(part);
    }
}

/// Whether a shape, as a body's properties name it, is made of parts.
constexpr bool has_parts(const BodyProperties& body) {
    return body.shape >= static_cast<std::uint8_t>(ShapeType::compound);
}

} // namespace lockwind

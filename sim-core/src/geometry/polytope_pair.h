#pragma once

#include "geometry/pair_kernels.h"
#include "geometry/polytope_face.h"
#include "geometry/segments.h"

#include <cstdint>

namespace lockwind {

// What the kernels of two polytopes share: hulls and boxes, and triangles of surfaces.

// Axes of the cache: 1 .. 64 faces of A, 65 .. 128 faces of B.
inline constexpr std::uint32_t kFirstFaceB = 1 + kHullFacesMax;

// Features: a face contact's is (reference, both faces, both edges), others have a bit of their
// own and both edges.
inline constexpr int kEdgeBits = 7;
inline constexpr int kFaceBits = 6;
inline constexpr std::uint32_t kReferenceIsB = 1U << (2 * kEdgeBits + 2 * kFaceBits);
inline constexpr std::uint32_t kEdgeFeature = kReferenceIsB << 1U;
inline constexpr std::uint32_t kNearestFeature = kReferenceIsB << 2U;
inline constexpr std::uint32_t kDeepFeature = kReferenceIsB << 3U;

struct Polytopes {
    const ShapeInstance* shape[2];
    Polytope polytope[2];
    FramePlace other[2]; // [0]: B in A's frame; [1]: A in B's
};

/// `delta` from A's centre to B's, world.
Polytopes polytopes_of(const ShapeInstance& a,
                       const Polytope& polytope_a,
                       const ShapeInstance& b,
                       const Polytope& polytope_b,
                       const std::int32_t delta[3]);

/// A face of one of the two.
struct Reference {
    std::uint32_t side; // 0: A, 1: B
    std::uint32_t face;

    static Reference of_axis(std::uint32_t axis) {
        return axis < kFirstFaceB ? Reference{0, axis - 1} : Reference{1, axis - kFirstFaceB};
    }
    std::uint32_t axis() const { return side == 0 ? 1 + face : kFirstFaceB + face; }
};

/// How high the other's lowest vertex lies above the face.
std::int64_t separation_of(const Polytopes& pair, const Reference& reference);

/// The other's part above the face.
void clip_face(const Polytopes& pair, const Reference& reference, PolytopeContact& contact);

/// The normal of a face of either, from A to B, world.
void normal_of(const Polytopes& pair, const Reference& reference, std::int32_t normal[3]);

/// A point of the reference's frame in both.
void set_locals(const Polytopes& pair,
                std::uint32_t side,
                const std::int32_t local[3],
                ManifoldPoint& point);

void emit_face(const Polytopes& pair,
               const Reference& reference,
               const PolytopeContact& contact,
               ManifoldGeometry& out);

/// Whether the arcs of two edges cross: the ends of each lie on different sides of the other, and
/// they meet on one side of the sphere, not on opposite ones. B's arc is that of the negative
/// normals. (Gregorius; an edge's direction is the cross product of its two normals.)
bool arcs_cross(const HullEdge& edge_a,
                std::uint64_t along_a,
                const HullEdge& edge_b,
                std::uint64_t along_b);

/// Two edges in A's frame, by their middles.
struct EdgePair {
    std::uint32_t edge_a;
    std::uint32_t edge_b;
    std::int32_t middle_a[3];
    Segments segments;
};
EdgePair edge_pair(const Polytopes& pair, std::uint32_t edge_a, std::uint32_t edge_b);

/// One point between A's point `on_a` of its edge and B's of its own. `normal`: A's frame.
void emit_between(const Polytopes& pair,
                  const EdgePair& edges,
                  std::int32_t on_a,
                  std::int32_t on_b,
                  const std::int32_t normal[3],
                  ManifoldGeometry& out);

struct EdgeResult {
    bool separates = false;
    bool found = false;
    std::uint32_t edge_a = 0;
    std::uint32_t edge_b = 0;
    std::int32_t normal[3] = {0, 0, 0}; // A's frame, outwards, Q2.30 but for the sine
    std::int64_t separation = 0;        // or the threshold
};

/// One pair of edges whose arcs cross.
class EdgeTest {
public:
    EdgeTest(const Polytopes& pair, std::int64_t threshold) : pair_(pair) {
        result_.separation = threshold;
    }
    const EdgeResult& result() const { return result_; }

    /// False once a pair of edges separates.
    bool test(std::uint32_t edge_a, std::uint32_t edge_b, const std::int32_t direction_b[3]);

private:
    const Polytopes& pair_;
    EdgeResult result_;
};

/// Contact of two edges where their nearest points lie on both. False where not: a face then tells
/// more.
bool emit_edges(const Polytopes& pair, const EdgeResult& best, ManifoldGeometry& out);

} // namespace lockwind

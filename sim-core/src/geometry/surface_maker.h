#pragma once

#include "geometry/surface.h"

#include <optional>
#include <vector>

namespace lockwind {

/// Builds a surface from points in the given frame, |coordinate| <= kSurfaceCoordinateMax, and
/// triangles of them.
class SurfaceMaker {
public:
    SurfaceMaker(std::vector<Surface::Point> points, std::vector<std::uint32_t> indices)
        : points_(std::move(points)), indices_(std::move(indices)) {}

    Result<Surface> run();

private:
    void weld();
    std::optional<Error> centre();
    std::optional<Error> make_triangle(std::uint32_t index);
    void join_neighbours();
    void make_rings();
    void make_outwards();
    void make_tree();

    std::vector<Surface::Point> points_;
    std::vector<std::uint32_t> indices_;
    Surface surface_;
};

} // namespace lockwind

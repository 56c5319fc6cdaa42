#pragma once

#include "geometry/compound.h"
#include "geometry/hull.h"
#include "geometry/surface.h"

#include "lockwind/result.h"
#include "lockwind/shape.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lockwind {

/// As of a WorldDefinition.
struct ShapeDefinitions {
    const std::vector<HullDefinition>& hulls;
    const std::vector<CompoundDefinition>& compounds;
    const std::vector<HeightFieldDefinition>& height_fields;
    const std::vector<MeshDefinition>& meshes;
};

/// What a body takes from its shape, where that is more than sizes.
struct ShapeBuild {
    // Where the shape's own frame lies in the one of its definition.
    std::int32_t centre[3];      // Q9.22 m
    std::int32_t orientation[4]; // Q2.30 x y z w

    std::int32_t bounding_radius; // Q9.22 m
    // As of a Hull; 0 for surfaces, which weigh nothing.
    std::int32_t arm[3];
    Volume volume;
    UnitInertia inertia;
};

/// The shapes of a world that are more than three sizes. They follow from its definition alone and
/// never change: every machine builds the same ones, so they are no state. A body's properties hold
/// an index; load() refuses one that leads nowhere.
class ShapeLibrary {
public:
    ShapeLibrary() = default;
    /// The Error names the shape by its index.
    static Result<ShapeLibrary> create(const ShapeDefinitions& definitions);

    /// How many there are of a type; 0 for types that are sizes alone.
    std::uint32_t count(ShapeType type) const;
    // These stay where they are as long as the library lives.
    const Hull& hull(std::uint32_t index) const { return shapes_->hulls[index]; }
    const Compound& compound(std::uint32_t index) const { return shapes_->compounds[index]; }
    const Surface& height_field(std::uint32_t index) const { return shapes_->height_fields[index]; }
    const Surface& mesh(std::uint32_t index) const { return shapes_->meshes[index]; }

    /// Lets the instance's type point to its shape; `index` is below count(type). Types that are
    /// sizes alone point to none.
    void set_shape(ShapeInstance& instance, std::uint32_t index) const;
    /// None for types that are sizes alone.
    std::optional<ShapeBuild> build(ShapeType type, std::uint32_t index) const;

private:
    struct Shapes {
        std::vector<Hull> hulls;
        std::vector<Compound> compounds;
        std::vector<Surface> height_fields;
        std::vector<Surface> meshes;
    };
    std::shared_ptr<const Shapes> shapes_ = std::make_shared<const Shapes>();
};

/// Which of its type a definition names.
std::uint32_t library_index(const ShapeDefinition& shape);

} // namespace lockwind

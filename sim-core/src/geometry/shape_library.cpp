#include "geometry/shape_library.h"

#include "geometry/fixed_geometry.h"

#include <algorithm>
#include <optional>
#include <string>

namespace lockwind {

namespace {

/// Makes one shape for each definition, in order.
template <class Definition, class Shape, class Make>
std::optional<Error> make_all(const std::vector<Definition>& definitions,
                              const char* name,
                              const char* names,
                              std::uint32_t count_max,
                              const Make& make,
                              std::vector<Shape>& shapes) {
    if (definitions.size() > count_max) {
        return Error{std::string(names) + ": " + std::to_string(definitions.size()) +
                     ", but there may be at most " + std::to_string(count_max)};
    }
    shapes.reserve(definitions.size());
    for (std::size_t index = 0; index < definitions.size(); ++index) {
        Result<Shape> made = make(definitions[index]);
        if (!made) {
            return Error{std::string(name) + " " + std::to_string(index) + ": " +
                         made.error().message};
        }
        shapes.push_back(std::move(made).value());
    }
    return std::nullopt;
}

/// Of a hull or compound.
template <class Solid>
ShapeBuild solid_build(const Solid& solid) {
    ShapeBuild build{};
    std::copy(solid.centre, solid.centre + 3, build.centre);
    std::copy(solid.orientation, solid.orientation + 4, build.orientation);
    std::copy(solid.arm, solid.arm + 3, build.arm);
    build.bounding_radius = solid.bounding_radius;
    build.volume = solid.volume;
    build.inertia = solid.inertia;
    return build;
}

} // namespace

Result<ShapeLibrary> ShapeLibrary::create(const ShapeDefinitions& definitions) {
    auto shapes = std::make_shared<Shapes>();
    const auto make_hull_of = [](const HullDefinition& hull) { return make_hull(hull.points); };
    const auto make_compound_of = [&](const CompoundDefinition& compound) {
        return make_compound(compound, shapes->hulls);
    };
    std::optional<Error> error =
        make_all(definitions.hulls, "hull", "hulls", kHullsMax, make_hull_of, shapes->hulls);
    if (!error) {
        error = make_all(definitions.compounds,
                         "compound",
                         "compounds",
                         kCompoundsMax,
                         make_compound_of,
                         shapes->compounds);
    }
    if (!error) {
        error = make_all(definitions.height_fields,
                         "height field",
                         "height fields",
                         kSurfacesMax,
                         make_height_field,
                         shapes->height_fields);
    }
    if (!error) {
        error =
            make_all(definitions.meshes, "mesh", "meshes", kSurfacesMax, make_mesh, shapes->meshes);
    }
    if (error) {
        return *error;
    }
    ShapeLibrary library;
    library.shapes_ = std::move(shapes);
    return library;
}

std::uint32_t ShapeLibrary::count(ShapeType type) const {
    switch (type) {
    case ShapeType::hull:
        return static_cast<std::uint32_t>(shapes_->hulls.size());
    case ShapeType::compound:
        return static_cast<std::uint32_t>(shapes_->compounds.size());
    case ShapeType::height_field:
        return static_cast<std::uint32_t>(shapes_->height_fields.size());
    case ShapeType::mesh:
        return static_cast<std::uint32_t>(shapes_->meshes.size());
    default:
        return 0;
    }
}

void ShapeLibrary::set_shape(ShapeInstance& instance, std::uint32_t index) const {
    switch (instance.type) {
    case ShapeType::hull:
        instance.hull = &hull(index);
        return;
    case ShapeType::compound:
        instance.compound = &compound(index);
        return;
    case ShapeType::height_field:
        instance.surface = &height_field(index);
        return;
    case ShapeType::mesh:
        instance.surface = &mesh(index);
        return;
    default:
        return;
    }
}

std::optional<ShapeBuild> ShapeLibrary::build(ShapeType type, std::uint32_t index) const {
    ShapeInstance shape{type, {0, 0, 0}, nullptr};
    set_shape(shape, index);
    if (shape.hull != nullptr) {
        return solid_build(*shape.hull);
    }
    if (shape.compound != nullptr) {
        return solid_build(*shape.compound);
    }
    if (shape.surface == nullptr) {
        return std::nullopt;
    }
    ShapeBuild build{};
    std::copy(shape.surface->centre(), shape.surface->centre() + 3, build.centre);
    build.orientation[3] = kUnitOne;
    build.bounding_radius = shape.surface->bounding_radius();
    return build;
}

std::uint32_t library_index(const ShapeDefinition& shape) {
    switch (shape.type) {
    case ShapeType::hull:
        return shape.hull;
    case ShapeType::compound:
        return shape.compound;
    case ShapeType::height_field:
        return shape.height_field;
    case ShapeType::mesh:
        return shape.mesh;
    default:
        return 0;
    }
}

} // namespace lockwind

#include "scene/shape_reader.h"

#include "geometry/compound.h"
#include "geometry/mass.h"
#include "geometry/surface.h"

#include "lockwind/trig.h"

#include <algorithm>

namespace lockwind {
namespace {

constexpr Range kSize{0.01, 250, "m"};
constexpr Range kCoordinate{-250, 250, "m"};
constexpr Range kSurfaceCoordinate{-500, 500, "m"};

std::int32_t to_length(Real value) {
    return static_cast<std::int32_t>(value.raw() >> (Real::kFraction - Length::kFraction));
}

Vec3 read_point(const FieldReader& components, const Range& range) {
    return {components.real("x", 0, range),
            components.real("y", 0, range),
            components.real("z", 0, range)};
}

std::string plural(const std::string& field) {
    return field + (field == "mesh" ? "es" : "s");
}

/// The named shapes of a scene are given a name each, and no more often than there may be.
template <class Shapes>
void check_names(const Shapes& shapes,
                 const std::string& field,
                 std::uint32_t count_max,
                 const FieldReader& scene) {
    if (shapes.size() > static_cast<int>(count_max)) {
        scene.fail(field, "is given more than " + std::to_string(count_max) + " times");
        return;
    }
    std::vector<std::string> names;
    for (int index = 0; index < shapes.size() && !scene.failed(); ++index) {
        const std::string& name = shapes[index].name();
        const FieldReader reader = scene.nested(field, index);
        if (name.empty()) {
            reader.fail("name", "is missing; bodies name their " + field);
        }
        if (std::find(names.begin(), names.end(), name) != names.end()) {
            reader.fail("name", "\"" + name + "\" is the name of two " + plural(field));
        }
        names.push_back(name);
    }
}

/// The index of the shape that a body or child names in that field.
template <class Shapes>
std::uint32_t index_of(const Shapes& shapes,
                       const std::string& field,
                       const std::string& name,
                       const FieldReader& reader) {
    std::string names;
    for (int index = 0; index < shapes.size(); ++index) {
        if (shapes[index].name() == name) {
            return static_cast<std::uint32_t>(index);
        }
        names += (index == 0 ? "" : ", ") + shapes[index].name();
    }
    reader.fail(field,
                "\"" + name + "\" is not defined; " +
                    (names.empty() ? "the scene has no " + plural(field) : "there is: " + names));
    return 0;
}

} // namespace

RealQuat read_turn(const FieldReader& reader) {
    constexpr Range kComponent{-1, 1, ""};
    if (reader.has("orientation")) {
        const FieldReader quat = reader.nested("orientation");
        const RealQuat read{quat.real("x", 0, kComponent),
                            quat.real("y", 0, kComponent),
                            quat.real("z", 0, kComponent),
                            quat.real("w", 0, kComponent)};
        if (read == RealQuat{0, 0, 0, 0}) {
            reader.fail("orientation", "is 0; give a quaternion, w: 1 for none");
            return {};
        }
        return normalized(read);
    }
    if (reader.has("rotation")) {
        const FieldReader rotation = reader.nested("rotation");
        const Vec3 axis = rotation.vector("axis", {}, kComponent);
        if (axis == Vec3{}) {
            rotation.fail("axis", "is 0; give a direction, such as { y: 1 }");
        }
        const Real degrees = rotation.real("degrees", 0, {-360, 360, "degrees"});
        return from_axis_angle(normalized(axis), Angle::from_turns(degrees / Real(360)));
    }
    return {};
}

void ShapeReader::read_named() {
    check_names(scene_.hull(), "hull", kHullsMax, reader_);
    check_names(scene_.compound(), "compound", kCompoundsMax, reader_);
    check_names(scene_.height_field(), "height_field", kSurfacesMax, reader_);
    check_names(scene_.mesh(), "mesh", kSurfacesMax, reader_);
    for (int index = 0; index < scene_.hull_size() && !reader_.failed(); ++index) {
        read_hull(index);
    }
    for (int index = 0; index < scene_.compound_size() && !reader_.failed(); ++index) {
        read_compound(index);
    }
    for (int index = 0; index < scene_.height_field_size() && !reader_.failed(); ++index) {
        read_height_field(index);
    }
    for (int index = 0; index < scene_.mesh_size() && !reader_.failed(); ++index) {
        read_mesh(index);
    }
}

void ShapeReader::read_hull(int index) {
    const scene_text::Hull& hull = scene_.hull(index);
    const FieldReader reader = reader_.nested("hull", index);
    if (hull.point_size() > static_cast<int>(kHullPointsMax)) {
        reader.fail("",
                    "has " + std::to_string(hull.point_size()) + " points; give at most " +
                        std::to_string(kHullPointsMax));
        return;
    }
    HullDefinition definition;
    for (int point = 0; point < hull.point_size(); ++point) {
        definition.points.push_back(read_point(reader.nested("point", point), kCoordinate));
    }
    if (reader.failed()) {
        return;
    }
    const Result<Hull> made = make_hull(definition.points);
    if (!made) {
        reader.fail("", "\"" + hull.name() + "\" " + made.error().message);
        return;
    }
    hulls_.push_back(made.value());
    world_.hulls.push_back(std::move(definition));
}

void ShapeReader::read_compound(int index) {
    const scene_text::Compound& compound = scene_.compound(index);
    const FieldReader reader = reader_.nested("compound", index);
    CompoundDefinition definition;
    for (int number = 0; number < compound.child_size() && !reader.failed(); ++number) {
        const FieldReader child = reader.nested("child", number);
        CompoundChild made;
        if (!read_convex(child, compound.child(number).hull(), made.shape)) {
            child.fail("", "has no shape; give sphere, capsule, box or hull");
        }
        made.position = child.vector("position", {}, kCoordinate);
        made.orientation = read_turn(child);
        made.density = child.real("density", 1, {0.001, 1000, "times the body's"});
        definition.children.push_back(made);
    }
    if (reader.failed()) {
        return;
    }
    const Result<Compound> made = make_compound(definition, hulls_);
    if (!made) {
        reader.fail("", "\"" + compound.name() + "\" " + made.error().message);
        return;
    }
    compound_volumes_.push_back(made.value().volume);
    world_.compounds.push_back(std::move(definition));
}

void ShapeReader::read_height_field(int index) {
    const scene_text::HeightField& field = scene_.height_field(index);
    const FieldReader reader = reader_.nested("height_field", index);
    HeightFieldDefinition definition;
    definition.columns = field.columns();
    definition.rows = field.rows();
    definition.spacing_x = reader.real("spacing_x", 1, kSize);
    definition.spacing_z = reader.real("spacing_z", 1, kSize);
    definition.heights = reader.reals("height", kSurfaceCoordinate);
    definition.holes.assign(field.hole().begin(), field.hole().end());
    if (reader.failed()) {
        return;
    }
    if (const Result<Surface> made = make_height_field(definition); !made) {
        reader.fail("", "\"" + field.name() + "\" " + made.error().message);
        return;
    }
    world_.height_fields.push_back(std::move(definition));
}

void ShapeReader::read_mesh(int index) {
    const scene_text::Mesh& mesh = scene_.mesh(index);
    const FieldReader reader = reader_.nested("mesh", index);
    MeshDefinition definition;
    for (int vertex = 0; vertex < mesh.vertex_size() && !reader.failed(); ++vertex) {
        definition.vertices.push_back(
            read_point(reader.nested("vertex", vertex), kSurfaceCoordinate));
    }
    definition.indices.assign(mesh.index().begin(), mesh.index().end());
    if (reader.failed()) {
        return;
    }
    if (const Result<Surface> made = make_mesh(definition); !made) {
        reader.fail("", "\"" + mesh.name() + "\" " + made.error().message);
        return;
    }
    world_.meshes.push_back(std::move(definition));
}

bool ShapeReader::read_convex(const FieldReader& holder,
                              const std::string& hull,
                              ShapeDefinition& shape) const {
    if (holder.has("sphere")) {
        shape.type = ShapeType::sphere;
        shape.radius = holder.nested("sphere").real("radius", shape.radius, kSize);
    } else if (holder.has("capsule")) {
        const FieldReader capsule = holder.nested("capsule");
        shape.type = ShapeType::capsule;
        shape.radius = capsule.real("radius", shape.radius, kSize);
        shape.half_height = capsule.real("half_height", shape.half_height, kSize);
    } else if (holder.has("box")) {
        shape.type = ShapeType::box;
        const FieldReader box = holder.nested("box");
        if (!box.has("half_extents")) {
            holder.fail("box", "has no half_extents");
        }
        shape.half_extents = box.vector("half_extents", shape.half_extents, kSize);
    } else if (holder.has("hull")) {
        shape.type = ShapeType::hull;
        shape.hull = index_of(scene_.hull(), "hull", hull, holder);
    } else {
        return false;
    }
    return true;
}

void ShapeReader::read_shape(const scene_text::Body& body,
                             const FieldReader& reader,
                             bool fixed,
                             ShapeDefinition& shape) const {
    if (read_convex(reader, body.hull(), shape)) {
        return;
    }
    const auto must_be_fixed = [&](const char* field, const char* what) {
        if (!fixed) {
            reader.fail(field, what);
        }
    };
    switch (body.shape_case()) {
    case scene_text::Body::kPlane:
        shape.type = ShapeType::plane;
        must_be_fixed("plane", "has no end and cannot move; add `mode: fixed`");
        return;
    case scene_text::Body::kCompound:
        shape.type = ShapeType::compound;
        shape.compound = index_of(scene_.compound(), "compound", body.compound(), reader);
        return;
    case scene_text::Body::kHeightField:
        shape.type = ShapeType::height_field;
        shape.height_field =
            index_of(scene_.height_field(), "height_field", body.height_field(), reader);
        must_be_fixed("height_field", "has no inside and cannot move; add `mode: fixed`");
        return;
    case scene_text::Body::kMesh:
        shape.type = ShapeType::mesh;
        shape.mesh = index_of(scene_.mesh(), "mesh", body.mesh(), reader);
        must_be_fixed("mesh", "has no inside and cannot move; add `mode: fixed`");
        return;
    default:
        reader.fail("",
                    "has no shape; give sphere, capsule, box, hull, compound, plane, height_field "
                    "or mesh");
        return;
    }
}

Real ShapeReader::mass(const ShapeDefinition& shape, Real density) const {
    switch (shape.type) {
    case ShapeType::hull:
        return mass_of(hulls_[shape.hull].volume, density);
    case ShapeType::compound:
        return mass_of(compound_volumes_[shape.compound], density);
    case ShapeType::box: {
        const std::int32_t size[3] = {to_length(shape.half_extents.x),
                                      to_length(shape.half_extents.y),
                                      to_length(shape.half_extents.z)};
        return mass_of(shape.type, size, density);
    }
    case ShapeType::sphere:
    case ShapeType::capsule: {
        const std::int32_t size[3] = {to_length(shape.radius), to_length(shape.half_height), 0};
        return mass_of(shape.type, size, density);
    }
    default:
        return 0;
    }
}

} // namespace lockwind

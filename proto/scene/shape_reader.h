#pragma once

#include "geometry/hull.h"
#include "scene.pb.h"
#include "scene/field_reader.h"

#include "lockwind/world_definition.h"

#include <string>
#include <vector>

namespace lockwind {

/// Reads the shapes of a scene: those that have names, before the bodies that name them, and those
/// that bodies and compounds' children hold themselves. Each is built once, to be checked.
class ShapeReader {
public:
    ShapeReader(const scene_text::Scene& scene, const FieldReader& reader, WorldDefinition& world)
        : scene_(scene), reader_(reader), world_(world) {}

    void read_named();
    /// The sphere, capsule, box or hull of a body or child; false where it has none of these.
    bool
    read_convex(const FieldReader& holder, const std::string& hull, ShapeDefinition& shape) const;
    /// The shape of a body, which is `fixed` or not.
    void read_shape(const scene_text::Body& body,
                    const FieldReader& reader,
                    bool fixed,
                    ShapeDefinition& shape) const;
    /// By the density; 0 for planes and surfaces.
    Real mass(const ShapeDefinition& shape, Real density) const;

private:
    void read_hull(int index);
    void read_compound(int index);
    void read_height_field(int index);
    void read_mesh(int index);

    const scene_text::Scene& scene_;
    const FieldReader& reader_;
    WorldDefinition& world_;
    std::vector<Hull> hulls_;              // as world_.hulls
    std::vector<Volume> compound_volumes_; // as world_.compounds
};

/// The turn that a message's orientation or rotation gives; none without.
RealQuat read_turn(const FieldReader& reader);

} // namespace lockwind

#pragma once

#include "scene.pb.h"
#include "scene/arrangement.h"
#include "scene/field_reader.h"
#include "scene/layer_reader.h"
#include "scene/shape_reader.h"

#include "lockwind/world_definition.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lockwind {

/// Appends the bodies and pods of a scene to a world definition whose settings are read.
class BodyReader {
public:
    BodyReader(const scene_text::Scene& scene,
               const FieldReader& reader,
               const LayerReader& layers,
               const ShapeReader& shapes,
               WorldDefinition& world);

    /// body[index]: one body, or as many as its arrangement has.
    void read_body(int index);
    /// One pod for each of `players`.
    void read_pods(std::uint32_t players);

private:
    BodyDefinition read_common(const scene_text::Body& body, const FieldReader& reader) const;
    void read_motion(const FieldReader& reader, BodyDefinition& definition) const;
    void read_matter(const scene_text::Body& body,
                     const FieldReader& reader,
                     BodyDefinition& definition) const;
    void check_mass(const FieldReader& reader, const BodyDefinition& definition) const;
    std::vector<Placement> read_arrangement(const scene_text::Body& body,
                                            const FieldReader& reader) const;
    bool room_for(std::uint64_t count, const FieldReader& reader) const;
    void
    append(const BodyDefinition& definition, const Placement& place, const FieldReader& reader);
    PodDefinition read_pod(const FieldReader& reader) const;

    const scene_text::Scene& scene_;
    const FieldReader& reader_;
    const LayerReader& layers_;
    const ShapeReader& shapes_;
    WorldDefinition& world_;
};

} // namespace lockwind

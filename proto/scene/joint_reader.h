#pragma once

#include "scene.pb.h"
#include "scene/field_reader.h"

#include "lockwind/world_definition.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lockwind {

/// Appends the joints of a scene to a world definition whose bodies are read.
class JointReader {
public:
    JointReader(const scene_text::Scene& scene, const FieldReader& reader, WorldDefinition& world);

    /// body[index] became `count` bodies from `first` of the world's on.
    void note_body(int index, std::size_t first, std::size_t count);
    /// joint[index]
    void read_joint(int index);

private:
    /// Joint's body, where found; 0 otherwise, with an error.
    BodyId find_body(const FieldReader& reader, const std::string& field, const std::string& name);
    void read_frames(const scene_text::Joint& joint,
                     const FieldReader& reader,
                     JointDefinition& definition);
    void read_kind(const scene_text::Joint& joint,
                   const FieldReader& reader,
                   JointDefinition& definition);

    struct Named {
        std::string name;
        BodyId first;
        std::size_t count;
        bool arranged;
    };
    const scene_text::Scene& scene_;
    const FieldReader& reader_;
    WorldDefinition& world_;
    std::vector<Named> named_;
};

} // namespace lockwind

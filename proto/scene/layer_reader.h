#pragma once

#include "scene.pb.h"
#include "scene/field_reader.h"

#include "lockwind/world_definition.h"

#include <array>
#include <cstdint>
#include <google/protobuf/repeated_field.h>
#include <string>
#include <vector>

namespace lockwind {

/// The scene's layers: names for the numbers and masks of the core. Layer 0 is "default".
class LayerReader {
public:
    /// Reports what is wrong with the scene's layers.
    LayerReader(const scene_text::Scene& scene, const FieldReader& reader);

    /// For WorldSettings.
    std::array<std::uint32_t, kLayerCount> masks() const { return masks_; }
    /// The layer that field `layer` of a body names; "" is layer 0.
    std::uint32_t read_layer(const std::string& name, const FieldReader& reader) const;
    /// All layers but those that field `ignores` names.
    std::uint32_t read_mask(const google::protobuf::RepeatedPtrField<std::string>& ignores,
                            const FieldReader& reader) const;

private:
    std::uint32_t
    find(const std::string& name, const std::string& field, const FieldReader& reader) const;

    std::vector<std::string> names_{"default"};
    std::array<std::uint32_t, kLayerCount> masks_ = all_layers();
};

} // namespace lockwind

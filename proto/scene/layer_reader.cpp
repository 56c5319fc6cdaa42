#include "scene/layer_reader.h"

#include <algorithm>

namespace lockwind {

LayerReader::LayerReader(const scene_text::Scene& scene, const FieldReader& reader) {
    for (int index = 0; index < scene.layer_size(); ++index) {
        const std::string& name = scene.layer(index).name();
        const FieldReader layer = reader.nested("layer", index);
        const auto same = std::find(names_.begin(), names_.end(), name);
        if (name.empty()) {
            layer.fail("", "has no name");
        } else if (same == names_.end()) {
            names_.push_back(name);
        } else if (same != names_.begin() || index > 0) {
            layer.fail("name", "\"" + name + "\" is a layer already; \"default\" comes first");
        }
    }
    if (names_.size() > kLayerCount) {
        reader.fail("layer", "there are more than 31 layers beside \"default\"");
        return;
    }
    for (int index = 0; index < scene.layer_size(); ++index) {
        const FieldReader layer = reader.nested("layer", index);
        const std::uint32_t number = find(scene.layer(index).name(), "name", layer);
        masks_[number] = read_mask(scene.layer(index).ignores(), layer);
    }
}

std::uint32_t LayerReader::find(const std::string& name,
                                const std::string& field,
                                const FieldReader& reader) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) {
        std::string known;
        for (const std::string& other : names_) {
            known += (known.empty() ? "" : ", ") + other;
        }
        reader.fail(field, "\"" + name + "\" is no layer of the scene; there is: " + known);
        return 0;
    }
    return static_cast<std::uint32_t>(found - names_.begin());
}

std::uint32_t LayerReader::read_layer(const std::string& name, const FieldReader& reader) const {
    return name.empty() ? 0 : find(name, "layer", reader);
}

std::uint32_t LayerReader::read_mask(const google::protobuf::RepeatedPtrField<std::string>& ignores,
                                     const FieldReader& reader) const {
    std::uint32_t mask = kAllLayers;
    for (const std::string& name : ignores) {
        mask &= ~(1U << find(name, "ignores", reader));
    }
    return mask;
}

} // namespace lockwind

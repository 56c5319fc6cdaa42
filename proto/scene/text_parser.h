#pragma once

#include "scene.pb.h"
#include "scene/field_reader.h"

#include <google/protobuf/text_format.h>
#include <string_view>

namespace lockwind {

/// Text to message; `tree` tells where each field stands. False, with an error, where it is no
/// scene.
bool parse_scene_text(std::string_view text,
                      scene_text::Scene& scene,
                      google::protobuf::TextFormat::ParseInfoTree& tree,
                      SceneErrors& errors);

} // namespace lockwind

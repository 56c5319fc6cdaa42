#pragma once

#include "scene.pb.h"
#include "scene/field_reader.h"
#include "scene/scene.h"

namespace lockwind {

/// `settings` of the scene, with what the match adds.
WorldSettings read_settings(const scene_text::Scene& scene,
                            const FieldReader& scene_reader,
                            const SceneOptions& options);

} // namespace lockwind

#pragma once

#include "scene/field_reader.h"
#include "scene/scene.h"

namespace lockwind {

/// `settings` of the scene, with what the match adds.
WorldSettings read_settings(const FieldReader& scene, const SceneOptions& options);

} // namespace lockwind

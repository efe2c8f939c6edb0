#pragma once

// What acts on the bodies of a scene file: springs, dampers, friction, drives, loads and stops. Private to the readers
// of model/.

#include "model/scene.hpp"
#include "model/scene_names.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Reads these tables of the document `root` and adds what they hold to the scene, whose units, bodies and joints were
/// read before and are known to `names`. Throws InputError with file, line and item.
void read_elements(const TomlTable& root, const SceneNames& names, Scene& scene);

}  // namespace poise

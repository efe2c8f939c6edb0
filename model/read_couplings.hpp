#pragma once

// Reads the tables of a scene file that bind measures to one another. Private to the readers of model/.

#include "model/scene.hpp"
#include "model/scene_names.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Reads the tables of coupling_kinds() and adds each as a stop to the scene, whose bodies and joints are registered in
/// `names`. Values that the file does not give are NaN until set_values_from_start(). Throws InputError with file, line
/// and item.
void read_couplings(const TomlTable& root, const SceneNames& names, Scene& scene);

/// Gives couplings without a value the one that their measure has at the guesses of [start], which has been read.
/// Throws InputError where that is not known.
void set_values_from_start(const TomlTable& root, Scene& scene);

}  // namespace poise

#pragma once

#include <string>

#include "model/scene.hpp"

namespace poise {

/// Makes the change "PATH=NUMBER" in a scene, in the scene's own units (see set_value). Throws InputError
/// "--set PATH=NUMBER: ...".
void apply_setting(Scene& scene, const std::string& setting);

}  // namespace poise

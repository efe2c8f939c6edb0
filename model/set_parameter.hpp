#pragma once

#include <string>

#include "model/scene.hpp"

namespace poise {

/// Sets one parameter of a scene by "PATH=NUMBER", in the scene's own units (see set_value). Throws InputError
/// "--set PATH=NUMBER: ...".
void set_parameter(Scene& scene, const std::string& change);

}  // namespace poise

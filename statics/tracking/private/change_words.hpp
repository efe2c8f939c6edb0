#pragma once

#include <string>

#include "statics/model/varied_scene.hpp"

namespace poise {

/// Numbers that vary together (VariedScene from one scene to another) at a part of the change: "load.P = 37.0934 N". Of
/// more than two, which nobody could read off at a glance: "80 % of the change".
std::string place_in_words(const VariedScene& varied, double part);

}  // namespace poise

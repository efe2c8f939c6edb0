#pragma once

#include <string>

#include "design/synthesis/four_bar.hpp"
#include "model/scene.hpp"

namespace poise {

/// The four-bar as a scene without masses: ground points A and B, bodies "input" (A, C), "coupler" (C, D, P) and
/// "output" (B, D), pins, and the start. Throws InputError where it is no linkage, as with a link of length 0.
Scene four_bar_scene(const FourBar& linkage, const FourBarPose& start, const std::string& title, const Units& units);

}  // namespace poise

#pragma once

#include "design/synthesis/path_problem.hpp"
#include "design/synthesis/path_search.hpp"
#include "model/scene.hpp"

namespace poise {

/// The linkage as a scene without masses, at the first of its points: a four-bar as of four_bar_scene(), a slider-crank
/// with ground points A (crank) and S (on the line of the slider), bodies "input" (A, C) and "coupler" (C, D, P), and D
/// guided along that line. Throws InputError where the links do not reach.
Scene path_scene(const PathProblem& problem, const PathSolution& solution);

}  // namespace poise

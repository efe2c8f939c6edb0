#pragma once

#include <string>

#include "model/scene.hpp"

namespace poise::benchmarks {

/// The scene of this name for all solvers of poise_baselines: a file of datasets/ ("toggle_press.toml") or "chain of 10
/// links" (comparison::hanging_chain_scene). Throws InputError.
Scene baseline_scene(const std::string& name);

}  // namespace poise::benchmarks

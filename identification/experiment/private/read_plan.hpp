#pragma once

#include "identification/experiment/experiment.hpp"
#include "model/scene_names.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Reads [plan] of an experiment whose other parts have been read. Throws InputError.
PlanLimits read_plan(const TomlTable& table, const SceneNames& names, const Experiment& experiment);

}  // namespace poise

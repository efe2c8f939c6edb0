#pragma once

// The readings at rest of an experiment file and their data.

#include <filesystem>

#include "identification/experiment/experiment.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Reads the tables [[static]] of the document `root` and the data files they name, and adds them to the runs and
/// records of an experiment whose scene, sensors and other runs were read before; `folder` holds the experiment file.
void read_static_runs(const TomlTable& root, const std::filesystem::path& folder, Experiment& experiment);

}  // namespace poise

#pragma once

// The runs of an experiment file and their data.

#include <filesystem>
#include <vector>

#include "identification/experiment/experiment.hpp"
#include "model/scene_names.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Reads the tables [[run]] of the document `root` and the data files they name, and fills in the runs and records of
/// an experiment whose scene and sensors were read before; `names` knows the scene, `folder` holds the experiment file.
/// `data` takes the place of the one file that the runs name; empty: none does.
void read_runs(const TomlTable& root, const SceneNames& names, const std::filesystem::path& folder,
               const std::filesystem::path& data, Experiment& experiment);

}  // namespace poise

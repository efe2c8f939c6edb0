#pragma once

// The runs of an experiment file and their data. Private to read_experiment.

#include <filesystem>
#include <vector>

#include "identification/experiment.hpp"
#include "identification/experiment_table.hpp"
#include "model/scene_names.hpp"

namespace poise {

/// Calls f; what it throws as InputError is thrown again with the place in front.
template <class F>
auto located(const TomlPlace& place, F f) {
  try {
    return f();
  } catch (const InputError& error) {
    place.fail(error.what());
  }
}

/// The key `set` of a table: known changes, which are made in the scene as well.
std::vector<Run::Change> read_changes(const ExperimentTable& table, Scene& scene);

/// Reads the tables [[run]] of the document `root` and the data files they name, and fills in the runs and records of
/// an experiment whose scene and sensors were read before; `names` knows the scene, `folder` holds the experiment file.
/// `data` takes the place of the one file that the runs name; empty: none does.
void read_runs(const ExperimentTable& root, const SceneNames& names, const std::filesystem::path& folder,
               const std::filesystem::path& data, Experiment& experiment);

}  // namespace poise

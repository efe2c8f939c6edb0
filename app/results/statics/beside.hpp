#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/path_measures.hpp"

namespace poise::app {

/// The curve of equilibria of one of several scenes over the same range of the same number.
struct SceneBeside {
  std::string label;                    ///< "press", "A"
  std::vector<std::string> settings{};  ///< with which the scene was read
  VariedScene varied;
  std::vector<SoughtQuantity> measures{};  ///< those shown, of the same names and units in all scenes
  Path found{};

  bool is_proved() const { return found.status == Path::Status::traced && found.unproved() == 0; }
};

/// What `poise path` shows of several scenes: their folds, and the values of each measure where they were asked for,
/// `at`, SI, with the differences from the first scene. Of several equilibria at one value the first of each scene are
/// compared, then the second ones, in the order of the curves. All points in CSV.
Result beside_result(const std::vector<SceneBeside>& scenes, const std::vector<double>& at);

}  // namespace poise::app

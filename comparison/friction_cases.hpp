#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "model/parameter_change.hpp"
#include "model/scene.hpp"
#include "statics/friction/held.hpp"

namespace poise::comparison {

/// A pose with friction whose verdict is known in closed form: just on one side of the edge of slipping, or held
/// whatever the load.
struct FrictionCase {
  std::string name;                      ///< unique among them: "wedge-below-1e-9"
  std::string title;                     ///< one line: the difficulty
  std::string source;                    ///< of the closed form
  std::string scene;                     ///< file, resolved
  std::vector<ParameterChange> changes;  ///< of the scene
  Holding verdict = Holding::held;       ///< or slips
  /// If not empty: a number of the scene that may grow without end, the pose being held.
  std::string without_end;
};

/// What became of a case.
struct FrictionResult {
  FrictionCase known;
  HeldPose pose;
  bool agrees = false;  ///< with the verdict, and, if asked for, the end of the range
  bool proved = false;  ///< what agrees is proved in ball arithmetic
  std::string why;      ///< where it does not agree: one sentence
};

/// Reads friction.toml of the catalogue's folder (grammar in docs/hard-cases.md); no cases where there is no such file.
/// Throws InputError (file, line, item, what was expected).
std::vector<FrictionCase> read_friction_cases(const std::filesystem::path& folder);

/// Holds the pose of a case as drawn and compares. Throws InputError of its scene.
FrictionResult run_friction_case(const FrictionCase& known);

}  // namespace poise::comparison

#pragma once

// An experiment on a small mechanism, in a folder of its own.

#include <numbers>
#include <string>

#include "identification/experiment/experiment.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::test {

inline constexpr double degree = std::numbers::pi / 180.0;

/// A crank that drives a block along a rail against a spring, in the units of a workshop.
inline constexpr const char* bench_scene = R"(title = "Crank and block"

[units]
length = "mm"
mass = "g"
angle = "deg"

[ground]
points = { O = [0, 0] }

[body.crank]
points = { O = [0, 0], B = [100, 0] }
mass = 500
inertia = 4e5

[body.rod]
points = { B = [0, 0], C = [300, 0] }
mass = 200

[body.block]
points = { C = [0, 0] }
mass = 800

[[pin]]
points = ["ground.O", "crank.O"]

[[pin]]
points = ["crank.B", "rod.B"]

[[pin]]
points = ["rod.C", "block.C"]

[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]

[[spring]]
name = "coil"
points = ["ground.O", "block.C"]
stiffness = 2
free_length = 350

[[torsion_spring]]
name = "wrap"
bodies = ["ground", "crank"]
stiffness = 3

[[torsion_damper]]
name = "grease"
bodies = ["ground", "crank"]
coefficient = 0.5

[[force]]
name = "P"
at = "block.C"
vector = [-5, 0]

[start]
crank = 40
rail = 350
)";

inline const std::string bench_header = "scene = \"scene.toml\"\n";
inline const std::string bench_sensor = "[[sensor]]\nname = \"a\"\nangle = \"crank\"\nnoise = 0.1\n";
inline const std::string bench_run = "[[run]]\nduration = 2\nrate = 100\n";
inline const std::string bench_measured = "[[run]]\ndata = \"data.csv\"\n";

/// A folder with the scene, an experiment (experiment.toml) and its data (data.csv, and slow.csv of a second logger).
class Bench {
 public:
  explicit Bench(const std::string& experiment, const std::string& data = "", const std::string& slow = "");

  Experiment read(const ExperimentOptions& options = {}) const;
  /// What is said about it, without the folder's name; empty when it is taken.
  std::string error(const ExperimentOptions& options = {}) const;
  const app_tests::TempFolder& folder() const { return folder_; }

 private:
  app_tests::TempFolder folder_;
  std::string file_;
};

}  // namespace poise::test

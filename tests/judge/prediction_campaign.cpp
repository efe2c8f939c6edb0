#include "tests/judge/prediction_campaign.hpp"

#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "identification/assessment/carried_numbers.hpp"
#include "identification/assessment/identify.hpp"
#include "identification/experiment/experiment.hpp"
#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/sensitivity/fitted_numbers.hpp"

namespace poise::judge {
namespace {

constexpr double stiffness = 10000.0, free_length = 0.412;

}  // namespace

std::string rig_scene() {
  return fmt::format(R"(
[ground]
points = {{ O = [0, 0], wall = [1, 0] }}
[body.left]
points = {{ O = [0, 0], knee = [0.3, 0] }}
[body.right]
points = {{ knee = [0, 0], C = [0.3, 0] }}
[body.block]
points = {{ C = [0, 0] }}
mass = 4
[[pin]]
name = "O"
points = ["ground.O", "left.O"]
[[pin]]
name = "knee"
points = ["left.knee", "right.knee"]
[[pin]]
name = "C"
points = ["right.C", "block.C"]
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[spring]]
name = "rubber"
points = ["ground.wall", "block.C"]
stiffness = {}
free_length = {}
[[damper]]
name = "block"
points = ["ground.wall", "block.C"]
coefficient = 10
[[force]]
name = "P"
at = "left.knee"
vector = [0, -8]
[start]
left = 0.19
right = -0.19
rail = 0.589
)",
                     stiffness, free_length);
}

std::string rig_experiment(std::uint64_t seed) {
  return fmt::format(R"(
scene = "rig.toml"
[[sensor]]
name = "left"
angle = "left"
noise = 4e-3
[[unknown]]
path = "spring.rubber.stiffness"
name = "k"
start = 9000
min = 1000
[[unknown]]
path = "spring.rubber.free_length"
name = "l0"
start = 0.411
[[unknown]]
path = "damper.block.coefficient"
name = "c"
start = 15
min = 0
[[run]]
name = "swing"
release = {{ left = 0.22 }}
duration = 1.5
rate = 100
seed = {}
)",
                     seed);
}

CarriedFit carried_fit(std::uint64_t seed) {
  CarriedFit out;
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "poise_rig" / "experiment.toml";
  ExperimentOptions reading;
  Scene as_written = parse_scene(rig_scene(), (file.parent_path() / "rig.toml").string());
  reading.scene = std::make_shared<const Scene>(as_written);
  const FitProblem problem(parse_experiment(rig_experiment(seed), file, reading));
  const Identification answer = identify(problem);
  const std::optional<FittedNumbers> carried = carried_numbers(problem, answer);
  if (!carried) {
    out.why = "no fit: " + answer.fit.why;
    return out;
  }
  const FittedNumbers numbers = carried->of(as_written);
  numbers.put_into(as_written);
  const StaticModel model(as_written);
  const PredictedResult found =
      predict(numbers, model, solve(model), {find_quantity(as_written, "fold.load.P")}).front();
  out.why = found.why.empty() ? found.undetermined : found.why;
  out.value = found.value;
  out.low = found.low;
  out.high = found.high;
  out.first_low = found.first_low;
  out.first_high = found.first_high;
  out.is_linear = found.is_linear;
  return out;
}

double true_snap_load() {
  const auto load = [](double a) { return 2 * stiffness * (free_length - 1 + 0.6 * std::cos(a)) * std::tan(a); };
  double low = 0.0, high = std::acos((1 - free_length) / 0.6);  // golden section
  const double part = (std::sqrt(5.0) - 1) / 2;
  for (int k = 0; k < 120; ++k) {
    const double a = high - part * (high - low), b = low + part * (high - low);
    (load(a) > load(b) ? high : low) = load(a) > load(b) ? b : a;
  }
  return load(0.5 * (low + high));
}

}  // namespace poise::judge

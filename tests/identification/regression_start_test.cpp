// Starts of fits from the equations of motion and smoothed readings alone.

#include "identification/fit/regression_start.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"

namespace poise::regression_start_test {
namespace {

const std::string scene = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.upper]
points = { A = [0, 0], B = [0.3, 0] }
mass = 1.2
center = [0.16, 0]
inertia = 0.02
[body.lower]
points = { B = [0, 0] }
mass = 0.7
center = [0.14, 0]
inertia = 0.01
[[pin]]
points = ["ground.O", "upper.A"]
[[pin]]
points = ["upper.B", "lower.B"]
[[torsion_damper]]
name = "grease"
bodies = ["ground", "upper"]
coefficient = 0.12
[[torsion_damper]]
name = "oil"
bodies = ["upper", "lower"]
coefficient = 0.03
[[torque]]
name = "shoulder"
on = "upper"
value = 3
time = { sine = { amplitude = 1, frequency = 0.8 } }
[[torque]]
name = "elbow"
on = "lower"
value = 0.7
time = { sine = { amplitude = 1, frequency = 1.3 } }
[start]
upper = -1.5707963267948966
lower = -1.5707963267948966
)";

const std::string upper = "[[sensor]]\nname = \"one\"\nangle = \"upper\"\nnoise = 1e-3\n";
const std::string relative = "[[sensor]]\nname = \"two\"\nangle = [\"upper\", \"lower\"]\nnoise = 1e-3\n";

// Far off: lighter arms of a quarter of the inertia, and damping 10 times too large.
const std::string unknowns = R"(
[[unknown]]
path = "body.lower.mass"
start = 0.2
[[unknown]]
path = "body.upper.inertia"
start = 0.1
[[unknown]]
path = "body.lower.inertia"
start = 0.001
[[unknown]]
path = "torsion_damper.grease.coefficient"
start = 1.2
[[unknown]]
path = "torsion_damper.oil.coefficient"
start = 0.3
)";

const std::string swing = "[[run]]\nduration = 10\nrate = 200\nrelease = { upper = -1, lower = -1.2 }\n";

const std::vector<double> truth = {0.7, 0.02, 0.01, 0.12, 0.03};

class RegressionStart : public test::WrittenExperiment {
 protected:
  RegressionStart() : WrittenExperiment(scene) {}
};

TEST_F(RegressionStart, IsNearTheTruthWithoutAGuess) {
  const Experiment e = read("scene = \"scene.toml\"\n" + upper + relative + unknowns + swing);
  const FitProblem problem(e);
  const auto found = start_from_regression(problem, problem.records());
  ASSERT_TRUE(found);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR((*found)[i], truth[i], 0.15 * truth[i]) << problem.parameters()[i].name;
  }
}

TEST_F(RegressionStart, LeadsAFitToTheTruth) {
  const Experiment e = read("scene = \"scene.toml\"\n" + upper + relative + unknowns + swing);
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records(), {.retries = 0});
  ASSERT_EQ(found.status, FitStatus::converged) << found.why;
  EXPECT_EQ(found.start, "from the equations of motion fitted to smoothed readings, no guess needed");
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(found.estimates[i].value, truth[i], 4 * found.estimates[i].standard_error) << found.estimates[i].name;
  }
}

TEST_F(RegressionStart, NeedsAllFreedoms) {
  const Experiment e = read("scene = \"scene.toml\"\n" + upper + unknowns + swing);
  const FitProblem problem(e);
  EXPECT_FALSE(start_from_regression(problem, problem.records()));
}

}  // namespace
}  // namespace poise::regression_start_test

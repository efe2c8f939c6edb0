// What readings determine of masses and inertias that they leave open: against fits of these sums themselves.

#include "identification/assessment/determined_inertia.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/experiment/experiment.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::determined_inertia_test {
namespace {

/// An arm of 1.2 kg, centre 0.3 m, 0.02 kg m^2 on a motor; `numbers` and what `body` says of its inertia, `unknowns` of
/// it.
Experiment arm(const app_tests::TempFolder& folder, const std::string& numbers, const std::string& body,
               const std::string& unknowns) {
  folder.write("arm.toml", fmt::format(R"(
gravity = [0, -9.81]
{}
[ground]
points = {{ O = [0, 0] }}
[body.arm]
points = {{ O = [0, 0] }}
{}
[[pin]]
points = ["ground.O", "arm.O"]
[[torsion_damper]]
name = "bearing"
bodies = ["ground", "arm"]
coefficient = 0.05
[[torque]]
name = "motor"
on = "arm"
value = 1
time = {{ sine = {{ amplitude = 1, frequency = 0.7 }} }}
[start]
arm = -1.57
)",
                                       numbers, body));
  return read_experiment(folder.write("experiment.toml", fmt::format(R"(
scene = "arm.toml"
[[sensor]]
name = "phi"
angle = "arm"
noise = 1e-3
{}
[[run]]
name = "A"
release = {{ arm = -0.7 }}
duration = 6
rate = 100
seed = 1
)",
                                                                     unknowns)));
}

std::string unknown(const std::string& path, double start) {
  return fmt::format("[[unknown]]\npath = \"{}\"\nstart = {}\n", path, start);
}

// The readings determine m c and I + m c^2 of m, c and I alone, with the errors of a fit of these two.
TEST(DeterminedInertia, HasTheErrorsOfAFitOfItsSums) {
  const app_tests::TempFolder folder;
  const Experiment open =
      arm(folder, "", "mass = 1.2\ncenter = [0.3, 0]\ninertia = 0.02\n",
          unknown("body.arm.mass", 1.1) + unknown("body.arm.center.x", 0.28) + unknown("body.arm.inertia", 0.022));
  const FitProblem problem(open);
  const Identification answer = identify(problem);
  ASSERT_TRUE(answer.fit.usable());
  for (const Estimate& estimate : answer.fit.estimates) EXPECT_TRUE(estimate.withheld) << estimate.name;
  const std::vector<PredictedResult> found = determined_inertia(problem, answer);
  ASSERT_EQ(found.size(), 2U);

  const app_tests::TempFolder other;
  const Experiment sums = arm(other, "[numbers]\nfirst = 0.36\nabout_O = 0.128\nm = 1.2\n",
                              "mass = \"m\"\ncenter = [\"first/m\", 0]\ninertia = \"about_O - first^2/m\"\n",
                              unknown("numbers.first", 0.34) + unknown("numbers.about_O", 0.12));
  const Identification direct = identify(FitProblem(sums));
  const double truth[] = {0.128, 0.36};
  for (std::size_t k = 0; k < 2; ++k) {
    const Estimate& expected = direct.fit.estimates[1 - k];
    EXPECT_EQ(found[k].name, k == 0 ? "arm.J" : "arm.m x");
    EXPECT_NEAR(found[k].value, expected.value, 1e-3 * expected.standard_error) << found[k].name;
    EXPECT_NEAR(found[k].sigma, expected.standard_error, 1e-3 * expected.standard_error) << found[k].name;
    EXPECT_LT(std::abs(found[k].value - truth[k]), 4 * found[k].sigma);
  }
}

// With the mass known all are identifiable, and nothing is left to be summed up.
TEST(DeterminedInertia, IsNotForWhatIsIdentifiable) {
  const app_tests::TempFolder folder;
  const Experiment known = arm(folder, "", "mass = 1.2\ncenter = [0.3, 0]\ninertia = 0.02\n",
                               unknown("body.arm.center.x", 0.28) + unknown("body.arm.inertia", 0.022));
  const FitProblem problem(known);
  EXPECT_TRUE(determined_inertia(problem, identify(problem)).empty());
}

}  // namespace
}  // namespace poise::determined_inertia_test

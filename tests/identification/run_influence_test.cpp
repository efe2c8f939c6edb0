// Runs that disagree with the others where the model is far from linear: pendulums that swing up to 2 rad.

#include "identification/fit/private/run_influence.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "tests/identification/experiments.hpp"

namespace poise::run_influence_test {
namespace {

constexpr double damping = 0.01;

/// Six runs of one pendulum, its inertia and damping unknown.
Experiment pendulum() {
  Experiment out;
  out.scene = parse_scene(R"(
    gravity = [0, -9.81]
    [ground]
    points = { O = [0, 0] }
    [body.bob]
    points = { O = [0, 0] }
    mass = 1
    center = [0, -0.3]
    inertia = 0.02
    [[pin]]
    points = ["ground.O", "bob.O"]
    [[torsion_damper]]
    name = "air"
    bodies = ["ground", "bob"]
    coefficient = 0.01
  )",
                          "pendulum.toml");
  out.sensors = {test::angle_of(out.scene, "bob", 1e-3)};
  out.unknowns = {test::unknown("body.bob.inertia"), test::unknown("torsion_damper.air.coefficient")};
  for (int r = 0; r < 6; ++r) {
    Release turn;
    turn.body = 1;
    turn.value = 2.0 - 0.05 * r;
    out.runs.push_back(test::simulated(100, 800, {turn}));
    out.runs.back().name = std::to_string(r);
  }
  return out;
}

/// The records, of which run 2 is of a pendulum with `factor` times the damping.
std::vector<Record> records_of(const FitProblem& problem, double factor, std::uint64_t seed) {
  Experiment odd = problem.experiment();
  set_value(odd.scene, "torsion_damper.air.coefficient", factor * damping);
  const FitProblem other(odd);
  std::vector<Record> out;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    out.push_back((r == 2 ? other : problem).ideal_record(r));
    problem.add_noise(out.back(), solvers::RandomStream(10 * seed + r));
  }
  return out;
}

// The one run moves the common fit so far that to first order no run, or another one, is off.
TEST(RunInfluence, NamesTheRunWithMoreDamping) {
  for (const bool noise_known : {true, false}) {
    Experiment experiment = pendulum();
    experiment.sensors[0].noise_known = noise_known;
    const FitProblem problem(experiment);
    for (const double factor : {1.5, 2.0, 3.0}) {
      const Fit found = fit(problem, records_of(problem, factor, 1));
      ASSERT_EQ(found.errors.disagreement.size(), 6U);
      for (std::size_t r = 0; r < 6; ++r) {
        EXPECT_EQ(found.errors.disagreement[r] > disagrees_from, r == 2)
            << factor << ", " << r << ": " << found.errors.disagreement[r];
      }
      EXPECT_NEAR(found.parameters[1] + found.errors.without_run[2][1], damping, 0.01 * damping)
          << "the fit without it finds the damping of the others";
    }
  }
}

TEST(RunInfluence, NamesNoneOfEqualPendulums) {
  const Experiment experiment = pendulum();
  const FitProblem problem(experiment);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Fit found = fit(problem, records_of(problem, 1.0, seed));
    for (const double disagreement : found.errors.disagreement) EXPECT_LT(disagreement, disagrees_from) << seed;
  }
}

}  // namespace
}  // namespace poise::run_influence_test

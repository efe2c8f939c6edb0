// Friction that sticks: derivatives of readings across its events, and what fits find.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "model/joint_friction.hpp"
#include "model/read_scene.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::dry_friction_test {
namespace {

/// Two arms that swing and come to a stop one after the other, and again.
Experiment two_arms(double width, double torque) {
  Experiment e;
  e.scene = read_scene(test::dataset("double_pendulum.toml"));
  for (Element& element : e.scene.elements) {
    if (auto* dry = std::get_if<DryFriction>(&element.law)) *dry = {torque, width};
  }
  e.sensors = {test::angle_of(e.scene, "arm1", 1e-4), test::angle_of(e.scene, "arm2", 1e-4)};
  for (const char* path :
       {"body.arm1.inertia", "body.arm2.center.x", "point.arm1.elbow.x", "torsion_damper.shoulder.coefficient",
        "friction.shoulder dry.torque", "friction.elbow dry.torque"}) {
    e.unknowns.push_back(test::unknown(path));
  }
  e.runs = {test::simulated(200, 500)};
  return e;
}

TEST(DryFriction, DerivativesCrossItsEvents) {
  for (const double torque : {3e-3, 3e-2}) {  // with the larger one both arms are held in the end
    Experiment e = two_arms(0.0, torque);
    const FitProblem problem(e);
    const RunModel& run = problem.run(0);
    const std::vector<double> numbers = run.scene_values();
    const std::vector<double> nuisances = {-0.55, 0.4, 0.3, -0.2};
    Prediction whole;
    run.predict(numbers.data(), nuisances.data(), INFINITY, 1e-10, true, whole);
    ASSERT_TRUE(whole.ok) << whole.why;
    const auto columns = static_cast<std::size_t>(run.columns());
    for (std::size_t c = 0; c < columns; ++c) {
      std::vector<double> p = numbers, n = nuisances;
      double& moved = c < numbers.size() ? p[c] : n[c - numbers.size()];
      const double at = moved, size = std::max(std::abs(at), 1e-4);
      const std::vector<double> expected = test::derivative(
          [&](double h) {
            moved = at + h;
            Prediction there;
            run.predict(p.data(), n.data(), INFINITY, 1e-10, false, there);
            return there.reading;
          },
          1e-4 * size);
      double largest = 0.0;
      for (const double x : expected) largest = std::max(largest, std::abs(x));
      ASSERT_EQ(expected.size(), whole.reading.size());
      for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_NEAR(whole.jacobian[i * columns + c], expected[i], 1e-6 * largest)
            << "column " << c << ", reading " << i << ", torque " << torque;
      }
    }
  }
}

TEST(DryFriction, FreeOscillationDeterminesTorqueAndStiffness) {
  Experiment e = two_arms(0.0, 2e-3);
  e.unknowns.clear();
  for (const auto& [path, start] : {std::pair{"body.arm2.inertia", 1.5e-3},
                                    {"friction.shoulder dry.torque", 1e-3},
                                    {"friction.elbow dry.torque", 3e-3}}) {
    e.unknowns.push_back(test::unknown(path));
    e.unknowns.back().start = start;
  }
  for (const auto& [body, angle] : {std::pair{1, -0.6}, {2, 0.4}}) {
    Release& release = e.runs[0].release.emplace_back();
    release.body = body;
    release.value = angle;
  }
  const FitProblem problem(e);
  const std::vector<Record> records = {problem.ideal_record(0)};
  FitOptions options;
  options.function_tolerance = 1e-14;
  const Fit found = fit(problem, records, options);
  ASSERT_EQ(found.parameters.size(), 3U) << found.why;
  const std::vector<double> truth = problem.truths();
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_NEAR(found.parameters[i], truth[i], 1e-6 * truth[i]) << i;
}

/// A block that a growing push breaks loose, as StickSlip.BreaksLooseUnderALoadThatGrows.
TEST(DryFriction, OfABlockThatBreaksLooseIsFound) {
  Experiment e;
  e.scene = resisted_by_joints(parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
mass = 1
[[slide]]
name = "x"
points = ["ground.O", "block.C"]
axis = [1, 0]
friction = { force = 0.3 }
[[force]]
at = "block.C"
vector = [1, 0]
time = { sine = { amplitude = 4, frequency = 0.6 } }
)",
                                           "block.toml"));
  Sensor travel;
  travel.name = "x";
  travel.on = Measure::travel_of(0);
  travel.noise = 1e-4;
  e.sensors = {travel};
  e.unknowns = {test::unknown("slide.x.friction.force")};
  e.unknowns.back().start = 0.2;
  e.runs = {test::simulated(200, 400)};
  const FitProblem problem(e);
  const Fit found = fit(problem, {problem.ideal_record(0)}, {});
  ASSERT_EQ(found.parameters.size(), 1U) << found.why;
  EXPECT_NEAR(found.parameters[0], 0.3, 1e-6);
}

}  // namespace
}  // namespace poise::dry_friction_test

// Named numbers as unknowns: Jacobians of predictions against differences, and a fit that recovers one.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "tests/identification/experiments.hpp"

namespace poise::identification_named_numbers_test {
namespace {

// One number in everything: inertia, places, lengths, forces with their directions, gravity, an axis, a sum, a drive.
Scene scene(bool driven) {
  std::string text = R"-(
gravity = ["r/5", "-9 - r"]
[numbers]
r = 0.8
half = "r/2"
idle = 3
[ground]
points = { O = [0, "r/10"], S = ["1 + r", 0.3] }
[body.arm]
points = { O = [0, 0], B = ["r", "r^2/9"] }
mass = "1 + r^2"
center = ["half", 0.02]
inertia = "0.05*exp(r)"
[body.block]
points = { p = [0, 0.1], q = ["0.2*r", 0] }
mass = 0.7
center = [0.05, 0]
inertia = 0.03
[[pin]]
points = ["ground.O", "arm.O"]
[[slide]]
name = "rail"
points = ["arm.B", "block.p"]
axis = ["cos(r)", "sin(r)"]
angle = "half/3"
[[spring]]
name = "k"
sum = [{ factor = "r", slide = "rail" }, { factor = 0.3, x = "block.q" }]
stiffness = "60*r"
free_length = "0.1*r"
[[spring]]
points = ["ground.S", "block.q"]
stiffness = "40/r"
free_length = "0.5*r"
[[damper]]
slide = "rail"
coefficient = "1 + r"
[[torsion_damper]]
bodies = ["ground", "arm"]
coefficient = "0.3*r"
[[force]]
name = "P"
at = "block.q"
vector = ["2*cos(r)", "2*r*sin(r)"]
[start]
arm = 0.4
rail = 0.05
)-";
  if (driven) {
    text += R"-(
[[drive]]
name = "motor"
bodies = ["ground", "arm"]
start = "half"
rate = "r - 0.5"
acceleration = "r/4"
amplitude = "0.2*r"
frequency = "1 + r/10"
phase = "r^2"
)-";
  }
  return parse_scene(text, "everything.toml");
}

Experiment experiment(bool driven) {
  Experiment e;
  e.scene = scene(driven);
  Sensor travel;
  travel.name = "travel";
  travel.on = Measure::travel_of(1);
  travel.noise = 1e-4;
  Sensor place = travel;
  place.name = "place";
  place.on = Measure::x_of({2, 1});
  place.by_time = 1;
  Sensor force = travel;
  force.name = "force";
  force.element = 0;
  force.on = e.scene.elements[0].on;
  e.sensors = {travel, place, force, test::angle_of(e.scene, "arm", 1e-4)};
  e.unknowns = {test::unknown("numbers.r")};
  e.runs = {test::simulated(50, 60, {})};
  return e;
}

/// The run with the named number as its unknown.
RunModel model_of(const Experiment& e) { return {e, 0, {*SceneParameter::find(e.scene, "numbers.r")}}; }

TEST(NamedNumberUnknowns, HaveTheDerivativesOfPredictions) {
  for (const bool driven : {false, true}) {
    for (const bool start_unknown : {true, false}) {
      Experiment e = experiment(driven);
      e.runs[0].unknown_start = start_unknown;
      const RunModel run = model_of(e);
      Prediction exact;
      run.predict(run.scene_values().data(), run.released().data(), run.span(), 1e-12, true, exact);
      ASSERT_TRUE(exact.ok) << exact.why;
      const std::vector<double> difference = test::derivative(
          [&](double h) {
            std::vector<double> p = run.scene_values();
            p[0] += h;
            Prediction out;
            run.predict(p.data(), run.released().data(), run.span(), 1e-13, false, out);
            EXPECT_TRUE(out.ok) << out.why;
            return out.reading;
          },
          1e-3);
      double largest = 0.0;
      for (const double one : difference) largest = std::max(largest, std::abs(one));
      ASSERT_GT(largest, 0.1);
      for (std::size_t i = 0; i < exact.reading.size(); ++i) {
        EXPECT_NEAR(exact.jacobian[i * static_cast<std::size_t>(run.columns())], difference[i], 1e-7 * largest)
            << "reading " << i << (driven ? ", driven" : "") << (start_unknown ? ", start unknown" : "");
      }
    }
  }
}

TEST(NamedNumberUnknowns, AreRecovered) {
  Experiment e = experiment(false);
  e.runs[0].unknown_start = true;
  e.unknowns[0].start = 0.83;
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  ASSERT_TRUE(found.usable());
  EXPECT_NEAR(found.estimates[0].value, 0.8, 6 * found.errors.error[0]);
  EXPECT_LT(found.errors.error[0], 1e-3);
}

TEST(NamedNumberUnknowns, AreRefusedWhereAnExpressionHasNoValue) {
  const Experiment e = experiment(false);
  const RunModel run = model_of(e);
  Prediction out;
  std::vector<double> p = run.scene_values();
  p[0] = 0.0;
  run.predict(p.data(), run.released().data(), run.span(), 1e-10, false, out);
  EXPECT_FALSE(out.ok);
  EXPECT_EQ(out.why, "numbers.r gives some number a value that it cannot have");
}

}  // namespace
}  // namespace poise::identification_named_numbers_test

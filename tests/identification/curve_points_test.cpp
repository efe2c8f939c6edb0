// Points of the curves of slots and cams as unknowns: Jacobians of predictions against differences, and fits.

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "identification/identifiability/identifiability.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"

namespace poise::identification_curve_points_test {
namespace {

// A bead on a bent wire with a spring. It swings over a point of the wire, at which the third derivative of the curve
// jumps.
const std::string wire = R"(
title = "bead on a wire"
gravity = [4, -9.81]
[ground]
points = { O = [0, 0], S = [0.15, 0.3] }
[body.bead]
points = { P = [0, 0] }
mass = 2
[[curved_slot]]
name = "wire"
pin = "bead.P"
at = "ground.O"
curve = [[-0.1, 0.08], [-0.05, 0.02], [0.03, -0.02], [0.1, 0.03], [0.18, 0.12]]
[[damper]]
slide = "wire"
coefficient = 0.4
[[spring]]
points = ["ground.S", "bead.P"]
stiffness = 20
free_length = 0.05
[start]
wire = 0.12
)";

const std::string cam = R"(
title = "cam"
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.cam]
points = { O = [0, 0] }
mass = 1
inertia = 0.004
[body.follower]
points = { R = [0, 0] }
mass = 2
[[pin]]
name = "shaft"
points = ["ground.O", "cam.O"]
[[slide]]
name = "guide"
points = ["ground.O", "follower.R"]
axis = [0, 1]
[[cam]]
name = "eccentric"
bodies = ["ground", "cam"]
follower = { slide = "guide" }
curve = [[0, 0.1], [1.4, 0.4], [3, 1], [4.4, 0.6], [6.283185307179586, 0.1]]
lift = 0.02
base = 0.05
guided = true
[[torsion_spring]]
bodies = ["ground", "cam"]
stiffness = 1
free_angle = 1.5
[[torsion_damper]]
bodies = ["ground", "cam"]
coefficient = 0.02
[start]
cam = 1.0
guide = 0.06
)";

std::string unknowns(const std::vector<std::string>& paths) {
  std::string out;
  for (const std::string& path : paths) out += "[[unknown]]\npath = \"" + path + "\"\n";
  return out;
}

std::vector<std::string> points(const std::string& prefix, int count, bool of_slot) {
  std::vector<std::string> out;
  for (int k = 1; k <= count; ++k) {
    out.push_back(fmt::format("{}.{}", prefix, k) + (of_slot ? ".x" : ""));
    if (of_slot) out.push_back(fmt::format("{}.{}.y", prefix, k));
  }
  return out;
}

class CurvePointUnknowns : public test::WrittenExperiment {
 protected:
  CurvePointUnknowns() : WrittenExperiment(wire) {}
};

const std::string of_bead = "scene = \"scene.toml\"\n[[sensor]]\nname = \"x\"\nx = \"bead.P\"\nnoise = 1e-5\n";
const std::string of_cam = "scene = \"scene.toml\"\n[[sensor]]\nname = \"angle\"\nangle = \"cam\"\nnoise = 1e-5\n";

TEST_F(CurvePointUnknowns, HaveTheDerivativesOfPredictions) {
  for (const bool is_cam : {false, true}) {
    folder_.write("scene.toml", is_cam ? cam : wire);
    const std::vector<std::string> paths =
        is_cam ? points("cam.eccentric.curve", 4, false) : points("curved_slot.wire.curve", 5, true);
    const Experiment e = read((is_cam ? of_cam : of_bead) + unknowns(paths) + "[[run]]\nduration = 0.8\nrate = 40\n");
    const FitProblem problem(e);
    const RunModel& run = problem.run(0);
    const auto predict = [&](const std::vector<double>& at, bool jacobian) {
      Prediction out;
      run.predict(at.data(), run.released().data(), INFINITY, jacobian ? 1e-11 : 1e-13, jacobian, out);
      EXPECT_TRUE(out.ok) << out.why;
      return out;
    };
    const Prediction exact = predict(run.scene_values(), true);
    const auto columns = static_cast<std::size_t>(run.columns());
    for (std::size_t c = 0; c < paths.size(); ++c) {
      const std::vector<double> expected = test::derivative(
          [&](double by) {
            std::vector<double> moved = run.scene_values();
            moved[c] += by;
            return predict(moved, false).reading;
          },
          is_cam ? 1e-4 : 1e-5);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_NEAR(exact.jacobian[columns * i + c], expected[i], 3e-8 * (1 + std::abs(expected[i])))
            << paths[c] << " reading " << i;
      }
    }
  }
}

// The travel counts along the curve, so that one place on it is known by its x alone: two points are found.
TEST_F(CurvePointUnknowns, AreFound) {
  const Experiment e = read(of_bead + R"(
[[unknown]]
path = "curved_slot.wire.curve.3.y"
start = -0.01
[[unknown]]
path = "curved_slot.wire.curve.4.y"
start = 0.04
[[run]]
duration = 2
rate = 100
seed = 3
)");
  test::expect_found(e, 1e-3);
}

// The lift and all shares together are one factor too many, and with the base two.
TEST_F(CurvePointUnknowns, AreFreeWhereTheLiftIsToo) {
  folder_.write("scene.toml", cam);
  std::vector<std::string> paths = points("cam.eccentric.curve", 4, false);
  paths.emplace_back("cam.eccentric.lift");
  const Experiment e = read(of_cam + unknowns(paths) + "[[run]]\nduration = 2\nrate = 100\nseed = 3\n");
  const FitProblem problem(e);
  const Fit fitted = fit(problem, problem.records());
  for (const Estimate& estimate : fitted.estimates) EXPECT_TRUE(estimate.withheld) << estimate.name;
}

}  // namespace
}  // namespace poise::identification_curve_points_test

// Friction of joints in identification: derivatives of readings by its numbers and others, and what fits find.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/support/moving_scenes.hpp"

namespace poise::identification_gripping_joints_test {
namespace {

// A crank that swings below its bearing and moves a ram on guides, which are longer than they are wide.
constexpr const char* swing = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], G = [0, -0.1] }
[body.crank]
points = { O = [0, 0], B = [0.4, 0] }
mass = 1.2
center = [0.3, 0.02]
inertia = 0.03
[body.rod]
points = { B = [0, 0], C = [1.1, 0] }
mass = 0.4
center = [0.5, 0]
inertia = 0.03
[body.ram]
points = { C = [0.6, 0.05], A = [0, 0] }
mass = 0.3
inertia = 0.01
[[pin]]
name = "main"
points = ["ground.O", "crank.O"]
friction = { coefficient = 0.2, radius = 0.03, torque = 0.02 }
[[pin]]
name = "big"
points = ["crank.B", "rod.B"]
friction = { coefficient = 0.1, radius = 0.02 }
[[pin]]
name = "small"
points = ["rod.C", "ram.C"]
friction = { coefficient = 0.15, radius = 0.01, torque = 0.01 }
[[slide]]
name = "guide"
points = ["ground.G", "ram.A"]
axis = [1, 0.1]
angle = 0.02
friction = { coefficient = 0.1, length = 0.3, force = 0.1 }
[start]
crank = -1.5
rod = 0.3
guide = 1.1
)";

Experiment experiment(Scene scene, const std::string& body, const std::vector<std::string>& unknowns,
                      std::size_t readings = 500) {
  Experiment e;
  e.scene = std::move(scene);
  e.sensors = {test::angle_of(e.scene, body, 1e-4)};
  for (const std::string& path : unknowns) e.unknowns.push_back(test::unknown(path));
  e.runs = {test::simulated(200, readings)};
  return e;
}

Experiment experiment(const std::string& text, const std::string& body, const std::vector<std::string>& unknowns) {
  return experiment(parse_scene(text, "test"), body, unknowns);
}

TEST(GrippingJoints, DerivativesFollowForcesAndCrossEvents) {
  const Experiment e =
      experiment(swing, "crank",
                 {"pin.main.friction.coefficient", "pin.main.friction.radius", "pin.main.friction.torque",
                  "pin.big.friction.coefficient", "pin.small.friction.torque", "slide.guide.friction.coefficient",
                  "slide.guide.friction.length", "slide.guide.friction.force", "body.crank.mass", "body.rod.center.x",
                  "point.crank.B.x", "point.ram.C.y", "slide.guide.angle", "gravity.y"});
  test::expect_derivatives(e, {-0.9, 0.5});
}

// A crank whose pin slides in the slot of a rocker, and a block that slides on the rocker: lines that turn.
constexpr const char* rocker = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], R = [0, -0.5] }
[body.crank]
points = { O = [0, 0], B = [0.2, 0] }
mass = 1
center = [0.1, 0]
inertia = 0.02
[body.rocker]
points = { R = [0, 0], S = [0.1, 0.02], T = [0, 0.05] }
mass = 0.8
center = [0.4, 0]
inertia = 0.05
[body.block]
points = { A = [0.02, 0.01] }
mass = 0.3
center = [0.05, 0.04]
inertia = 0.003
[[pin]]
name = "main"
points = ["ground.O", "crank.O"]
friction = { coefficient = 0.2, radius = 0.02 }
[[pin]]
name = "base"
points = ["ground.R", "rocker.R"]
friction = { coefficient = 0.2, radius = 0.02 }
[[pin_in_slot]]
name = "slot"
points = ["rocker.S", "crank.B"]
axis = [1, 0.1]
friction = { coefficient = 0.15, force = 0.05 }
[[slide]]
name = "guide"
points = ["rocker.T", "block.A"]
axis = [1, 0]
angle = 0.1
friction = { coefficient = 0.1, length = 0.1 }
[[spring]]
name = "pull"
points = ["rocker.R", "block.A"]
stiffness = 60
free_length = 0.35
[start]
crank = 0.2
rocker = 1.2
slot = 0.45
guide = 0.3
)";

TEST(GrippingJoints, DerivativesFollowLinesThatTurn) {
  const Experiment e =
      experiment(rocker, "crank",
                 {"pin_in_slot.slot.friction.coefficient", "pin_in_slot.slot.friction.force",
                  "slide.guide.friction.coefficient", "slide.guide.friction.length", "slide.guide.angle",
                  "pin.base.friction.radius", "spring.pull.stiffness", "point.rocker.S.y", "body.block.center.x"});
  test::expect_derivatives(e, {0.3, 0.25, -2.0, 0.1});
}

// Teeth and rollers press on what rubs, from both flanks.
TEST(GrippingJoints, DerivativesFollowForcesOfContacts) {
  test::expect_derivatives(experiment(test::rubbing_planet(), "planet",
                                      {"pin.sun shaft.friction.coefficient", "pin.planet pin.friction.radius",
                                       "gear.inner.ratio", "gear.outer.ratio", "gear.inner.pressure_angle",
                                       "point.arm.Q.x", "body.planet.mass", "load.T", "gravity.y"},
                                      100),
                           {0.5, 2.0});
  test::expect_derivatives(experiment(test::rubbing_rack(), "beam",
                                      {"slide.guide.friction.coefficient", "slide.guide.friction.length",
                                       "pin.hub.friction.radius", "rack.teeth.radius", "rack.teeth.pressure_angle",
                                       "point.beam.C.x", "point.rack.T.y", "spring.pull.stiffness", "load.T"},
                                      100),
                           {0.3, 0.25, 0.5, -0.1});
  Experiment rollers = experiment(
      test::rubbing_rollers(), "lever",
      {"pin.shaft.friction.coefficient", "slide.guide.friction.length", "pin.pivot.friction.radius", "cam.rise.lift",
       "cam.rise.base", "cam.swing.curve.2", "point.ram.R.x", "point.lever.E.x", "spring.push.free_length"},
      50);
  rollers.sensors.push_back(test::angle_of(rollers.scene, "cam", 1e-4));
  test::expect_derivatives(rollers, {0.4, 0.2, 2.0, 1.0});
}

TEST(GrippingJoints, SwingsDetermineTheCoefficientOfABearing) {
  Experiment e = experiment(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0] }
mass = 1.5
center = [0.4, 0]
inertia = 0.04
[[pin]]
name = "bearing"
points = ["ground.O", "arm.O"]
friction = { coefficient = 0.25, radius = 0.03, torque = 0.01 }
[start]
arm = -1.5707963267948966
)",
                            "arm", {});
  for (const auto& [path, start] : {std::pair{"pin.bearing.friction.coefficient", 0.1},
                                    {"pin.bearing.friction.torque", 0.02},
                                    {"body.arm.inertia", 0.05}}) {
    e.unknowns.push_back(test::unknown(path));
    e.unknowns.back().start = start;
  }
  Release& release = e.runs[0].release.emplace_back();
  release.body = 1;
  release.value = 0.5;
  const FitProblem problem(e);
  const std::vector<Record> records = {problem.ideal_record(0)};
  FitOptions options;
  options.function_tolerance = 1e-14;
  const Fit found = fit(problem, records, options);
  ASSERT_EQ(found.parameters.size(), 3U) << found.why;
  const std::vector<double> truth = problem.truths();
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_NEAR(found.parameters[i], truth[i], 1e-4 * truth[i]) << i;
}

}  // namespace
}  // namespace poise::identification_gripping_joints_test

// Cams in identification: derivatives of readings across the borders of their laws.

#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/identification/experiments.hpp"

namespace poise::cams_test {
namespace {

// A flywheel with a cam that moves a weight on a spring, and runs over the parts of its law both ways.
std::string flywheel(const std::string& law) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0], S = [0, 0.6] }}
[body.wheel]
points = {{ O = [0, 0] }}
mass = 2
center = [0.05, 0]
inertia = 0.1
[body.weight]
points = {{ A = [0, 0] }}
mass = 3
[[pin]]
name = "shaft"
points = ["ground.O", "wheel.O"]
[[slide]]
name = "guide"
points = ["ground.O", "weight.A"]
axis = [0, 1]
[[cam]]
name = "lobe"
bodies = ["ground", "wheel"]
follower = {{ slide = "guide" }}
law = [{{ to = 1, lift = 0, law = "dwell" }}, {{ to = 2.6, lift = 1, law = "{0}" }}, {{ to = 5, lift = 0, law = "{0}" }},
       {{ to = 6.283185307179586, law = "dwell" }}]
lift = 0.1
base = 0.2
phase = 0.3
guided = true
[[spring]]
name = "return"
points = ["ground.S", "weight.A"]
stiffness = 150
free_length = 0.3
[[damper]]
bodies = ["ground", "wheel"]
coefficient = 0.02
[start]
wheel = 0.5
guide = 0.2
)",
                     law);
}

void expect_derivatives_of(const std::string& law) {
  Experiment e;
  e.scene = parse_scene(flywheel(law), "test");
  e.sensors = {test::angle_of(e.scene, "wheel", 1e-4)};
  for (const char* path : {"cam.lobe.phase", "cam.lobe.lift", "cam.lobe.base", "spring.return.stiffness",
                           "body.weight.mass", "body.wheel.inertia", "body.wheel.center.x", "gravity.y"}) {
    e.unknowns.push_back(test::unknown(path));
  }
  e.runs = {test::simulated(100, 200)};
  test::expect_derivatives(e, {0.5, 4.0});
}

TEST(Cams, DerivativesCrossBordersOfContinuousAccelerations) {
  expect_derivatives_of("polynomial_345");
  expect_derivatives_of("cycloidal");
}

// Rates at a border jump by what accelerations jump by and the time of the border changes by.
TEST(Cams, DerivativesCrossBordersAtWhichAccelerationsJump) { expect_derivatives_of("harmonic"); }

// A heavy crank that drives the wheel of a Geneva drive against a spring, through slots and dwells.
TEST(Cams, DerivativesCrossTheEndsOfSlots) {
  Experiment e;
  e.scene = parse_scene(R"(
gravity = [0, -9.81]
[ground]
points = { A = [0, 0], B = [0.1, 0] }
[body.crank]
points = { A = [0, 0] }
mass = 2
center = [0.03, 0]
inertia = 0.02
[body.wheel]
points = { B = [0, 0] }
inertia = 0.004
[[pin]]
name = "A"
points = ["ground.A", "crank.A"]
[[pin]]
name = "B"
points = ["ground.B", "wheel.B"]
[[geneva]]
name = "indexer"
bodies = ["crank", "wheel"]
slots = 5
phase = 0.3
offset = 0.1
[[torsion_spring]]
name = "brake"
bodies = ["ground", "wheel"]
stiffness = 0.02
free_angle = 0.4
[[damper]]
bodies = ["ground", "crank"]
coefficient = 0.01
[start]
crank = 0.5
)",
                        "test");
  e.sensors = {test::angle_of(e.scene, "crank", 1e-4), test::angle_of(e.scene, "wheel", 1e-4)};
  for (const char* path : {"geneva.indexer.phase", "geneva.indexer.offset", "torsion_spring.brake.stiffness",
                           "torsion_spring.brake.free_angle", "body.wheel.inertia", "body.crank.center.x"}) {
    e.unknowns.push_back(test::unknown(path));
  }
  e.runs = {test::simulated(100, 200)};
  test::expect_derivatives(e, {0.5, 9.0});
}

}  // namespace
}  // namespace poise::cams_test

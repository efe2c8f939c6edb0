#include "motion/stick_slip.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/joint_friction.hpp"
#include "motion/confirmed_motion.hpp"
#include "motion/simulate.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/motions.hpp"

namespace poise::stick_slip_test {
namespace {

constexpr double inertia = 0.01, stiffness = 1.0;

// A wheel on a torsion spring, with friction of these torques between it and the ground.
Scene wheel(const std::vector<double>& torques) {
  Scene scene;
  scene.gravity = {0, 0};
  scene.add_point(0, "O", {0, 0});
  test::add_link(scene, "wheel", 1.0);
  scene.bodies[1].inertia = inertia;
  test::add_pin(scene, "ground.O", "wheel.a");
  scene.elements.push_back(test::torsion_spring("spring", 0, 1, stiffness, 0.0));
  for (const double torque : torques) scene.elements.push_back(test::friction("rub", 0, 1, torque, 0.0));
  return scene;
}

// From x0 at rest half swings of time pi / omega about -+ T / k, each 2 T / k less far, until |x| <= T / k.
double place_of_wheel(double x0, double torque, double t) {
  const double omega = std::sqrt(stiffness / inertia), offset = torque / stiffness;
  double x = x0;
  for (; std::abs(x) > offset; x = x > 0 ? 2 * offset - x : -2 * offset - x) {
    const double middle = x > 0 ? offset : -offset;
    if (omega * t < std::numbers::pi) return middle + (x - middle) * std::cos(omega * t);
    t -= std::numbers::pi / omega;
  }
  return x;
}

void expect_wheel(const std::vector<double>& torques, double total) {
  const MotionModel model(wheel(torques));
  const Motion motion = test::moved(model, test::released(model, {{{"wheel", 1.05}}, {}}), 3.0);
  std::vector<double> t;
  for (int k = 0; k <= 300; ++k) t.push_back(0.01 * k);
  const std::vector<test::Reading> read = test::read_at(motion, t);
  for (std::size_t i = 0; i < t.size(); ++i) {
    ASSERT_NEAR(read[i].q[0], place_of_wheel(1.05, total, t[i]), 1e-12) << "at " << t[i];
  }
  EXPECT_EQ(read.back().v[0], 0.0) << "it stays";
  EXPECT_LT(motion.energy_error, 1e-12);
}

TEST(StickSlip, StopsAWheelAfterTheHalfSwingsOfItsClosedForm) { expect_wheel({0.1}, 0.1); }

// Whichever of them is thought of as sliding where both are held.
TEST(StickSlip, ForcesInOneJointAddUp) {
  expect_wheel({0.04, 0.06}, 0.1);
  expect_wheel({0.09, 0.01}, 0.1);
  expect_wheel({0.05, 0.05}, 0.1);
}

TEST(StickSlip, HoldsWhatStartsWithinItsForce) {
  const MotionModel model(wheel({0.1}));
  const Motion motion = test::moved(model, test::released(model, {{{"wheel", -0.099}}, {}}), 2.0);
  EXPECT_EQ(test::q_at(motion, motion.trajectory.nodes() - 1)[0], test::q_at(motion, 0)[0]);
}

// A wheel in a driven ring, on a spring to the ground: the ring carries it along until the spring overcomes the
// friction, at the angle T / k; then it slips.
TEST(StickSlip, SlipsWhereTheHoldingForcePassesItsLimit) {
  constexpr double speed = 0.2, torque = 0.04;
  Scene scene = wheel({});
  test::add_link(scene, "ring", 1.0);
  test::add_pin(scene, "ground.O", "ring.a");
  scene.elements.push_back(test::friction("rub", 2, 1, torque, 0.0));
  Drive drive;
  drive.name = "motor";
  drive.on = Measure::angle_between(0, 2);
  drive.rate = speed;
  scene.drives.push_back(drive);
  const MotionModel model(scene);
  const double slip = torque / stiffness / speed;
  const Motion motion = test::moved(model, test::released(model, {{{"wheel", 0.0}}, {{"wheel", speed}}}), 2.0 * slip);
  const auto wheel = static_cast<std::size_t>(test::coordinate_of(model, "wheel"));
  for (const test::Reading& read : test::read_at(motion, {0.3 * slip, 0.7 * slip, 0.99 * slip})) {
    EXPECT_NEAR(read.v[wheel], speed, 1e-13);
  }
  // I x'' = T - k x from x = T / k with the ring's speed.
  const double omega = std::sqrt(stiffness / inertia), later = 0.5 / omega;
  const test::Reading read = test::read_at(motion, {slip + later}).front();
  EXPECT_NEAR(read.q[wheel], torque / stiffness + speed / omega * std::sin(omega * later), 1e-12);
}

/// A block of 1 kg with friction of 0.3 N, pushed by 4 sin(w t) N from rest: it breaks loose where that passes 0.3 N,
/// slides until  4/w (cos w t0 - cos w t) - 0.3 (t - t0) = 0  and back from then on, as the push is far above 0.3 N;
/// and so at each turn within 2 s.
constexpr double push = 4.0, rubbing = 0.3, omega = 1.2 * std::numbers::pi;

double rate_of_block(double from, int sign, double t) {
  return push / omega * (std::cos(omega * from) - std::cos(omega * t)) - sign * rubbing * (t - from);
}
double way_of_block(double from, int sign, double t) {
  const double s = t - from;
  return push / omega * (std::cos(omega * from) * s - (std::sin(omega * t) - std::sin(omega * from)) / omega) -
         sign * rubbing * s * s / 2;
}
double place_of_block(double t) {
  constexpr double part = 1e-3;  // each sense lasts longer
  double from = std::asin(rubbing / push) / omega, place = 0.0;
  if (t < from) return 0.0;
  for (int sign = 1;; sign = -sign) {
    const auto goes_on = [&](double then) { return sign * rate_of_block(from, sign, then) > 0; };
    double below = from, above = from + part;
    for (; goes_on(above); below = above, above += part) {
      if (above > t) return place + way_of_block(from, sign, t);
    }
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (below + above);
      (goes_on(middle) ? below : above) = middle;
    }
    const double turn = below;
    if (turn > t) return place + way_of_block(from, sign, t);
    place += way_of_block(from, sign, turn);
    from = turn;
  }
}

TEST(StickSlip, BreaksLooseUnderALoadThatGrows) {
  const MotionModel model(resisted_by_joints(parse_scene(R"(
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
                                                         "block.toml")));
  EXPECT_NEAR(place_of_block(2.0), 1.35563, 5e-6);
  for (const double accuracy : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
    MotionOptions options;
    options.duration = 2.0;
    options.accuracy = accuracy;
    const ConfirmedMotion found = simulate_and_confirm(model, test::released(model, {}), options);
    ASSERT_TRUE(found.confirmed()) << accuracy << found.motion.why << found.why_unknown;
    EXPECT_LT(*found.error, 10 * accuracy);
    std::vector<double> t;
    for (int k = 0; k <= 100; ++k) t.push_back(0.02 * k);
    const std::vector<test::Reading> read = test::read_at(found.motion, t);
    for (std::size_t i = 0; i < t.size(); ++i) {
      ASSERT_NEAR(read[i].q[0], place_of_block(t[i]), 2 * *found.error + 1e-12) << accuracy << " at " << t[i];
    }
  }
}

// A wheel between the ground and a driven wheel, on which both rub, while the drive dwells and then begins: it stays
// with the one that grips more, and the work of the drive is that against the friction of the other.
TEST(StickSlip, DecidesAnewWhereADriveBegins) {
  for (const bool by_ground : {false, true}) {
    const MotionModel model(resisted_by_joints(parse_scene(fmt::format(R"(
[ground]
points = {{ O = [0, 0] }}
[body.driven]
points = {{ O = [0, 0] }}
inertia = 1
[body.wheel]
points = {{ O = [0, 0] }}
inertia = 0.3
[[pin]]
points = ["ground.O", "driven.O"]
[[pin]]
points = ["ground.O", "wheel.O"]
friction = {{ torque = {} }}
[[drive]]
bodies = ["ground", "driven"]
time = {{ ramp = {{ to = -1.3, start = 0.5, end = 1.5 }} }}
[[friction]]
bodies = ["driven", "wheel"]
torque = 0.25
width = 0
)",
                                                                       by_ground ? 1.0 : 0.1),
                                                           "wheels.toml")));
    MotionOptions options;
    options.duration = 2.0;
    const ConfirmedMotion found = simulate_and_confirm(model, test::released(model, {}), options);
    ASSERT_TRUE(found.confirmed()) << found.motion.why << found.why_unknown;
    if (!by_ground) continue;
    const auto wheel = static_cast<std::size_t>(test::coordinate_of(model, "wheel"));
    EXPECT_EQ(test::q_at(found.motion, found.motion.trajectory.nodes() - 1)[wheel], 0.0);
    EXPECT_NEAR(found.motion.work.back(), 0.0, 1e-12);  // what the drive does is lost in the friction
    double least = 0.0;
    for (const double effort : found.motion.drive_force[0]) least = std::min(least, effort);
    EXPECT_LT(least, -0.25);
  }
}

// A ramp of the fifth degree begins with neither rate nor acceleration, from which nothing of it can be foreseen: where
// nothing else moves, steps at its beginning failed.
TEST(StickSlip, FollowsADriveThatBeginsSmoothlyWhereAllElseIsHeld) {
  constexpr double to = -0.58, begin = 0.347, end = 1.49;
  for (const bool with_wheel : {false, true}) {
    const MotionModel model(resisted_by_joints(parse_scene(fmt::format(R"(
[ground]
points = {{ O = [0, 0] }}
[body.driven]
points = {{ O = [0, 0] }}
inertia = 1
[[pin]]
points = ["ground.O", "driven.O"]
[[drive]]
bodies = ["ground", "driven"]
time = {{ ramp = {{ to = {}, start = {}, end = {}, law = "polynomial_345" }} }}
{})",
                                                                       to, begin, end,
                                                                       with_wheel ? R"([body.wheel]
points = { O = [0, 0] }
inertia = 0.3
[[pin]]
points = ["ground.O", "wheel.O"]
friction = { torque = 1 }
[[friction]]
bodies = ["driven", "wheel"]
torque = 0.25
width = 0
)"
                                                                                  : ""),
                                                           "wheels.toml")));
    for (const double accuracy : {1e-7, 1e-10, 1e-12, 1e-13}) {
      MotionOptions options;
      options.duration = 2.2;
      options.accuracy = accuracy;
      const ConfirmedMotion found = simulate_and_confirm(model, test::released(model, {}), options);
      ASSERT_TRUE(found.confirmed()) << accuracy << found.motion.why << found.why_unknown;
      EXPECT_LT(found.motion.steps, 60) << accuracy;
      const std::vector<test::Reading> read = test::read_at(found.motion, {0.3, 0.4, 0.9, 1.4, 2.0});
      const auto driven = static_cast<std::size_t>(test::coordinate_of(model, "driven"));
      const double times[] = {0.3, 0.4, 0.9, 1.4, 2.0};
      for (std::size_t k = 0; k < read.size(); ++k) {
        const double s = std::clamp((times[k] - begin) / (end - begin), 0.0, 1.0);
        EXPECT_NEAR(read[k].q[driven], to * s * s * s * (10 + s * (6 * s - 15)), accuracy + 1e-14);
      }
    }
  }
}

// What is held is looked at within steps too, however far they lead.
TEST(StickSlip, HoldsWhatTurnsByMoreThanARadianInAStep) {
  const MotionModel model(resisted_by_joints(parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.a]
points = { O = [0, 0] }
inertia = 0.5
[body.b]
points = { O = [0, 0] }
inertia = 0.7
[[pin]]
points = ["ground.O", "a.O"]
friction = { torque = 0.55 }
[[torque]]
on = "a"
value = 1.75
[[pin]]
points = ["ground.O", "b.O"]
[[friction]]
bodies = ["a", "b"]
torque = 0.9
width = 0
)",
                                                         "wheels.toml")));
  MotionOptions options;
  options.duration = 4.0;
  const ConfirmedMotion found = simulate_and_confirm(model, test::released(model, {}), options);
  ASSERT_TRUE(found.confirmed()) << found.motion.why << found.why_unknown;
  const test::Reading end = test::read_at(found.motion, {4.0}).front();
  for (const double angle : end.q) EXPECT_NEAR(angle, 8.0, 1e-9);  // both with 1 rad/s^2
}

Scene two_arms(double width) {
  Scene scene = read_scene(test::dataset("double_pendulum.toml"));
  for (Element& element : scene.elements) {
    if (auto* dry = std::get_if<DryFriction>(&element.law)) *dry = {3e-3, width};
  }
  return scene;
}

Motion swing(const Scene& scene) {
  const MotionModel model(scene);
  return test::moved(model, test::released(model, {{{"arm1", -0.55}, {"arm2", 0.4}}, {}}), 2.0);
}

TEST(StickSlip, IsTheLimitOfNarrowWidths) {
  const Motion sharp = swing(two_arms(0.0));
  EXPECT_LT(sharp.energy_error, 1e-11);
  const double wide = difference(swing(two_arms(1e-2)), sharp);
  const double narrow = difference(swing(two_arms(1e-3)), sharp);
  EXPECT_LT(wide, 1e-4);
  EXPECT_LT(narrow, 0.2 * wide);
}

}  // namespace
}  // namespace poise::stick_slip_test

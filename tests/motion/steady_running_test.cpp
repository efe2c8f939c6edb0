// Machines with motors: laws of motors, run-up, and steady running by shooting.

#include "motion/steady_running.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/joint_friction.hpp"
#include "model/read_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/motions.hpp"

namespace poise::steady_running_test {
namespace {

constexpr double pi = std::numbers::pi;

/// A wheel on a motor and a load of constant torque.
std::string wheel(const std::string& motor, double load = 0.0) {
  return fmt::format(R"(
[ground]
points = {{ O = [0, 0] }}
[body.rotor]
points = {{ O = [0, 0] }}
inertia = 0.05
[[pin]]
name = "O"
points = ["ground.O", "rotor.O"]
[[motor]]
name = "M"
bodies = ["ground", "rotor"]
{}
[[torque]]
on = "rotor"
value = {}
)",
                     motor, -load);
}

const char* const kloss = "breakdown_torque = 40\nbreakdown_slip = 0.2\nsynchronous_rate = 157.07963267948966";

/// The time at which the rotor first has a rate.
double time_to(const Motion& motion, double rate) {
  TrajectoryReader reader(motion.trajectory, {0});
  double low = 0.0, high = motion.trajectory.t.back();
  for (int k = 0; k < 200; ++k) {
    const double middle = (low + high) / 2;
    reader.at(middle);
    (reader.v(0) < rate ? low : high) = middle;
  }
  return low;
}

// t = J ws/(2 Mk) ((1 - s^2)/(2 sk) + sk ln(1/s)) from rest (../shared/benchmarks.md 4.4, after M. Kloss 1917).
TEST(Motors, AnInductionMotorRunsUpAsKlossSays) {
  constexpr double ws = 50 * pi, J = 0.05, Mk = 40, sk = 0.2;
  const MotionModel model(parse_scene(wheel(kloss), "scene.toml"));
  const Motion motion = test::moved(model, test::released(model, {}), 0.6);
  for (const double s : {0.2, 0.05, 0.01}) {
    const double t = J * ws / (2 * Mk) * ((1 - s * s) / (2 * sk) + sk * std::log(1 / s));
    EXPECT_NEAR(time_to(motion, (1 - s) * ws), t, 1e-9) << s;
  }
  EXPECT_NEAR(J * ws / (2 * Mk) * ((1 - 0.04) / 0.4 + 0.2 * std::log(5.0)), 0.267220688532, 1e-12);
}

TEST(Motors, UnderAConstantLoadTheSlipIsThatOfTheFormula) {
  const MotionModel model(parse_scene(wheel(kloss, 10.0), "scene.toml"));
  const SteadyRunning found = steady_running(model, test::released(model, {}), {});
  ASSERT_TRUE(found.found) << found.why;
  constexpr double ws = 50 * pi, slip = 0.0254033307585;
  EXPECT_NEAR(found.mean, (1 - slip) * ws, 1e-9 * ws);
  EXPECT_NEAR(found.fluctuation(), 0.0, 1e-9);
  EXPECT_TRUE(found.stable);
  // A disturbance of the rate decays as exp(M'(w) t/J).
  const double k = 0.2, squares = slip * slip + k * k;
  const double slope = -40.0 * 2 * k * (k * k - slip * slip) / (squares * squares) / ws;
  EXPECT_NEAR(found.multipliers[0].real(), std::exp(slope * found.period / 0.05), 1e-6);
  // Its mate at a slip of 1.5746 is unstable: it turns backwards there.
  RunningOptions back;
  back.guess = (1 - 1.57459667) * ws;
  const SteadyRunning mate = steady_running(model, test::released(model, {}), back);
  EXPECT_TRUE(!mate.found || !mate.stable);
}

// A DC motor on a slider crank: ../shared/benchmarks.md 4.3.
TEST(Motors, ADcMotorTurnsASliderCrank) {
  const MotionModel model(read_scene(test::dataset("machines/motor_slider_crank.toml")));
  RunningOptions options;
  options.coordinate = test::coordinate_of(model, "crank");
  const MotionState rest = test::released(model, {});
  const SteadyRunning found = steady_running(model, rest, options);
  ASSERT_TRUE(found.found) << found.why;
  EXPECT_TRUE(found.stable);
  EXPECT_NEAR(found.period, 0.12290078165, 5e-11);
  EXPECT_NEAR(found.slowest.speed, 41.9999515, 2e-7);
  EXPECT_NEAR(found.fastest.speed, 63.9869923, 2e-7);
  EXPECT_NEAR(found.motion.trajectory.v[static_cast<std::size_t>(options.coordinate)], 60.6162067299, 5e-8);
  EXPECT_LT(found.residual, 1e-10);
  EXPECT_EQ(found.multipliers.size(), 1U);
  // The first turn from rest.
  const Motion start = test::moved(model, rest, 0.169336327560);
  EXPECT_NEAR(test::q_at(start, start.trajectory.nodes() - 1)[static_cast<std::size_t>(options.coordinate)], 2 * pi,
              1e-8);
}

TEST(Motors, WithoutALoadTheSpeedIsThatWithoutLoad) {
  const MotionModel model(parse_scene(wheel("stall_torque = 3\nno_load_rate = 20"), "scene.toml"));
  const SteadyRunning found = steady_running(model, test::released(model, {}), {});
  ASSERT_TRUE(found.found) << found.why;
  EXPECT_NEAR(found.mean, 20.0, 1e-9);
}

// A DC motor with friction in its bearing runs at M0/(M0/w0 + c), and a disturbance decays by exp(-(M0/w0 + c) T/J),
// from wherever it starts.
TEST(Motors, ItIsFoundFromAnySpeed) {
  constexpr double stall = 10.0, no_load = 100.0, c = 0.05, inertia = 0.05;
  const MotionModel model(parse_scene(wheel("stall_torque = 10\nno_load_rate = 100") +
                                          "[[torsion_damper]]\nbodies = [\"ground\", \"rotor\"]\ncoefficient = 0.05\n",
                                      "scene.toml"));
  const double slope = stall / no_load + c, speed = stall / slope;
  for (const double guess : {0.0, 30.0, 200.0, 3e4, 1e9}) {
    RunningOptions options;
    options.guess = guess;
    const SteadyRunning found = steady_running(model, test::released(model, {}), options);
    ASSERT_TRUE(found.found) << guess << ": " << found.why;
    EXPECT_NEAR(found.mean, speed, 1e-9 * speed) << guess;
    EXPECT_NEAR(found.multipliers[0].real(), std::exp(-slope * found.period / inertia), 1e-6) << guess;
  }
}

// Between the speeds at which an induction motor holds a load the lower one is unstable: from beyond it the motor runs
// up to the higher one, as its motion does.
TEST(Motors, ARunningIsThatToWhichTheMotionComes) {
  constexpr double load = 5.0, Mk = 10.0, sk = 0.2, ws = 100.0;
  const MotionModel model(
      parse_scene(wheel("breakdown_torque = 10\nbreakdown_slip = 0.2\nsynchronous_rate = 100", load), "scene.toml"));
  // Kloss: load (s^2 + sk^2) = 2 Mk sk s.
  const double root = std::sqrt(Mk * Mk - load * load), fast = (1 - sk * (Mk - root) / load) * ws,
               slow = (1 - sk * (Mk + root) / load) * ws;
  ASSERT_GT(slow, 20.0);
  for (const double guess : {slow + 2.0, slow + 10.0, 60.0, 99.0, 300.0}) {
    RunningOptions options;
    options.guess = guess;
    const SteadyRunning found = steady_running(model, test::released(model, {}), options);
    ASSERT_TRUE(found.found) << guess << ": " << found.why;
    EXPECT_TRUE(found.stable) << guess;
    EXPECT_NEAR(found.mean, fast, 1e-9 * ws) << guess;
  }
}

// What a turn does not bring back is no running: a spring that winds up, a limit that comes nearer.
TEST(Motors, WhatWindsUpDoesNotRunSteadily) {
  const auto why = [](const std::string& tables) {
    const MotionModel model(parse_scene(wheel("stall_torque = 10\nno_load_rate = 100", 1.0) + tables, "scene.toml"));
    const SteadyRunning found = steady_running(model, test::released(model, {}), {});
    EXPECT_FALSE(found.found);
    return found.why;
  };
  const std::string spring =
      why("[[torsion_spring]]\nname = \"S\"\nbodies = [\"ground\", \"rotor\"]\n"
          "stiffness = 1e-3\n");
  EXPECT_NE(spring.find("torsion spring \"S\" winds up"), std::string::npos) << spring;
  const std::string stop = why("[[stop]]\nname = \"end\"\nbodies = [\"ground\", \"rotor\"]\nmax = 1e4\n");
  EXPECT_NE(stop.find("limit of stop \"end\""), std::string::npos) << stop;
}

/// A crank that turns an eccentric wheel under gravity by a gear.
std::string eccentric(double ratio) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ A = [0, 0], B = [0.4, 0] }}
[body.crank]
points = {{ A = [0, 0] }}
inertia = 0.05
[body.wheel]
points = {{ B = [0, 0], P = [0.1, 0] }}
mass = 2
center = [0.1, 0]
inertia = 0.01
[[pin]]
points = ["ground.A", "crank.A"]
[[pin]]
points = ["ground.B", "wheel.B"]
[[motor]]
bodies = ["ground", "crank"]
stall_torque = 6
no_load_rate = 30
[[torsion_damper]]
bodies = ["ground", "crank"]
coefficient = 0.05
[[gear]]
bodies = ["crank", "wheel"]
ratio = {}
)",
                     ratio);
}

// The wheel is back after two turns of the crank. By the rate as a function of the angle, w dw = M/J dphi, by Runge and
// Kutta's method until it repeats itself.
TEST(Motors, APeriodIsThatOfAllBodies) {
  const MotionModel model(parse_scene(eccentric(0.5), "scene.toml"));
  RunningOptions options;
  options.coordinate = test::coordinate_of(model, "crank");
  const SteadyRunning found = steady_running(model, test::released(model, {}), options);
  ASSERT_TRUE(found.found) << found.why;
  EXPECT_EQ(found.turns, 2);
  const double inertia = 0.05 + 0.25 * (0.01 + 2 * 0.01);
  // The wheel turns the other way, by half the angle.
  const auto slope = [&](double phi, double energy) {
    const double w = std::sqrt(2 * energy);
    return (6 * (1 - w / 30) - 0.05 * w + 0.5 * 2 * 9.81 * 0.1 * std::cos(-0.5 * phi)) / inertia;
  };
  constexpr int steps = 20000;
  constexpr double h = 4 * pi / steps;
  double energy = 300.0, slowest = 1e9, fastest = 0.0;
  for (int turn = 0; turn < 60; ++turn) {
    slowest = 1e9;
    fastest = 0.0;
    for (int k = 0; k < steps; ++k) {
      const double phi = k * h, k1 = slope(phi, energy), k2 = slope(phi + h / 2, energy + h / 2 * k1);
      const double k3 = slope(phi + h / 2, energy + h / 2 * k2), k4 = slope(phi + h, energy + h * k3);
      energy += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      slowest = std::min(slowest, std::sqrt(2 * energy));
      fastest = std::max(fastest, std::sqrt(2 * energy));
    }
  }
  EXPECT_NEAR(found.slowest.speed, slowest, 1e-5);
  EXPECT_NEAR(found.fastest.speed, fastest, 1e-5);
  // A spring on the wheel's eccentric point is back then, too.
  const MotionModel sprung(parse_scene(eccentric(0.2) + "[[spring]]\nname = \"S\"\npoints = [\"ground.A\", "
                                                        "\"wheel.P\"]\nstiffness = 40\nfree_length = 0.2\n",
                                       "scene.toml"));
  const SteadyRunning fifth = steady_running(sprung, test::released(sprung, {}), options);
  ASSERT_TRUE(fifth.found) << fifth.why;
  EXPECT_EQ(fifth.turns, 5);
  // Where a ratio takes many turns, it says so.
  const MotionModel uneven(parse_scene(eccentric(0.04), "scene.toml"));
  const SteadyRunning many = steady_running(uneven, test::released(uneven, {}), options);
  EXPECT_FALSE(many.found);
  EXPECT_NE(many.why.find("--turns 25"), std::string::npos) << many.why;
}

TEST(Motors, WhatDoesNotRunSteadilySaysWhy) {
  const auto why = [](const std::string& motor, double load) {
    const MotionModel model(parse_scene(wheel(motor, load), "scene.toml"));
    RunningOptions options;
    options.most_turns = 30;
    const SteadyRunning found = steady_running(model, test::released(model, {}), options);
    EXPECT_FALSE(found.found);
    return found.why;
  };
  // No effort: it stands.
  EXPECT_NE(why("stall_torque = 0\nno_load_rate = 20", 0.0).find("it makes no whole turn"), std::string::npos);
  // A load that drives it faster and faster, for which the motor has no effort.
  EXPECT_NE(why("stall_torque = 0\nno_load_rate = 20", -1.0).find("its speed still changes"), std::string::npos);
}

TEST(Motors, DrivesAreRefused) {
  const MotionModel model(parse_scene(
      wheel(kloss) + "[[drive]]\nname = \"d\"\nbodies = [\"ground\", \"rotor\"]\nrate = 1\n", "scene.toml"));
  EXPECT_THROW(steady_running(model, test::released(model, {}), {}), InputError);
}

}  // namespace
}  // namespace poise::steady_running_test

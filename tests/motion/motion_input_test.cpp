// Motions under loads and drives that follow curves of time.

#include "motion/motion_input.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "motion/simulate.hpp"
#include "solvers/quintic_spline.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/moving_scenes.hpp"

namespace poise::motion_input_test {
namespace {

using Numbers = std::vector<double>;
using Of = MotionInput::Of;

MotionInput lines(Of of, int item, Numbers time, const Numbers& value) {
  return {of, item, std::make_shared<TimeCurve>(TimeCurve::through(std::move(time), value))};
}

MotionInput constant(Of of, int item, double value) { return lines(of, item, {0, 100}, {value, value}); }

Motion driven(const MotionModel& model, const MotionState& start, double duration, std::vector<MotionInput> inputs,
              double accuracy = 1e-10, bool sensitivities = false) {
  MotionOptions options;
  options.duration = duration;
  options.accuracy = accuracy;
  options.inputs = std::move(inputs);
  options.sensitivities = sensitivities;
  Motion motion = simulate(model, start, options);
  EXPECT_TRUE(motion.completed()) << motion.why;
  return motion;
}

TEST(TimeCurve, IsThePolynomialOfItsInterval) {
  const TimeCurve line = TimeCurve::through({1, 2, 4}, {5, 7, 3});
  EXPECT_EQ(line.at(1), 5);
  EXPECT_EQ(line.at(1.5), 6);
  EXPECT_EQ(line.at(2), 7);
  EXPECT_EQ(line.at(3), 5);
  EXPECT_EQ(line.at(4), 3);
  EXPECT_EQ(line.at(4.5), 2) << "on with the last";
  EXPECT_EQ(line.at(3, 1), -2);
  EXPECT_EQ(line.at(3, 2), 0);
  const TimeCurve cubic({0, 1, 3}, {1, 0, 0, 2, 3, 6, 6, -1});
  EXPECT_DOUBLE_EQ(cubic.at(0.5), 1.25);
  EXPECT_DOUBLE_EQ(cubic.at(2, 0), 14);
  EXPECT_DOUBLE_EQ(cubic.at(2, 1), 15);
  EXPECT_DOUBLE_EQ(cubic.at(2, 2), 6);
}

// m x'' + k x = F(t) with F along straight lines: F(t) / k and an oscillation in each interval, with x and x'
// continuous.
TEST(MotionInput, PushesAnOscillatorByItsClosedForm) {
  constexpr double m = 2.0, k = 50.0;
  const double omega = std::sqrt(k / m);
  Scene scene;
  scene.add_point(0, "O", {0, 0});
  const int body = scene.add_body("mass");
  scene.add_point(body, "c", {0, 0});
  scene.bodies[body].mass = m;
  const int x = test::add_slide(scene, "ground.O", "mass.c", {1, 0}, "x");
  scene.elements.push_back(test::make_element("spring", "", Measure::travel_of(x), LinearSpring{k, 0.0}));
  test::add_force(scene, "mass.c", {-3, 0}, "push");
  const MotionModel model(scene);
  // Corners of every kind: reversals, a jump within 1 ms, a long pause, uneven spacing.
  const Numbers time{0, 0.13, 0.2, 0.201, 0.7, 1.9, 2.0, 2.05, 3.0};
  const Numbers push{0, 12, -7, 9, 9, 9, -20, 4, 0};
  for (const double accuracy : {1e-6, 1e-8, 1e-10}) {
    const Motion motion = driven(model, test::released(model, {}), 3.0, {lines(Of::force, 0, time, push)}, accuracy);
    EXPECT_LT(motion.energy_error, accuracy);
    Numbers t;
    for (int i = 0; i <= 3000; ++i) t.push_back(1e-3 * i);
    const std::vector<test::Reading> read = test::read_at(motion, t);
    double worst = 0.0, largest = 0.0;
    double from = 0.0, rate = 0.0;  // x and x' where the interval begins
    std::size_t piece = 0;
    const auto place = [&](double at, double& v) {
      const double slope = -(push[piece + 1] - push[piece]) / (time[piece + 1] - time[piece]) / k;
      const double start = -push[piece] / k;  // the force is along -x
      const double a = from - start, b = (rate - slope) / omega, s = at - time[piece];
      v = slope + omega * (b * std::cos(omega * s) - a * std::sin(omega * s));
      return start + slope * s + a * std::cos(omega * s) + b * std::sin(omega * s);
    };
    for (std::size_t i = 0; i < t.size(); ++i) {
      while (piece + 2 < time.size() && t[i] > time[piece + 1]) {
        double v = 0.0;
        from = place(time[piece + 1], v);
        rate = v;
        ++piece;
      }
      double v = 0.0;
      worst = std::max(worst, std::abs(read[i].q[0] - place(t[i], v)));
      largest = std::max(largest, std::abs(read[i].q[0]));
    }
    EXPECT_LT(worst, 2 * accuracy * largest) << accuracy;
  }
}

/// What the scene does under constant loads, it does under inputs of these magnitudes.
TEST(MotionInput, IsTheSceneOwnLoadWhereItIsConstant) {
  const Scene written = test::four_bar_with_follower();
  ASSERT_EQ(written.forces.size(), 2U);
  Scene other = written;
  for (Force& force : other.forces) force.vector = -1.7 * force.vector;
  other.torques[0].value += 0.8;
  const MotionModel model(written);
  const MotionModel expected(other, model.scales());
  const MotionState start = test::released(model, {{}, {{"crank", 2.0}}});
  const std::vector<MotionInput> inputs = {constant(Of::force, 0, -1.7 * norm(written.forces[0].vector)),
                                           constant(Of::force, 1, -1.7 * norm(written.forces[1].vector)),
                                           constant(Of::torque, 0, written.torques[0].value + 0.8)};
  const Motion a = driven(model, start, 1.0, inputs, 1e-11, true);
  const Motion b = driven(expected, start, 1.0, {}, 1e-11, true);
  EXPECT_LT(a.energy_error, 1e-10);
  EXPECT_LT(difference(a, b), 1e-9);
  ASSERT_EQ(a.trajectory.columns, 2);
  const auto end = [](const Motion& motion, std::size_t i) {
    return motion.trajectory.q_p[motion.trajectory.q_p.size() - 1 - i];
  };
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(end(a, i), end(b, i), 1e-8 * (1 + std::abs(end(b, i))));
}

/// Inputs that multiply the scene's loads are inputs of the products, for geometry, forces that follow and scaled
/// units.
TEST(MotionInput, MultipliesTheLoadOfTheScene) {
  const Scene scene = test::four_bar_with_follower();
  const MotionModel model(scene);
  const MotionState start = test::released(model, {{}, {{"crank", 2.0}}});
  const Numbers time = {0, 0.3, 0.5, 100}, times = {1, -2, 0, 1.5};
  const std::vector<double> loads = {norm(scene.forces[0].vector), norm(scene.forces[1].vector),
                                     scene.torques[0].value};
  std::vector<MotionInput> multiplying, own;
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_NE(loads[i], 0);
    const Of of = i < 2 ? Of::force : Of::torque;
    const int item = i < 2 ? static_cast<int>(i) : 0;
    multiplying.push_back(lines(of, item, time, times));
    multiplying.back().multiplies = true;
    Numbers products;
    for (const double c : times) products.push_back(c * loads[i]);
    own.push_back(lines(of, item, time, products));
  }
  const Motion a = driven(model, start, 1.0, multiplying, 1e-11, true);
  const Motion b = driven(model, start, 1.0, own, 1e-11, true);
  EXPECT_LT(a.energy_error, 1e-10);
  EXPECT_LT(difference(a, b), 1e-9);
}

TEST(MotionInput, HasExactSensitivities) {
  const Scene scene = test::four_bar_with_follower();
  const MotionModel model(scene);
  const MotionState start = test::released(model, {{}, {{"crank", 2.0}}});
  Numbers time, load;
  for (int i = 0; i <= 40; ++i) {
    time.push_back(0.025 * i);
    load.push_back(6 * std::sin(2.9 * i));
  }
  const std::vector<MotionInput> inputs = {lines(Of::force, 0, time, load), lines(Of::force, 1, time, load),
                                           lines(Of::torque, 0, time, load)};
  const Motion motion = driven(model, start, 1.0, inputs, 1e-10, true);
  EXPECT_LT(motion.energy_error, 1e-10);
  ASSERT_EQ(motion.freedoms, 1);
  const int z = motion.independent[0];
  const auto n = static_cast<std::size_t>(motion.trajectory.coordinates);
  for (const bool rate : {false, true}) {
    const auto end = [&](double by) {
      const MotionState moved = start_motion(model,
                                             {{z, false, start.q[static_cast<std::size_t>(z)] + (rate ? 0 : by)},
                                              {z, true, start.v[static_cast<std::size_t>(z)] + (rate ? by : 0)}},
                                             &start.q);
      const Motion other = driven(model, moved, 1.0, inputs, 1e-13);
      return test::q_at(other, other.trajectory.nodes() - 1);
    };
    constexpr double h = 1e-3;
    const Numbers far_down = end(-2 * h), down = end(-h), up = end(h), far_up = end(2 * h);
    for (std::size_t i = 0; i < n; ++i) {
      const double expected = (8 * (up[i] - down[i]) - (far_up[i] - far_down[i])) / (12 * h);
      const std::size_t at = motion.trajectory.q_p.size() - 2 * n + 2 * i + (rate ? 1 : 0);
      EXPECT_NEAR(motion.trajectory.q_p[at], expected, 1e-7 * (1 + std::abs(expected))) << i << rate;
    }
  }
}

// A drive read at 500 Hz moves the mechanism as the drive itself, up to the error of the spline.
TEST(MotionInput, DrivesByASplineThroughReadings) {
  Scene scene = test::driven_five_bar();
  const MotionModel model(scene);
  const MotionState start = test::released(model, {});
  constexpr double duration = 0.6;
  const Motion expected = driven(model, start, duration, {}, 1e-11);
  std::vector<MotionInput> inputs;
  Scene other = scene;
  for (std::size_t d = 0; d < scene.drives.size(); ++d) {
    // The drives begin at the assembled pose: their measures are read there.
    Drive& drive = other.drives[d];
    const int at = drive.on.is_angle()
                       ? test::coordinate_of(model, "crank")
                       : test::coordinate_of(model, scene.joints[static_cast<std::size_t>(drive.on.joint)].name);
    const double from = drive.start.value_or(start.q[static_cast<std::size_t>(at)]);
    Numbers t, y;
    for (int i = 0; i <= 300; ++i) {
      t.push_back(duration * i / 300);
      y.push_back(from + drive.moved(t.back(), 0));
    }
    const solvers::QuinticSpline spline = solvers::interpolating_spline(t, y);
    Numbers coefficients;
    for (const auto& piece : spline.pieces) coefficients.insert(coefficients.end(), piece.begin(), piece.end());
    inputs.push_back({Of::drive, static_cast<int>(d), std::make_shared<TimeCurve>(spline.breaks, coefficients)});
    drive.rate = drive.acceleration = drive.amplitude = 0.0;
    drive.start = from;
  }
  ASSERT_EQ(inputs.size(), 2U);
  const MotionModel still(other, model.scales());
  const Motion motion = driven(still, test::released(still, {}), duration, inputs, 1e-11);
  EXPECT_LT(difference(motion, expected), 1e-7);
  EXPECT_LT(motion.energy_error, 1e-9);
  for (std::size_t d = 0; d < inputs.size(); ++d) {
    const double largest = *std::max_element(expected.drive_force[d].begin(), expected.drive_force[d].end());
    EXPECT_NEAR(motion.drive_force[d].back(), expected.drive_force[d].back(), 1e-3 * std::abs(largest));
  }
}

TEST(MotionInput, IsMetWhereTheMechanismStandsStill) {
  // A wheel at rest is turned by a pulse of 2 ms after 5 s: no step passes over it.
  Scene scene;
  scene.add_point(0, "O", {0, 0});
  test::add_link(scene, "wheel", 1.0, 0.0);
  scene.bodies[1].inertia = 0.5;
  test::add_pin(scene, "ground.O", "wheel.a");
  Torque torque;
  torque.name = "motor";
  torque.body = 1;
  scene.torques.push_back(torque);
  const MotionModel model(scene);
  const Motion motion =
      driven(model, test::released(model, {}), 10.0, {lines(Of::torque, 0, {0, 5, 5.001, 5.002, 10}, {0, 0, 3, 0, 0})});
  EXPECT_NEAR(motion.trajectory.v.back(), 3e-3 / 0.5, 1e-12);
  EXPECT_NEAR(motion.trajectory.q.back(), 3e-3 / 0.5 * 4.999, 1e-10);
}

}  // namespace
}  // namespace poise::motion_input_test

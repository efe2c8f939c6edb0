// The torque of a drive over a period and its flywheel, against closed forms and an independent quadrature.

#include "motion/fluctuation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/message_of.hpp"

namespace poise::fluctuation_test {
namespace {

constexpr double pi = std::numbers::pi;

std::function<std::vector<double>(int)> sampled(const std::function<double(double)>& torque, double from, double to) {
  return [=](int n) {
    std::vector<double> out;
    for (int k = 0; k <= n; ++k) out.push_back(torque(from + (to - from) * k / n));
    return out;
  };
}

// The integral of b sin(n phi) runs from 0 to 2 b / n.
TEST(Fluctuation, OfASineIsTwiceItsSizeOverItsWaves) {
  constexpr double a = 7.0, b = 3.0;
  for (const int waves : {1, 2, 3, 5}) {
    const auto torque = [&](double phi) { return a + b * std::sin(waves * phi); };
    const Fluctuation found = fluctuation_of(sampled(torque, 0.0, 2 * pi), 0.0, 2 * pi, 24, 5000);
    EXPECT_NEAR(found.mean, a, 1e-13);
    EXPECT_NEAR(found.swing, 2 * b / waves, 1e-6);
    EXPECT_NEAR(found.greatest.value, a + b, 1e-4);
    EXPECT_NEAR(found.least.value, a - b, 1e-4);
    EXPECT_NEAR(std::sin(waves * found.greatest.angle), 1.0, 1e-4);
    EXPECT_NEAR(std::cos(waves * found.fastest_at), 1.0, 1e-6);
    EXPECT_NEAR(std::cos(waves * found.slowest_at), -1.0, 1e-6);
    // Driven backwards the torque does its work where it is negative.
    const Fluctuation back = fluctuation_of(sampled(torque, 2 * pi, 0.0), 2 * pi, 0.0, 24, 5000);
    EXPECT_NEAR(back.swing, 2 * b / waves, 1e-6);
  }
}

// A torque that jumps between c and -c: the integral of each half is c pi. Its series converges slowly, and says so.
TEST(Fluctuation, TheErrorOfATorqueThatJumpsIsSaid) {
  constexpr double c = 4.0;
  const auto torque = [](double phi) { return std::sin(phi - 0.1) > 0 ? c : -c; };
  const Fluctuation found = fluctuation_of(sampled(torque, 0.0, 2 * pi), 0.0, 2 * pi, 36, 1200);
  EXPECT_NEAR(found.swing, c * pi, 0.05 * c);
  EXPECT_GT(found.swing_error, 0.0);
  EXPECT_LE(std::abs(found.swing - c * pi), 4 * found.swing_error + 0.02 * c);
}

constexpr double crank = 0.06, rod = 0.21, mass = 1.7, pressing = 40.0, speed = 25.0;

/// A crank and a rod without mass on a block in a level guide, pressed by a force.
Scene slider_crank() {
  return parse_scene(fmt::format(R"(
[units]
angle = "deg"
[ground]
points = {{ O = [0, 0] }}
[body.crank]
points = {{ A = [0, 0], B = [{}, 0] }}
[body.rod]
points = {{ A = [0, 0], B = [{}, 0] }}
[body.block]
points = {{ C = [0, 0] }}
mass = {}
[[pin]]
points = ["ground.O", "crank.A"]
[[pin]]
points = ["crank.B", "rod.A"]
[[pin]]
points = ["rod.B", "block.C"]
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[force]]
name = "gas"
at = "block.C"
vector = [{}, 0]
[[drive]]
name = "motor"
bodies = ["ground", "crank"]
[start]
crank = 20
)",
                                 crank, rod, mass, -pressing),
                     "slider_crank.toml");
}

/// The torque by virtual power, with s the place of the block: (mass s'' + pressing) ds/dtheta.
double torque(double theta) {
  const double sine = std::sin(theta), cosine = std::cos(theta);
  const double reach = std::sqrt(rod * rod - crank * crank * sine * sine);
  const double slope = -crank * crank * sine * cosine / reach;  // of the reach
  const double bend = -crank * crank * (cosine * cosine - sine * sine) / reach - slope * slope / reach;
  const double first = -crank * sine + slope, second = -crank * cosine + bend;
  return (mass * second * speed * speed + pressing) * first;
}

TEST(Fluctuation, OfASliderCrankIsThatOfAFineQuadrature) {
  const MotionModel model(slider_crank());
  const Fluctuation found = fluctuation_over(model, {"crank", 0.0, 2 * pi}, {.steps = 36, .rate = speed});
  // Midpoints, so many that their error is below what is asserted.
  constexpr int n = 400'000;
  const double h = 2 * pi / n;
  double mean = 0.0, most = -1e9, least = 1e9;
  for (int k = 0; k < n; ++k) {
    const double one = torque((k + 0.5) * h);
    mean += one / n;
    most = std::max(most, one);
    least = std::min(least, one);
  }
  double integral = 0.0, low = 0.0, high = 0.0;
  for (int k = 0; k < n; ++k) {
    integral += (torque((k + 0.5) * h) - mean) * h;
    low = std::min(low, integral);
    high = std::max(high, integral);
  }
  EXPECT_NEAR(found.mean, mean, 1e-8);
  EXPECT_NEAR(found.mean, 0.0, 1e-8) << "what presses gives back what it takes";
  EXPECT_NEAR(found.swing, high - low, 1e-6 * (high - low));
  EXPECT_NEAR(found.greatest.value, most, 1e-4 * most);
  EXPECT_NEAR(found.least.value, least, 1e-4 * most);
  EXPECT_LE(found.swing_error, 1e-6 * found.swing);
  EXPECT_DOUBLE_EQ(found.flywheel(0.02), found.swing / (0.02 * speed * speed));
}

TEST(Fluctuation, WhatIsNoPeriodIsRefused) {
  const MotionModel model(slider_crank());
  EXPECT_NE(test::message_of([&] {
              fluctuation_over(model, {"crank", 0.0, 2.0}, {.rate = 1.0});
            }).find("whole turns"),
            std::string::npos);
  EXPECT_NE(test::message_of([&] {
              fluctuation_of(sampled([](double phi) { return phi; }, 0.0, 1.0), 0.0, 1.0, 24, 100);
            }).find("whole period"),
            std::string::npos);
  Scene idle = slider_crank();
  idle.drives.clear();
  const MotionModel none(std::move(idle));
  EXPECT_NE(test::message_of([&] {
              fluctuation_over(none, {"crank", 0.0, 2 * pi}, {});
            }).find("one --drive"),
            std::string::npos);
}

}  // namespace
}  // namespace poise::fluctuation_test

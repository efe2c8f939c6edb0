// Periodic motions under a load that swings: Duffing's oscillator, its folds, and what ends a branch.

#include "motion/periodic_response.hpp"

#include <atomic>
#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "motion/equilibrium_pose.hpp"
#include "motion/simulate.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"

namespace poise::periodic_response_test {
namespace {

using nlohmann::json;
using Complex = std::complex<double>;
using Event = ResponseEvent::Kind;
using End = ResponseBranch::End;

struct Swung {
  PeriodicResponse found;
  std::string refused;
  std::unique_ptr<FrequencyResponse> linear;
};

/// About the equilibrium next to the start.
Swung swung(const Scene& given, const std::string& excited, const std::string& of, const PeriodicOptions& options) {
  Swung out;
  const Scene scene = scene_at_rest(given);
  const StaticModel statics(scene);
  static std::vector<std::unique_ptr<MotionModel>> models;  // responses refer to them
  const MotionModel& model = *models.emplace_back(std::make_unique<MotionModel>(scene));
  const Equilibrium equilibrium = solve(statics);
  EXPECT_TRUE(equilibrium.found()) << equilibrium.why;
  const std::vector<double> x = motion_coordinates(model, statics, equilibrium.x);
  const Excitation excitation = excitation_of(scene, excited);
  const SoughtQuantity quantity = find_quantity(scene, of, AskedOf::motion);
  out.linear = std::make_unique<FrequencyResponse>(model, x, excitation, quantity);
  out.refused = test::message_of([&] { refuse_without_periodic_response(scene, *out.linear, excitation); });
  if (out.refused.empty()) {
    out.found = periodic_response(scene, model, x, *out.linear, excitation, quantity, options);
  }
  return out;
}

Scene duffing() { return read_scene(test::dataset("duffing.toml")); }

double hertz(double omega) { return omega / (2 * M_PI); }

std::vector<ResponseEvent> of_kind(const PeriodicResponse& found, Event kind) {
  std::vector<ResponseEvent> out;
  for (const ResponseEvent& one : found.events) {
    if (one.kind == kind) out.push_back(one);
  }
  return out;
}

// Values by shooting and Fourier series apart from Poise: x'' + 0.04 x' + x + 0.1 x^3 = 0.2 cos(W t).
TEST(PeriodicResponse, DuffingsOscillatorFoldsAndJumps) {
  PeriodicOptions options;
  options.amplitude = 0.2;
  options.from = hertz(0.5);
  options.to = hertz(2.0);
  options.at = {hertz(1.3), hertz(0.9)};
  const PeriodicResponse found = swung(duffing(), "load.F", "x.mass.C", options).found;
  ASSERT_TRUE(found.is_whole());
  ASSERT_EQ(found.branches.size(), 1U);
  const json known = test::read_json(test::dataset("motion_answers.json")).at("duffing.toml");
  const std::vector<ResponseEvent> folds = of_kind(found, Event::fold);
  ASSERT_EQ(folds.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const json& expected = known.at("folds")[k];
    EXPECT_NEAR(2 * M_PI * folds[k].at.frequency, expected.at("W").get<double>(), 1e-10);
    EXPECT_NEAR(folds[k].at.farthest, expected.at("farthest").get<double>(), 2e-8);
    EXPECT_NEAR(folds[k].at.place[0], expected.at("state")[0].get<double>(), 3e-8);
    EXPECT_NEAR(folds[k].at.rate[0], expected.at("state")[1].get<double>(), 3e-8);
  }
  for (const ResponseEvent& fold : folds) {
    EXPECT_TRUE(fold.jumps);
    EXPECT_NEAR(std::abs(fold.at.multipliers.front() - 1.0), 0.0, 1e-5);
    ASSERT_TRUE(fold.landing);
    EXPECT_TRUE(fold.landing->stable);
  }
  EXPECT_TRUE(folds[0].upwards);
  EXPECT_LT(folds[0].landing->amplitude, 0.3);
  EXPECT_FALSE(folds[1].upwards);
  EXPECT_GT(folds[1].landing->amplitude, 2.0);

  ASSERT_EQ(found.answers.size(), 2U);
  const std::vector<PeriodicAnswer>& three = found.answers[0];
  ASSERT_EQ(three.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const json& expected = known.at("answers")[k];
    const Complex multiplier(expected.at("multiplier")[0].get<double>(), expected.at("multiplier")[1].get<double>());
    EXPECT_NEAR(three[k].farthest, expected.at("farthest").get<double>(), 2e-8) << k;
    EXPECT_NEAR(three[k].place[0], expected.at("state")[0].get<double>(), 1e-8) << k;
    EXPECT_NEAR(three[k].rate[0], expected.at("state")[1].get<double>(), 1e-8) << k;
    EXPECT_NEAR(std::abs(three[k].multipliers[0] - multiplier), 0.0, 1e-5) << k;
    EXPECT_EQ(three[k].stable, k != 1) << k;
    // The product of both is exp(-2 z W T), by Liouville.
    EXPECT_NEAR(std::abs(three[k].multipliers[0] * three[k].multipliers[1]), std::exp(-0.04 * 2 * M_PI / 1.3), 1e-9);
  }
  EXPECT_EQ(found.answers[1].size(), 1U);
  EXPECT_LT(found.error, 1e-10);
  EXPECT_EQ(of_kind(found, Event::largest).size(), 1U);
  EXPECT_GT(of_kind(found, Event::largest)[0].at.amplitude, folds[0].at.amplitude);
}

// The upper branch as the load swings is where a simulated motion settles.
TEST(PeriodicResponse, ASimulatedMotionSettlesOnTheStableAnswer) {
  PeriodicOptions options;
  options.amplitude = 0.2;
  options.from = hertz(0.8);
  options.to = hertz(1.0);
  const PeriodicResponse found = swung(duffing(), "load.F", "x.mass.C", options).found;
  ASSERT_TRUE(found.is_whole());
  const PeriodicAnswer& last = found.branches[0].points.back();
  EXPECT_NEAR(last.frequency, hertz(1.0), 1e-12);
  Scene scene = duffing();
  scene.forces[0].vector = {0.2, 0};
  TimeFunction function;
  function.item = 0;
  function.law = SineInTime{1.0, last.frequency, M_PI_2, 0.0};
  scene.time_functions.push_back(function);
  const MotionModel model(scene);
  MotionOptions motion;
  motion.duration = 120 / last.frequency;
  const Motion settled = simulate(model, start_motion(model, {}), motion);
  ASSERT_TRUE(settled.completed());
  EXPECT_NEAR(settled.trajectory.q.back(), last.place[0], 1e-6);
  EXPECT_NEAR(settled.trajectory.v.back(), last.rate[0], 1e-6);
}

TEST(PeriodicResponse, ASmallAmplitudeIsLinear) {
  constexpr double amplitude = 1e-6;
  PeriodicOptions options;
  options.amplitude = amplitude;
  options.from = hertz(0.5);
  options.to = hertz(2.0);
  const Swung duffing_swung = swung(duffing(), "load.F", "x.mass.C", options);
  ASSERT_TRUE(duffing_swung.found.is_whole());
  for (const PeriodicAnswer& one : duffing_swung.found.branches[0].points) {
    const Complex expected = amplitude * duffing_swung.linear->at(one.frequency);
    EXPECT_NEAR(std::abs(one.harmonic - expected), 0.0, 1e-7 * std::abs(expected)) << one.frequency;
    EXPECT_NEAR(one.amplitude, std::abs(expected), 1e-7 * std::abs(expected));
    EXPECT_TRUE(one.stable);
  }
  EXPECT_TRUE(of_kind(duffing_swung.found, Event::fold).empty());
}

// Loops, several freedoms, another load beside: by the full equations the same as by those linearised.
TEST(PeriodicResponse, ASmallAmplitudeOfALinkageIsLinear) {
  Scene scene = read_scene(test::dataset("lift.toml"));
  test::add_force(scene, "platform.Q", {0, -50}, "shaker");
  PeriodicOptions options;
  options.amplitude = 1.0;
  options.from = 2.0;
  options.to = 4.0;
  const Swung lift = swung(scene, "load.shaker", "angle.fa", options);
  ASSERT_EQ(lift.refused, "");
  ASSERT_TRUE(lift.found.is_whole()) << lift.found.why << lift.found.branches.back().why;
  for (const PeriodicAnswer& one : lift.found.branches[0].points) {
    const Complex expected = lift.linear->at(one.frequency);
    EXPECT_NEAR(std::abs(one.harmonic - expected), 0.0, 1e-5 * std::abs(expected)) << one.frequency;
  }
}

// Without a load period and amplitude of the free motion are those of the complete elliptic integral.
TEST(PeriodicResponse, FreeDuffingHasThePeriodOfTheEllipticIntegral) {
  Scene scene = duffing();
  std::erase_if(scene.elements, [](const Element& element) { return element.table == "damper"; });
  for (Element& element : scene.elements) std::get<CubicSpring>(element.law).cubic = 0.05;
  const MotionModel model(scene);
  const double period =
      test::read_json(test::dataset("motion_answers.json")).at("duffing.toml").at("free_period").get<double>();
  MotionOptions options;
  options.duration = period;
  const Motion motion = simulate(model, start_motion(model, {{0, false, 2.0}}), options);
  ASSERT_TRUE(motion.completed());
  EXPECT_NEAR(motion.trajectory.q.back(), 2.0, 1e-10);
  EXPECT_NEAR(motion.trajectory.v.back(), 0.0, 1e-10);
}

// A damped pendulum under a large torque, x'' + x'/2 + sin x = A cos(W t): near W = 2/3 its swing loses its symmetry
// and then doubles its period (G. L. Baker, J. P. Gollub, "Chaotic Dynamics", chapter 3).
Scene torqued_pendulum() {
  return test::model_of(R"(
gravity = [0, -1]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0] }
mass = 1
center = [0, -1]
[[pin]]
name = "O"
points = ["ground.O", "arm.O"]
[[torsion_damper]]
name = "oil"
bodies = ["ground", "arm"]
coefficient = 0.5
[[torque]]
name = "M"
on = "arm"
value = 0
)")
      .scene();
}

TEST(PeriodicResponse, ALargeSwingLosesItsSymmetry) {
  PeriodicOptions options;
  options.amplitude = 1.0;
  options.from = 0.085;
  options.to = 0.25;
  const PeriodicResponse found = swung(torqued_pendulum(), "load.M", "angle.arm", options).found;
  ASSERT_TRUE(found.is_whole()) << found.why;
  const std::vector<ResponseEvent> crossings = of_kind(found, Event::branch);
  ASSERT_EQ(crossings.size(), 1U);
  EXPECT_NEAR(std::abs(crossings[0].at.multipliers.front() - 1.0), 0.0, 5e-3);
  for (const PeriodicAnswer& one : found.branches[0].points) {
    EXPECT_NEAR(one.amplitude, one.farthest, 1e-6);  // symmetric
    if (std::abs(one.frequency - crossings[0].at.frequency) < 1e-4) continue;
    EXPECT_EQ(one.stable, one.frequency > crossings[0].at.frequency) << one.frequency;
  }
}

TEST(PeriodicResponse, ALargerSwingDoublesItsPeriod) {
  PeriodicOptions options;
  options.amplitude = 1.2;
  options.from = 0.085;
  options.to = 0.25;
  const PeriodicResponse found = swung(torqued_pendulum(), "load.M", "angle.arm", options).found;
  ASSERT_TRUE(found.found) << found.why;
  const std::vector<ResponseEvent> doublings = of_kind(found, Event::doubling);
  ASSERT_FALSE(doublings.empty());
  for (const ResponseEvent& one : doublings) {
    EXPECT_NEAR(std::abs(one.at.multipliers.front() + 1.0), 0.0, 1e-6);
    // Their product is exp(-c T / J), by Liouville.
    EXPECT_NEAR(std::abs(one.at.multipliers[0] * one.at.multipliers[1]), std::exp(-0.5 / one.at.frequency), 1e-9);
  }
}

TEST(PeriodicResponse, EndsWhereAStopIsMet) {
  Scene scene = duffing();
  Stop& stop = scene.stops.emplace_back();
  stop.name = "buffer";
  stop.on = scene.elements[0].on;
  stop.min = -1.0;
  stop.max = 1.0;
  PeriodicOptions options;
  options.amplitude = 0.2;
  options.from = hertz(0.5);
  options.to = hertz(2.0);
  const PeriodicResponse found = swung(scene, "load.F", "x.mass.C", options).found;
  ASSERT_EQ(found.branches.size(), 2U);  // from both ends of the range
  for (const ResponseBranch& branch : found.branches) {
    EXPECT_EQ(branch.end, End::stop);
    EXPECT_NE(branch.why.find("buffer"), std::string::npos) << branch.why;
    for (const PeriodicAnswer& one : branch.points) EXPECT_LE(one.farthest, 1.0 + 1e-3);
  }
  EXPECT_FALSE(found.is_whole());
}

TEST(PeriodicResponse, SaysWhatItLacks) {
  PeriodicOptions options;
  options.amplitude = 0.2;
  options.from = hertz(0.5);
  options.to = hertz(2.0);
  EXPECT_NE(swung(duffing(), "spring.flexure.free_length", "x.mass.C", options).refused.find("only loads swing"),
            std::string::npos);
  Scene sticks = duffing();
  Element rub = sticks.elements[0];
  rub.table = "friction";
  rub.name = "rail";
  rub.law = DryFriction{0.1, 0.0};
  sticks.elements.push_back(rub);
  EXPECT_NE(swung(sticks, "load.F", "x.mass.C", options).refused.find("\"rail\" sticks"), std::string::npos);
  Scene driven = duffing();
  Drive& drive = driven.drives.emplace_back();
  drive.name = "motor";
  drive.on = driven.elements[0].on;
  EXPECT_NE(swung(driven, "load.F", "x.mass.C", options).refused.find("\"motor\""), std::string::npos);
  Scene held = duffing();
  held.forces[0].vector = {-1, 0};
  Stop& stop = held.stops.emplace_back();
  stop.name = "buffer";
  stop.on = held.elements[0].on;
  stop.min = 0.0;
  stop.max = 9.0;
  EXPECT_NE(swung(held, "load.F", "x.mass.C", options).refused.find("\"buffer\" holds"), std::string::npos);
}

TEST(PeriodicResponse, IsInterruptedAndLimited) {
  PeriodicOptions options;
  options.amplitude = 0.2;
  options.from = hertz(0.5);
  options.to = hertz(2.0);
  options.most_points = 5;
  const PeriodicResponse limited = swung(duffing(), "load.F", "x.mass.C", options).found;
  EXPECT_EQ(limited.branches[0].end, End::limit);
  EXPECT_EQ(limited.branches[0].points.size(), 5U);
  std::atomic<bool> interrupt = false;
  int points = 0;
  options.most_points = 2000;
  options.interrupt = &interrupt;
  options.progress = [&](double) { interrupt = ++points == 7; };
  const PeriodicResponse interrupted = swung(duffing(), "load.F", "x.mass.C", options).found;
  ASSERT_EQ(interrupted.branches.size(), 1U);
  EXPECT_EQ(interrupted.branches[0].end, End::interrupted);
  EXPECT_GE(interrupted.branches[0].points.size(), 7U);
}

}  // namespace
}  // namespace poise::periodic_response_test

// Driven kinematics against closed forms of textbook linkages and finite differences.

#include "motion/kinematics.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::kinematics_test {
namespace {

using std::numbers::pi;

// Four-bar a (crank), b (coupler), c (rocker) on a ground d long, without any load: O = (0, 0), C = (d, 0).
Scene four_bar(double a, double b, double c, double d, double crank, double coupler, double rocker) {
  SceneBuilder builder("four_bar.toml");
  test::add_link(builder, "crank", a);
  test::add_link(builder, "coupler", b);
  test::add_link(builder, "rocker", c);
  return builder.ground_point("O", {0, 0})
      .ground_point("C", {d, 0})
      .pin("ground.O", "crank.a", "O")
      .pin("crank.b", "coupler.a", "A")
      .pin("coupler.b", "rocker.b", "B")
      .pin("ground.C", "rocker.a", "C")
      .start("crank", crank)
      .start("coupler", coupler)
      .start("rocker", rocker)
      .build();
}

// Slider-crank r, l with the slide "rail" along x through the crank's pivot.
Scene slider_crank(double r, double l, double crank) {
  SceneBuilder builder("slider_crank.toml");
  test::add_link(builder, "crank", r);
  test::add_link(builder, "rod", l);
  const double rod = std::asin(-r * std::sin(crank) / l);
  return builder.ground_point("O", {0, 0})
      .body("slider", {.points = {{"D", {0, 0}}}})
      .pin("ground.O", "crank.a")
      .pin("crank.b", "rod.a")
      .pin("rod.b", "slider.D", "D")
      .slide("ground.O", "slider.D", {1, 0}, "rail")
      .start("crank", crank)
      .start("rod", rod)
      .start("rail", r * std::cos(crank) + l * std::cos(rod))
      .build();
}

int body_of(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].name == name) return static_cast<int>(i);
  }
  throw std::out_of_range(name);
}

std::size_t coordinate_of(const KinematicsResult& result, const std::string& name) {
  const auto found = std::find(result.coordinates.begin(), result.coordinates.end(), name);
  if (found == result.coordinates.end()) throw std::out_of_range(name);
  return static_cast<std::size_t>(found - result.coordinates.begin());
}

std::string refusal(const Scene& scene, const std::vector<DriveRange>& drives) {
  try {
    sweep(scene, drives);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Kinematics, FourBarMovesByTheClosedForm) {
  const double a = 1.0, b = 3.2, c = 2.5, d = 3.0, w = 2.5;
  const Scene scene = four_bar(a, b, c, d, 1.0, 0.4, 1.6);
  SweepOptions options;
  options.steps = 90;
  options.rate = w;
  const KinematicsResult result = sweep(scene, {{"crank", 0.3, 0.3 + 2 * pi}}, options);
  ASSERT_TRUE(result.complete) << result.why;
  EXPECT_TRUE(result.singular.empty());
  ASSERT_EQ(result.samples.size(), 91u);
  for (const KinematicSample& at : result.samples) {
    const double t2 = at.bodies[1].pose.angle;
    // Intersection of two circles about A and C, the upper one.
    const Vec2 from_a = Vec2{d, 0} - a * unit(t2);
    const double e = norm(from_a);
    const double t3 = std::atan2(from_a.y, from_a.x) + std::acos((b * b + e * e - c * c) / (2 * b * e));
    const Vec2 tip = a * unit(t2) + b * unit(t3) - Vec2{d, 0};
    const double t4 = std::atan2(tip.y, tip.x);
    const double w3 = a * w * std::sin(t4 - t2) / (b * std::sin(t3 - t4));
    const double w4 = a * w * std::sin(t2 - t3) / (c * std::sin(t4 - t3));
    const double a3 =
        (c * w4 * w4 - a * w * w * std::cos(t2 - t4) - b * w3 * w3 * std::cos(t3 - t4)) / (b * std::sin(t3 - t4));
    const double a4 =
        (a * w * w * std::cos(t2 - t3) + b * w3 * w3 - c * w4 * w4 * std::cos(t4 - t3)) / (c * std::sin(t4 - t3));
    EXPECT_NEAR(at.drive[0], t2, 1e-13);
    EXPECT_NEAR(at.bodies[2].pose.angle, t3, 1e-13);
    EXPECT_NEAR(at.bodies[3].pose.angle, t4, 1e-13);
    EXPECT_NEAR(at.bodies[2].rate, w3, 1e-12);
    EXPECT_NEAR(at.bodies[3].rate, w4, 1e-12);
    EXPECT_NEAR(at.bodies[2].angular_acceleration, a3, 1e-11);
    EXPECT_NEAR(at.bodies[3].angular_acceleration, a4, 1e-11);
    const Vec2 middle{b / 2, 0};
    const Vec2 velocity = a * w * quarter_turn(unit(t2)) + w3 * quarter_turn(middle * unit(t3));
    const Vec2 acceleration = -a * w * w * unit(t2) + Vec2{-w3 * w3, a3} * (middle * unit(t3));
    EXPECT_NEAR(norm(at.bodies[2].velocity_of(middle) - velocity), 0.0, 1e-12);
    EXPECT_NEAR(norm(at.bodies[2].acceleration_of(middle) - acceleration), 0.0, 1e-11);
  }
}

TEST(Kinematics, SliderCrankMovesByTheClosedForm) {
  const double r = 0.05, l = 0.17, w = 300.0;
  const Scene scene = slider_crank(r, l, 0.7);
  SweepOptions options;
  options.rate = w;
  const KinematicsResult result = sweep(scene, {{"crank", 0.0, 2 * pi}}, options);
  ASSERT_TRUE(result.complete) << result.why;
  const std::size_t rail = coordinate_of(result, "rail");
  for (const KinematicSample& at : result.samples) {
    const double s = r * std::sin(at.drive[0]), c = r * std::cos(at.drive[0]);
    const double root = std::sqrt(l * l - s * s);
    EXPECT_NEAR(at.q[rail], c + root, 1e-14);
    EXPECT_NEAR(at.rate[rail], w * (-s - s * c / root), 1e-11);
    EXPECT_NEAR(at.acceleration[rail], w * w * (-c - (c * c - s * s) / root - s * s * c * c / (root * root * root)),
                1e-8);
  }
}

TEST(Kinematics, TwoDrivesKeepPace) {
  SceneBuilder builder("double pendulum");
  test::add_link(builder, "upper", 1.0);
  test::add_link(builder, "lower", 0.7);
  builder.ground_point("O", {0, 0}).pin("ground.O", "upper.a").pin("upper.b", "lower.a");
  const KinematicsResult result = sweep(builder.build(), {{"upper", 0.0, 1.0}, {"lower", 0.5, -2.5}});
  ASSERT_TRUE(result.complete) << result.why;
  for (const KinematicSample& at : result.samples) {
    EXPECT_NEAR(at.drive[1], 0.5 - 3 * at.drive[0], 1e-13);
    const Vec2 upper = unit(at.drive[0]), lower = 0.7 * unit(at.drive[1]);
    const Vec2 tip{0.7, 0};
    EXPECT_NEAR(norm(at.bodies[2].velocity_of(tip) - quarter_turn(upper - 3.0 * lower)), 0.0, 1e-12);
    EXPECT_NEAR(norm(at.bodies[2].acceleration_of(tip) + upper + 9.0 * lower), 0.0, 1e-12);
  }
}

// Derivatives of the whole lift against differences of its positions, and of its rates.
TEST(Kinematics, DerivativesAreThoseOfThePositions) {
  const Scene scene = read_scene(test::dataset("lift.toml"));
  SweepOptions options;
  options.steps = 2000;
  const KinematicsResult result = sweep(scene, {{"obd", -0.1, 0.9}}, options);
  ASSERT_TRUE(result.complete) << result.why;
  const double h = 1.0 / options.steps;
  for (std::size_t k = 100; k + 2 < result.samples.size(); k += 190) {
    const auto& s = result.samples;
    for (std::size_t i = 0; i < result.coordinates.size(); ++i) {
      const auto slope = [&](auto f) {
        return (8 * (f(s[k + 1]) - f(s[k - 1])) - (f(s[k + 2]) - f(s[k - 2]))) / (12 * h);
      };
      EXPECT_NEAR(s[k].rate[i], slope([&](const auto& at) { return at.q[i]; }), 1e-10);
      EXPECT_NEAR(s[k].acceleration[i], slope([&](const auto& at) { return at.rate[i]; }), 1e-9);
    }
  }
}

TEST(Kinematics, RockerStopsAtItsDeadCentre) {
  const double a = 1.0, b = 3.2, c = 2.5, d = 3.0;
  const Scene scene = four_bar(a, b, c, d, 1.0, 0.4, 1.6);
  // Crank and coupler in line, stretched: a triangle of a + b, c and d.
  const double end = pi - std::acos((c * c + d * d - (a + b) * (a + b)) / (2 * c * d));
  const KinematicsResult result = sweep(scene, {{"rocker", 2.0, 1.0}});
  EXPECT_FALSE(result.complete);
  ASSERT_EQ(result.singular.size(), 1u);
  const SingularPose& dead = result.singular.front();
  EXPECT_EQ(dead.kind, SingularPose::Kind::dead_centre);
  EXPECT_NEAR(dead.drive[0], end, 1e-10);
  EXPECT_NE(dead.text.find("crank and coupler are in line"), std::string::npos) << dead.text;
  EXPECT_NE(result.why.find("cannot be driven beyond rocker = "), std::string::npos) << result.why;
  ASSERT_FALSE(result.samples.empty());
  EXPECT_GT(result.samples.back().drive[0], dead.drive[0]);
  EXPECT_LT(result.samples.back().drive[0], dead.drive[0] + 1.0 / 72);
  for (const KinematicSample& at : result.samples) {
    EXPECT_TRUE(std::all_of(at.acceleration.begin(), at.acceleration.end(), [](double v) { return std::isfinite(v); }));
  }
}

TEST(Kinematics, SliderStopsWhereCrankAndRodStretch) {
  const Scene scene = slider_crank(0.05, 0.17, 0.7);
  const KinematicsResult result = sweep(scene, {{"rail", 0.15, 0.3}});
  EXPECT_FALSE(result.complete);
  ASSERT_EQ(result.singular.size(), 1u);
  EXPECT_NEAR(result.singular.front().drive[0], 0.22, 1e-11);
  EXPECT_NE(result.why.find("cannot be driven beyond rail = 0.22 m: dead centre"), std::string::npos) << result.why;
}

TEST(Kinematics, AnUnreachableRangeEndsOnTheWay) {
  const Scene scene = slider_crank(0.05, 0.17, 0.7);
  const KinematicsResult result = sweep(scene, {{"rail", 0.3, 0.4}});
  EXPECT_FALSE(result.complete);
  EXPECT_TRUE(result.samples.empty());
  ASSERT_EQ(result.singular.size(), 1u);
  EXPECT_TRUE(result.singular.front().before_range);
}

TEST(Kinematics, ParallelogramKeepsItsBranchThroughItsChangePoints) {
  const Scene scene = four_bar(1, 3, 1, 3, 0.8, 0.0, 0.8);
  SweepOptions options;
  options.steps = 8;  // samples stand on the change points
  const KinematicsResult result = sweep(scene, {{"crank", 0.0, 4 * pi}}, options);
  ASSERT_TRUE(result.complete) << result.why;
  ASSERT_EQ(result.samples.size(), 9u);
  for (const KinematicSample& at : result.samples) {
    EXPECT_NEAR(at.bodies[3].pose.angle, at.drive[0], 1e-9);
    EXPECT_NEAR(at.bodies[3].rate, 1.0, 1e-7);
    EXPECT_NEAR(at.bodies[2].pose.angle, 0.0, 1e-9);
    EXPECT_NEAR(at.bodies[2].rate, 0.0, 1e-7);
    EXPECT_NEAR(at.bodies[3].angular_acceleration, 0.0, 1e-5);
  }
  ASSERT_EQ(result.singular.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(result.singular[k].kind, SingularPose::Kind::change_point);
    EXPECT_NEAR(result.singular[k].drive[0], pi * static_cast<double>(k), 1e-10);
    EXPECT_NE(result.singular[k].text.find("change point of the loop closed by"), std::string::npos);
    EXPECT_NE(result.singular[k].text.find("coupler and rocker are in line"), std::string::npos)
        << result.singular[k].text;
  }
}

TEST(Kinematics, AnAlmostParallelogramHasNoChangePoint) {
  const Scene scene = four_bar(1, 3, 1.001, 3, 0.8, 0.0, 0.8);
  const KinematicsResult result = sweep(scene, {{"crank", 0.5, 2.5}});
  ASSERT_TRUE(result.complete) << result.why;
  EXPECT_TRUE(result.singular.empty());
}

TEST(Kinematics, RedundantClosuresDoNoHarm) {
  const Scene scene = read_scene(test::dataset("redundant_parallelogram.toml"));
  const KinematicsResult result = sweep(scene, {{"crank1", 0.0, 2 * pi}});
  ASSERT_TRUE(result.complete) << result.why;
  const int third = body_of(scene, "crank3");
  for (const KinematicSample& at : result.samples) {
    EXPECT_NEAR(at.bodies[third].pose.angle, at.drive[0], 1e-9);
    EXPECT_NEAR(at.bodies[third].rate, 1.0, 1e-7);
  }
  ASSERT_EQ(result.singular.size(), 3u);
  EXPECT_NEAR(result.singular[1].drive[0], pi, 1e-10);
  EXPECT_NE(result.singular[1].text.find("are in line"), std::string::npos) << result.singular[1].text;
}

TEST(Kinematics, OnePlaceIsOneSample) {
  const Scene scene = slider_crank(0.05, 0.17, 0.7);
  const KinematicsResult result = sweep(scene, {{"crank", 0.4, 0.4}});
  ASSERT_TRUE(result.complete) << result.why;
  ASSERT_EQ(result.samples.size(), 1u);
  EXPECT_NEAR(result.samples[0].bodies[1].pose.angle, 0.4, 1e-15);
  EXPECT_NEAR(result.samples[0].bodies[1].rate, 1.0, 1e-15);
}

TEST(Kinematics, RangeEndsAtTheStop) {
  constexpr double a = 1.0, b = 3.2, c = 2.5, d = 3.0, most = 1.9;
  Scene scene = four_bar(a, b, c, d, 1.0, 0.4, 1.6);
  test::add_stop(scene, "room", 0, body_of(scene, "rocker"), 0.2, most);
  const KinematicsResult result = sweep(scene, {{"crank", 0.9, 3.0}});
  EXPECT_FALSE(result.complete);
  ASSERT_TRUE(result.stop.has_value());
  EXPECT_EQ(result.stop->stop, 0u);
  EXPECT_TRUE(result.stop->at_max);
  EXPECT_TRUE(result.singular.empty());
  const KinematicSample& last = result.samples.back();
  EXPECT_NEAR(last.bodies[3].pose.angle, most, 1e-14);
  // Intersection of two circles about O and B: where the crank stands then.
  const Vec2 tip = Vec2{d, 0} + c * unit(most);
  const double e = norm(tip);
  const double crank = std::atan2(tip.y, tip.x) + std::acos((a * a + e * e - b * b) / (2 * a * e));
  EXPECT_NEAR(last.drive[0], crank, 1e-13);
  EXPECT_NE(result.why.find("the stop \"room\" is reached at crank = "), std::string::npos) << result.why;
  EXPECT_NE(result.why.find("(its max, 1.9 rad)"), std::string::npos) << result.why;
  // Before it the range has the samples that it has without the stop, and the same.
  scene.stops.clear();
  const KinematicsResult whole = sweep(scene, {{"crank", 0.9, 3.0}});
  for (std::size_t k = 0; k + 1 < result.samples.size(); ++k) {
    EXPECT_EQ(result.samples[k].drive, whole.samples[k].drive);
    EXPECT_EQ(result.samples[k].q, whole.samples[k].q);
  }
  EXPECT_GT(whole.samples[result.samples.size() - 1].bodies[3].pose.angle, most);
}

// The slider's stop lets it go all but 0.1 um of its stroke: the crank may turn to 2 mrad before its dead centre.
TEST(Kinematics, StopThatIsPassedWithinOneStepIsMet) {
  constexpr double r = 0.05, l = 0.17, short_by = 1e-7;
  Scene scene = slider_crank(r, l, -0.7);
  Stop stop;
  stop.on = Measure::travel_of(3);
  stop.max = r + l - short_by;
  scene.stops.push_back(stop);
  const KinematicsResult result = sweep(scene, {{"crank", -0.73, 0.8}});
  ASSERT_TRUE(result.stop.has_value());
  const double x = r + l - short_by;
  EXPECT_NEAR(result.samples.back().drive[0], -std::acos((r * r + x * x - l * l) / (2 * r * x)), 1e-10);
  scene.stops.back().max = r + l;
  EXPECT_TRUE(sweep(scene, {{"crank", -0.73, 0.8}}).complete) << "it is touched, not passed";
}

TEST(Kinematics, RangeMayEndAtAStop) {
  Scene scene = slider_crank(0.05, 0.17, 0.7);
  test::add_stop(scene, "room", 0, 1, 0.3, 1.1);
  EXPECT_TRUE(sweep(scene, {{"crank", 0.3, 1.1}}).complete);
  const KinematicsResult beyond = sweep(scene, {{"crank", 1.1, 0.2}});
  ASSERT_TRUE(beyond.stop.has_value());
  EXPECT_FALSE(beyond.stop->at_max);
  EXPECT_NEAR(beyond.samples.back().drive[0], 0.3, 1e-15);
  const KinematicsResult nowhere = sweep(scene, {{"crank", 1.1, 1.2}});
  ASSERT_TRUE(nowhere.stop.has_value());
  EXPECT_EQ(nowhere.samples.size(), 1u);
}

TEST(Kinematics, RefusesPlacesBeyondAStop) {
  Scene scene = slider_crank(0.05, 0.17, 0.7);
  test::add_stop(scene, "room", 0, 1, 0.3, 1.1);
  for (const double start : {0.7, 1.25}) {  // a start beyond a stop is assembled at it
    scene.start.angle[1] = start;
    const std::string said = refusal(scene, {{"crank", 1.2, 0.5}});
    EXPECT_NE(
        said.find("the stop \"room\" is reached at crank = 1.1 rad (its max, 1.1 rad), on the way from the start"),
        std::string::npos)
        << said;
    EXPECT_TRUE(sweep(scene, {{"crank", 1.0, 0.5}}).complete);
  }
}

TEST(Kinematics, SaysWhatElseMustBeDriven) {
  const Scene scene = test::chain(3, 1.0, 1.0);
  const std::string said = refusal(scene, {{"1", 0, 1}});
  EXPECT_NE(said.find("2 degrees of freedom are undriven"), std::string::npos) << said;
  EXPECT_NE(said.find("drive 2 more, of 2, 3"), std::string::npos) << said;
}

TEST(Kinematics, SaysWhichCamMayLiftOff) {
  const std::string said = refusal(read_scene(test::dataset("cam_follower.toml")), {{"cam", 0, 1}});
  EXPECT_NE(said.find("drive 1 more, of guide; or give cam \"lobe\", which may lift off, guided = true"),
            std::string::npos)
      << said;
}

TEST(Kinematics, RefusesDrivesThatContradictEachOther) {
  const Scene scene = slider_crank(0.05, 0.17, 0.7);
  const std::string said = refusal(scene, {{"crank", 0, 1}, {"rod", 0, 1}});
  EXPECT_NE(said.find("expected 1 of them"), std::string::npos) << said;
  EXPECT_NE(refusal(scene, {{"crank", 0, 1}, {"crank", 0, 1}}).find("already"), std::string::npos);
  EXPECT_NE(refusal(scene, {{"slider", 0, 1}}).find("keeps its angle"), std::string::npos);
  EXPECT_NE(refusal(scene, {{"cranc", 0, 1}}).find("did you mean \"crank\"?"), std::string::npos);
}

TEST(Kinematics, RefusesASingularStart) {
  const std::string said = refusal(four_bar(1, 3, 1, 3, 0.0, 0.0, 0.0), {{"crank", 0.0, 2 * pi}});
  EXPECT_NE(said.find("the start is a singular position"), std::string::npos) << said;
}

TEST(Kinematics, CanBeInterrupted) {
  const std::atomic<bool> interrupt = true;
  SweepOptions options;
  options.interrupt = &interrupt;
  const KinematicsResult result = sweep(slider_crank(0.05, 0.17, 0.7), {{"crank", 0.0, 1.0}}, options);
  EXPECT_FALSE(result.complete);
  EXPECT_EQ(result.why, "interrupted");
}

// The way is followed step by step from the assembled start: beyond 2^53 rad no step moves it.
TEST(Kinematics, RefusesAWayThatItsStepsCannotLead) {
  const auto message = [](const Scene& scene, const DriveRange& range) -> std::string {
    try {
      sweep(scene, {range});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  Scene scene = four_bar(1, 3, 3, 4, 0.5, 0.6, 1.5);
  EXPECT_NE(message(scene, {"crank", 0.5, 1e6}).find("driven by less than 10000 rad over its range"),
            std::string::npos);
  SceneBuilder arm("arm.toml");
  test::add_link(arm, "arm", 1.0);
  arm.ground_point("O", {0, 0}).pin("ground.O", "arm.a").start("arm", 9007199254740993.0);
  EXPECT_NE(message(arm.build(), {"arm", 0.0, 0.5}).find("driven by less than 10000 rad from the start to its range"),
            std::string::npos);
}

TEST(Kinematics, SaysWhereItIsWhenItsStepsAreUsedUp) {
  SweepOptions options;
  options.most_steps = 130;  // 6.5 rad of the crank, but the other link that turns is faster at times
  const Scene drag_link = four_bar(2, 2, 2.2, 0.5, 0.5, 2.489, 1.72);
  const KinematicsResult result = sweep(drag_link, {{"crank", 0.5, 0.5 + 2 * pi}}, options);
  EXPECT_FALSE(result.complete);
  EXPECT_EQ(result.why.find("after 130 steps it is at crank = "), 0U) << result.why;
  EXPECT_GT(result.samples.size(), 10U);
}

}  // namespace
}  // namespace poise::kinematics_test

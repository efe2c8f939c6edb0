// Other dimensions with which a mechanism moves alike.

#include "identification/fit/private/twins.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/identification/experiments.hpp"
#include "tests/support/build_scene.hpp"

namespace poise::twins_test {
namespace {

// A block on a rail along x, on a spring whose anchor is h beside the rail: the spring's length is that of one whose
// anchor is on the other side.
struct BlockOnARail {
  static constexpr double h = 0.07;
  Experiment experiment;

  BlockOnARail() {
    experiment.scene = parse_scene(R"(
      [ground]
      points = { O = [0, 0], S = [0.1, 0.07] }
      [body.block]
      points = { C = [0, 0] }
      mass = 0.5
      [[slide]]
      name = "rail"
      points = ["ground.O", "block.C"]
      axis = [1, 0]
      [[spring]]
      name = "coil"
      points = ["ground.S", "block.C"]
      stiffness = 30
      free_length = 0.06
      [start]
      rail = 0.2
    )",
                                   "rail.toml");
    Sensor& travel = experiment.sensors.emplace_back();
    travel.name = travel.column = "rail";
    travel.on = Measure::travel_of(0);
    travel.noise = 1e-4;
    experiment.unknowns = {test::unknown("body.block.mass"), test::unknown("point.ground.S.y")};
    experiment.unknowns[1].start = 0.06;
    experiment.runs = {test::simulated(100, 200)};
    Release& release = experiment.runs[0].release.emplace_back();
    release.joint = 0;
    release.value = 0.25;
  }
};

TEST(Twins, AnAnchorOnEitherSideOfARailIsAmbiguous) {
  const BlockOnARail block;
  const FitProblem problem(block.experiment);
  const Fit found = fit(problem, problem.records());
  EXPECT_EQ(found.status, FitStatus::ambiguous) << found.why;
  EXPECT_NE(found.why.find("point.ground.S.y"), std::string::npos) << found.why;
  ASSERT_EQ(found.alternatives.size(), 2U);
  const double one = found.alternatives[0].values[1];
  EXPECT_NEAR(std::abs(one), block.h, 0.01 * block.h);
  EXPECT_NEAR(found.alternatives[1].values[1], -one, 1e-5 * block.h);
  EXPECT_NEAR(found.alternatives[1].more, 0.0, 1e-3);
  // The mass is the same in both.
  ASSERT_EQ(found.estimates.size(), 2U);
  EXPECT_TRUE(found.estimates[1].withheld);
  EXPECT_FALSE(found.estimates[0].withheld);
  EXPECT_NEAR(found.estimates[0].value, 0.5, 4 * found.estimates[0].standard_error);
}

// Two blocks in series, k1 from the ground to the first and k2 between them; only the second one is read. Its
// frequencies are those of  P = k1 k2  and  S = k1 / m1 + k2 (1/m1 + 1/m2):  with two values of k2, the roots of
//   k2^2 (1/m1 + 1/m2) - S k2 + P / m1 = 0,
// it moves alike, the first block otherwise.
TEST(Twins, StatesThatNoSensorReadsLeaveTwoPairsOfStiffnesses) {
  constexpr double m1 = 0.4, m2 = 1.3, k1 = 220, k2 = 150;
  const double other = k1 / (1 + m1 / m2);  // product of the roots: P / m1 / (1/m1 + 1/m2)
  Experiment e;
  e.scene = parse_scene(R"(
    [ground]
    points = { O = [0, 0] }
    [body.a]
    points = { P = [0, 0] }
    mass = 0.4
    [body.b]
    points = { P = [0, 0] }
    mass = 1.3
    [[slide]]
    name = "first"
    points = ["ground.O", "a.P"]
    axis = [1, 0]
    [[slide]]
    name = "second"
    points = ["ground.O", "b.P"]
    axis = [1, 0]
    [[spring]]
    name = "k1"
    points = ["ground.O", "a.P"]
    stiffness = 220
    free_length = 0.2
    [[spring]]
    name = "k2"
    points = ["a.P", "b.P"]
    stiffness = 150
    free_length = 0.15
    [start]
    first = 0.29
    second = 0.33
  )",
                        "series.toml");
  e.unknowns = {test::unknown("spring.k1.stiffness"), test::unknown("spring.k2.stiffness")};
  e.runs = {test::simulated(100, 300)};
  const auto travel = [](int joint) {
    Sensor sensor;
    sensor.name = sensor.column = joint == 0 ? "first" : "second";
    sensor.on = Measure::travel_of(joint);
    sensor.noise = 1e-4;
    return sensor;
  };
  e.sensors = {travel(1)};
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  ASSERT_EQ(found.status, FitStatus::ambiguous) << found.why;
  ASSERT_EQ(found.alternatives.size(), 2U);
  const bool first = std::abs(found.alternatives[0].values[1] - k2) < std::abs(found.alternatives[1].values[1] - k2);
  const Alternative& truth = found.alternatives[first ? 0 : 1];
  const Alternative& twin = found.alternatives[first ? 1 : 0];
  EXPECT_NEAR(truth.values[0], k1, 0.03 * k1);
  EXPECT_NEAR(truth.values[1], k2, 0.03 * k2);
  EXPECT_NEAR(twin.values[1], other, 0.03 * other);
  EXPECT_NEAR(twin.values[0], k1 * k2 / other, 0.03 * k1);
  EXPECT_NEAR(truth.more, twin.more, 1e-3);

  // With the first block read, too, nothing is left to choose.
  e.sensors = {travel(1), travel(0)};
  const FitProblem both(e);
  const Fit known = fit(both, both.records());
  ASSERT_EQ(known.status, FitStatus::converged) << known.why;
  EXPECT_NEAR(known.estimates[1].value, k2, 4 * known.estimates[1].standard_error);
}

// The distance from W to E, at (a, b) of an arm on the pivot O, is that to the mirror image of the arm about the
// vertical through W:  O_x' = 2 W_x - O_x,  theta' = -pi - theta,  for b = 0, on a spring of the free angle
// phi' = -pi - phi.
struct WireToAnArm {
  static constexpr double Wx = 0.6, Ox = 0.08;
  Experiment experiment;

  WireToAnArm() {
    experiment.scene = parse_scene(R"(
      gravity = [0, -9.81]
      [ground]
      points = { O = [0.08, -0.03], W = [0.6, -0.2] }
      [body.arm]
      points = { O = [0, 0], E = [0.45, 0] }
      mass = 2
      center = [0.3, 0]
      inertia = 0.03
      [[pin]]
      points = ["ground.O", "arm.O"]
      [[torsion_damper]]
      name = "oil"
      bodies = ["ground", "arm"]
      coefficient = 0.005
      [[torsion_spring]]
      name = "coil"
      bodies = ["ground", "arm"]
      stiffness = 2
      free_angle = -1
      [start]
      arm = -1.2
    )",
                                   "wire.toml");
    Sensor& wire = experiment.sensors.emplace_back();
    wire.name = wire.column = "wire";
    wire.on =
        Measure::distance_between(test::point(experiment.scene, "ground.W"), test::point(experiment.scene, "arm.E"));
    wire.noise = 1e-3;
    experiment.runs = {test::simulated(100, 400)};
    experiment.runs[0].unknown_start = true;
    Release& release = experiment.runs[0].release.emplace_back();
    release.body = 1;
    release.value = -0.9;
  }
};

TEST(Twins, APendulumOnEitherSideOfADistanceSensorIsAmbiguous) {
  for (const double start : {0.1, 1.1}) {
    WireToAnArm arm;
    arm.experiment.unknowns = {test::unknown("point.ground.O.x"), test::unknown("body.arm.inertia"),
                               test::unknown("torsion_spring.coil.free_angle")};
    arm.experiment.unknowns[0].start = start;
    const FitProblem problem(arm.experiment);
    const Fit found = fit(problem, problem.records());
    ASSERT_EQ(found.status, FitStatus::ambiguous) << found.why;
    ASSERT_EQ(found.alternatives.size(), 2U);
    const std::vector<double>& one = found.alternatives[0].values;
    const std::vector<double>& other = found.alternatives[1].values;
    EXPECT_NEAR(std::min(one[0], other[0]), arm.Ox, 0.01);
    EXPECT_NEAR(one[0] + other[0], 2 * arm.Wx, 1e-5);
    EXPECT_NEAR(one[1], other[1], 1e-5 * one[1]);
    EXPECT_NEAR(one[2] + other[2], -M_PI, 1e-4);
    EXPECT_NEAR(found.alternatives[1].more, 0.0, 1e-3);
  }
}

TEST(Twins, ASpringOnThePendulumTellsTheSide) {
  WireToAnArm arm;
  arm.experiment.unknowns = {test::unknown("point.ground.O.x"), test::unknown("body.arm.inertia")};
  arm.experiment.unknowns[0].start = 0.1;
  const FitProblem problem(arm.experiment);
  const Fit found = fit(problem, problem.records());
  ASSERT_EQ(found.status, FitStatus::converged) << found.why;
  EXPECT_NEAR(found.estimates[0].value, arm.Ox, 4 * found.estimates[0].standard_error);
}

// W right above O: the spring may turn the arm to either side.
TEST(Twins, ASpringToEitherSideIsAmbiguous) {
  WireToAnArm arm;
  const int W = test::point(arm.experiment.scene, "ground.W").point;
  arm.experiment.scene.bodies[0].points[static_cast<std::size_t>(W)].at = {0.08, 0.2};
  arm.experiment.unknowns = {test::unknown("torsion_spring.coil.free_angle")};
  const FitProblem problem(arm.experiment);
  const Fit found = fit(problem, problem.records());
  ASSERT_EQ(found.status, FitStatus::ambiguous) << found.why;
  ASSERT_EQ(found.alternatives.size(), 2U);
  EXPECT_NEAR(found.alternatives[0].values[0] + found.alternatives[1].values[0], -M_PI, 1e-4);
}

// A pendulum on a carriage that moves vertically and is read: the pendulum alone may swing the other way.
TEST(Twins, APendulumThatSwingsOtherwiseOnACarriageThatIsReadIsAmbiguous) {
  constexpr double Ox = 0.1, Wx = 0.7;
  Experiment e;
  e.scene = parse_scene(R"(
    gravity = [0, -9.81]
    [ground]
    points = { O = [0.1, 0], S = [0.1, 1], W = [0.7, -0.2] }
    [body.carriage]
    points = { C = [0, 0] }
    mass = 1
    [body.arm]
    points = { E = [0.45, 0], O = [0, 0] }
    mass = 2
    center = [0.3, 0]
    inertia = 0.03
    [[slide]]
    name = "lift"
    points = ["ground.O", "carriage.C"]
    axis = [0, 1]
    [[spring]]
    name = "coil"
    points = ["ground.S", "carriage.C"]
    stiffness = 400
    free_length = 0.95
    [[pin]]
    points = ["carriage.C", "arm.O"]
    [[torsion_damper]]
    name = "oil"
    bodies = ["ground", "arm"]
    coefficient = 0.005
    [start]
    arm = -1.57
    lift = 0
  )",
                        "carriage.toml");
  e.unknowns = {test::unknown("point.ground.W.x"), test::unknown("body.arm.inertia")};
  e.unknowns[0].start = 0.6;
  Sensor& height = e.sensors.emplace_back();
  height.name = height.column = "height";
  height.on = Measure::travel_of(0);
  height.noise = 1e-3;
  Sensor& wire = e.sensors.emplace_back();
  wire.name = wire.column = "wire";
  wire.on = Measure::distance_between(test::point(e.scene, "ground.W"), test::point(e.scene, "arm.E"));
  wire.noise = 1e-3;
  e.runs = {test::simulated(100, 400)};
  e.runs[0].unknown_start = true;
  Release& swing = e.runs[0].release.emplace_back();
  swing.body = 2;
  swing.value = -0.9;
  Release& lifted = e.runs[0].release.emplace_back();
  lifted.joint = 0;
  lifted.value = 0.02;
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  ASSERT_EQ(found.status, FitStatus::ambiguous) << found.why;
  ASSERT_EQ(found.alternatives.size(), 2U);
  EXPECT_NEAR(found.alternatives[0].values[0], Wx, 0.01);
  EXPECT_NEAR(found.alternatives[0].values[0] + found.alternatives[1].values[0], 2 * Ox, 1e-4);
}

TEST(Twins, NoneWithinTheRange) {
  BlockOnARail block;
  block.experiment.unknowns[1].min = 0.0;
  const FitProblem problem(block.experiment);
  const Fit found = fit(problem, problem.records());
  ASSERT_EQ(found.status, FitStatus::converged) << found.why;
  EXPECT_NEAR(found.estimates[1].value, block.h, 4 * found.estimates[1].standard_error);
  EXPECT_TRUE(twins(problem, found).empty());
}

// A crank in gravity: a centre of mass above the line to the crank's zero is told from one below it.
TEST(Twins, NoneWhereGravityTellsTheSides) {
  Experiment e;
  e.scene = parse_scene(R"(
    gravity = [0, -9.81]
    [ground]
    points = { O = [0, 0] }
    [body.arm]
    points = { O = [0, 0] }
    mass = 1
    center = [0.2, 0.03]
    inertia = 0.01
    [[pin]]
    points = ["ground.O", "arm.O"]
    [start]
    arm = -1
  )",
                        "arm.toml");
  e.sensors = {test::angle_of(e.scene, "arm", 1e-3)};
  e.unknowns = {test::unknown("body.arm.center.x"), test::unknown("body.arm.center.y")};
  e.runs = {test::simulated(100, 200)};
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  EXPECT_EQ(found.status, FitStatus::converged) << found.why;
  EXPECT_TRUE(twins(problem, found).empty());
}

}  // namespace
}  // namespace poise::twins_test

#include "motion/modes.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "motion/equilibrium_pose.hpp"
#include "motion/kinematics.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::modes_test {
namespace {

using nlohmann::json;
using Kind = Vibration::Kind;

// The modes about the equilibrium next to the scene's start.
Modes modes_at_equilibrium(const Scene& scene) {
  const StaticModel statics(scene);
  const MotionModel motion(scene);
  const Equilibrium equilibrium = solve(statics);
  EXPECT_TRUE(equilibrium.found()) << equilibrium.why;
  return modes_of(motion, motion_coordinates(motion, statics, equilibrium.x));
}

// A compound pendulum on ground.O: centre of mass 0.4 m out, 3 kg, 0.2 kg m^2.
Scene pendulum(double start) {
  Scene scene;
  scene.gravity = {0, -9.81};
  scene.bodies[0].points.push_back({"O", {0, 0}});
  test::add_link(scene, "arm", 1.0, 3.0);
  scene.bodies[1].center = {0.4, 0};
  scene.bodies[1].inertia = 0.2;
  test::add_pin(scene, "ground.O", "arm.a");
  scene.start.angle[1] = start;
  return scene;
}

// `count` blocks on a rail, m each, tied to the ground and to each other by springs k, at rest at x = 1, 2, ...
Scene spring_mass_chain(int count, double m, double k) {
  Scene scene;
  scene.bodies[0].points.push_back({"O", {0, 0}});
  std::string before = "ground.O";
  for (int i = 1; i <= count; ++i) {
    const std::string name = std::to_string(i);
    const int body = scene.add_body(name);
    scene.add_point(body, "c", {0, 0});
    scene.bodies[body].mass = m;
    const int joint = test::add_slide(scene, "ground.O", name + ".c", {1, 0}, "x" + name);
    scene.start.travel[joint] = i + 0.1;
    scene.elements.push_back(
        test::line_spring("s" + name, test::point(scene, before), test::point(scene, name + ".c"), k, 1.0));
    before = name + ".c";
  }
  return scene;
}

void add_damper(Scene& scene, const std::string& a, const std::string& b, double coefficient) {
  scene.elements.push_back(test::line_damper(a + "-" + b, test::point(scene, a), test::point(scene, b), coefficient));
}

TEST(Modes, PendulumSwingsByItsMomentAboutThePin) {
  const Modes modes = modes_at_equilibrium(pendulum(-1.2));
  ASSERT_TRUE(modes.known);
  ASSERT_EQ(modes.vibrations.size(), 1u);
  const double moment = 0.2 + 3.0 * 0.4 * 0.4;
  const double omega = std::sqrt(3.0 * 9.81 * 0.4 / moment);
  EXPECT_EQ(modes.vibrations[0].kind, Kind::oscillates);
  EXPECT_NEAR(modes.vibrations[0].frequency, omega / (2 * M_PI), 1e-14);
  EXPECT_NEAR(modes.vibrations[0].shape[0].real(), 1 / std::sqrt(moment), 1e-14);
  EXPECT_EQ(modes.vibrations[0].damping_ratio, 0.0);
}

TEST(Modes, PendulumOnItsHeadLeavesAtTheSameRate) {
  const Modes modes = modes_at_equilibrium(pendulum(M_PI / 2));
  ASSERT_EQ(modes.vibrations.size(), 1u);
  const double moment = 0.2 + 3.0 * 0.4 * 0.4;
  EXPECT_EQ(modes.vibrations[0].kind, Kind::diverges);
  EXPECT_EQ(modes.vibrations[0].frequency, 0.0);
  EXPECT_NEAR(modes.vibrations[0].growth, std::sqrt(3.0 * 9.81 * 0.4 / moment), 1e-12);
}

// Two equal point masses on massless rods of length l: omega^2 = (2 -+ sqrt 2) g / l, lower mass sqrt 2 times as far.
TEST(Modes, DoublePendulumHasItsTwoFrequencies) {
  constexpr double l = 0.7;
  Scene scene = test::chain(2, l, 1.3);
  scene.gravity = {0, -9.81};
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    scene.bodies[i].center = {l, 0};
    scene.bodies[i].inertia = 0.0;
    scene.start.angle[i] = -1.4;
  }
  const Modes modes = modes_at_equilibrium(scene);
  ASSERT_EQ(modes.vibrations.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    const double sign = k == 0 ? -1.0 : 1.0;
    const Vibration& mode = modes.vibrations[static_cast<std::size_t>(k)];
    EXPECT_NEAR(mode.frequency, std::sqrt((2 + sign * std::sqrt(2.0)) * 9.81 / l) / (2 * M_PI), 1e-12);
    EXPECT_NEAR((mode.shape[1] / mode.shape[0]).real(), -sign * std::sqrt(2.0), 1e-12);
  }
}

TEST(Modes, SpringMassChainHasTheFrequenciesOfAFixedFreeChain) {
  constexpr int count = 6;
  const Modes modes = modes_at_equilibrium(spring_mass_chain(count, 0.3, 70.0));
  ASSERT_EQ(modes.vibrations.size(), static_cast<std::size_t>(count));
  for (int j = 1; j <= count; ++j) {
    const double omega = 2 * std::sqrt(70.0 / 0.3) * std::sin((2 * j - 1) * M_PI / (2.0 * (2 * count + 1)));
    EXPECT_NEAR(modes.vibrations[static_cast<std::size_t>(j - 1)].frequency, omega / (2 * M_PI), 1e-12 * omega);
  }
}

TEST(Modes, StatesDampingRatioAndDampedFrequency) {
  Scene scene = spring_mass_chain(1, 2.0, 50.0);
  add_damper(scene, "ground.O", "1.c", 4.0);
  const Vibration mode = modes_at_equilibrium(scene).vibrations.at(0);
  EXPECT_EQ(mode.kind, Kind::oscillates);
  EXPECT_NEAR(mode.frequency, 5.0 / (2 * M_PI), 1e-14);
  EXPECT_NEAR(mode.damping_ratio, 0.2, 1e-14);
  EXPECT_NEAR(mode.damped_frequency, 5.0 * std::sqrt(1 - 0.04) / (2 * M_PI), 1e-14);
  EXPECT_NEAR(mode.growth, -1.0, 1e-13);
}

TEST(Modes, OverdampedMassDecaysAtTwoRates) {
  Scene scene = spring_mass_chain(1, 2.0, 50.0);
  add_damper(scene, "ground.O", "1.c", 52.0);  // s^2 + 26 s + 25 = (s + 1) (s + 25)
  const Vibration mode = modes_at_equilibrium(scene).vibrations.at(0);
  EXPECT_EQ(mode.kind, Kind::decays);
  EXPECT_NEAR(mode.growth, -1.0, 1e-12);
  EXPECT_NEAR(std::min(mode.roots[0].real(), mode.roots[1].real()), -25.0, 1e-12);
  EXPECT_NEAR(mode.damping_ratio, 2.6, 1e-12);
  EXPECT_EQ(mode.damped_frequency, 0.0);
}

// A damper between two blocks only, which no natural mode diagonalises.
TEST(Modes, ExponentsSolveTheQuadraticEigenproblem) {
  constexpr double m = 0.5, k = 30.0, c = 1.7;
  Scene scene = spring_mass_chain(2, m, k);
  add_damper(scene, "1.c", "2.c", c);
  const Modes modes = modes_at_equilibrium(scene);
  ASSERT_EQ(modes.vibrations.size(), 2u);
  for (const Vibration& mode : modes.vibrations) {
    for (const std::complex<double>& s : mode.roots) {
      const auto a = m * s * s + c * s + 2 * k;
      const auto b = -c * s - k;
      const auto d = m * s * s + c * s + k;
      EXPECT_LT(std::abs(a * d - b * b), 1e-10 * std::abs(a * d));
    }
    EXPECT_GT(mode.damping_ratio, 0.0);
  }
  EXPECT_NE(modes.vibrations[0].roots[0], modes.vibrations[1].roots[0]);
}

TEST(Modes, TorsionDamperTakesFromARelativeTurn) {
  Scene scene = pendulum(-1.5);
  scene.elements.push_back(test::torsion_damper("joint", 0, 1, 0.3));
  const Vibration mode = modes_at_equilibrium(scene).vibrations.at(0);
  EXPECT_NEAR(mode.growth, -0.3 / (2 * (0.2 + 3.0 * 0.4 * 0.4)), 1e-13);
}

TEST(Modes, FreeBlockIsNeutral) {
  Scene scene = spring_mass_chain(2, 1.0, 20.0);
  scene.elements.erase(scene.elements.begin());  // the pair may drift, and swings against itself
  const Modes modes = modes_at_equilibrium(scene);
  ASSERT_EQ(modes.vibrations.size(), 2u);
  EXPECT_EQ(modes.vibrations[0].kind, Kind::neutral);
  EXPECT_EQ(modes.vibrations[0].frequency, 0.0);
  EXPECT_EQ(modes.vibrations[1].kind, Kind::oscillates);
  EXPECT_NEAR(modes.vibrations[1].frequency, std::sqrt(2 * 20.0) / (2 * M_PI), 1e-13);
}

TEST(Modes, MasslessBlockFollowsItsSprings) {
  Scene scene = spring_mass_chain(2, 3.0, 40.0);
  scene.bodies[1].mass = 0.0;  // two springs in series hold the second block
  const Modes modes = modes_at_equilibrium(scene);
  ASSERT_TRUE(modes.known) << modes.why;
  EXPECT_EQ(modes.massless, 1);
  ASSERT_EQ(modes.vibrations.size(), 1u);
  EXPECT_NEAR(modes.vibrations[0].frequency, std::sqrt(20.0 / 3.0) / (2 * M_PI), 1e-13);
  EXPECT_NEAR((modes.vibrations[0].shape[0] / modes.vibrations[0].shape[1]).real(), 0.5, 1e-13);
  add_damper(scene, "ground.O", "1.c", 1.0);
  const Modes damped = modes_at_equilibrium(scene);
  EXPECT_FALSE(damped.known);
  EXPECT_NE(damped.why.find("\"x1\" is damped but has no inertia"), std::string::npos) << damped.why;
}

// Two massless blocks with a spring between them and none to anything else.
TEST(Modes, SayWhatNeitherInertiaNorStiffnessHolds) {
  Scene scene = spring_mass_chain(3, 3.0, 40.0);
  scene.bodies[2].mass = scene.bodies[3].mass = 0.0;
  scene.elements.erase(scene.elements.begin() + 1);
  const Modes modes = modes_at_equilibrium(scene);
  EXPECT_FALSE(modes.known);
  EXPECT_NE(modes.why.find("has neither inertia nor stiffness"), std::string::npos) << modes.why;
}

TEST(Modes, SayWhereNothingHasInertia) {
  const Modes modes = modes_at_equilibrium(spring_mass_chain(1, 0.0, 5.0));
  EXPECT_FALSE(modes.known);
  EXPECT_NE(modes.why.find("has inertia"), std::string::npos) << modes.why;
}

// Ziegler's column: two rods of length l, point masses 2m and m at their ends, springs k in the joints, a load P that
// follows the second rod. It flutters where (P l / k) exceeds 7/2 - sqrt 2.
Scene ziegler(double load) {
  Scene scene = test::chain(2, 1.0, 1.0);
  scene.gravity = {};
  for (int i = 1; i <= 2; ++i) {
    scene.bodies[static_cast<std::size_t>(i)].center = {1, 0};
    scene.bodies[static_cast<std::size_t>(i)].inertia = 0.0;
    scene.bodies[static_cast<std::size_t>(i)].mass = i == 1 ? 2.0 : 1.0;
    scene.start.angle[static_cast<std::size_t>(i)] = 0.0;
    test::add_torsion_spring(scene, i - 1, i, 1.0);
  }
  test::add_force(scene, "2.b", {-load, 0}, "P");
  scene.forces.back().follows = 2;
  return scene;
}

TEST(Modes, FollowerLoadFluttersBeyondZieglersLoad) {
  const double critical = 3.5 - std::sqrt(2.0);
  const Modes before = modes_at_equilibrium(ziegler(critical - 1e-6));
  ASSERT_EQ(before.vibrations.size(), 2u);
  for (const Vibration& mode : before.vibrations) EXPECT_EQ(mode.kind, Kind::oscillates);
  const Modes beyond = modes_at_equilibrium(ziegler(critical + 1e-6));
  ASSERT_EQ(beyond.vibrations.size(), 2u);
  EXPECT_EQ(beyond.vibrations[0].kind, Kind::flutters);
  EXPECT_GT(beyond.vibrations[0].growth, 1e-4);
  // s^4 + (7/2 - P) s^2 + 1/2 = 0
  const Modes light = modes_at_equilibrium(ziegler(1.0));
  for (const Vibration& mode : light.vibrations) {
    const double square = std::pow(2 * M_PI * mode.frequency, 2);
    EXPECT_NEAR(square * square - 2.5 * square + 0.5, 0.0, 1e-12);
  }
}

// The famous paradox: a little damping in the joints brings flutter at a lower load (here both equal: P about 1.464).
TEST(Modes, LittleDampingLowersZieglersLoad) {
  const auto damped = [](double load) {
    Scene scene = ziegler(load);
    for (int i = 1; i <= 2; ++i)
      scene.elements.push_back(test::torsion_damper(std::string("c").append(std::to_string(i)), i - 1, i, 1e-3));
    return modes_at_equilibrium(scene);
  };
  EXPECT_EQ(damped(41.0 / 28 - 1e-3).vibrations[0].kind, Kind::oscillates);
  EXPECT_EQ(damped(41.0 / 28 + 1e-3).vibrations[0].kind, Kind::flutters);
}

TEST(Modes, PressingStopHolds) {
  Scene scene = spring_mass_chain(2, 1.0, 20.0);
  Stop stop;
  stop.on = Measure::travel_of(1);
  stop.name = "wall";
  stop.max = 1.5;
  scene.stops.push_back(stop);
  scene.start.travel[0] = 0.9;
  scene.start.travel[1] = 1.4;
  const Modes modes = modes_at_equilibrium(scene);
  ASSERT_TRUE(modes.known) << modes.why;
  ASSERT_EQ(modes.stops.size(), 1U);
  EXPECT_TRUE(modes.stops[0].at_max);
  EXPECT_NEAR(modes.stops[0].force, 20.0 * 0.25, 1e-12) << "of the second spring, which is 0.75 long";
  EXPECT_TRUE(modes.just_touched.empty());
  ASSERT_EQ(modes.vibrations.size(), 1u);
  EXPECT_NEAR(modes.vibrations[0].frequency, std::sqrt(40.0) / (2 * M_PI), 1e-12);
}

// A wall where the block rests anyway: it carries nothing, and the block is free on one side of it.
TEST(Modes, AStopThatOnlyTouchesDoesNotHold) {
  Scene scene = spring_mass_chain(2, 1.0, 20.0);
  Stop stop;
  stop.on = Measure::travel_of(1);
  stop.name = "wall";
  stop.max = 2.0;
  scene.stops.push_back(stop);
  const Modes modes = modes_at_equilibrium(scene);
  ASSERT_TRUE(modes.known) << modes.why;
  EXPECT_TRUE(modes.stops.empty());
  ASSERT_EQ(modes.just_touched.size(), 1U);
  EXPECT_EQ(modes.just_touched[0].force, 0.0);
  EXPECT_TRUE(modes.just_touched[0].at_max);
  ASSERT_EQ(modes.vibrations.size(), 2U);
  EXPECT_NEAR(modes.vibrations[0].frequency, std::sqrt(20.0) * (std::sqrt(5.0) - 1) / 2 / (2 * M_PI), 1e-12);
}

TEST(Modes, DoNotDependOnScales) {
  Scene scene = read_scene(test::dataset("lift.toml"));
  const StaticModel statics(scene);
  const Equilibrium equilibrium = solve(statics);
  const MotionModel motion(scene);
  const MotionModel other(scene, {motion.scales().length / 16, motion.scales().force * 32});
  const Vibration a = modes_of(motion, motion_coordinates(motion, statics, equilibrium.x)).vibrations.at(0);
  const Vibration b = modes_of(other, motion_coordinates(other, statics, equilibrium.x)).vibrations.at(0);
  EXPECT_NEAR(a.frequency, b.frequency, 1e-12 * a.frequency);
  EXPECT_NEAR(a.damping_ratio, b.damping_ratio, 1e-12 * a.damping_ratio);
  for (std::size_t i = 0; i < a.shape.size(); ++i) EXPECT_NEAR(std::abs(a.shape[i] - b.shape[i]), 0.0, 1e-13);
}

// datasets/lift_dynamics.json: reduced inertia and stiffness per rad^2 of obd, frequency and damping ratio.
TEST(Modes, LiftSwingsAsItsReducedEquationSays) {
  const json answers = test::read_json(test::dataset("lift_dynamics.json"));
  ASSERT_EQ(answers.at("entries").size(), 15u);
  for (const json& known : answers.at("entries")) {
    SCOPED_TRACE(known.dump());
    Scene scene = read_scene(test::dataset("lift.toml"));
    set_value(scene, "body.payload.mass", known.at("payload"));
    auto& spring = test::law<LinearSpring>(scene, "spring");
    spring.free_length = known.at("l").get<double>() + known.at("cyl_force_N").get<double>() / spring.stiffness;
    const double q = known.at("q");
    const KinematicSample at = sweep(scene, {{"obd", q, q}}).samples.front();
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) scene.start.angle[i] = at.bodies[i].pose.angle;
    const StaticModel statics(scene);
    const MotionModel motion(scene);
    const Equilibrium equilibrium = solve(statics);
    ASSERT_TRUE(equilibrium.found());
    EXPECT_NEAR(test::angle_of(statics, equilibrium.x, "obd"), q, 1e-9);
    const Modes modes = modes_of(motion, motion_coordinates(motion, statics, equilibrium.x));
    ASSERT_EQ(modes.vibrations.size(), 1u);
    const Vibration& swing = modes.vibrations[0];
    const double omega = 2 * M_PI * swing.frequency;
    const auto& coordinates = motion.layout().coordinates;
    const auto obd =
        std::find_if(coordinates.begin(), coordinates.end(), [](const Coordinate& c) { return c.name == "obd"; });
    const double part = swing.shape[static_cast<std::size_t>(obd - coordinates.begin())].real();
    const auto expect = [&](const char* name, double value) {
      const double exact = known.at(name);
      EXPECT_NEAR(value, exact, 5e-11 * std::abs(exact)) << name;
    };
    expect("M", 1 / (part * part));
    expect("V2", omega * omega / (part * part));
    expect("omega", omega);
    expect("f_Hz", swing.frequency);
    expect("zeta", swing.damping_ratio);
  }
}

}  // namespace
}  // namespace poise::modes_test

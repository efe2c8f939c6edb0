#include "identification/experiment/scene_parameter.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "motion/simulate.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/moving_scenes.hpp"

namespace poise::scene_parameter_test {
namespace {

// All numbers of the four-bar with one of everything.
std::vector<std::string> all_paths(const Scene& scene) {
  std::vector<std::string> paths;
  for (const char* body : {"crank", "coupler", "rocker"}) {
    for (const char* part : {"mass", "inertia", "center.x", "center.y"}) {
      paths.push_back("body." + std::string(body) + "." + part);
    }
  }
  paths.push_back("spring." + test::element(scene, "spring").name + ".stiffness");
  paths.push_back("spring." + test::element(scene, "spring").name + ".free_length");
  paths.push_back("torsion_spring." + test::element(scene, "torsion_spring").name + ".stiffness");
  paths.push_back("torsion_spring." + test::element(scene, "torsion_spring").name + ".free_angle");
  paths.push_back("damper." + test::element(scene, "damper").name + ".coefficient");
  paths.push_back("torsion_damper." + test::element(scene, "torsion_damper").name + ".coefficient");
  paths.push_back("friction." + test::element(scene, "friction").name + ".torque");
  paths.push_back("friction." + test::element(scene, "friction").name + ".width");
  paths.push_back("load.F");
  paths.push_back("load.T");
  return paths;
}

// The same numbers as --set, whose scene is in SI here.
TEST(SceneParameter, IsWhatItsPathReports) {
  const Scene scene = test::four_bar_with_everything();
  for (const std::string& path : all_paths(scene)) {
    const auto number = SceneParameter::find(scene, path);
    ASSERT_TRUE(number) << path;
    EXPECT_EQ(number->path(), path);
    EXPECT_DOUBLE_EQ(number->get(scene), get_value(scene, path)) << path;
    Scene changed = scene;
    number->set(changed, 0.37);
    EXPECT_NEAR(get_value(changed, path), 0.37, 1e-15) << path;
    EXPECT_NEAR(number->get(changed), 0.37, 1e-15) << path;
  }
}

TEST(SceneParameter, IsNoneWhereMotionDoesNotDependOnIt) {
  const Scene scene = test::four_bar_with_everything();
  for (const char* path : {"start.crank", "body.crank", "body.nobody.mass", "body.ground.mass",
                           "friction.ground-crank.width", "load.G", ""}) {
    EXPECT_FALSE(SceneParameter::find(scene, path)) << path;
  }
}

TEST(SceneParameter, MayBeAPointOrGravityOrANumberOfADrive) {
  const Scene scene = test::driven_five_bar();
  for (const char* path : {"point.crank.B.x", "point.ground.A.y", "slide.track.angle", "gravity.y"}) {
    const auto number = SceneParameter::find(scene, path);
    ASSERT_TRUE(number) << path;
    EXPECT_TRUE(number->is_geometric()) << path;
    EXPECT_EQ(number->get(scene), get_value(scene, path)) << path;
  }
  const auto rate = SceneParameter::find(scene, "drive.motor.rate");
  ASSERT_TRUE(rate);
  EXPECT_FALSE(rate->is_geometric());
  // This drive starts from the assembled pose.
  EXPECT_FALSE(SceneParameter::find(scene, "drive.motor.start"));
}

TEST(SceneParameter, ALumpBesideOtherMassesMayBeNegative) {
  Scene scene = test::four_bar_with_everything();
  const auto number = SceneParameter::find(scene, "body.coupler.mass");
  ASSERT_TRUE(number);
  number->set(scene, -0.5);
  EXPECT_EQ(scene.bodies[2].mass, -0.5);
}

// Searches try numbers that the scene may not have: they are to be turned back and not to end the fit.
TEST(SceneParameter, ExponentsAndRatiosOfOneAreNotAllowed) {
  const Scene scene = parse_scene(R"(
ground.points = { O = [0, 0], T = [0, 3] }
body.b = { mass = 1, points = { O = [0, 0] } }
slide = [{ name = "s", points = ["ground.O", "b.O"], axis = [1, 0] }]
spring = [{ name = "g", points = ["ground.T", "b.O"], gas = { preload = 1, length = 4, stroke = 2, ratio = 1.5 } }]
bump_stop = [{ name = "rubber", slide = "s", force = 1, free_length = 0, depth = 0.1 }]
)",
                                  "scene.toml");
  for (const char* path : {"bump_stop.rubber.exponent", "spring.g.gas.ratio"}) {
    const auto number = SceneParameter::find(scene, path);
    ASSERT_TRUE(number) << path;
    EXPECT_FALSE(number->allows(scene, 1.0)) << path;
    EXPECT_FALSE(number->allows(scene, -1.0)) << path;
    EXPECT_TRUE(number->allows(scene, 1.1)) << path;
  }
}

TEST(SceneParameter, TurningALoadRoundKeepsItsLine) {
  Scene scene = test::four_bar_with_everything();
  const Vec2 before = scene.forces[0].vector;
  const auto number = SceneParameter::find(scene, "load.F");
  ASSERT_TRUE(number);
  number->set(scene, 2 * number->get(scene));
  EXPECT_NEAR(norm(scene.forces[0].vector - 2 * before), 0.0, 1e-15);
}

// Masses, inertias, stiffnesses, damping, friction and loads times one factor: the same motion.
TEST(SceneParameter, ThoseThatScaleWithForceLeaveMotionAlone) {
  const Scene scene = test::four_bar_with_everything();
  Scene other = scene;
  int scaled_up = 0;
  for (const std::string& path : all_paths(scene)) {
    const auto number = SceneParameter::find(scene, path);
    ASSERT_TRUE(number);
    if (!number->scales_with_force()) continue;
    number->set(other, 1.7 * number->get(scene));
    ++scaled_up;
  }
  EXPECT_EQ(scaled_up, 13);
  const auto end_of = [](const Scene& given) {
    const MotionModel model(given);
    const Motion motion = simulate(model, start_motion(model, {}), {});
    EXPECT_TRUE(motion.completed()) << motion.why;
    return std::vector<double>(motion.trajectory.q.end() - motion.trajectory.coordinates, motion.trajectory.q.end());
  };
  const std::vector<double> a = end_of(scene), b = end_of(other);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-9);
}

}  // namespace
}  // namespace poise::scene_parameter_test

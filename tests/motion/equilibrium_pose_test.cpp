#include "motion/equilibrium_pose.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::equilibrium_pose_test {
namespace {

// A crank with an offset load, and a balanced wheel on it that matters in motion only.
Scene crank_with_wheel() {
  Scene scene;
  scene.gravity = {0, -9.81};
  scene.bodies[0].points.push_back({"O", {0, 0}});
  test::add_link(scene, "crank", 3.0, 2.0);
  scene.bodies[1].center = {1.5, 0};
  scene.bodies[1].inertia = 1.5;
  test::add_link(scene, "wheel", 0.2, 400.0);
  scene.bodies[2].center = {0, 0};
  scene.bodies[2].inertia = 0.7;
  test::add_pin(scene, "ground.O", "crank.a");
  test::add_pin(scene, "crank.b", "wheel.a");
  scene.start.angle[1] = -1.0;
  scene.start.angle[2] = 2.5;
  return scene;
}

TEST(EquilibriumPose, KeepsWhatStaticsDroppedAtItsStart) {
  const StaticModel statics(crank_with_wheel());
  const MotionModel motion(crank_with_wheel());
  ASSERT_LT(statics.mechanism().coordinates(), motion.mechanism().coordinates());
  const Equilibrium equilibrium = solve(statics);
  ASSERT_TRUE(equilibrium.found());
  const std::vector<BodyPose<double>> poses = motion.poses(motion_coordinates(motion, statics, equilibrium.x));
  EXPECT_NEAR(poses[1].angle, -M_PI / 2, 1e-12);
  EXPECT_EQ(poses[2].angle, 2.5);
}

TEST(EquilibriumPose, GoesThroughSiWhereScalesDiffer) {
  const Scene scene = read_scene(test::dataset("lift.toml"));
  const StaticModel statics(scene);
  const MotionModel motion(scene, {8.0 * statics.scales().length, 4.0 * statics.scales().force});
  const Equilibrium equilibrium = solve(statics);
  ASSERT_TRUE(equilibrium.found());
  const auto expected = statics.poses(equilibrium.x);
  const auto poses = motion.poses(motion_coordinates(motion, statics, equilibrium.x));
  ASSERT_EQ(poses.size(), expected.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(poses[i].angle, expected[i].angle, 1e-13) << scene.bodies[i].name;
    EXPECT_NEAR(norm(poses[i].origin - expected[i].origin), 0.0, 1e-13) << scene.bodies[i].name;
  }
}

TEST(EquilibriumPose, ClosesLoopsThatStandOpen) {
  const Scene scene = read_scene(test::dataset("lift.toml"));
  const StaticModel statics(scene);
  const MotionModel motion(scene);
  const auto open = test::perturbed(assemble(statics), 1e-4, 3);
  const std::vector<double> x = motion_coordinates(motion, statics, open);
  std::vector<Planar<double>> pose(motion.mechanism().pose_size());
  std::vector<double> gaps(motion.mechanism().constraints());
  motion.mechanism().place(x.data(), pose.data());
  motion.mechanism().constraint(x.data(), pose.data(), gaps.data());
  for (double gap : gaps) EXPECT_NEAR(gap, 0.0, 1e-14);
}

}  // namespace
}  // namespace poise::equilibrium_pose_test

#include "motion/forces_along.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "motion/force_courses.hpp"
#include "tests/support/build_scene.hpp"

namespace poise::forces_along_test {
namespace {

constexpr double crank = 0.1, rod = 0.3, torque = 2.0, push = 5.0;

double reach(double theta) { return std::sqrt(rod * rod - std::pow(crank * std::sin(theta), 2)); }
double travel(double theta) { return crank * std::cos(theta) + reach(theta); }
/// d travel / d theta.
double lever(double theta) { return -crank * std::sin(theta) * (1 + crank * std::cos(theta) / reach(theta)); }

/// A crank on ground.O = (0, 0), its rod and a block on the rail y = 0, which drives it. A torque acts on the crank, a
/// force along the rail on the block.
Scene slider_crank(double theta, double on_crank, double on_block) {
  Scene scene;
  scene.add_point(0, "O", {0.0, 0.0});
  const int arm = test::add_link(scene, "crank", crank);
  const int bar = test::add_link(scene, "rod", rod);
  test::add_link(scene, "block", 0.02);
  test::add_pin(scene, "ground.O", "crank.a", "O");
  test::add_pin(scene, "crank.b", "rod.a", "B");
  test::add_pin(scene, "rod.b", "block.a", "C");
  const int rail = test::add_slide(scene, "ground.O", "block.a", {1.0, 0.0}, "rail");
  scene.torques.push_back({"M", arm, on_crank});
  test::add_force(scene, "block.a", {on_block, 0.0}, "P");
  scene.drives.push_back(find_drive(scene, "rail"));
  scene.start.angle[static_cast<std::size_t>(arm)] = theta;
  scene.start.angle[static_cast<std::size_t>(bar)] = -std::asin(crank / rod * std::sin(theta));
  scene.start.travel[static_cast<std::size_t>(rail)] = travel(theta);
  return scene;
}

const ForceCourse& course(const std::vector<ForceCourse>& courses, const std::string& name) {
  return *std::find_if(courses.begin(), courses.end(), [&](const ForceCourse& c) { return c.name == name; });
}

// The effort F of the drive does the work that the load needs:  (F + P) d travel + M d theta = 0.
TEST(ForcesAlong, FindTheDeadPointAtWhichARangeEnds) {
  const MotionModel model(slider_crank(1.0, torque, push));
  const ForcesAlong found = forces_over(model, {{"rail", 0.3, 0.45}}, {.steps = 30}, false);
  EXPECT_FALSE(found.complete);
  EXPECT_TRUE(found.balanced());
  ASSERT_EQ(found.dead_points.size(), 1U);
  EXPECT_NEAR(found.dead_points[0][0], crank + rod, 1e-12) << "crank and rod in line";
  ASSERT_EQ(found.at.size(), 20U) << "0.3 .. 0.395";
  const std::vector<ForceCourse> courses = force_courses(model.scene(), found);
  const std::vector<double>& effort = course(courses, "effort.rail").value;
  for (std::size_t k = 0; k < found.at.size(); ++k) {
    const double s = found.at[k];
    const double theta = std::acos((s * s + crank * crank - rod * rod) / (2 * s * crank));
    EXPECT_NEAR(effort[k], -push - torque / lever(theta), 1e-9 * std::abs(effort[k])) << s;
    if (k > 10) {
      EXPECT_GT(effort[k], effort[k - 1]) << "it grows towards the dead point";
    }
  }
}

TEST(ForcesAlong, FindTheDeadPointOfASinglePose) {
  for (const double theta : {0.0, M_PI}) {
    const ForcesAlong found = forces_in_place(MotionModel(slider_crank(theta, torque, push)));
    EXPECT_FALSE(found.balanced());
    ASSERT_EQ(found.dead_points.size(), 1U);
    EXPECT_NEAR(found.dead_points[0][0], travel(theta), 1e-14);
  }
  const ForcesAlong near = forces_in_place(MotionModel(slider_crank(0.01, torque, push)));
  EXPECT_TRUE(near.balanced());
  EXPECT_TRUE(near.dead_points.empty());
  EXPECT_NEAR(near.poses[0].drives[0].value, -push - torque / lever(0.01), 1e-8);
}

// A load that the crank need not take is held at the dead centre too.
TEST(ForcesAlong, ADeadCentreWithoutLoadOnTheCrankIsNoDeadPoint) {
  const MotionModel model(slider_crank(1.0, 0.0, push));
  const ForcesAlong found = forces_over(model, {{"rail", 0.3, 0.45}}, {.steps = 30}, false);
  EXPECT_FALSE(found.complete);
  EXPECT_TRUE(found.dead_points.empty());
  EXPECT_TRUE(forces_in_place(MotionModel(slider_crank(0.0, 0.0, push))).dead_points.empty());
}

TEST(ForcesAlong, TooFewDrivesAreNoDeadPoint) {
  Scene scene = slider_crank(1.0, torque, push);
  scene.drives.clear();
  const ForcesAlong found = forces_in_place(MotionModel(scene));
  EXPECT_FALSE(found.balanced());
  EXPECT_TRUE(found.dead_points.empty());
}

// A parallelogram passes the pose in which it is flat: two motions cross there, and its crank decides neither.
TEST(ForcesAlong, FindADeadPointThatIsPassed) {
  Scene scene;
  scene.add_point(0, "A", {0.0, 0.0});
  scene.add_point(0, "D", {1.0, 0.0});
  const int left = test::add_link(scene, "left", 0.4);
  const int top = test::add_link(scene, "top", 1.0);
  const int right = test::add_link(scene, "right", 0.4);
  test::add_pin(scene, "ground.A", "left.a");
  test::add_pin(scene, "left.b", "top.a");
  test::add_pin(scene, "top.b", "right.b");
  test::add_pin(scene, "ground.D", "right.a");
  scene.torques.push_back({"M", right, torque});
  scene.drives.push_back(find_drive(scene, "left"));
  scene.start.angle[static_cast<std::size_t>(left)] = 1.0;
  scene.start.angle[static_cast<std::size_t>(top)] = 0.0;
  scene.start.angle[static_cast<std::size_t>(right)] = 1.0;
  const MotionModel model(scene);
  const ForcesAlong found = forces_over(model, {{"left", 1.0, 5.0}}, {.steps = 10}, false);
  EXPECT_TRUE(found.complete);
  EXPECT_TRUE(found.balanced());
  for (const Forces& pose : found.poses) EXPECT_NEAR(pose.drives[0].value, -torque, 1e-9);
  ASSERT_EQ(found.dead_points.size(), 1U);
  EXPECT_NEAR(found.dead_points[0][0], M_PI, 1e-8);
}

}  // namespace
}  // namespace poise::forces_along_test

// Stability under follower loads, along load paths.

#include "motion/dynamic_stability.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "statics/paths/path.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::dynamic_stability_test {
namespace {

// Ziegler's column, masses 2 and 1: flutter above P l / k = 7/2 - sqrt 2.
TEST(DynamicStability, TellsFlutterAlongALoadPath) {
  const Scene scene = read_scene(test::dataset("hard/ziegler.toml"));
  const VariedScene varied(scene, "load.P", 0.5, 4.0);
  const Path judged = path(varied, {.dynamic_stability = dynamic_stability});
  ASSERT_EQ(judged.status, Path::Status::traced) << judged.why;
  ASSERT_GT(judged.branches.at(0).points.size(), 50U);
  const double flutter = 3.5 - std::sqrt(2.0);
  for (const PathPoint& point : judged.branches[0].points) {
    if (std::abs(point.parameter - flutter) < 1e-3) continue;
    EXPECT_EQ(point.stability, point.parameter < flutter ? Stability::stable : Stability::unstable) << point.parameter;
  }
  ASSERT_EQ(judged.events.size(), 1U);
  EXPECT_EQ(judged.events[0].kind, PathEvent::Kind::flutter);
  EXPECT_NEAR(judged.events[0].at.parameter, flutter, 1e-7);
  // Without the masses' part nothing can be said.
  const Path plain = path(varied);
  for (const PathPoint& point : plain.branches.at(0).points) EXPECT_EQ(point.stability, Stability::unknown);
}

TEST(DynamicStability, IsUnknownWithoutInertia) {
  Scene scene = read_scene(test::dataset("hard/ziegler.toml"));
  for (Body& body : scene.bodies) body.mass = 0.0;
  const StaticModel model(scene);
  EXPECT_EQ(dynamic_stability(model, {0.0, 0.0}), Stability::unknown);
}

}  // namespace
}  // namespace poise::dynamic_stability_test

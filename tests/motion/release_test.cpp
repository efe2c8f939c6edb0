#include "motion/release.hpp"

#include <gtest/gtest.h>

#include "motion/confirmed_motion.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"

namespace poise::release_test {
namespace {

constexpr double mass = 2.0, stiffness = 200.0, hanging = 0.05;

/// A block of 2 kg on the rail x = 0, pulled down by its weight on a spring of 200 N/m that is 50 mm long when slack.
Scene block_on_spring() {
  Scene scene;
  scene.gravity = {0.0, -9.81};
  scene.add_point(0, "O", {0.0, 0.0});
  const int block = test::add_link(scene, "block", 0.1, mass);
  scene.bodies[static_cast<std::size_t>(block)].center = {0.0, 0.0};
  const int rail = test::add_slide(scene, "ground.O", "block.a", {0.0, -1.0}, "rail");
  scene.elements.push_back(
      test::line_spring("S", test::point(scene, "ground.O"), test::point(scene, "block.a"), stiffness, hanging));
  scene.start.travel[static_cast<std::size_t>(rail)] = 0.1;
  return scene;
}

double value(const std::vector<double>& q, const Channel& channel) {
  return q[static_cast<std::size_t>(channel.coordinate)] + channel.offset;
}

TEST(Release, DisplacesFromTheEquilibrium) {
  const MotionModel model(block_on_spring());
  const MotionOrigin origin = equilibrium_origin(model);
  ASSERT_EQ(origin.kind, MotionOrigin::Kind::equilibrium);
  EXPECT_EQ(origin.stability, Stability::stable);
  const Channel rail = channel_named("test", "rail", channels_of(model));
  EXPECT_EQ(rail.quantity, Quantity::length);
  const double equilibrium = hanging + mass * 9.81 / stiffness;
  EXPECT_NEAR(value(*origin.q, rail), equilibrium, 1e-12);
  const MotionState still = release(model, origin, {});
  EXPECT_NEAR(value(still.q, rail), equilibrium, 1e-12);
  const MotionState moved = release(model, origin, {{rail, false, 0.02}, {rail, true, -0.3}});
  EXPECT_NEAR(value(moved.q, rail), equilibrium + 0.02, 1e-12);
  EXPECT_NEAR(value(moved.v, rail), -0.3, 1e-12);
  const MotionState assembled = release(model, {}, {{rail, false, 0.02}});
  EXPECT_NEAR(value(assembled.q, rail), 0.12, 1e-12) << "counted from the start of the scene";
}

TEST(Release, SaysThatThereIsNoEquilibrium) {
  Scene scene = block_on_spring();
  scene.elements.clear();
  const MotionOrigin origin = equilibrium_origin(MotionModel(scene));
  EXPECT_FALSE(origin.found());
  EXPECT_FALSE(origin.why.empty());
  scene.gravity = {};
  EXPECT_EQ(equilibrium_origin(MotionModel(scene)).kind, MotionOrigin::Kind::unloaded);
}

TEST(ChannelNamed, NamesTheNearest) {
  const MotionModel model(block_on_spring());
  try {
    channel_named("test", "rial", channels_of(model));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "test: nothing that moves is called \"rial\"; expected a body that turns or a joint that slides; "
                 "did you mean \"rail\"?");
  }
}

TEST(ConfirmedMotion, EstimatesItsErrorByAStricterRun) {
  const MotionModel model(block_on_spring());
  const Channel rail = channel_named("test", "rail", channels_of(model));
  const MotionOrigin origin = equilibrium_origin(model);
  const MotionState start = release(model, origin, {{rail, false, 0.02}});
  MotionOptions options;
  options.duration = 1.0;
  options.accuracy = 1e-9;
  double last = 0.0;
  const ConfirmedMotion found = simulate_and_confirm(model, start, options, [&](double t) { last = t; });
  EXPECT_TRUE(found.confirmed());
  ASSERT_TRUE(found.error);
  EXPECT_LT(*found.error, 1e-7);
  EXPECT_EQ(last, 1.0) << "the second run reports how far it came";
  const MotionRecord read = record(model, found.motion, 100.0);
  ASSERT_EQ(read.time.size(), 101U);
  const double omega = std::sqrt(stiffness / mass);
  for (std::size_t k = 0; k < read.time.size(); ++k) {
    EXPECT_NEAR(read.value[0][k] - value(*origin.q, rail), 0.02 * std::cos(omega * read.time[k]), 1e-9);
  }
  options.most_steps = found.motion.steps + found.motion.rejected + 1;
  const ConfirmedMotion unchecked = simulate_and_confirm(model, start, options);
  EXPECT_TRUE(unchecked.motion.completed());
  EXPECT_FALSE(unchecked.error);
  EXPECT_NE(unchecked.why_unknown.find(" steps reached only t = "), std::string::npos) << unchecked.why_unknown;
  options.most_steps = 3;
  EXPECT_FALSE(simulate_and_confirm(model, start, options).error) << "it did not complete";
}

}  // namespace
}  // namespace poise::release_test

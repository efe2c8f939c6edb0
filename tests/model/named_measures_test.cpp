// Measures by their names.

#include "model/named_measures.hpp"

#include <string>

#include <gtest/gtest.h>

#include "model/read_scene.hpp"

namespace poise::named_measures_test {
namespace {

// Bodies whose names begin alike and hold dots.
Scene arms() {
  return parse_scene(R"(
title = "arms"
source = "ours"
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], A = [1, 0] }
[body."arm.2"]
points = { A = [0, 0], B = [1, 0] }
[[pin]]
points = ["ground.O", "arm.O"]
[[pin]]
points = ["arm.A", "arm.2.A"]
[[spring]]
name = "coil"
bodies = ["arm", "arm.2"]
stiffness = 1
free_angle = 0
[[damper]]
name = "coil"
points = ["ground.O", "arm.2.B"]
coefficient = 1
)",
                     "arms.toml");
}

TEST(NamedMeasures, AllHaveTheirNames) {
  const Scene scene = arms();
  for (const NamedMeasure& one : named_measures(scene)) {
    const auto found = find_measure(scene, one.name);
    ASSERT_TRUE(found) << one.name;
    EXPECT_EQ(found->words, one.words);
  }
}

TEST(NamedMeasures, SayWhichAngleTheyAre) {
  const Scene scene = arms();
  EXPECT_EQ(find_measure(scene, "angle.arm.2")->words, "angle of arm.2 in the world");
  EXPECT_EQ(find_measure(scene, "arm.2")->name, "angle.arm.2");
  const auto relative = find_measure(scene, "angle.arm.2.arm");
  ASSERT_TRUE(relative);
  EXPECT_EQ(relative->words, "angle of arm.2 relative to arm");
  EXPECT_EQ(relative->on.body_a, 1);
  EXPECT_EQ(relative->on.body_b, 2);
  EXPECT_EQ(find_measure(scene, "angle.arm.arm.2")->on.body_a, 2);
  EXPECT_FALSE(find_measure(scene, "angle.arm.arm"));
  EXPECT_EQ(find_measure(scene, "length.spring.coil")->words, "angle of spring.coil");
  EXPECT_EQ(find_measure(scene, "length.damper.coil")->words, "length of damper.coil");
  EXPECT_FALSE(find_measure(scene, "length.coil"));
}

TEST(NamedMeasures, OfPointsHaveADirectionInDegrees) {
  const Scene scene = arms();
  const auto along = find_measure(scene, "along.arm.2.B.-270");
  ASSERT_TRUE(along);
  EXPECT_EQ(along->words, "place of arm.2.B along -270 degrees from x");
  EXPECT_EQ(along->on.terms[0].factor, 0.0);  // exact
  EXPECT_EQ(along->on.terms[1].factor, 1.0);
  EXPECT_FALSE(find_measure(scene, "along.arm.2.B.nan"));
  EXPECT_FALSE(find_measure(scene, "along.arm.2.B."));
  EXPECT_FALSE(find_measure(scene, "along.arm.2.B"));
}

TEST(NamedMeasures, ThatDoNotExistHaveNearOnes) {
  const Scene scene = arms();
  EXPECT_EQ(why_no_measure(scene, "angle.amr"), "expected the name of a body; did you mean \"arm\"?");
  EXPECT_EQ(why_no_measure(scene, "load.P"), "");
}

}  // namespace
}  // namespace poise::named_measures_test

#include <cmath>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "model/scene.hpp"
#include "model/scene_builder.hpp"

namespace poise::joint_friction_test {
namespace {

const char* const text = R"(
[units]
length = "mm"
[numbers]
mu = 0.2
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], A = [10, 0] }
[body.block]
points = { A = [0, 0] }
[[pin]]
name = "O"
points = ["ground.O", "arm.O"]
friction = { radius = 8, coefficient = "mu / 2", torque = 5 }
[[slide]]
name = "guide"
points = ["arm.A", "block.A"]
axis = [1, 0]
friction = { coefficient = "mu", length = 60, force = 3 }
)";

TEST(JointFriction, IsReadInTheUnitsOfTheScene) {
  const Scene scene = parse_scene(text, "test");
  const JointFriction& pin = *scene.joints[0].friction;
  EXPECT_DOUBLE_EQ(pin.radius, 0.008);
  EXPECT_DOUBLE_EQ(pin.coefficient, 0.1);
  EXPECT_DOUBLE_EQ(pin.torque, 0.005);
  EXPECT_DOUBLE_EQ(pin.circle(), 0.008 * std::sin(std::atan(0.1)));
  const JointFriction& slide = *scene.joints[1].friction;
  EXPECT_DOUBLE_EQ(slide.coefficient, 0.2);
  EXPECT_DOUBLE_EQ(slide.length, 0.06);
  EXPECT_DOUBLE_EQ(slide.force, 3.0);
}

TEST(JointFriction, IsAmongTheNumbers) {
  Scene scene = parse_scene(text, "test");
  set_value(scene, "numbers.mu", 0.4);
  EXPECT_DOUBLE_EQ(get_value(scene, "pin.O.friction.coefficient"), 0.2);
  EXPECT_DOUBLE_EQ(get_value(scene, "slide.guide.friction.coefficient"), 0.4);
  set_value(scene, "pin.O.friction.radius", 4.0);
  EXPECT_DOUBLE_EQ(scene.joints[0].friction->radius, 0.004);
  EXPECT_THROW(set_value(scene, "pin.O.friction.radius", -1.0), InputError);
  EXPECT_THROW(set_value(scene, "pin.O.friction.coefficient", 0.3), InputError);  // an expression
  EXPECT_DOUBLE_EQ(get_value(scene, "slide.guide.angle"), 0.0);
  const Scene scaled_scene = scaled(scene, Scales{.length = 0.5, .force = 4.0});
  EXPECT_DOUBLE_EQ(scaled_scene.joints[0].friction->radius, 0.008);
  EXPECT_DOUBLE_EQ(scaled_scene.joints[0].friction->coefficient, 0.2);
}

TEST(JointFriction, IsWrittenBack) {
  Scene scene = parse_scene(text, "test");
  set_value(scene, "pin.O.friction.radius", 4.0);
  set_value(scene, "slide.guide.friction.force", 7.0);
  const Scene back = parse_scene(rewritten_scene(text, "test", scene), "test");
  EXPECT_DOUBLE_EQ(back.joints[0].friction->radius, 0.004);
  EXPECT_DOUBLE_EQ(back.joints[1].friction->force, 7.0);
}

void expect_refused(const std::string& joint, const std::string& message) {
  const std::string scene = R"(
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], A = [10, 0] }
)" + joint;
  try {
    parse_scene(scene, "test");
    FAIL() << joint;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
  }
}

TEST(JointFriction, IsRefusedWhereItIsNot) {
  const std::string points = "points = [\"ground.O\", \"arm.O\"]\n";
  expect_refused("[[weld]]\n" + points + "friction = { coefficient = 0.1 }", "friction");
  expect_refused("[[pin]]\n" + points + "friction = { coefficient = 0.1 }", "expected the key radius");
  expect_refused("[[pin]]\n" + points + "friction = { coefficient = 0.1, radius = 1, length = 3 }", "length");
  expect_refused("[[pin]]\n" + points + "friction = { coefficient = -0.1, radius = 1 }", "coefficient");
  expect_refused("[[pin]]\n" + points + "friction = 0.1", "friction");
}

TEST(JointFriction, IsBuiltInCode) {
  SceneBuilder builder("arm");
  builder.ground_point("O", {0, 0})
      .body("arm", {.points = {{"O", {0, 0}}}})
      .pin("ground.O", "arm.O", "O")
      .friction({{"radius", 0.01}, {"coefficient", 0.3}});
  EXPECT_DOUBLE_EQ(builder.build().joints[0].friction->coefficient, 0.3);
  EXPECT_THROW(SceneBuilder("none").friction({{"coefficient", 0.3}}), InputError);
}

}  // namespace
}  // namespace poise::joint_friction_test

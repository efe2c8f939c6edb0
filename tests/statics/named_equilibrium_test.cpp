#include "statics/equilibrium/named_equilibrium.hpp"

#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "model/scene_builder.hpp"

namespace poise::named_equilibrium_test {
namespace {

constexpr double degree = M_PI / 180.0;

/// An arm of 200 mm on a torsion spring of 20 N mm/deg at O, pulled down by 3 N at its end; a block of 5 N hangs on a
/// vertical rail, with a spring of 0.5 N/mm and free length 40 mm from the rail's top.
SceneBuilder arm_and_block() {
  SceneBuilder builder("arm", {.length = "mm", .angle = "deg"});
  builder.ground_point("O", {0, 0})
      .ground_point("T", {500, 300})
      .body("arm", {.points = {{"O", {0, 0}}, {"B", {200, 0}}}})
      .body("block", {.points = {{"C", {0, 0}}}})
      .pin("ground.O", "arm.O", "hinge")
      .slide("ground.T", "block.C", {0, -1}, "rail")
      .element("torsion_spring", "coil", measures::angle("ground", "arm"), {{"stiffness", 20}})
      .element("spring", "coil", measures::distance("ground.T", "block.C"), {{"stiffness", 0.5}, {"free_length", 40}})
      .element("spring", "slack", measures::distance("ground.T", "block.C"),
               {{"stiffness", 9}, {"free_length", 400}, {"acts", "tension"}})
      .force("P", "arm.B", {0, -3})
      .force("W", "block.C", {0, -5})
      .stop("floor", measures::travel("rail"), {{"max", 200}})
      .start("arm", -10)
      .start("rail", 60);
  return builder;
}

// The arm hangs at theta < 0: 20 N mm/deg theta = -3 N 200 mm cos(theta).
double arm_degrees() {
  double theta = -20;
  for (int i = 0; i < 200; ++i) theta -= (20 * theta + 600 * std::cos(theta * degree)) / 30;
  return theta;
}

TEST(NamedEquilibrium, IsReadBySceneNamesInSi) {
  const NamedEquilibrium equilibrium = solve(arm_and_block().build());
  ASSERT_TRUE(equilibrium.found());
  const double theta = arm_degrees() * degree;
  EXPECT_NEAR(equilibrium.angle("arm"), theta, 1e-9);
  EXPECT_EQ(equilibrium.angle("ground"), 0.0);
  EXPECT_NEAR(equilibrium.point("arm.B").x, 0.2 * std::cos(theta), 1e-9);
  EXPECT_NEAR(equilibrium.point("arm.B").y, 0.2 * std::sin(theta), 1e-9);
  // 5 N on 500 N/m: 10 mm longer than 40 mm.
  EXPECT_NEAR(equilibrium.travel("rail"), 0.05, 1e-9);
  EXPECT_NEAR(equilibrium.measure("spring.coil"), 0.05, 1e-9);
  EXPECT_NEAR(equilibrium.force("spring.coil"), 5.0, 1e-7);
  EXPECT_EQ(equilibrium.force("slack"), 0.0);
  // Tends to diminish an angle that is negative: pushes it up.
  EXPECT_NEAR(equilibrium.force("torsion_spring.coil"), 0.020 / degree * theta, 1e-9);
  EXPECT_NEAR(equilibrium.reaction("hinge").force.y, 3.0, 1e-9);
  EXPECT_NEAR(equilibrium.reaction("hinge").at.x, 0.0, 1e-12);
  EXPECT_EQ(equilibrium.stop_reaction("floor").axial, 0.0);
  EXPECT_EQ(equilibrium.energy(), equilibrium.result().energy);
}

TEST(NamedEquilibrium, IsReadInTheUnitsOfTheSceneOrOthers) {
  const NamedEquilibrium equilibrium = solve(arm_and_block().build());
  const NamedEquilibrium shown = equilibrium.in_scene_units();
  EXPECT_NEAR(shown.angle("arm"), arm_degrees(), 1e-7);
  EXPECT_NEAR(shown.travel("rail"), 50, 1e-6);
  EXPECT_NEAR(shown.measure("torsion_spring.coil"), arm_degrees(), 1e-7);
  EXPECT_NEAR(shown.force("torsion_spring.coil"), 20 * arm_degrees(), 1e-5);
  EXPECT_NEAR(shown.reaction("rail").at.x, 500, 1e-6);
  EXPECT_NEAR(*shown.energy(), 1000 * *equilibrium.energy(), 1e-9);
  const NamedEquilibrium inches = equilibrium.in({.length = "in", .force = "lbf"});
  EXPECT_NEAR(inches.point("block.C").x, 0.5 / 0.0254, 1e-9);
  EXPECT_NEAR(inches.force("spring.coil"), 5 / 4.4482216152605, 1e-7);
  EXPECT_NEAR(inches.angle("arm"), equilibrium.angle("arm"), 1e-15);
}

TEST(NamedEquilibrium, HasTheForceOfAStopInContact) {
  SceneBuilder builder = arm_and_block();
  builder.force("more", "block.C", {0, -100});
  const NamedEquilibrium equilibrium = solve(builder.build());
  ASSERT_TRUE(equilibrium.found());
  EXPECT_NEAR(equilibrium.in_scene_units().travel("rail"), 200, 1e-6);
  // The spring takes 0.5 (200 - 40) = 80 of 105 N.
  EXPECT_NEAR(norm(equilibrium.stop_reaction("floor").force), 25, 1e-6);
}

TEST(NamedEquilibrium, NamesTheNearestOfAnUnknownName) {
  const NamedEquilibrium equilibrium = solve(arm_and_block().build());
  const auto message = [](const std::function<void()>& read) -> std::string {
    try {
      read();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([&] { equilibrium.angle("amr"); }),
            "arm: expected the name of a body, found \"amr\"; did you mean \"arm\"?");
  EXPECT_EQ(message([&] { equilibrium.point("arm.C"); }),
            "arm: expected a point \"BODY.POINT\", found \"arm.C\"; did you mean \"arm.O\"?");
  EXPECT_EQ(message([&] { equilibrium.travel("hinge"); }),
            "arm: expected the name of a slide or pin_in_slot, found \"hinge\"; known here: rail");
  EXPECT_EQ(message([&] { equilibrium.force("slak"); }),
            "arm: expected the name of a force element, found \"slak\"; did you mean \"slack\"?");
  EXPECT_EQ(message([&] { equilibrium.force("coil"); }),
            "arm: expected one element called \"coil\", found spring.coil and torsion_spring.coil; give one of these");
  EXPECT_EQ(message([&] { equilibrium.reaction("hing"); }),
            "arm: expected the name of a joint, found \"hing\"; did you mean \"hinge\"?");
  EXPECT_EQ(message([&] { equilibrium.stop_reaction("flor"); }),
            "arm: expected the name of a stop, found \"flor\"; did you mean \"floor\"?");
}

}  // namespace
}  // namespace poise::named_equilibrium_test

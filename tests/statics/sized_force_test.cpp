// Forces that have a direction at any size.

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "model/scene_builder.hpp"
#include "model/set_parameter.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/static_model.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/path_measures.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"

namespace poise::sized_force_test {
namespace {

// A lever of 0.2 m on a torsion spring of 3 N m/rad, and a force at its tip: P 0.2 cos(angle) = 3 angle.
std::string lever(const std::string& force) {
  return R"(title = "lever"
source = "ours"
[ground]
points = { O = [0, 0] }
[body.lever]
points = { O = [0, 0], B = [0.2, 0] }
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "lever"]
stiffness = 3
free_angle = 0
[[force]]
name = "P"
at = "lever.B"
)" + force;
}

Scene with(const std::string& force) { return parse_scene(lever(force), "lever.toml"); }

std::string refusal(const std::string& force) {
  return test::message_of([&] { with(force); });
}

TEST(SizedForce, IsReadWithItsDirection) {
  const Scene none = with("direction = [0, 20]\nsize = 0\n");
  EXPECT_EQ(none.forces[0].vector, (Vec2{0, 0}));
  EXPECT_EQ(none.forces[0].along, (Vec2{0, 1}));
  const Scene back = with("direction = [3, 4]\nsize = -5\n");
  EXPECT_NEAR(back.forces[0].vector.x, -3, 1e-15);
  EXPECT_NEAR(back.forces[0].vector.y, -4, 1e-15);
  EXPECT_NEAR(get_value(back, "load.P"), -5, 1e-15);
  const Scene built = SceneBuilder("lever")
                          .ground_point("O", {0, 0})
                          .body("lever", {.points = {{"O", {0, 0}}, {"B", {0.2, 0}}}})
                          .pin("ground.O", "lever.O", "O")
                          .force_along("P", "lever.B", {0, 2}, 0.0)
                          .build();
  EXPECT_EQ(built.forces[0].along, (Vec2{0, 1}));
}

TEST(SizedForce, IsRefusedInOneLine) {
  EXPECT_EQ(refusal("direction = [0, 0]\nsize = 1\n"),
            "lever.toml:18: force \"P\".direction: expected a direction, found [0, 0]; give for example [0, 1]");
  EXPECT_EQ(refusal("direction = [0, 1]\nsize = 1\nvector = [0, 1]\n"),
            "lever.toml:20: force \"P\".vector: expected vector, or direction and size, found both; leave one out");
  EXPECT_NE(refusal("direction = [0, 1]\n").find("size"), std::string::npos);
  EXPECT_NE(refusal("size = 1\n").find("direction"), std::string::npos);
  EXPECT_NE(refusal("direction = [0, 1]\nsize = nan\n"), "");
  EXPECT_NE(refusal("").find("vector"), std::string::npos);
}

TEST(SizedForce, IsSetAtEverySize) {
  Scene scene = with("direction = [1, 1]\nsize = 0\n");
  for (const double size : {4.0, 0.0, -2.0, 1e-30}) {
    set_value(scene, "load.P", size);
    EXPECT_NEAR(get_value(scene, "load.P"), size, 1e-15 * std::abs(size));
    EXPECT_NEAR(scene.forces[0].vector.x, size / std::sqrt(2.0), 1e-15 * std::abs(size));
  }
  const Scene doubled = scaled(with("direction = [1, 1]\nsize = 3\n"), {.length = 1, .force = 0.5});
  EXPECT_NEAR(doubled.forces[0].size(), 6, 1e-14);
}

TEST(SizedForce, IsWrittenAsItWasRead) {
  const std::string text = lever("direction = [0, 1]\nsize = 0 # none yet\n");
  Scene wanted = parse_scene(text, "lever.toml");
  set_value(wanted, "load.P", 7.5);
  std::string expected = text;
  expected.replace(expected.find("size = 0"), 8, "size = 7.5");
  EXPECT_EQ(rewritten_scene(text, "lever.toml", wanted), expected);
  wanted.forces[0].along = {-1, 0};
  wanted.forces[0].vector = {-7.5, 0};
  expected.replace(expected.find("[0, 1]"), 6, "[-1, 0]");
  EXPECT_EQ(parse_scene(rewritten_scene(text, "lever.toml", wanted), "lever.toml").forces[0].vector, (Vec2{-7.5, 0}));
}

TEST(SizedForce, FollowsExpressionsOfNumbers) {
  const std::string text = lever("direction = [0, 1]\nsize = \"2 * half\"\n[numbers]\nhalf = 0\n");
  Scene scene = parse_scene(text, "lever.toml");
  EXPECT_EQ(scene.forces[0].size(), 0.0);
  set_value(scene, "numbers.half", -3);
  EXPECT_EQ(scene.forces[0].size(), -6.0);
  EXPECT_NE(test::message_of([&] { set_value(scene, "load.P", 1); }), "");
  EXPECT_NE(test::message_of(
                [] { parse_scene(lever("direction = [0, \"half\"]\nsize = 1\n[numbers]\nhalf = 1\n"), "lever.toml"); }),
            "");
}

// From nothing, where the lever is level, with the slope d angle / dP = 0.2 / 3 there.
TEST(SizedForce, IsVariedFromNothing) {
  const VariedScene varied(with("direction = [0, 1]\nsize = 0\n"), "load.P", -6, 9);
  PathOptions options;
  options.at = {-4, 0, 1e-3, 8};
  const Path found = path(varied, options);
  EXPECT_EQ(found.status, Path::Status::traced);
  EXPECT_EQ(found.unproved(), 0);
  PathReader reader(varied);
  const SoughtQuantity angle = find_quantity(varied.scene(), "angle.lever");
  for (std::size_t k = 0; k < options.at.size(); ++k) {
    ASSERT_EQ(found.wanted[k].size(), 1U);
    const double turned = reader.value(angle, found.wanted[k][0]);
    EXPECT_NEAR(options.at[k] * 0.2 * std::cos(turned), 3 * turned, 1e-12);
  }
}

TEST(SizedForce, HasASensitivityAtZero) {
  const auto by_load = [](const std::string& force) {
    const StaticModel model(with(force));
    const Sensitivities all = sensitivities(model, {find_quantity(model.scene(), "angle.lever")});
    EXPECT_EQ(all.why, "");
    for (const Sensitivity& one : all.of.at(0).by) {
      if (one.number == "load.P") return one;
    }
    return Sensitivity{};
  };
  const Sensitivity sized = by_load("direction = [0, 1]\nsize = 0\n");
  EXPECT_EQ(sized.why, "");
  EXPECT_NEAR(sized.derivative, 0.2 / 3, 1e-12);
  EXPECT_NE(by_load("vector = [0, 0]\n").why, "");
}

}  // namespace
}  // namespace poise::sized_force_test

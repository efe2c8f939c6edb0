// Scenes without the items that are switched off: what refers to others by their places follows them.

#include "app/view/parked_items.hpp"

#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "model/scene.hpp"

namespace poise::app::parked_items_test {
namespace {

const Scene& scene() {
  static const Scene all = parse_scene(R"(
    [numbers]
    r = 1.5
    [ground]
    points = { O = [0, 0], C = [1, 0] }
    [body.a]
    points = { O = [0, 0], E = [0.5, 0] }
    [body.a.section]
    area = 1e-4
    second_moment = 1e-9
    modulus = 2e11
    height = 0.01
    flexible = true
    elements = 1
    [body.b]
    points = { C = [0, 0] }
    [[pin]]
    points = ["ground.O", "a.O"]
    [[pin]]
    points = ["ground.C", "b.C"]
    [[torsion_spring]]
    name = "first"
    bodies = ["ground", "b"]
    stiffness = 7
    [[torsion_spring]]
    name = "second"
    bodies = ["ground", "b"]
    stiffness = 9
    [[stop]]
    name = "end"
    bodies = ["ground", "b"]
    max = 2
    [[gear]]
    name = "mesh"
    bodies = ["a", "b"]
    ratio = "2*r"
  )",
                                       "parked.toml");
  return all;
}

TEST(ParkedItems, ExpressionsOfCouplingsFollowThem) {
  Scene left = without_items(scene(), {"stop.end"});
  ASSERT_EQ(left.stops.size(), 1U);
  set_value(left, "numbers.r", 4);
  EXPECT_EQ(get_value(left, "gear.mesh.ratio"), 8.0);
}

TEST(ParkedItems, SpringsOfFlexibleLinksFollowThem) {
  Scene left = without_items(scene(), {"torsion_spring.first"});
  const auto stiffness_at = [](const Scene& of, int spring) {
    return std::get<LinearSpring>(of.elements[static_cast<std::size_t>(spring)].law).stiffness;
  };
  const std::vector<int>& whole = scene().flexible_links.at(0).springs;
  ASSERT_EQ(left.flexible_links.at(0).springs.size(), whole.size());
  set_value(left, "body.a.section.modulus", 4e11);
  EXPECT_EQ(get_value(left, "torsion_spring.second.stiffness"), 9.0);
  for (std::size_t k = 0; k < whole.size(); ++k) {
    EXPECT_DOUBLE_EQ(stiffness_at(left, left.flexible_links[0].springs[k]), 2 * stiffness_at(scene(), whole[k]));
  }
}

TEST(ParkedItems, FunctionsOfTimeFollowTheirLoads) {
  const Scene all = parse_scene(R"(
    [ground]
    points = { O = [0, 0] }
    [body.b]
    points = { C = [0, 0] }
    [[pin]]
    points = ["ground.O", "b.C"]
    [[force]]
    name = "first"
    at = "b.C"
    vector = [1, 0]
    time = { step = { to = 1 } }
    [[force]]
    name = "second"
    at = "b.C"
    vector = [0, 1]
    time = { ramp = { to = 3, end = 1 } }
    [[torque]]
    name = "third"
    on = "b"
    value = 2
    time = { step = { to = 5 } }
  )",
                                "timed.toml");
  const Scene left = without_items(all, {"load.first"});
  ASSERT_EQ(left.time_functions.size(), 2U);
  EXPECT_EQ(get_value(left, "load.second.time.to"), 3);
  EXPECT_EQ(get_value(left, "load.third.time.to"), 5);
}

}  // namespace
}  // namespace poise::app::parked_items_test

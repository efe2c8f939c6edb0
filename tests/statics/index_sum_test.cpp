#include "statics/all_equilibria/private/index_sum.hpp"

#include <gtest/gtest.h>

#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/pulled_chain.hpp"

namespace poise::index_sum_test {
namespace {

using test::dataset;
using test::pulled_chain;

TEST(IndexSum, IsTheEulerCharacteristicOfThePoses) {
  EXPECT_EQ(index_sum(StaticModel(pulled_chain(3))), 0);
  EXPECT_EQ(index_sum(StaticModel(read_scene(dataset("four_bar_gravity.toml")))), 0);
  // Equal edges: a surface of genus 4, as C. Gibson and others drew it. A long one: a sphere.
  const auto five_bar = [](double span) {
    Scene scene = test::chain(4, 1.0, 1.0);
    const PointRef end = scene.add_point(0, "E", {span, 0.0});
    test::add_pin(scene, "4.b", scene.name_of(end), "end");
    scene.gravity = {0.0, -10.0};
    return scene;
  };
  EXPECT_EQ(index_sum(StaticModel(five_bar(1.0))), -6);
  EXPECT_EQ(index_sum(StaticModel(five_bar(3.9))), 2);
  // Four edges of 1 m on 2 m: it can be stretched to a line.
  EXPECT_FALSE(index_sum(StaticModel(five_bar(2.0))).has_value());
  EXPECT_FALSE(index_sum(StaticModel(read_scene(dataset("von_mises_toggle.toml")))).has_value()) << "it slides";
  EXPECT_FALSE(index_sum(StaticModel(read_scene(dataset("inverted_pendulum_torsion.toml")))).has_value()) << "it winds";
  Scene held = read_scene(dataset("four_bar_gravity.toml"));
  test::add_stop(held, "motor", 0, 1, 1.0, 1.0);
  EXPECT_FALSE(index_sum(StaticModel(held)).has_value()) << "it is held";
}

TEST(IndexSum, IsUnknownWhereAForceMayLoseItsDirection) {
  const auto sprung = [](double free_length, LinearSpring::Acts acts, double at) {
    Scene scene = pulled_chain(2);
    const PointRef post = scene.add_point(0, "P", {at, 0.0});
    scene.elements.push_back(test::line_spring("S", post, test::point(scene, "2.b"), 3.0, free_length, acts));
    return index_sum(StaticModel(scene));
  };
  using Acts = LinearSpring::Acts;
  EXPECT_EQ(sprung(0.0, Acts::both, 1.0), 0);
  EXPECT_EQ(sprung(0.5, Acts::tension, 1.0), 0);
  EXPECT_EQ(sprung(0.5, Acts::both, 2.5), 0) << "out of reach";
  EXPECT_FALSE(sprung(0.5, Acts::both, 1.0).has_value());
  // A rope of free length zero over both links: where one part of it vanishes the other pulls.
  Scene rope = pulled_chain(2);
  const PointRef post = rope.add_point(0, "P", {1.0, 0.0});
  const PointRef knee = test::point(rope, "1.b"), tip = test::point(rope, "2.b");
  rope.elements.push_back(test::make_element(
      "spring", "rope",
      Measure::sum_of({{1.0, Measure::distance_between(post, knee)}, {1.0, Measure::distance_between(knee, tip)}}),
      LinearSpring{3.0, 0.0}));
  EXPECT_FALSE(index_sum(StaticModel(rope)).has_value());
}

}  // namespace
}  // namespace poise::index_sum_test

// What must not change an answer: where the world's origin is, points of the ground that nothing uses, the units.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::invariance_test {
namespace {

using test::dataset;

constexpr const char* names[] = {"thesis_four_bar.toml",
                                 "toggle_clamp.toml",
                                 "toggle_press.toml",
                                 "lift.toml",
                                 "car_hood.toml",
                                 "hencky_cantilever.toml",
                                 "vertical_slider_crank.toml",
                                 "six_bar.toml",
                                 "scissor_lift.toml",
                                 "redundant_parallelogram.toml",
                                 "zeeman.toml",
                                 "von_mises_toggle.toml"};

// The whole mechanism elsewhere in the world.
Scene moved(Scene scene, Vec2 by) {
  for (NamedPoint& p : scene.bodies[0].points) p.at += by;
  for (std::optional<Vec2>& position : scene.start.position) {
    if (position) *position += by;
  }
  return scene;
}

double rounded(double x) { return std::ldexp(std::round(std::ldexp(x, 20)), -20); }

// Ground points with few digits, which stay exact in a sum with a large power of two. Loops then close elsewhere.
Scene with_short_numbers(Scene scene) {
  for (NamedPoint& p : scene.bodies[0].points) p.at = {rounded(p.at.x), rounded(p.at.y)};
  return scene;
}

struct Answer {
  std::vector<double> x;
  Equilibrium equilibrium;
  Scales scales;
};

Answer answer_of(const Scene& scene) {
  const StaticModel model(scene);
  Answer out{{}, solve(model, test::by(Method::virtual_work)), model.scales()};
  out.x = out.equilibrium.x;
  return out;
}

void expect_same_verdict(const Answer& a, const Answer& b) {
  EXPECT_EQ(a.equilibrium.found(), b.equilibrium.found()) << a.equilibrium.why << " / " << b.equilibrium.why;
  EXPECT_EQ(to_string(a.equilibrium.certificate.stability), to_string(b.equilibrium.certificate.stability));
  EXPECT_EQ(a.equilibrium.certificate.unstable_directions, b.equilibrium.certificate.unstable_directions);
}

// All but the energy, whose zero is arbitrary, and where reactions act: `unit` is the force unit of b.
void expect_same_bits(const Answer& a, const Answer& b, double unit = 1.0) {
  EXPECT_EQ(a.x, b.x);
  expect_same_verdict(a, b);
  const Check& one = a.equilibrium.check;
  const Check& two = b.equilibrium.check;
  EXPECT_EQ(one.imbalance, two.imbalance * unit);
  EXPECT_EQ(one.largest_force, two.largest_force * unit);
  ASSERT_EQ(one.reactions.size(), two.reactions.size());
  for (std::size_t k = 0; k < one.reactions.size(); ++k) {
    EXPECT_EQ(one.reactions[k].force, unit * two.reactions[k].force) << one.reactions[k].name;
  }
}

TEST(Invariance, OfAnswersMovedByAPowerOfTwo) {
  for (const char* name : names) {
    SCOPED_TRACE(name);
    const Scene scene = with_short_numbers(read_scene(dataset(name)));
    const Answer here = answer_of(scene);
    for (const int power : {10, 20}) {
      const double far = std::ldexp(here.scales.length, power);
      for (const Vec2 by : {Vec2{far, 0}, Vec2{-far, far}}) {
        const Answer there = answer_of(moved(scene, by));
        EXPECT_EQ(here.scales.length, there.scales.length);
        EXPECT_EQ(here.equilibrium.check.closure_error, there.equilibrium.check.closure_error);
        expect_same_bits(here, there);
      }
    }
  }
}

// The numbers of the moved scene round, by half a unit in the last place of the distance.
TEST(Invariance, OfVerdictsMovedByDecimals) {
  for (const char* name : names) {
    SCOPED_TRACE(name);
    const Scene scene = read_scene(dataset(name));
    const Answer here = answer_of(scene);
    for (const double far : {1e3, 1e6}) {
      const Answer there = answer_of(moved(scene, {far * here.scales.length, -0.7 * far * here.scales.length}));
      EXPECT_EQ(here.scales.length, there.scales.length);
      expect_same_verdict(here, there);
      ASSERT_EQ(here.x.size(), there.x.size());
      for (std::size_t i = 0; i < here.x.size(); ++i) EXPECT_NEAR(here.x[i], there.x[i], 1e-13 * far) << i;
    }
  }
}

TEST(Invariance, OfAnswersWithAnUnusedGroundPoint) {
  for (const char* name : names) {
    SCOPED_TRACE(name);
    Scene scene = read_scene(dataset(name));
    const Answer without = answer_of(scene);
    scene.add_point(0, "nobody uses it", {1e9, -3e9});
    const Answer with = answer_of(scene);
    EXPECT_EQ(without.scales.length, with.scales.length);
    expect_same_bits(without, with);
  }
}

TEST(Invariance, OfAnswersInOtherUnits) {
  for (const char* name : names) {
    SCOPED_TRACE(name);
    const Scene scene = read_scene(dataset(name));
    const Answer here = answer_of(scene);
    for (const int length : {-20, 0, 20}) {
      for (const int force : {-20, 0, 20}) {
        const Scales unit{std::ldexp(1.0, length), std::ldexp(1.0, force)};
        expect_same_bits(here, answer_of(scaled(scene, unit)), unit.force);
      }
    }
    for (const double length : {1e-6, 1e-3, 1e6}) {
      for (const double force : {1e-6, 1e3, 1e6}) {
        const Answer there = answer_of(scaled(scene, {length, force}));
        expect_same_verdict(here, there);
        ASSERT_EQ(here.x.size(), there.x.size());
        for (std::size_t i = 0; i < here.x.size(); ++i) {
          const double unit = static_cast<int>(i) < StaticModel(scene).layout().angles
                                  ? 1.0
                                  : here.scales.length / (there.scales.length * length);
          EXPECT_NEAR(here.x[i], there.x[i] / unit, 1e-11) << i;
        }
      }
    }
  }
}

// A beam on two springs is tied to the ground by no joint: its coordinates count from the first spring's anchor.
TEST(Invariance, OfABodyOnSpringsAlone) {
  Scene scene;
  const int beam = test::add_link(scene, "beam", 1.5, 2.0);
  scene.gravity = {0.0, -9.81};
  scene.add_point(0, "A", {0.25, 1.0});
  scene.add_point(0, "B", {1.75, 1.0});
  scene.elements.push_back(
      test::line_spring("a", test::point(scene, "ground.A"), test::point(scene, "beam.a"), 100, 0.5));
  scene.elements.push_back(
      test::line_spring("b", test::point(scene, "ground.B"), test::point(scene, "beam.b"), 120, 0.5));
  scene.start.position[beam] = Vec2{0.25, 0.25};
  const Answer here = answer_of(scene);
  ASSERT_TRUE(here.equilibrium.found()) << here.equilibrium.why;
  for (const int power : {0, 10, 20}) {
    const double far = std::ldexp(1.0, power);
    const Scene other = moved(scene, {far, -far});
    const Answer there = answer_of(other);
    expect_same_bits(here, there);
    const StaticModel model(other);
    const Vec2 place = model.poses(there.x)[static_cast<std::size_t>(beam)].origin;
    const Vec2 first = StaticModel(scene).poses(here.x)[static_cast<std::size_t>(beam)].origin;
    EXPECT_NEAR(place.x - far, first.x, 1e-15 * far + 1e-15);
    EXPECT_NEAR(place.y + far, first.y, 1e-15 * far + 1e-15);
  }
}

TEST(Invariance, OfTheScalesOfAMechanismFarAway) {
  const Scene scene = read_scene(dataset("thesis_four_bar.toml"));
  const double size = StaticModel(scene).scales().length;
  for (const double far : {1e6, 1e9}) EXPECT_EQ(StaticModel(moved(scene, {far, far})).scales().length, size);
}

}  // namespace
}  // namespace poise::invariance_test

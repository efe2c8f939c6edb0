// Reactions with their proved distances from the exact ones, against closed forms and 50 digits.

#include "statics/proof/enclosed_reactions.hpp"

#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "statics/equilibrium/equilibrium.hpp"
#include "tests/judge/exact_reactions.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_scenes.hpp"

namespace poise::enclosed_reactions_test {
namespace {

using judge::Real;
using test::model_of;
using test::reaction_of;

// Compares all that is enclosed with 50 digits, or rather less; how many reactions were.
int expect_enclosed(const StaticModel& model, const Equilibrium& found, const judge::ExactForces& exact) {
  const Scene& scene = model.scene();
  const Check& check = found.check;
  const Real rounding("1e-60");
  int enclosed = 0;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Reaction& shown = check.reactions[j];
    const Planar<Real> off = planar_cast<Real>(shown.force) - exact.joints[j].force;
    EXPECT_LE(norm(off), Real(shown.radius) + rounding) << shown.name;
    EXPECT_LE(abs(Real(shown.moment) - exact.joints[j].moment), Real(shown.moment_radius) + rounding) << shown.name;
    enclosed += std::isfinite(shown.radius) ? 1 : 0;
  }
  for (std::size_t s = 0; s < exact.stops.size(); ++s) {
    const Reaction& shown = check.reactions[scene.joints.size() + s];
    if (shown.axial != 0.0) {
      EXPECT_LE(abs(Real(shown.axial) + exact.stops[s]), Real(shown.radius) + rounding) << shown.name;
    } else if (shown.moment != 0.0) {
      EXPECT_LE(abs(Real(shown.moment) - exact.stops[s]), Real(shown.moment_radius) + rounding) << shown.name;
    }
  }
  for (std::size_t e = 0; e < exact.elements.size(); ++e) {
    const ElementForce& shown = check.element_forces[e];
    EXPECT_LE(abs(Real(shown.value) - exact.elements[e]), Real(shown.radius) + rounding) << scene.elements[e].name;
  }
  return enclosed;
}

TEST(EnclosedReactions, OfAPendulumAreItsWeight) {
  const StaticModel model = model_of(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0.1, 0.7] }
    [body.arm]
    points = { O = [0, 0] }
    center = [1, 0]
    mass = 3
    [[pin]]
    name = "hinge"
    points = ["ground.O", "arm.O"]
  )");
  const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(found.found()) << found.why;
  const Reaction& hinge = reaction_of(found.check, "hinge");
  EXPECT_LE(norm(hinge.force - Vec2{0.0, 30.0}), hinge.radius);
  EXPECT_LT(hinge.radius, 1e-20);
}

class OfDatasets : public testing::TestWithParam<const char*> {};

TEST_P(OfDatasets, AreThoseOfFiftyDigits) {
  const StaticModel model(read_scene(test::dataset(GetParam())));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  const auto exact = judge::exact_forces(model, found);
  ASSERT_TRUE(exact);
  EXPECT_EQ(expect_enclosed(model, found, *exact), static_cast<int>(model.scene().joints.size()));
  for (const Reaction& reaction : found.check.reactions) {
    EXPECT_LT(reaction.radius, 1e-14 * found.check.largest_force) << reaction.name;
  }
}

INSTANTIATE_TEST_SUITE_P(EnclosedReactions, OfDatasets,
                         testing::Values("thesis_four_bar.toml", "six_bar.toml", "toggle_press.toml", "car_hood.toml",
                                         "vertical_slider_crank.toml", "andrews.toml", "scissor_lift.toml"),
                         [](const auto& scene) {
                           const std::string name = scene.param;
                           return name.substr(0, name.find('.'));
                         });

class OfRandomScenes : public testing::TestWithParam<std::string> {};

TEST_P(OfRandomScenes, AreThoseOfFiftyDigits) {
  constexpr std::uint64_t scenes = 25;
  constexpr Eigen::Index most_unknowns = 60;  // for the time that 50 digits take
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    SCOPED_TRACE(fmt::format("{} {}", GetParam(), seed));
    const StaticModel model(test::random_scene(GetParam(), seed));
    if (3 * static_cast<Eigen::Index>(model.scene().bodies.size()) > most_unknowns / 2) continue;
    Equilibrium found;
    try {
      found = solve(model, test::by(Method::virtual_work));
    } catch (const InputError&) {
      continue;
    }
    if (!found.found() || found.certificate.outcome != Outcome::proved || !found.certificate.strict) continue;
    const auto exact = judge::exact_forces(model, found);
    if (exact) compared += expect_enclosed(model, found, *exact);
  }
  EXPECT_GT(compared, 25);
}

INSTANTIATE_TEST_SUITE_P(EnclosedReactions, OfRandomScenes,
                         testing::Values("planted", "followers", "stops", "touching", "scales", "soft", "curvature",
                                         "kinks"),
                         [](const auto& family) { return family.param; });

// A load of 1 N on a bar that is held by a spring of k N/m: in double its length, and so its force, is known to k
// 1e-16.
TEST(EnclosedReactions, OfStiffSpringsAreBetterThanDoublePrecision) {
  for (const double stiffness : {1e8, 1e12}) {
    const StaticModel model = model_of(fmt::format(R"(
      [ground]
      points = {{ O = [0, 0], S = [0.3, 1.1] }}
      [body.bar]
      points = {{ O = [0, 0], P = [0.9, 0] }}
      [start]
      bar = 0.3
      [[pin]]
      name = "hinge"
      points = ["ground.O", "bar.O"]
      [[spring]]
      points = ["ground.S", "bar.P"]
      stiffness = {}
      free_length = 1.0
      [[force]]
      at = "bar.P"
      vector = [0.3, -1]
    )",
                                                   stiffness));
    const Equilibrium found = solve(model, test::by(Method::virtual_work));
    ASSERT_TRUE(found.found()) << found.why;
    const auto exact = judge::exact_forces(model, found);
    ASSERT_TRUE(exact);
    EXPECT_EQ(expect_enclosed(model, found, *exact), 1);
    const Reaction& hinge = reaction_of(found.check, "hinge");
    EXPECT_LT(hinge.radius, 1e-10);
    const Check in_double = check(model, found.x);
    EXPECT_GT(norm(reaction_of(in_double, "hinge").force - hinge.force), hinge.radius);
    EXPECT_GT(std::abs(in_double.element_forces[0].value - found.check.element_forces[0].value),
              found.check.element_forces[0].radius);
  }
}

TEST(EnclosedReactions, AreOfLeastNormWhereStaticsLeavesThemOpen) {
  const StaticModel model(read_scene(test::dataset("redundant_parallelogram.toml")));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  ASSERT_GT(found.check.redundancy, 0);
  const Check in_double = check(model, found.x);
  for (const Reaction& reaction : found.check.reactions) {
    EXPECT_FALSE(reaction.determined) << reaction.name;
    EXPECT_LT(reaction.radius, 1e-12 * found.check.largest_force) << reaction.name;
    const Vec2 off = reaction.force - reaction_of(in_double, reaction.name).force;
    EXPECT_LE(norm(off), 1e-13 * found.check.largest_force) << reaction.name;
  }
  for (const ElementForce& force : found.check.element_forces) EXPECT_TRUE(std::isfinite(force.radius));
}

// Three slides in a loop keep one angle twice: their moments are not determined, but the forces of the pin are.
TEST(EnclosedReactions, OfRepeatedMomentsAreOfLeastNorm) {
  const StaticModel model = model_of(R"(
    gravity = [0, -10]
    [ground]
    points = { A = [0, 0], S = [-3, 0] }
    [body.inner]
    points = { P = [0, 0], Q = [0.5, 0.5] }
    mass = 1
    center = [0.2, 0.1]
    [body.outer]
    points = { P = [0, 0], A = [0.1, 0.2], H = [0.4, -0.3] }
    mass = 2
    center = [0.1, 0]
    [body.bob]
    points = { H = [0, 0] }
    mass = 2
    center = [1, 0]
    [[slide]]
    name = "level"
    points = ["ground.A", "inner.P"]
    axis = [1, 0]
    [[slide]]
    name = "upright"
    points = ["inner.Q", "outer.P"]
    axis = [0.3, 1]
    [[slide]]
    name = "across"
    points = ["ground.A", "outer.A"]
    axis = [1, 2]
    [[pin]]
    name = "hook"
    points = ["outer.H", "bob.H"]
    [[spring]]
    points = ["ground.S", "inner.P"]
    stiffness = 50
    free_length = 3
  )");
  ASSERT_EQ(model.layout().redundant_angle.size(), 1U);
  const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(found.found()) << found.why;
  const Check in_double = check(model, found.x);
  for (const char* name : {"level", "upright", "across"}) {
    const Reaction& slide = reaction_of(found.check, name);
    EXPECT_FALSE(slide.determined) << name;
    EXPECT_LT(slide.moment_radius, 1e-12) << name;
    EXPECT_NEAR(slide.moment, reaction_of(in_double, name).moment, 1e-11) << name;
  }
  const Reaction& hook = reaction_of(found.check, "hook");
  EXPECT_LE(norm(hook.force - Vec2{0.0, 20.0}), hook.radius);
  EXPECT_LT(hook.radius, 1e-14);
}

// A balanced arm rests at every angle; its pin carries both weights.
TEST(EnclosedReactions, OfANeutralArm) {
  const StaticModel model = model_of(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0.5, 0.25] }
    [body.arm]
    points = { O = [0, 0], L = [-1, 0], R = [2, 0] }
    [[pin]]
    name = "hinge"
    points = ["ground.O", "arm.O"]
    [[force]]
    at = "arm.L"
    vector = [0, -8]
    [[force]]
    at = "arm.R"
    vector = [0, -4]
    [[torsion_spring]]
    bodies = ["ground", "arm"]
    stiffness = 0
    free_angle = 0
  )");
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  ASSERT_EQ(found.certificate.outcome, Outcome::neutral);
  const Reaction& hinge = reaction_of(found.check, "hinge");
  EXPECT_LE(norm(hinge.force - Vec2{0.0, 12.0}), hinge.radius);
  EXPECT_LT(hinge.radius, 1e-14);
}

TEST(EnclosedReactions, AreNotClaimedWithoutAProof) {
  const StaticModel model(read_scene(test::dataset("thesis_four_bar.toml")));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  for (const Reaction& reaction : check(model, found.x).reactions) EXPECT_FALSE(std::isfinite(reaction.radius));
  Certificate none = found.certificate;
  none.outcome = Outcome::not_proved;
  Check check = poise::check(model, found.x);
  enclose_reactions(model, none, check);
  for (const Reaction& reaction : check.reactions) EXPECT_FALSE(std::isfinite(reaction.radius));
  // Without the finer enclosure what follows from the pose, which contains the exact ones.
  Certificate coarse = found.certificate;
  coarse.rest.clear();
  coarse.radius = 1e-7;
  enclose_reactions(model, coarse, check);
  for (const Reaction& reaction : check.reactions) {
    const Reaction& exact = reaction_of(found.check, reaction.name);
    EXPECT_GT(reaction.radius, 1e-8 * found.check.largest_force) << reaction.name;
    EXPECT_LT(reaction.radius, 1e-4 * found.check.largest_force) << reaction.name;
    EXPECT_LE(norm(reaction.force - exact.force), reaction.radius) << reaction.name;
  }
  for (const ElementForce& force : check.element_forces) EXPECT_TRUE(std::isfinite(force.radius));
}

// Beyond a few hundred unknowns the decompositions are sparse.
TEST(EnclosedReactions, OfALongChain) {
  const StaticModel model(test::hanging_chain(300, 10.0, 5.0, 6.0));
  const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(found.found()) << found.why;
  for (const Reaction& reaction : found.check.reactions) EXPECT_LT(reaction.radius, 1e-14) << reaction.name;
}

}  // namespace
}  // namespace poise::enclosed_reactions_test

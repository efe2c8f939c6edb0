// What is proved of an answer: equilibria and their stability by hand, folds, cusps, neutral sets, change points, stops
// and one-way springs at their limits. What is no equilibrium is never confirmed.

#include "statics/proof/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/scene.hpp"
#include "solvers/real50.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/check.hpp"
#include "statics/model/reference.hpp"
#include "statics/proof/principal_directions.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/seed.hpp"

namespace poise::certificate_test {
namespace {

using test::coordinates_at;
using test::dataset;
using test::model_of;
using Pose = std::map<std::string, double>;

// A scaled coordinate in SI, without rounding.
Real50 in_si(const StaticModel& model, const std::vector<double>& x, int i) {
  const Coordinate& coordinate = model.layout().coordinates[i];
  return i < model.layout().angles ? Real50(x[i]) : (Real50(x[i]) + coordinate.origin) * model.scales().length;
}

Certificate certified(const StaticModel& model, const Pose& values) {
  return certify(model, coordinates_at(model, values));
}

void expect_proved(const Certificate& proof, Stability stability, int unstable) {
  EXPECT_EQ(to_string(proof.outcome), "proved") << proof.statement;
  EXPECT_TRUE(proof.confirmed());
  EXPECT_EQ(to_string(proof.stability), to_string(stability));
  EXPECT_EQ(proof.unstable_directions, unstable);
  EXPECT_EQ(proof.neutral_directions, 0);
}

// --- one equilibrium in a ball ---------------------------------------------------------------------------------------

class Refines : public testing::TestWithParam<const char*> {};

// From 1e-6 away the same doubles are found again, within a radius that contains 50 digits' answer.
TEST_P(Refines, EveryCoordinateShiftedByAMillionth) {
  const StaticModel model(read_scene(dataset(GetParam())));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  const Reference exact = refine(model, found.x);
  ASSERT_TRUE(exact.refined) << exact.why;
  for (std::size_t i = 0; i < found.x.size(); ++i) {
    SCOPED_TRACE(model.layout().coordinates[i].name);
    std::vector<double> x = found.x;
    x[i] += 1e-6;
    const Certificate proof = certify(model, x);
    ASSERT_EQ(to_string(proof.outcome), "proved") << proof.statement;
    EXPECT_EQ(proof.unstable_directions, found.certificate.unstable_directions);
    for (std::size_t k = 0; k < x.size(); ++k) {
      EXPECT_NEAR(proof.x[k], found.x[k], proof.radius + found.certificate.radius);
    }
    EXPECT_NEAR(proof.moved, 1e-6, 1e-9);
    // Half a unit in the last place of the largest coordinate.
    EXPECT_LE(proof.radius, 5e-16);
    for (std::size_t k = 0; k < x.size(); ++k) {
      const int coordinate = static_cast<int>(k);
      const double unit = coordinate < model.layout().angles ? 1.0 : model.scales().length;
      const Real50 apart = abs(Real50(exact.decimal[k]) - in_si(model, proof.x, coordinate)) / unit;
      EXPECT_LE(apart, proof.radius + Real50(1e-38));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Refines,
                         testing::Values("thesis_four_bar.toml", "pendulum_chain.toml", "six_bar.toml",
                                         "vertical_slider_crank.toml", "lift.toml", "toggle_press.toml",
                                         "hencky_cantilever.toml"),
                         [](const auto& scene) {
                           const std::string name = scene.param;
                           return name.substr(0, name.find('.'));
                         });

TEST(Certify, RefusesWhatIsNotFinite) {
  const StaticModel model(read_scene(dataset("thesis_four_bar.toml")));
  const std::vector<double> equilibrium = solve(model, test::by(Method::virtual_work)).x;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    for (std::size_t i = 0; i < equilibrium.size(); ++i) {
      std::vector<double> x = equilibrium;
      x[i] = bad;
      const Certificate proof = certify(model, x);
      EXPECT_FALSE(proof.confirmed());
      EXPECT_EQ(to_string(proof.stability), "unknown");
      EXPECT_NE(proof.statement.find("not a finite number"), std::string::npos) << proof.statement;
    }
  }
}

TEST(Certify, ProvesNothingBeyondItsLimit) {
  const StaticModel model(read_scene(dataset("thesis_four_bar.toml")));
  const std::vector<double> equilibrium = solve(model, test::by(Method::virtual_work)).x;
  const auto expect_unfinished = [&](const CertificateOptions& options, const std::string& statement) {
    const Certificate proof = certify(model, equilibrium, options);
    EXPECT_TRUE(proof.unfinished);
    EXPECT_EQ(to_string(proof.outcome), "not proved");
    EXPECT_FALSE(proof.confirmed());
    EXPECT_EQ(proof.statement, statement);
  };
  expect_unfinished({.products = 1.0}, "no proof within 1 products");
  // Where a person asks for a time that counts alone.
  expect_unfinished({.products = 1e9, .seconds = 0.0}, "no proof within 0 s");
  EXPECT_TRUE(certify(model, equilibrium, {.products = 1.0, .seconds = 1e3}).confirmed());
}

TEST(Certify, IsBoundToTheNeighbourhoodOfTheAnswer) {
  // A pendulum hangs at -pi/2.
  Scene scene = test::chain(1, 1.0, 1.0);
  scene.gravity = {0.0, -10.0};
  const StaticModel model(scene);
  expect_proved(certify(model, {-M_PI_2 + 5e-4}), Stability::stable, 0);
  EXPECT_FALSE(certify(model, {-M_PI_2 + 2e-3}).confirmed());
  expect_proved(certify(model, {-M_PI_2 + 2e-3}, {.farthest = 1e-2}), Stability::stable, 0);
  for (const double angle : {0.0, 0.3, 1.0, 3.0}) EXPECT_FALSE(certify(model, {angle}).confirmed()) << angle;
}

TEST(Certify, NothingHoldsAFallingBlock) {
  const StaticModel model = model_of(
      "gravity = [0, -10]\n[ground]\npoints = { R = [0, 0] }\n[body.block]\npoints = { P = [0, 0] }\nmass = 2\n"
      "[[slide]]\nname = \"rail\"\npoints = [\"ground.R\", \"block.P\"]\naxis = [0, 1]\n");
  for (const double height : {0.0, 0.3, -1e6}) EXPECT_FALSE(certified(model, {{"rail", height}}).confirmed());
}

TEST(Certify, RoundingOfTheSceneIsDividedByTheCurvature) {
  // Torques 2 cos(q) + T = 0: a relative change of 2^-53 of each of the four numbers of 2 cos(q) = m g c cos(q) and T
  // moves q by at most 4 x 2^-53 |T| / (2 |sin(q)|).
  for (const double q : {-1.4, -1.0, -0.1, -0.01}) {
    Scene scene = test::chain(1, 4.0, 1.0);
    scene.gravity = {0.0, -1.0};
    Torque torque;
    torque.body = 1;
    torque.value = 2.0 * std::cos(q);
    scene.torques.push_back(torque);
    const StaticModel model(scene);
    const Certificate proof = certify(model, {q});
    expect_proved(proof, Stability::stable, 0);
    const double one = 0x1p-53 * std::cos(q) / std::abs(std::sin(q));
    EXPECT_GE(proof.rounding_effect, one);
    EXPECT_LE(proof.rounding_effect, 6 * one + 0x1p-53 * std::abs(std::sin(q)));
    EXPECT_LE(proof.radius, 0x1p-53);
  }
}

// --- inertia ---------------------------------------------------------------------------------------------------------

TEST(StabilityOf, PendulumsByEachOrientationOfTheirLinks) {
  Scene scene = test::chain(3, 1.0, 1.0);
  scene.gravity = {0.0, -10.0};
  const StaticModel model(scene);
  for (int up = 0; up < 8; ++up) {
    Pose pose;
    int standing = 0;
    for (int i = 0; i < 3; ++i) {
      const bool stands = (up >> i & 1) != 0;
      standing += stands;
      pose[std::to_string(i + 1)] = stands ? M_PI_2 : -M_PI_2;
    }
    const Certificate proof = certified(model, pose);
    expect_proved(proof, standing > 0 ? Stability::unstable : Stability::stable, standing);
    const std::vector<CurvatureDirection> directions = principal_directions(model, proof);
    ASSERT_EQ(directions.size(), 3u);
    // Uncoupled: each link's curvature is the weight it carries times its arm, sign by its sense.
    const std::vector<double> stiffness = {25.0, 15.0, 5.0};
    std::vector<double> expected;
    for (int i = 0; i < 3; ++i) expected.push_back((up >> i & 1) != 0 ? -stiffness[i] : stiffness[i]);
    std::sort(expected.begin(), expected.end());
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(directions[i].curvature, expected[i], 1e-12);
  }
}

TEST(StabilityOf, ModesNameWhatMoves) {
  Scene scene = test::chain(2, 1.0, 1.0);
  scene.gravity = {0.0, -10.0};
  const StaticModel model(scene);
  const std::vector<CurvatureDirection> directions =
      principal_directions(model, certified(model, {{"1", M_PI_2}, {"2", -M_PI_2}}));
  ASSERT_EQ(directions.size(), 2u);
  EXPECT_EQ(directions[0].moves.front().first, "1");
  EXPECT_NEAR(directions[0].moves.front().second, 1.0, 1e-12);
  EXPECT_EQ(directions[1].moves.front().first, "2");
}

TEST(StabilityOf, AStandingChainIsUnstableInAllItsLinks) {
  Scene scene = test::chain(400, 0.1, 1.0);
  scene.gravity = {0.0, -1.0};
  for (auto& angle : scene.start.angle) angle = M_PI_2;
  const StaticModel model(scene);
  expect_proved(certify(model, model.start()), Stability::unstable, 400);
}

// Closures that repeat others: each crank beyond two adds one redundant pair of forces.
TEST(StabilityOf, AParallelogramWithRedundantCranks) {
  for (const int cranks : {2, 3, 10, 60}) {
    SCOPED_TRACE(std::to_string(cranks) + " cranks");
    const StaticModel model(test::parallelogram(cranks, 1.0, 100.0));
    const Certificate proof = certify(model, model.start());
    expect_proved(proof, Stability::unstable, 1);
    EXPECT_EQ(proof.redundant, cranks - 2);
    EXPECT_FALSE(proof.singular);
  }
}

TEST(StabilityOf, AStiffnessATrillionthBesideTheWeight) {
  // k = m g c (1 + excess) on an inverted pendulum: V'' = m g c excess. Down is along -x, so that upright is 0 to the
  // last bit.
  for (const double excess : {1e-12, -1e-12, 1e-15, -1e-15}) {
    Scene scene = test::chain(1, 2.0, 1.0);
    scene.gravity = {-8.0, 0.0};
    const double stiffness = 8.0 * (1 + excess);
    test::add_torsion_spring(scene, 0, 1, stiffness);
    const StaticModel model(scene);
    const Certificate proof = certify(model, model.start());
    expect_proved(proof, excess > 0 ? Stability::stable : Stability::unstable, excess > 0 ? 0 : 1);
    const std::vector<CurvatureDirection> directions = principal_directions(model, proof);
    ASSERT_EQ(directions.size(), 1u);
    EXPECT_EQ(directions[0].curvature, stiffness - 8.0);
    // The rounding of k alone moves it by 2^-53 / excess of an angle that is zero: by nothing.
    EXPECT_LE(proof.radius, 1e-16);
  }
}

TEST(PrincipalDirections, AreNoneWhereStopsLeaveNoMotion) {
  const StaticModel model(read_scene(dataset("toggle_clamp.toml")));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  EXPECT_TRUE(found.certificate.locked);
  EXPECT_EQ(found.certificate.active_stops.size(), 1u);
  EXPECT_TRUE(principal_directions(model, found.certificate).empty());
}

TEST(PrincipalDirections, AreNoneWithFollowerLoads) {
  Scene scene = test::chain(2, 1.0, 1.0);
  scene.gravity = {0.0, -10.0};
  test::add_force(scene, "2.b", {-1.0, 0.0}, "P");
  scene.forces[0].follows = 2;
  const StaticModel model(scene);
  EXPECT_TRUE(principal_directions(model, certified(model, {{"1", -M_PI_2}, {"2", -M_PI_2}})).empty());
}

// --- follower loads --------------------------------------------------------------------------------------------------

// Two links of 1 m, torsion springs of 1 N m/rad at both joints, pushed at the tip by a force that follows a link.
StaticModel column(double force, const std::string& follows) {
  return model_of(
      "[ground]\npoints = { O = [0, 0] }\n"
      "[body.one]\npoints = { a = [0, 0], b = [1, 0] }\n"
      "[body.two]\npoints = { a = [0, 0], b = [1, 0] }\n"
      "[[pin]]\npoints = [\"ground.O\", \"one.a\"]\n[[pin]]\npoints = [\"one.b\", \"two.a\"]\n"
      "[[torsion_spring]]\nbodies = [\"ground\", \"one\"]\nstiffness = 1\n"
      "[[torsion_spring]]\nbodies = [\"one\", \"two\"]\nstiffness = 1\n" +
      fmt::format("[[force]]\nname = \"P\"\nat = \"two.b\"\nfollows = \"{}\"\nvector = [{}, 0]\n", follows, -force));
}

// Stiffness [[2 - P, P - 1], [-1, 1]]: determinant 1 whatever P, so it cannot diverge. Whether it flutters depends on
// masses, at loads that statics cannot name.
TEST(FollowerLoads, OnTheirOwnLinkMayFlutterButNeverDiverge) {
  for (const double force : {0.9, 1.5, 2.5, 3.5, 4.5}) {
    SCOPED_TRACE(force);
    expect_proved(certified(column(force, "two"), {}), Stability::unknown, 0);
  }
}

// Following the first link: determinant 1 - P, so beyond P = 1 one real eigenvalue is negative.
TEST(FollowerLoads, OnTheOtherLinkDiverge) {
  for (const double beside : {1e-1, 1e-6, 1e-12}) {
    SCOPED_TRACE(beside);
    expect_proved(certified(column(1.0 - beside, "one"), {}), Stability::unknown, 0);
    expect_proved(certified(column(1.0 + beside, "one"), {}), Stability::unstable, 1);
  }
}

// A column of ten such links: singular values of its stiffness from 8.92 to 0.164, so the equilibrium is isolated; its
// determinant is 1 at every load, as with two links.
TEST(FollowerLoads, OnTenLinksAreNotNeutral) {
  Scene scene = test::chain(10, 1.0, 0.0);
  for (int i = 1; i <= 10; ++i) test::add_torsion_spring(scene, i - 1, i, 1.0);
  test::add_force(scene, "10.b", {-2.5, 0.0}, "P");
  scene.forces[0].follows = 10;
  const StaticModel model(scene);
  expect_proved(certify(model, std::vector<double>(10, 0.0)), Stability::unknown, 0);
}

// --- folds -----------------------------------------------------------------------------------------------------------

// A block on a vertical rail at height y, held by a spring of stiffness k to a point 1 m aside and pushed down by P:
//   P = k (l0 / l - 1) y,  l^2 = 1 + y^2,  with the largest P where l^3 = l0.
struct Truss {
  explicit Truss(double slope) : free_length(std::sqrt(1.0 + slope * slope)) {
    const Real50 l0 = free_length;
    const Real50 l = cbrt(l0);
    fold = sqrt(l * l - 1);
    largest = stiffness * (l0 / l - 1) * fold;
  }

  Real50 load(const Real50& y) const {
    return stiffness * (Real50(free_length) / sqrt(across * across + y * y) - 1) * y;
  }

  // The height at a smaller load, above (stable) or below (unstable) the fold.
  Real50 height(double p, bool above) const {
    Real50 safe = fold;
    Real50 beyond = above ? Real50(sqrt(Real50(free_length) * free_length - across * across)) : Real50(0);
    for (int k = 0; k < 160; ++k) {
      const Real50 middle = (safe + beyond) / 2;
      (load(middle) > p ? safe : beyond) = middle;
    }
    return safe;
  }

  StaticModel model(double p) const {
    Scene scene = parse_scene(
        "[ground]\npoints = { R = [0, 0], S = [1, 0], T = [1, 1] }\n[body.block]\npoints = { P = [0, 0], Q = [0, 1] }\n"
        "[[slide]]\nname = \"rail\"\npoints = [\"ground.R\", \"block.P\"]\naxis = [0, 1]\n"
        "[[spring]]\nname = \"strut\"\npoints = [\"ground.S\", \"block.P\"]\nstiffness = 1\nfree_length = 1\n"
        "[[force]]\nname = \"P\"\nat = \"block.P\"\nvector = [0, -1]\n",
        "truss.toml");
    set_value(scene, "spring.strut.stiffness", stiffness);
    set_value(scene, "spring.strut.free_length", free_length);
    set_value(scene, "load.P", p);
    return StaticModel(scene);
  }

  double stiffness = 1000.0;
  double free_length;
  Real50 across = 1;  // from the rail to the spring's other point, m; the fold is that of 1 m
  Real50 fold, largest;
};

class Folds : public testing::TestWithParam<double> {};

TEST_P(Folds, AreProvedOnTheirNearSideAndNeverConfirmedBeyond) {
  const Truss truss(GetParam());
  const double at_fold = static_cast<double>(truss.fold);
  for (double part = 1e-3; part > 5e-16; part /= 10) {
    SCOPED_TRACE(part);
    const double below = static_cast<double>(truss.largest * (1 - Real50(part)));
    const StaticModel near_side = truss.model(below);
    const double size = near_side.scales().length;
    for (const bool above : {true, false}) {
      const Real50 y = truss.height(below, above);
      // Two equilibria, this far from each other.
      const double apart = 2 * std::abs(static_cast<double>(y - truss.fold));
      const Certificate proof = certified(near_side, {{"rail", static_cast<double>(y)}});
      ASSERT_EQ(to_string(proof.outcome), "proved") << proof.statement;
      EXPECT_LE(abs(in_si(near_side, proof.x, 0) - y), proof.radius * size + Real50(1e-38));
      EXPECT_LE(proof.radius * size, 0.1 * apart);
      EXPECT_EQ(to_string(proof.stability), above ? "stable" : "unstable");
    }
    const double beyond = static_cast<double>(truss.largest * (1 + Real50(part)));
    ASSERT_GT(Real50(beyond), truss.largest);
    const StaticModel far_side = truss.model(beyond);
    for (const double beside : {0.0, 1e-9, -1e-9, 1e-6, -1e-6}) {
      const Certificate proof = certified(far_side, {{"rail", at_fold + beside}});
      EXPECT_FALSE(proof.confirmed()) << proof.statement;
    }
    for (const Method method : {Method::virtual_work, Method::energy}) {
      const Equilibrium found = solve(far_side, coordinates_at(far_side, {{"rail", at_fold}}), {.method = method});
      // On the other side of the point of the truss there is one more.
      EXPECT_TRUE(!found.found() || test::travel_of(far_side, found.x, "rail") < 0.0) << found.certificate.statement;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Slopes, Folds, testing::Values(0.5, 0.1, 0.03, 0.01, 1e-3),
                         [](const auto& slope) { return "Slope" + std::to_string(slope.index); });

// A one-way spring along an arm, from its pin to a point of it, is for ever at its free length. It never acts, and
// hides nothing: a motor of 10 (1 + part) N m lifts an arm of 10 N over the top, and one of 10 (1 - part) holds it at
// cos(q) = 1 - part, stable where it hangs and unstable where it stands.
// Two rails 5.6e-17 m apart, which is rounding: the one that is left out would place the block at another height.
TEST(Folds, AreProvedWhicheverOfTwoRailsIsLeftOut) {
  Truss truss(0.1);
  for (const double part : {1e-4, 1e-7, 1e-10}) {
    SCOPED_TRACE(part);
    const double p = static_cast<double>(truss.largest * (1 - Real50(part)));
    Scene scene = parse_scene(
        "[ground]\npoints = { R = [0.3, 0], T = [0.30000000000000004, 0], S = [1.3, 0] }\n"
        "[body.block]\npoints = { P = [0, 0] }\n"
        "[[slide]]\nname = \"rail\"\npoints = [\"ground.R\", \"block.P\"]\naxis = [0, 1]\n"
        "[[slide]]\nname = \"other\"\npoints = [\"ground.T\", \"block.P\"]\naxis = [0, 1]\n"
        "[[spring]]\nname = \"strut\"\npoints = [\"ground.S\", \"block.P\"]\nstiffness = 1\nfree_length = 1\n"
        "[[force]]\nname = \"P\"\nat = \"block.P\"\nvector = [0, -1]\n",
        "rails.toml");
    set_value(scene, "spring.strut.stiffness", truss.stiffness);
    set_value(scene, "spring.strut.free_length", truss.free_length);
    set_value(scene, "load.P", p);
    const StaticModel model(scene);
    const double start = static_cast<double>(truss.height(p, true));
    const Certificate proof = certified(model, {{"rail", start}, {"other", start}});
    expect_proved(proof, Stability::stable, 0);
    EXPECT_EQ(proof.redundant, 1);
    for (const double rail : {0.3, 0.30000000000000004}) {
      truss.across = Real50(1.3) - rail;
      for (int i = 0; i < 2; ++i) {
        EXPECT_LE(abs(in_si(model, proof.x, i) - truss.height(p, true)), Real50(proof.radius * model.scales().length));
      }
    }
    truss.across = 1;
  }
}

TEST(Folds, AreNotHiddenByASpringThatNeverActs) {
  const auto model = [](double torque) {
    return model_of(fmt::format(
        "gravity = [0, -10]\n[ground]\npoints = {{ O = [0, 0] }}\n[body.arm]\npoints = {{ O = [0, 0], P = [1, 0] }}\n"
        "mass = 1\ncenter = [1, 0]\n[[pin]]\npoints = [\"ground.O\", \"arm.O\"]\n[[torque]]\non = \"arm\"\n"
        "value = {}\n[[spring]]\npoints = [\"ground.O\", \"arm.P\"]\nstiffness = 7\nfree_length = 1\nacts = "
        "\"tension\"\n",
        torque));
  };
  for (const double part : {1e-3, 1e-8, 1e-12}) {
    SCOPED_TRACE(part);
    EXPECT_FALSE(certified(model(10 * (1 + part)), {{"arm", 0.0}}).confirmed());
    for (const double side : {-1.0, 1.0}) {
      const Certificate proof = certified(model(10 * (1 - part)), {{"arm", side * std::acos(1 - part)}});
      EXPECT_TRUE(proof.confirmed()) << proof.statement;
      EXPECT_EQ(to_string(proof.stability), side < 0 ? "stable" : "unstable");
    }
  }
}

// --- cusps -----------------------------------------------------------------------------------------------------------

// V / 8 = q^2 / 2 + cos(q) = 1 + q^4 / 24 - ..., a minimum of fourth order.
TEST(Cusps, OfAnInvertedPendulumAreStable) {
  Scene scene = test::chain(1, 2.0, 1.0);
  scene.gravity = {-8.0, 0.0};
  test::add_torsion_spring(scene, 0, 1, 8.0);
  const StaticModel model(scene);
  for (const double start : {0.0, 1e-12, -1e-6, 1e-4}) {
    const Certificate proof = certify(model, {start});
    EXPECT_EQ(to_string(proof.outcome), "degenerate") << proof.statement;
    EXPECT_EQ(to_string(proof.stability), "stable");
    EXPECT_TRUE(proof.confirmed());
    EXPECT_EQ(proof.neutral_directions, 0);
    EXPECT_LE(std::abs(proof.x[0]), proof.radius);
    EXPECT_LE(proof.radius, 1e-12);
  }
}

// A standing arm that a spring across holds, V = 8 cos(q) + 8 / 2 sin(q)^2: V'' = 0 and V'''' = 8 - 32 < 0.
TEST(Cusps, WhereTheFourthOrderFallsAreUnstable) {
  const auto model = [](double stiffness) {
    return model_of(fmt::format(
        "gravity = [-8, 0]\n[ground]\npoints = {{ O = [0, 0] }}\n[body.arm]\npoints = {{ O = [0, 0], P = [1, 0] }}\n"
        "mass = 1\ncenter = [1, 0]\n[[pin]]\npoints = [\"ground.O\", \"arm.O\"]\n[[spring]]\ny = \"arm.P\"\n"
        "free_length = 0\nstiffness = {}\n",
        stiffness));
  };
  const Certificate proof = certified(model(8.0), {{"arm", 0.0}});
  EXPECT_EQ(to_string(proof.outcome), "degenerate") << proof.statement;
  EXPECT_EQ(to_string(proof.stability), "unstable");
  EXPECT_EQ(proof.unstable_directions, 1);
  expect_proved(certified(model(9.0), {{"arm", 0.0}}), Stability::stable, 0);
  expect_proved(certified(model(7.0), {{"arm", 0.0}}), Stability::unstable, 1);
}

// Zeeman's machine at its cusp, d = 0: V''(pi) = 0 and V''''(pi) > 0 (references static.zeeman.sym), so pi is stable.
TEST(Cusps, OfZeemansMachineIsStable) {
  Scene scene = read_scene(dataset("hard/zeeman_cusp.toml"));
  set_value(scene, "point.ground.fixed.x", -0.25);
  const StaticModel model(scene);
  for (const double start : {M_PI, M_PI + 1e-6, M_PI - 1e-4}) {
    const Certificate proof = certify(model, {start});
    EXPECT_TRUE(proof.confirmed()) << proof.statement;
    EXPECT_EQ(to_string(proof.outcome), "degenerate");
    EXPECT_EQ(to_string(proof.stability), "stable");
    EXPECT_NEAR(proof.x[0], M_PI, proof.radius + 1e-15);
  }
  const Equilibrium found = solve(model, {M_PI - 0.1}, test::by(Method::virtual_work, Seek::stable));
  EXPECT_TRUE(found.found()) << found.why;
  EXPECT_EQ(to_string(found.certificate.stability), "stable");
}

// --- neutral ---------------------------------------------------------------------------------------------------------

TEST(Neutral, ABalancedArmAtEveryAngle) {
  const StaticModel weights = model_of(R"(
    gravity = [0, -9.81]
    [ground]
    points = { O = [0, 0] }
    [body.arm]
    points = { O = [0, 0] }
    mass = 2
    center = [-1.5, 0]
    [body.counterweight]
    points = { O = [0, 0] }
    mass = 4
    center = [0.75, 0]
    [[pin]]
    points = ["ground.O", "arm.O"]
    [[weld]]
    points = ["arm.O", "counterweight.O"]
  )");
  // k h r = m g c with a spring whose free length is zero: balanced all round.
  const StaticModel spring = model_of(R"(
    gravity = [0, -9.81]
    [ground]
    points = { O = [0, 0], S = [0, 0.3] }
    [body.arm]
    points = { O = [0, 0], P = [0.2, 0] }
    mass = 2
    center = [0.7, 0]
    [[pin]]
    points = ["ground.O", "arm.O"]
    [[spring]]
    points = ["ground.S", "arm.P"]
    stiffness = 228.9
    free_length = 0
  )");
  for (const StaticModel* model : {&weights, &spring}) {
    for (int k = 0; k < 24; ++k) {
      const double angle = 2 * M_PI * k / 24;
      const Certificate proof = certified(*model, {{"arm", angle}});
      EXPECT_EQ(to_string(proof.outcome), "neutral") << angle << ": " << proof.statement;
      EXPECT_EQ(to_string(proof.stability), "neutral") << angle;
      EXPECT_EQ(proof.neutral_directions, 1);
      EXPECT_EQ(proof.unstable_directions, 0);
      EXPECT_EQ(proof.neutral_coordinates, std::vector<std::string>{"arm"});
      EXPECT_EQ(proof.x, coordinates_at(*model, {{"arm", angle}})) << "it stays where it is";
    }
  }
}

TEST(Neutral, APegThatIsPushedAlongItsSlotWhereTheWeightBalances) {
  Scene scene = parse_scene(
      "gravity = [0, -10]\n[ground]\npoints = { O = [0, 0] }\n[body.peg]\npoints = { P = [0, 0] }\nmass = 1\n"
      "[[pin_in_slot]]\nname = \"slot\"\npoints = [\"ground.O\", \"peg.P\"]\naxis = [0.86602540378443865, 0.5]\n"
      "[[force]]\nname = \"H\"\nat = \"peg.P\"\nvector = [1, 0]\n",
      "slot.toml");
  set_value(scene, "load.H", 10.0 * std::tan(M_PI / 6));
  const StaticModel model(scene);
  const Certificate proof = certified(model, {{"slot", 3.0}});
  EXPECT_EQ(to_string(proof.outcome), "neutral") << proof.statement;
  EXPECT_EQ(to_string(proof.stability), "neutral");
}

// `arms` balanced arms about one axis each, and a pendulum.
TEST(Neutral, ArmsBesideAPendulum) {
  for (const int arms : {1, 3, 30}) {
    SCOPED_TRACE(arms);
    Scene scene = test::chain(1, 1.0, 1.0);
    scene.gravity = {0.0, -10.0};
    for (int k = 0; k < arms; ++k) {
      const std::string name = "arm" + std::to_string(k);
      const int arm = test::add_link(scene, name, 1.0, 2.0);
      scene.bodies[arm].center = {0.0, 0.0};
      test::add_pin(scene, "ground.O", name + ".a");
      test::add_force(scene, name + ".b", {0.0, 1.0}, "up" + name);
      test::add_force(scene, name + ".b", {0.0, -1.0}, "down" + name);
      scene.start.angle[arm] = 0.1 * k;
    }
    for (const double pendulum : {-M_PI_2, M_PI_2}) {
      scene.start.angle[1] = pendulum;
      const StaticModel model(scene);
      const Certificate proof = certify(model, model.start());
      EXPECT_EQ(to_string(proof.outcome), "neutral") << proof.statement;
      EXPECT_EQ(proof.neutral_directions, arms);
      EXPECT_EQ(proof.unstable_directions, pendulum > 0 ? 1 : 0);
      EXPECT_EQ(to_string(proof.stability), pendulum > 0 ? "unstable" : "neutral");
    }
  }
}

// --- singular configurations -----------------------------------------------------------------------------------------

// Two links drawn straight between their anchors, loaded across: no finite reactions balance the load.
TEST(Singular, BarsPulledStraightAndLoadedAcross) {
  const StaticModel model(read_scene(dataset("hard/taut.toml")));
  const Certificate proof = certify(model, model.start());
  EXPECT_FALSE(proof.confirmed()) << proof.statement;
  EXPECT_TRUE(proof.singular) << proof.statement;
  // Bars that turn by 1e-10 rad at most balance it with W / 2e-10 and more.
  const double load = std::abs(model.scene().forces.front().vector.y);
  EXPECT_GE(proof.least_joint_force, 1e8 * load);
  EXPECT_LE(proof.least_joint_force, 0.5e10 * load);
}

// A middle pin written twice, one unit in the last place apart (0.3 and 0.1 + 0.2): to within the rounding of the
// scene's numbers one of the two says nothing.
TEST(Singular, APinWrittenTwiceCountsOnce) {
  const StaticModel model = model_of(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 0] }
    [body.one]
    points = { O = [0, 0], P = [0.3, 0], Q = [0.30000000000000004, 0] }
    mass = 1
    center = [0.15, 0]
    [body.two]
    points = { P = [0, 0] }
    mass = 1
    center = [0.5, 0]
    [[pin]]
    points = ["ground.O", "one.O"]
    [[pin]]
    name = "once"
    points = ["one.P", "two.P"]
    [[pin]]
    name = "twice"
    points = ["one.Q", "two.P"]
  )");
  for (const double one : {-M_PI_2, M_PI_2}) {
    for (const double two : {-M_PI_2, M_PI_2}) {
      const Certificate proof = certified(model, {{"one", one}, {"two", two}});
      const int up = (one > 0 ? 1 : 0) + (two > 0 ? 1 : 0);
      expect_proved(proof, up > 0 ? Stability::unstable : Stability::stable, up);
      EXPECT_EQ(proof.redundant, 2);
    }
  }
}

// A block on a rail from the world's origin along an axis, and what else acts.
StaticModel block_on_rail(const std::string& axis, const std::string& more) {
  return model_of(R"(
    [ground]
    points = { G = [0, 0] }
    [body.block]
    points = { C = [0, 0] }
    [[slide]]
    name = "rail"
    points = ["ground.G", "block.C"]
    axis = )" + axis +
                  "\n" + more);
}

// A block on a rail along (1, 2) rests where its spring of k = 3 N/m is stretched by 7 sqrt(1/5) / 3 m: the direction
// is exact, although no double is sqrt(1/5).
TEST(Proved, AnAxisIsAnExactDirection) {
  const StaticModel model = block_on_rail("[1, 2]", R"(
    [[spring]]
    slide = "rail"
    stiffness = 3
    free_length = 0
    [[force]]
    at = "block.C"
    vector = [7, 0]
  )");
  const Certificate proof = certified(model, {{"rail", 1.0435}});
  expect_proved(proof, Stability::stable, 0);
  const Real50 exact = 7 / sqrt(Real50(5)) / 3;
  EXPECT_LE(abs(in_si(model, proof.x, 0) - exact), Real50(proof.radius * model.scales().length));
  EXPECT_LE(proof.radius, 2e-16);
}

// The same from beside the point where its branches cross.
TEST(Singular, AChangePointIsFoundFromBeside) {
  const StaticModel model = model_of(R"(
    [ground]
    points = { A = [0, 0], B = [3, 0] }
    [body.crank]
    points = { a = [0, 0], b = [2, 0] }
    [body.rocker]
    points = { a = [0, 0], b = [1, 0] }
    [body.coupler]
    points = { a = [0, 0], b = [2, 0] }
    [[pin]]
    points = ["ground.A", "crank.a"]
    [[pin]]
    points = ["ground.B", "rocker.a"]
    [[pin]]
    points = ["crank.b", "coupler.a"]
    [[pin]]
    points = ["coupler.b", "rocker.b"]
    [[torsion_spring]]
    bodies = ["ground", "crank"]
    stiffness = 0.3
  )");
  const Certificate proof = certified(model, {{"crank", 2e-17}, {"rocker", 1e-7}, {"coupler", 5e-8}});
  EXPECT_TRUE(proof.confirmed()) << proof.statement;
  EXPECT_EQ(to_string(proof.outcome), "degenerate");
  EXPECT_EQ(to_string(proof.stability), "stable");
  EXPECT_LE(proof.moved, 2e-7);
}

// A parallelogram of unit cranks on unit ground, flat, with torsion springs on both cranks that hold it there: the
// motions are crank = rocker = t (parallel) and crank = -rocker = t (crossed), V = k t^2 / 2 (1 + 1) on both.
TEST(Singular, AFlatParallelogramThatSpringsHoldIsStable) {
  Scene scene;
  scene.add_point(0, "A", {0.0, 0.0});
  scene.add_point(0, "D", {1.0, 0.0});
  const int crank = test::add_link(scene, "crank", 1.0);
  const int coupler = test::add_link(scene, "coupler", 1.0);
  const int rocker = test::add_link(scene, "rocker", 1.0);
  test::add_pin(scene, "ground.A", "crank.a");
  test::add_pin(scene, "crank.b", "coupler.a");
  test::add_pin(scene, "coupler.b", "rocker.b");
  test::add_pin(scene, "ground.D", "rocker.a");
  for (const int body : {crank, coupler, rocker}) scene.start.angle[body] = 0.0;
  const auto with = [&](double on_crank, double on_rocker) {
    Scene sprung = scene;
    test::add_torsion_spring(sprung, 0, crank, on_crank);
    test::add_torsion_spring(sprung, 0, rocker, on_rocker);
    return sprung;
  };
  const StaticModel held(with(1.0, 1.0));
  const Certificate stable = certify(held, held.start());
  EXPECT_TRUE(stable.confirmed()) << stable.statement;
  EXPECT_EQ(to_string(stable.outcome), "degenerate");
  EXPECT_EQ(to_string(stable.stability), "stable");
  // A weight that stands on the crank, V = 8 cos(t) + ..., falls along both branches.
  Scene pushed = with(1.0, 1.0);
  pushed.gravity = {-16.0, 0.0};
  pushed.bodies[crank].mass = 1.0;
  const StaticModel falling(pushed);
  const Certificate unstable = certify(falling, falling.start());
  EXPECT_NE(to_string(unstable.stability), "stable") << unstable.statement;
  // Beside it, where the loops are closed to 1e-10 only.
  std::vector<double> beside = falling.start();
  for (double& q : beside) q += 1e-10;
  EXPECT_NE(to_string(certify(falling, beside).stability), "stable");
}

// --- stops -----------------------------------------------------------------------------------------------------------

// A pendulum of 1 kg on an arm of 1 m under 10 m/s^2 along +x (hanging at 0 exactly) or -x (standing at 0).
StaticModel arm(double gravity, const std::string& stop) {
  return model_of(
      fmt::format("gravity = [{}, 0]\n[ground]\npoints = {{ O = [0, 0] }}\n[body.arm]\npoints = {{ O = [0, 0] }}\n"
                  "center = [1, 0]\nmass = 1\n[[pin]]\npoints = [\"ground.O\", \"arm.O\"]\n",
                  gravity) +
      stop);
}

std::string stop(const std::string& limits) {
  return "[[stop]]\nname = \"stop\"\nbodies = [\"ground\", \"arm\"]\n" + limits + "\n";
}

TEST(StopsOf, AnArmThatLiesOnOneLockIt) {
  // At 1 rad from hanging the weight's moment, 10 sin(1) N m, presses on the stop at min = 1.
  const StaticModel model = arm(10.0, stop("min = 1\nmax = 2"));
  const Certificate proof = certified(model, {{"arm", 1.0}});
  expect_proved(proof, Stability::stable, 0);
  EXPECT_TRUE(proof.locked);
  EXPECT_TRUE(proof.strict);
  EXPECT_EQ(proof.active_stops, std::vector<int>{0});
  // A stop on the other side would have to pull.
  EXPECT_FALSE(certified(arm(10.0, stop("max = 1")), {{"arm", 1.0}}).confirmed());
}

TEST(StopsOf, AHangingArmThatIsTouchedWithoutForce) {
  for (const char* limits : {"min = 0", "max = 0"}) {
    const Certificate proof = certified(arm(10.0, stop(limits)), {{"arm", 0.0}});
    EXPECT_TRUE(proof.confirmed()) << proof.statement;
    EXPECT_EQ(to_string(proof.stability), "stable");
    EXPECT_FALSE(proof.strict);
    EXPECT_FALSE(proof.locked);
  }
}

// It stands at a stop that exerts no force, and falls away from it.
TEST(StopsOf, AStandingArmThatIsTouchedWithoutForceIsUnstable) {
  for (const char* limits : {"min = 0", "max = 0"}) {
    const Certificate proof = certified(arm(-10.0, stop(limits)), {{"arm", 0.0}});
    EXPECT_TRUE(proof.confirmed()) << proof.statement;
    EXPECT_EQ(to_string(proof.stability), "unstable");
    EXPECT_GE(proof.unstable_directions, 1);
    EXPECT_FALSE(proof.strict);
  }
}

// One that would have to pull by a moment of 10 sin(1e-9), and one that is not touched by 1e-9 rad.
TEST(StopsOf, AnArmThatIsNearlyTouched) {
  for (const double away : {1e-9, 1e-12}) {
    const Certificate pulls = certified(arm(10.0, stop(fmt::format("max = {}", away))), {{"arm", away}});
    expect_proved(pulls, Stability::stable, 0);
    EXPECT_LE(std::abs(pulls.x[0]), pulls.radius) << "it hangs straight";
    EXPECT_TRUE(pulls.active_stops.empty());
    const Certificate standing = certified(arm(-10.0, stop(fmt::format("min = {}", -away))), {{"arm", 0.0}});
    expect_proved(standing, Stability::unstable, 1);
    EXPECT_TRUE(standing.active_stops.empty());
    EXPECT_TRUE(standing.strict);
  }
}

// A crank and a rod that nothing loads rest wherever the stop lets them. Rounding of its limit overruns it here by up
// to 6e-17: where the limit holds is up to 4e-16 rad away.
TEST(StopsOf, ACrankThatIsTouchedToRoundingIsWhereTheLimitHolds) {
  const std::string scene = R"(
[ground]
points = { O = [0, 0] }
[body.crank]
points = { A = [0, 0], B = [1, 0] }
[body.rod]
points = { B = [0, 0], C = [2, 0] }
[[pin]]
points = ["ground.O", "crank.A"]
[[pin]]
points = ["crank.B", "rod.B"]
[[pin_in_slot]]
points = ["ground.O", "rod.C"]
axis = [1, 0]
[[stop]]
x = "crank.B"
max = )";
  for (const double start : {0.11, 0.123, 0.15, 0.2}) {
    const double limit = std::cos(start);
    const StaticModel model = model_of(fmt::format("{}{}\n[start]\ncrank = {}\n", scene, limit, start));
    const Real50 crank = acos(Real50(limit));
    const Real50 rod = -asin(sin(crank) / 2);
    const Real50 slot = cos(crank) + 2 * cos(rod);
    const Certificate proof = certified(
        model, {{"crank", start}, {"rod", static_cast<double>(rod)}, {"ground.O-rod.C", static_cast<double>(slot)}});
    ASSERT_TRUE(proof.confirmed()) << proof.statement;
    for (std::size_t i = 0; i < proof.x.size(); ++i) {
      const std::string& name = model.layout().coordinates[i].name;
      if (name != "crank" && name != "rod") continue;
      if (std::find(proof.neutral_coordinates.begin(), proof.neutral_coordinates.end(), name) !=
          proof.neutral_coordinates.end()) {
        continue;
      }
      EXPECT_LE(abs(in_si(model, proof.x, static_cast<int>(i)) - (name == "crank" ? crank : rod)), proof.radius)
          << name << " " << start;
    }
  }
}

// min = max, or two stops from both sides: a standing arm cannot move.
TEST(StopsOf, AStandingArmHeldFromBothSidesIsLocked) {
  const std::string both =
      "[[stop]]\nname = \"a\"\nbodies = [\"ground\", \"arm\"]\nmin = 0\n"
      "[[stop]]\nname = \"b\"\nbodies = [\"ground\", \"arm\"]\nmax = 0\n";
  for (const std::string& stops : {stop("min = 0\nmax = 0"), both}) {
    SCOPED_TRACE(stops);
    const StaticModel model = arm(-10.0, stops);
    const Certificate proof = certified(model, {{"arm", 0.0}});
    EXPECT_TRUE(proof.confirmed()) << proof.statement;
    EXPECT_EQ(to_string(proof.stability), "stable");
    EXPECT_TRUE(proof.locked);
    const Equilibrium found =
        solve(model, coordinates_at(model, {{"arm", 0.0}}), test::by(Method::virtual_work, Seek::stable));
    EXPECT_TRUE(found.found()) << found.why;
  }
}

// A beam on a pivot, held by a string of 1 m from each end to the ground straight below it: neither end can rise.
TEST(StopsOf, ABeamOnAPivotWithTwoTautStringsCannotMove) {
  const StaticModel model = model_of(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 0], L = [-1, -1], R = [1, -1] }
    [body.beam]
    points = { O = [0, 0], L = [-1, 0], R = [1, 0] }
    mass = 1
    center = [0, 0.5]
    [[pin]]
    points = ["ground.O", "beam.O"]
    [[stop]]
    name = "left"
    points = ["ground.L", "beam.L"]
    max = 1
    [[stop]]
    name = "right"
    points = ["ground.R", "beam.R"]
    max = 1
  )");
  const Certificate proof = certified(model, {{"beam", 0.0}});
  EXPECT_TRUE(proof.confirmed()) << proof.statement;
  EXPECT_EQ(to_string(proof.stability), "stable");
}

// A standing arm with a stop on its angle and one on the height of a point, 0.0625 sin(q) - 0.2 cos(q), which is a
// rounding unit above its place at q = 0.
constexpr double raised = -0.19999999999999998;
StaticModel arm_with_raised_point(const std::string& angle_limit) {
  return model_of(fmt::format(R"(
    gravity = [-10, 0]
    [ground]
    points = {{ O = [0, 0] }}
    [body.arm]
    points = {{ O = [0, 0], R = [0.0625, -0.2] }}
    center = [1, 0]
    mass = 1
    [[pin]]
    points = ["ground.O", "arm.O"]
    [[stop]]
    name = "angle"
    bodies = ["ground", "arm"]
    {}
    [[stop]]
    name = "height"
    y = "arm.R"
    min = {:.17}
  )",
                              angle_limit, raised));
}

// Both stops keep it from falling to the same side: at neither is there an equilibrium as the scene is written, and
// nothing is locked.
TEST(StopsOf, AStandingArmTouchedTwiceOnOneSideIsNotLocked) {
  const Certificate proof = certified(arm_with_raised_point("min = 0"), {{"arm", 0.0}});
  EXPECT_FALSE(proof.confirmed() && proof.stability == Stability::stable) << proof.statement;
  EXPECT_FALSE(proof.locked);
}

// A free block on a rail touches a wall, and an arc of 2^-22 m about a point below the rail, 3 * 2^-24 m aside of it:
// what holds next to the place at which it touches ends within 6 * 2^-24 m, where the block is beyond the point.
StaticModel block_between_a_wall_and_an_arc(const std::string& side) {
  return model_of(fmt::format(R"(
    [ground]
    points = {{ G = [-1, 0], A = [0, {}] }}
    [body.block]
    points = {{ C = [0, 0] }}
    [[slide]]
    name = "rail"
    points = ["ground.G", "block.C"]
    axis = [1, 0]
    [[stop]]
    name = "arc"
    points = ["ground.A", "block.C"]
    {} = {}
    [[stop]]
    name = "wall"
    slide = "rail"
    max = {}
  )",
                              -4 * 0x1p-24, side, 5 * 0x1p-24, 1 + 3 * 0x1p-24));
}

TEST(StopsOf, AnArcHoldsABlockHoweverShortItIs) {
  const Certificate proof = certified(block_between_a_wall_and_an_arc("min"), {{"rail", 1 + 3 * 0x1p-24}});
  EXPECT_TRUE(proof.confirmed()) << proof.statement;
  EXPECT_EQ(to_string(proof.stability), "stable");
  EXPECT_TRUE(proof.locked);
}

TEST(StopsOf, AnArcLeavesABlockHoweverShortTheWayIs) {
  const Certificate proof = certified(block_between_a_wall_and_an_arc("max"), {{"rail", 1 + 3 * 0x1p-24}});
  EXPECT_TRUE(proof.confirmed()) << proof.statement;
  EXPECT_EQ(to_string(proof.stability), "neutral");
}

// A block without weight lies in a slot of its own width, and may move along it; at a wall it may leave this only; and
// walls at both ends hold it.
TEST(StopsOf, ABlockInASlotMovesAlongIt) {
  const auto block = [](const std::string& walls) {
    return model_of(
        "[ground]\npoints = { O = [0, 0] }\n[body.block]\npoints = { C = [0, 0] }\n[[torsion_spring]]\n"
        "bodies = [\"ground\", \"block\"]\nfree_angle = 0\nstiffness = 1\n[[stop]]\nname = \"floor\"\n"
        "y = \"block.C\"\nmin = 0\n[[stop]]\nname = \"roof\"\ny = \"block.C\"\nmax = 0\n" +
        walls + "[start]\nblock = 0\n");
  };
  const std::string left = "[[stop]]\nname = \"left\"\nx = \"block.C\"\nmin = 0\n";
  const std::string right = "[[stop]]\nname = \"right\"\nx = \"block.C\"\nmax = 0\n";
  for (const std::string& walls : {std::string(), left}) {
    const StaticModel model = block(walls);
    const Certificate proof = certify(model, model.start());
    EXPECT_TRUE(proof.confirmed()) << proof.statement;
    EXPECT_EQ(to_string(proof.stability), "neutral");
  }
  const StaticModel held = block(left + right);
  const Certificate proof = certify(held, held.start());
  EXPECT_TRUE(proof.confirmed()) << proof.statement;
  EXPECT_NE(to_string(proof.stability), "neutral");
  EXPECT_NE(to_string(proof.stability), "unstable");
}

// A block pushed with 30 N against two walls at the same place: either may carry all of it.
TEST(StopsOf, WallsAtTheSamePlaceShareTheLoad) {
  const StaticModel model = block_on_rail("[1, 0]", R"(
    [[stop]]
    name = "one"
    slide = "rail"
    max = 0.5
    [[stop]]
    name = "two"
    slide = "rail"
    max = 0.5
    [[force]]
    at = "block.C"
    vector = [30, 0]
  )");
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  expect_proved(found.certificate, Stability::stable, 0);
  EXPECT_EQ(found.certificate.active_stops.size() + found.certificate.sharing_stops.size(), 2u);
  EXPECT_EQ(found.check.redundancy, 1);
  double sum = 0.0;
  for (const Reaction& reaction : found.check.reactions) {
    if (reaction.kind != "stop") continue;
    EXPECT_FALSE(reaction.determined) << reaction.name;
    EXPECT_LT(reaction.radius, 1e-14) << reaction.name;
    EXPECT_LE(std::abs(reaction.force.x + 15.0), reaction.radius) << reaction.name;
    sum -= reaction.force.x;
  }
  EXPECT_NEAR(sum, 30.0, 1e-12);
}

// Between the two, which exclude each other by a rounding unit: the radius reaches from where the one holds to where
// the other does.
TEST(StopsOf, TheRadiusReachesFromOneStopToTheOther) {
  const Certificate proof = certified(arm_with_raised_point("max = 0"), {{"arm", 0.0}});
  EXPECT_TRUE(proof.confirmed()) << proof.statement;
  EXPECT_TRUE(proof.locked);
  const double other = (raised + 0.2) / 0.0625;
  ASSERT_GT(other, 0.0);
  for (const double q : {0.0, other}) EXPECT_LE(std::abs(proof.x[0] - q), proof.radius);
}

// --- one-way springs -------------------------------------------------------------------------------------------------

// The band of hard/kink.toml is just taut: 100 N/m before, 200 N/m behind the equilibrium.
TEST(OneWaySprings, AreExaminedOnBothSidesOfTheirLimit) {
  const StaticModel model(read_scene(dataset("hard/kink.toml")));
  const Certificate proof = certified(model, {{"rail", 0.5}});
  expect_proved(proof, Stability::stable, 0);
  EXPECT_FALSE(proof.strict);
}

// A standing arm, V = 8 cos(q), with a spring that acts below -e only, V += 5 (q + e)^2: q = 0 falls, and beside it the
// arm stands on the spring at q = -10 e / (10 - 8) = -5 e.
TEST(OneWaySprings, JustBesideTheirLimitCountOnTheirOwnSide) {
  const StaticModel model = model_of(
      "gravity = [-8, 0]\n[ground]\npoints = { O = [0, 0] }\n[body.arm]\npoints = { O = [0, 0], P = [1, 0] }\n"
      "mass = 1\ncenter = [1, 0]\n[[pin]]\npoints = [\"ground.O\", \"arm.O\"]\n[[torsion_spring]]\nbodies = "
      "[\"ground\", \"arm\"]\nfree_angle = -1e-13\nstiffness = 10\nacts = \"compression\"\n");
  const Certificate standing = certify(model, {0.0});
  expect_proved(standing, Stability::unstable, 1);
  EXPECT_EQ(standing.x[0], 0.0);
  const Certificate leaning = certify(model, {-5e-13});
  expect_proved(leaning, Stability::stable, 0);
  EXPECT_NEAR(leaning.x[0], -5e-13, 1e-25);
}

// A standing arm, V = 10 cos(q), with a spring exactly at its limit, that holds where q > 0, and one that is 1e-12 rad
// from its own, which would hold where q < -1e-12: only the first counts at q = 0, and the arm falls the other way.
TEST(OneWaySprings, ThatAreNearlyAtTheirLimitKeepTheirState) {
  const auto spring = [](const char* angle, const char* acts) {
    return fmt::format(
        "[[torsion_spring]]\nbodies = [\"ground\", \"arm\"]\nfree_angle = {}\nstiffness = 100\nacts = \"{}\"\n", angle,
        acts);
  };
  const StaticModel model = model_of(
      "gravity = [-10, 0]\n[ground]\npoints = { O = [0, 0] }\n[body.arm]\npoints = { O = [0, 0] }\nmass = 1\n"
      "center = [1, 0]\n[[pin]]\npoints = [\"ground.O\", \"arm.O\"]\n" +
      spring("0", "tension") + spring("-1e-12", "compression"));
  const Certificate proof = certify(model, {0.0});
  EXPECT_TRUE(proof.confirmed()) << proof.statement;
  EXPECT_EQ(to_string(proof.stability), "unstable");
  EXPECT_FALSE(proof.strict);
}

// A standing arm held back by a rope that is just taut: to one side the rope holds it, to the other it falls.
TEST(OneWaySprings, ThatHoldOneSideOnlyLeaveTheOtherUnstable) {
  for (const char* acts : {"tension", "compression"}) {
    const StaticModel model = model_of(
        "gravity = [-10, 0]\n[ground]\npoints = { O = [0, 0], S = [1, -1] }\n[body.arm]\n"
        "points = { O = [0, 0], P = [1, 0] }\ncenter = [1, 0]\nmass = 1\n[[pin]]\npoints = [\"ground.O\", \"arm.O\"]\n"
        "[[spring]]\npoints = [\"ground.S\", \"arm.P\"]\nstiffness = 1000\nfree_length = 1\nacts = \"" +
        std::string(acts) + "\"\n");
    const Certificate proof = certified(model, {{"arm", 0.0}});
    EXPECT_TRUE(proof.confirmed()) << proof.statement;
    EXPECT_EQ(to_string(proof.stability), "unstable");
    EXPECT_FALSE(proof.strict);
  }
}

// Whether two equilibria are proved to be others that lie side by side in the last bits of their coordinates, as the
// ones with and without a stop that is almost touched.
bool are_apart(const Certificate& a, const Certificate& b) {
  if (a.rest.size() != a.x.size() || b.rest.size() != b.x.size()) return false;
  double apart = 0.0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    apart = std::max(apart, std::abs((a.x[i] - b.x[i]) + (a.rest[i] - b.rest[i])));
  }
  return apart > 2 * (a.rest_radius + b.rest_radius) && apart < 1e-14;
}

// What is proved is proved again from the place that it names, and from those that differ from it in last bits: neither
// another equilibrium nearby, nor, but for one in a hundred, less than before. One that is degenerate within a radius
// may be told exactly from nearer by.
TEST(RandomCertificates, AreGivenAgainAtTheirOwnPlaces) {
  std::minstd_rand random(1);
  int proved = 0, not_again = 0;
  for (const std::string& family : test::scene_families()) {
    for (int k = 0; k < test::cases(3, 300); ++k) {
      const std::uint64_t seed = test::seed(12207) + static_cast<std::uint64_t>(k);
      std::optional<StaticModel> model;
      Certificate first;
      try {
        model.emplace(test::random_scene(family, seed));
        first = solve(*model, {.seek = Seek::any}).certificate;
      } catch (const InputError&) {
        continue;  // it cannot be assembled
      }
      if (first.outcome != Outcome::proved && first.outcome != Outcome::neutral) continue;
      ++proved;
      for (int trial = 0; trial < 4; ++trial) {
        std::vector<double> x = first.x;
        for (double& at : x) {
          if (trial > 0 && random() % 3 > 0) at = std::nextafter(at, random() % 2 == 0 ? 1e9 : -1e9);
        }
        const Certificate again = certify(*model, x);
        if (!again.confirmed()) {
          ++not_again;
          break;
        }
        if (are_apart(first, again)) continue;
        EXPECT_EQ(to_string(again.outcome), to_string(first.outcome)) << family << " " << seed << again.statement;
        EXPECT_EQ(to_string(again.stability), to_string(first.stability)) << family << " " << seed;
      }
    }
  }
  EXPECT_GT(proved, test::cases(30, 3000));
  EXPECT_LE(not_again, proved / 100);
}

}  // namespace
}  // namespace poise::certificate_test

// The judge against equilibria known in closed form.

#include "tests/judge/judge.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "statics/model/static_model.hpp"
#include "tests/judge/claim.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"

namespace poise::judge::judge_test {
namespace {

// Verdict on the claim that x is an equilibrium of that kind within the radius.
Judgement verdict(const Scene& scene, const std::vector<double>& x, Kind kind, double radius = 1e-12) {
  const StaticModel model(scene);
  return Judge(model.scene(), model.scales().length).judge(claim_at(model, model.from_si(x), kind, radius));
}

void expect(Verdict expected, const Judgement& found) {
  EXPECT_EQ(to_string(expected), to_string(found.verdict)) << found.why;
}

Scene pendulum() {
  Scene scene = test::chain(1, 1.0, 1.0);
  scene.gravity = {0.0, -9.81};
  return scene;
}

TEST(Judge, PendulumHangsStableAndStandsUnstable) {
  expect(Verdict::right, verdict(pendulum(), {-M_PI / 2}, Kind::stable, 1e-15));
  expect(Verdict::right, verdict(pendulum(), {M_PI / 2}, Kind::unstable, 1e-15));
  expect(Verdict::wrong_kind, verdict(pendulum(), {M_PI / 2}, Kind::stable));
  expect(Verdict::wrong_kind, verdict(pendulum(), {-M_PI / 2}, Kind::neutral));
  expect(Verdict::outside_radius, verdict(pendulum(), {-M_PI / 2 + 1e-9}, Kind::stable, 1e-10));
  expect(Verdict::right, verdict(pendulum(), {-M_PI / 2 + 1e-9}, Kind::stable, 1.0001e-9));
  expect(Verdict::no_equilibrium, verdict(pendulum(), {-M_PI / 2 + 1e-2}, Kind::stable, 1e-10));
  expect(Verdict::no_equilibrium, verdict(pendulum(), {0.1}, Kind::stable, 1e-10));
}

TEST(Judge, DistanceIsThatOfTheDoubles) {
  // The nearest double to -pi/2 is 6.1e-17 away from it.
  const Judgement found = verdict(pendulum(), {-M_PI / 2}, Kind::stable);
  ASSERT_TRUE(found.truth);
  EXPECT_NEAR(found.truth->distance, 6.123e-17, 1e-20);
}

TEST(Judge, UnconfirmedEquilibriumIsLost) {
  const StaticModel model(pendulum());
  Claim claim = claim_at(model, {M_PI / 2}, Kind::unstable, 1e-15);
  claim.confirmed = false;
  const Judge judge(model.scene(), model.scales().length);
  expect(Verdict::lost, judge.judge(claim));
  claim.minimum_sought = true;
  expect(Verdict::right, judge.judge(claim));
}

// Two bars of rise h over the half span 1, guided vertically, as one link on a spring: a link from the ground to a
// slider on x = 1 replaced by a linear spring of stiffness k between the ground and the slider. Loaded downwards.
//   P(y) = k (l0 / l - 1) y,   l = sqrt(1 + y^2),   l0 = sqrt(1 + h^2),   P_max at  y^2 = l0^(2/3) - 1
Scene truss(double h, double load) {
  Scene scene;
  scene.add_point(0, "O", {0.0, 0.0});
  scene.add_point(0, "G", {1.0, 0.0});
  const int block = scene.add_body("block");
  scene.add_point(block, "P", {0.0, 0.0});
  test::add_slide(scene, "ground.G", "block.P", {0.0, 1.0}, "guide");
  scene.elements.push_back(test::line_spring("bar", test::point(scene, "ground.O"), test::point(scene, "block.P"),
                                             1000.0, std::sqrt(1 + h * h)));
  test::add_force(scene, "block.P", {0.0, -load}, "P");
  scene.start.travel[0] = h;
  return scene;
}

// The double below P_max of the truss as written, found in 50 digits.
double largest_load(double h) {
  const Real l0 = std::sqrt(1 + h * h);
  const Real y = sqrt(Real(pow(l0, Real(2) / 3) - 1));
  const Real load = 1000 * (l0 / sqrt(Real(1 + y * y)) - 1) * y;
  double below = static_cast<double>(load);
  if (Real(below) > load) below = std::nextafter(below, 0.0);
  return below;
}

double fold(double h) { return std::sqrt(std::pow(1 + h * h, 1.0 / 3) - 1); }

TEST(Judge, TrussHasAnEquilibriumBelowItsFoldOnly) {
  for (const double h : {0.3, 0.1, 0.01, 0.001}) {
    const double load = largest_load(h);
    SCOPED_TRACE(h);
    // At P_max (1 - d) the two equilibria are about y sqrt(d) from the fold.
    expect(Verdict::right, verdict(truss(h, load), {fold(h)}, Kind::stable, 2e-8 * h));
    expect(Verdict::right, verdict(truss(h, load), {fold(h)}, Kind::unstable, 2e-8 * h));
    expect(Verdict::no_equilibrium, verdict(truss(h, std::nextafter(load, 1e9)), {fold(h)}, Kind::stable, 1e-7));
    for (const double d : {1e-3, 1e-6, 1e-9, 1e-12}) {
      SCOPED_TRACE(d);
      expect(Verdict::right, verdict(truss(h, load * (1 - d)), {fold(h)}, Kind::stable, 2 * h * std::sqrt(d)));
      expect(Verdict::no_equilibrium, verdict(truss(h, load * (1 + d)), {fold(h)}, Kind::stable, 2 * h * std::sqrt(d)));
    }
  }
}

TEST(Judge, StopCarriesOrIsLeft) {
  Scene scene = pendulum();
  test::add_stop(scene, "s", 0, 1, 0.5, 1.0);
  expect(Verdict::right, verdict(scene, {0.5}, Kind::stable, 1e-15));
  expect(Verdict::no_equilibrium, verdict(scene, {1.0}, Kind::stable, 1e-10));
  // Leaning against the stop, however little: the nearest double is below pi / 2. Upright it is within 1e-16, too.
  scene.stops[0] = {.name = "s", .on = scene.stops[0].on, .min = M_PI / 2, .max = 3.0};
  expect(Verdict::right, verdict(scene, {M_PI / 2}, Kind::stable, 1e-16));
  expect(Verdict::right, verdict(scene, {M_PI / 2}, Kind::unstable, 1e-16));
  // Upright and just touching it falls to the free side.
  scene.gravity = {-1.0, 0.0};
  scene.stops[0] = {.name = "s", .on = scene.stops[0].on, .min = 0.0, .max = 3.0};
  expect(Verdict::right, verdict(scene, {0.0}, Kind::unstable));
  expect(Verdict::wrong_kind, verdict(scene, {0.0}, Kind::stable));
  expect(Verdict::wrong_kind, verdict(scene, {0.0}, Kind::neutral));
  // Hanging and just touching it is stable.
  scene.gravity = {1.0, 0.0};
  expect(Verdict::right, verdict(scene, {0.0}, Kind::stable));
  expect(Verdict::wrong_kind, verdict(scene, {0.0}, Kind::unstable));
  scene.stops[0].min = 0.3;
  scene.stops[0].max = 0.3;
  expect(Verdict::right, verdict(scene, {0.3}, Kind::stable));
  scene.stops[0].min = scene.stops[0].max = 2.0;
  expect(Verdict::right, verdict(scene, {2.0}, Kind::stable));
}

TEST(Judge, OneWaySpringAtItsFreeAngleHoldsOneSideOnly) {
  Scene scene = pendulum();
  scene.gravity = {0.0, 0.0};
  const auto add = [&](LinearSpring::Acts acts) {
    scene.elements.push_back(
        test::make_element("torsion_spring", "t", Measure::angle_between(0, 1), LinearSpring{1.0, 0.25, acts}));
  };
  add(LinearSpring::Acts::tension);
  expect(Verdict::right, verdict(scene, {0.25}, Kind::neutral));
  expect(Verdict::wrong_kind, verdict(scene, {0.25}, Kind::stable));
  add(LinearSpring::Acts::compression);
  expect(Verdict::right, verdict(scene, {0.25}, Kind::stable));
  scene.gravity = {0.0, -1.0};
  scene.elements.clear();
  add(LinearSpring::Acts::tension);
  // V = - cos below and + (1 - 1/2) beyond its free angle, at the top where the weight is balanced.
  std::get<LinearSpring>(scene.elements[0].law).free_length = M_PI / 2;
  expect(Verdict::right, verdict(scene, {M_PI / 2}, Kind::unstable));
}

TEST(Judge, BalancedArmIsNeutral) {
  Scene scene = test::chain(1, 1.0, 0.0);
  scene.gravity = {0.0, -1.0};
  scene.bodies[1].mass = 1.0;
  scene.bodies[1].center = {0.0, 0.0};
  scene.elements.push_back(test::torsion_spring("idle", 0, 1, 0.0));
  test::add_force(scene, "1.b", {0.0, -3.0}, "P");
  const PointRef c = scene.add_point(1, "c", {-3.0, 0.0});
  Force other;
  other.name = "Q";
  other.at = c;
  other.vector = {0.0, -1.0};
  scene.forces.push_back(other);
  expect(Verdict::right, verdict(scene, {0.7}, Kind::neutral));
  expect(Verdict::wrong_kind, verdict(scene, {0.7}, Kind::stable));
}

// Cranks of length 1 on (0, 0) and (2, 0), the coupler of length 2 flat between them; a torsion spring on each crank
// holds it at zero. The cranks turn by (1, 1) along one branch and by (1, -3) along the crossed one.
Scene flat_parallelogram(double c1, double c2) {
  Scene scene;
  scene.add_point(0, "A", {0.0, 0.0});
  scene.add_point(0, "B", {2.0, 0.0});
  test::add_link(scene, "first", 1.0);
  test::add_link(scene, "second", 1.0);
  test::add_link(scene, "coupler", 2.0);
  test::add_pin(scene, "ground.A", "first.a");
  test::add_pin(scene, "ground.B", "second.a");
  test::add_pin(scene, "first.b", "coupler.a");
  test::add_pin(scene, "coupler.b", "second.b");
  test::add_torsion_spring(scene, 0, 1, c1);
  test::add_torsion_spring(scene, 0, 2, c2);
  return scene;
}

TEST(Judge, ChangePointIsStableIfEnergyGrowsAlongBothBranches) {
  expect(Verdict::right, verdict(flat_parallelogram(1.0, 1.0), {0.0, 0.0, 0.0}, Kind::stable));
  expect(Verdict::wrong_kind, verdict(flat_parallelogram(1.0, 1.0), {0.0, 0.0, 0.0}, Kind::unstable));
  // A force along the cranks adds -1 to the curvature of the first one: unstable along both branches, or along one.
  for (const auto& [c1, c2] : {std::pair{0.1, 0.05}, {0.5, 0.1}, {0.1, 0.2}}) {
    Scene pressed = flat_parallelogram(c1, c2);
    test::add_force(pressed, "first.b", {-1.0, 0.0}, "P");
    expect(Verdict::right, verdict(pressed, {0.0, 0.0, 0.0}, Kind::unstable));
    expect(Verdict::wrong_kind, verdict(pressed, {0.0, 0.0, 0.0}, Kind::stable));
  }
  // A force across them is balanced by no finite joint forces but along the branches.
  Scene pushed = flat_parallelogram(1.0, 1.0);
  test::add_force(pushed, "first.b", {0.0, 0.1}, "P");
  EXPECT_NE(verdict(pushed, {0.0, 0.0, 0.0}, Kind::stable).verdict, Verdict::right);
}

TEST(Judge, FollowerLoadDivergesOrDoesNot) {
  // A link on a torsion spring: the follower adds no stiffness where it follows the link.
  Scene scene = test::chain(1, 1.0, 0.0);
  test::add_torsion_spring(scene, 0, 1, 1.0);
  Force force;
  force.name = "F";
  force.at = test::point(scene, "1.b");
  force.vector = {0.0, 0.5};
  force.follows = 1;
  scene.forces.push_back(force);
  expect(Verdict::right, verdict(scene, {0.5}, Kind::stable, 1e-15));
  expect(Verdict::no_equilibrium, verdict(scene, {0.6}, Kind::stable));
}

TEST(Judge, PinWrittenTwiceLeavesTheLinkFree) {
  Scene scene;
  scene.gravity = {0.0, -1.0};
  scene.add_point(0, "A", {0.3, 0.0});
  scene.add_point(0, "B", {0.1 + 0.2, 0.0});
  const int link = test::add_link(scene, "link", 1.0, 1.0);
  scene.add_point(link, "A", {0.3, 0.0});
  scene.add_point(link, "B", {0.1 + 0.2, 0.0});
  test::add_pin(scene, "ground.A", "link.A");
  test::add_pin(scene, "ground.B", "link.B");
  scene.start.angle[link] = M_PI / 2;
  // Above the pin its weight falls, below it hangs.
  expect(Verdict::wrong_kind, verdict(scene, {M_PI / 2}, Kind::stable));
  expect(Verdict::right, verdict(scene, {M_PI / 2}, Kind::unstable, 1e-14));
  expect(Verdict::right, verdict(scene, {-M_PI / 2}, Kind::stable, 1e-14));
}

TEST(Judge, RedundantJointsAgreeToRounding) {
  Scene scene = test::windows(3);
  for (int i = 1; i <= 3; ++i) scene.stops.clear();
  const StaticModel model(scene);
  std::vector<double> x(static_cast<std::size_t>(model.mechanism().coordinates()), 0.0);
  for (std::size_t t = 0; t < x.size(); ++t) {
    if (model.layout().coordinates[t].name.starts_with("post")) x[t] = -M_PI / 2;
  }
  expect(Verdict::right, verdict(scene, x, Kind::stable, 1e-14));
  for (double& v : x) v = -v;
  expect(Verdict::right, verdict(scene, x, Kind::unstable, 1e-14));
  expect(Verdict::wrong_kind, verdict(scene, x, Kind::stable, 1e-14));
}

TEST(Judge, PlaceOfTheOriginDoesNotMatter) {
  Scene scene = pendulum();
  scene.bodies[0].points[0].at = {1e6, -3e5};
  expect(Verdict::right, verdict(scene, {-M_PI / 2}, Kind::stable, 1e-15));
  expect(Verdict::wrong_kind, verdict(scene, {-M_PI / 2}, Kind::unstable, 1e-15));
}

}  // namespace
}  // namespace poise::judge::judge_test

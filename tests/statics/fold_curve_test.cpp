// Curves of folds in two numbers, against closed forms of the same mechanisms.

#include "statics/paths/fold_curve.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/scene_builder.hpp"
#include "statics/model/curvature.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::fold_curve_test {
namespace {

using test::dataset;
using End = FoldBranch::End;
using Status = FoldCurve::Status;

VariedPair pair_of(const std::string& file, const VariedNumber& first, const VariedNumber& second) {
  return {read_scene(dataset(file)), first, second};
}

/// Largest distance of neighbouring points of a curve.
double widest(const VariedPair& pair, const FoldBranch& curve) {
  const auto part = [](const VariedScene& of, double a, double b) { return (b - a) / (of.to() - of.from()); };
  double out = 0.0;
  for (std::size_t k = 1; k < curve.points.size(); ++k) {
    const FoldPoint &a = curve.points[k - 1], &b = curve.points[k];
    double sum =
        std::pow(part(pair.first(), a.first, b.first), 2) + std::pow(part(pair.second(), a.second, b.second), 2);
    for (std::size_t i = 0; i < a.x.size(); ++i) sum += std::pow(b.x[i] - a.x[i], 2);
    out = std::max(out, std::sqrt(sum));
  }
  return out;
}

int changes_of_sign(const FoldBranch& curve) {
  int count = 0;
  for (std::size_t k = 1; k < curve.points.size(); ++k) {
    count += (curve.points[k - 1].coefficient > 0.0) != (curve.points[k].coefficient > 0.0);
  }
  return count;
}

// --- Zeeman's machine -----------------------------------------------------------------------------------------------

// The disc turns about (1, 0), its rim point at r(t) = (1 + cos t / 2, sin t / 2); springs of stiffness 1 and free
// length L = 1/4 lead to the origin and to the hand h. With  s_c = |r - c|,
//   V(t) = (s_0 - L)^2 / 2 + (s_h - L)^2 / 2,   s_c^2 = |(1, 0) - c|^2 + 1/4 + ((1, 0) - c) . (cos t, sin t),
// folds have V' = V'' = 0 and cusps V''' = 0 besides.
struct Slopes {
  double first, second, third;
};
Slopes energy_of_disc(double t, double hand_x, double hand_y) {
  constexpr double L = 0.25;
  Slopes sum{};
  const std::array<std::array<double, 2>, 2> ends{{{0.0, 0.0}, {hand_x, hand_y}}};
  for (const auto& [x, y] : ends) {
    const double dx = 1.0 - x, dy = -y;
    const double u = dx * dx + dy * dy + 0.25 + dx * std::cos(t) + dy * std::sin(t);
    const double u1 = -dx * std::sin(t) + dy * std::cos(t), u2 = -dx * std::cos(t) - dy * std::sin(t);
    const double s = std::sqrt(u), s1 = u1 / 2 / s, s2 = (u2 / 2 - s1 * s1) / s, s3 = (-u1 / 2 - 3 * s1 * s2) / s;
    sum.first += u1 / 2 - L * s1;
    sum.second += u2 / 2 - L * s2;
    sum.third += -u1 / 2 - L * s3;
  }
  return sum;
}

// Cusps on the axis: V'' = 0 at t = pi is x^2 - 9/4 x + 1 = 0, at t = 0 it is (x - 1) (x - 7/4) / (x - 3/2) = 5/6. The
// others are roots of V' = V'' = V''' = 0 by Newton's method in 34 digits (mpmath).
struct DiscCusp {
  double angle, x, y;
};
const std::vector<DiscCusp> disc_cusps = {
    {M_PI, 1.640388203202207568727676232, 0.0},
    {1.47016845802174049879837726429, 1.97981632864681142527013566068, -0.199899880232789595206816838225},
    {-1.47016845802174049879837726429, 1.97981632864681142527013566068, 0.199899880232789595206816838225},
    {0.0, 2.25, 0.0}};

TEST(FoldCurve, ZeemansMachineHasFourCuspsOnOneClosedCurve) {
  for (const DiscCusp& cusp : disc_cusps) {
    const Slopes slopes = energy_of_disc(cusp.angle, cusp.x, cusp.y);
    EXPECT_LT(std::max({std::abs(slopes.first), std::abs(slopes.second), std::abs(slopes.third)}), 1e-15);
  }
  const VariedPair pair =
      pair_of("zeeman.toml", {"point.ground.hand.x", 1.5, 2.4}, {"point.ground.hand.y", -0.4, 0.45});
  const FoldCurve folds = fold_curve(pair);
  EXPECT_EQ(folds.status, Status::traced);
  EXPECT_EQ(folds.why, "");
  ASSERT_EQ(folds.curves.size(), 1U);
  const FoldBranch& curve = folds.curves[0];
  // The disc goes round once.
  EXPECT_EQ(curve.end, (std::array{End::closed, End::closed}));
  EXPECT_NEAR(std::abs(curve.points.back().x[0] - curve.points.front().x[0]), 2 * M_PI, 1e-9);
  for (const FoldPoint& point : curve.points) {
    const Slopes slopes = energy_of_disc(point.x[0], point.first, point.second);
    EXPECT_LT(std::abs(slopes.first), 1e-14);
    EXPECT_LT(std::abs(slopes.second), 1e-14);
    EXPECT_EQ(point.unstable_directions, 0);
  }
  ASSERT_EQ(folds.cusps.size(), 4U);
  for (const DiscCusp& known : disc_cusps) {
    const auto nearest = std::min_element(folds.cusps.begin(), folds.cusps.end(), [&](const auto& a, const auto& b) {
      const auto distance = [&](const FoldCusp& c) { return std::hypot(c.at.first - known.x, c.at.second - known.y); };
      return distance(a) < distance(b);
    });
    EXPECT_NEAR(nearest->at.first, known.x, 1e-14);
    EXPECT_NEAR(nearest->at.second, known.y, 1e-14);
    EXPECT_NEAR(std::remainder(nearest->at.x[0] - known.angle, 2 * M_PI), 0.0, 1e-6);
    EXPECT_GE(nearest->digits(), 14);
    EXPECT_LT(nearest->error, 1e-14);
  }
  // Smoothly through all of them.
  EXPECT_EQ(changes_of_sign(curve), 4);
  EXPECT_LT(widest(pair, curve), 1.01 * FoldCurveOptions{}.spacing);
}

TEST(FoldCurve, TheMachineOfTheHardCatalogueHasItsCuspOnTheAxis) {
  const FoldCurve folds = fold_curve(
      pair_of("hard/zeeman_cusp.toml", {"point.ground.hand.y", -0.1, 0.1}, {"point.ground.fixed.x", -0.4, -0.1}));
  EXPECT_EQ(folds.status, Status::traced);
  ASSERT_EQ(folds.cusps.size(), 1U);
  EXPECT_NEAR(folds.cusps[0].at.first, 0.0, 1e-14);
  EXPECT_NEAR(folds.cusps[0].at.second, -0.25, 1e-14);
  EXPECT_NEAR(folds.cusps[0].at.x[0], M_PI, 1e-6);
}

// --- the imperfect pendulum -----------------------------------------------------------------------------------------

// A weight on an upright rod with a torsion spring k unstressed at e aside: k (t - e) = sin t, folds where k = cos t,
// so that e = t - tan t. At the perfect one, e = 0, there is a cusp.
constexpr const char* stiffness = "torsion_spring.spring.stiffness";
constexpr const char* free_angle = "torsion_spring.spring.free_angle";

VariedPair pendulum(double from_imperfection, double to_imperfection) {
  return pair_of("hard/imperfect_pendulum.toml", {stiffness, 0.8, 1.2},
                 {free_angle, M_PI / 2 + from_imperfection, M_PI / 2 + to_imperfection});
}

TEST(FoldCurve, FoldLoadsOfAnImperfectPendulumMeetInACusp) {
  const VariedPair pair = pendulum(-0.1, 0.1);
  const FoldCurve folds = fold_curve(pair, {.spacing = 0.005});
  EXPECT_EQ(folds.status, Status::traced);
  ASSERT_EQ(folds.curves.size(), 1U);
  EXPECT_EQ(folds.curves[0].end, (std::array{End::range, End::range}));
  ASSERT_EQ(folds.cusps.size(), 1U);
  EXPECT_EQ(folds.curves[0].cusps, std::vector<int>{0});
  EXPECT_NEAR(folds.cusps[0].at.first, 1.0, 1e-15);
  EXPECT_NEAR(folds.cusps[0].at.second, M_PI / 2, 1e-15);
  int near = 0;
  for (const FoldPoint& point : folds.curves[0].points) {
    const double t = point.x[0] - M_PI / 2, imperfection = point.second - M_PI / 2;
    EXPECT_NEAR(point.first, std::cos(t), 1e-14);
    EXPECT_NEAR(imperfection, t - std::tan(t), 1e-14);
    // V''' = k t - sin t's third derivative: V = k (t - e)^2 / 2 + cos t.
    EXPECT_NEAR(std::abs(point.coefficient), std::abs(std::sin(t)), 1e-7);
    // Koiter: the load falls by (9/8)^(1/3) |e|^(2/3), 1/2 (3 e)^(2/3), next to the perfect one.
    if (std::abs(t) > 0.1 || std::abs(t) < 1e-3) continue;
    ++near;
    EXPECT_NEAR((1.0 - point.first) / std::cbrt(9.0 / 8.0 * imperfection * imperfection), 1.0, t * t);
  }
  EXPECT_GT(near, 10);
  EXPECT_LT(widest(pair, folds.curves[0]), 1.01 * 0.005);
}

TEST(FoldCurve, EndsExactlyAtTheEndOfTheRange) {
  // references static.inverted_pendulum_imperfect, 1e-2: the fold load 1.04897323447748318843 over k.
  const FoldCurve folds = fold_curve(pendulum(-0.05, 0.01));
  ASSERT_EQ(folds.curves.size(), 1U);
  const std::vector<FoldPoint>& points = folds.curves[0].points;
  const FoldPoint& last = points.front().second > points.back().second ? points.front() : points.back();
  EXPECT_EQ(last.second, M_PI / 2 + 0.01);
  EXPECT_NEAR(last.first, 1.0 / 1.04897323447748318843, 1e-14);
  EXPECT_NEAR(last.x[0] - M_PI / 2, -0.306772547185126073907, 1e-13);
}

TEST(FoldCurve, EndsWhereAStopIsMet) {
  Scene scene = read_scene(dataset("hard/imperfect_pendulum.toml"));
  test::add_stop(scene, "left", 0, 1, M_PI / 2 - 0.5, M_PI / 2 + 0.4);
  const VariedPair pair(scene, {stiffness, 0.8, 1.2}, {free_angle, M_PI / 2 - 0.1, M_PI / 2 + 0.1});
  const FoldCurve folds = fold_curve(pair);
  EXPECT_EQ(folds.status, Status::traced);
  ASSERT_EQ(folds.curves.size(), 1U);
  const FoldBranch& curve = folds.curves[0];
  EXPECT_EQ(curve.end, (std::array{End::piece, End::piece}));
  for (const std::string& why : curve.why)
    EXPECT_NE(why.find("the stop \"left\" is met at torsion"), std::string::npos);
  for (const FoldPoint* end : {&curve.points.front(), &curve.points.back()}) {
    const double t = end->x[0] > M_PI / 2 ? 0.4 : -0.5;
    EXPECT_NEAR(end->x[0] - M_PI / 2, t, 1e-12);
    EXPECT_NEAR(end->first, std::cos(t), 1e-12);
    EXPECT_NEAR(end->second - M_PI / 2, t - std::tan(t), 1e-12);
    EXPECT_TRUE(end->active_stops.empty());
  }
}

TEST(FoldCurve, FollowsFoldsUnderFollowerLoads) {
  // A force of 0.02 across the rod that turns with it is a torque of 0.02: k (t - e) = sin t + 0.02, k = cos t.
  Scene scene = SceneBuilder("pushed pendulum")
                    .gravity({0, -1})
                    .ground_point("O", {0, 0})
                    .body("rod", {.points = {{"O", {0, 0}}, {"tip", {1, 0}}}, .mass = 1, .center = {1, 0}})
                    .pin("ground.O", "rod.O")
                    .element("torsion_spring", "spring", measures::angle("ground", "rod"),
                             {{"stiffness", 1}, {"free_angle", 1.58}})
                    .force("push", "rod.tip", {0, 0.02}, "rod")
                    .start("rod", 1.3)
                    .build();
  const VariedPair pair(scene, {stiffness, 0.8, 1.2}, {free_angle, M_PI / 2 - 0.1, M_PI / 2 + 0.1});
  const FoldCurve folds = fold_curve(pair);
  EXPECT_EQ(folds.status, Status::traced);
  ASSERT_EQ(folds.curves.size(), 1U);
  ASSERT_EQ(folds.cusps.size(), 1U);
  EXPECT_NEAR(folds.cusps[0].at.first, 1.0, 1e-14);
  EXPECT_NEAR(folds.cusps[0].at.second, M_PI / 2 - 0.02, 1e-14);
  for (const FoldPoint& point : folds.curves[0].points) {
    const double t = point.x[0] - M_PI / 2;
    EXPECT_NEAR(point.first, std::cos(t), 1e-13);
    EXPECT_NEAR(point.second - M_PI / 2, t - std::tan(t) - 0.02 / std::cos(t), 1e-13);
    EXPECT_EQ(point.unstable_directions, -1);
  }
}

TEST(FoldCurve, BranchPointsThatNeitherNumberDisturbsAreCounted) {
  // Upright and symmetric whatever its stiffness and its mass.
  const FoldCurve folds =
      fold_curve(pair_of("inverted_pendulum_torsion.toml", {stiffness, 5, 15}, {"body.rod.mass", 0.5, 1.5}));
  EXPECT_EQ(folds.status, Status::no_fold);
  EXPECT_GT(folds.symmetric, 0);
  EXPECT_NE(folds.why.find("neither number disturbs"), std::string::npos);
}

// --- snap-through ---------------------------------------------------------------------------------------------------

TEST(FoldCurve, TheSnapThroughLoadOfATrussGrowsWithItsStiffness) {
  Scene scene = read_scene(dataset("von_mises_toggle.toml"));
  // One spring alone: the load over its stiffness is half of what the reference's two bear with 1000 N/m each.
  std::get<LinearSpring>(scene.elements[1].law).stiffness = 0.0;
  const VariedPair pair(scene, {"load.P", -60, 60}, {"spring.left.stiffness", 1000, 2000});
  const FoldCurve folds = fold_curve(pair);
  EXPECT_EQ(folds.status, Status::traced);
  ASSERT_EQ(folds.curves.size(), 2U);
  EXPECT_TRUE(folds.cusps.empty());
  for (const FoldBranch& curve : folds.curves) {
    EXPECT_EQ(curve.end, (std::array{End::range, End::range}));
    EXPECT_EQ(std::min(curve.points.front().second, curve.points.back().second), 1000.0);
    for (const FoldPoint& point : curve.points) {
      EXPECT_NEAR(std::abs(point.first) / point.second, 0.0429143257312246876869530451065 / 2, 1e-15);
      // V''' = 3 k l0 h b^2 / l^5 with b = 1 m, in lengths of the mechanism's size.
      const auto model = pair.model_at(point.first, point.second);
      const double h = model->to_si(point.x)[0], l = std::hypot(1.0, h), l0 = 1.118033988749894848204587;
      const double third = 3 * point.second * l0 * h / std::pow(l, 5) * std::pow(model->scales().length, 3);
      EXPECT_NEAR(std::abs(point.coefficient), std::abs(third), 1e-8 * std::abs(third));
    }
  }
}

TEST(FoldCurve, EndsWhereAOneWayRopeTightens) {
  Scene scene = SceneBuilder("leaning springs with a rope")
                    .ground_point("L", {-1, 0})
                    .ground_point("R", {1, 0})
                    .ground_point("O", {0, 0})
                    .body("apex", {.points = {{"C", {0, 0}}}})
                    .slide("ground.O", "apex.C", {0, 1}, "guide")
                    .element("spring", "left", measures::distance("ground.L", "apex.C"),
                             {{"stiffness", 1000}, {"free_length", 1.118}})
                    .element("spring", "right", measures::distance("ground.R", "apex.C"),
                             {{"stiffness", 1000}, {"free_length", 1.118}})
                    .element("spring", "rope", measures::distance("ground.O", "apex.C"),
                             {{"stiffness", 1}, {"free_length", 0.25}, {"acts", "tension"}})
                    .force("P", "apex.C", {0, -1})
                    .start("guide", 0.5)
                    .build();
  const VariedPair pair(scene, {"load.P", 10, 60}, {"point.ground.L.y", -0.2, 0.2});
  const FoldCurve folds = fold_curve(pair);
  ASSERT_FALSE(folds.curves.empty());
  int met = 0;
  for (const FoldBranch& curve : folds.curves) {
    for (const std::size_t side : {0U, 1U}) {
      if (curve.end[side] != End::piece) continue;
      ++met;
      const FoldPoint& end = side == 0 ? curve.points.front() : curve.points.back();
      EXPECT_NEAR(std::abs(pair.model_at(end.first, end.second)->to_si(end.x)[0]), 0.25, 1e-12);
      const bool slack = !end.slack_springs.empty();
      EXPECT_NE(curve.why[side].find(slack ? "\"rope\" begins to act" : "\"rope\" goes slack"), std::string::npos);
    }
  }
  EXPECT_GT(met, 0);
}

TEST(FoldCurve, FoldsOfAPressAreSingularEquilibriaAllAlong) {
  // Loops, a one-way spring, weights; all folds against the tangent stiffness at their poses.
  const VariedPair pair = pair_of("toggle_press.toml", {"load.T", 300, 900}, {"spring.work.stiffness", 10, 30});
  const FoldCurve folds = fold_curve(pair, {.from = PathOptions::From::equilibrium, .slices = 3});
  ASSERT_EQ(folds.curves.size(), 1U);
  EXPECT_EQ(folds.curves[0].end, (std::array{End::range, End::range}));
  for (const FoldPoint& point : folds.curves[0].points) {
    const auto model = pair.model_at(point.first, point.second);
    const Mechanism<double>& m = model->mechanism();
    std::vector<int> rows(static_cast<std::size_t>(m.equalities()));
    for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = static_cast<int>(r);
    DensePoint<double> at(m, point.x, rows);
    const Eigen::VectorXd y = at.multipliers();
    EXPECT_LT((at.force + at.jacobian.transpose() * y).cwiseAbs().maxCoeff(), 1e-11);
    const ReducedHessian reduced(m, point.x, rows);
    ASSERT_EQ(reduced.matrix.rows(), 1);
    EXPECT_LT(std::abs(reduced.matrix(0, 0)), 1e-11 * reduced.largest);
  }
}

TEST(FoldCurve, FindsCuspsOfAMechanismWithLoops) {
  const VariedPair pair = pair_of("toggle_press.toml", {"load.T", 0, 400}, {"point.upper.N.x", 330, 345});
  const FoldCurve folds = fold_curve(pair, {.slices = 3});
  ASSERT_EQ(folds.cusps.size(), 2U);
  for (const FoldCusp& cusp : folds.cusps) {
    EXPECT_GE(cusp.digits(), 12);
    // Three equilibria on one side, one on the other: along the curve, the load turns.
    EXPECT_LT(std::abs(cusp.at.coefficient), 1e-6);
  }
}

// --- how it ends ----------------------------------------------------------------------------------------------------

TEST(FoldCurve, SaysWhereItIsStuck) {
  // The hand comes to the rim: the spring has no length and no direction.
  const FoldCurve folds =
      fold_curve(pair_of("zeeman.toml", {"point.ground.hand.x", 0.3, 0.8}, {"point.ground.hand.y", -0.3, 0.35}));
  EXPECT_EQ(folds.status, Status::incomplete);
  ASSERT_FALSE(folds.curves.empty());
  EXPECT_EQ(folds.curves[0].end[0], End::stuck);
  EXPECT_NE(folds.why.find("no step along the curve succeeds at point.ground.hand.x = 0.54"), std::string::npos)
      << folds.why;
}

TEST(FoldCurve, StopsAtTheLimitOfPoints) {
  const FoldCurve folds = fold_curve(pendulum(-0.1, 0.1), {.most_points = 20});
  EXPECT_EQ(folds.status, Status::incomplete);
  EXPECT_EQ(folds.why, "20 points were not enough");
  ASSERT_EQ(folds.curves.size(), 1U);
  EXPECT_EQ(folds.curves[0].end[1], End::limit);
  EXPECT_LE(folds.curves[0].points.size(), 21U);
}

TEST(FoldCurve, KeepsWhatItHasWhenInterrupted) {
  std::atomic<bool> stop = false;
  FoldCurveOptions options;
  options.interrupt = &stop;
  options.progress = [&](double /*first*/, double /*second*/, int points) { stop = points >= 32; };
  const FoldCurve folds = fold_curve(pendulum(-0.1, 0.1), options);
  EXPECT_EQ(folds.status, Status::interrupted);
  ASSERT_EQ(folds.curves.size(), 1U);
  EXPECT_GE(folds.curves[0].points.size(), 32U);
  EXPECT_LT(folds.curves[0].points.size(), 50U);
  EXPECT_EQ(folds.curves[0].end[1], End::interrupted);
}

TEST(FoldCurve, SaysThatThereIsNoFold) {
  const FoldCurve folds =
      fold_curve(pair_of("von_mises_toggle.toml", {"load.P", 1, 10}, {"spring.left.stiffness", 900, 1100}));
  EXPECT_EQ(folds.status, Status::no_fold);
  EXPECT_NE(folds.why.find("no smooth fold of load.P was met at 9 values of spring.left.stiffness"), std::string::npos);
}

TEST(FoldCurve, SaysThatNothingComesToRest) {
  const Scene scene =
      SceneBuilder("runaway")
          .ground_point("O", {0, 0})
          .ground_point("Q", {0, 2})
          .body("block", {.points = {{"C", {0, 0}}}})
          .slide("ground.O", "block.C", {1, 0})
          .element("constant_force", "band", measures::distance("ground.Q", "block.C"), {{"force", 0.1}})
          .force("P", "block.C", {1, 0})
          .build();
  const FoldCurve folds = fold_curve({scene, {"load.P", 1, 2}, {"point.ground.Q.y", 2, 3}});
  EXPECT_EQ(folds.status, Status::no_start);
  EXPECT_EQ(folds.slices_without_start, 18);
  EXPECT_NE(folds.why.find("no equilibrium to begin with"), std::string::npos) << folds.why;
}

TEST(FoldCurve, LeavesLargeMechanismsAlone) {
  const FoldCurve folds = fold_curve({test::hanging_chain(420, 3, 1, 2), {"gravity.y", -10, -9}, {"gravity.x", 0, 1}});
  EXPECT_EQ(folds.status, Status::too_large);
  EXPECT_NE(folds.why.find("up to 400 coordinates and closures"), std::string::npos);
}

std::string message_of(const VariedNumber& first, const VariedNumber& second) {
  try {
    pair_of("von_mises_toggle.toml", first, second);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(FoldCurve, RefusesNumbersThatAreNotTwo) {
  EXPECT_EQ(message_of({"load.P", 0, 1}, {"load.P", 0, 2}), "load.P: named twice; expected two different numbers");
  EXPECT_EQ(message_of({"load.P", 0, 1}, {"travel.guide", 0, 2}),
            "travel.guide: a driven measure can be the first number only; name it first");
  EXPECT_EQ(message_of({"load.P", 0, 1}, {"loads", 0, 2}),
            "load.P: \"loads\" multiplies it; expected a number apart from it");
  EXPECT_NE(message_of({"load.Q", 0, 1}, {"loads", 0, 2}).find("load.Q"), std::string::npos);
  EXPECT_NE(message_of({"load.P", 0, 1}, {"spring.left.stiffness", 2, 2}).find("has no length"), std::string::npos);
}

}  // namespace
}  // namespace poise::fold_curve_test

#include "motion/impact.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "solvers/complementarity.hpp"

namespace poise::impact_test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

// M z + q >= 0 and z >= 0, one of both zero.
TEST(Complementarity, SolvesRandomProblems) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Index m = 1 + k % 7, rank = 1 + (k / 7) % m;
    const MatrixXd A = MatrixXd::NullaryExpr(m, rank, [&] { return normal(random); });
    const MatrixXd M = A * A.transpose();
    // So that z exists with M z + q >= 0, where M is singular too.
    const VectorXd q = k % 2 == 0 ? VectorXd(A * VectorXd::NullaryExpr(rank, [&] { return normal(random); }))
                                  : VectorXd(-M * VectorXd::NullaryExpr(m, [&] { return std::abs(normal(random)); }));
    const std::optional<VectorXd> z = solvers::solve_complementarity(M, q);
    ASSERT_TRUE(z) << k;
    const VectorXd w = M * *z + q;
    EXPECT_GE(z->minCoeff(), 0.0);
    EXPECT_GE(w.minCoeff(), -1e-9 * (1 + q.norm())) << k;
    EXPECT_NEAR(z->dot(w), 0.0, 1e-8 * (1 + q.norm()) * (1 + z->norm())) << k;
  }
}

TEST(Impact, OneSideReboundsByEveryLaw) {
  for (const ImpactLaw law : {ImpactLaw::energetic, ImpactLaw::newton, ImpactLaw::poisson}) {
    const Impact found = impact(MatrixXd::Constant(1, 1, 0.5), {{-2.0, 0.6}}, law);
    ASSERT_TRUE(found.found);
    EXPECT_NEAR(found.impulse[0], 1.6 * 2 / 0.5, 1e-14);
    EXPECT_NEAR(found.rate[0], 1.2, 1e-14);
    EXPECT_NEAR(found.energy_lost, (4 - 1.44) / 2 / 0.5, 1e-13);
    EXPECT_TRUE(found.unique);
  }
}

// Three balls of 1 kg that touch, of which the first is hit at 1 m/s: one impulse after the other would send the last
// one away alone; the laws at both places at once do not, and say that they are not alone.
TEST(Impact, ACradleIsNotUnique) {
  MatrixXd D(2, 2);
  D << 2, -1, -1, 2;
  for (const ImpactLaw law : {ImpactLaw::energetic, ImpactLaw::newton, ImpactLaw::poisson}) {
    const Impact found = impact(D, {{-1.0, 1.0}, {0.0, 1.0}}, law);
    ASSERT_TRUE(found.found);
    EXPECT_FALSE(found.unique);
    EXPECT_NEAR(found.energy_lost, 0.0, 1e-14);
  }
  // Without restitution all three go on together, whatever the order.
  const Impact plastic = impact(D, {{-1.0, 0.0}, {0.0, 0.0}}, ImpactLaw::energetic);
  EXPECT_TRUE(plastic.unique);
  EXPECT_NEAR(plastic.energy_lost, 0.5 - 3 * 0.5 / 9, 1e-14);
}

// Two uniform rods of 1 kg and 1 m in series, at 20 and 30 degrees from straight down at -0.1 and -0.2 rad/s, whose tip
// strikes a floor (after T. R. Kane, A dynamics puzzle, 1984; values of ../shared/benchmarks.md 1.5).
struct TwoRods {
  MatrixXd D = MatrixXd(2, 2);
  Vector2d across, along, rates{-0.1, -0.2};
  Eigen::Matrix2d mass;

  TwoRods() {
    const double a = 20 * std::numbers::pi / 180, b = 30 * std::numbers::pi / 180;
    across = {std::sin(a), std::sin(b)};
    along = {std::cos(a), std::cos(b)};
    mass << 4.0 / 3, std::cos(b - a) / 2, std::cos(b - a) / 2, 1.0 / 3;
    Eigen::Matrix2d W;
    W.row(0) = across;
    W.row(1) = along;
    D = W * mass.inverse() * W.transpose();
  }
  ImpactSide side(double e, double mu) const { return {across.dot(rates), e, mu, along.dot(rates)}; }
  Vector2d after(const Impact& found) const {
    return rates + mass.inverse() * (across * found.impulse[0] + along * found.rub[0]);
  }
};

TEST(Impact, KanesRodsGainEnergyByNewtonsLaw) {
  const TwoRods rods;
  EXPECT_NEAR(rods.side(0, 0).rate, -0.134202014333, 1e-12);
  EXPECT_NEAR(rods.side(0, 0).slip, -0.267174342835, 1e-12);
  const auto expect = [&](double e, double mu, double first, double second, double pushed, double rubbed,
                          double energy) {
    // One side with friction is one complementarity problem by Newton's law.
    const Impact found = impact(rods.D, {rods.side(e, mu)}, ImpactLaw::newton);
    ASSERT_TRUE(found.found);
    const Vector2d after = rods.after(found);
    EXPECT_NEAR(after[0], first, 1e-8);
    EXPECT_NEAR(after[1], second, 1e-8);
    EXPECT_NEAR(found.impulse[0], pushed, 1e-8);
    EXPECT_NEAR(found.rub[0], rubbed, 1e-8);
    EXPECT_NEAR(0.5 * after.dot(rods.mass * after), energy, 1e-12);
    EXPECT_NEAR(found.energy_lost, 0.0231814108635 - energy, 1e-12);
    EXPECT_EQ(found.gains, energy > 0.0231814108635);
  };
  expect(0.7, 0.0, -0.24790298, 0.35745845, 0.22598296, 0.0, 0.0186323055657);
  expect(0.7, 0.25, -0.28649787, 0.38385891, 0.36257377, -0.09064344, 0.0251266326125);
  expect(0.7, 0.5, -0.44303840, 0.49093893, 0.91658481, -0.45829241, 0.0639253154169);
  expect(0.5, 0.5, -0.33464893, 0.36311536, 0.56797988, -0.24459659, 0.0368003665813);
}

TEST(Impact, KanesRodsLoseEnergyByStrongesLaw) {
  const TwoRods rods;
  for (const double e : {0.0, 0.5, 0.7, 1.0}) {
    for (const double mu : {0.0, 0.25, 0.5, 1.0}) {
      const Impact found = impact(rods.D, {rods.side(e, mu)}, ImpactLaw::energetic);
      ASSERT_TRUE(found.found);
      EXPECT_GE(found.energy_lost, -1e-15) << e << " " << mu;
      EXPECT_LE(std::abs(found.rub[0]), mu * found.impulse[0] + 1e-15);
    }
  }
}

// Painleve's rod (../shared/benchmarks.md 1.4): the impulse of an impact without collision, until the slip stops and
// then until the end has no rate.
TEST(Impact, ASlidingRodJamsWithoutCollision) {
  const double angle = std::numbers::pi / 3, c = std::cos(angle), s = std::sin(angle);
  MatrixXd D(2, 2);
  D << 1 + 3 * c * c, -3 * s * c, -3 * s * c, 1 + 3 * s * s;
  const Impact found = impact(D, {{0.0, 0.0, 2.0, -1.0}}, ImpactLaw::energetic);
  ASSERT_TRUE(found.found);
  EXPECT_NEAR(found.impulse[0], 0.324759526419, 1e-12);
  EXPECT_NEAR(found.rub[0], 2 * 0.192272125872 + 0.399704032516 * 0.132487400547, 1e-11);
  EXPECT_NEAR(found.rate[0], 0.0, 1e-15);
  EXPECT_GT(found.energy_lost, 0.0);
}

// The energetic law never adds energy, and no law lets a gap close further.
TEST(Impact, RandomImpactsLoseEnergy) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  int several = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Eigen::Index m = 1 + k % 4, f = 1 + (k / 4) % 5;
    const bool rubs = k % 3 == 0;
    const Eigen::Index rows = rubs ? 2 * m : m;
    const MatrixXd W = MatrixXd::NullaryExpr(rows, f, [&] { return normal(random); });
    const MatrixXd D = W * W.transpose();
    const VectorXd v = VectorXd::NullaryExpr(f, [&] { return normal(random); }), u = W * v;
    std::vector<ImpactSide> sides;
    bool closes = false;
    for (Eigen::Index i = 0; i < m; ++i) {
      sides.push_back({u[i], uniform(random), 0.0, 0.0});
      closes = closes || u[i] < 0.0;
      if (rubs) {
        sides.back().friction = uniform(random);
        sides.back().slip = u[m + i];
      }
    }
    const Impact found = impact(D, sides, ImpactLaw::energetic);
    if (!found.found) {
      // Where gaps cannot all open, as with fewer freedoms than gaps, or with friction, there may be none.
      EXPECT_TRUE(f < m || rubs) << k;
      continue;
    }
    several += found.unique ? 0 : 1;
    EXPECT_FALSE(found.gains) << k << ": " << found.energy_lost;
    for (Eigen::Index i = 0; i < m; ++i) {
      const auto at = static_cast<std::size_t>(i);
      EXPECT_GE(found.impulse[at], 0.0) << k;
      EXPECT_GE(found.rate[at], -1e-8 * (1 + u.norm())) << k;
      if (!rubs) continue;
      EXPECT_LE(std::abs(found.rub[at]), sides[at].friction * found.impulse[at] * (1 + 1e-9) + 1e-12) << k;
    }
  }
  EXPECT_GT(several, 100);
}

/// Sides and their D, of m sides; those of a change are relative to it.
struct Sides {
  MatrixXd D;
  std::vector<ImpactSide> sides;

  Sides plus(const Sides& change, double part) const {
    Sides out{D + part * change.D, sides};
    for (std::size_t i = 0; i < sides.size(); ++i) {
      out.sides[i].rate += part * change.sides[i].rate;
      out.sides[i].restitution += part * change.sides[i].restitution;
      out.sides[i].friction += part * change.sides[i].friction;
      out.sides[i].slip += part * change.sides[i].slip;
    }
    return out;
  }
  VectorXd impulses(ImpactLaw law) const {
    const Impact found = impact(D, sides, law);
    VectorXd out(2 * static_cast<Eigen::Index>(sides.size()));
    if (!found.found) return {};
    out << Eigen::Map<const VectorXd>(found.impulse.data(), out.size() / 2),
        Eigen::Map<const VectorXd>(found.rub.data(), out.size() / 2);
    return out;
  }
};

// The derivatives are those of differences, where two steps of these agree: no side begins to act, slip or stick
// between them.
TEST(Impact, ImpulsesChangeAsDifferencesSay) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  int compared = 0, all = 0;
  for (int k = 0; k < 3000; ++k) {
    const Eigen::Index m = 1 + k % 3, f = 2 * m + 1;
    const bool rubs = k % 2 == 0;
    const Eigen::Index rows = rubs ? 2 * m : m;
    const auto matrix = [&] { return MatrixXd(MatrixXd::NullaryExpr(rows, f, [&] { return normal(random); })); };
    const MatrixXd W = matrix(), change = matrix();
    Sides at{W * W.transpose(), {}}, by{W * change.transpose() + change * W.transpose(), {}};
    for (Eigen::Index i = 0; i < m; ++i) {
      at.sides.push_back({-std::abs(normal(random)), 0.1 + 0.8 * uniform(random)});
      by.sides.push_back({normal(random), normal(random)});
      if (!rubs) continue;
      at.sides.back().friction = 0.1 + uniform(random);
      at.sides.back().slip = normal(random);
      by.sides.back().friction = normal(random);
      by.sides.back().slip = normal(random);
    }
    const ImpactLaw law = std::array{ImpactLaw::energetic, ImpactLaw::newton, ImpactLaw::poisson}[k / 6 % 3];
    const auto difference = [&](double h) -> VectorXd {
      const VectorXd more = at.plus(by, h).impulses(law), less = at.plus(by, -h).impulses(law);
      return more.size() == 0 || less.size() == 0 ? VectorXd() : VectorXd((more - less) / (2 * h));
    };
    const VectorXd impulse = at.impulses(law), coarse = difference(1e-5), fine = difference(2e-6);
    if (impulse.size() == 0 || coarse.size() == 0 || fine.size() == 0) continue;
    ++all;
    const double size = 1 + fine.norm();
    if ((coarse - fine).norm() > 1e-6 * size) continue;
    ++compared;
    const ImpulseChange found = impulse_change(at.D, by.D, at.sides, by.sides, law);
    for (Eigen::Index i = 0; i < m; ++i) {
      const auto side = static_cast<std::size_t>(i);
      EXPECT_NEAR(found.impulse[side], fine[i], 1e-5 * size) << k;
      EXPECT_NEAR(found.rub[side], fine[m + i], 1e-5 * size) << k;
    }
  }
  EXPECT_GT(all, 2500);
  EXPECT_GT(compared, 9 * all / 10);
}

}  // namespace
}  // namespace poise::impact_test

// What is proved of random cones must agree with many directions, each of which is looked at in double.

#include "statics/proof/private/stability_on_cones.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "tests/support/seed.hpp"

namespace poise::stability_on_cones_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using solvers::Ball;

struct Given {
  MatrixXd h;
  std::vector<VectorXd> acting, forbidden;

  Cones cones() const {
    Cones out;
    for (const auto& row : h.rowwise()) out.hessian.emplace_back(row.begin(), row.end());
    for (const VectorXd& a : acting) out.acting.emplace_back(a.begin(), a.end());
    for (const VectorXd& b : forbidden) out.forbidden.emplace_back(b.begin(), b.end());
    return out;
  }

  bool allows(const VectorXd& v) const {
    return std::all_of(forbidden.begin(), forbidden.end(), [&](const VectorXd& b) { return b.dot(v) <= 0; });
  }

  // Moved to where it is allowed, if some rounds of that suffice.
  VectorXd allowed(VectorXd v) const {
    for (int round = 0; round < 100 && !allows(v); ++round) {
      for (const VectorXd& b : forbidden) v -= 1.001 * std::max(0.0, b.dot(v)) / b.squaredNorm() * b;
    }
    return v.normalized();
  }

  double energy(const VectorXd& v) const {
    double q = v.dot(h * v);
    for (const VectorXd& a : acting) q += std::pow(std::max(0.0, a.dot(v)), 2);
    return q;
  }
};

TEST(StabilityOnCones, AgreesWithManyDirections) {
  std::mt19937_64 random(test::seed(11));
  std::normal_distribution<double> normal;
  const auto vector = [&](Eigen::Index d) {
    return VectorXd(VectorXd::NullaryExpr(d, [&] { return normal(random); }));
  };
  int decided = 0, stable = 0, locked = 0;
  const int cases = test::cases(300, 3000);
  for (int k = 0; k < cases; ++k) {
    const Eigen::Index d = 1 + k % 3;
    Given given;
    const MatrixXd half = MatrixXd::NullaryExpr(d, d, [&] { return normal(random); });
    given.h = half * half.transpose();
    const VectorXd soft = vector(d).normalized();
    given.h -= 1.5 * soft.dot(given.h * soft) * soft * soft.transpose();
    given.h = (0.5 * (given.h + given.h.transpose())).eval();
    const int acting = static_cast<int>(random() % 3), forbidden = static_cast<int>(random() % 5);
    for (int j = 0; j < acting; ++j) given.acting.push_back(vector(d));
    for (int j = 0; j < forbidden; ++j) given.forbidden.push_back(vector(d));
    const StabilityOnCones found = stability_on_cones(given.cones());
    double least = std::numeric_limits<double>::infinity();
    VectorXd lowest;
    const int directions = d == 1 ? 2 : d == 2 ? 1000 : 4000;
    for (int j = 0; j < directions; ++j) {
      const double angle = 2 * M_PI * j / directions;
      const VectorXd v = d == 1   ? VectorXd(VectorXd::Constant(1, j % 2 == 0 ? 1.0 : -1.0))
                         : d == 2 ? VectorXd(Eigen::Vector2d(std::cos(angle), std::sin(angle)))
                                  : given.allowed(vector(d));
      if (v.norm() < 0.5 || !given.allows(v) || given.energy(v) >= least) continue;
      least = given.energy(v);
      lowest = v;
    }
    // Lower still beside the lowest.
    for (int j = 0; j < directions && lowest.size() > 0; ++j) {
      const VectorXd v = (lowest + std::exp2(-20.0 * j / directions) * vector(d)).normalized();
      if (!given.allows(v) || given.energy(v) >= least) continue;
      least = given.energy(v);
      lowest = v;
    }
    const bool none = least == std::numeric_limits<double>::infinity();
    EXPECT_TRUE(found.stability != Stability::stable || least > -1e-12) << k;
    EXPECT_TRUE(!found.locked || none) << k;
    EXPECT_TRUE(least > -1e-3 || found.stability == Stability::unstable) << k;
    EXPECT_TRUE(found.stability != Stability::unstable || none || least < 0.02 * given.h.norm()) << k;
    decided += found.stability != Stability::unknown;
    stable += found.stability == Stability::stable;
    locked += found.locked;
  }
  EXPECT_GE(decided, cases * 98 / 100);
  EXPECT_GE(stable, cases / 10);
  EXPECT_GE(locked, cases / 30);
}

// The energy does not change along the edge of the cone: neither is proved.
TEST(StabilityOnCones, LeavesOpenWhatIsNeitherSign) {
  const Given edge{.h = MatrixXd{{0, 0}, {0, 1}}, .acting = {}, .forbidden = {VectorXd{{0, 1}}}};
  EXPECT_EQ(to_string(stability_on_cones(edge.cones()).stability), "unknown");
  EXPECT_FALSE(goes_on_beside(edge.cones(), 1)) << "it stays at the stop";
  const Given beside{.h = MatrixXd{{0, 0}, {0, 1}}, .acting = {}, .forbidden = {VectorXd{{1, 1}}}};
  EXPECT_TRUE(goes_on_beside(beside.cones(), 1));
  const Given blocked{.h = MatrixXd{{0, 0}, {0, 1}}, .acting = {}, .forbidden = {VectorXd{{1, 1}}, VectorXd{{-1, 1}}}};
  EXPECT_FALSE(goes_on_beside(blocked.cones(), 1));
  EXPECT_EQ(to_string(stability_on_cones(blocked.cones()).stability), "stable");
}

// Where a direction of least curvature follows the neutral one:  V = (x - y)^2 is neutral along x = y.
TEST(StabilityOnCones, NeutralMotionsMoveOtherCoordinatesToo) {
  const Given given{.h = MatrixXd{{1, -1}, {-1, 1}}, .acting = {}, .forbidden = {VectorXd{{1, -2}}}};
  EXPECT_TRUE(goes_on_beside(given.cones(), 1)) << "x = y > 0";
}

}  // namespace
}  // namespace poise::stability_on_cones_test

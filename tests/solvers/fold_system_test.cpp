// The system for curves of folds, on polynomials whose folds and cusps are known exactly.

#include "solvers/fold_system.hpp"

#include <cmath>
#include <map>
#include <memory>

#include <gtest/gtest.h>

namespace poise::solvers::fold_system_test {
namespace {

// R = x^3 - q x - p of one of both parameters while the other is held: folds at q = 3 x^2, p = -2 x^3.
class Cusp final : public ParametricProblem {
 public:
  Cusp(bool first_varies, double held) : first_varies_(first_varies), held_(held) {}

  int variables() const override { return 1; }
  int equalities() const override { return 0; }
  int rows() const override { return 0; }
  bool symmetric() const override { return true; }
  const Pattern& jacobian_pattern() const override { return none_; }
  const Pattern& tangent_pattern() const override { return one_; }
  void evaluate(std::span<const double> x, double varied, std::span<double> values, std::span<double> by) override {
    const auto [p, q] = both(varied);
    values[0] = x[0] * x[0] * x[0] - q * x[0] - p;
    if (!by.empty()) by[0] = first_varies_ ? -1.0 : -x[0];
  }
  void tangent(std::span<const double> x, double varied, std::span<const double> /*y*/,
               std::span<double> values) override {
    values[0] = 3 * x[0] * x[0] - both(varied).second;
  }
  void change(std::span<const double> x, double varied, std::span<const double> /*y*/, std::span<const double> u,
              std::span<const double> /*v*/, double w, std::span<double> values, std::span<double> by,
              std::span<double> tangent) override {
    const double q = both(varied).second;
    values[0] = (3 * x[0] * x[0] - q) * u[0] - (first_varies_ ? 1.0 : x[0]) * w;
    by[0] = first_varies_ ? 0.0 : -u[0];
    tangent[0] = 6 * x[0] * u[0] - (first_varies_ ? 0.0 : w);
  }

 private:
  std::pair<double, double> both(double varied) const {
    return first_varies_ ? std::pair(varied, held_) : std::pair(held_, varied);
  }
  bool first_varies_;
  double held_;
  Pattern none_{0, 1, {}, {}}, one_{1, 1, {0}, {0}};
};

class CuspFamily final : public CurveFamily {
 public:
  Curve& first_varies(double q) override { return make(first_, true, q); }
  Curve& second_varies(double p) override { return make(second_, false, p); }

 private:
  struct Made {
    Made(bool first_varies, double held) : problem(first_varies, held), curve(problem, {}) {}
    Cusp problem;
    Curve curve;
  };
  static Curve& make(std::unique_ptr<Made>& made, bool first_varies, double held) {
    made = std::make_unique<Made>(first_varies, held);
    return made->curve;
  }
  std::unique_ptr<Made> first_, second_;
};

FoldPlace near(double x, double p, double q) {
  FoldPlace out;
  out.z = Eigen::Vector3d(x, p, q);
  return out;
}

TEST(FoldSystem, FindsTheFoldNextToAPoint) {
  CuspFamily family;
  FoldSystem system(family);
  for (const double x : {-0.6, -0.05, 0.3, 0.5}) {
    FoldPlace place = near(x + 0.01, -2 * x * x * x - 0.01, 3 * x * x + 0.01);
    ASSERT_TRUE(system.begin(place).converged) << x;
    const double at = place.z[0];
    EXPECT_NEAR(at, x, 0.03);
    EXPECT_NEAR(place.z[1], -2 * at * at * at, 1e-15);
    EXPECT_NEAR(place.z[2], 3 * at * at, 1e-15);
    // v = w = 1 or both -1, so that the sign of the coefficient is v's.
    EXPECT_NEAR(place.coefficient, 6 * at * place.v[0], 1e-8);
    EXPECT_EQ(place.v[0], place.w[0]);
    // (1, -6 x^2, 6 x) along the curve.
    const Eigen::Vector3d along = Eigen::Vector3d(1.0, -6 * at * at, 6 * at).normalized();
    EXPECT_NEAR(std::abs(along.dot(place.tangent)), 1.0, 1e-12);
  }
}

TEST(FoldSystem, PassesThroughACuspWithoutLosingItsSense) {
  CuspFamily family;
  FoldSystem system(family);
  FoldPlace here = near(-0.3, 0.054, 0.27);
  ASSERT_TRUE(system.begin(here).converged);
  if (here.tangent[0] < 0.0) here.tangent = -here.tangent;
  const double sense = here.v[0];
  for (int k = 0; k < 60; ++k) {
    FoldPlace next = here;
    next.z += 0.01 * here.tangent;
    const auto correction = system.correct(next, here.tangent, here);
    ASSERT_TRUE(correction.converged) << k;
    EXPECT_LT(correction.first, 1e-3);
    EXPECT_GT(system.dot(next.tangent, here.tangent), 0.99);
    EXPECT_EQ(next.v[0], sense);
    EXPECT_NEAR(next.z[1], -2 * std::pow(next.z[0], 3), 1e-15);
    EXPECT_NEAR(next.z[2], 3 * std::pow(next.z[0], 2), 1e-15);
    here = next;
  }
  EXPECT_GT(here.z[0], 0.1);
}

TEST(FoldSystem, ErrorsOfTheEquationsMoveACusp) {
  CuspFamily family;
  FoldSystem system(family);
  FoldPlace cusp = near(0.0, 0.0, 0.0);
  ASSERT_TRUE(system.begin(cusp).converged);
  // R + e_1 = 0 has its cusp at p = e_1, and R_x + e_2 = 0 its double zero at q = e_2.
  const auto [first, second] = system.sensitivity(cusp);
  EXPECT_NEAR(first[0], -1.0, 1e-14);
  EXPECT_NEAR(first[1], 0.0, 1e-14);
  EXPECT_NEAR(second[0], 0.0, 1e-14);
  EXPECT_NEAR(second[1], -1.0, 1e-14);
}

TEST(FoldSystem, NothingIsFoundFarFromFolds) {
  CuspFamily family;
  FoldSystem system(family);
  FoldPlace place = near(0.0, 0.0, -2000.0);
  EXPECT_FALSE(system.begin(place).converged);
}

}  // namespace
}  // namespace poise::solvers::fold_system_test

#include "solvers/newton.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "solvers/kkt.hpp"

namespace poise::solvers::newton_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// min or stationary point of a x^2/2 + b y^2/2 + s x^4/4 - p x, on the circle x^2 + y^2 = r^2 where r > 0, with
// lo <= y <= hi. Everything about it can be worked out by hand.
class Parabola final : public Problem {
 public:
  double a = 1, b = 1, s = 0, p = 0, r = 0;
  bool potential = true;

  explicit Parabola(bool on_circle = false, double lo = -infinity, double hi = infinity) : r(on_circle ? 1.0 : 0.0) {
    const bool limited = std::isfinite(lo) || std::isfinite(hi);
    if (limited) {
      lower_ = {lo};
      upper_ = {hi};
    }
    if (on_circle) {
      jacobian_.row = {0, 0};
      jacobian_.column = {0, 1};
    }
    if (limited) {
      jacobian_.row.push_back(on_circle ? 1 : 0);
      jacobian_.column.push_back(1);
    }
    jacobian_.rows = constraints();
    jacobian_.columns = 2;
    tangent_ = {2, 2, {0, 1}, {0, 1}};
  }

  int variables() const override { return 2; }
  int equalities() const override { return r > 0 ? 1 : 0; }
  const std::vector<double>& lower() const override { return lower_; }
  const std::vector<double>& upper() const override { return upper_; }
  bool has_objective() const override { return potential; }
  const Pattern& jacobian_pattern() const override { return jacobian_; }
  const Pattern& tangent_pattern() const override { return tangent_; }
  double objective(Evaluation& at) const override {
    const double x = at.x[0];
    const double y = at.x[1];
    return a * x * x / 2 + b * y * y / 2 + s * x * x * x * x / 4 - p * x;
  }
  void evaluate(Evaluation& at) const override {
    const double x = at.x[0];
    const double y = at.x[1];
    at.gradient = {a * x + s * x * x * x - p, b * y};
    std::size_t row = 0;
    std::size_t entry = 0;
    if (r > 0) {
      at.constraint[row++] = (x * x + y * y - r * r) / 2;
      at.jacobian[entry++] = x;
      at.jacobian[entry++] = y;
    }
    if (!lower_.empty()) {
      at.constraint[row] = y;
      at.jacobian[entry] = 1;
    }
  }
  void tangent(Evaluation& at, std::span<const double> multipliers, std::span<double> values) const override {
    const double bend = r > 0 ? multipliers[0] : 0.0;
    values[0] = a + 3 * s * at.x[0] * at.x[0] + bend;
    values[1] = b + bend;
  }

 private:
  Pattern jacobian_, tangent_;
  std::vector<double> lower_, upper_;
};

NewtonOptions seeking(Goal goal, int dense_limit = 48) {
  NewtonOptions options;
  options.goal = goal;
  options.dense_limit = dense_limit;
  return options;
}

// Both linear algebras must behave the same.
class NewtonOnBoth : public testing::TestWithParam<int> {
 protected:
  NewtonOptions goal(Goal g) const { return seeking(g, GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Algebra, NewtonOnBoth, testing::Values(48, 0),
                         [](const auto& algebra) { return algebra.param == 0 ? "Sparse" : "NullSpace"; });

TEST_P(NewtonOnBoth, FindsTheMinimumOfAParabola) {
  Parabola parabola;
  parabola.p = 0.3;
  Newton newton(parabola, goal(Goal::minimum));
  const double start[] = {2.0, -1.0};
  const NewtonResult& result = newton.solve(start);
  EXPECT_EQ(result.end, NewtonEnd::converged);
  EXPECT_NEAR(result.x[0], 0.3, 1e-15);
  EXPECT_NEAR(result.x[1], 0.0, 1e-15);
}

TEST_P(NewtonOnBoth, StationaryStaysAtTheMaximumNearItAndMinimumLeavesIt) {
  Parabola parabola(true);
  parabola.a = 1;
  parabola.b = 4;
  const double near_top[] = {0.02, 0.98};
  Newton nearest(parabola, goal(Goal::stationary));
  const NewtonResult& top = nearest.solve(near_top);
  EXPECT_EQ(top.end, NewtonEnd::converged);
  EXPECT_NEAR(top.x[1], 1.0, 1e-14);
  EXPECT_NEAR(top.multipliers[0], -4.0, 1e-13);
  const double on_top[] = {0.0, 1.0};
  Newton minimum(parabola, goal(Goal::minimum));
  const NewtonResult& bottom = minimum.solve(on_top);
  EXPECT_EQ(bottom.end, NewtonEnd::converged);
  EXPECT_NEAR(std::abs(bottom.x[0]), 1.0, 1e-14);
  EXPECT_NEAR(bottom.x[1], 0.0, 1e-14);
  EXPECT_NEAR(bottom.multipliers[0], -1.0, 1e-13);
}

TEST_P(NewtonOnBoth, InequalitiesHoldWithMultipliersOfTheRightSign) {
  Parabola parabola(true, 0.5, infinity);
  parabola.a = 1;
  parabola.b = 4;
  Newton newton(parabola, goal(Goal::minimum));
  const double start[] = {0.1, 1.0};
  const NewtonResult& result = newton.solve(start);
  EXPECT_EQ(result.end, NewtonEnd::converged);
  EXPECT_NEAR(result.x[1], 0.5, 1e-14);
  EXPECT_TRUE(result.active[1]);
  // grad f + lambda grad c + mu grad y = 0: x + lambda x = 0, 4 y + lambda y + mu = 0.
  EXPECT_NEAR(result.multipliers[0], -1.0, 1e-13);
  EXPECT_NEAR(result.multipliers[1], -1.5, 1e-13);
}

TEST_P(NewtonOnBoth, AnInequalityWithAMultiplierOfWrongSignIsReleased) {
  Parabola parabola(false, 0.5, 2.0);
  parabola.b = -1.0;
  parabola.s = 1.0;
  // f falls with y: from the lower bound the answer is the upper one.
  Newton newton(parabola, goal(Goal::minimum));
  const double start[] = {0.0, 0.5};
  const NewtonResult& result = newton.solve(start);
  EXPECT_EQ(result.end, NewtonEnd::converged);
  EXPECT_NEAR(result.x[1], 2.0, 1e-14);
  EXPECT_NEAR(result.multipliers[0], 2.0, 1e-13);
}

TEST_P(NewtonOnBoth, AnUnboundedObjectiveIsReported) {
  Parabola parabola;
  parabola.b = -1.0;
  Newton newton(parabola, goal(Goal::minimum));
  const double start[] = {0.0, 0.1};
  EXPECT_EQ(newton.solve(start).end, NewtonEnd::unbounded);
}

TEST_P(NewtonOnBoth, IterationLimitIsReported) {
  Parabola parabola(true);
  parabola.b = 9;
  NewtonOptions options = goal(Goal::minimum);
  options.iterations = 2;
  Newton newton(parabola, options);
  const double start[] = {0.28, 0.96};
  EXPECT_EQ(newton.solve(start).end, NewtonEnd::iteration_limit);
}

TEST_P(NewtonOnBoth, AnInterruptStopsTheRunAndKeepsThePoint) {
  Parabola parabola(true);
  const std::atomic<bool> stop{true};
  for (const Goal g : {Goal::minimum, Goal::stationary}) {
    NewtonOptions options = goal(g);
    options.interrupt = &stop;
    Newton newton(parabola, options);
    const double start[] = {0.6, 0.8};
    const NewtonResult& result = newton.solve(start);
    EXPECT_EQ(result.end, NewtonEnd::interrupted);
    EXPECT_DOUBLE_EQ(result.x[0], 0.6);
  }
}

TEST_P(NewtonOnBoth, ARunRepeatsItself) {
  Parabola parabola(true);
  parabola.b = 3;
  Newton newton(parabola, goal(Goal::minimum));
  const double start[] = {0.0, 1.0};
  const std::vector<double> first = newton.solve(start).x;
  EXPECT_EQ(newton.solve(start).x, first);
}

// c = x^2 + y^2 + 1 has no zero.
class Impossible final : public Problem {
 public:
  int variables() const override { return 2; }
  int equalities() const override { return 1; }
  const std::vector<double>& lower() const override { return none_; }
  const std::vector<double>& upper() const override { return none_; }
  bool has_objective() const override { return true; }
  const Pattern& jacobian_pattern() const override { return jacobian_; }
  const Pattern& tangent_pattern() const override { return tangent_; }
  double objective(Evaluation& at) const override { return at.x[0]; }
  void evaluate(Evaluation& at) const override {
    at.gradient = {1, 0};
    at.constraint[0] = at.x[0] * at.x[0] + at.x[1] * at.x[1] + 1;
    at.jacobian = {2 * at.x[0], 2 * at.x[1]};
  }
  void tangent(Evaluation&, std::span<const double> multipliers, std::span<double> values) const override {
    values[0] = values[1] = 2 * multipliers[0];
  }

 private:
  std::vector<double> none_;
  Pattern jacobian_{1, 2, {0, 0}, {0, 1}}, tangent_{2, 2, {0, 1}, {0, 1}};
};

TEST_P(NewtonOnBoth, ConstraintsThatCannotHoldAreNotClosed) {
  const Impossible problem;
  Newton newton(problem, goal(Goal::minimum));
  const double start[] = {1.0, 0.5};
  const NewtonResult& result = newton.solve(start);
  EXPECT_EQ(result.end, NewtonEnd::not_closed);
  EXPECT_GE(result.constraint_error, 1.0);
}

// A field without potential: F = (y + x/2, -x + y/2) - (1, 0), linear, one zero.
class Whirl final : public Problem {
 public:
  int variables() const override { return 2; }
  int equalities() const override { return 0; }
  const std::vector<double>& lower() const override { return none_; }
  const std::vector<double>& upper() const override { return none_; }
  bool has_objective() const override { return false; }
  const Pattern& jacobian_pattern() const override { return jacobian_; }
  const Pattern& tangent_pattern() const override { return tangent_; }
  double objective(Evaluation&) const override { return 0.0; }
  void evaluate(Evaluation& at) const override { at.gradient = {at.x[1] + at.x[0] / 2 - 1, -at.x[0] + at.x[1] / 2}; }
  void tangent(Evaluation&, std::span<const double>, std::span<double> values) const override {
    values[0] = values[1] = 0.5;
    values[2] = 1;
    values[3] = -1;
  }

 private:
  std::vector<double> none_;
  Pattern jacobian_{0, 2, {}, {}}, tangent_{2, 2, {0, 1, 0, 1}, {0, 1, 1, 0}};
};

TEST(Newton, SolvesAFieldWithoutPotential) {
  const Whirl problem;
  Newton newton(problem);
  const double start[] = {0.0, 0.0};
  const NewtonResult& result = newton.solve(start);
  EXPECT_EQ(result.end, NewtonEnd::converged);
  EXPECT_NEAR(result.x[0], 0.4, 1e-15);
  EXPECT_NEAR(result.x[1], 0.8, 1e-15);
}

// F = x^2 + 1 has no zero and no potential to descend.
class NoRest final : public Problem {
 public:
  int variables() const override { return 1; }
  int equalities() const override { return 0; }
  const std::vector<double>& lower() const override { return none_; }
  const std::vector<double>& upper() const override { return none_; }
  bool has_objective() const override { return false; }
  const Pattern& jacobian_pattern() const override { return jacobian_; }
  const Pattern& tangent_pattern() const override { return tangent_; }
  double objective(Evaluation&) const override { return 0.0; }
  void evaluate(Evaluation& at) const override { at.gradient = {at.x[0] * at.x[0] + 1}; }
  void tangent(Evaluation& at, std::span<const double>, std::span<double> values) const override {
    values[0] = 2 * at.x[0];
  }

 private:
  std::vector<double> none_;
  Pattern jacobian_{0, 1, {}, {}}, tangent_{1, 1, {0}, {0}};
};

TEST(Newton, StallsWhereTheFieldHasNoZero) {
  const NoRest problem;
  Newton newton(problem);
  const double start[] = {0.7};
  EXPECT_EQ(newton.solve(start).end, NewtonEnd::stalled);
}

TEST(Newton, EveryOutcomeHasAName) {
  for (const NewtonEnd o : {NewtonEnd::not_solved, NewtonEnd::converged, NewtonEnd::not_closed, NewtonEnd::stalled,
                            NewtonEnd::unbounded, NewtonEnd::iteration_limit, NewtonEnd::interrupted}) {
    EXPECT_NE(describe(o), "unknown");
  }
}

TEST(Kkt, BothAlgebrasGiveTheSameStepAndMultipliers) {
  Parabola parabola(true, -1.0, 0.4);
  parabola.a = 2;
  parabola.b = 5;
  parabola.p = 0.7;
  Evaluation at = parabola.make_evaluation();
  at.x = {0.8, 0.45};
  parabola.evaluate(at);
  for (const bool stop : {false, true}) {
    std::vector<double> d_dense(2), d_sparse(2), y_dense(2), y_sparse(2), tangent(2);
    const double multipliers[] = {0.3, 0.0};
    parabola.tangent(at, multipliers, tangent);
    const std::vector<char> active = {1, static_cast<char>(stop)};
    const double gap[] = {at.constraint[0], 0.05};
    const auto solve = [&](Kkt& kkt, std::vector<double>& d, std::vector<double>& y) {
      kkt.set_jacobian(at, active);
      EXPECT_EQ(kkt.factor_tangent(tangent), Kkt::Factors::positive);
      kkt.solve(at.gradient, gap, d);
      kkt.solved_multipliers(at.gradient, y);
    };
    solve(*make_null_space(parabola), d_dense, y_dense);
    solve(*make_sparse_kkt(parabola), d_sparse, y_sparse);
    for (int i = 0; i < 2; ++i) {
      // The sparse factors are relaxed by 1e-13.
      EXPECT_NEAR(d_dense[i], d_sparse[i], 1e-12);
      EXPECT_NEAR(y_dense[i], y_sparse[i], 1e-12);
    }
    EXPECT_NEAR(at.x[0] * d_dense[0] + at.x[1] * d_dense[1], -gap[0], 1e-15);
    if (stop) {
      EXPECT_NEAR(d_dense[1], -gap[1], 1e-15);
    }
  }
}

TEST(Kkt, DistinguishesPositiveDefiniteFromIndefinite) {
  Parabola parabola(true);
  parabola.a = 1;
  parabola.b = 4;
  Evaluation at = parabola.make_evaluation();
  for (const bool bottom : {true, false}) {
    at.x = bottom ? std::vector<double>{1.0, 0.0} : std::vector<double>{0.0, 1.0};
    parabola.evaluate(at);
    for (const auto& kkt : {make_null_space(parabola), make_sparse_kkt(parabola)}) {
      std::vector<double> tangent(2), y(1);
      kkt->set_jacobian(at, {1});
      kkt->multipliers(at.gradient, y);
      EXPECT_NEAR(y[0], bottom ? -1.0 : -4.0, 1e-9);
      parabola.tangent(at, y, tangent);
      EXPECT_EQ(kkt->factor_tangent(tangent), bottom ? Kkt::Factors::positive : Kkt::Factors::indefinite);
      EXPECT_EQ(kkt->factor_shifted(10.0), Kkt::Factors::positive);
    }
    EXPECT_EQ(inertia_at(parabola, at.x, {1}).negative, bottom ? 0 : 1);
  }
}

}  // namespace
}  // namespace poise::solvers::newton_test

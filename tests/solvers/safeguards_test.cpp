// Each safeguard of Newton's method on the smallest problem that needs it: with it the answer is known in closed form,
// without it the run fails or ends elsewhere.

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "solvers/newton.hpp"

namespace poise::solvers::safeguards_test {
namespace {

// f(x, y) = g(x) + y^2 / 2, or its gradient as a mere field, with `repeats` copies of the constraint y = h(x).
class Groove final : public Problem {
 public:
  std::function<double(double)> g, slope, curvature;             // of the objective
  std::function<double(double)> h = [](double) { return 0.0; };  // of the constraint
  std::function<double(double)> h_slope = [](double) { return 0.0; };
  std::function<double(double)> h_curvature = [](double) { return 0.0; };

  bool potential = true;

  explicit Groove(int repeats = 0) : repeats_(repeats) {
    for (int k = 0; k < repeats; ++k) {
      jacobian_.row.insert(jacobian_.row.end(), {k, k});
      jacobian_.column.insert(jacobian_.column.end(), {0, 1});
    }
    jacobian_.rows = repeats;
    jacobian_.columns = 2;
  }

  int variables() const override { return 2; }
  int equalities() const override { return repeats_; }
  const std::vector<double>& lower() const override { return none_; }
  const std::vector<double>& upper() const override { return none_; }
  bool has_objective() const override { return potential; }
  const Pattern& jacobian_pattern() const override { return jacobian_; }
  const Pattern& tangent_pattern() const override { return tangent_; }
  double objective(Evaluation& at) const override { return g(at.x[0]) + at.x[1] * at.x[1] / 2; }
  void evaluate(Evaluation& at) const override {
    const double x = at.x[0];
    const double y = at.x[1];
    at.gradient = {slope(x), y};
    for (int k = 0; k < repeats_; ++k) {
      at.constraint[k] = y - h(x);
      at.jacobian[2 * k] = -h_slope(x);
      at.jacobian[2 * k + 1] = 1.0;
    }
  }
  void tangent(Evaluation& at, std::span<const double> multipliers, std::span<double> values) const override {
    values[0] = curvature(at.x[0]);
    for (int k = 0; k < repeats_; ++k) values[0] -= multipliers[k] * h_curvature(at.x[0]);
    values[1] = 1.0;
  }

 private:
  int repeats_;
  std::vector<double> none_;
  Pattern jacobian_, tangent_{2, 2, {0, 1}, {0, 1}};
};

// g = sqrt(1 + x^2): a full Newton step goes from x to -x^3.
Groove funnel() {
  Groove groove;
  groove.g = [](double x) { return std::sqrt(1 + x * x); };
  groove.slope = [](double x) { return x / std::sqrt(1 + x * x); };
  groove.curvature = [](double x) { return std::pow(1 + x * x, -1.5); };
  return groove;
}

// g = x^4/4 - x^2/2: a maximum at 0 between minima at -1 and 1.
Groove two_wells(int repeats = 0) {
  Groove groove(repeats);
  groove.g = [](double x) { return x * x * x * x / 4 - x * x / 2; };
  groove.slope = [](double x) { return x * x * x - x; };
  groove.curvature = [](double x) { return 3 * x * x - 1; };
  return groove;
}

NewtonOptions with(Goal goal, Safeguards safeguards) {
  NewtonOptions options;
  options.goal = goal;
  options.safeguards = safeguards;
  return options;
}

TEST(Safeguards, LineSearchShortensStepsThatOvershoot) {
  const Groove groove = funnel();
  const double start[] = {2.0, 0.0};
  for (const Goal goal : {Goal::stationary, Goal::minimum}) {
    Newton guarded(groove, with(goal, {.restarts = false, .load_stepping = false}));
    EXPECT_EQ(guarded.solve(start).end, NewtonEnd::converged);
    EXPECT_NEAR(guarded.solve(start).x[0], 0.0, 1e-15);
    Newton bare(groove, with(goal, {.line_search = false, .restarts = false, .load_stepping = false}));
    EXPECT_NE(bare.solve(start).end, NewtonEnd::converged);
  }
}

TEST(Safeguards, InertiaCorrectionLeadsAwayFromMaxima) {
  const Groove groove = two_wells();
  const double start[] = {0.2, 0.3};
  Newton guarded(groove, with(Goal::minimum, {}));
  const NewtonResult& found = guarded.solve(start);
  EXPECT_EQ(found.end, NewtonEnd::converged);
  EXPECT_NEAR(found.x[0], 1.0, 1e-15);
  Newton bare(groove, with(Goal::minimum, {.inertia_correction = false, .restarts = false, .load_stepping = false}));
  const NewtonResult& lost = bare.solve(start);
  EXPECT_FALSE(lost.end == NewtonEnd::converged && std::abs(std::abs(lost.x[0]) - 1.0) < 1e-9);
}

// On y = x/2 the objective is x^4/4 - x^2/2 + x^2/8, least at x = sqrt(3)/2, with the sum of multipliers -y.
TEST(Safeguards, RankRevealingFactorsTakeRepeatedConstraints) {
  Groove groove = two_wells(2);
  groove.h = [](double x) { return x / 2; };
  groove.h_slope = [](double) { return 0.5; };
  const double start[] = {0.7, 0.35};
  Newton guarded(groove, with(Goal::minimum, {}));
  const NewtonResult& found = guarded.solve(start);
  EXPECT_EQ(found.end, NewtonEnd::converged);
  EXPECT_NEAR(found.x[0], std::sqrt(0.75), 1e-15);
  EXPECT_NEAR(found.multipliers[0] + found.multipliers[1], -std::sqrt(0.75) / 2, 1e-14);
  Newton bare(groove, with(Goal::minimum, {.rank_revealing = false, .restarts = false, .load_stepping = false}));
  EXPECT_NE(bare.solve(start).end, NewtonEnd::converged);
}

// Full steps from 1.2 diverge, but a part of the load at a time they hold.
TEST(Safeguards, LoadSteppingIsTheLastResort) {
  Groove groove = funnel();
  groove.potential = false;
  const double start[] = {1.2, 0.0};
  NewtonOptions options = with(Goal::stationary, {.line_search = false, .restarts = false});
  Newton stepped(groove, options);
  const NewtonResult& found = stepped.solve(start);
  EXPECT_EQ(found.end, NewtonEnd::converged);
  EXPECT_TRUE(found.load_stepped);
  EXPECT_NEAR(found.x[0], 0.0, 1e-12);
  options.safeguards.load_stepping = false;
  Newton bare(groove, options);
  EXPECT_NE(bare.solve(start).end, NewtonEnd::converged);
  EXPECT_FALSE(bare.solve(start).load_stepped);
}

TEST(Safeguards, RestartsFindWhatTheStartMisses) {
  Groove groove = funnel();
  groove.potential = false;
  const double start[] = {2.0, 0.0};
  Newton newton(groove, with(Goal::stationary, {.line_search = false, .load_stepping = false}));
  const NewtonResult& found = newton.solve(start);
  EXPECT_EQ(found.end, NewtonEnd::converged);
  EXPECT_TRUE(found.restarted);
  EXPECT_NEAR(found.x[0], 0.0, 1e-12);
}

TEST(Safeguards, LoadSteppingIsNotNeededWhereTheOthersConverge) {
  const Groove groove = two_wells();
  const double start[] = {0.9, 0.1};
  Newton newton(groove);
  EXPECT_EQ(newton.solve(start).end, NewtonEnd::converged);
  EXPECT_FALSE(newton.solve(start).load_stepped);
}

// f = x on the cusp y^2 = x^3: it is least at the tip (0, 0), where J = (-3 x^2, 2 y) vanishes and no finite multiplier
// balances grad f = (1, 0). Beside it lambda = 1 / (3 x^2) grows without bound.
class Cusp final : public Problem {
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
    const double x = at.x[0];
    const double y = at.x[1];
    at.gradient = {1.0, 0.0};
    at.constraint[0] = y * y - x * x * x;
    at.jacobian = {-3 * x * x, 2 * y};
  }
  void tangent(Evaluation& at, std::span<const double> multipliers, std::span<double> values) const override {
    values[0] = -6 * at.x[0] * multipliers[0];
    values[1] = 2 * multipliers[0];
  }

 private:
  std::vector<double> none_;
  Pattern jacobian_{1, 2, {0, 0}, {0, 1}}, tangent_{2, 2, {0, 1}, {0, 1}};
};

TEST(Safeguards, ALockIsNeverCalledAnEquilibrium) {
  const Cusp cusp;
  for (const Goal goal : {Goal::stationary, Goal::minimum}) {
    for (const double x : {0.25, 1.0, 4.0}) {
      Newton newton(cusp, with(goal, {}));
      const double start[] = {x, std::pow(x, 1.5)};
      const NewtonResult& result = newton.solve(start);
      EXPECT_NE(result.end, NewtonEnd::converged) << result.x[0] << ' ' << result.x[1];
      EXPECT_NE(describe(result.end), "unknown");
    }
  }
}

}  // namespace
}  // namespace poise::solvers::safeguards_test

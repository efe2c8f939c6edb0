#include "solvers/runge_kutta.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace poise::solvers::runge_kutta_test {
namespace {

// y1' = y2, y2' = -y1; refuses beyond t = limit.
class Oscillator : public OdeSystem {
 public:
  int size() const override { return 2; }
  bool rates(double t, const double* y, double* dydt) override {
    dydt[0] = y[1];
    dydt[1] = -y[0];
    return t <= limit;
  }
  double limit = 1e9;
};

// Error of one step from (0, 1), and the estimate of it.
struct Errors {
  double real, estimated;
};
Errors after(double h) {
  Oscillator system;
  RungeKutta78 method(system);
  std::vector<double> y{0.0, 1.0}, rates{1.0, 0.0}, end(2), error(2);
  EXPECT_TRUE(method.step(0.0, y, rates, h, end, error));
  return {std::abs(end[0] - std::sin(h)), std::max(std::abs(error[0]), std::abs(error[1]))};
}

TEST(RungeKutta78, IsOfOrderEightWithAnEstimateOfOrderSeven) {
  const Errors whole = after(0.8);
  const Errors half = after(0.4);
  EXPECT_NEAR(std::log2(whole.real / half.real), 9.0, 0.7);
  EXPECT_NEAR(std::log2(whole.estimated / half.estimated), 8.0, 0.7);
  EXPECT_LT(whole.real, whole.estimated);
}

TEST(RungeKutta78, SaysThatAStageCannotBeEvaluated) {
  Oscillator system;
  system.limit = 0.7;
  RungeKutta78 method(system);
  std::vector<double> y{0.0, 1.0}, rates{1.0, 0.0}, end(2), error(2);
  EXPECT_FALSE(method.step(0.0, y, rates, 0.8, end, error));
  EXPECT_TRUE(method.step(0.0, y, rates, 0.6, end, error));
}

// No stage comes nearer than a twelfth of the step.
TEST(RungeKutta78, HasGapsBetweenItsStages) {
  class Clock : public OdeSystem {
   public:
    int size() const override { return 1; }
    bool rates(double t, const double*, double* dydt) override {
      times.push_back(t);
      dydt[0] = 0.0;
      return true;
    }
    std::vector<double> times;
  };
  Clock system;
  RungeKutta78 method(system);
  std::vector<double> y{0.0}, rates{0.0}, end(1), error(1);
  ASSERT_TRUE(method.step(0.0, y, rates, 1.0, end, error));
  EXPECT_EQ(system.times.size(), 12u);
  for (double gap : RungeKutta78::gaps) {
    for (double t : system.times) EXPECT_GT(std::abs(t - gap), 1.0 / 12 - 1e-12) << gap;
  }
}

TEST(NextStep, AimsAtTheErrorAllowed) {
  EXPECT_NEAR(next_step(1.0, 256.0), 0.45, 1e-15);
  EXPECT_NEAR(next_step(1.0, 1.0 / 256), 1.8, 1e-15);
  EXPECT_EQ(next_step(1.0, 0.0), 4.0);
  EXPECT_EQ(next_step(1.0, 1e-30), 4.0);
  EXPECT_EQ(next_step(1.0, 1e30), 0.2);
}

}  // namespace
}  // namespace poise::solvers::runge_kutta_test

#include "identification/fit/oscillation_start.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/identification/experiments.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::oscillation_start_test {
namespace {

// Largest relative residual of a record that start_from_oscillations accepts.
constexpr double pure = 0.1;

std::vector<double> times(int count, double rate) {
  std::vector<double> t;
  for (int i = 0; i < count; ++i) t.push_back(i / rate);
  return t;
}

template <class F>
std::vector<double> readings(const std::vector<double>& t, F f) {
  std::vector<double> y;
  for (const double at : t) y.push_back(f(at));
  return y;
}

TEST(FitDampedSine, RecoversADampedSine) {
  const auto t = times(2000, 1000);
  for (const DampedSine& truth :
       {DampedSine{0.37, 0.005, 0.0, 1.15, 33.9, 0.0}, DampedSine{-2.0, 0.3, -0.8, 0.02, 5.7, 0.0},
        DampedSine{0.0, -0.01, 0.02, 6.0, 50.0, 0.0}}) {
    const auto y = readings(t, [&](double at) {
      return truth.offset + std::exp(-truth.decay * at) *
                                (truth.a * std::cos(truth.omega * at) + truth.b * std::sin(truth.omega * at));
    });
    const auto found = fit_damped_sine(t, y);
    ASSERT_TRUE(found);
    const double size = std::hypot(truth.a, truth.b);
    EXPECT_NEAR(found->offset, truth.offset, 1e-8 * size);
    EXPECT_NEAR(found->a, truth.a, 1e-8 * size);
    EXPECT_NEAR(found->b, truth.b, 1e-8 * size);
    EXPECT_NEAR(found->decay, truth.decay, 1e-8 * truth.omega);
    EXPECT_NEAR(found->omega, truth.omega, 1e-8 * truth.omega);
    EXPECT_LT(found->relative_residual, 1e-7);
  }
}

// Noise of a fifth of the amplitude gives that relative residual.
TEST(FitDampedSine, ReportsTheResidual) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.2 / std::sqrt(2.0));
  const auto t = times(2000, 1000);
  const auto y = readings(t, [&](double at) { return std::cos(20 * at) + noise(random); });
  const auto found = fit_damped_sine(t, y);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->omega, 20.0, 0.02);
  EXPECT_NEAR(found->relative_residual, 0.2, 0.02);
}

TEST(FitDampedSine, TakesNothingElseForADampedSine) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise;
  const auto t = times(2000, 1000);
  const auto is_damped_sine = [&](const std::vector<double>& y) {
    const auto found = fit_damped_sine(t, y);
    return found && found->relative_residual < pure;
  };
  EXPECT_TRUE(is_damped_sine(readings(t, [](double at) { return std::sin(30 * at); })));
  EXPECT_FALSE(is_damped_sine(readings(t, [](double) { return 0.3; })));
  EXPECT_FALSE(is_damped_sine(readings(t, [](double at) { return 2 * at; })));
  EXPECT_FALSE(is_damped_sine(readings(t, [](double at) { return std::exp(-3 * at); })));
  EXPECT_FALSE(is_damped_sine(readings(t, [&](double) { return noise(random); })));
  EXPECT_FALSE(is_damped_sine(readings(t, [](double at) { return std::sin(20 * at + 15 * at * at); })));
  EXPECT_FALSE(fit_damped_sine(t, readings(t, [](double at) { return std::sin(2 * at); })));  // 0.6 periods
}

// No start is needed: linear least squares of the lift's dozen oscillations is already near. The inertia of the crank
// is the least certain, with a bound of 1.2 %.
TEST(StartFromOscillations, LiftComesOutNearTheTruth) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const auto start = start_from_oscillations(problem, problem.records());
  ASSERT_TRUE(start);
  const std::vector<double> truth = problem.truths();
  const double within[] = {0.02, 0.15, 0.01, 0.02};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double includes = e.unknowns[i].includes;
    EXPECT_NEAR((start->parameters[i] + includes) / (truth[i] + includes), 1.0, within[i]) << e.unknowns[i].name;
  }
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const std::vector<double> released = problem.run(r).released();
    EXPECT_NEAR(start->nuisances[r][0], released[0], 2e-5);
    EXPECT_NEAR(start->nuisances[r][1], released[1], 2e-4);
    EXPECT_NEAR(start->nuisances[r][2], released[2], 5e-3);
  }
}

// The linear equations do not use the experiment's own starts.
TEST(StartFromOscillations, DoesNotDependOnTheStarts) {
  Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  const auto one = start_from_oscillations(problem, records);
  e.unknowns[0].start = 200.0;
  e.unknowns[1].start = 3.0;
  e.unknowns[2].start = 5e5;
  e.unknowns[3].start = 20.0;
  const FitProblem moved(e);
  const auto other = start_from_oscillations(moved, records);
  ASSERT_TRUE(one && other);
  for (std::size_t i = 0; i < one->parameters.size(); ++i) {
    const double includes = e.unknowns[i].includes;
    EXPECT_NEAR((one->parameters[i] + includes) / (other->parameters[i] + includes), 1.0, 0.01);
  }
}

TEST(StartFromOscillations, IsNoneForOtherExperiments) {
  Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  std::vector<Record> records = problem.records();
  // One record without oscillations.
  for (double& reading : records[2].sensors[0].value) reading = 0.37;
  EXPECT_FALSE(start_from_oscillations(problem, records));
  // A number in which the equations are not linear.
  e.unknowns.push_back(test::unknown("body.platform.center.x"));
  const FitProblem curved(e);
  EXPECT_FALSE(start_from_oscillations(curved, curved.records()));
  // More than one degree of freedom, and no equilibrium pose.
  Experiment free;
  free.scene = read_scene(test::dataset("double_pendulum.toml"));
  free.sensors = {test::angle_of(free.scene, "arm1", 1e-3)};
  free.unknowns = {test::unknown("body.arm1.inertia")};
  free.runs = {test::simulated(100, 500)};
  const FitProblem pendulum(free);
  EXPECT_FALSE(start_from_oscillations(pendulum, pendulum.records()));
}

}  // namespace
}  // namespace poise::oscillation_start_test

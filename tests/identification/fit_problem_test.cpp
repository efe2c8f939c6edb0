#include "identification/prediction/fit_problem.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/identification/experiments.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::fit_problem_test {
namespace {

// Half the sum of squares of one run, straight from the residuals.
double cost(const FitProblem& problem, std::size_t r, const Record& record, const std::vector<double>& parameters,
            const std::vector<double>& nuisances) {
  const Residuals e = problem.residuals(r, parameters, nuisances, record);
  EXPECT_FALSE(e.empty());
  double sum = 0.0;
  for (const std::vector<double>& of_sensor : e) {
    for (const double residual : of_sensor) sum += residual * residual / 2;
  }
  return sum;
}

// Slightly different from the truth in everything, so that no gradient vanishes.
struct Displaced {
  std::vector<double> parameters;
  std::vector<std::vector<double>> nuisances;
};

Displaced displaced(const FitProblem& problem) {
  Displaced out{problem.truths(), test::released(problem)};
  double by = 0.01;
  for (std::size_t i = 0; i < out.parameters.size(); ++i)
    out.parameters[i] += (by = -by) * problem.parameters()[i].scale;
  for (std::vector<double>& nuisances : out.nuisances) {
    for (double& value : nuisances) value += (by = -by) / 100;
  }
  return out;
}

TEST(FitProblem, TrianglesHoldCostAndGradient) {
  Experiment e = test::experiment("lift_experiment_heights");
  for (poise::Run& run : e.runs) run.sample_rate = 200;
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  const Displaced here = displaced(problem);
  for (const std::size_t r : {0U, 3U}) {
    const RunModel& run = problem.run(r);
    SCOPED_TRACE(run.run().name);
    const int columns = run.columns();
    const Eigen::MatrixXd R =
        problem.triangle(r, here.parameters, here.nuisances[r], &records[r], INFINITY, 1e-10, problem.weighting());
    ASSERT_EQ(R.rows(), columns + 1);
    ASSERT_EQ(R.cols(), columns + 1);
    EXPECT_NEAR(R.col(columns).squaredNorm() / 2 / cost(problem, r, records[r], here.parameters, here.nuisances[r]),
                1.0, 1e-6);
    const Eigen::VectorXd gradient = R.leftCols(columns).transpose() * R.col(columns);
    for (int c = 0; c < columns; ++c) {
      // Nuisances first.
      const bool is_nuisance = c < run.nuisances();
      const auto own = static_cast<std::size_t>(is_nuisance ? c : problem.parameters_of(r)[c - run.nuisances()]);
      SCOPED_TRACE(is_nuisance ? run.nuisance_names()[own] : problem.parameters()[own].name);
      const auto at = [&](double by) {
        Displaced moved = here;
        (is_nuisance ? moved.nuisances[r][own] : moved.parameters[own]) += by;
        return std::vector<double>{cost(problem, r, records[r], moved.parameters, moved.nuisances[r])};
      };
      const double step = is_nuisance ? 1e-5 : 1e-3 * problem.parameters()[own].scale;
      EXPECT_NEAR(step * gradient[c], step * test::derivative(at, step)[0], 2e-4 * std::abs(step * gradient[c]) + 1e-5);
    }
  }
}

// One value for all runs, one for each height, or one for each run.
TEST(FitProblem, SharesParametersByTheirRuns) {
  Experiment e = test::experiment("lift_experiment_heights");
  const auto names = [&] {
    std::vector<std::string> out;
    const FitProblem problem(e);
    for (const Parameter& p : problem.parameters()) out.push_back(p.name);
    return out;
  };
  EXPECT_EQ(names(), (std::vector<std::string>{"mP", "J_O", "k (low)", "c", "k (middle)", "k (high)"}));
  e.unknowns[2].per = "run";
  EXPECT_EQ(names().size(), 9U);
  EXPECT_EQ(names()[2], "k (low, empty)");
  e.unknowns[2].per = "";
  EXPECT_EQ(names().size(), 4U);
}

TEST(FitProblem, RejectsUnknownsThatMotionDoesNotDependOn) {
  Experiment e = test::experiment("lift_experiment");
  e.unknowns[0].path = "start.obd";
  e.unknowns[0].line = 17;
  try {
    const FitProblem problem(e);
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(":17: unknown \"start.obd\": expected"), std::string::npos)
        << error.what();
  }
}

// Ranges, starts and truths are of the number in the scene: less what the shown value includes.
TEST(FitProblem, CountsWithoutWhatIsIncluded) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const Parameter& lump = problem.parameters()[test::parameter(problem, "mP")];
  EXPECT_DOUBLE_EQ(lump.truth, 0.0);
  EXPECT_NEAR(lump.start, 40 - 64.6823847579, 1e-12);
  EXPECT_DOUBLE_EQ(lump.scale, 40.0);
}

TEST(FitProblem, NoiseIsAsLargeAsStatedAndItsOwnForEachRun) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  const std::vector<Record> again = problem.records();
  std::vector<Eigen::VectorXd> noise;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const Record ideal = problem.ideal_record(r);
    ASSERT_EQ(records[r].sensors[0].time.size(), 2000U);
    EXPECT_EQ(records[r].sensors[0].value, again[r].sensors[0].value);
    const auto as_vector = [](const std::vector<double>& v) {
      return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
    };
    noise.emplace_back(as_vector(records[r].sensors[0].value) - as_vector(ideal.sensors[0].value));
    EXPECT_NEAR(std::sqrt(noise.back().squaredNorm() / 2000), 1e-4, 4e-6);
    EXPECT_NEAR(noise.back().mean(), 0.0, 4e-4 / std::sqrt(2000.0));
  }
  for (std::size_t a = 0; a < noise.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      EXPECT_LT(std::abs(noise[a].normalized().dot(noise[b].normalized())), 4 / std::sqrt(2000.0));
    }
  }
}

// How far a measured run travels is not what its release guesses.
TEST(FitProblem, AccuracyDoesNotFollowFromAGuessedStart) {
  Experiment e = test::experiment("lift_experiment");
  e.records = FitProblem(e).records();
  for (poise::Run& run : e.runs) run.data = {"lift.csv"};
  for (Sensor& sensor : e.sensors) sensor.noise = 1e-8;
  Experiment guessed = e;
  for (poise::Run& run : e.runs) run.release.clear();
  for (poise::Run& run : guessed.runs) run.release.front().value = 0.0;
  EXPECT_EQ(FitProblem(guessed).accuracy(0), FitProblem(e).accuracy(0));
}

// The accuracy that fits compute with: its error is lost in the noise.
TEST(FitProblem, AccuracyOfARunIsFarBelowItsNoise) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  for (const std::size_t r : {0U, 5U}) {
    const RunModel& run = problem.run(r);
    const Record ideal = problem.ideal_record(r);
    Prediction rough;
    run.predict(run.scene_values().data(), run.released().data(), INFINITY, problem.accuracy(r), true, rough);
    ASSERT_TRUE(rough.ok);
    double worst = 0.0;
    for (std::size_t i = 0; i < rough.reading.size(); ++i) {
      worst = std::max(worst, std::abs(rough.reading[i] - ideal.sensors[0].value[i]));
    }
    EXPECT_LT(worst, 0.01 * e.sensors[0].noise);
  }
}

/// A double pendulum of 0.5 and 0.4 kg released at these angles from the horizontal, with more text of the scene; the
/// angles are read 100 times a second with noise of 1 mrad.
Experiment double_pendulum(double a, double b, const std::string& more, int readings) {
  Experiment e;
  e.scene = parse_scene(fmt::format(R"(
    gravity = [0, -9.81]
    [ground]
    points = {{ O = [0, 0] }}
    [body.a]
    points = {{ O = [0, 0], E = [0.2, 0] }}
    mass = 0.5
    center = [0.1, 0]
    inertia = 0.002
    [body.b]
    points = {{ E = [0, 0] }}
    mass = 0.4
    center = [0.12, 0.01]
    inertia = 0.003
    [[pin]]
    points = ["ground.O", "a.O"]
    [[pin]]
    points = ["a.E", "b.E"]
    [start]
    a = {}
    b = {}
    {}
  )",
                                    a, b, more),
                        "double.toml");
  e.sensors = {test::angle_of(e.scene, "a", 1e-3), test::angle_of(e.scene, "b", 1e-3)};
  e.unknowns = {test::unknown("body.b.inertia")};
  e.runs = {test::simulated(100, readings)};
  return e;
}

/// The cost at the truth does not show errors of the motion: it hardly changes between starts 1e-13 rad apart.
void expect_smooth_cost(const Experiment& e, double within) {
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  std::vector<std::vector<double>> starts = test::released(problem);
  const double cost = problem.cost(problem.truths(), starts, records, problem.weighting(), 1);
  EXPECT_NEAR(cost, static_cast<double>(problem.readings()) / 2, 100);
  for (int step = 0; step < 8; ++step) {
    starts[0][0] += 1e-13;
    EXPECT_NEAR(problem.cost(problem.truths(), starts, records, problem.weighting(), 1), cost, within);
  }
}

// A double pendulum that turns over multiplies changes of its start, and errors of its motion, by some 10^4. The cost
// must not show the errors, or no step of a fit decreases it.
TEST(FitProblem, CostIsSmoothWhereTheMotionIsChaotic) { expect_smooth_cost(double_pendulum(1, 1.5, "", 560), 0.05); }

// Steps of the integrator are as long as the turn of the friction, and its estimate of the error too small there.
TEST(FitProblem, CostIsSmoothWhereFrictionTurns) {
  expect_smooth_cost(double_pendulum(-1.2, -1.9, R"(
    [[friction]]
    name = "shoulder"
    bodies = ["ground", "a"]
    torque = 0.01
    [[friction]]
    name = "elbow"
    bodies = ["a", "b"]
    torque = 0.004
  )",
                                     1500),
                     0.05);
}

}  // namespace
}  // namespace poise::fit_problem_test

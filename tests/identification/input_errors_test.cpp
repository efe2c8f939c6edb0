// Noise in the readings of inputs: what it does to what sensors read, and to estimates.

#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/assessment/compare_models.hpp"
#include "identification/assessment/identify.hpp"
#include "identification/fit/fit.hpp"
#include "identification/fit/some_runs.hpp"
#include "identification/identifiability/identifiability.hpp"
#include "tests/identification/crane.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"
#include "tests/support/seed.hpp"

namespace poise::input_errors_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// Products of whitened rows are those with the inverse of the covariance, 1 + F F^T, F written out.
TEST(InputErrors, WhitenedRowsHaveTheProductsOfTheInverseCovariance) {
  std::mt19937_64 random(3);
  const std::vector<std::size_t> readings = {12, 7};
  const std::vector<double> noise = {0.3, 2.0};
  std::vector<InputErrors::Step> steps;
  std::vector<std::size_t> next(2, 0);
  MatrixXd states(3, 0);  // by all w so far
  MatrixXd f = MatrixXd::Zero(19, 60);
  const std::vector<Eigen::Index> first = {0, 12, 19};
  for (int s = 0; s < 20; ++s) {
    InputErrors::Step step{0.4 * random_matrix(3, 3, random), random_matrix(3, s == 0 ? 2 : 1, random), {}};
    MatrixXd now(3, states.cols() + step.kick.cols());
    now << step.transition * states, step.kick;
    states = now;
    for (std::size_t k = 0; k < 2; ++k) {
      if (next[k] == readings[k] || (s + static_cast<int>(k)) % 3 == 1) continue;
      step.readings.push_back({k, next[k], random_matrix(1, 3, random)});
      f.row(first[k] + static_cast<Eigen::Index>(next[k]++)).head(states.cols()) =
          step.readings.back().by_state * states / noise[k];
    }
    steps.push_back(std::move(step));
  }
  ASSERT_EQ(next, readings);
  const MatrixXd covariance = MatrixXd::Identity(19, 19) + f * f.transpose();
  const MatrixXd rows = random_matrix(19, 4, random);
  MatrixXd whitened = rows;
  const InputErrors errors(steps);
  errors.whiten(whitened, first, noise);
  const MatrixXd expected = rows.transpose() * covariance.ldlt().solve(rows);
  EXPECT_LT((whitened.transpose() * whitened - expected).norm(), 1e-9 * expected.norm());
  // The first readings of each sensor alone are whitened with their own part of the covariance.
  std::vector<int> kept = {0, 1, 2, 3, 4, 12, 13};
  MatrixXd fewer = rows(kept, Eigen::all);
  errors.whiten(fewer, {0, 5, 7}, noise);
  const MatrixXd of_fewer = rows(kept, Eigen::all);
  const MatrixXd part = of_fewer.transpose() * covariance(kept, kept).ldlt().solve(of_fewer);
  EXPECT_LT((fewer.transpose() * fewer - part).norm(), 1e-9 * part.norm());
}

const std::string scene = test::crane("value = 0", "", "start = 0", "-1.2");

double motor(double t) { return 0.9 * std::sin(5.1 * t) + 0.6 * std::sin(2.3 * t + 1); }
double wind(double t) { return 0.7 * std::cos(3.7 * t); }

class NoiseOfInputs : public test::WrittenExperiment {
 protected:
  NoiseOfInputs() : WrittenExperiment(scene) {}

  /// Readings of the motor, at `rate` per second up to 2 s, and of the wind.
  void write_inputs(double rate, const std::function<double(double)>& error) const {
    std::string text = "time,tau,wind,belt\n";
    for (int i = 0; i <= std::lround(2.1 * rate); ++i) {
      const double t = i / rate;
      text += fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}\n", t, motor(t) + error(t), wind(t), 0.05 * std::sin(2 * t));
    }
    folder_.write("inputs.csv", text);
  }

  /// The covariance that a record's rows are whitened by, from what is left of them.
  static MatrixXd inverse_covariance(const InputErrors& errors, const std::vector<std::size_t>& counts,
                                     const std::vector<double>& noise) {
    std::vector<Eigen::Index> first{0};
    for (const std::size_t count : counts) first.push_back(first.back() + static_cast<Eigen::Index>(count));
    MatrixXd rows = MatrixXd::Identity(first.back(), first.back());
    errors.whiten(rows, first, noise);
    return rows.transpose() * rows;
  }

  /// Expects the covariance of the first run to be what comes of one reading of the motor after the other raised by its
  /// noise.
  static void expect_covariance(const Experiment& e) {
    const FitProblem problem(e);
    const RunModel& run = problem.run(0);
    const std::vector<double> values = problem.unknowns_of(0, problem.starts()), nuisances = run.released();
    const auto predicted = [&](const Experiment& of) {
      const RunModel model(of, 0, run.numbers(), run.sensor_numbers());
      Prediction out;
      model.predict(values.data(), nuisances.data(), INFINITY, 1e-12, false, out);
      EXPECT_TRUE(out.ok) << out.why;
      return VectorXd(VectorXd::Map(out.reading.data(), std::ssize(out.reading)));
    };
    const std::vector<std::size_t> counts = run.counts(INFINITY);
    VectorXd per_noise(static_cast<Eigen::Index>(run.readings(INFINITY)));
    std::vector<double> noise;
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      noise.push_back(e.sensors[k].noise);
      for (std::size_t s = 0; s < counts[k]; ++s) per_noise[row++] = 1 / noise.back();
    }
    MatrixXd f(row, 0);
    for (std::size_t i = 0; i < e.runs[0].inputs.size(); ++i) {
      const RunInput& input = e.runs[0].inputs[i];
      if (input.noise == 0) continue;
      const std::vector<double>& times = input.motion.curve->breaks();
      for (std::size_t n = 0; n < times.size(); ++n) {
        const auto raised = [&](double by) {
          Experiment other = e;
          std::vector<double> read;
          for (const double t : times) read.push_back(input.motion.curve->at(t));
          read[n] += by;
          other.runs[0].inputs[i].motion.curve = std::make_shared<const TimeCurve>(TimeCurve::through(times, read));
          return predicted(other);
        };
        f.conservativeResize(row, f.cols() + 1);
        f.rightCols(1) = per_noise.cwiseProduct(raised(input.noise) - raised(-input.noise)) / 2;
      }
    }
    const MatrixXd expected = MatrixXd::Identity(row, row) + f * f.transpose();
    ASSERT_GT((f * f.transpose()).diagonal().maxCoeff(), 1.0) << "the noise of the input matters";
    const auto errors = run.input_errors(values.data(), nuisances.data(), 1e-10);
    ASSERT_NE(errors, nullptr);
    const MatrixXd found = inverse_covariance(*errors, counts, noise).inverse();
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 2e-3 * expected.cwiseAbs().maxCoeff());
  }

  static constexpr const char* sensors = R"(
scene = "scene.toml"
[[sensor]]
name = "angle"
angle = ["cart", "arm"]
noise = 1e-3
[[sensor]]
name = "gyro"
read = "d(angle.arm)/dt"
noise = 2e-2
delay = 0.013
[[unknown]]
path = "body.arm.inertia"
name = "J"
start = 0.06
[[run]]
duration = 1.2
rate = 40
)";
};

TEST_F(NoiseOfInputs, IsWhatOneReadingAfterTheOtherDoesToThoseOfSensors) {
  write_inputs(50, [](double) { return 0.0; });
  Experiment e = read(std::string(sensors) + R"(
inputs = { "load.motor" = { column = "tau", file = "inputs.csv" }, "load.wind" = "wind", "drive.belt" = "belt" }
)");
  e.runs[0].inputs[0].noise = 0.05;
  expect_covariance(e);
  e.runs[0].inputs[1].noise = 0.1;
  expect_covariance(e);
}

TEST_F(NoiseOfInputs, OfALoadThatMultipliesAndBesideAnAccelerometer) {
  folder_.write("scene.toml", test::crane("value = 2", "", "start = 0", "-1.2"));
  write_inputs(60, [](double) { return 0.0; });
  Experiment e = read(R"(
scene = "scene.toml"
[[sensor]]
name = "axle"
accelerometer = "arm.T"
direction = 1.5707963267948966
noise = 0.05
[[unknown]]
path = "body.arm.inertia"
[[run]]
duration = 1
rate = 30
inputs = { "load.motor" = { column = "tau", file = "inputs.csv", multiplies = true }, "drive.belt" = "belt" }
)");
  e.runs[0].inputs[0].noise = 0.05;
  expect_covariance(e);
}

TEST_F(NoiseOfInputs, OfACarriageIsInMetres) {
  folder_.write("scene.toml", R"(
[ground]
points = { O = [0, 0] }
[body.cart]
points = { O = [0, 0], P = [7, 0] }
mass = 3
[[slide]]
name = "rail"
points = ["ground.O", "cart.O"]
axis = [1, 0]
[[spring]]
name = "spring"
points = ["ground.O", "cart.P"]
stiffness = 50
free_length = 7
[[cubic_spring]]
name = "motor"
slide = "rail"
free_length = 0
stiffness = 30
cubic = 200
)");
  write_inputs(40, [](double) { return 0.0; });
  Experiment e = read(R"(
scene = "scene.toml"
[[sensor]]
name = "place"
travel = "rail"
noise = 1e-3
[[unknown]]
path = "body.cart.mass"
[[run]]
duration = 1.5
rate = 30
inputs = { "cubic_spring.motor.free_length" = { column = "wind", factor = 0.2, file = "inputs.csv" } }
)");
  e.runs[0].inputs[0].noise = 0.02;
  expect_covariance(e);
}

/// A driven oscillator whose torque is read with noise.
class NoisyTorque : public test::WrittenExperiment {
 protected:
  static constexpr double inertia = 0.02, stiffness = 0.79, damping = 0.02, torque_noise = 0.014, noise = 2e-3;

  NoisyTorque()
      : WrittenExperiment(R"(
gravity = [0, 0]
[ground]
points = { O = [0, 0] }
[body.disc]
points = { O = [0, 0] }
mass = 1
inertia = 0.026
[[pin]]
points = ["ground.O", "disc.O"]
[[torsion_spring]]
name = "spring"
bodies = ["ground", "disc"]
stiffness = 0.63
[[torsion_damper]]
name = "air"
bodies = ["ground", "disc"]
coefficient = 0.03
[[torque]]
name = "motor"
on = "disc"
value = 0
)") {}

  /// Moves it by Runge and Kutta's method, under lines between torques at 100 Hz, and writes the file of a run of 6 s.
  void write_run(std::uint64_t seed) const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> torque(601, 0.0);
    for (const double frequency : {0.3, 0.7, 1.3, 2.1}) {
      const double size = 0.1 * normal(random), phase = 6.3 * normal(random);
      for (std::size_t i = 0; i < torque.size(); ++i) {
        torque[i] += size * std::sin(2 * M_PI * frequency * 0.01 * static_cast<double>(i) + phase);
      }
    }
    double angle = 0.2 * normal(random), rate = 0.0;
    std::string text = "time,phi,tau\n";
    for (std::size_t i = 0; i < torque.size(); ++i) {
      text += fmt::format("{:.2f},{:.9g},{:.9g}\n", 0.01 * static_cast<double>(i), angle + noise * normal(random),
                          torque[i] + torque_noise * normal(random));
      if (i + 1 == torque.size()) break;
      constexpr int parts = 4;
      constexpr double h = 0.01 / parts;
      const auto acceleration = [&](double part, double q, double v) {
        const double load = torque[i] + part * (torque[i + 1] - torque[i]);
        return (load - stiffness * q - damping * v) / inertia;
      };
      for (int k = 0; k < parts; ++k) {
        const double begin = static_cast<double>(k) / parts, middle = begin + 0.5 / parts, end = begin + 1.0 / parts;
        const double k1 = rate, l1 = acceleration(begin, angle, rate);
        const double k2 = rate + h / 2 * l1, l2 = acceleration(middle, angle + h / 2 * k1, k2);
        const double k3 = rate + h / 2 * l2, l3 = acceleration(middle, angle + h / 2 * k2, k3);
        const double k4 = rate + h * l3, l4 = acceleration(end, angle + h * k3, k4);
        angle += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        rate += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
      }
    }
    folder_.write("run.csv", text);
  }

  Experiment experiment(const std::string& input_noise, bool states_noise, const std::string& more = "") const {
    return read(R"(
scene = "scene.toml"
)" + more + R"(
[[sensor]]
name = "phi"
angle = "disc"
)" + (states_noise ? fmt::format("noise = {}\n", noise) : "") +
                R"(
[[unknown]]
path = "body.disc.inertia"
[[unknown]]
path = "torsion_spring.spring.stiffness"
[[unknown]]
path = "torsion_damper.air.coefficient"
[[run]]
name = "only"
data = "run.csv"
inputs = { "load.motor" = { column = "tau")" +
                input_noise + " } }\n");
  }
};

// 95 % intervals hold the truth as often as they say, and nothing is called a misfit.
TEST_F(NoisyTorque, IntervalsCoverTheTruthAsTheySay) {
  const int fits = test::cases(30, 200);
  const std::vector<double> truth = {inertia, stiffness, damping};
  for (const bool states_noise : {true, false}) {
    int covered = 0, converged = 0;
    double squares = 0.0;
    std::vector<double> mean(truth.size(), 0.0);
    for (int i = 0; i < fits; ++i) {
      write_run(test::seed(1000 * static_cast<std::uint64_t>(states_noise) + static_cast<std::uint64_t>(i)));
      const Identification found = identify(experiment(fmt::format(", noise = {}", torque_noise), states_noise), {});
      converged += found.fit.status == FitStatus::converged;
      for (std::size_t p = 0; p < truth.size(); ++p) {
        const Estimate& estimate = found.fit.estimates[p];
        covered += estimate.low <= truth[p] && truth[p] <= estimate.high;
        const double error = (estimate.value - truth[p]) / estimate.standard_error;
        squares += error * error;
        mean[p] += error / fits;
      }
    }
    const double n = 3.0 * fits;
    std::printf(
        "%s noise of the sensor: %d fits, %.1f %% of intervals hold the truth; errors over those told: root mean "
        "square %.3f, means %.3f, %.3f, %.3f\n",
        states_noise ? "stated" : "estimated", fits, 100 * covered / n, std::sqrt(squares / n), mean[0], mean[1],
        mean[2]);
    for (const double one : mean) EXPECT_LT(std::abs(one), 4 / std::sqrt(fits)) << "no bias";
    EXPECT_GT(covered / n, 0.95 - 4 * std::sqrt(0.05 * 0.95 / n));
    EXPECT_LT(squares / n, 1 + 5 * std::sqrt(2 / n));
    EXPECT_GT(squares / n, 1 - 4 * std::sqrt(2 / n));
    EXPECT_GE(converged, fits - 2 - fits / 15);
  }
}

// Overstated noise would be taken out of the derivatives too much; what the residuals show is taken. Understated noise
// is a misfit, and how much it would have to be is told.
TEST_F(NoisyTorque, NoiseThatIsStatedWronglyIsSeen) {
  write_run(7);
  const auto found = [&](double stated) { return identify(experiment(fmt::format(", noise = {}", stated), true), {}); };
  const Identification right = found(torque_noise);
  EXPECT_EQ(right.fit.weighting.input_noise, 1.0);
  // One run tells the noise of its load to a third or so.
  for (const double times : {3.0, 30.0, 1e6}) {
    const Identification over = found(times * torque_noise);
    EXPECT_EQ(over.fit.status, FitStatus::converged) << times << over.fit.why;
    EXPECT_NEAR(times * over.fit.weighting.input_noise, 1.0, 0.4) << times;
    for (std::size_t p = 0; p < 3; ++p) {
      const Estimate &one = over.fit.estimates[p], &other = right.fit.estimates[p];
      EXPECT_NEAR(one.value, other.value, 0.3 * other.standard_error) << times;
      EXPECT_NEAR(one.standard_error, other.standard_error, 0.3 * other.standard_error) << times;
    }
  }
  const Identification under = found(0.1 * torque_noise);
  EXPECT_EQ(under.fit.status, FitStatus::misfit);
  EXPECT_NEAR(0.1 * under.fit.weighting.input_noise, 1.0, 0.4);
  EXPECT_NE(under.fit.why.find("times what is stated would explain it"), std::string::npos) << under.fit.why;
}

TEST_F(NoisyTorque, WithoutItsNoiseItIsAMisfit) {
  write_run(5);
  EXPECT_EQ(identify(experiment("", true), {}).fit.status, FitStatus::misfit);
  const Identification found = identify(experiment(fmt::format(", noise = {}", torque_noise), true), {});
  EXPECT_EQ(found.fit.status, FitStatus::converged) << found.fit.why;
  // What the design alone tells of the errors, at the estimates.
  const Experiment at_estimates = experiment(fmt::format(", noise = {}", torque_noise), true);
  const FitProblem design(at_estimates);
  const Identifiability told = assess(design, found.fit.parameters, {found.fit.runs[0].nuisances});
  const Experiment exact = experiment("", true);
  const Identifiability without = assess(FitProblem(exact), found.fit.parameters, {found.fit.runs[0].nuisances});
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_NEAR(told.standard_error[p], found.fit.identifiability.standard_error[p], 0.02 * told.standard_error[p]);
    EXPECT_LT(without.standard_error[p], 0.6 * told.standard_error[p]);
  }
  // A fit of some of the runs takes what the noise does in these.
  const Experiment e = experiment(fmt::format(", noise = {}", torque_noise), true);
  const FitProblem problem(e);
  const Fit seed = SomeRuns(problem, found.records, {0}).seed(found.fit);
  EXPECT_EQ(seed.weighting.inputs, found.fit.weighting.inputs);
  EXPECT_NE(seed.weighting.input_errors(0), nullptr);
  EXPECT_EQ(seed.weighting.input_errors(1), nullptr);
}

TEST_F(NoisyTorque, BadInputIsNamed) {
  write_run(6);
  const std::string with = fmt::format(", noise = {}", torque_noise);
  const auto said = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto expect_said = [](const std::string& words, const std::string& part) {
    EXPECT_NE(words.find(part), std::string::npos) << words;
  };
  const Experiment robust = experiment(with, true, "loss = \"huber\"");
  expect_said(said([&] { FitProblem problem(robust); }),
              ("input \"load.motor\".noise: expected loss = \"squares\" with it, found \"huber\"; leave "
               "out one of them"));
  const Experiment e = experiment(with, true);
  const FitProblem one(e), other(e);
  expect_said(said([&] {
                compare_models({&one, &other});
              }),
              ("expected inputs without noise, found that of \"load.motor\" in run \"only\"; leave it "
               "out of both experiments"));
  expect_said(said([&] { experiment(", noise = 0", true); }), ("noise: expected"));
  folder_.write("inputs.csv", "time,tau\n0,0\n10,1\n");
  const std::string simulated = R"(
scene = "scene.toml"
[[sensor]]
name = "phi"
angle = "disc"
noise = 1e-3
[[run]]
duration = 2
rate = 100
inputs = { "load.motor" = { column = "tau", file = "inputs.csv", noise = 0.1 } }
)";
  EXPECT_EQ(error(simulated),
            "experiment.toml:10: run 1.inputs.load.motor.noise: expected noise of a load in a measured run, found it "
            "in a simulated one; leave it out");
  folder_.write("scene.toml", app_tests::contents(folder_.path("scene.toml")) + R"(
[[stop]]
name = "end"
bodies = ["ground", "disc"]
max = 3
)");
  expect_said(said([&] { experiment(with, true); }),
              ("noise: expected noise of a load only where motions depend on it smoothly, found stop "
               "\"end\" in the scene; leave it out, and smooth the column"));
}

}  // namespace
}  // namespace poise::input_errors_test

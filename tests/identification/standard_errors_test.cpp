// Standard errors under white, correlated and run-wise residuals, tests of the noise, outliers and runs that disagree:
// against what the estimates of many simulated fits do.

#include "identification/fit/standard_errors.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "solvers/linear_algebra.hpp"
#include "tests/identification/wheel.hpp"

namespace poise::standard_errors_test {
namespace {

using test::Wheel;

/// Ideal records with noise of unit variance from `draw`, times the sensor's; `draw` begins anew for every series.
std::vector<Record> noisy(const FitProblem& problem, const std::function<double()>& draw,
                          const std::function<void()>& begin = {}) {
  std::vector<Record> out;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    out.push_back(problem.ideal_record(r));
    for (std::size_t k = 0; k < out.back().sensors.size(); ++k) {
      if (begin) begin();
      for (double& y : out.back().sensors[k].value) y += problem.experiment().sensors[k].noise * draw();
    }
  }
  return out;
}

/// A stationary first-order series with the autocorrelation phi^|lag|.
struct Correlated {
  double phi;
  std::mt19937_64 random;
  std::normal_distribution<double> normal{};
  double x = normal(random);

  double operator()() {
    x = phi * x + std::sqrt(1 - phi * phi) * normal(random);
    return x;
  }
};

struct Coverage {
  double leading = 0.0, white = 0.0;
  int misfits = 0;
  int correlated = 0, shifted = 0;  // fits with such a run
  int of_kind[3] = {0, 0, 0};
};

Coverage coverage(const FitProblem& problem, double phi, int trials) {
  Coverage out;
  for (int t = 0; t < trials; ++t) {
    Correlated noise{phi, std::mt19937_64(static_cast<unsigned>(t))};
    const Fit found =
        fit(problem, noisy(
                         problem, [&] { return noise(); }, [&] { noise.x = noise.normal(noise.random); }));
    const Estimate& k = found.estimates[0];
    out.leading += (k.truth >= k.low && k.truth <= k.high ? 1.0 : 0.0) / trials;
    out.white += (std::abs(k.value - k.truth) <= 1.96 * found.errors.white[0] ? 1.0 : 0.0) / trials;
    ++out.of_kind[static_cast<int>(found.errors.leading)];
    out.misfits += found.status == FitStatus::misfit ? 1 : 0;
    const auto any = [&](auto&& of) { return std::any_of(found.runs.begin(), found.runs.end(), of) ? 1 : 0; };
    out.correlated += any([](const RunFit& run) { return !run.is_white(); });
    out.shifted += any([](const RunFit& run) { return run.is_shifted(); });
  }
  return out;
}

Wheel wheel_of(int runs, int readings) {
  Wheel wheel(runs);
  for (Run& run : wheel.experiment.runs) run.duration = readings / run.sample_rate;
  return wheel;
}

// 200 fits: a coverage of 95 % is found within 0.95 +- 0.046 (3 sigma).
TEST(StandardErrors, WhiteResidualsLeadToWhiteIntervals) {
  const Wheel wheel = wheel_of(4, 100);
  const Coverage found = coverage(FitProblem(wheel.experiment), 0.0, 200);
  EXPECT_NEAR(found.leading, 0.95, 0.046);
  EXPECT_GE(found.of_kind[0], 180);
  // Each by chance in one of a thousand: more than 3 of 200 in one of 20 000 such tests.
  EXPECT_LE(found.misfits, 3);
  EXPECT_LE(found.correlated, 3);
  EXPECT_LE(found.shifted, 3);
}

TEST(StandardErrors, CorrelatedResidualsStillCoverTheTruth) {
  const Wheel wheel = wheel_of(4, 400);
  const Coverage found = coverage(FitProblem(wheel.experiment), 0.9, 200);
  EXPECT_NEAR(found.leading, 0.95, 0.046);
  EXPECT_LT(found.white, 0.6) << "what independent readings would say";
  EXPECT_GE(found.of_kind[1], 198) << "runs lead by chance in one of a thousand";
  EXPECT_LE(found.misfits, 2) << "their size is as stated";
  EXPECT_EQ(found.correlated, 200);
  EXPECT_LE(found.shifted, 2) << "the correlation explains their means";
}

// A start fitted to 16 readings takes an eighth of them, and correlates what is left.
TEST(StandardErrors, ShortRunsOfWhiteNoiseAreWhite) {
  const Wheel wheel = wheel_of(10, 16);
  const Coverage found = coverage(FitProblem(wheel.experiment), 0.0, 200);
  EXPECT_NEAR(found.leading, 0.95, 0.046);
  EXPECT_GE(found.of_kind[0], 180);
  EXPECT_LE(found.misfits, 3);
}

// The same takes most of noise that is correlated over much of a run: what is left is small, not the noise.
TEST(StandardErrors, ShortRunsOfCorrelatedNoiseAreNoMisfit) {
  const Wheel wheel = wheel_of(6, 100);
  const Coverage found = coverage(FitProblem(wheel.experiment), 0.9, 300);
  EXPECT_GE(found.leading, 0.95 - 0.038);
  EXPECT_LE(found.misfits, 2);
}

// Correlated over a large part of each run: only the runs are independent, and the intervals may be too wide.
TEST(StandardErrors, LongCorrelationLeadsToRuns) {
  const Wheel wheel = wheel_of(10, 100);
  const Coverage found = coverage(FitProblem(wheel.experiment), 0.98, 100);
  EXPECT_GE(found.of_kind[2], 95);
  EXPECT_GE(found.leading, 0.95 - 0.065);
  EXPECT_LT(found.white, 0.7);
}

// With one parameter and n equal runs, the third error is  sqrt(sum (a_r.e_r)^2 / (1 - 1/n)) / sum a.a  and has n - 1
// degrees of freedom.
TEST(StandardErrors, RunsInClosedForm) {
  const Wheel wheel = wheel_of(5, 60);
  const FitProblem problem(wheel.experiment);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const std::vector<Record> records = noisy(problem, [&] { return normal(random); });
  const Fit found = fit(problem, records);
  double squares = 0.0;
  double information = 0.0;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const LinearRun run =
        problem.linearized(r, found.parameters, found.runs[r].nuisances, &records[r], INFINITY, 1e-10, found.weighting);
    const Eigen::MatrixXd n = run.rows.leftCols(2);
    Eigen::VectorXd a = run.rows.col(2);
    a -= n * solvers::minimum_norm_solution<double>(n, a);
    squares += std::pow(a.dot(run.rows.col(3)), 2) / (1 - 1.0 / 5);
    information += a.squaredNorm();
  }
  EXPECT_NEAR(found.errors.runs[0], std::sqrt(squares) / information, 2e-3 * found.errors.runs[0]);
  EXPECT_NEAR(found.errors.runs_degrees[0], 4.0, 0.02);
  EXPECT_NEAR(found.errors.white[0], 1 / std::sqrt(information), 0.1 * found.errors.white[0]);
}

// Leaving out a run changes the estimate as a fit without it says.
// Of a ratio, by every kind of residuals: as of the one number where the other is known.
TEST(StandardErrors, OfACombination) {
  for (const double phi : {0.0, 0.9, 0.999}) {
    Wheel wheel = wheel_of(4, 400);
    const FitProblem one(wheel.experiment);
    Correlated noise{phi, std::mt19937_64(5)};
    const std::vector<Record> records = noisy(
        one, [&] { return noise(); }, [&] { noise.x = noise.normal(noise.random); });
    const Fit of_one = fit(one, records);
    wheel.experiment.unknowns.push_back(test::unknown("body.wheel.inertia"));
    const FitProblem both(wheel.experiment);
    const Fit of_both = fit(both, records);
    EXPECT_EQ(of_one.errors.leading, of_both.errors.leading);
    ASSERT_EQ(of_both.identifiability.combinations.size(), 1U) << phi;
    const Identifiability::Combination& ratio = of_both.identifiability.combinations[0];
    ASSERT_GE(ratio.over, 0);
    const double relative = of_one.errors.error[0] / of_one.parameters[0];
    EXPECT_NEAR(ratio.standard_error / std::abs(ratio.value) / relative, 1.0, 1e-3) << phi;
  }
}

TEST(StandardErrors, WithoutARunAsAFitWithoutIt) {
  const Wheel wheel = wheel_of(4, 80);
  const FitProblem problem(wheel.experiment);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const std::vector<Record> records = noisy(problem, [&] { return normal(random); });
  const Fit all = fit(problem, records);
  Experiment fewer = wheel.experiment;
  fewer.runs.erase(fewer.runs.begin() + 1);
  const FitProblem three(fewer);
  const Fit without = fit(three, {records[0], records[2], records[3]});
  EXPECT_NEAR(all.errors.without_run[1][0], without.parameters[0] - all.parameters[0], 0.02 * all.errors.error[0]);
  EXPECT_LT(all.errors.disagreement[1], disagrees_from);
}

// However far it is off: a run contributes to the errors that it is compared with.
TEST(StandardErrors, NameARunThatDisagrees) {
  const Wheel wheel = wheel_of(6, 80);
  const FitProblem problem(wheel.experiment);
  for (const double sizes : {25.0, 100.0, 1000.0, 5000.0}) {
    std::mt19937_64 random(6);
    std::normal_distribution<double> normal;
    std::vector<Record> records = noisy(problem, [&] { return normal(random); });
    // One run of a wheel whose spring is stiffer by so many errors.
    Experiment stiffer = wheel.experiment;
    const Fit all = fit(problem, records);
    set_value(stiffer.scene, "torsion_spring.coil.stiffness", Wheel::stiffness + sizes * all.errors.white[0]);
    const FitProblem other(stiffer);
    records[2] = other.ideal_record(2);
    other.add_noise(records[2], solvers::RandomStream(9));
    const Fit found = fit(problem, records);
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      EXPECT_EQ(found.errors.disagreement[r] > disagrees_from, r == 2)
          << sizes << ", " << r << ": " << found.errors.disagreement[r];
    }
    EXPECT_EQ(found.errors.leading, StandardErrors::Kind::runs) << found.errors.why;
    EXPECT_TRUE(found.errors.runs_scatter || sizes > 25) << "its own residuals explain larger changes";
    EXPECT_LT(std::abs(found.estimates[0].value - found.estimates[0].truth), sizes * all.errors.white[0]);
  }
}

TEST(StandardErrors, NameNoRunWhereAllAgree) {
  const Wheel wheel = wheel_of(4, 200);
  const FitProblem problem(wheel.experiment);
  int named = 0, by_runs = 0;
  for (const double phi : {0.0, 0.9}) {
    for (unsigned t = 0; t < 100; ++t) {
      Correlated noise{phi, std::mt19937_64(t)};
      const Fit found =
          fit(problem, noisy(
                           problem, [&] { return noise(); }, [&] { noise.x = noise.normal(noise.random); }));
      for (const double disagreement : found.errors.disagreement) named += disagreement > disagrees_from ? 1 : 0;
      by_runs += phi == 0 && found.errors.leading == StandardErrors::Kind::runs ? 1 : 0;
    }
  }
  EXPECT_EQ(named, 0);
  EXPECT_LE(by_runs, 1);
}

// Noise that is a third below or above what is stated is no agreement, in total or in one run.
TEST(StandardErrors, NoiseIsTestedOnBothSides) {
  const Wheel wheel = wheel_of(4, 400);
  const FitProblem problem(wheel.experiment);
  for (const double size : {0.7, 1.0, 1.3, 1e-6}) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    const Fit found = fit(problem, noisy(problem, [&] { return size * normal(random); }));
    EXPECT_EQ(found.status, size == 1.0 ? FitStatus::converged : FitStatus::misfit) << size;
    EXPECT_NEAR(found.errors.sensors[0].ratio, size, 0.08 * size + 1e-4);
    if (size < 1) {
      EXPECT_NE(found.why.find("smaller than stated"), std::string::npos) << found.why;
      EXPECT_NEAR(found.errors.error[0], found.identifiability.standard_error[0], 1e-9);
    }
  }
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  std::vector<Record> records = noisy(problem, [&] { return normal(random); });
  const Record ideal = problem.ideal_record(1);
  for (double& y : records[1].sensors[0].value) y += Wheel::noise * 0.8 * normal(random);
  const Fit found = fit(problem, records);
  EXPECT_EQ(found.status, FitStatus::misfit);
}

// Two degrees make chi squared exponential:  P(ratio^2 > x) = exp(-x),  P(ratio^2 < x) = 1 - exp(-x).
TEST(StandardErrors, ChanceOfARatio) {
  EXPECT_NEAR((NoiseTest{2.0, 2.0}).chance(), 2 * std::exp(-4.0), 1e-12);
  EXPECT_NEAR((NoiseTest{0.1, 2.0}).chance(), 2 * (1 - std::exp(-0.01)), 1e-12);
  EXPECT_NEAR((NoiseTest{1 + (NoiseTest{1.0, 1e6}).reach(), 1e6}).chance(), 0.05, 1e-3);
  EXPECT_DOUBLE_EQ((NoiseTest{std::nan(""), 1.0}).chance(), 1.0);
}

// An encoder that reads a third of its noise too much in one of six runs: the total size of the residuals hardly says
// so, and the estimate changes by a tenth of its error.
TEST(StandardErrors, AnOffsetInOneRunIsNamed) {
  const Wheel wheel = wheel_of(6, 400);
  const FitProblem problem(wheel.experiment);
  std::mt19937_64 random(10);
  std::normal_distribution<double> normal;
  std::vector<Record> records = noisy(problem, [&] { return normal(random); });
  for (double& y : records[2].sensors[0].value) y += Wheel::noise / 3;
  const Fit found = fit(problem, records);
  EXPECT_EQ(found.status, FitStatus::converged) << found.why;
  for (std::size_t r = 0; r < 6; ++r) EXPECT_EQ(found.runs[r].is_shifted(), r == 2) << r;
  EXPECT_NEAR(found.runs[2].mean[0], Wheel::noise / 3, 0.2 * Wheel::noise);
}

// However long the correlation of residuals is, those of more than twice the noise are no agreement: here over half the
// record.
TEST(StandardErrors, LongCorrelationHidesNoMisfit) {
  Wheel wheel = wheel_of(1, 100);
  wheel.experiment.runs[0].unknown_start = false;
  const FitProblem problem(wheel.experiment);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  std::vector<Record> records = noisy(problem, [&] { return normal(random); });
  for (std::size_t i = 0; i < 100; ++i) {
    records[0].sensors[0].value[i] += 3 * Wheel::noise * std::sin(0.03 * static_cast<double>(i));
  }
  const Fit found = fit(problem, records);
  EXPECT_EQ(found.status, FitStatus::misfit) << found.errors.sensors[0].ratio;
}

// Two sensors of one wheel, of which the noise is not known: restricted maximum likelihood finds both, and the
// estimate is as good as with the noise known.
TEST(StandardErrors, UnknownNoiseOfEverySensor) {
  Wheel wheel = wheel_of(3, 300);
  wheel.experiment.sensors.push_back(test::angle_of(wheel.experiment.scene, "wheel", 20 * Wheel::noise));
  const FitProblem known(wheel.experiment);
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const std::vector<Record> records = noisy(known, [&] { return normal(random); });
  const Fit expected = fit(known, records);
  Experiment unstated = wheel.experiment;
  for (Sensor& sensor : unstated.sensors) {
    sensor.noise_known = false;
    sensor.noise = 3e-3;
  }
  const FitProblem unknown(unstated);
  const Fit found = fit(unknown, records);
  EXPECT_EQ(found.status, FitStatus::converged) << found.why;
  EXPECT_NEAR(found.weighting.noise[0], Wheel::noise, 0.07 * Wheel::noise);
  EXPECT_NEAR(found.weighting.noise[1], 20 * Wheel::noise, 0.07 * 20 * Wheel::noise);
  EXPECT_NEAR(found.parameters[0], expected.parameters[0], 0.05 * expected.errors.error[0]);
  EXPECT_NEAR(found.errors.error[0], expected.errors.error[0], 0.07 * expected.errors.error[0]);
}

// One reading in ten is off by a thousand times the noise, always to the same side, in two of three runs.
TEST(StandardErrors, OutliersMoveNoRobustEstimateAndAreListed) {
  for (const Loss loss : {Loss::huber, Loss::cauchy, Loss::student}) {
    SCOPED_TRACE(to_string(loss));
    Wheel wheel = wheel_of(3, 300);
    wheel.experiment.loss = loss;
    const FitProblem problem(wheel.experiment);
    std::mt19937_64 random(12);
    std::normal_distribution<double> normal;
    std::vector<Record> records = noisy(problem, [&] { return normal(random); });
    std::set<std::pair<std::size_t, double>> gross;
    for (const std::size_t r : {0U, 2U}) {
      for (std::size_t i = r; i < 300; i += 10) {
        records[r].sensors[0].value[i] += 0.1;
        gross.emplace(r, records[r].sensors[0].time[i]);
      }
    }
    const Fit found = fit(problem, records);
    EXPECT_EQ(found.status, FitStatus::converged) << found.why;
    EXPECT_NEAR(found.parameters[0], Wheel::stiffness, 3 * found.identifiability.standard_error[0]);
    EXPECT_LT(found.errors.error[0], 2 * found.identifiability.standard_error[0]);
    std::set<std::pair<std::size_t, double>> listed;
    for (const Outlier& outlier : found.outliers) listed.emplace(outlier.run, outlier.time);
    EXPECT_EQ(listed, gross);
  }
}

TEST(StandardErrors, NoOutliersWithoutThem) {
  const Wheel wheel = wheel_of(3, 300);
  const FitProblem problem(wheel.experiment);
  EXPECT_TRUE(fit(problem, problem.records()).outliers.empty());
}

}  // namespace
}  // namespace poise::standard_errors_test

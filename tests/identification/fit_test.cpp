#include "identification/fit/fit.hpp"

#include <atomic>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "solvers/linear_algebra.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/wheel.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::fit_test {
namespace {

FitOptions starting_from(std::vector<double> starts) {
  FitOptions options;
  options.use_starts = true;
  options.starts = std::move(starts);
  return options;
}

// Largest difference of two fits of the same records, in standard errors.
double apart(const Fit& a, const Fit& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.estimates.size(); ++i) {
    worst = std::max(worst, std::abs(a.estimates[i].value - b.estimates[i].value) / a.estimates[i].standard_error);
  }
  return worst;
}

TEST(Fit, LiftNeedsNoStart) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  EXPECT_EQ(found.status, FitStatus::converged) << found.why;
  EXPECT_TRUE(found.usable());
  EXPECT_NE(found.start.find("damped sines"), std::string::npos) << found.start;
  EXPECT_EQ(found.tries, 1);
  EXPECT_LE(found.evaluations, 6);
  EXPECT_EQ(found.readings, 12000);
  EXPECT_EQ(found.degrees_of_freedom, 12000 - 4 - 18);
  EXPECT_NEAR(found.residual_over_noise, 1.0, 4 * found.residual_over_noise_sigma);
  EXPECT_NEAR(found.rms[0], 1e-4, 4e-4 * found.residual_over_noise_sigma);
  ASSERT_EQ(found.estimates.size(), 4U);
  for (const Estimate& estimate : found.estimates) {
    EXPECT_FALSE(estimate.withheld) << estimate.name << ": " << estimate.why;
    EXPECT_NEAR((estimate.value - estimate.truth) / estimate.standard_error, 0.0, 4.0) << estimate.name;
  }
  ASSERT_EQ(found.runs.size(), 6U);
  for (std::size_t r = 0; r < 6; ++r) {
    EXPECT_TRUE(found.runs[r].is_white()) << found.runs[r].name;
    EXPECT_NEAR(found.runs[r].nuisances[0], e.runs[r].equilibrium->at, 2e-5);
  }
}

// The start of a measured run is estimated: where its record alone says where to begin, a release has no part in it.
TEST(Fit, SaysWhereAReleaseWasNotUsed) {
  Experiment e = test::experiment("lift_experiment_four_runs");
  e.records = FitProblem(e).records();
  for (poise::Run& run : e.runs) run.data = {"lift.csv"};
  const std::string unused = "; the release of measured runs was not used";
  const auto fitted = [&] { return fit(FitProblem(e), e.records); };
  const Fit found = fitted();
  EXPECT_TRUE(found.start.starts_with("from damped sines")) << found.start;
  EXPECT_TRUE(found.start.ends_with(unused)) << found.start;
  for (poise::Run& run : e.runs) run.release.front().value *= -3;
  EXPECT_EQ(fitted().parameters, found.parameters) << "that is so";
  for (poise::Run& run : e.runs) run.release.clear();
  EXPECT_FALSE(fitted().start.ends_with(unused));
}

// The runs are computed on threads, but their costs are added up in one order.
TEST(Fit, DoesNotDependOnTheThreads) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  FitOptions options = starting_from(problem.starts());
  options.jobs = 1;
  const Fit alone = fit(problem, records, options);
  EXPECT_EQ(alone.status, FitStatus::converged) << alone.why;
  for (const int jobs : {2, 4}) {
    options.jobs = jobs;
    const Fit shared = fit(problem, records, options);
    EXPECT_EQ(shared.parameters, alone.parameters);
    EXPECT_EQ(shared.residual_over_noise, alone.residual_over_noise);
    EXPECT_EQ(shared.evaluations, alone.evaluations);
    for (std::size_t i = 0; i < alone.estimates.size(); ++i) {
      EXPECT_EQ(shared.estimates[i].standard_error, alone.estimates[i].standard_error);
    }
  }
}

// There is one minimum, whatever the start.
TEST(Fit, LiftConvergesFromStartsThatDifferByHalf) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  FitOptions strict;
  strict.function_tolerance = 1e-12;
  const Fit reference = fit(problem, records, strict);
  ASSERT_EQ(reference.status, FitStatus::converged);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    test::Random random(seed);
    std::vector<double> starts;
    for (const Parameter& p : problem.parameters()) {
      const double includes = e.unknowns[static_cast<std::size_t>(p.unknown)].includes;
      starts.push_back(p.truth + (p.truth + includes) * (random.chance(0.5) ? 0.5 : -0.5) * random.uniform(0.5, 1.0));
    }
    FitOptions options = starting_from(starts);
    options.function_tolerance = 1e-12;
    const Fit found = fit(problem, records, options);
    EXPECT_EQ(found.status, FitStatus::converged) << "seed " << seed << ": " << found.why;
    ASSERT_EQ(found.estimates.size(), 4U);
    EXPECT_LT(apart(reference, found), 1e-4) << "seed " << seed;
  }
}

// The gradient of the whole cost, by differences of the residuals, vanishes where a fit ends.
TEST(Fit, EndsWhereTheCostIsLeast) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  const Fit found = fit(problem, records);
  ASSERT_TRUE(found.usable());
  for (std::size_t i = 0; i < found.parameters.size(); ++i) {
    const double standard_error = found.estimates[i].standard_error;
    const auto cost = [&](double by) {
      std::vector<double> p = found.parameters;
      p[i] += by;
      double sum = 0.0;
      for (std::size_t r = 0; r < problem.runs(); ++r) {
        const Residuals e_r = problem.residuals(r, p, found.runs[r].nuisances, records[r]);
        EXPECT_EQ(e_r.size(), 1u);
        for (const double residual : e_r.at(0)) sum += residual * residual / 2;
      }
      return std::vector<double>{sum};
    };
    // In standard deviations: the cost grows by 1/2 over one at least.
    EXPECT_NEAR(test::derivative(cost, 0.3 * standard_error)[0] * standard_error, 0.0, 0.1) << found.estimates[i].name;
  }
}

TEST(Fit, WithoutPayloadEveryEstimateIsWithheld) {
  const Experiment e = test::experiment("lift_experiment_empty");
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  ASSERT_TRUE(found.usable()) << found.why;
  bool names_scale = false;
  for (const auto& direction : found.identifiability.null_directions) names_scale = names_scale || direction.scale;
  EXPECT_TRUE(names_scale);
  for (const Estimate& estimate : found.estimates) {
    EXPECT_TRUE(estimate.withheld) << estimate.name << " = " << estimate.value;
    EXPECT_FALSE(estimate.why.empty());
  }
}

TEST(Fit, WithholdsWhatIsAtABound) {
  Experiment e = test::experiment("lift_experiment");
  e.unknowns[2].max = 1.9e6;
  e.unknowns[2].start = 1.5e6;
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  ASSERT_EQ(found.estimates.size(), 4U);
  const Estimate& k = found.estimates[2];
  EXPECT_NEAR(k.value, 1.9e6, 1.0);
  EXPECT_TRUE(k.withheld);
  EXPECT_NE(k.why.find("at the bound 1.9e+06"), std::string::npos) << k.why;
  EXPECT_EQ(found.status, FitStatus::misfit);
}

// A bound that the truth respects does not hold the estimate.
TEST(Fit, LeavesABoundThatIsNotActive) {
  Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  FitOptions closely;  // so that the fits differ by much less than a standard error
  closely.function_tolerance = 1e-10;
  const Fit free = fit(problem, records, closely);
  e.unknowns[2].max = 2.2e6;
  e.unknowns[2].start = 2.2e6;
  const FitProblem bounded(e);
  closely.use_starts = true;
  const Fit found = fit(bounded, records, closely);
  EXPECT_EQ(found.status, FitStatus::converged) << found.why;
  EXPECT_FALSE(found.estimates[2].withheld) << found.estimates[2].why;
  EXPECT_LT(apart(free, found), 0.01);
}

// The mass of a pendulum of one mass is a null: a step along it that makes the mass negative, so that the motion cannot
// be computed, must not end the fit.
TEST(Fit, GoesOnAfterAStepThatLeavesTheRange) {
  const std::string text =
      "scene = \"pendulum_a01.toml\"\n[[sensor]]\nname = \"s\"\nangle = \"arm\"\nnoise = 1.83532e-05\n"
      "[[unknown]]\npath = \"point.arm.O.x\"\n[[unknown]]\npath = \"body.arm.mass\"\n"
      "[[run]]\nrelease = { arm = 0.17307431386598882 }\nduration = 2\nrate = 100\nseed = 365\n"
      "[[run]]\nrelease = { arm = -0.036427346197223376 }\nduration = 2\nrate = 200\nseed = 365\n"
      "[[run]]\nrelease = { arm = -0.18425759850399248 }\nduration = 1\nrate = 50\nseed = 365\n";
  const Experiment e = parse_experiment(text, test::dataset("pendulum_masses.toml"));
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  EXPECT_EQ(found.status, FitStatus::converged) << found.why;
  EXPECT_LT(std::abs(found.estimates[0].value), 4 * found.estimates[0].standard_error);
  EXPECT_TRUE(found.estimates[1].withheld);
}

// A prior as precise as the data moves the estimate half way towards it.
TEST(Fit, APriorAddsItsInformation) {
  Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  const Fit free = fit(problem, records);
  ASSERT_TRUE(free.usable());
  const Estimate& k = free.estimates[2];
  e.unknowns[2].prior = k.value + 4 * k.standard_error;
  e.unknowns[2].prior_deviation = k.standard_error;
  const FitProblem known(e);
  const Fit pulled = fit(known, records);
  ASSERT_TRUE(pulled.usable());
  EXPECT_NEAR((pulled.estimates[2].value - k.value) / k.standard_error, 2.0, 0.02);
  EXPECT_NEAR(pulled.estimates[2].standard_error / k.standard_error, 1 / std::sqrt(2.0), 0.01);
}

// Noise understated threefold: the fit reports it and multiplies its standard errors accordingly.
TEST(Fit, ReportsThatTheNoiseIsLargerThanStated) {
  Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  const Fit correct = fit(problem, records);
  e.sensors[0].noise /= 3;
  const FitProblem understated(e);
  const Fit found = fit(understated, records);
  EXPECT_EQ(found.status, FitStatus::misfit);
  EXPECT_TRUE(found.usable());
  EXPECT_NEAR(found.residual_over_noise, 3.0, 0.05);
  EXPECT_NE(found.why.find("times the stated noise"), std::string::npos) << found.why;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(found.estimates[i].standard_error / correct.estimates[i].standard_error, 1.0, 0.02);
    EXPECT_NEAR(found.estimates[i].value, correct.estimates[i].value, 0.01 * correct.estimates[i].standard_error);
  }
}

TEST(Fit, FailsWhereReadingsAreTooFew) {
  Experiment e = test::experiment("lift_experiment");
  e.runs.resize(1);
  e.runs[0].duration = 0.006;
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  EXPECT_EQ(found.status, FitStatus::failed);
  EXPECT_FALSE(found.usable());
  EXPECT_NE(found.why.find("6 readings do not determine 7 values"), std::string::npos) << found.why;
  EXPECT_TRUE(found.estimates.empty());
}

TEST(Fit, SaysWhyTheMotionCannotBeComputed) {
  test::Wheel wheel(1);
  const std::vector<Record> records = FitProblem(wheel.experiment).records();
  wheel.experiment.scene.bodies[1].inertia = 0.0;
  const Fit found = fit(FitProblem(wheel.experiment), records);
  EXPECT_EQ(found.status, FitStatus::failed);
  EXPECT_NE(found.why.find("has no inertia"), std::string::npos) << found.why;
}

TEST(Fit, StopsWhenInterrupted) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  std::atomic<bool> stop{true};
  FitOptions options;
  options.interrupt = &stop;
  EXPECT_EQ(fit(problem, records, options).status, FitStatus::interrupted);
  // In the middle of it.
  stop = false;
  options.use_starts = true;
  int said = 0;
  options.progress = [&](const std::string&) {
    if (++said == 2) stop = true;
  };
  const Fit found = fit(problem, records, options);
  EXPECT_EQ(found.status, FitStatus::interrupted);
  EXPECT_FALSE(found.usable());
  EXPECT_FALSE(found.why.empty());
}

// Wherever it is interrupted, there are values of all parameters, and a fit that goes on from them ends where one does
// that was not.
TEST(Fit, GoesOnFromWhereItWasInterrupted) {
  const Experiment e = test::experiment("lift_experiment_four_runs");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  FitOptions options;
  options.use_starts = true;
  const Fit whole = fit(problem, records, options);
  ASSERT_TRUE(whole.usable()) << whole.why;
  std::atomic<bool> stop{false};
  options.interrupt = &stop;
  bool was_interrupted = true;
  for (int after = 1; was_interrupted; after += 4) {
    stop = false;
    int said = 0;
    options.progress = [&](const std::string&) { stop = stop || ++said == after; };
    const Fit part = fit(problem, records, options);
    was_interrupted = stop;
    ASSERT_EQ(part.parameters.size(), whole.parameters.size()) << after;
    ASSERT_EQ(part.estimates.size(), whole.estimates.size()) << after;
    if (was_interrupted) {
      EXPECT_EQ(part.status, FitStatus::interrupted) << after;
    }
    FitOptions going_on;
    going_on.continued = &part;
    const Fit rest = fit(problem, records, going_on);
    ASSERT_EQ(rest.status, whole.status) << rest.why;
    for (std::size_t i = 0; i < rest.estimates.size(); ++i) {
      EXPECT_NEAR(rest.estimates[i].value, whole.estimates[i].value, 0.03 * whole.estimates[i].standard_error) << after;
    }
  }
}

TEST(Fit, LeavesOutChecksWhereItIsToBeQuick) {
  const Experiment e = test::experiment("lift_experiment_four_runs");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  FitOptions options;
  const Fit whole = fit(problem, records, options);
  options.checks = Checks::none;
  const Fit quick = fit(problem, records, options);
  EXPECT_EQ(quick.check_evaluations, 0);
  EXPECT_EQ(quick.unexamined.size(), 3U);
  EXPECT_TRUE(whole.unexamined.empty());
  EXPECT_EQ(quick.parameters, whole.parameters);
}

// The values to which a step of a fit may lead: without mass nothing moves the arm, and it has no coordinate.
TEST(FitProblem, AnArmWithoutMassHasNoMotion) {
  Experiment e;
  e.scene = test::chain(1, 1.0, 1.0);
  e.scene.gravity = {0, -9.81};
  e.scene.bodies[1].center = {0.5, 0};
  e.scene.bodies[1].inertia = 0.0;
  e.sensors = {test::angle_of(e.scene, "1", 1e-3)};
  e.unknowns = {test::unknown("body.1.mass")};
  e.unknowns[0].min = 0.0;
  e.runs = {test::simulated(100, 100)};
  const FitProblem problem(e);
  EXPECT_EQ(problem.why_no_motion({1.0}, {problem.run(0).released()}), "");
  EXPECT_NE(problem.why_no_motion({0.0}, {problem.run(0).released()}), "");
  EXPECT_EQ(
      problem.linearized(0, {0.0}, problem.run(0).released(), nullptr, INFINITY, 1e-8, problem.weighting()).rows.size(),
      0);
}

// A pendulum that oscillates widely for a long time: a fit of the whole record that starts with a wrong frequency ends
// in a local minimum with a wrong number of oscillations.
Experiment wide_pendulum() {
  Experiment e;
  e.scene = test::chain(1, 1.0, 1.0);
  e.scene.gravity = {0, -9.81};
  e.scene.bodies[1].center = {0.5, 0};
  e.scene.bodies[1].inertia = 1.0 / 12;
  e.sensors = {test::angle_of(e.scene, "1", 1e-3)};
  e.unknowns = {test::unknown("body.1.inertia")};
  e.unknowns[0].min = 0.0;
  Release lift;
  lift.body = 1;
  lift.value = 0.9 - M_PI / 2;
  e.scene.start.angle[1] = lift.value;
  e.runs = {test::simulated(100, 3000, {lift})};
  return e;
}

// Levenberg and Marquardt over the whole record at once, in its simplest form: the parameter at which it ends.
double plain_levenberg_marquardt(const FitProblem& problem, const Record& record, double start) {
  std::vector<double> nuisances = problem.run(0).released();
  Eigen::VectorXd x(static_cast<Eigen::Index>(nuisances.size()) + 1);
  x[0] = start;
  for (std::size_t i = 0; i < nuisances.size(); ++i) x[static_cast<Eigen::Index>(i) + 1] = nuisances[i];
  const auto triangle = [&](const Eigen::VectorXd& at) {
    const std::vector<double> n(at.data() + 1, at.data() + at.size());
    return problem.triangle(0, {at[0]}, n, &record, INFINITY, 1e-9, problem.weighting());
  };
  double damping = 1e-3;
  Eigen::MatrixXd R = triangle(x);
  for (int iteration = 0; iteration < 200; ++iteration) {
    // Columns of the triangle: nuisances, the parameter, the residuals.
    const Eigen::Index n = x.size();
    Eigen::MatrixXd J(n + 1, n);
    J << R.col(n - 1), R.leftCols(n - 1);
    const Eigen::MatrixXd H = J.transpose() * J;
    const Eigen::VectorXd g = J.transpose() * R.col(n);
    const Eigen::MatrixXd damped = H + damping * Eigen::MatrixXd(H.diagonal().asDiagonal());
    const Eigen::VectorXd next = x - solvers::FullyPivotedLu(damped).solve(g);
    const Eigen::MatrixXd there = next[0] > 0 ? triangle(next) : Eigen::MatrixXd();
    const double before = R.col(n).squaredNorm();
    if (there.size() == 0 || !(there.col(n).squaredNorm() < before)) {
      damping *= 4;
      if (damping > 1e12) break;
      continue;
    }
    const bool settled = before - there.col(n).squaredNorm() < 1e-12 * before;
    x = next;
    R = there;
    damping = std::max(1e-9, damping / 5);
    if (settled) break;
  }
  return x[0];
}

TEST(Fit, ConvergesWherePlainLevenbergMarquardtDoesNot) {
  const Experiment e = wide_pendulum();
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  const double truth = problem.truths()[0];
  EXPECT_NEAR(plain_levenberg_marquardt(problem, records[0], 1.01 * truth), truth, 1e-3 * truth);
  int elsewhere = 0;
  for (const double start : {0.5 * truth, 1.6 * truth, 3.0 * truth}) {
    elsewhere += std::abs(plain_levenberg_marquardt(problem, records[0], start) - truth) > 0.05 * truth ? 1 : 0;
    const Fit found = fit(problem, records, starting_from({start}));
    EXPECT_EQ(found.status, FitStatus::converged) << found.why;
    ASSERT_EQ(found.estimates.size(), 1U);
    EXPECT_NEAR((found.estimates[0].value - truth) / found.estimates[0].standard_error, 0.0, 4.0) << "from " << start;
  }
  EXPECT_GE(elsewhere, 2);
}

// An arm on a spring, which swings widely. Its short windows do not tell the anchor, the hook and the stiffness apart,
// and from these starts the residuals are 10^4 times the noise: steps of that size in the directions left free end at
// anchors thousands of kilometres away.
TEST(Fit, KeepsDimensionsThatAShortWindowLeavesFree) {
  Experiment e;
  e.scene = parse_scene(R"(
    gravity = [0, -9.81]
    [ground]
    points = { O = [0, 0], S = [0.262, -0.446] }
    [body.arm]
    points = { O = [0, 0], H = [0.408, 0.0637] }
    mass = 0.308
    center = [0.27, 0.02]
    inertia = 0.044
    [[pin]]
    points = ["ground.O", "arm.O"]
    [[torsion_spring]]
    name = "coil"
    bodies = ["ground", "arm"]
    stiffness = 3.4
    free_angle = -0.898
    [[spring]]
    name = "spring"
    points = ["ground.S", "arm.H"]
    stiffness = 121
    free_length = 0.331
    [start]
    arm = -1.84
  )",
                        "arm.toml");
  e.sensors = {test::angle_of(e.scene, "arm", 1e-4)};
  e.unknowns = {test::unknown("point.ground.S.x"), test::unknown("spring.spring.stiffness"),
                test::unknown("point.arm.H.y")};
  Release release;
  release.body = 1;
  release.value = -3.57;
  e.runs = {test::simulated(50, 356, {release})};
  const std::vector<double> truths = {0.262, 121, 0.0637};
  e.records = FitProblem(e).records();
  e.runs[0].release.clear();
  e.runs[0].data = {"arm.csv"};
  e.unknowns[0].start = 0.276;
  e.unknowns[1].start = 134;
  e.unknowns[2].start = 0.0566;
  const Fit found = fit(FitProblem(e), e.records);
  EXPECT_EQ(found.status, FitStatus::converged) << found.why;
  ASSERT_EQ(found.estimates.size(), 3U);
  for (std::size_t i = 0; i < truths.size(); ++i) {
    EXPECT_NEAR(found.estimates[i].value, truths[i], 4 * found.estimates[i].standard_error) << found.estimates[i].name;
  }
}

// Measured motions of a double pendulum, all 26 segments: what a bare Ceres program reaches, 0.00354 and 0.00310 rad.
// With the length of the first arm free the same or less, and in few evaluations.
void expect_measured(const std::string& name, double limit, bool length_is_free, int most_evaluations) {
  const std::filesystem::path data =
      std::filesystem::path(POISE_SOURCE_DIR) / "../shared/data/multi_arm_pendulum/double.csv";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is not there";
  Experiment e = read_experiment(test::dataset(name), {data, {}});
  ASSERT_EQ(e.runs.size(), 26U);
  if (length_is_free) {
    Unknown& length = e.unknowns.emplace_back();
    length.path = length.name = "point.arm1.elbow.x";
    length.min = 0.1;
    length.max = 0.3;
  }
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  ASSERT_TRUE(found.usable()) << found.why;
  ASSERT_EQ(found.rms.size(), 2U);
  EXPECT_LE(std::sqrt((found.rms[0] * found.rms[0] + found.rms[1] * found.rms[1]) / 2), limit);
  EXPECT_LE(found.evaluations, most_evaluations);
  ASSERT_EQ(found.runs.size(), 26U);
  for (const RunFit& run : found.runs) EXPECT_EQ(run.rms.size(), 2U) << run.name;
}

TEST(Fit, MeasuredDoublePendulumViscous) {
  expect_measured("double_pendulum_experiment.toml", 0.0036, false, 10);
  expect_measured("double_pendulum_experiment.toml", 0.00348, true, 10);
}

TEST(Fit, MeasuredDoublePendulumDry) {
  expect_measured("double_pendulum_dry_experiment.toml", 0.0031, false, 16);
  expect_measured("double_pendulum_dry_experiment.toml", 0.00303, true, 16);
}

}  // namespace
}  // namespace poise::fit_test

#include "identification/assessment/residuals.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/identification/experiments.hpp"
#include "tests/identification/wheel.hpp"

namespace poise::residuals_test {
namespace {

using test::Wheel;

// A fit that ended at the true values.
Fit at_truth(const FitProblem& problem) {
  Fit fitted;
  fitted.parameters = problem.truths();
  fitted.weighting = problem.weighting();
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    fitted.runs.emplace_back();
    fitted.runs.back().nuisances = problem.run(r).released();
  }
  return fitted;
}

TEST(Residuals, AreReadingMinusPrediction) {
  const Wheel wheel(1);
  const FitProblem problem(wheel.experiment);
  std::vector<Record> records = problem.records();
  for (std::size_t s = 0; s < records[0].sensors[0].time.size(); ++s) {
    records[0].sensors[0].value[s] = Wheel::at(records[0].sensors[0].time[s]) + 0.01 * static_cast<double>(s);
  }
  const RunResiduals found = residuals_of(problem, at_truth(problem), records, 0);
  ASSERT_EQ(found.residual.size(), 1U);
  ASSERT_EQ(found.residual[0].size(), 50U);
  for (std::size_t s = 0; s < 50; ++s) {
    EXPECT_NEAR(found.prediction[0][s], Wheel::at(records[0].sensors[0].time[s]), 1e-6);
    EXPECT_NEAR(found.residual[0][s], 0.01 * static_cast<double>(s), 1e-6);
  }
}

TEST(Residuals, AreNotNumbersWhereTheMotionFails) {
  const Wheel wheel(1);
  const FitProblem problem(wheel.experiment);
  Fit fitted = at_truth(problem);
  fitted.parameters[0] = std::nan("");
  const RunResiduals found = residuals_of(problem, fitted, problem.records(), 0);
  EXPECT_TRUE(std::isnan(found.residual[0][7]));
  EXPECT_TRUE(std::isnan(found.prediction[0][7]));
}

TEST(Residuals, OverTheNoiseOfEachSensor) {
  Wheel wheel(1);
  wheel.experiment.sensors.push_back(test::angle_of(wheel.experiment.scene, "wheel", 2e-3));
  const FitProblem problem(wheel.experiment);
  Fit fitted;
  fitted.weighting = problem.weighting();
  RunFit run;
  run.rms = {3 * Wheel::noise, 4 * 2e-3};
  EXPECT_NEAR(rms_over_noise(fitted, run), std::sqrt((9.0 + 16.0) / 2), 1e-12);
  run.rms = {std::nan(""), 4 * 2e-3};
  EXPECT_NEAR(rms_over_noise(fitted, run), 4.0, 1e-12) << "a sensor without readings in this run";
  fitted.weighting.noise[1] *= 2;
  EXPECT_NEAR(rms_over_noise(fitted, run), 2.0, 1e-12) << "the noise that the fit estimated";
  run.rms.clear();
  EXPECT_TRUE(std::isnan(rms_over_noise(fitted, run)));
}

TEST(Residuals, WorstRunFirst) {
  const Wheel wheel(4);
  const FitProblem problem(wheel.experiment);
  Fit fitted = at_truth(problem);
  fitted.runs[0].rms = {1e-4};
  fitted.runs[1].rms = {5e-4};
  fitted.runs[3].rms = {1e-4};
  EXPECT_EQ(worst_first(fitted), (std::vector<std::size_t>{2, 1, 0, 3}));
}

// k d(a cos(w t))/dk = -a (w t / 2) sin(w t).
TEST(Sensitivities, OfAnOscillatorByItsStiffness) {
  Wheel wheel(1);
  wheel.experiment.unknowns[0].includes = Wheel::stiffness;  // the shown value is twice that of the scene
  const FitProblem problem(wheel.experiment);
  const auto found = problem.sensitivities(0, problem.truths(), problem.run(0).released());
  ASSERT_EQ(found.size(), 1U);
  ASSERT_EQ(found[0].size(), 1U);
  const std::vector<double>& times = problem.run(0).times()[0];
  ASSERT_EQ(found[0][0].size(), times.size());
  for (std::size_t s = 0; s < times.size(); ++s) {
    const double phase = std::sqrt(Wheel::stiffness / Wheel::inertia) * times[s];
    const double expected = -2 * Wheel::angle * phase / 2 * std::sin(phase) / Wheel::noise;
    EXPECT_NEAR(found[0][0][s], expected, 1e-4 * Wheel::angle / Wheel::noise) << times[s];
  }
  EXPECT_TRUE(problem.sensitivities(0, {std::nan("")}, problem.run(0).released()).empty());
}

TEST(FitProblem, CountsNuisancesAndReadings) {
  Wheel wheel(3);
  wheel.experiment.runs[2].unknown_start = false;
  const FitProblem problem(wheel.experiment);
  EXPECT_TRUE(wheel.experiment.is_simulated());
  EXPECT_EQ(problem.nuisances(), 4);
  EXPECT_EQ(problem.readings(), 150U);
  EXPECT_EQ(problem.unknown_of(0).path, "torsion_spring.coil.stiffness");
  wheel.experiment.runs[1].data = {"wheel.csv"};
  EXPECT_FALSE(wheel.experiment.is_simulated());
}

}  // namespace
}  // namespace poise::residuals_test

// What sizes of residuals say of a fit.

#include "identification/fit/private/verdict.hpp"

#include <gtest/gtest.h>

#include "tests/identification/wheel.hpp"

namespace poise::verdict_test {
namespace {

// 1000 independent residuals scatter by 2 % about the stated noise.
FitVerdict verdict_at(double ratio, bool is_aliased = false, int tries = 1) {
  const test::Wheel wheel(1);
  const FitProblem problem(wheel.experiment);
  Fit fitted;
  fitted.weighting = problem.weighting();
  fitted.tries = tries;
  fitted.residual_over_noise = ratio;
  fitted.errors.sensors = {{.ratio = ratio, .degrees = 1000, .size = ratio}};
  fitted.errors.runs_noise = {{{.ratio = ratio, .degrees = 1000, .size = ratio}}};
  return verdict_on(problem, fitted, is_aliased);
}

TEST(FitVerdict, ResidualsAsStatedAreConverged) {
  for (const double ratio : {0.95, 1.0, 1.05}) {
    EXPECT_EQ(verdict_at(ratio).status, FitStatus::converged) << ratio;
    EXPECT_TRUE(verdict_at(ratio).why.empty()) << ratio;
  }
}

TEST(FitVerdict, LargerOnesAreAMisfitOfTheModelOrTheNoise) {
  const FitVerdict slightly = verdict_at(1.2);
  EXPECT_EQ(slightly.status, FitStatus::misfit);
  EXPECT_EQ(slightly.why,
            "the residuals are 1.2 times the stated noise, expected 1 ± 0.044 (95 %): the model is incomplete, or the "
            "noise is larger than stated; standard errors are multiplied by what is found over what is expected");
  const std::string much = verdict_at(5.0, false, 4).why;
  EXPECT_NE(much.find("; or a better minimum exists, 4 starts were tried"), std::string::npos) << much;
}

// Of correlated residuals a fit takes much: 1.28 times the noise are 2.2 times what such noise would leave.
TEST(FitVerdict, SaysTheSizeOfCorrelatedResidualsItselfAndWhatNoiseWouldLeave) {
  const test::Wheel wheel(1);
  const FitProblem problem(wheel.experiment);
  Fit fitted;
  fitted.weighting = problem.weighting();
  fitted.errors.sensors = {{.ratio = 2.22, .degrees = 50, .size = 1.28}};
  fitted.errors.runs_noise = {{{.ratio = 2.22, .degrees = 50, .size = 1.28}}};
  const std::string why = verdict_on(problem, fitted, false).why;
  EXPECT_NE(why.find("1.28 times the stated noise, expected 0.577 ± 0.11 (95 %)"), std::string::npos) << why;
}

TEST(FitVerdict, SmallerOnesAreSmoothedReadings) {
  const FitVerdict smaller = verdict_at(0.8);
  EXPECT_EQ(smaller.status, FitStatus::misfit);
  EXPECT_NE(smaller.why.find("or the readings have been smoothed"), std::string::npos) << smaller.why;
}

TEST(FitVerdict, LargeOnesFailWhereOtherFrequenciesWerePossible) {
  EXPECT_EQ(verdict_at(1.2, true).status, FitStatus::misfit);
  EXPECT_EQ(verdict_at(2.0, true).status, FitStatus::failed);
  EXPECT_EQ(verdict_at(1.0, true).status, FitStatus::converged);
}

TEST(FitVerdict, SeveralMinimaAreAmbiguous) {
  const test::Wheel wheel(1);
  const FitProblem problem(wheel.experiment);
  Fit fitted;
  fitted.alternatives = {{.values = {20.0}, .frequency = {1.0}}, {.values = {80.0}, .frequency = {2.0}, .more = 1.0}};
  const FitVerdict several = verdict_on(problem, fitted, false);
  EXPECT_EQ(several.status, FitStatus::ambiguous);
  EXPECT_NE(several.why.find("with frequencies of 1 Hz and 2 Hz; read faster"), std::string::npos) << several.why;
  fitted.alternatives[1].frequency.clear();  // where nothing restores the pose
  const FitVerdict without = verdict_on(problem, fitted, false);
  EXPECT_NE(without.why.find("2 minima explain the readings equally well; read faster"), std::string::npos)
      << without.why;
}

}  // namespace
}  // namespace poise::verdict_test

// Bootstrap of residuals: against white, correlated and run-wise standard errors.

#include "identification/assessment/bootstrap.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/identification/wheel.hpp"

namespace poise::bootstrap_test {
namespace {

Bootstrap of(const FitProblem& problem, const std::vector<Record>& records, const Fit& found, int jobs) {
  return bootstrap(problem, records, found, {.samples = 200, .jobs = jobs});
}

// 200 samples: a standard error within 5 % (1 sigma).
TEST(Bootstrap, OfWhiteResidualsIsTheWhiteError) {
  test::Wheel wheel(3);
  const FitProblem problem(wheel.experiment);
  const std::vector<Record> records = problem.records();
  const Fit found = fit(problem, records);
  const Bootstrap again = of(problem, records, found, 2);
  EXPECT_EQ(again.samples, 200);
  EXPECT_EQ(again.failed, 0);
  EXPECT_NEAR(again.standard_error[0], found.errors.white[0], 0.25 * found.errors.white[0]);
  EXPECT_NEAR(again.high[0] - again.low[0], 2 * 1.96 * again.standard_error[0], 0.8 * again.standard_error[0]);
  const Bootstrap same = of(problem, records, found, 1);
  EXPECT_EQ(again.standard_error, same.standard_error) << "the same for any number of threads";
  EXPECT_EQ(again.low, same.low);
}

TEST(Bootstrap, OfCorrelatedResidualsIsTheSerialError) {
  test::Wheel wheel(4);
  for (poise::Run& run : wheel.experiment.runs) run.duration = 6.0;
  const FitProblem problem(wheel.experiment);
  std::vector<Record> records = problem.records();
  const double phi = 0.9;
  for (std::size_t r = 0; r < records.size(); ++r) {
    solvers::RandomStream random(77, static_cast<std::uint32_t>(r));
    const Record ideal = problem.ideal_record(r);
    double x = random.normal();
    for (std::size_t i = 0; i < ideal.sensors[0].value.size(); ++i) {
      records[r].sensors[0].value[i] = ideal.sensors[0].value[i] + test::Wheel::noise * x;
      x = phi * x + std::sqrt(1 - phi * phi) * random.normal();
    }
  }
  const Fit found = fit(problem, records);
  ASSERT_EQ(found.errors.leading, StandardErrors::Kind::serial);
  const Bootstrap again = of(problem, records, found, 0);
  EXPECT_TRUE(std::isfinite(again.block));
  EXPECT_NEAR(again.standard_error[0], found.errors.serial[0], 0.35 * found.errors.serial[0]);
  EXPECT_GT(again.standard_error[0], 1.8 * found.errors.white[0]);
}

}  // namespace
}  // namespace poise::bootstrap_test

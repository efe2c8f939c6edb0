// The catalogue of hard cases that Poise ships, from a few starts each: virtual work converges without false claims.

#include <gtest/gtest.h>

#include "comparison/stress.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::comparison::hard_catalogue_test {
namespace {

constexpr int starts = 3;
constexpr int largest_series = 1000;

TEST(HardCatalogue, VirtualWorkConvergesWithoutFalseClaims) {
  StressOptions options;
  options.methods = {Method::virtual_work};
  options.starts = starts;
  int tried = 0;
  for (const HardCase& hard : read_catalogue(test::dataset("hard"))) {
    if (hard.size > largest_series) continue;
    SCOPED_TRACE(hard.name);
    const std::vector<CaseResult> results = stress({hard}, options);
    ASSERT_EQ(results.size(), 1u);
    const Cell& cell = results.front().cells.at(0);
    EXPECT_EQ(cell.false_claims, 0) << cell.why;
    EXPECT_EQ(cell.converged, cell.starts) << cell.why;
    ++tried;
  }
  EXPECT_GE(tried, 100);
}

}  // namespace
}  // namespace poise::comparison::hard_catalogue_test

#include "comparison/friction_cases.hpp"

#include <gtest/gtest.h>

#include "tests/support/known_answers.hpp"

namespace poise::comparison::friction_cases_test {
namespace {

TEST(FrictionCases, TheCatalogueHoldsAndSlipsAsKnown) {
  const std::vector<FrictionCase> cases = read_friction_cases(test::dataset("hard"));
  ASSERT_GE(cases.size(), 12U);
  for (const FrictionCase& known : cases) {
    const FrictionResult result = run_friction_case(known);
    EXPECT_TRUE(result.agrees) << known.name << ": " << result.why << ", factor " << result.pose.least_factor;
    EXPECT_TRUE(result.proved) << known.name;
  }
}

TEST(FrictionCases, NoFileHasNoCases) { EXPECT_TRUE(read_friction_cases(test::dataset("friction")).empty()); }

}  // namespace
}  // namespace poise::comparison::friction_cases_test

#include "identification/identifiability/private/structural_nulls_50.hpp"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/identification/experiments.hpp"
#include "tests/support/build_scene.hpp"

namespace poise::structural_nulls_50_test {
namespace {

/// Of a sprung and damped mass on a rail along x, m x'' + c x' + k x = F: m, c and k have a common factor unless F
/// pulls.
std::optional<NullSpace> nulls_on_rail(double along) {
  Experiment e = test::oscillator();
  Force pull;
  pull.name = "pull";
  pull.at = {1, 0};
  pull.vector = {along, -5.0};
  e.scene.forces = {pull};
  const FitProblem problem(e);
  const std::vector<double> truths = problem.truths();
  return structural_nulls_50(problem, {problem.run(0).actions(truths.data(), problem.run(0).released().data(), 20)});
}

TEST(StructuralNulls50, HaveACommonFactorWithoutAForceAlongTheRail) {
  const std::optional<NullSpace> found = nulls_on_rail(0.0);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->dimension(), 1);
  EXPECT_EQ(found->unclear, 0);
  for (Eigen::Index i = 0; i < 3; ++i) EXPECT_TRUE(found->touches(i)) << i;
  EXPECT_NEAR(found->basis(1, 0) / found->basis(0, 0), 40.0, 1e-12);
  EXPECT_NEAR(found->basis(2, 0) / found->basis(0, 0), 0.3, 1e-14);
}

// Far below what doubles can tell from rounding of the accelerations.
TEST(StructuralNulls50, AnEffectEndsANullHoweverSmall) {
  const std::optional<NullSpace> found = nulls_on_rail(1e-11);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->dimension(), 0);
}

// The cosine of a right angle in doubles is 6e-17, an effect in 50 digits that the rail does not have.
TEST(StructuralNulls50, AnEffectOfRoundingDecidesNothing) { EXPECT_FALSE(nulls_on_rail(5.0 * 6.1e-17)); }

}  // namespace
}  // namespace poise::structural_nulls_50_test

// Equilibria as goals.

#include <string>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "tests/design/lever_designs.hpp"

namespace poise::test::equilibrium_goals_test {
namespace {

using Status = GoalDesign::Status;

// A spring along a lever of 1 m, which ends 1 m from its tip: it holds the lever at 0 where it pulls, free length below
// 1 m. By symmetry the force that turns the lever vanishes there for all springs.
const char* const spring_in_line = R"(title = "lever"
source = "ours"
[ground]
points = { O = [0, 0], S = [2, 0] }
[body.lever]
points = { O = [0, 0], B = [1, 0] }
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[spring]]
name = "s"
points = ["ground.S", "lever.B"]
stiffness = 10
free_length = 1.4
)";

TEST(EquilibriumGoals, AStableOneAtZeroIsLookedForOnBothSides) {
  const app_tests::TempFolder folder;
  const std::string chosen = "[variables]\n\"spring.s.free_length\" = [0.95, 2.5]\n[[goal]]\nequilibrium = ";
  const GoalDesign stable = design_of(folder, spring_in_line, chosen + "\"stable\"\nalong = \"angle.lever\"\nat = 0\n");
  ASSERT_EQ(stable.status, Status::met);
  EXPECT_LT(get_value(*stable.scene, "spring.s.free_length"), 1.0);
  const GoalDesign unstable =
      design_of(folder, spring_in_line, chosen + "\"unstable\"\nalong = \"angle.lever\"\nat = 0\n");
  ASSERT_EQ(unstable.status, Status::met);
  EXPECT_GT(get_value(*unstable.scene, "spring.s.free_length"), 1.0);
}

// k (a - a0) + m g c cos(a) = 0 at a = 0.3 is a line of k and a0; over [0.6, 1] there is to be none.
TEST(EquilibriumGoals, WhereThereIsOneAndWhereThereIsNone) {
  const app_tests::TempFolder folder;
  const GoalDesign found = design_of(folder, SprungLever().text(), R"([variables]
"torsion_spring.coil.stiffness" = [1, 30]
"torsion_spring.coil.free_angle" = [0, 2]
[[goal]]
equilibrium = "stable"
along = "angle.lever"
at = 0.3
[[goal]]
equilibrium = "none"
along = "angle.lever"
over = [0.6, 1]
)");
  ASSERT_EQ(found.status, Status::met);
  SprungLever lever;
  lever.stiffness = get_value(*found.scene, "torsion_spring.coil.stiffness");
  lever.free_angle = get_value(*found.scene, "torsion_spring.coil.free_angle");
  EXPECT_NEAR(lever.torque(0.3), 0.0, 1e-6);
  EXPECT_GT(lever.torque(0.31), 0.0);
  for (double angle = 0.6; angle <= 1.0; angle += 0.01) EXPECT_GT(lever.torque(angle), 0.0);
}

}  // namespace
}  // namespace poise::test::equilibrium_goals_test

// What goals are asked along, where it meets what is chosen.

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "tests/design/lever_designs.hpp"

namespace poise::test::design_sweeps_test {
namespace {

// The lever without weight, a load P across its tip at 0.4 rad:  k a = f P cos(a - 0.4)  for the factor f of all loads.
const std::string loaded = R"(
[[force]]
name = "P"
at = "lever.B"
direction = [-0.3894183423086505, 0.9210609940028851]
size = 4
)";

std::string lever_without_weight() {
  SprungLever lever;
  lever.gravity = 0.0;
  lever.free_angle = 0.0;
  return lever.text() + loaded;
}

TEST(DesignSweeps, AFactorOfAllLoadsIsOfTheLoadThatIsChosen) {
  const app_tests::TempFolder folder;
  const GoalDesign found = design_of(folder, lever_without_weight(), R"([variables]
"load.P" = [1, 10]
[[goal]]
of = "angle.lever"
along = "loads"
at = [0.8, 1.2]
most = 0.95
[[goal]]
of = "angle.lever"
along = "loads"
at = 1.2
equals = 0.9
)");
  ASSERT_EQ(found.status, GoalDesign::Status::met);
  EXPECT_NEAR(get_value(*found.scene, "load.P"), 5.0 * 0.9 / (1.2 * std::cos(0.5)), 1e-8);
}

// The coil has the stiffness c^2, while the load grows to 6 N.
TEST(DesignSweeps, NumbersThatFollowCountOnceAlongALoad) {
  const app_tests::TempFolder folder;
  std::string scene = lever_without_weight();
  scene.insert(scene.find("[ground]"), "[numbers]\nc = 2\n");
  const std::string stiffness = "stiffness = 5";
  scene.replace(scene.find(stiffness), stiffness.size(), "stiffness = \"c^2\"");
  const GoalDesign found = design_of(folder, scene, R"([variables]
"numbers.c" = [1, 4]
[[goal]]
of = "angle.lever"
along = "load.P"
at = 6
equals = 0.9
)");
  ASSERT_EQ(found.status, GoalDesign::Status::met);
  EXPECT_NEAR(get_value(*found.scene, "numbers.c"), std::sqrt(6.0 * std::cos(0.5) / 0.9), 1e-8);
}

}  // namespace
}  // namespace poise::test::design_sweeps_test

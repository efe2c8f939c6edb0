// Random goals whose numbers are known: what is said to be met is met, and most are.

#include "tests/design/planted_goals.hpp"

#include <string>

#include <gtest/gtest.h>

#include "design/goals/design_search.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/design/goal_judge.hpp"
#include "tests/support/seed.hpp"

namespace poise::test::planted_goals_test {
namespace {

constexpr long most_evaluations = 20'000;  // about 5 s on one core

TEST(RandomGoals, ArePlantedAndFound) {
  const int wanted = cases(25, 1000);
  constexpr const char* statuses[] = {"met", "not met", "not confirmed", "no start", "interrupted"};
  int problems = 0, met = 0;
  std::string missed;
  for (std::uint64_t one = seed(1); problems < wanted; ++one) {
    const auto problem = plant_goals(one);
    if (!problem) continue;
    const app_tests::TempFolder folder;
    const std::string file = write_files(folder, *problem);
    ++problems;
    GoalSearchOptions options;
    options.jobs = 1;
    options.seed = one;
    options.starts = 40;
    const GoalProblem read = read_goals(file);
    const GoalDesign found = design_for_goals(read, options);
    const bool is_met = found.status == GoalDesign::Status::met;
    EXPECT_EQ(is_met ? missed_goals(file, *found.scene) : "", "") << problem->what;
    if (is_met && found.counts.evaluations <= most_evaluations) {
      ++met;
    } else {
      missed +=
          problem->what + ": " + (is_met ? "too many evaluations" : statuses[static_cast<int>(found.status)]) + "\n";
    }
  }
  RecordProperty("met", met);
  EXPECT_GE(met, 0.95 * problems - 1e-9) << met << " of " << problems << "\n" << missed;
}

}  // namespace
}  // namespace poise::test::planted_goals_test

#include "comparison/stress_summary.hpp"

#include <gtest/gtest.h>

#include "comparison/tally.hpp"

namespace poise::comparison::stress_summary_test {
namespace {

Verdict converged_with(std::optional<double> error, std::optional<double> allowed) {
  return {.kind = Verdict::Kind::converged, .error = error, .allowed = allowed};
}

TEST(Tally, TheLargestErrorSurvivesConvergedStartsWithoutOne) {
  Tally tally(Method::virtual_work);
  const Equilibrium equilibrium;
  tally.add(equilibrium, converged_with(1e-12, 1e-11));
  tally.add(equilibrium, converged_with(1e-9, 1e-8));
  tally.add(equilibrium, converged_with({}, {}));
  tally.add(equilibrium, converged_with(1e-13, 1e-7));
  const Cell cell = tally.cell();
  EXPECT_EQ(cell.converged, 4);
  EXPECT_EQ(cell.error, 1e-9);
  EXPECT_EQ(cell.allowed, 1e-8);
}

TEST(Tally, ConvergedStartsWithoutErrorLeaveNone) {
  Tally tally(Method::virtual_work);
  tally.add(Equilibrium(), converged_with({}, {}));
  EXPECT_FALSE(tally.cell().error.has_value());
}

Cell cell_with(int starts, int converged, int false_claims = 0) {
  Cell cell;
  cell.method = Method::virtual_work;
  cell.starts = starts;
  cell.converged = converged;
  cell.false_claims = false_claims;
  if (converged > 0) cell.iterations = cell.microseconds = converged;
  return cell;
}

TEST(StressSummary, OnlyAllStartsAreAThousandTenthsAndOnlyNoneAreZero) {
  EXPECT_EQ(converged_tenths(cell_with(100000, 100000)), 1000);
  EXPECT_EQ(converged_tenths(cell_with(100000, 99999)), 999);
  EXPECT_EQ(converged_tenths(cell_with(100000, 1)), 1);
  EXPECT_EQ(converged_tenths(cell_with(100000, 0)), 0);
  EXPECT_EQ(converged_tenths(cell_with(3, 2)), 666);
  EXPECT_FALSE(converged_tenths(Cell()).has_value());
}

StressOutcome three_cases() {
  StressOutcome outcome;
  outcome.methods = {"virtual-work", "energy"};
  Cell not_applicable;
  not_applicable.applies = false;
  outcome.results.resize(3);
  outcome.results[0].hard.name = "easy";
  outcome.results[0].cells = {cell_with(10, 10), cell_with(10, 10)};
  outcome.results[1].hard.name = "hard";
  outcome.results[1].cells = {cell_with(10, 9), cell_with(10, 0, 2)};
  outcome.results[2].hard.name = "odd";
  outcome.results[2].hard.answer = KnownAnswer::none;
  outcome.results[2].cells = {cell_with(10, 10), not_applicable};
  for (CaseResult& result : outcome.results) result.cells[1].method = Method::energy;
  return outcome;
}

TEST(StressSummary, CountsByMethod) {
  const std::vector<MethodSummary> of = summaries(three_cases());
  ASSERT_EQ(of.size(), 2U);
  EXPECT_EQ(of[0].name, "virtual-work");
  EXPECT_EQ(of[0].applicable, 2);
  EXPECT_EQ(of[0].solved, 1);
  EXPECT_EQ(of[0].iterations, 9.5);
  EXPECT_EQ(of[1].false_claims, 2);
  EXPECT_EQ(of[1].iterations, 10.0) << "only cases where it converged";
}

TEST(StressSummary, NamesWhatFails) {
  const StressFailures failures = failures_of(three_cases());
  EXPECT_EQ(failures.false_claims, 2);
  EXPECT_EQ(failures.unsolved, std::vector<std::string>{"hard"}) << "the case without an answer does not count";
}

TEST(StressSummary, OfSafeguardsShowsWhereOneMakesADifference) {
  StressOutcome outcome = three_cases();
  EXPECT_EQ(shown_cases(outcome).size(), 3U);
  outcome.safeguards = true;
  const std::vector<const CaseResult*> shown = shown_cases(outcome);
  ASSERT_EQ(shown.size(), 2U);
  EXPECT_EQ(shown[0]->hard.name, "hard");
  EXPECT_EQ(shown[1]->hard.name, "odd");
}

}  // namespace
}  // namespace poise::comparison::stress_summary_test

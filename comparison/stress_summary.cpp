#include "comparison/stress_summary.hpp"

#include <algorithm>
#include <cmath>

namespace poise::comparison {

std::vector<MethodSummary> summaries(const StressOutcome& outcome) {
  std::vector<MethodSummary> out;
  for (std::size_t k = 0; k < outcome.methods.size(); ++k) {
    MethodSummary s;
    s.name = outcome.methods[k];
    std::vector<double> iterations, times;
    for (const CaseResult& result : outcome.results) {
      if (k >= result.cells.size() || !result.cells[k].applies) continue;
      const Cell& cell = result.cells[k];
      s.false_claims += cell.false_claims;
      s.denied_by_check += cell.denied_by_check;
      if (result.hard.answer != KnownAnswer::equilibrium) continue;
      ++s.applicable;
      if (solved(cell)) ++s.solved;
      if (cell.converged == 0) continue;
      iterations.push_back(cell.iterations.value());
      times.push_back(cell.microseconds.value());
    }
    s.iterations = median(iterations);
    s.microseconds = median(times);
    out.push_back(s);
  }
  return out;
}

std::vector<const CaseResult*> shown_cases(const StressOutcome& outcome) {
  std::vector<const CaseResult*> out;
  for (const CaseResult& result : outcome.results) {
    const bool differs = std::any_of(result.cells.begin(), result.cells.end(), [&](const Cell& cell) {
      const Cell& first = result.cells.front();
      return cell.applies != first.applies || converged_tenths(cell) != converged_tenths(first) ||
             (cell.false_claims > 0) != (first.false_claims > 0);
    });
    if (!outcome.safeguards || differs) out.push_back(&result);
  }
  return out;
}

std::optional<int> converged_tenths(const Cell& cell) {
  if (cell.starts == 0) return std::nullopt;
  if (cell.converged == 0) return 0;
  return std::max(1, static_cast<int>(std::floor(1000.0 * cell.converged / cell.starts)));
}

StressFailures failures_of(const StressOutcome& outcome) {
  StressFailures out;
  for (const CaseResult& result : outcome.results) {
    for (std::size_t k = 0; k < result.cells.size(); ++k) {
      const Cell& cell = result.cells[k];
      out.false_claims += cell.false_claims;
      // Of safeguards only the first form has all of them.
      const bool must = cell.method == Method::virtual_work && (!outcome.safeguards || k == 0);
      if (must && result.hard.answer == KnownAnswer::equilibrium && !solved(cell)) {
        out.unsolved.push_back(result.hard.name);
      }
    }
  }
  return out;
}

}  // namespace poise::comparison

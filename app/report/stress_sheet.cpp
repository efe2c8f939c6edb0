#include "app/report/stress_sheet.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace poise::app {

using comparison::CaseResult;
using comparison::Expect;

std::vector<MethodSummary> summaries(const StressOutcome& outcome) {
  std::vector<MethodSummary> out;
  for (std::size_t k = 0; k < outcome.methods.size(); ++k) {
    MethodSummary s;
    s.name = outcome.methods[k];
    std::vector<double> iterations, times;
    for (const CaseResult& result : outcome.results) {
      if (k >= result.cells.size() || result.cells[k].refused) continue;
      const comparison::Cell& cell = result.cells[k];
      s.wrong += cell.wrong;
      s.denied += cell.denied;
      s.inexact += cell.inexact;
      if (result.hard.expect != Expect::equilibrium) continue;
      ++s.taken;
      if (comparison::mastered(cell)) ++s.mastered;
      if (cell.arrived == 0) continue;
      iterations.push_back(cell.iterations.value());
      times.push_back(cell.microseconds.value());
    }
    s.iterations = comparison::median(iterations);
    s.microseconds = comparison::median(times);
    out.push_back(s);
  }
  return out;
}

std::vector<const CaseResult*> shown_cases(const StressOutcome& outcome) {
  std::vector<const CaseResult*> out;
  for (const CaseResult& result : outcome.results) {
    const bool differs = std::any_of(result.cells.begin(), result.cells.end(), [&](const comparison::Cell& cell) {
      return arrival(cell) != arrival(result.cells.front());
    });
    if (!outcome.safeguards || differs) out.push_back(&result);
  }
  return out;
}

std::string arrival(const comparison::Cell& cell) {
  if (cell.refused) return "-";
  if (cell.starts == 0) return "";
  const double tenths = std::floor(1000.0 * cell.arrived / cell.starts);
  std::string text = cell.arrived == cell.starts ? "100"
                     : cell.arrived == 0         ? "0"
                                                 : fmt::format("{:.1f}", 0.1 * std::max(1.0, tenths));
  return text + (cell.wrong > 0 ? "!" : "");
}

std::string digits_of(const std::optional<double>& allowed) {
  if (!allowed) return "-";
  return fmt::format("{:.1f}", std::max(0.0, -std::log10(*allowed)));
}

StressFailures failures_of(const StressOutcome& outcome) {
  StressFailures out;
  for (const CaseResult& result : outcome.results) {
    for (std::size_t k = 0; k < result.cells.size(); ++k) {
      const comparison::Cell& cell = result.cells[k];
      out.wrong += cell.wrong;
      // Of safeguards only the first form has all of them.
      const bool must = cell.method == Method::virtual_work && (!outcome.safeguards || k == 0);
      if (must && result.hard.expect == Expect::equilibrium && !comparison::mastered(cell)) {
        out.missed.push_back(result.hard.name);
      }
    }
  }
  return out;
}

}  // namespace poise::app

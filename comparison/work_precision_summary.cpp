#include "comparison/work_precision_summary.hpp"

#include <algorithm>
#include <cstddef>

namespace poise::comparison {
namespace {

bool same_outcome(const WorkPrecisionRow& a, const WorkPrecisionRow& b) {
  return a.error == b.error && a.equilibrium == b.equilibrium && a.iterations == b.iterations &&
         a.evaluations == b.evaluations && a.ending == b.ending && a.confirmed == b.confirmed;
}

ToleranceSpan span_of(const WorkPrecisionRow* first, const WorkPrecisionRow* end) {
  std::vector<double> times;
  for (const WorkPrecisionRow* row = first; row != end; ++row) times.push_back(row->microseconds);
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return {first, end - 1, *middle};
}

}  // namespace

std::vector<std::vector<ToleranceSpan>> tolerance_spans(const WorkPrecision& result) {
  std::vector<std::vector<ToleranceSpan>> out;
  const WorkPrecisionRow* const end = result.rows.data() + result.rows.size();
  for (const WorkPrecisionRow* first = result.rows.data(); first != end;) {
    const WorkPrecisionRow* next = first + 1;
    while (next != end && next->method == first->method && same_outcome(*first, *next)) ++next;
    if (out.empty() || out.back().front().loosest->method != first->method) out.emplace_back();
    out.back().push_back(span_of(first, next));
    first = next;
  }
  return out;
}

std::string status_of(const WorkPrecisionRow& row) {
  switch (row.ending) {
    case Ending::converged:
      return row.confirmed ? "confirmed" : "too coarse";
    case Ending::elsewhere:
      return "elsewhere";
    case Ending::not_converged:
      break;
  }
  return "not converged";
}

bool any_confirmed(const WorkPrecision& result) {
  return std::any_of(result.rows.begin(), result.rows.end(),
                     [](const WorkPrecisionRow& row) { return row.ending == Ending::converged && row.confirmed; });
}

}  // namespace poise::comparison

#include "identification/assessment/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "solvers/not_a_number.hpp"

namespace poise {

RunResiduals residuals_of(const FitProblem& problem, const Fit& fitted, const std::vector<Record>& records,
                          std::size_t run) {
  const Record& record = records[run];
  RunResiduals out;
  for (const Series& series : record.sensors) out.residual.emplace_back(series.value.size(), not_a_number);
  out.prediction = out.residual;
  const Residuals e = problem.residuals(run, fitted.parameters, fitted.runs[run].nuisances, record);
  for (std::size_t k = 0; k < e.size(); ++k) {
    for (std::size_t s = 0; s < e[k].size(); ++s) {
      out.residual[k][s] = -problem.experiment().sensors[k].noise * e[k][s];
      out.prediction[k][s] = record.sensors[k].value[s] - out.residual[k][s];
    }
  }
  return out;
}

double rms_over_noise(const Fit& fitted, const RunFit& run) {
  if (run.rms.empty()) return not_a_number;
  double squares = 0.0;
  int sensors = 0;
  for (std::size_t k = 0; k < run.rms.size(); ++k) {
    if (std::isnan(run.rms[k])) continue;
    squares += std::pow(run.rms[k] / fitted.weighting.noise[k], 2);
    ++sensors;
  }
  return std::sqrt(squares / sensors);
}

std::vector<std::size_t> worst_first(const Fit& fitted) {
  std::vector<std::size_t> order(fitted.runs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto badness = [&](std::size_t r) {
    const double rms = rms_over_noise(fitted, fitted.runs[r]);
    return std::isnan(rms) ? std::numeric_limits<double>::infinity() : rms;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return badness(a) > badness(b); });
  return order;
}

}  // namespace poise

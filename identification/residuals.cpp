#include "identification/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace poise {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

RunResiduals residuals_of(const FitProblem& problem, const Fit& fitted, const std::vector<Record>& records,
                          std::size_t run) {
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  const Record& record = records[run];
  RunResiduals out;
  out.residual.assign(sensors.size(), std::vector<double>(record.time.size(), nan));
  out.prediction = out.residual;
  std::vector<double> e;
  const std::size_t times = record.time.size();
  if (!problem.residuals(run, fitted.parameters, fitted.runs[run].nuisances, record, times, e)) return out;
  for (std::size_t i = 0; i < e.size(); ++i) {
    const std::size_t k = i % sensors.size();
    const std::size_t s = i / sensors.size();
    out.residual[k][s] = -sensors[k].noise * e[i];
    out.prediction[k][s] = record.reading[k][s] - out.residual[k][s];
  }
  return out;
}

double rms_over_noise(const FitProblem& problem, const RunFit& run) {
  if (run.rms.empty()) return nan;
  double squares = 0.0;
  for (std::size_t k = 0; k < run.rms.size(); ++k) {
    squares += std::pow(run.rms[k] / problem.experiment().sensors[k].noise, 2);
  }
  return std::sqrt(squares / static_cast<double>(run.rms.size()));
}

std::vector<std::size_t> worst_first(const FitProblem& problem, const Fit& fitted) {
  std::vector<std::size_t> order(fitted.runs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto badness = [&](std::size_t r) {
    const double rms = rms_over_noise(problem, fitted.runs[r]);
    return std::isnan(rms) ? std::numeric_limits<double>::infinity() : rms;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return badness(a) > badness(b); });
  return order;
}

}  // namespace poise

#include "identification/fit/outliers.hpp"

#include <algorithm>
#include <cmath>

#include "identification/fit/private/robust_scale.hpp"

namespace poise {
namespace {

/// Exceeded by one of 5e8 readings with normal noise.
constexpr double outlying_from = 6.0;
/// Readings on each side that one is compared with: the error of a model changes little over these.
constexpr std::ptrdiff_t neighbours = 5;

/// x_i less the median of its neighbours.
std::vector<double> jumps(const std::vector<double>& x) {
  std::vector<double> out, around;
  const auto count = static_cast<std::ptrdiff_t>(x.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    around.clear();
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - neighbours); j <= std::min(count - 1, i + neighbours);
         ++j) {
      if (j != i) around.push_back(x[static_cast<std::size_t>(j)]);
    }
    double middle = 0.0;
    if (!around.empty()) {
      const auto at = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
      std::nth_element(around.begin(), at, around.end());
      middle = *at;
    }
    out.push_back(x[static_cast<std::size_t>(i)] - middle);
  }
  return out;
}

std::vector<double> as_vector(const auto& values) { return {values.begin(), values.end()}; }

}  // namespace

std::vector<Outlier> outliers(const FitProblem& problem, const std::vector<LinearRun>& runs,
                              const Weighting& weighting) {
  const std::size_t sensors = weighting.noise.size();
  std::vector<std::vector<double>> all(sensors), all_jumps(sensors);
  for (const LinearRun& run : runs) {
    if (run.rows.size() == 0) return {};
    for (std::size_t k = 0; k < sensors; ++k) {
      const std::vector<double> e = as_vector(run.residuals(k));
      const std::vector<double> jump = jumps(e);
      all[k].insert(all[k].end(), e.begin(), e.end());
      all_jumps[k].insert(all_jumps[k].end(), jump.begin(), jump.end());
    }
  }
  std::vector<Outlier> out;
  std::vector<std::size_t> next(sensors, 0);
  std::vector<double> scale, jump_scale;
  for (std::size_t k = 0; k < sensors; ++k) {
    // The median size of a few readings may be small by chance.
    const bool is_stated = problem.experiment().sensors[k].noise_known;
    scale.push_back(is_stated ? std::max(1.0, robust_scale(all[k])) : robust_scale(all[k]));
    jump_scale.push_back(robust_scale(all_jumps[k]));
  }
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (std::size_t k = 0; k < sensors; ++k) {
      for (const double time : problem.run(r).times()[k]) {
        const std::size_t i = next[k]++;
        const double size = std::abs(all[k][i]) / scale[k];
        if (size > outlying_from && std::abs(all_jumps[k][i]) > outlying_from * jump_scale[k]) {
          out.push_back({r, k, time, -weighting.noise[k] * all[k][i], size});
        }
      }
    }
  }
  return out;
}

Record without_outliers(const Record& record) {
  Record out = record;
  for (Series& series : out.sensors) {
    const std::vector<double> jump = jumps(series.value);
    const double limit = outlying_from * robust_scale(jump);
    for (std::size_t i = 0; i < jump.size(); ++i) {
      if (std::abs(jump[i]) > limit) series.value[i] -= jump[i];
    }
  }
  return out;
}

}  // namespace poise

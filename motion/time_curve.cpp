#include "motion/time_curve.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace poise {

TimeCurve TimeCurve::through(std::vector<double> time, const std::vector<double>& value) {
  std::vector<double> coefficients;
  for (std::size_t i = 0; i + 1 < time.size(); ++i) {
    coefficients.push_back(value[i]);
    coefficients.push_back((value[i + 1] - value[i]) / (time[i + 1] - time[i]));
  }
  return {std::move(time), std::move(coefficients)};
}

TimeCurve TimeCurve::along(const solvers::QuinticSpline& spline) {
  std::vector<double> coefficients;
  for (const std::array<double, 6>& piece : spline.pieces) {
    coefficients.insert(coefficients.end(), piece.begin(), piece.end());
  }
  return {spline.breaks, std::move(coefficients)};
}

TimeCurve::TimeCurve(std::vector<double> breaks, std::vector<double> coefficients)
    : breaks_(std::move(breaks)),
      coefficients_(std::move(coefficients)),
      order_(coefficients_.size() / (breaks_.size() - 1)) {}

double TimeCurve::at(double t, int derivative) const {
  const auto after = std::upper_bound(breaks_.begin() + 1, breaks_.end() - 1, t);
  const auto piece = static_cast<std::size_t>(after - breaks_.begin()) - 1;
  const double from = t - breaks_[piece];
  const double* const c = &coefficients_[piece * order_];
  double sum = 0.0;
  for (std::size_t k = order_; k-- > static_cast<std::size_t>(derivative);) {
    double factor = 1.0;
    for (int d = 0; d < derivative; ++d) factor *= static_cast<double>(k) - d;
    sum = sum * from + factor * c[k];
  }
  return sum;
}

}  // namespace poise

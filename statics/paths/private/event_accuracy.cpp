#include "statics/paths/private/event_accuracy.hpp"

#include <algorithm>
#include <cmath>

namespace poise {

KeptEquations kept_equations(const std::vector<solvers::ActiveRow>& active) {
  KeptEquations out;
  for (const solvers::ActiveRow& a : active) {
    out.rows.push_back(a.row);
    out.at_upper.push_back(a.upper ? 1 : 0);
  }
  return out;
}

FirstOrderEffect effect_of(const Eigen::VectorXd& row, const std::vector<Ball>& errors) {
  Ball sum(0.0);
  FirstOrderEffect out;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double factor = row[static_cast<Eigen::Index>(i)];
    sum += Ball(factor) * errors[i];
    out.spread += std::abs(factor) * errors[i].radius();
  }
  out.whole = sum.greatest();
  return out;
}

int decimal_digits(double error, double rounding_effect) {
  const double doubt = std::max({error, rounding_effect, 1e-16});
  return std::clamp(static_cast<int>(std::floor(-std::log10(doubt))), 0, 16);
}

}  // namespace poise

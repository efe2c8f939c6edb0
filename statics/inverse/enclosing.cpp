#include "statics/inverse/enclosing.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

constexpr int most_ball_unknowns = 160;  // whose dense matrices of balls are multiplied in seconds

/// Whether a measure goes through a curve, whose enclosures have no derivatives.
bool has_curves(const Scene& scene) {
  const auto goes_through_curve = [](const auto& item) {
    return std::any_of(item.on.terms.begin(), item.on.terms.end(),
                       [](const Measure::Term& term) { return term.profile != nullptr; });
  };
  return std::any_of(scene.stops.begin(), scene.stops.end(), goes_through_curve) ||
         std::any_of(scene.elements.begin(), scene.elements.end(), goes_through_curve);
}

}  // namespace

std::string why_not_enclosed(const UnknownNumbers& numbers, const Scene& scene, int unknowns) {
  if (!numbers.is_enclosed()) return "what follows from the number is not enclosed: a section, or a load in time";
  if (has_curves(scene)) return "curves of couplings are not enclosed with their derivatives";
  if (unknowns <= most_ball_unknowns) return "";
  return fmt::format("{} unknowns are more than the {} that are enclosed", unknowns, most_ball_unknowns);
}

std::vector<int> independent_columns(const Eigen::MatrixXd& a) {
  const solvers::PivotOrder order = solvers::pivot_order<double>(a, solvers::known_to::solution);
  std::vector<int> out(order.columns.begin(), order.columns.begin() + order.rank);
  std::sort(out.begin(), out.end());
  return out;
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& a) {
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(a.rows(), a.cols());
  Eigen::MatrixXd out(a.rows(), a.cols());
  const solvers::LeastSquares<double> factors(a, solvers::known_to::rounding);
  for (Eigen::Index k = 0; k < a.cols(); ++k) out.col(k) = factors.solve(identity.col(k));
  return out;
}

}  // namespace poise

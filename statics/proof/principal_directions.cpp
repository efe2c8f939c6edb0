#include "statics/proof/principal_directions.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solvers/linear_algebra.hpp"
#include "statics/model/curvature.hpp"

namespace poise {
namespace {

constexpr int most_coordinates_judged = 300;
constexpr Eigen::Index most_directions = 6;

CurvatureDirection direction_of(const StaticModel& model, double curvature, const Eigen::VectorXd& direction) {
  CurvatureDirection out;
  out.curvature = curvature * model.scales().energy();
  std::vector<int> order(direction.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  const double sign = order.empty() || direction[order[0]] >= 0 ? 1.0 : -1.0;
  for (int i : order) {
    if (out.moves.size() == 4 || std::abs(direction[i]) < 0.05 * std::abs(direction[order[0]])) break;
    out.moves.emplace_back(model.layout().coordinates[i].name, sign * direction[i]);
  }
  return out;
}

}  // namespace

std::vector<CurvatureDirection> principal_directions(const StaticModel& model, const Certificate& certificate) {
  const Mechanism<double>& m = model.mechanism();
  if (!certificate.confirmed() || m.has_follower_loads() || m.coordinates() > most_coordinates_judged) return {};
  std::vector<int> rows(m.equalities());
  std::iota(rows.begin(), rows.end(), 0);
  for (const int stop : certificate.active_stops) rows.push_back(m.stop_row(stop));
  const ReducedHessian reduced(m, certificate.x, rows);
  if (reduced.matrix.size() == 0) return {};
  const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(reduced.matrix);
  const Eigen::MatrixXd directions = reduced.basis * eigen.vectors;
  std::vector<CurvatureDirection> out;
  for (Eigen::Index k = 0; k < std::min(most_directions, directions.cols()); ++k) {
    out.push_back(direction_of(model, eigen.values[k], directions.col(k)));
  }
  return out;
}

}  // namespace poise

#include "statics/model/singular_configuration.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "solvers/linear_algebra.hpp"
#include "solvers/newton.hpp"
#include "statics/model/curvature.hpp"

namespace poise {
namespace {

constexpr int most_searched_coordinates = 60;
constexpr double nearly_closed = 1e-7;
constexpr double unbalanced_beyond = 1e-6;  // relative to the largest load
// A search that approaches a singular configuration stops at some distance, because small gaps displace such poses far.
constexpr double singular_rank_tolerance = solvers::known_to::singular_point;
constexpr double beside_singular = 0.1;  // rad or mechanism sizes
constexpr int tries = 8;

std::vector<int> closure_rows(const Mechanism<double>& mechanism) {
  std::vector<int> rows(mechanism.equalities());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

int rank_of(const Eigen::MatrixXd& jacobian) {
  return static_cast<int>(solvers::rank<double>(jacobian.transpose(), singular_rank_tolerance));
}

double largest_gap(const DensePoint<double>& point) {
  double worst = 0.0;
  for (int row : point.kept) worst = std::max(worst, std::abs(point.constraint[row]));
  return worst;
}

// With the rank of the singular configuration: singular values below the tolerance count as zero.
bool balances(const DensePoint<double>& point) {
  const Eigen::MatrixXd directions = point.jacobian.transpose();
  const Eigen::VectorXd left = point.force + directions * solvers::minimum_norm_solution<double>(
                                                              directions, -point.force, singular_rank_tolerance);
  return left.cwiseAbs().maxCoeff() <= unbalanced_beyond * (1.0 + point.force.cwiseAbs().maxCoeff());
}

constexpr int most_search_steps = 30;
constexpr double converged_within = 1e-12;
constexpr double loses_rank_within = 1e-10;  // |J^T u|; where nothing loses rank a rest remains

}  // namespace

std::optional<std::vector<double>> nearest_singular_point(const Mechanism<double>& mechanism,
                                                          const std::vector<double>& x, const std::vector<int>& rows) {
  const auto m = static_cast<Eigen::Index>(rows.size());
  const Eigen::Index n = mechanism.coordinates();
  if (m == 0 || n == 0 || n > most_searched_coordinates) return std::nullopt;
  std::vector<double> q = x;
  // Stops keep the value that they have at x.
  std::vector<double> kept(rows.size(), 0.0);
  const DensePoint<double> first(mechanism, q, rows);
  for (Eigen::Index k = 0; k < m; ++k) {
    if (rows[k] >= mechanism.equalities()) kept[k] = first.constraint[rows[k]];
  }
  Eigen::VectorXd u = solvers::symmetric_eigen(first.jacobian * first.jacobian.transpose()).vectors.col(0);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(m);
  for (int step = 0; step < most_search_steps; ++step) {
    DensePoint<double> point(mechanism, q, rows);
    Eigen::MatrixXd derivative = Eigen::MatrixXd::Zero(m + n + 1, n + m);
    derivative.topLeftCorner(m, n) = point.jacobian;
    derivative.block(m, 0, n, n) = point.tangent(u) - point.tangent(none);
    derivative.block(m, n, n, m) = point.jacobian.transpose();
    derivative.bottomRightCorner(1, m) = 2 * u.transpose();
    Eigen::VectorXd value(m + n + 1);
    for (Eigen::Index k = 0; k < m; ++k) value[k] = point.constraint[rows[k]] - kept[k];
    value.segment(m, n) = point.jacobian.transpose() * u;
    value[m + n] = u.squaredNorm() - 1.0;
    const Eigen::VectorXd change = solvers::minimum_norm_solution<double>(derivative, -value, solvers::known_to::path);
    if (!change.allFinite()) return std::nullopt;
    for (Eigen::Index i = 0; i < n; ++i) q[i] += change[i];
    u += change.tail(m);
    if (change.cwiseAbs().maxCoeff() > converged_within) continue;
    return value.cwiseAbs().maxCoeff() < loses_rank_within ? std::optional(q) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<SingularConfiguration> find_singular_configuration(const StaticModel& model,
                                                                 const std::vector<double>& x) {
  const Mechanism<double>& m = model.mechanism();
  const std::vector<int> rows = closure_rows(m);
  if (rows.empty() || m.coordinates() == 0 || m.coordinates() > most_searched_coordinates) return std::nullopt;
  const DensePoint<double> here(m, x, rows);
  if (largest_gap(here) > nearly_closed || balances(here)) return std::nullopt;
  SingularConfiguration singular;
  singular.rank = rank_of(here.jacobian);
  if (singular.rank == std::min<int>(static_cast<int>(rows.size()), m.coordinates())) return std::nullopt;
  solvers::Newton closing(model.problem());
  std::minstd_rand random(20220531);
  std::uniform_real_distribution<double> uniform(-beside_singular, beside_singular);
  for (int k = 0; k < tries; ++k) {
    std::vector<double> moved = x;
    for (double& v : moved) v += uniform(random);
    const DensePoint<double> there(m, closing.close(moved).x, rows);
    if (largest_gap(there) <= nearly_closed)
      singular.rank_beside = std::max(singular.rank_beside, rank_of(there.jacobian));
  }
  return singular.rank_beside > singular.rank ? std::optional(singular) : std::nullopt;
}

}  // namespace poise

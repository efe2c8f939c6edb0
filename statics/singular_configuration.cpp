#include "statics/singular_configuration.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "solvers/linear_algebra.hpp"
#include "solvers/newton.hpp"
#include "statics/curvature.hpp"

namespace poise {
namespace {

constexpr int most_coordinates = 60;
constexpr double closed_within = 1e-7;
constexpr double unbalanced_beyond = 1e-6;  // relative to the largest load
// A search that approaches a singular configuration stops at some distance, because small gaps displace such poses far.
constexpr double rank_tolerance = solvers::known_to::singular_point;
constexpr double beside = 0.1;  // rad or mechanism sizes
constexpr int tries = 8;

std::vector<int> closure_rows(const Mechanism<double>& mechanism) {
  std::vector<int> rows(mechanism.equalities());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

int rank_of(const Eigen::MatrixXd& jacobian) {
  return static_cast<int>(solvers::rank<double>(jacobian.transpose(), rank_tolerance));
}

double largest_gap(const DensePoint<double>& point) {
  double worst = 0.0;
  for (int row : point.kept) worst = std::max(worst, std::abs(point.constraint[row]));
  return worst;
}

// With the rank of the singular configuration: singular values below the tolerance count as zero.
bool balances(const DensePoint<double>& point) {
  const Eigen::MatrixXd directions = point.jacobian.transpose();
  const Eigen::VectorXd left =
      point.force + directions * solvers::minimum_norm_solution<double>(directions, -point.force, rank_tolerance);
  return left.cwiseAbs().maxCoeff() <= unbalanced_beyond * (1.0 + point.force.cwiseAbs().maxCoeff());
}

}  // namespace

std::optional<SingularConfiguration> find_singular_configuration(const StaticModel& model,
                                                                 const std::vector<double>& x) {
  const Mechanism<double>& m = model.mechanism();
  const std::vector<int> rows = closure_rows(m);
  if (rows.empty() || m.coordinates() > most_coordinates) return std::nullopt;
  const DensePoint<double> here(m, x, rows);
  if (largest_gap(here) > closed_within || balances(here)) return std::nullopt;
  SingularConfiguration singular;
  singular.rank = rank_of(here.jacobian);
  if (singular.rank == std::min<int>(static_cast<int>(rows.size()), m.coordinates())) return std::nullopt;
  solvers::Newton closing(model.problem());
  std::minstd_rand random(20220531);
  std::uniform_real_distribution<double> uniform(-beside, beside);
  for (int k = 0; k < tries; ++k) {
    std::vector<double> moved = x;
    for (double& v : moved) v += uniform(random);
    const DensePoint<double> there(m, closing.close(moved).x, rows);
    if (largest_gap(there) <= closed_within)
      singular.rank_beside = std::max(singular.rank_beside, rank_of(there.jacobian));
  }
  return singular.rank_beside > singular.rank ? std::optional(singular) : std::nullopt;
}

}  // namespace poise

#include "solvers/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/QR>
#include <Eigen/SparseCholesky>

namespace poise::solvers {
namespace {

constexpr int dense_rows = 200;
constexpr double relax = 1e-13;  // keeps J J^T factored where rows repeat each other
constexpr int refinements = 20;
constexpr double locked_beyond = 1e6;
constexpr double left_out_within = 1e-9;
constexpr int releases = 8;  // of one inequality before it counts as cycling

using SparseMatrix = Eigen::SparseMatrix<double>;

// J^T of the rows, one column each.
SparseMatrix transposed_rows(const Problem& problem, const Evaluation& at, const std::vector<int>& rows) {
  std::vector<int> column_of(problem.constraints(), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) column_of[rows[i]] = static_cast<int>(i);
  const Pattern& pattern = problem.jacobian_pattern();
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t e = 0; e < pattern.size(); ++e) {
    const int column = column_of[pattern.row[e]];
    if (column >= 0) entries.emplace_back(pattern.column[e], column, at.jacobian[e]);
  }
  SparseMatrix out(problem.variables(), static_cast<Eigen::Index>(rows.size()));
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// By normal equations, refined until what squaring the condition lost is back.
Eigen::VectorXd sparse_least_squares(const SparseMatrix& a, const Eigen::VectorXd& b) {
  SparseMatrix normal = a.transpose() * a;
  const double scale = 1.0 + normal.diagonal().maxCoeff();
  SparseMatrix identity(normal.rows(), normal.cols());
  identity.setIdentity();
  normal += relax * scale * identity;
  const Eigen::SimplicialLDLT<SparseMatrix> factors(normal);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(a.cols());
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < refinements; ++k) {
    const Eigen::VectorXd slope = a.transpose() * (b - a * x);
    const double left = slope.cwiseAbs().maxCoeff();
    if (!(left < 0.5 * last)) break;
    last = left;
    x += factors.solve(slope);
  }
  return x;
}

}  // namespace

double largest(const std::vector<double>& v) {
  double worst = 0.0;
  for (double e : v) worst = std::isnan(e) ? std::numeric_limits<double>::infinity() : std::max(worst, std::abs(e));
  return worst;
}

void unbalanced(const Problem& problem, const Evaluation& at, const std::vector<double>& y, std::vector<double>& out) {
  out = at.gradient;
  const Pattern& pattern = problem.jacobian_pattern();
  for (std::size_t e = 0; e < pattern.size(); ++e) out[pattern.column[e]] += at.jacobian[e] * y[pattern.row[e]];
}

double force_error(const Problem& problem, const Evaluation& at, const std::vector<double>& y) {
  std::vector<double> left;
  unbalanced(problem, at, y, left);
  return largest(left) / (1.0 + largest(at.gradient));
}

double violation(const Problem& problem, const Evaluation& at, int row) {
  const int inequality = row - problem.equalities();
  const double value = at.constraint[row];
  if (inequality < 0) return value;
  return std::max(0.0, value - problem.upper()[inequality]) + std::min(0.0, value - problem.lower()[inequality]);
}

std::vector<double> least_squares_multipliers(const Problem& problem, const Evaluation& at,
                                              const std::vector<int>& rows) {
  std::vector<double> y(problem.constraints(), 0.0);
  if (rows.empty()) return y;
  const SparseMatrix a = transposed_rows(problem, at, rows);
  const Eigen::VectorXd b = -Eigen::Map<const Eigen::VectorXd>(at.gradient.data(), problem.variables());
  const Eigen::VectorXd solution = static_cast<int>(rows.size()) <= dense_rows
                                       ? Eigen::MatrixXd(a).completeOrthogonalDecomposition().solve(b).eval()
                                       : sparse_least_squares(a, b);
  for (std::size_t i = 0; i < rows.size(); ++i) y[rows[i]] = solution[static_cast<Eigen::Index>(i)];
  return y;
}

HeldRows::HeldRows(const Problem& problem, const std::vector<int>& kept)
    : problem_(problem), kept_(kept), side_(problem.constraints(), 0), releases_(problem.constraints(), 0) {
  if (kept_.empty()) {
    kept_.resize(problem.constraints());
    std::iota(kept_.begin(), kept_.end(), 0);
  }
  std::sort(kept_.begin(), kept_.end());
  held_.reserve(kept_.size());
  for (const int r : kept_) side_[r] = r < problem.equalities() ? 1 : 0;
  list_held();
}

double HeldRows::gap(const Evaluation& at, int row) const {
  const int inequality = row - problem_.equalities();
  if (inequality < 0) return at.constraint[row];
  return at.constraint[row] - (side_[row] > 0 ? problem_.upper()[inequality] : problem_.lower()[inequality]);
}

double HeldRows::largest_gap(const Evaluation& at) const {
  double worst = 0.0;
  for (const int r : kept_) {
    const double left = std::abs(holds(r) ? gap(at, r) : violation(problem_, at, r));
    worst = std::isnan(left) ? std::numeric_limits<double>::infinity() : std::max(worst, left);
  }
  return worst;
}

double HeldRows::largest_left_out(const Evaluation& at) const {
  double worst = 0.0;
  for (int r = 0; r < problem_.constraints(); ++r) {
    if (!std::binary_search(kept_.begin(), kept_.end(), r))
      worst = std::max(worst, std::abs(violation(problem_, at, r)));
  }
  return worst;
}

bool HeldRows::hold_violated(const Evaluation& at, double outside) {
  bool any = false;
  for (const int r : kept_) {
    if (holds(r)) continue;
    const int inequality = r - problem_.equalities();
    const double above = at.constraint[r] - problem_.upper()[inequality];
    const double below = problem_.lower()[inequality] - at.constraint[r];
    if (std::max(above, below) <= outside) continue;
    side_[r] = above > below ? 1 : -1;
    any = true;
  }
  if (any) list_held();
  return any;
}

HeldRows::Pulling HeldRows::release_pulling(const std::vector<double>& y, double least) {
  int worst = -1;
  double strongest = least;
  for (const int r : held_) {
    const int inequality = r - problem_.equalities();
    if (inequality < 0 || problem_.lower()[inequality] == problem_.upper()[inequality]) continue;
    const double pull = -side_[r] * y[r];
    if (pull > strongest) {
      strongest = pull;
      worst = r;
    }
  }
  if (worst < 0) return Pulling::none;
  if (++releases_[worst] > releases) return Pulling::cycling;
  side_[worst] = 0;
  list_held();
  return Pulling::released;
}

void HeldRows::list_held() {
  held_.clear();
  for (const int r : kept_) {
    if (holds(r)) held_.push_back(r);
  }
}

const char* objection(const Evaluation& at, const HeldRows& held, const std::vector<double>& y, double tolerance) {
  if (largest(y) > locked_beyond * (1.0 + largest(at.gradient))) {
    return "the constraints lock: no finite multipliers balance";
  }
  if (held.largest_left_out(at) > std::max(left_out_within, tolerance)) return "rows left out as redundant do not hold";
  return nullptr;
}

}  // namespace poise::solvers

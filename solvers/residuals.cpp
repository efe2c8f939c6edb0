#include "solvers/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/SparseCholesky>

#include "solvers/linear_algebra.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr int dense_residual_rows = 200;
constexpr double row_shift = 1e-13;  // keeps J J^T regular where rows are dependent
constexpr int residual_refinements = 20;
constexpr double singular_beyond = 1e6;
constexpr double left_out_within = 1e-9;

using SparseMatrix = Eigen::SparseMatrix<double>;

// J^T of the rows, one column each.
SparseMatrix transposed_rows(const Problem& problem, const Evaluation& at, const std::vector<int>& rows) {
  std::vector<int> column_of(problem.constraints(), -1);
  for (int i = 0; i < static_cast<int>(rows.size()); ++i) column_of[rows[i]] = i;
  const Pattern& pattern = problem.jacobian_pattern();
  std::vector<Eigen::Triplet<double>> entries;
  for (int e = 0; e < pattern.size(); ++e) {
    const int column = column_of[pattern.row[e]];
    if (column >= 0) entries.emplace_back(pattern.column[e], column, at.jacobian[e]);
  }
  SparseMatrix out(problem.variables(), static_cast<Eigen::Index>(rows.size()));
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// By normal equations, refined iteratively to recover the accuracy that their squared condition costs.
Eigen::VectorXd sparse_least_squares(const SparseMatrix& a, const Eigen::VectorXd& b) {
  SparseMatrix normal = a.transpose() * a;
  const double scale = 1.0 + normal.diagonal().maxCoeff();
  SparseMatrix identity(normal.rows(), normal.cols());
  identity.setIdentity();
  normal += row_shift * scale * identity;
  const Eigen::SimplicialLDLT<SparseMatrix> factors(normal);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(a.cols());
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < residual_refinements; ++k) {
    const Eigen::VectorXd slope = a.transpose() * (b - a * x);
    const double left = slope.cwiseAbs().maxCoeff();
    if (!(left < 0.5 * last)) break;
    last = left;
    x += factors.solve(slope);
  }
  return x;
}

}  // namespace

void unbalanced(const Problem& problem, const Evaluation& at, const std::vector<double>& y, std::vector<double>& out) {
  out = at.gradient;
  const Pattern& pattern = problem.jacobian_pattern();
  for (int e = 0; e < pattern.size(); ++e) out[pattern.column[e]] += at.jacobian[e] * y[pattern.row[e]];
}

double force_error(const Problem& problem, const Evaluation& at, const std::vector<double>& y) {
  std::vector<double> left;
  unbalanced(problem, at, y, left);
  return largest(left) / (1.0 + largest(at.gradient));
}

std::vector<double> least_squares_multipliers(const Problem& problem, const Evaluation& at,
                                              const std::vector<int>& rows) {
  std::vector<double> y(problem.constraints(), 0.0);
  if (rows.empty()) return y;
  const SparseMatrix a = transposed_rows(problem, at, rows);
  const Eigen::VectorXd b = -Eigen::Map<const Eigen::VectorXd>(at.gradient.data(), problem.variables());
  const Eigen::VectorXd solution = static_cast<int>(rows.size()) <= dense_residual_rows
                                       ? minimum_norm_solution(Eigen::MatrixXd(a), b)
                                       : sparse_least_squares(a, b);
  for (int i = 0; i < static_cast<int>(rows.size()); ++i) y[rows[i]] = solution[i];
  return y;
}

const char* objection(const Evaluation& at, const ActiveSet& active, const std::vector<double>& y, double tolerance) {
  if (largest(y) > singular_beyond * (1.0 + largest(at.gradient))) {
    return "the constraints lock: no finite multipliers balance";
  }
  if (active.largest_left_out(at) > std::max(left_out_within, tolerance))
    return "rows left out as redundant do not hold";
  return nullptr;
}

}  // namespace poise::solvers

#include "statics/sparse_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace poise {
namespace {

constexpr double relax = 1e-12;
constexpr int refinements = 20;
constexpr double smallest_singular_value = 1e-6;

// Lower triangle of [I A; A^T corner I].
Eigen::SparseMatrix<double> augmented(const Eigen::SparseMatrix<double>& a, double corner) {
  const int rows = static_cast<int>(a.rows());
  const int size = rows + static_cast<int>(a.cols());
  std::vector<Eigen::Triplet<double>> lower;
  for (int i = 0; i < size; ++i) lower.emplace_back(i, i, i < rows ? 1.0 : corner);
  for (int c = 0; c < a.outerSize(); ++c) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(a, c); it; ++it) {
      lower.emplace_back(rows + c, static_cast<int>(it.row()), it.value());
    }
  }
  Eigen::SparseMatrix<double> system(size, size);
  system.setFromTriplets(lower.begin(), lower.end());
  return system;
}

}  // namespace

SparseLeastSquares::SparseLeastSquares(const Eigen::SparseMatrix<double>& a) : a_(a) {
  factors_.compute(augmented(a, -relax));
}

Eigen::VectorXd SparseLeastSquares::solve(const Eigen::VectorXd& b) const {
  const Eigen::Index rows = a_.rows();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(rows + a_.cols());
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < refinements; ++k) {
    Eigen::VectorXd right(x.size());
    right << b - x.head(rows) - a_ * x.tail(a_.cols()), -(a_.transpose() * x.head(rows));
    const double left = right.cwiseAbs().maxCoeff();
    if (!(left < 0.5 * last)) break;
    last = left;
    x += factors_.solve(right);
  }
  return x.tail(a_.cols());
}

NullSpace null_space(const Eigen::SparseMatrix<double>& a) {
  Eigen::SparseMatrix<double> even = a;
  const auto scales = [](const Eigen::VectorXd& squares) {
    return squares.unaryExpr([](double s) { return s > 0 ? 1.0 / std::sqrt(s) : 1.0; }).eval();
  };
  const auto squares = [&] { return Eigen::SparseMatrix<double>(even.cwiseProduct(even)); };
  even = scales(squares() * Eigen::VectorXd::Ones(a.cols())).asDiagonal() * even;
  even = even * scales(squares().transpose() * Eigen::VectorXd::Ones(a.rows())).asDiagonal();

  // A random vector's projection on the null space has a part in every unknown that the null space touches.
  NullSpace out;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.5, 1.5);
  const Eigen::VectorXd probe = Eigen::VectorXd::NullaryExpr(a.cols(), [&] { return uniform(random); });
  const Eigen::VectorXd unfelt = probe - SparseLeastSquares(even).solve(even * probe);
  for (const double part : unfelt) out.touches.push_back(std::abs(part) > 1e-6);
  if (std::find(out.touches.begin(), out.touches.end(), true) == out.touches.end()) return out;

  // [I A; A^T t I] has m positive eigenvalues and one more for each singular value below sqrt(t).
  const double t = smallest_singular_value * smallest_singular_value;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(augmented(even, t));
  out.dimension = static_cast<int>((factors.vectorD().array() > 0).count() - a.rows());
  return out;
}

}  // namespace poise

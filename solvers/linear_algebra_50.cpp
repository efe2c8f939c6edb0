#include "solvers/linear_algebra_50.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include "solvers/linear_algebra_impl.hpp"

namespace poise::solvers {

using Matrix = DenseMatrix<Real50>;
using Vector = DenseVector<Real50>;
using SparseMatrix50 = Eigen::SparseMatrix<Real50>;

template PivotOrder pivot_order(const Matrix&, double);
template Matrix null_space(const Matrix&, double);
template class LeastSquares<Real50>;
template Vector symmetric_eigenvalues(const Matrix&);

std::optional<Vector> solve(const SparseMatrix50& a, const Vector& b, bool symmetric) {
  if (symmetric) {
    const Eigen::SimplicialLDLT<SparseMatrix50> factors(a);
    if (factors.info() == Eigen::Success) {
      Vector x = factors.solve(b);
      if (x.allFinite()) return x;
    }
  }
  Eigen::SparseLU<SparseMatrix50> factors;
  factors.compute(a);
  if (factors.info() != Eigen::Success) return std::nullopt;
  Vector x = factors.solve(b);
  return x.allFinite() ? std::optional(std::move(x)) : std::nullopt;
}

}  // namespace poise::solvers

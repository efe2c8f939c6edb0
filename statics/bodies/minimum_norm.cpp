#include "statics/bodies/minimum_norm.hpp"

#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

constexpr double takes_part_from = 1e-8;  // component of an orthonormal basis

}  // namespace

struct MinimumNorm::Dense {
  explicit Dense(const Eigen::MatrixXd& a) : factors(a, solvers::known_to::solution) {}
  solvers::LeastSquares<double> factors;
};

MinimumNorm::MinimumNorm(const Eigen::SparseMatrix<double>& a, int dense_limit) : a_(a) {
  if (a.cols() == 0) return;
  if (a.cols() <= dense_limit)
    dense_ = std::make_unique<const Dense>(Eigen::MatrixXd(a));
  else
    sparse_ = std::make_unique<SparseLeastSquares>(a);
}

MinimumNorm::~MinimumNorm() = default;

Eigen::VectorXd MinimumNorm::solve(const Eigen::VectorXd& b) {
  if (sparse_) return sparse_->solve(b);
  if (!dense_) return Eigen::VectorXd::Zero(0);
  const Eigen::VectorXd x = dense_->factors.solve(b);
  // One step of iterative refinement: the balance of bodies is checked to 1e-9 of the largest force.
  return x + dense_->factors.solve(b - a_ * x);
}

TouchedNullSpace MinimumNorm::null_space() {
  if (sparse_) return sparse_->null_space();
  TouchedNullSpace out;
  out.touches.assign(static_cast<std::size_t>(a_.cols()), false);
  if (!dense_) return out;
  out.dimension = static_cast<int>(a_.cols() - dense_->factors.rank());
  if (out.dimension == 0) return out;
  const Eigen::MatrixXd basis = dense_->factors.null_space();
  for (Eigen::Index u = 0; u < a_.cols(); ++u) {
    out.touches[static_cast<std::size_t>(u)] = basis.row(u).norm() > takes_part_from;
  }
  return out;
}

}  // namespace poise

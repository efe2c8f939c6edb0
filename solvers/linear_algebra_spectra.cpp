#include <Eigen/SVD>

#include "solvers/linear_algebra_impl.hpp"

namespace poise::solvers {

using Eigen::MatrixXd;
using Eigen::VectorXd;

template VectorXd symmetric_eigenvalues(const MatrixXd&);

SymmetricEigen symmetric_eigen(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(a);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigenpairs eigenpairs(const MatrixXd& a) {
  const Eigen::EigenSolver<MatrixXd> eigen(a);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::Index SingularValues::rank(double tolerance) const {
  return values.size() > 0 ? (values.array() >= tolerance * values[0] && values.array() > 0.0).count() : 0;
}

SingularValues singular_value_decomposition(const MatrixXd& a) {
  const Eigen::JacobiSVD<MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixU(), svd.matrixV()};
}

VectorXd singular_values(const MatrixXd& a) { return Eigen::BDCSVD<MatrixXd>(a).singularValues(); }

}  // namespace poise::solvers

#include "statics/model/curvature.hpp"

#include "statics/model/private/curvature_impl.hpp"

namespace poise {

template struct DensePoint<double>;

ReducedHessian::ReducedHessian(const Mechanism<double>& mechanism, const std::vector<double>& q,
                               const std::vector<int>& rows) {
  DensePoint<double> point(mechanism, q, rows);
  const Eigen::MatrixXd full = point.tangent(point.multipliers());
  basis = solvers::null_space(point.jacobian, solvers::known_to::solution);
  matrix = basis.transpose() * full * basis;
  largest = full.size() > 0 ? full.cwiseAbs().maxCoeff() : 0.0;
}

}  // namespace poise

#pragma once

#include <optional>

#include <Eigen/Core>

namespace poise::solvers {

/// Solves the linear complementarity problem  w = M z + q,  w >= 0,  z >= 0,  w^T z = 0  by Lemke's method with the
/// covering vector of ones; ties of the ratio test are decided lexicographically, so that it does not cycle. Of a
/// positive semidefinite M it finds a solution wherever z >= 0 with M z + q >= 0 exists. Where M is singular z may be
/// one of many; w is unique where M is symmetric. Where it ends on a ray, as rounding may make it, all choices of which
/// z are zero are tried, of up to 10. None if none of these is a solution.
/// Source: R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, 1992, section 4.4.
std::optional<Eigen::VectorXd> solve_complementarity(const Eigen::MatrixXd& M, const Eigen::VectorXd& q);

}  // namespace poise::solvers

#pragma once

#include <vector>

#include <Eigen/Core>

namespace poise::solvers {

/// x >= 0 of least |A x - b|, by the active set method of Lawson and Hanson ("Solving Least Squares Problems", 1974,
/// chapter 23). Its positive entries belong to linearly independent columns.
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// Which entries are zero in the x >= 0 of least |C x + c| among those with  E x = e,  of which `feasible` >= 0 is one;
/// C has full column rank on the null space N of E. With x = feasible + N t and Q R the factors of C N it is the
/// problem of least distance
///
///   min |y|  subject to  N R^-1 y >= N R^-1 Q^T (C feasible + c) - feasible,
///
/// whose active constraints are the positive entries of a non-negative least-squares solution (Lawson and Hanson,
/// chapter 23, algorithm LDP).
std::vector<bool> zeros_of_least_norm(const Eigen::MatrixXd& e, const Eigen::VectorXd& feasible,
                                      const Eigen::MatrixXd& c_matrix, const Eigen::VectorXd& c);

}  // namespace poise::solvers

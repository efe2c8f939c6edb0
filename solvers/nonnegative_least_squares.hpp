#pragma once

#include <vector>

#include <Eigen/Core>

namespace poise::solvers {

/// x >= 0 of least |A x - b|, by the active set method of Lawson and Hanson ("Solving Least Squares Problems", 1974,
/// chapter 23). Its positive entries belong to linearly independent columns.
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

}  // namespace poise::solvers

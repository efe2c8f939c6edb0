#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Core>

#include "solvers/linear_algebra.hpp"

namespace poise {

/// Left sides of a square system, and their derivatives.
struct LeftSides {
  Eigen::VectorXd value;
  Eigen::MatrixXd by;
};

/// Newton's method with steps of least norm, so that equations that repeat others do not matter, halved while they do
/// not help. Improves u; unknowns for which is_effort(i) are compared with their own size, others with 1, and a step
/// moves those by 1/2 at most. False where it does not converge.
template <class Differentiate, class IsEffort>
bool least_norm_newton(Eigen::VectorXd& u, Differentiate differentiate, IsEffort is_effort) {
  constexpr int most_steps = 40, most_halvings = 8;
  constexpr double converged = 1e-13, near_enough = 1e-9, longest = 0.5;
  double last = std::numeric_limits<double>::infinity();
  LeftSides here = differentiate(u);
  for (int step = 0; step < most_steps; ++step) {
    if (!here.value.allFinite() || !here.by.allFinite()) return false;
    // Rows of one size, so that the rank does not depend on units.
    Eigen::VectorXd weight(here.value.size());
    for (Eigen::Index i = 0; i < weight.size(); ++i) weight[i] = 1.0 / std::max(here.by.row(i).norm(), 1e-300);
    const Eigen::MatrixXd matrix = weight.asDiagonal() * here.by;
    const Eigen::VectorXd right = -(weight.asDiagonal() * here.value);
    const Eigen::VectorXd by = solvers::minimum_norm_solution<double>(matrix, right, solvers::known_to::solution);
    if (!by.allFinite()) return false;
    double length = 0.0, moved = 0.0;
    for (Eigen::Index i = 0; i < by.size(); ++i) {
      const bool effort = is_effort(i);
      length = std::max(length, std::abs(by[i]) / (effort ? std::max(1.0, std::abs(u[i])) : 1.0));
      if (!effort) moved = std::max(moved, std::abs(by[i]));
    }
    double part = moved > longest ? longest / moved : 1.0;
    const double before = right.norm();
    bool is_better = false;
    for (int k = 0; k < most_halvings && !is_better; ++k, part *= 0.5) {
      const Eigen::VectorXd next = u + part * by;
      LeftSides there = differentiate(next);
      const double after = (weight.asDiagonal() * there.value).norm();
      is_better = std::isfinite(after) && (after < before || length < near_enough);
      if (!is_better) continue;
      u = next;
      here = std::move(there);
    }
    if (!is_better) return false;
    if (length < converged || (length < near_enough && length >= 0.5 * last)) return true;
    last = length;
  }
  return false;
}

}  // namespace poise

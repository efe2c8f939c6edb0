#pragma once

#include <array>

namespace poise::benchmarks {

/// Equilibrium of the four-bar datasets/thesis_four_bar.toml (in, lbf, rad) by a Newton written for this one linkage:
/// the yardstick for Poise's virtual work. With the angles t4, t6, t7 of the links, e_k = (cos t_k, sin t_k), lengths
/// l_k, mid-link forces F4 = (-13.29, 0), F6 = (0, 50), F7 = (10, 0) and the pivots A = (0, 0), D = (g, 0):
///
///   closure       l4 e4 + l6 e6 + l7 e7 - (g, 0) = 0                                          2 equations
///   virtual work  N^T Q = 0,  N = (sin(t7 - t6) / l4, sin(t4 - t7) / l6, sin(t6 - t4) / l7)   1 equation
///
/// N is the cross product of the two rows of the closure Jacobian over l4 l6 l7, and Q are the generalized forces with
/// link 7 measured from D:  Q4 = l4 (50 cos t4 + 13.29/2 sin t4), Q6 = l6 50/2 cos t6, Q7 = l7 10/2 sin t7.
struct HandFourBarResult {
  std::array<double, 3> angles{};  ///< links 4, 6, 7, rad
  int iterations = 0;              ///< Newton steps
  bool converged = false;          ///< the last step met max |d| <= 1e-9
};

/// Steps with exact derivatives until max |d| <= 1e-9, that last step still applied; at most 50.
HandFourBarResult solve_four_bar_by_hand(const std::array<double, 3>& start);

}  // namespace poise::benchmarks

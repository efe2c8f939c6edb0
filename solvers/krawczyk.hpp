#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "solvers/ball.hpp"

namespace poise::solvers {

/// A proof that a square system H(u) = 0 has exactly one solution near a point, and where.
struct KrawczykProof {
  bool proved = false;
  /// Some comparison of balls was not decided, so that it is not known which piece of H holds near the point.
  bool undecided = false;
  std::vector<Ball> solution;  ///< an enclosure of the solution
  double reach = 0.0;          ///< no other has all of its unknowns within  reach max(1, |u|)  of it
};

/// H of balls, and with `by` its derivatives, row by row. False where a comparison was not decided.
using BallFunction =
    std::function<bool(const std::vector<Ball>& u, std::vector<Ball>& values, std::vector<std::vector<Ball>>* by)>;

/// With C = `inverse`, near that of the derivatives DH in the middle m of a box U, Krawczyk's operator
///
///   K(U) = m - C H(m) + (I - C DH(U)) (U - m)   inside U
///
/// proves that U has exactly one solution, and that it lies in K(U) (R. E. Moore, R. B. Kearfott, M. J. Cloud,
/// "Introduction to Interval Analysis", 2009, chapter 8). m is `point` after some steps of  m - C H(m); nothing is
/// proved where these lead away from it.
KrawczykProof krawczyk(std::vector<Ball> point, const Eigen::MatrixXd& inverse, const BallFunction& evaluate);

}  // namespace poise::solvers

#pragma once

// Folds at a given load, with one number of the scene unknown.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "solvers/ball.hpp"
#include "statics/inverse/enclosing.hpp"
#include "statics/inverse/least_norm_newton.hpp"
#include "statics/inverse/unknown_numbers.hpp"
#include "statics/quantities/numbered_equations.hpp"

namespace poise {

/// The square system in (z, w, s): an equilibrium whose equations are singular along w, where two equilibria meet,
///
///   R(z, p(s)) = 0,   dR/dz w = 0,   w_k = 1,
///
/// with k the largest component of w at the beginning. It is regular at a fold that moves with the number (solvers/
/// fold_system.hpp). Refers to the numbers, of which one is sought.
class FoldEquations {
 public:
  FoldEquations(const UnknownNumbers& numbers, std::vector<ActingStop> acting);

  struct Point {
    std::vector<double> z, w;
    double s = 0.0;
  };
  /// Newton's method from a fold with bodies at `poses`, three values of each, at the part s. False where it does not
  /// converge.
  bool solve(std::vector<double> poses, double s, Point& out);

  /// That exactly one fold is near, in ball arithmetic, without joints that repeat others.
  SolutionProof prove(const Point& at) const;
  /// To first order, how far s moves where every number of the scene changes by two units in its last place.
  double rounding_effect(const Point& at) const;

 private:
  /// R(z, p) with its derivatives.
  template <class Along>
  std::vector<Along> evaluate(const std::vector<Along>& p, const std::vector<Along>& z) const;
  /// The kept left sides where the kept unknowns are u and the others as given; as solvers::BallFunction.
  bool enclose(const std::vector<double>& given, const std::vector<int>& kept, const std::vector<solvers::Ball>& u,
               std::vector<solvers::Ball>& values, std::vector<std::vector<solvers::Ball>>* by) const;
  LeftSides differentiate(const Point& at) const;
  int unknowns() const { return equations_.unknowns(); }

  const UnknownNumbers* numbers_;
  NumberedEquations equations_;
  int held_ = 0;  // k
};

}  // namespace poise

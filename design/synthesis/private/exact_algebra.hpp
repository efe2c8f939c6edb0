#pragma once

// Linear systems and polynomials whose coefficients are balls, so that what is found of them is proved.

#include <cstddef>
#include <vector>

#include "solvers/ball.hpp"

namespace poise::synthesis {

using solvers::Ball;

/// A matrix by rows.
using BallRows = std::vector<std::vector<Ball>>;

/// A basis of the vectors x with A x = 0, where A has full rank: columns minus rows of them, each a row here. Empty
/// where a pivot may be zero, so that the rank is not proved to be full.
BallRows null_space(BallRows a);

/// Coefficients of 1, x, x^2, ...
using BallPolynomial = std::vector<Ball>;

BallPolynomial operator+(const BallPolynomial& a, const BallPolynomial& b);
BallPolynomial operator-(const BallPolynomial& a, const BallPolynomial& b);
BallPolynomial operator*(const BallPolynomial& a, const BallPolynomial& b);
Ball value_of(const BallPolynomial& p, const Ball& x);

/// The zeros of a real polynomial.
struct PolynomialRoots {
  /// All zeros are simple and lie in circles that do not touch; then `real` has each real one and `others` counts those
  /// that are not.
  bool isolated = false;
  std::vector<Ball> real;  ///< ascending; where they are not isolated: places near those that may be real
  int others = 0;
};

/// All zeros of p, of which the last coefficient is not zero, proved by the circles of B. T. Smith, "Error bounds for
/// zeros of a polynomial based upon Gerschgorin's theorems", J. ACM 17, 1970: the zeros of a polynomial of degree n
/// with the leading coefficient c lie in the circles around any points z_k of radius n |p(z_k) / (c prod (z_k - z_j))|,
/// and one that touches no other contains exactly one. A circle around a real point then has a real one.
PolynomialRoots roots_of(const BallPolynomial& p);

/// A rotation of so many axes that is in no special position to anything: the `attempt`-th.
std::vector<std::vector<double>> generic_rotation(std::size_t size, int attempt);

}  // namespace poise::synthesis

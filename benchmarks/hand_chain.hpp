#pragma once

#include <vector>

namespace poise::benchmarks {

/// Equilibrium of the hanging chain (comparison/series.hpp) by a Newton that costs O(n) per step: the yardstick for
/// Poise on long chains. With link length l, the weight w_i = 1 - (i + 1/2)/n that link i and all after it hang on its
/// far side, and multipliers x, y:
///
///   energy   sum l w_i sin t_i,  closure  sum l cos t_i = span,  sum l sin t_i = 0
///   Hessian  h_i = -l ((w_i + y) sin t_i + x cos t_i),  diagonal
///
/// so a step is the 2 x 2 Schur complement S = J H^-1 J^T and two passes over the links. The first multipliers are
/// those of least squares. All arrays are sized by the constructor.
class HandChain {
 public:
  explicit HandChain(int links);

  /// Steps from `start` until max |d| <= 1e-9, that last step still applied; at most 50. True where that was met.
  bool solve(const std::vector<double>& start);

  const std::vector<double>& angles() const { return angle_; }  ///< rad
  int iterations() const { return iterations_; }

 private:
  void guess_multipliers();
  double step();

  int links_;
  double length_;
  int iterations_ = 0;
  double x_ = 0.0, y_ = 0.0;
  std::vector<double> angle_, cos_, sin_, inverse_;
};

}  // namespace poise::benchmarks

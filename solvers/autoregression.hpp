#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace poise::solvers {

/// A stationary series  x_t = sum_j coefficient_j x_{t-j} + u_t  with white u of variance `innovation` times that of x.
/// White itself without coefficients.
struct Autoregression {
  std::vector<double> coefficient;
  double innovation = 1.0;

  bool is_white() const { return coefficient.empty(); }
  /// Sum over all lags of the squared autocorrelations: a series of n values scatters like n / spread independent ones
  /// where its variance is estimated (Bartlett). 1 for white.
  double spread() const;
  /// sum_{s,t} a_s r(s - t) a_t^T  over the rows a_t of A, with the autocorrelation r.
  Eigen::MatrixXd weighted_square(const Eigen::MatrixXd& a) const;
};

/// Fitted to several pieces of one series by Burg's method, of the order up to `most` that the Bayesian information
/// criterion selects. `taken`: columns b of what a fit took of the series x before,  E[x x^T] - E[pieces] = sum b b^T,
/// cut like the pieces: found is the correlation of x. Source: P. J. Brockwell, R. A. Davis, Time Series: Theory and
/// Methods, ch. 8 and 9.
Autoregression fit_autoregression(std::span<const std::vector<double>> pieces, int most,
                                  std::span<const std::vector<double>> taken = {});

}  // namespace poise::solvers

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

/// What Burg's method takes of the columns b of a matrix, in place of the columns: each of the rows t = 0 ... n - 1.
struct LagProducts {
  Eigen::Index rows = 0;       ///< n
  Eigen::MatrixXd lagged;      ///< l, i: sum_t b_ti b_(t-l)i for the lags l = 0 ... most; 0 from l = n
  Eigen::MatrixXd head, tail;  ///< t, i: b_ti and b_(n-1-t)i for t = 0 ... most - 1; 0 from t = n
};

LagProducts lag_products(const Eigen::MatrixXd& b, int most);

/// Columns b of what a fit took of one piece of a series x before:  E[x x^T] - E[piece] = sum_i weight_i b_i b_i^T.
struct TakenColumns {
  LagProducts products;
  Eigen::VectorXd weight;
};

/// Fitted to several pieces of one series by Burg's method, of the order up to `most` that the Bayesian information
/// criterion selects. `taken`: what is to be added to the pieces, with products of the same `most` or more; found is
/// the correlation of x. The order ends where the rounding of these products is seen: where prediction leaves about
/// 1e-10 of the columns. Source: P. J. Brockwell, R. A. Davis, Time Series: Theory and Methods, ch. 8 and 9; of the
/// products: J. Makhoul, Stable and efficient lattice methods for linear prediction, 1977.
Autoregression fit_autoregression(std::span<const std::vector<double>> pieces, int most,
                                  std::span<const TakenColumns> taken = {});

}  // namespace poise::solvers

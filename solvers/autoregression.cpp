#include "solvers/autoregression.hpp"

#include <algorithm>
#include <cmath>

namespace poise::solvers {
namespace {

constexpr std::size_t most_lags = 200'000;
/// Sums over rows or lags without end stop where what is added is below this part.
constexpr double negligible = 1e-6;
/// Rows that are filtered before they are summed.
constexpr Eigen::Index block = 256;
/// Columns that are filtered together.
constexpr int strip = 8;

}  // namespace

// Levinson's recursion: downwards from the coefficients to those of all lower orders, upwards to the autocorrelations,
// which then follow each other by the coefficients themselves.
double Autoregression::spread() const {
  const std::size_t order = coefficient.size();
  std::vector<std::vector<double>> of_order(order + 1);
  of_order[order] = coefficient;
  for (std::size_t m = order; m > 1; --m) {
    const std::vector<double>& phi = of_order[m];
    const double k = phi[m - 1];
    for (std::size_t j = 0; j + 1 < m; ++j) of_order[m - 1].push_back((phi[j] + k * phi[m - 2 - j]) / (1 - k * k));
  }
  std::vector<double> r{1.0};
  double left = 1.0;  // of the variance
  for (std::size_t m = 1; m <= order; ++m) {
    const double k = of_order[m][m - 1];
    double next = k * left;
    for (std::size_t j = 0; j + 1 < m; ++j) next += of_order[m - 1][j] * r[m - 1 - j];
    r.push_back(next);
    left *= 1 - k * k;
  }
  double sum = 1.0;
  for (std::size_t lag = 1; lag <= order; ++lag) sum += 2 * r[lag] * r[lag];
  double recent = 0.0;
  for (std::size_t lag = order + 1; order > 0 && lag < most_lags; ++lag) {
    double next = 0.0;
    for (std::size_t j = 0; j < order; ++j) next += coefficient[j] * r[lag - 1 - j];
    r.push_back(next);
    sum += 2 * next * next;
    recent = 0.99 * recent + next * next;
    if (recent < negligible * 1e-2) break;
  }
  return sum;
}

// With x = P u, P the lower triangular filter, A^T P P^T A is the square of b = P^T A, which runs backwards in time,
// and on beyond the first row, since the series did not begin there.
Eigen::MatrixXd Autoregression::weighted_square(const Eigen::MatrixXd& a) const {
  const Eigen::Index rows = a.rows();
  const Eigen::Index columns = a.cols();
  const auto order = static_cast<Eigen::Index>(coefficient.size());
  if (order == 0) return a.transpose() * a;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(columns, columns);
  const Eigen::VectorXd backwards =
      Eigen::Map<const Eigen::VectorXd>(coefficient.data(), order).reverse();  // the farthest row first
  // One column for each row of b: the last ones of the block before, then those of a block.
  const Eigen::Index strips = (columns + strip - 1) / strip;
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(strip * strips, order + block);
  for (Eigen::Index begin = 0; begin < 50 * rows; begin += block) {
    for (Eigen::Index i = 0; i < block; ++i) {
      b.col(order + i).setZero();
      if (begin + i < rows) b.col(order + i).head(columns) = a.row(rows - 1 - begin - i).transpose();
      for (Eigen::Index k = 0; k < strips; ++k) {
        Eigen::Matrix<double, strip, 1> sum_of_strip = b.block<strip, 1>(strip * k, order + i);
        for (Eigen::Index j = 0; j < order; ++j) sum_of_strip += backwards[j] * b.block<strip, 1>(strip * k, i + j);
        b.block<strip, 1>(strip * k, order + i) = sum_of_strip;
      }
    }
    const auto present = b.topRightCorner(columns, block);
    sum.selfadjointView<Eigen::Lower>().rankUpdate(present);
    if (begin >= rows && present.squaredNorm() < negligible * sum.trace()) break;
    b.leftCols(order) = b.rightCols(order).eval();
  }
  sum.triangularView<Eigen::StrictlyUpper>() = sum.transpose();
  return innovation * sum;
}

Autoregression fit_autoregression(std::span<const std::vector<double>> pieces, int most,
                                  std::span<const std::vector<double>> taken) {
  // Of the present order m: errors of the forward prediction of x_t at t, of the backward prediction of x_{t-m} at t -
  // m.
  std::vector<Eigen::VectorXd> forward, backward;
  double total = 0.0;
  std::size_t count = 0;
  std::size_t longest = 0;
  for (const std::vector<double>& piece : pieces) {
    if (piece.size() < 4) continue;
    forward.emplace_back(Eigen::Map<const Eigen::VectorXd>(piece.data(), static_cast<Eigen::Index>(piece.size())));
    backward.push_back(forward.back());
    total += forward.back().squaredNorm();
    count += piece.size();
    longest = std::max(longest, piece.size());
  }
  for (const std::vector<double>& piece : taken) {
    if (piece.size() < 4) continue;
    forward.emplace_back(Eigen::Map<const Eigen::VectorXd>(piece.data(), static_cast<Eigen::Index>(piece.size())));
    backward.push_back(forward.back());
  }
  Autoregression best;
  if (count == 0 || !(total > 0)) return best;
  const double n = static_cast<double>(count);
  std::vector<double> phi;
  double part = 1.0;
  double least = 0.0;  // of the criterion; 0 for white
  const int limit = std::min(most, static_cast<int>(longest / 4));
  for (int order = 1; order <= limit; ++order) {
    double product = 0.0;
    double squares = 0.0;
    for (std::size_t p = 0; p < forward.size(); ++p) {
      const Eigen::Index both = std::max<Eigen::Index>(forward[p].size() - order, 0);
      const auto f = forward[p].tail(both);
      const auto b = backward[p].head(both);
      product += f.dot(b);
      squares += f.squaredNorm() + b.squaredNorm();
    }
    if (!(squares > 0)) break;
    const double k = 2 * product / squares;
    std::vector<double> next(phi);
    next.push_back(k);
    for (std::size_t j = 0; j < phi.size(); ++j) next[j] -= k * phi[phi.size() - 1 - j];
    phi = std::move(next);
    part *= 1 - k * k;
    if (!(part > 0)) break;
    for (std::size_t p = 0; p < forward.size(); ++p) {
      const Eigen::Index both = std::max<Eigen::Index>(forward[p].size() - order, 0);
      auto f = forward[p].tail(both);
      auto b = backward[p].head(both);
      const Eigen::VectorXd before = f;
      f -= k * b;
      b -= k * before;
    }
    const double criterion = n * std::log(part) + order * std::log(n);
    if (criterion < least) {
      least = criterion;
      best = {phi, part};
    }
  }
  return best;
}

}  // namespace poise::solvers

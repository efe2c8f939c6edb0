#include "solvers/autoregression.hpp"

#include <algorithm>
#include <cmath>

namespace poise::solvers {
namespace {

constexpr std::size_t most_lags = 200'000;
/// Sums over lags without end stop where what is added is below this part.
constexpr double negligible = 1e-8;
/// Rows that are filtered before they are summed.
constexpr Eigen::Index block_size = 256;
/// Columns that are filtered together.
constexpr int strip = 8;
/// Parts of sums of products that are lost in rounding do not count below this part of them.
constexpr double sum_rounding = 1e-12;

/// Sums of products of neighbours in columns x of at least `rows` rows n, x_t of weight w:
///   sum_w sum_(t=m)^(n-1) x_(t-i) x_(t-j) = lagged(j - i) - head(m - 1 - i, m - 1 - j) - tail(i - 1, j - 1),
/// all t less those before m and those from n, with the sums along diagonals
///   head(a, b) = sum_w sum_(q>=0) x_(a-q) x_(b-q),  tail the same of the columns backwards in time.
class NeighbourProducts {
 public:
  NeighbourProducts(Eigen::Index rows, Eigen::Index most)
      : rows_(rows),
        lagged_(Eigen::VectorXd::Zero(most + 1)),
        head_(Eigen::MatrixXd::Zero(most, most)),
        tail_(Eigen::MatrixXd::Zero(most, most)) {}

  Eigen::Index rows() const { return rows_; }
  double squares() const { return lagged_[0]; }

  void add(const TakenColumns& columns) {
    const Eigen::Index most = head_.rows();
    const auto add_diagonals = [&](const Eigen::MatrixXd& x, Eigen::MatrixXd& sum) {
      Eigen::MatrixXd product = x.topRows(most) * columns.weight.asDiagonal() * x.topRows(most).transpose();
      for (Eigen::Index a = 1; a < most; ++a) {
        product.row(a).tail(most - 1) += product.row(a - 1).head(most - 1).eval();
      }
      sum += product;
    };
    lagged_ += columns.products.lagged.topRows(most + 1) * columns.weight;
    add_diagonals(columns.products.head, head_);
    add_diagonals(columns.products.tail, tail_);
  }

  double operator()(Eigen::Index order, Eigen::Index i, Eigen::Index j) const {
    double sum = lagged_[std::abs(i - j)];
    if (i < order && j < order) sum -= head_(order - 1 - i, order - 1 - j);
    if (i > 0 && j > 0) sum -= tail_(i - 1, j - 1);
    return sum;
  }

 private:
  Eigen::Index rows_;
  Eigen::VectorXd lagged_;
  Eigen::MatrixXd head_, tail_;
};

/// The autocorrelations to the lag of the order, by Levinson's recursion: downwards from the coefficients to those of
/// all lower orders, upwards to the autocorrelations, which then follow each other by the coefficients themselves.
std::vector<double> first_correlations(const std::vector<double>& coefficient) {
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
  return r;
}

/// One for all columns of more than `most` rows, which every order has all sums of, and one for each length below.
std::vector<NeighbourProducts> neighbour_products(std::span<const TakenColumns> taken, Eigen::Index most) {
  std::vector<NeighbourProducts> out;
  for (const TakenColumns& columns : taken) {
    const Eigen::Index rows = std::min(columns.products.rows, most + 1);
    auto same = std::find_if(out.begin(), out.end(), [&](const auto& sums) { return sums.rows() == rows; });
    if (same == out.end()) same = out.emplace(out.end(), rows, most);
    same->add(columns);
  }
  return out;
}

}  // namespace

double Autoregression::spread() const {
  const std::size_t order = coefficient.size();
  std::vector<double> r = first_correlations(coefficient);
  double sum = 1.0;
  for (std::size_t lag = 1; lag <= order; ++lag) sum += 2 * r[lag] * r[lag];
  double recent = 0.0;
  for (std::size_t lag = order + 1; order > 0 && lag < most_lags; ++lag) {
    double next = 0.0;
    for (std::size_t j = 0; j < order; ++j) next += coefficient[j] * r[lag - 1 - j];
    r.push_back(next);
    sum += 2 * next * next;
    recent = 0.99 * recent + next * next;
    if (recent < negligible) break;
  }
  return sum;
}

// By  sum_t a_t x_t = sum_(t>=p) b_t u_t + sum_(t<p) s_t x_t:  backwards in time, each row a_t with what later rows
// leave it, b_t = a_t + sum_j coefficient_j b_(t+j), until the p values of x that the series begins with, which have
// the autocorrelation of x; s_t is the same sum there, over t + j >= p.
Eigen::MatrixXd Autoregression::weighted_square(const Eigen::MatrixXd& a) const {
  const Eigen::Index rows = a.rows();
  const Eigen::Index columns = a.cols();
  const auto order = static_cast<Eigen::Index>(coefficient.size());
  if (order == 0) return a.transpose() * a;
  const Eigen::Index first = std::min(order, rows);
  Eigen::MatrixXd s(columns, first);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(columns, columns);
  const Eigen::VectorXd backwards =
      Eigen::Map<const Eigen::VectorXd>(coefficient.data(), order).reverse();  // the farthest row first
  // One column for each row of b: the last ones of the block before, then those of a block; 0 for t < p.
  const Eigen::Index strips = (columns + strip - 1) / strip;
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(strip * strips, order + block_size);
  for (Eigen::Index begin = 0; begin < rows; begin += block_size) {
    const Eigen::Index present = std::min(block_size, rows - begin);
    for (Eigen::Index i = 0; i < present; ++i) {
      const Eigen::Index t = rows - 1 - begin - i;
      b.col(order + i).setZero();
      b.col(order + i).head(columns) = a.row(t).transpose();
      for (Eigen::Index k = 0; k < strips; ++k) {
        Eigen::Matrix<double, strip, 1> sum_of_strip = b.block<strip, 1>(strip * k, order + i);
        for (Eigen::Index j = 0; j < order; ++j) sum_of_strip += backwards[j] * b.block<strip, 1>(strip * k, i + j);
        b.block<strip, 1>(strip * k, order + i) = sum_of_strip;
      }
      if (t < first) {
        s.col(t) = b.col(order + i).head(columns);
        b.col(order + i).setZero();
      }
    }
    sum.selfadjointView<Eigen::Lower>().rankUpdate(b.block(0, order, columns, present));
    b.leftCols(order) = b.rightCols(order).eval();
  }
  sum.triangularView<Eigen::StrictlyUpper>() = sum.transpose();
  const std::vector<double> r = first_correlations(coefficient);
  const Eigen::MatrixXd correlation = Eigen::MatrixXd::NullaryExpr(
      first, first, [&](Eigen::Index i, Eigen::Index j) { return r[static_cast<std::size_t>(std::abs(i - j))]; });
  return innovation * sum + s * correlation * s.transpose();
}

LagProducts lag_products(const Eigen::MatrixXd& b, int most) {
  const Eigen::Index rows = b.rows();
  LagProducts out;
  out.rows = rows;
  out.lagged = Eigen::MatrixXd::Zero(most + 1, b.cols());
  for (Eigen::Index i = 0; i < b.cols(); ++i) {
    for (Eigen::Index lag = 0; lag <= most && lag < rows; ++lag) {
      out.lagged(lag, i) = b.col(i).tail(rows - lag).dot(b.col(i).head(rows - lag));
    }
  }
  const Eigen::Index ends = std::min<Eigen::Index>(most, rows);
  out.head = out.tail = Eigen::MatrixXd::Zero(most, b.cols());
  out.head.topRows(ends) = b.topRows(ends);
  out.tail.topRows(ends) = b.bottomRows(ends).colwise().reverse();
  return out;
}

Autoregression fit_autoregression(std::span<const std::vector<double>> pieces, int most,
                                  std::span<const TakenColumns> taken) {
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
  Autoregression best;
  if (count == 0 || !(total > 0)) return best;
  const double n = static_cast<double>(count);
  const int limit = std::min(most, static_cast<int>(longest / 4));
  const std::vector<NeighbourProducts> sums = neighbour_products(taken, limit);
  std::vector<double> phi;
  double part = 1.0;
  double least = 0.0;  // of the criterion; 0 for white
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
    // The errors of prediction in the columns that were taken, of x_t and x_{t-m}:  sum_i filter_i x_{t-i},  sum_i
    // filter_i x_{t-m+i}.
    Eigen::VectorXd filter(order);
    filter[0] = 1.0;
    for (int i = 1; i < order; ++i) filter[i] = -phi[static_cast<std::size_t>(i - 1)];
    double rounded = 0.0;
    for (const NeighbourProducts& sum : sums) {
      if (sum.rows() < 4 || sum.rows() <= order) continue;
      for (int i = 0; i < order; ++i) {
        for (int j = 0; j < order; ++j) {
          const double both = filter[i] * filter[j];
          product += both * sum(order, i, order - j);
          squares += both * (sum(order, i, j) + sum(order, order - i, order - j));
        }
      }
      rounded += sum_rounding * sum.squares() * std::pow(filter.lpNorm<1>(), 2);
    }
    if (!(squares > rounded)) break;
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

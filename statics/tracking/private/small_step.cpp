#include "statics/tracking/private/small_step.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <Eigen/LU>

#include "statics/model/curvature.hpp"
#include "statics/paths/path_piece.hpp"
#include "statics/tracking/private/proved_segment.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_dense_coordinates = 200;  // of dense factors
constexpr double longest = 0.2;              // of a step, rad or mechanism sizes
constexpr double start_in_balance = 1e-7;    // of the start, in its largest force
constexpr double closed_start = 1e-8;        // of the start
constexpr double converged_step = 1e-12;
constexpr double largest_rounding = 1e-8;  // larger steps are none of rounding
constexpr int most_iterations = 8;

double largest_of(const VectorXd& v) { return v.size() == 0 ? 0.0 : v.cwiseAbs().maxCoeff(); }

class SmallStep {
 public:
  SmallStep(const StaticModel& from, const std::vector<double>& x, const std::vector<int>& active,
            const StaticModel& to)
      : from_(from), to_(to), x_(x), n_(static_cast<Index>(x.size())) {
    const Mechanism<double>&a = from.mechanism(), &b = to.mechanism();
    const bool alike = a.coordinates() == b.coordinates() && a.equalities() == b.equalities() &&
                       a.stops() == b.stops() && a.jacobian_row() == b.jacobian_row() &&
                       a.jacobian_column() == b.jacobian_column() && a.tangent_row() == b.tangent_row() &&
                       a.tangent_column() == b.tangent_column() && from.scales().length == to.scales().length &&
                       from.scales().force == to.scales().force;
    if (!alike || n_ != a.coordinates() || n_ > most_dense_coordinates) return;
    side_ = piece_at(from, x, active).side;
    rows_ = independent_closures(a, x);
    for (int s = 0; s < a.stops(); ++s) {
      if (side_[static_cast<std::size_t>(s)] != 0) rows_.push_back(a.stop_row(s));
    }
    is_possible_ = static_cast<Index>(rows_.size()) <= n_;
  }

  std::optional<std::vector<double>> run() {
    if (!is_possible_) return std::nullopt;
    DensePoint<double> begin(from_.mechanism(), x_, rows_);
    VectorXd y = begin.multipliers();
    const VectorXd left = begin.force + begin.jacobian.transpose() * y;
    const double heaviest = std::max({1e-3, largest_of(begin.force), largest_of(y)});
    if (largest_of(left) > start_in_balance * heaviest) return std::nullopt;
    if (largest_of(gaps(from_.mechanism(), begin)) > closed_start) return std::nullopt;
    const VectorXd first = y;
    const MatrixXd equations = begin.equations(y);
    std::vector<double> x = x_;
    double last = longest;
    for (int i = 0; i < most_iterations; ++i) {
      DensePoint<double> here(to_.mechanism(), x, rows_);
      const MatrixXd k = here.equations(y);
      VectorXd right(k.rows());
      right.head(n_) = -here.force;
      right.tail(y.size()) = -gaps(to_.mechanism(), here);
      const VectorXd step = Eigen::PartialPivLU<MatrixXd>(k).solve(right);
      if (!step.allFinite()) return std::nullopt;
      y = step.tail(y.size());
      const double size = largest_of(step.head(n_));
      // Next to a singular pose rounding ends it earlier; the proof bounds what is left.
      const bool is_last = size <= converged_step || (size > last && size < largest_rounding);
      if (size > last && !is_last) return std::nullopt;
      for (Index j = 0; j < n_; ++j) x[static_cast<std::size_t>(j)] += step[j];
      last = 0.5 * size;
      if (!is_last) continue;
      const MatrixXd middle = 0.5 * (equations + k);
      const bool is_proved = is_closed(x) && segment_is_proved({from_, x_, first}, {to_, x, y}, rows_, side_, middle);
      return is_proved ? std::optional(x) : std::nullopt;
    }
    return std::nullopt;
  }

 private:
  // Of the rows kept.
  VectorXd gaps(const Mechanism<double>& m, const DensePoint<double>& point) const {
    VectorXd out(static_cast<Index>(rows_.size()));
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      double bound = 0.0;
      if (rows_[k] >= m.equalities()) {
        const int s = rows_[k] - m.equalities();
        bound = side_[static_cast<std::size_t>(s)] < 0 ? m.lower()[s] : m.upper()[s];
      }
      out[static_cast<Index>(k)] = point.constraint[static_cast<std::size_t>(rows_[k])] - bound;
    }
    return out;
  }

  // Closures that repeated others still do.
  bool is_closed(const std::vector<double>& x) const {
    const Mechanism<double>& m = to_.mechanism();
    const DensePoint<double> end(m, x, rows_);
    return std::none_of(end.constraint.begin(), end.constraint.begin() + m.equalities(),
                        [](double gap) { return std::abs(gap) > closed_start; });
  }

  const StaticModel& from_;
  const StaticModel& to_;
  const std::vector<double>& x_;
  const Index n_;
  bool is_possible_ = false;
  std::vector<signed char> side_;
  std::vector<int> rows_;
};

}  // namespace

std::optional<std::vector<double>> followed_in_one_step(const StaticModel& from, const std::vector<double>& x,
                                                        const std::vector<int>& active_stops, const StaticModel& to) {
  return SmallStep(from, x, active_stops, to).run();
}

}  // namespace poise

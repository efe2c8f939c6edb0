#include "statics/small_step.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <Eigen/LU>

#include "statics/body_measures.hpp"
#include "statics/curvature.hpp"
#include "statics/path_piece.hpp"
#include "statics/readings.hpp"
#include "statics/varied_mechanism.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_coordinates = 200;   // of dense factors
constexpr double longest = 0.2;         // of a step, rad or mechanism sizes
constexpr double largest_change = 0.5;  // of the equations
constexpr double room = 0.3;            // to a limit, in what the distance from it changes
constexpr double least_room = 1e-9;     // the same, rad or mechanism sizes, or the model's unit of force
constexpr double in_balance = 1e-7;     // of the start, in its largest force
constexpr double closed = 1e-8;         // of the start
constexpr double converged = 1e-12;
constexpr int most_iterations = 7;

double largest_of(const VectorXd& v) { return v.size() == 0 ? 0.0 : v.cwiseAbs().maxCoeff(); }

// Row sums.
double norm_of(const MatrixXd& m) { return m.size() == 0 ? 0.0 : m.cwiseAbs().rowwise().sum().maxCoeff(); }

class SmallStep {
 public:
  SmallStep(const StaticModel& from, const std::vector<double>& x, const std::vector<int>& active,
            const StaticModel& to)
      : from_(from), to_(to), x_(x), n_(static_cast<Index>(x.size())) {
    const Mechanism<double>&a = from.mechanism(), &b = to.mechanism();
    const bool alike = a.coordinates() == b.coordinates() && a.equalities() == b.equalities() &&
                       a.stops() == b.stops() && from.scales().length == to.scales().length &&
                       from.scales().force == to.scales().force;
    if (!alike || n_ != a.coordinates() || n_ > most_coordinates) return;
    side_ = piece_at(from, x, active).side;
    rows_ = independent_closures(a, x);
    closures_ = static_cast<Index>(rows_.size());
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
    if (largest_of(left) > in_balance * heaviest) return std::nullopt;
    if (largest_of(gaps(from_.mechanism(), begin)) > closed) return std::nullopt;
    const VectorXd before = margins(from_, x_, begin, y);
    const MatrixXd equations = equations_at(begin, y);
    const Eigen::PartialPivLU<MatrixXd> factors(equations);
    std::vector<double> x = x_;
    double last = longest;
    for (int i = 0; i < most_iterations; ++i) {
      DensePoint<double> here(to_.mechanism(), x, rows_);
      const MatrixXd k = equations_at(here, y);
      VectorXd right(k.rows());
      right.head(n_) = -here.force;
      right.tail(y.size()) = -gaps(to_.mechanism(), here);
      const VectorXd step = Eigen::PartialPivLU<MatrixXd>(k).solve(right);
      if (!step.allFinite()) return std::nullopt;
      y = step.tail(y.size());
      const double size = largest_of(step.head(n_));
      if (size > std::max(last, converged)) return std::nullopt;
      for (Index j = 0; j < n_; ++j) x[static_cast<std::size_t>(j)] += step[j];
      last = 0.5 * size;
      if (size > converged) continue;
      if (!is_near(factors, equations, before, x, y)) return std::nullopt;
      return x;
    }
    return std::nullopt;
  }

 private:
  MatrixXd equations_at(DensePoint<double>& point, const VectorXd& y) const {
    const Index k = y.size();
    MatrixXd out = MatrixXd::Zero(n_ + k, n_ + k);
    out.topLeftCorner(n_, n_) = point.tangent(y);
    out.topRightCorner(n_, k) = point.jacobian.transpose();
    out.bottomLeftCorner(k, n_) = point.jacobian;
    return out;
  }

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

  // What must not vanish on the way.
  VectorXd margins(const StaticModel& model, const std::vector<double>& x, const DensePoint<double>& point,
                   const VectorXd& y) const {
    const Mechanism<double>& m = model.mechanism();
    std::vector<double> out;
    Index push = closures_;
    for (int s = 0; s < m.stops(); ++s) {
      const signed char side = side_[static_cast<std::size_t>(s)];
      const double value = point.constraint[static_cast<std::size_t>(m.stop_row(s))];
      if (side == 0) {
        if (std::isfinite(m.lower()[s])) out.push_back(value - m.lower()[s]);
        if (std::isfinite(m.upper()[s])) out.push_back(m.upper()[s] - value);
        continue;
      }
      if (m.lower()[s] != m.upper()[s]) out.push_back(side * y[push]);
      ++push;
    }
    const std::vector<int> one_way = VariedMechanism::one_way_springs(model.scene());
    if (!one_way.empty()) {
      const std::vector<BodyPose<double>> poses = model.poses(x);
      for (const int e : one_way) {
        const Element& element = model.scene().elements[static_cast<std::size_t>(e)];
        const double free_length = std::get<LinearSpring>(element.law).free_length;
        const double scale = element.on.is_angle() ? 1.0 : model.scales().length;
        out.push_back((value_of(model.scene(), element.on, poses) - free_length) / scale);
      }
    }
    return VectorXd::Map(out.data(), static_cast<Index>(out.size()));
  }

  bool is_near(const Eigen::PartialPivLU<MatrixXd>& factors, const MatrixXd& equations, const VectorXd& before,
               const std::vector<double>& x, const VectorXd& y) const {
    DensePoint<double> end(to_.mechanism(), x, rows_);
    for (int r = 0; r < to_.mechanism().equalities(); ++r) {
      if (std::abs(end.constraint[static_cast<std::size_t>(r)]) > closed) return false;  // repeats others no longer
    }
    const VectorXd after = margins(to_, x, end, y);
    for (Index i = 0; i < after.size(); ++i) {
      if (before[i] * after[i] <= 0.0) return false;
      const double least = std::min(std::abs(before[i]), std::abs(after[i]));
      if (least < least_room || least < room * std::abs(after[i] - before[i])) return false;
    }
    // A bound on the spectral radius that does not depend on the unit of y.
    const MatrixXd change = factors.solve(equations_at(end, y) - equations);
    if (!change.allFinite()) return false;
    const Index k = y.size();
    const double xx = norm_of(change.topLeftCorner(n_, n_)), yy = norm_of(change.bottomRightCorner(k, k));
    const double xy = norm_of(change.topRightCorner(n_, k)), yx = norm_of(change.bottomLeftCorner(k, n_));
    const double bound = 0.5 * (xx + yy) + std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy * yx);
    return bound < largest_change;
  }

  const StaticModel& from_;
  const StaticModel& to_;
  const std::vector<double>& x_;
  const Index n_;
  bool is_possible_ = false;
  std::vector<signed char> side_;
  std::vector<int> rows_;
  Index closures_ = 0;
};

}  // namespace

std::optional<std::vector<double>> followed_in_one_step(const StaticModel& from, const std::vector<double>& x,
                                                        const std::vector<int>& active_stops, const StaticModel& to) {
  return SmallStep(from, x, active_stops, to).run();
}

}  // namespace poise

#include "design/synthesis/path_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

namespace poise {
namespace {

constexpr double first_damping = 1e-3;
constexpr double small_step = 1e-9;
constexpr int slow_steps = 12;
constexpr double slow_fall = 0.03;

// The residuals and derivatives at a place, and the steps from there.
class Linearised {
 public:
  explicit Linearised(const PointSquares& problem)
      : problem_(&problem),
        residuals_(Eigen::VectorXd::Zero(rows())),
        by_shared_(rows(), problem.shared()),
        by_own_(Eigen::VectorXd::Zero(rows())),
        own_scale_(Eigen::VectorXd::Zero(problem.points())),
        shared_scale_(Eigen::VectorXd::Zero(problem.shared())) {
    by_shared_.setZero();
  }

  /// S there; infinite where it is not defined.
  double evaluate(const std::vector<double>& x, const std::vector<double>& t) {
    const std::size_t m = problem_->rows(), n = problem_->shared();
    for (int i = 0; i < problem_->points(); ++i) {
      const std::size_t row = i * m;
      if (!problem_->evaluate(i, x, t[i], {residuals_.data() + row, m}, {by_shared_.data() + row * n, m * n},
                              {by_own_.data() + row, m})) {
        return std::numeric_limits<double>::infinity();
      }
    }
    const std::size_t row = problem_->points() * m, more = problem_->more_rows();
    if (!problem_->evaluate_more(x, {residuals_.data() + row, more}, {by_shared_.data() + row * n, more * n})) {
      return std::numeric_limits<double>::infinity();
    }
    const double sum = residuals_.squaredNorm();
    return std::isfinite(sum) && by_shared_.allFinite() && by_own_.allFinite()
               ? sum
               : std::numeric_limits<double>::infinity();
  }

  /// The damping is measured in the largest norm of each column so far, those of `before` among them.
  void rescale(const Linearised& before) {
    shared_scale_ = before.shared_scale_;
    own_scale_ = before.own_scale_;
    const int m = problem_->rows();
    for (int j = 0; j < problem_->shared(); ++j) {
      shared_scale_[j] = std::max(shared_scale_[j], by_shared_.col(j).norm());
    }
    for (int i = 0; i < problem_->points(); ++i) {
      own_scale_[i] = std::max(own_scale_[i], by_own_.segment(i * m, m).norm());
    }
  }

  /// The step that minimises |r + J d|^2 + damping |D d|^2. Returns the fall of S that this promises.
  double step(double damping, std::vector<double>& dx, std::vector<double>& dt) const {
    const int m = problem_->rows(), n = problem_->shared(), points = problem_->points();
    const int more = problem_->more_rows();
    const double root = std::sqrt(damping);
    Eigen::MatrixXd left(points * m + more + n, n);
    Eigen::VectorXd right(left.rows());
    // The elimination of a point's own unknown leaves one row for it: scale, by shared, right side.
    Eigen::MatrixXd kept(points, n + 2);
    Eigen::MatrixXd block(m + 1, n + 1);
    Eigen::VectorXd pivot(m + 1);
    for (int i = 0; i < points; ++i) {
      block.topLeftCorner(m, n) = by_shared_.middleRows(i * m, m);
      block.topRightCorner(m, 1) = -residuals_.segment(i * m, m);
      kept.row(i).setZero();
      if (!problem_->own(i)) {
        left.middleRows(i * m, m) = block.topLeftCorner(m, n);
        right.segment(i * m, m) = block.topRightCorner(m, 1);
        continue;
      }
      block.row(m).setZero();
      pivot.head(m) = by_own_.segment(i * m, m);
      pivot[m] = root * (own_scale_[i] > 0.0 ? own_scale_[i] : 1.0);
      const double length = pivot.norm();
      const double sign = pivot[0] < 0.0 ? -1.0 : 1.0;
      pivot[0] += sign * length;
      const double square = pivot.squaredNorm();
      block -= (2.0 / square) * pivot * (pivot.transpose() * block).eval();
      kept(i, 0) = -sign * length;
      kept.row(i).tail(n + 1) = block.row(0);
      left.middleRows(i * m, m) = block.bottomLeftCorner(m, n);
      right.segment(i * m, m) = block.bottomRightCorner(m, 1);
    }
    left.middleRows(points * m, more) = by_shared_.bottomRows(more);
    right.segment(points * m, more) = -residuals_.tail(more);
    left.bottomRows(n).setZero();
    right.tail(n).setZero();
    for (int j = 0; j < n; ++j) {
      left(points * m + more + j, j) = root * (shared_scale_[j] > 0.0 ? shared_scale_[j] : 1.0);
    }
    const Eigen::VectorXd d = left.householderQr().solve(right);
    for (int j = 0; j < n; ++j) dx[j] = shared_scale_[j] > 0.0 ? d[j] : 0.0;
    Eigen::VectorXd after = residuals_ + by_shared_ * d;
    for (int i = 0; i < points; ++i) {
      dt[i] = problem_->own(i) ? (kept(i, n + 1) - kept.row(i).segment(1, n).dot(d)) / kept(i, 0) : 0.0;
      after.segment(i * m, m) += dt[i] * by_own_.segment(i * m, m);
    }
    return residuals_.squaredNorm() - after.squaredNorm();
  }

 private:
  int rows() const { return problem_->points() * problem_->rows() + problem_->more_rows(); }

  const PointSquares* problem_;
  Eigen::VectorXd residuals_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by_shared_;
  Eigen::VectorXd by_own_, own_scale_, shared_scale_;
};

double largest_share(const std::vector<double>& step, const std::vector<double>& of) {
  double out = 0.0;
  for (std::size_t i = 0; i < step.size(); ++i) out = std::max(out, std::abs(step[i]) / (1.0 + std::abs(of[i])));
  return out;
}

}  // namespace

SquaresResult least_squares_of_points(const PointSquares& problem, std::vector<double> x, std::vector<double> t,
                                      const SquaresOptions& options) {
  SquaresResult out;
  Linearised here(problem), there(problem);
  out.sum = here.evaluate(x, t);
  std::vector<double> dx(x.size()), dt(t.size());
  double damping = first_damping, growth = 2.0, watched = out.sum;
  int small = 0;
  here.rescale(there);
  while (std::isfinite(out.sum) && out.iterations < options.iterations && out.sum > options.enough) {
    if (options.interrupt != nullptr && options.interrupt->load()) break;
    ++out.iterations;
    const double promised = here.step(damping, dx, dt);
    std::vector<double> new_x = x, new_t = t;
    for (std::size_t j = 0; j < x.size(); ++j) new_x[j] += dx[j];
    for (std::size_t i = 0; i < t.size(); ++i) new_t[i] += dt[i];
    const double share = std::max(largest_share(dx, x), largest_share(dt, t));
    const double sum = std::isfinite(share) ? there.evaluate(new_x, new_t) : std::numeric_limits<double>::infinity();
    if (sum < out.sum) {
      const double gain = promised > 0.0 ? (out.sum - sum) / promised : 1.0;
      std::swap(here, there);
      x = std::move(new_x);
      t = std::move(new_t);
      out.sum = sum;
      here.rescale(there);
      damping *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3));
      growth = 2.0;
    } else {
      damping *= growth;
      growth *= 2.0;
    }
    small = share < small_step ? small + 1 : 0;
    if (small >= 2 || damping > 1e30) break;
    if (out.iterations % slow_steps == 0) {
      if (options.hopeless >= 0.0 && out.sum > options.hopeless && out.sum > (1.0 - slow_fall) * watched) break;
      watched = out.sum;
    }
  }
  out.converged = std::isfinite(out.sum) && (small >= 2 || out.sum <= options.enough);
  out.x = std::move(x);
  out.t = std::move(t);
  return out;
}

}  // namespace poise

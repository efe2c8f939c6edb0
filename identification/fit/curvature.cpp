#include "identification/fit/curvature.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "identification/identifiability/frequencies.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/not_a_number.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Standard errors at which the cost is compared with the parabola: about the ends of 95 % intervals.
constexpr double probe = 2.0;
/// There the ends move by about this part of the interval where the growth differs by as much.
constexpr double straight_within = 0.1;
/// Directions are examined in which a standard error changes a number by more than this part of its scale, or readings
/// by more than the noise in second order: changes by the scale make |A| in the strongest direction, and about as much
/// in second order in any.
constexpr double small_part = 0.002;
/// Half widths of the interval at which the others are fitted anew, until the cost has grown to its limit.
constexpr double step_sizes[] = {1.0, 1.5, 2.0, 3.0, 5.0, 10.0};
/// Where it has grown to more than this part of the limit at the first of them, a point between is needed.
constexpr double near_limit = 1.25;
/// First step along a null, of the number's scale.
constexpr double null_step = 0.02;
/// A cost that is lower by more than this, or by what integration errors make, is another minimum's.
constexpr double lower_by = 0.05, integration_part = 1e-4;
/// Fits along a trace end where a step lowers the cost by less than this part of what it grows to at the limit.
constexpr double cost_within = 1e-2;
/// Without an end on one side, an interval that is longer by this factor along the trace has none either.
constexpr double much_longer = 1.5;

class Explorer {
 public:
  Explorer(const FitProblem& problem, const std::vector<Record>& records, const Fit& fitted,
           const std::vector<LinearRun>& linear, const FitOptions& options, int most)
      : problem_(problem),
        records_(records),
        fitted_(fitted),
        linear_(linear),
        options_(options),
        most_(most),
        n_(static_cast<Index>(fitted.parameters.size())),
        scale_(n_) {
    for (Index i = 0; i < n_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      scale_[i] = problem.scale_of(at).size_or(problem.unknown_of(at).unit);
    }
    const auto count = static_cast<std::size_t>(n_);
    out_.low.assign(count, not_a_number);
    out_.high.assign(count, not_a_number);
    out_.open.assign(count, 0.0);
    traced_.assign(count, false);
  }

  Curvature run() {
    explore_weak_directions();
    explore_nulls();
    return std::move(out_);
  }

 private:
  void explore_weak_directions() {
    const VectorXd per_scale = scale_.cwiseInverse();
    const MatrixXd& white = fitted_.identifiability.covariance;
    const solvers::SymmetricEigen axes =
        solvers::symmetric_eigen(per_scale.asDiagonal() * white * per_scale.asDiagonal());
    const double strongest = fitted_.identifiability.singular_values.front();
    for (Index k = n_ - 1; k >= 0 && !done(); --k) {
      const double white_variance = axes.values[k];
      if (!(white_variance > 0)) return;
      const VectorXd direction = axes.vectors.col(k);
      const double variance =
          direction.dot(per_scale.asDiagonal() * fitted_.errors.covariance * per_scale.asDiagonal() * direction);
      if (std::sqrt(variance) < small_part && strongest * variance < 1.0) return;
      if (is_exhausted()) return;
      const double leading = std::sqrt(variance / white_variance);
      const VectorXd step = std::sqrt(variance) * (scale_.asDiagonal() * direction);
      if (is_straight(step, leading)) return;
      Index most = -1;
      for (Index i = 0; i < n_; ++i) {
        if (!has_error(i) || traced_[static_cast<std::size_t>(i)]) continue;
        if (most < 0 || std::abs(direction[i]) > std::abs(direction[most])) most = i;
      }
      if (most < 0) return;
      const auto at = static_cast<std::size_t>(most);
      trace(most, white.col(most) / white(most, most), fitted_.errors.reach[at],
            fitted_.errors.error[at] / std::sqrt(white(most, most)),
            fitted_.errors.reach[at] / fitted_.errors.error[at]);
    }
  }

  /// Nulls of numbers that masses and forces are linear in are nulls at any distance, and do not move others.
  void explore_nulls() {
    for (const Identifiability::Direction& null : fitted_.identifiability.null_directions) {
      if (done()) return;
      if (null.singular_value > 0) continue;
      Index most = -1;
      VectorXd step(n_);
      for (Index i = 0; i < n_; ++i) {
        step[i] = null_step * scale_[i] * null.part[static_cast<std::size_t>(i)];
        const SceneParameter* const number = problem_.number(static_cast<int>(i));
        if (step[i] == 0 || number == nullptr || !number->is_geometric()) continue;
        if (most < 0 || std::abs(step[i] / scale_[i]) > std::abs(step[most] / scale_[most])) most = i;
      }
      if (most < 0 || traced_[static_cast<std::size_t>(most)]) continue;
      if (is_exhausted()) return;
      if (is_null(step)) continue;
      trace(most, step / step[most], null_step * scale_[most], largest_factor(), probe);
    }
  }

  bool done() const {
    return out_.better || !out_.is_complete || (options_.interrupt != nullptr && options_.interrupt->load());
  }
  /// Whether another evaluation is one too many, which makes the result incomplete.
  bool is_exhausted() {
    if (out_.evaluations >= most_) out_.is_complete = false;
    return !out_.is_complete;
  }
  bool has_error(Index i) const {
    const auto at = static_cast<std::size_t>(i);
    return std::isfinite(fitted_.identifiability.standard_error[at]) && fitted_.errors.error[at] > 0 &&
           !fitted_.estimates[at].at_bound;
  }

  double largest_factor() const {
    double factor = 1.0;
    for (Index i = 0; i < n_; ++i) {
      if (has_error(i)) {
        const auto at = static_cast<std::size_t>(i);
        factor = std::max(factor, fitted_.errors.error[at] / fitted_.identifiability.standard_error[at]);
      }
    }
    return factor;
  }

  bool is_lower(double cost) const { return cost < fitted_.cost - std::max(lower_by, integration_part * fitted_.cost); }

  static FitPoint values_of(const Fit& fit) {
    FitPoint out{fit.parameters, {}};
    for (const RunFit& run : fit.runs) out.nuisances.push_back(run.nuisances);
    return out;
  }

  /// The values at x + step, nuisances following to first order.
  FitPoint moved(const VectorXd& step) const {
    FitPoint out{fitted_.parameters, {}};
    for (Index i = 0; i < n_; ++i) out.parameters[static_cast<std::size_t>(i)] += step[i];
    for (std::size_t r = 0; r < linear_.size(); ++r) {
      std::vector<double>& own = out.nuisances.emplace_back(fitted_.runs[r].nuisances);
      const Index count = problem_.run(r).nuisances();
      if (count == 0) continue;
      VectorXd change = VectorXd::Zero(linear_[r].rows.rows());
      for (std::size_t c = 0; c < problem_.parameters_of(r).size(); ++c) {
        change += step[problem_.parameters_of(r)[c]] * linear_[r].rows.col(count + static_cast<Index>(c));
      }
      const VectorXd follow = solvers::minimum_norm_solution<double>(linear_[r].rows.leftCols(count), change);
      for (Index i = 0; i < count; ++i) own[static_cast<std::size_t>(i)] -= follow[i];
    }
    return out;
  }

  /// The cost there; nothing where a parameter leaves its range.
  std::optional<double> cost_at(const VectorXd& step) {
    const FitPoint there = moved(step);
    for (std::size_t i = 0; i < there.parameters.size(); ++i) {
      const Parameter& p = problem_.parameters()[i];
      if (there.parameters[i] < p.min || there.parameters[i] > p.max) return {};
    }
    ++out_.evaluations;
    return problem_.cost(there.parameters, there.nuisances, records_, fitted_.weighting, options_.jobs);
  }

  /// Whether the cost at two leading standard errors is that of the parabola, on the side that is within the ranges.
  bool is_straight(const VectorXd& step, double leading) {
    std::optional<double> cost = cost_at(probe * step);
    if (!cost) cost = cost_at(-probe * step);
    if (!cost || is_lower(*cost)) return false;
    const double growth = std::sqrt(2 * std::max(0.0, *cost - fitted_.cost)) / (probe * leading);
    return std::abs(growth - 1) <= straight_within;
  }

  bool is_null(const VectorXd& step) {
    const double least = std::max(lower_by, integration_part * fitted_.cost);
    constexpr std::array sides = {-1.0, 1.0};
    return std::all_of(sides.begin(), sides.end(), [&](double t) {
      const std::optional<double> cost = cost_at(t * step);
      return !cost || std::abs(*cost - fitted_.cost) < least;
    });
  }

  struct Point {
    FitPoint values;
    double growth = 0.0;  // in leading standard errors
  };

  /// `direction`: changes of all parameters per change of the one held, to first order; `reach`: half its interval,
  /// `factor`: its leading over its white standard error, `limit`: the quantile of the interval.
  void trace(Index held, const VectorXd& direction, double reach, double factor, double limit) {
    const auto at = static_cast<std::size_t>(held);
    traced_[at] = true;
    CostTrace found{.held = static_cast<int>(held)};
    for (const int side : {-1, 1}) {
      std::vector<Point> points = {{values_of(fitted_), 0.0}};
      const bool ended = follow(held, side * direction, reach, factor, limit, points);
      if (done()) return;
      const Point& last = points.back();
      const double far = limit * std::abs(last.values.parameters[at] - fitted_.parameters[at]) / reach;
      const double slow = points.size() > 1 ? far / std::max(last.growth, 1e-3 * far) : 1.0;
      (side < 0 ? found.slow_low : found.slow_high) = slow;
      (side < 0 ? found.open_low : found.open_high) = !ended;
      widen(held, points, limit, ended ? 0.0 : slow);
    }
    out_.traces.push_back(found);
  }

  /// Points outwards, the last one at the limit or beyond it. False where the cost does not grow to it, or no fit
  /// succeeds; true also at a bound.
  bool follow(Index held, const VectorXd& direction, double reach, double factor, double limit,
              std::vector<Point>& points) {
    const auto at = static_cast<std::size_t>(held);
    const Parameter& p = problem_.parameters()[at];
    const double side = direction[held];
    const double estimate = fitted_.parameters[at];
    const auto add = [&](double x, const FitPoint& start) {
      if (is_exhausted()) return false;
      if (options_.progress) {
        options_.progress(fmt::format("following the valley of {}, {:.1f} half intervals {}", p.name,
                                      std::abs(x - estimate) / reach, side < 0 ? "down" : "up"));
      }
      const Fit there = fit_at(held, x, start, limit * factor);
      out_.evaluations += there.evaluations;
      if (done() || there.status == FitStatus::failed) return false;
      if (is_lower(there.cost)) {
        out_.better = there;
        return false;
      }
      points.push_back({values_of(there), std::sqrt(2 * std::max(0.0, there.cost - fitted_.cost)) / factor});
      return true;
    };
    const auto linear = [&](double x) { return moved((x - estimate) / side * direction); };
    const auto onwards = [&](double x) {
      return extrapolated(points[points.size() - 2].values, points.back().values, at, x);
    };
    for (const double step : step_sizes) {
      double x = estimate + side * step * reach;
      const bool at_bound = side < 0 ? x <= p.min : x >= p.max;
      if (at_bound) x = side < 0 ? p.min : p.max;
      const double half = (estimate + x) / 2;
      if (points.size() > 1) {
        if (!add(x, onwards(x))) return false;
      } else if (!add(x, linear(x))) {
        if (done() || !add(half, linear(half)) || !add(x, onwards(x))) return false;
      } else if (points.back().growth > near_limit * limit) {
        if (!add(half, onwards(half))) return false;
        std::swap(points[1], points[2]);
      }
      if (points.back().growth >= limit || at_bound) return true;
    }
    return false;
  }

  Fit fit_at(Index held, double x, const FitPoint& start, double grown) const {
    Fit from = fitted_;
    start_at(start, from);
    FitOptions options;
    options.from = &from;
    options.held = {{static_cast<int>(held), x}};
    options.values_only = true;
    options.function_tolerance = std::max(options.function_tolerance, cost_within * grown * grown / 2 / fitted_.cost);
    options.jobs = options_.jobs;
    options.interrupt = options_.interrupt;
    return fit(problem_, records_, options);
  }

  /// On the line through two points where parameter `at` has the value x.
  static FitPoint extrapolated(const FitPoint& a, const FitPoint& b, std::size_t at, double x) {
    const double part = (x - b.parameters[at]) / (b.parameters[at] - a.parameters[at]);
    FitPoint out = b;
    for (std::size_t i = 0; i < out.parameters.size(); ++i)
      out.parameters[i] += part * (b.parameters[i] - a.parameters[i]);
    for (std::size_t r = 0; r < out.nuisances.size(); ++r) {
      for (std::size_t i = 0; i < out.nuisances[r].size(); ++i) {
        out.nuisances[r][i] += part * (b.nuisances[r][i] - a.nuisances[r][i]);
      }
    }
    return out;
  }

  /// Makes a fit that others start from start at this point, within the ranges.
  void start_at(const FitPoint& point, Fit& from) const {
    for (std::size_t i = 0; i < point.parameters.size(); ++i) {
      from.parameters[i] = std::clamp(point.parameters[i], problem_.parameters()[i].min, problem_.parameters()[i].max);
    }
    for (std::size_t r = 0; r < point.nuisances.size(); ++r) from.runs[r].nuisances = point.nuisances[r];
  }

  /// The interval of every parameter along these points; `slow` of a side without an end, else 0.
  void widen(Index held, const std::vector<Point>& points, double limit, double slow) {
    constexpr int parts = 16;
    const MatrixXd& covariance = fitted_.errors.covariance;
    const bool null = !has_error(held);
    for (Index j = 0; j < n_; ++j) {
      if (!has_error(j)) continue;
      const auto at = static_cast<std::size_t>(j);
      const double shared = null || !(covariance(held, held) > 0)
                                ? 0.0
                                : covariance(j, held) * covariance(j, held) / covariance(held, held);
      const double own = fitted_.errors.reach[at] *
                         std::sqrt(std::max(0.0, 1.0 - shared / (fitted_.errors.error[at] * fitted_.errors.error[at])));
      double low = fitted_.parameters[at];
      double high = low;
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        for (int k = 0; k <= parts; ++k) {
          const double share = static_cast<double>(k) / parts;
          const auto between = [&](double a, double b) { return a + share * (b - a); };
          const double growth = between(points[i].growth, points[i + 1].growth) / limit;
          if (growth > 1.0) continue;
          const double x = between(points[i].values.parameters[at], points[i + 1].values.parameters[at]);
          const double around = j == held ? 0.0 : own * std::sqrt(1.0 - growth * growth);
          low = std::min(low, x - around);
          high = std::max(high, x + around);
        }
      }
      out_.low[at] = std::isnan(out_.low[at]) ? low : std::min(out_.low[at], low);
      out_.high[at] = std::isnan(out_.high[at]) ? high : std::max(out_.high[at], high);
      const double farther = std::max(fitted_.parameters[at] - low, high - fitted_.parameters[at]);
      if (slow > 0 && (j == held || farther > much_longer * fitted_.errors.reach[at]))
        out_.open[at] = std::max(out_.open[at], slow);
    }
  }

  const FitProblem& problem_;
  const std::vector<Record>& records_;
  const Fit& fitted_;
  const std::vector<LinearRun>& linear_;
  const FitOptions& options_;
  int most_;
  Index n_;
  VectorXd scale_;
  std::vector<bool> traced_;
  Curvature out_;
};

}  // namespace

Curvature find_curvature(const FitProblem& problem, const std::vector<Record>& records, const Fit& fitted,
                         const std::vector<LinearRun>& linear, const FitOptions& options, int most) {
  return Explorer(problem, records, fitted, linear, options, most).run();
}

}  // namespace poise

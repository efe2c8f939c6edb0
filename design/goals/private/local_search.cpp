#include "design/goals/private/local_search.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/bounded_least_squares.hpp"
#include "solvers/nonnegative_least_squares.hpp"

namespace poise {
namespace {

constexpr double inside = 1e-8;  // by which inequalities are kept, over the goal's size, against rounding
constexpr int most_evaluations = 300;

/// The value of an aim over its terms.
double value_of(const DesignGoal& goal, const GoalAim& aim) {
  double most = -not_limited, least = not_limited;
  for (const GoalTerm& term : aim.terms) {
    const double value = goal.aim == DesignGoal::Aim::curve ? std::abs(term.value) : term.value;
    most = std::max(most, value);
    least = std::min(least, value);
  }
  return goal.aim == DesignGoal::Aim::flat ? most - least : most;
}

/// The least distance from a limit, over the goal's size: what is made as large as possible where there are no aims.
double margin_of(const GoalValues& values) {
  double out = 1.0;
  for (const GoalLimit& one : values.limits) {
    if (!one.is_equation) out = std::min(out, -one.c);
  }
  return out;
}

void judge(const GoalProblem& problem, const GoalValues& values, LocalEnd& out) {
  out.has_values = true;
  out.missed = 0.0;
  out.keeps = true;
  for (const GoalLimit& one : values.limits) {
    const double miss = one.is_equation ? std::abs(one.c) : std::max(0.0, one.c);
    out.missed += miss * miss;
    if (miss > (one.is_equation ? one.kept_to : 0.0)) {
      out.keeps = false;
      if (one.goal < 0) out.misses_length = true;
    }
  }
  out.aim = 0.0;
  out.aims.clear();
  if (values.aims.empty()) out.aim = -margin_of(values);
  for (const GoalAim& aim : values.aims) {
    const DesignGoal& goal = problem.goals[static_cast<std::size_t>(aim.goal)];
    out.aims.push_back(value_of(goal, aim));
    out.aim += goal.weight * out.aims.back();
  }
}

/// The aims as a program in the parts and in bounds on their terms.
class AimProgram {
 public:
  AimProgram(const GoalProblem& problem, GoalEvaluation& evaluation, const DesignPoint& from,
             const LocalSearchOptions& options)
      : problem_(problem), evaluation_(evaluation), point_(from), options_(options) {}

  /// Variables: parts, then of each aim the bound above, of a flat one that below too; without aims the margin, with a
  /// minus.
  int begin(const GoalValues& values, Eigen::VectorXd& start, Eigen::VectorXd& lower, Eigen::VectorXd& upper) {
    const Eigen::Index parts = point_.parts.size();
    std::vector<double> bounds;
    for (const GoalAim& aim : values.aims) {
      const DesignGoal& goal = problem_.goals[static_cast<std::size_t>(aim.goal)];
      first_.push_back(static_cast<int>(parts) + static_cast<int>(bounds.size()));
      double most = -not_limited, least = not_limited;
      for (const GoalTerm& term : aim.terms) {
        most = std::max(most, goal.aim == DesignGoal::Aim::curve ? std::abs(term.value) : term.value);
        least = std::min(least, term.value);
      }
      bounds.push_back(most);
      if (goal.aim == DesignGoal::Aim::flat) bounds.push_back(least);
    }
    is_margin_ = values.aims.empty();
    // A start that keeps all constraints strictly: from where one is just met SLSQP often does not move.
    constexpr double slack = 1e-3;
    if (is_margin_) bounds.push_back(slack - margin_of(values));
    const auto count = static_cast<Eigen::Index>(bounds.size());
    start.resize(parts + count);
    lower = Eigen::VectorXd::Constant(parts + count, -HUGE_VAL);
    upper = Eigen::VectorXd::Constant(parts + count, HUGE_VAL);
    start.head(parts) = point_.parts;
    lower.head(parts).setZero();
    upper.head(parts).setOnes();
    if (is_margin_) lower[parts] = -1.0;
    for (Eigen::Index k = 0; k < count; ++k) start[parts + k] = bounds[static_cast<std::size_t>(k)];
    return static_cast<int>(count);
  }

  bool evaluate(const Eigen::VectorXd& x, solvers::ProgramAt& out) {
    const Eigen::Index parts = point_.parts.size(), n = x.size();
    point_.parts = x.head(parts).cwiseMax(0.0).cwiseMin(1.0);
    GoalValues values;
    if (!evaluation_.evaluate(point_, true, values)) return false;
    std::vector<std::pair<double, Eigen::RowVectorXd>> below, equal;
    const auto widened = [&](const Eigen::RowVectorXd& by) {
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(n);
      row.head(parts) = by;
      return row;
    };
    for (const GoalLimit& one : values.limits) {
      (one.is_equation ? equal : below).emplace_back(one.c + (one.is_equation ? 0.0 : inside), widened(one.by));
    }
    out.gradient = Eigen::VectorXd::Zero(n);
    out.value = 0.0;
    if (is_margin_) {
      out.value = x[parts];
      out.gradient[parts] = 1.0;
      for (auto& [value, row] : below) {
        value -= x[parts];
        row[parts] = -1.0;
      }
    }
    for (std::size_t a = 0; a < values.aims.size(); ++a) add_aim(values.aims[a], a, x, widened, below, out);
    const auto put = [&](const auto& rows, Eigen::VectorXd& value, Eigen::MatrixXd& by) {
      value.resize(static_cast<Eigen::Index>(rows.size()));
      by.resize(value.size(), n);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        value[static_cast<Eigen::Index>(k)] = rows[k].first;
        by.row(static_cast<Eigen::Index>(k)) = rows[k].second;
      }
    };
    put(below, out.below, out.below_by);
    put(equal, out.equal, out.equal_by);
    return true;
  }

 private:
  template <class Widen, class Rows>
  void add_aim(const GoalAim& aim, std::size_t a, const Eigen::VectorXd& x, Widen widened, Rows& below,
               solvers::ProgramAt& out) const {
    const DesignGoal& goal = problem_.goals[static_cast<std::size_t>(aim.goal)];
    const Eigen::Index top = first_[a];
    const bool is_flat = goal.aim == DesignGoal::Aim::flat, is_curve = goal.aim == DesignGoal::Aim::curve;
    out.value += goal.weight * (x[top] - (is_flat ? x[top + 1] : 0.0));
    out.gradient[top] += goal.weight;
    if (is_flat) out.gradient[top + 1] -= goal.weight;
    for (const GoalTerm& term : aim.terms) {
      Eigen::RowVectorXd row = widened(term.by);
      row[top] -= 1.0;
      below.emplace_back(term.value - x[top], row);
      if (!is_flat && !is_curve) continue;
      row = -widened(term.by);
      row[is_flat ? top + 1 : top] += is_flat ? 1.0 : -1.0;
      below.emplace_back(is_flat ? x[top + 1] - term.value : -term.value - x[top], row);
    }
    if (a < options_.levels.size() && std::isfinite(options_.levels[a])) {
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(x.size());
      row[top] = 1.0;
      if (is_flat) row[top + 1] = -1.0;
      below.emplace_back(x[top] - (is_flat ? x[top + 1] : 0.0) - options_.levels[a], row);
    }
  }

  const GoalProblem& problem_;
  GoalEvaluation& evaluation_;
  DesignPoint point_;
  LocalSearchOptions options_;
  std::vector<int> first_;
  bool is_margin_ = false;
};

}  // namespace

bool LocalEnd::is_better_than(const LocalEnd& other, double by) const {
  if (has_values != other.has_values) return has_values;
  if (keeps != other.keeps) return keeps;
  if (!keeps) return missed < other.missed;
  return aim < other.aim - by * std::max(std::abs(aim), std::abs(other.aim));
}

LocalEnd values_at(const GoalProblem& problem, GoalEvaluation& evaluation, const DesignPoint& point) {
  LocalEnd out;
  out.point = point;
  GoalValues values;
  if (evaluation.evaluate(point, false, values)) judge(problem, values, out);
  return out;
}

LocalEnd local_search(const GoalProblem& problem, GoalEvaluation& evaluation, DesignPoint from,
                      const LocalSearchOptions& options) {
  const Eigen::Index n = from.parts.size();
  LocalEnd out;
  out.point = from;
  GoalValues values;
  if (n > 0) {
    const auto residuals = [&](const Eigen::VectorXd& x, bool with_derivatives, solvers::ResidualsAt& at) {
      const DesignPoint there{x, from.rows};
      if (!evaluation.evaluate(there, with_derivatives, values)) return false;
      const auto rows = static_cast<Eigen::Index>(values.limits.size());
      at.value.resize(rows);
      at.by = Eigen::MatrixXd::Zero(rows, n);
      for (Eigen::Index k = 0; k < rows; ++k) {
        const GoalLimit& one = values.limits[static_cast<std::size_t>(k)];
        const double c = one.is_equation ? one.c : std::max(0.0, one.c + inside);
        at.value[k] = c;
        if (c != 0.0) at.by.row(k) = one.by;
      }
      return true;
    };
    solvers::BoundedLeastSquaresOptions least;
    least.interrupt = options.interrupt;
    const auto found = solvers::bounded_least_squares(residuals, from.parts, Eigen::VectorXd::Zero(n),
                                                      Eigen::VectorXd::Ones(n), least);
    if (!std::isfinite(found.sum)) return out;
    from.parts = found.x;
  }
  out = values_at(problem, evaluation, from);
  if (!out.has_values || n == 0 || !options.with_aims || !out.keeps || (out.aims.empty() && out.aim <= -1.0))
    return out;
  if (!evaluation.evaluate(from, true, values)) return out;
  AimProgram program(problem, evaluation, from, options);
  Eigen::VectorXd start, lower, upper;
  program.begin(values, start, lower, upper);
  solvers::NonlinearProgramOptions search;
  search.method = options.method;
  search.evaluations = most_evaluations;
  search.interrupt = options.interrupt;
  const auto found = solvers::nonlinear_program(
      [&](const Eigen::VectorXd& x, solvers::ProgramAt& at) { return program.evaluate(x, at); }, start, lower, upper,
      search);
  LocalEnd better = values_at(problem, evaluation, {found.x.head(n).cwiseMax(0.0).cwiseMin(1.0), from.rows});
  const bool has_levels = !options.levels.empty();
  if (better.has_values && better.keeps && (better.is_better_than(out, 0.0) || has_levels)) return better;
  return out;
}

std::vector<HeldBack> holding_back(const GoalProblem& problem, GoalEvaluation& evaluation, const DesignPoint& point) {
  GoalValues values;
  std::vector<HeldBack> out;
  if (!evaluation.evaluate(point, true, values)) return out;
  constexpr double active = 1e-5;
  AimProgram program(problem, evaluation, point, {});
  Eigen::VectorXd x, lower, upper;
  program.begin(values, x, lower, upper);
  solvers::ProgramAt at;
  if (!program.evaluate(x, at)) return out;
  std::vector<Eigen::VectorXd> columns;
  std::size_t below = 0;
  for (const GoalLimit& one : values.limits) {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(x.size());
    column.head(point.parts.size()) = one.by.transpose();
    if (one.is_equation) {
      for (const double sign : {1.0, -1.0}) {
        columns.emplace_back(sign * column);
        out.push_back({one.goal, -1, sign > 0.0, 0.0});
      }
      continue;
    }
    ++below;
    if (one.c < -active) continue;
    columns.push_back(column);
    out.push_back({one.goal, -1, false, 0.0});
  }
  const std::size_t limits = out.size();
  for (Eigen::Index k = 0; k < point.parts.size(); ++k) {
    for (const bool is_upper : {false, true}) {
      if (is_upper ? point.parts[k] < 1.0 - active : point.parts[k] > active) continue;
      columns.emplace_back((is_upper ? 1.0 : -1.0) * Eigen::VectorXd::Unit(x.size(), k));
      out.push_back({-1, static_cast<int>(k), is_upper, 0.0});
    }
  }
  // Terms of the aims that attain their bounds.
  for (Eigen::Index k = static_cast<Eigen::Index>(below); k < at.below.size(); ++k) {
    if (at.below[k] >= -active) columns.emplace_back(at.below_by.row(k).transpose());
  }
  if (columns.empty()) return {};
  Eigen::MatrixXd a(x.size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) a.col(static_cast<Eigen::Index>(k)) = columns[k];
  const Eigen::VectorXd multipliers = solvers::nonnegative_least_squares(a, -at.gradient);
  // Where the search has not come to rest no multipliers balance the gradient, and none is known.
  constexpr double balanced_to = 1e-3;
  if (!((a * multipliers + at.gradient).norm() <= balanced_to * at.gradient.norm())) return {};
  for (std::size_t k = 0; k < out.size(); ++k) out[k].gain = multipliers[static_cast<Eigen::Index>(k)];
  // One line for each goal: the sum over its positions.
  std::vector<HeldBack> summed;
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (!(out[k].gain > 0.0)) continue;
    const auto same = std::find_if(summed.begin(), summed.end(), [&](const HeldBack& one) {
      return k < limits && one.variable < 0 && one.goal == out[k].goal;
    });
    if (same == summed.end()) {
      summed.push_back(out[k]);
    } else {
      same->gain += out[k].gain;
    }
  }
  std::stable_sort(summed.begin(), summed.end(),
                   [](const HeldBack& a1, const HeldBack& b1) { return a1.gain > b1.gain; });
  return summed;
}

}  // namespace poise

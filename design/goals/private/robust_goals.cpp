#include "design/goals/private/robust_goals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "design/goals/goal_evaluation.hpp"
#include "solvers/nonlinear_program.hpp"
#include "solvers/parallel.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

/// The problem whose variables are the numbers with tolerances, each over its half widths around the choice.
GoalProblem of_tolerances(const GoalProblem& problem, const DesignPoint& point) {
  GoalProblem out = problem;
  out.scene = scene_at(problem, point);
  out.variables.clear();
  out.ties.clear();
  out.catalogues.clear();
  // Percentages are those of the numbers chosen.
  out.tolerances = parse_tolerances(problem.tolerance_text, problem.tolerance_file, out.scene);
  for (const Tolerance& one : out.tolerances) {
    const ParameterRow row = parameter(out.scene, one.number);
    const double value = value_at(out.scene, row.place).value_or(0.0);
    out.variables.push_back({one.number, row, value - one.half_width, value + one.half_width});
  }
  return out;
}

DesignPoint middle(const GoalProblem& around) {
  return {Eigen::VectorXd::Constant(static_cast<Eigen::Index>(around.variables.size()), 0.5), {}};
}

/// Half of it moves the quantity from the middle to an end of the half width.
double spread(const GoalProblem& problem, const Eigen::RowVectorXd& by) {
  if (problem.worst_corner) return 0.5 * by.cwiseAbs().sum();
  double sum = 0.0;
  for (std::size_t k = 0; k < problem.tolerances.size(); ++k) {
    const Tolerance& one = problem.tolerances[k];
    const double moved =
        one.half_width > 0.0 ? 0.5 * by[static_cast<Eigen::Index>(k)] * one.sigma / one.half_width : 0.0;
    sum += moved * moved;
  }
  constexpr double deviations = 3.0;
  return deviations * std::sqrt(sum);
}

/// By how much quantities really differ in the corners that are worst to first order: products of deviations add.
void add_corners(GoalEvaluation& evaluation, const GoalValues& middle_values, GoalEvaluation::Tightening& out) {
  std::set<std::vector<char>> corners;
  for (const std::vector<GoalTerm>& terms : middle_values.terms) {
    for (const GoalTerm& term : terms) {
      std::vector<char> up, down;
      for (const double by : term.by) {
        up.push_back(by > 0.0 ? 1 : 0);
        down.push_back(by > 0.0 ? 0 : 1);
      }
      corners.insert({up, down});
    }
  }
  for (const std::vector<char>& corner : corners) {
    DesignPoint point{Eigen::VectorXd(static_cast<Eigen::Index>(corner.size())), {}};
    for (std::size_t k = 0; k < corner.size(); ++k) point.parts[static_cast<Eigen::Index>(k)] = corner[k];
    GoalValues there;
    if (!evaluation.evaluate(point, false, there)) continue;  // the check of all corners says so
    for (std::size_t k = 0; k < out.size(); ++k) {
      for (std::size_t i = 0; i < there.terms[k].size(); ++i) {
        double& amount = out[k][i].second;
        amount = std::max(amount, std::abs(there.terms[k][i].value - middle_values.terms[k][i].value));
      }
    }
  }
}

bool keeps(const GoalValues& values) {
  constexpr double rounding = 1e-9;
  return std::all_of(values.limits.begin(), values.limits.end(),
                     [](const GoalLimit& one) { return one.is_equation || one.c <= rounding; });
}

/// Half widths over the given ones with the least sum of their reciprocals, for which  sum |g| width <= margin  of all
/// limits.
std::vector<double> widest_of(const GoalProblem& problem, const GoalValues& values) {
  const auto n = static_cast<Eigen::Index>(problem.tolerances.size());
  std::vector<std::pair<Eigen::RowVectorXd, double>> limits;
  for (const GoalLimit& one : values.limits) {
    if (!one.is_equation) limits.emplace_back(0.5 * one.by.cwiseAbs(), -one.c);
  }
  std::vector<double> out;
  const bool has_room = std::all_of(limits.begin(), limits.end(), [](const auto& one) { return one.second > 0.0; });
  if (limits.empty() || !has_room) return out;
  // In logarithms, so that widths stay positive; begun where the tightest limit is just kept.
  double part = 1e6;
  for (const auto& [by, margin] : limits) part = std::min(part, margin / std::max(by.sum(), 1e-300));
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(n, std::log(part));
  const auto program = [&](const Eigen::VectorXd& x, solvers::ProgramAt& at) {
    const Eigen::ArrayXd width = x.array().exp();
    // The logarithm of the cost has the same minimum and a scale of its own.
    const double cost = width.inverse().sum();
    at.value = std::log(cost);
    at.gradient = (-width.inverse() / cost).matrix();
    at.below.resize(static_cast<Eigen::Index>(limits.size()));
    at.below_by.resize(at.below.size(), n);
    for (std::size_t k = 0; k < limits.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const auto& [by, margin] = limits[k];
      at.below[row] = (by.transpose().array() * width).sum() / margin - 1.0;
      at.below_by.row(row) = ((by.transpose().array() * width) / margin).matrix().transpose();
    }
    return true;
  };
  constexpr double widest = 1e3;
  solvers::NonlinearProgramOptions options;
  options.evaluations = 2000;
  const auto found = solvers::nonlinear_program(program, start, Eigen::VectorXd::Constant(n, std::log(part / widest)),
                                                Eigen::VectorXd::Constant(n, std::log(part * widest)), options);
  if (!found.keeps) return out;
  for (Eigen::Index k = 0; k < n; ++k) {
    const bool moves = std::any_of(limits.begin(), limits.end(),
                                   [&](const auto& one) { return one.first[k] * part * widest > one.second; });
    if (!moves) {
      out.push_back(std::numeric_limits<double>::infinity());
      continue;
    }
    out.push_back(std::exp(found.x[k]) * problem.tolerances[static_cast<std::size_t>(k)].half_width);
  }
  return out;
}

}  // namespace

GoalEvaluation::Tightening tightening(const GoalProblem& problem, const DesignPoint& point,
                                      const std::vector<double>& corrections) {
  const GoalProblem around = of_tolerances(problem, point);
  GoalEvaluation evaluation(around);
  evaluation.correct(corrections);
  GoalValues values;
  if (!evaluation.evaluate(middle(around), true, values)) return {};
  GoalEvaluation::Tightening out(problem.goals.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    for (const GoalTerm& term : values.terms[k]) out[k].emplace_back(term.at, spread(around, term.by));
  }
  if (problem.worst_corner) add_corners(evaluation, values, out);
  return out;
}

RobustCheck verify_tolerances(const GoalProblem& problem, const DesignPoint& point,
                              const std::vector<double>& corrections, const GoalSearchOptions& options) {
  RobustCheck out;
  out.asked = true;
  for (const auto& places : tightening(problem, point, corrections)) {
    double most = 0.0;
    for (const auto& [at, amount] : places) most = std::max(most, amount);
    out.tightened.push_back(most);
  }
  const GoalProblem around = of_tolerances(problem, point);
  out.tolerances = around.tolerances;
  GoalEvaluation evaluation(around);
  evaluation.correct(corrections);
  GoalValues values, there;
  if (!evaluation.evaluate(middle(around), true, values)) {
    out.corners_kept = false;
    return out;
  }
  out.widest = widest_of(around, values);
  for (const GoalLimit& limit : values.limits) {
    if (limit.is_equation || limit.by.isZero()) continue;
    DesignPoint corner = middle(around);
    for (Eigen::Index k = 0; k < corner.parts.size(); ++k) corner.parts[k] = limit.by[k] > 0.0 ? 1.0 : 0.0;
    if (!evaluation.evaluate(corner, false, there)) {
      out.corners_kept = false;
      continue;
    }
    for (const GoalLimit& other : there.limits) {
      const bool is_same = other.goal == limit.goal && !other.is_equation;
      if (is_same && other.c > 1e-9) out.corners_kept = false;
    }
  }
  constexpr std::size_t chunk = 50;
  const auto samples = static_cast<std::size_t>(std::max(0, options.samples));
  std::vector<int> done((samples + chunk - 1) / chunk, 0), kept(done);
  solvers::parallel_for(done.size(), {options.jobs, options.interrupt, {}}, [&](std::size_t c) {
    GoalEvaluation own(around);
    own.correct(corrections);
    GoalValues at;
    DesignPoint sample = middle(around);
    own.evaluate(sample, true, at);
    for (std::size_t i = c * chunk; i < std::min(samples, (c + 1) * chunk); ++i) {
      solvers::RandomStream random(options.seed, 1, i);
      for (std::size_t k = 0; k < around.tolerances.size(); ++k) {
        const Tolerance& one = around.tolerances[k];
        const bool is_uniform = one.distribution == Tolerance::Distribution::uniform || !(one.half_width > 0.0);
        const double part = is_uniform ? random.uniform() : 0.5 + 0.5 * random.normal() * one.sigma / one.half_width;
        sample.parts[static_cast<Eigen::Index>(k)] = part;
      }
      ++done[c];
      if (own.evaluate(sample, false, at) && keeps(at)) ++kept[c];
    }
  });
  for (std::size_t c = 0; c < done.size(); ++c) {
    out.samples += done[c];
    out.kept += kept[c];
  }
  return out;
}

}  // namespace poise

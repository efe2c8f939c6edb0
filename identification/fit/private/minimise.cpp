#include "identification/fit/private/minimise.hpp"

#include <algorithm>

#include <ceres/ceres.h>
#include <fmt/format.h>

#include "identification/fit/private/ceres_costs.hpp"

namespace poise {
namespace {

/// Motions of a fit that only has to be a start for more readings are less accurate by this factor, down to this.
constexpr double accuracy_of_start = 100.0, least_accuracy = 1e-4;

/// The least-squares problem in the form of Ceres: parameters in units of their scales, nuisances as differences from
/// the start.
class CeresFit {
 public:
  /// `weighting` and `start` must outlive this.
  CeresFit(const FitTask& task, const Weighting& weighting, const FitPoint& start, double window, FitEffort& effort)
      : task_(task),
        start_(start),
        window_(window),
        effort_(effort),
        runs_(task.options.jobs),
        problem_(calling(runs_)),
        held_(parameters().size(), 0) {
    for (std::size_t i = 0; i < parameters().size(); ++i)
      scaled_.push_back(start.parameters[i] / parameters()[i].scale);
    for (const auto& nuisances : start.nuisances) shifts_.emplace_back(nuisances.size(), 0.0);
    add_runs(weighting);
    add_priors();
    if (is_start()) stay_near();
    for (const auto& [p, value] : task.options.held) hold(static_cast<std::size_t>(p));
  }

  /// Ceres' own bounds cost a line search in every step, so ranges are kept by an active set: a parameter that leaves
  /// its range is held at the bound, and released where its gradient points inside again, as long as that lowers the
  /// cost. Returns the cost reached, nothing where Ceres finds no usable point.
  std::optional<double> solve() {
    Watch watch(task_.options.interrupt, is_start(), function_tolerance(), [&] { return leaves_range(); });
    ceres::Solver::Options options = settings();
    options.callbacks.push_back(&watch);
    hold_at_bounds();
    double reached = INFINITY;
    for (std::size_t round = 0;; ++round) {
      const std::optional<double> cost = descend(options);
      if (!cost || task_.stopped() || round > 2 * parameters().size()) return cost;
      if (hold_what_left()) continue;
      if (*cost > reached * (1 - function_tolerance())) return cost;
      reached = *cost;
      if (round > parameters().size() || !release()) return cost;
    }
  }

  FitPoint point() const {
    FitPoint out = start_;
    for (std::size_t i = 0; i < parameters().size(); ++i) out.parameters[i] = scaled_[i] * parameters()[i].scale;
    for (std::size_t r = 0; r < shifts_.size(); ++r) {
      for (std::size_t i = 0; i < shifts_[r].size(); ++i) out.nuisances[r][i] += shifts_[r][i];
    }
    return out;
  }

  /// The runs linearized at the point, once.
  std::vector<std::optional<LinearRun>> take_runs() {
    std::vector<std::optional<LinearRun>> out;
    for (OfRun& run : costs_) out.push_back(run.cost->take(run.blocks.data()));
    return out;
  }

 private:
  struct OfRun {
    RunCost* cost;
    std::vector<double*> blocks;
  };

  static ceres::Problem::Options calling(RunsInParallel& runs) {
    ceres::Problem::Options out;
    out.evaluation_callback = &runs;
    return out;
  }

  const std::vector<Parameter>& parameters() const { return task_.problem.parameters(); }
  /// Says whether the result only has to be a start for a fit to more readings.
  bool is_start() const { return window_ < 1.0; }

  // --- the problem --------------------------------------------------------------------------------------------------

  void add_runs(const Weighting& weighting) {
    const FitProblem& problem = task_.problem;
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      std::vector<double*> blocks;
      for (const int p : problem.parameters_of(r)) blocks.push_back(&scaled_[static_cast<std::size_t>(p)]);
      if (!shifts_[r].empty()) blocks.push_back(shifts_[r].data());
      const double accuracy =
          is_start() ? std::min(least_accuracy, accuracy_of_start * problem.accuracy(r)) : problem.accuracy(r);
      auto* cost = new RunCost(problem, r, task_.records[r], until(r), accuracy, weighting, start_.nuisances[r],
                               effort_.evaluations, task_.options.interrupt);
      problem_.AddResidualBlock(cost, nullptr, blocks);
      runs_.add(*cost, blocks);
      costs_.push_back({cost, std::move(blocks)});
    }
  }

  void add_priors() {
    for (std::size_t i = 0; i < parameters().size(); ++i) {
      const Unknown& unknown = task_.problem.unknown_of(i);
      if (unknown.prior) add_prior(i, *unknown.prior - unknown.includes, unknown.prior_deviation);
    }
  }

  void add_prior(std::size_t i, double mean, double deviation) {
    problem_.AddResidualBlock(new PriorCost(mean, deviation, parameters()[i].scale), nullptr, &scaled_[i]);
  }

  /// Few readings leave some directions of the parameters nearly free, and along these a step goes as far as residuals
  /// of a wrong start drive it: to dimensions of kilometres, from which there is no way back. So a change of a
  /// parameter by its reach counts as much as a reading at the start does.
  void stay_near() {
    double cost = 0.0;
    if (!problem_.Evaluate({}, &cost, nullptr, nullptr, nullptr)) return;
    std::size_t readings = 0;
    for (std::size_t r = 0; r < task_.problem.runs(); ++r) readings += task_.problem.run(r).readings(until(r));
    const double residual =
        std::max(1.0, std::sqrt(2 * cost / static_cast<double>(std::max<std::size_t>(readings, 1))));
    for (std::size_t i = 0; i < parameters().size(); ++i) {
      add_prior(i, start_.parameters[i], task_.problem.reach(i) / residual);
    }
  }

  /// The time up to which a part of run r is fitted; it contains enough readings for the run's own values.
  double until(std::size_t r) const {
    const RunModel& run = task_.problem.run(r);
    if (!is_start() || run.is_at_rest()) return INFINITY;
    const auto least = static_cast<std::size_t>(run.columns()) + 4;
    double part = window_;
    while (part < 1.0 && run.readings(part * run.span()) < least) part *= 1.5;
    return part < 1.0 ? part * run.span() : INFINITY;
  }

  // --- the descent --------------------------------------------------------------------------------------------------

  double function_tolerance() const { return is_start() ? 1e-3 : task_.options.function_tolerance; }

  ceres::Solver::Options settings() const {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = 60;
    // Trial dimensions with which the mechanism cannot be assembled make a step invalid, and the next one shorter.
    options.max_num_consecutive_invalid_steps = 20;
    options.function_tolerance = function_tolerance();
    options.parameter_tolerance = 1e-14;
    options.gradient_tolerance = 1e-12;
    // Full steps are tried first: small oscillations are nearly linear in the parameters.
    options.initial_trust_region_radius = 1e6;
    options.update_state_every_iteration = true;
    return options;
  }

  std::optional<double> descend(const ceres::Solver::Options& options) {
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    effort_.iterations += static_cast<int>(summary.iterations.size());
    if (!summary.IsSolutionUsable()) return std::nullopt;
    return summary.final_cost;
  }

  bool leaves_range() const {
    for (std::size_t i = 0; i < parameters().size(); ++i) {
      const Parameter& p = parameters()[i];
      if (scaled_[i] < p.min / p.scale || scaled_[i] > p.max / p.scale) return true;
    }
    return false;
  }

  // --- ranges -------------------------------------------------------------------------------------------------------

  void hold(std::size_t i) { problem_.SetParameterBlockConstant(&scaled_[i]); }

  bool is_given(std::size_t i) const {
    const auto& held = task_.options.held;
    return std::any_of(held.begin(), held.end(), [&](const auto& one) { return one.first == static_cast<int>(i); });
  }

  /// A parameter that a shorter window, or another fit, left at a bound is held there at first.
  void hold_at_bounds() {
    if (effort_.iterations == 0 && task_.options.from == nullptr) return;
    for (std::size_t i = 0; i < parameters().size(); ++i) {
      const Parameter& p = parameters()[i];
      if (scaled_[i] * p.scale > p.min && scaled_[i] * p.scale < p.max) continue;
      held_[i] = 1;
      hold(i);
    }
  }

  /// Holds parameters outside of their ranges at the bound. False if there are none.
  bool hold_what_left() {
    bool any = false;
    for (std::size_t i = 0; i < parameters().size(); ++i) {
      const Parameter& p = parameters()[i];
      const double kept = std::clamp(scaled_[i], p.min / p.scale, p.max / p.scale);
      if (kept == scaled_[i] || is_given(i)) continue;
      scaled_[i] = kept;
      held_[i] = 1;
      hold(i);
      any = true;
    }
    return any;
  }

  /// Releases parameters at bounds whose gradients point inside. False if there are none.
  bool release() {
    bool any = false;
    for (std::size_t i = 0; i < parameters().size(); ++i) {
      if (held_[i] == 0 || is_given(i)) continue;
      problem_.SetParameterBlockVariable(&scaled_[i]);
      ceres::Problem::EvaluateOptions only;
      only.parameter_blocks = {&scaled_[i]};
      std::vector<double> gradient;
      problem_.Evaluate(only, nullptr, nullptr, &gradient, nullptr);
      const bool at_min = scaled_[i] * parameters()[i].scale <= parameters()[i].min;
      if (!gradient.empty() && (at_min ? gradient[0] < 0 : gradient[0] > 0)) {
        held_[i] = 0;
        any = true;
      } else {
        hold(i);
      }
    }
    return any;
  }

  const FitTask& task_;
  const FitPoint& start_;
  double window_;
  FitEffort& effort_;
  // Blocks of the problem: Ceres changes them in place.
  std::vector<double> scaled_;
  std::vector<std::vector<double>> shifts_;
  RunsInParallel runs_;
  ceres::Problem problem_;
  std::vector<OfRun> costs_;
  std::vector<char> held_;  // parameters at bounds
};

std::string why_failed(const FitProblem& problem, const FitPoint& start) {
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const std::string why = problem.why_no_motion(r, start.parameters, start.nuisances[r]);
    if (!why.empty()) {
      return fmt::format("{} of run \"{}\" could not be computed at the start: {}", problem.run(r).computed(),
                         problem.run(r).run().name, why);
    }
  }
  return "no step from the start reduced the cost";
}

}  // namespace

Minimum minimise(const FitTask& task, const Weighting& weighting, const FitPoint& start, double window,
                 FitEffort& effort) {
  CeresFit fit(task, weighting, start, window, effort);
  const std::optional<double> cost = fit.solve();
  if (!cost) return {.point = start, .why_not = why_failed(task.problem, start)};
  Minimum out{.cost = *cost, .point = fit.point()};
  if (window == 1.0) out.computed = fit.take_runs();
  return out;
}

}  // namespace poise

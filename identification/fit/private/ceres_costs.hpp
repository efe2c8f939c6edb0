#pragma once

// The cost functions of identification/fit/private/minimise.cpp for Ceres.

#include <atomic>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <ceres/ceres.h>

#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// The residuals of one run, reduced to the columns + 1 rows of FitProblem::triangle(). Blocks: its parameters, one
/// value each, in units of their scale; then all nuisances, SI, as differences from their initial values.
class RunCost : public ceres::CostFunction {
 public:
  /// The record is fitted up to the time `until`, s, with motions of this `accuracy`, see simulate(). `evaluations`
  /// counts those of the first run. A motion that `interrupt` ends has no cost.
  RunCost(const FitProblem& problem, std::size_t run, const Record& record, double until, double accuracy,
          const Weighting& weighting, std::vector<double> nuisances, int& evaluations,
          const std::atomic<bool>* interrupt);

  /// Computes the motion at these values, unless it was computed for them the last time or the time before.
  void compute(const double* const* blocks) const;
  /// The run linearized at these values, once, if the last motion, or the one before, was computed for them.
  std::optional<LinearRun> take(const double* const* blocks);
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override;

 private:
  const FitProblem& problem_;
  std::size_t run_;
  const Record& record_;
  double until_, accuracy_;
  const Weighting& weighting_;
  std::vector<double> from_;
  int& evaluations_;
  const std::atomic<bool>* interrupt_;
  struct Point {
    std::vector<double> at;
    LinearRun linear;
    Eigen::MatrixXd triangle;
  };
  std::vector<double> values(const double* const* blocks) const;

  mutable Point last_, before_;
};

/// Computes the motions of all runs on several threads before Ceres asks for them. Ceres' own threads would add the
/// costs of the runs up in any order, so that the result would depend on them.
class RunsInParallel : public ceres::EvaluationCallback {
 public:
  explicit RunsInParallel(int jobs) : jobs_(jobs) {}

  /// `blocks` are those of the cost; both must outlive this.
  void add(const RunCost& cost, std::vector<double*> blocks) { runs_.push_back({&cost, std::move(blocks)}); }
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

 private:
  struct RunAt {
    const RunCost* cost;
    std::vector<double*> blocks;
  };
  int jobs_;
  std::vector<RunAt> runs_;
};

/// (value - mean) / standard deviation: what is known of one parameter beforehand.
class PriorCost : public ceres::SizedCostFunction<1, 1> {
 public:
  PriorCost(double mean, double deviation, double scale) : mean_(mean), deviation_(deviation), scale_(scale) {}
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override;

 private:
  double mean_, deviation_, scale_;
};

/// Stops Ceres when interrupted; when steps fail only because the integration errors of the motions exceed the decrease
/// of the cost that is left; when the next step will decrease the cost by less than `tolerance` of it; and when a step
/// that went as predicted leaves the ranges, which Ceres does not know.
class Watch : public ceres::IterationCallback {
 public:
  /// `is_start`: the result only has to be a start for a fit to more readings. `leaves_range` asks of the present
  /// values.
  Watch(const std::atomic<bool>* interrupt, bool is_start, double tolerance, std::function<bool()> leaves_range)
      : interrupt_(interrupt), is_start_(is_start), tolerance_(tolerance), leaves_range_(std::move(leaves_range)) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override;

 private:
  bool converges(const ceres::IterationSummary& step, double predicted);

  const std::atomic<bool>* interrupt_;
  bool is_start_;
  double tolerance_;
  std::function<bool()> leaves_range_;
  double cost_ = 0.0;       // at the point reached
  int idle_ = 0;            // successive steps that failed by no more than these errors
  double predicted_ = 0.0;  // decrease of the cost by the step before; 0 if there was none or it failed
};

}  // namespace poise

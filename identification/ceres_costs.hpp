#pragma once

// The cost functions of identification/fit.cpp for Ceres. Private to this folder.

#include <atomic>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <ceres/ceres.h>

#include "identification/fit_problem.hpp"

namespace poise {

/// The residuals of one run, reduced to the columns + 1 rows of FitProblem::triangle(). Blocks: its parameters, one
/// value each, in units of their scale; then all nuisances, SI, as differences from their initial values.
class RunCost : public ceres::CostFunction {
 public:
  /// The record is fitted up to the time `until`, s. `evaluations` counts those of the first run.
  RunCost(const FitProblem& problem, std::size_t run, const Record& record, double until, const Weighting& weighting,
          std::vector<double> nuisances, int& evaluations);

  /// Computes the motion at these values, unless it was computed for them the last time.
  void compute(const double* const* blocks) const;
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override;

 private:
  const FitProblem& problem_;
  std::size_t run_;
  const Record& record_;
  double until_;
  const Weighting& weighting_;
  std::vector<double> from_;
  int& evaluations_;
  mutable std::vector<double> at_;
  mutable Eigen::MatrixXd triangle_;
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

/// Stops Ceres when interrupted, and when steps fail only because the integration errors of the motions exceed the
/// decrease of the cost that is left.
class Watch : public ceres::IterationCallback {
 public:
  /// `is_start`: the result only has to be a start for a fit to more readings.
  Watch(const std::atomic<bool>* interrupt, bool is_start) : interrupt_(interrupt), is_start_(is_start) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override;

 private:
  const std::atomic<bool>* interrupt_;
  bool is_start_;
  int idle_ = 0;  // successive steps that failed by no more than these errors
};

}  // namespace poise

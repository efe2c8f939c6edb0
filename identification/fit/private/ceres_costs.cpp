#include "identification/fit/private/ceres_costs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/parallel.hpp"

namespace poise {
namespace {

/// Relative error of the cost that follows from the integration errors of the motions.
constexpr double noise_of_cost = 1e-4;
/// Predicted relative decrease of the cost below which no further step is tried after one that failed: the decrease is
/// then smaller than what integration errors change, and shorter steps would fail, too.
constexpr double least_decrease = 1e-5;
/// The same where the result is a start for more readings.
constexpr double least_decrease_of_start = 1e-3;
/// A fit ends without its next step only where that is expected to decrease the cost by less than this part of the
/// tolerance.
constexpr double sure = 1e-2;
/// A step was as predicted if the decrease of the cost was, but for this part.
constexpr double as_predicted_within = 0.1;

}  // namespace

RunCost::RunCost(const FitProblem& problem, std::size_t run, const Record& record, double until, double accuracy,
                 const Weighting& weighting, std::vector<double> nuisances, int& evaluations,
                 const std::atomic<bool>* interrupt)
    : problem_(problem),
      run_(run),
      record_(record),
      until_(until),
      accuracy_(accuracy),
      weighting_(weighting),
      from_(std::move(nuisances)),
      evaluations_(evaluations),
      interrupt_(interrupt) {
  const RunModel& model = problem.run(run);
  for (int i = 0; i < model.unknowns(); ++i) mutable_parameter_block_sizes()->push_back(1);
  if (model.nuisances() > 0) mutable_parameter_block_sizes()->push_back(model.nuisances());
  set_num_residuals(model.columns() + 1);
}

std::vector<double> RunCost::values(const double* const* blocks) const {
  const int p = problem_.run(run_).unknowns();
  std::vector<double> at;
  for (int i = 0; i < p; ++i) at.push_back(*blocks[i]);
  for (int i = 0; i < problem_.run(run_).nuisances(); ++i) at.push_back(blocks[p][i]);
  return at;
}

std::optional<LinearRun> RunCost::take(const double* const* blocks) {
  const std::vector<double> at = values(blocks);
  for (Point* point : {&last_, &before_}) {
    if (point->at == at) return std::exchange(*point, {}).linear;
  }
  return std::nullopt;
}

void RunCost::compute(const double* const* blocks) const {
  const int p = problem_.run(run_).unknowns();
  const int m = problem_.run(run_).nuisances();
  std::vector<double> at = values(blocks);
  // Ceres asks for the residuals first and, where it accepts the point, for the Jacobian: one motion gives both. Where
  // it does not accept it, it may return to the point before.
  if (at == last_.at) return;
  std::swap(last_, before_);
  if (at == last_.at) return;
  std::vector<double> parameters(problem_.parameters().size());
  for (int i = 0; i < p; ++i) {
    const auto k = static_cast<std::size_t>(problem_.parameters_of(run_)[static_cast<std::size_t>(i)]);
    parameters[k] = *blocks[i] * problem_.parameters()[k].scale;
  }
  std::vector<double> nuisances = from_;
  for (int i = 0; i < m; ++i) nuisances[static_cast<std::size_t>(i)] += blocks[p][i];
  last_.linear = problem_.linearized(run_, parameters, nuisances, &record_, until_, accuracy_, weighting_, interrupt_);
  last_.triangle = FitProblem::triangle_of(last_.linear.rows, weighting_);
  if (run_ == 0) ++evaluations_;
  last_.at = std::move(at);
}

bool RunCost::Evaluate(const double* const* blocks, double* residuals, double** jacobians) const {
  const int p = problem_.run(run_).unknowns();
  const int m = problem_.run(run_).nuisances();
  compute(blocks);
  const Eigen::MatrixXd& triangle = last_.triangle;
  if (triangle.size() == 0) return false;
  const Eigen::Index columns = p + m;
  Eigen::Map<Eigen::VectorXd>(residuals, columns + 1) = triangle.col(columns);
  if (jacobians == nullptr) return true;
  for (int i = 0; i < p; ++i) {
    if (jacobians[i] == nullptr) continue;
    const auto k = static_cast<std::size_t>(problem_.parameters_of(run_)[static_cast<std::size_t>(i)]);
    Eigen::Map<Eigen::VectorXd>(jacobians[i], columns + 1) = problem_.parameters()[k].scale * triangle.col(m + i);
  }
  if (m > 0 && jacobians[p] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[p], columns + 1, m) =
        triangle.leftCols(m);
  }
  return true;
}

void RunsInParallel::PrepareForEvaluation(bool /*evaluate_jacobians*/, bool /*new_evaluation_point*/) {
  solvers::parallel_for(runs_.size(), {.jobs = jobs_},
                        [this](std::size_t r) { runs_[r].cost->compute(runs_[r].blocks.data()); });
}

bool PriorCost::Evaluate(const double* const* blocks, double* residuals, double** jacobians) const {
  residuals[0] = (*blocks[0] * scale_ - mean_) / deviation_;
  if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = scale_ / deviation_;
  return true;
}

// The factor between successive predicted decreases also leads to the next one, which is not computed then. For a start
// the part by which a decrease differed from its prediction may stand for it.
bool Watch::converges(const ceres::IterationSummary& step, double predicted) {
  const double next = is_start_ ? std::min(predicted * predicted / predicted_, std::abs(step.cost_change - predicted))
                                : predicted * predicted / predicted_;
  predicted_ = predicted;
  return next < (is_start_ ? 1.0 : sure) * tolerance_ * step.cost;
}

ceres::CallbackReturnType Watch::operator()(const ceres::IterationSummary& step) {
  // Not as a failure: then Ceres would not hand over the values reached.
  if (interrupt_ != nullptr && interrupt_->load()) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  if (step.iteration == 0 || step.step_is_successful) {
    cost_ = step.cost;
    idle_ = 0;
  }
  if (step.iteration == 0) {
    predicted_ = 0.0;
    return ceres::SOLVER_CONTINUE;
  }
  // Of a step that failed `cost` is what it led to: without limit where the motion could not be computed.
  const bool computed = step.cost < std::numeric_limits<double>::max();
  const double predicted =
      computed && step.relative_decrease != 0 ? std::abs(step.cost_change / step.relative_decrease) : INFINITY;
  bool done = false;
  if (step.step_is_successful) {
    const bool as_predicted = std::abs(step.relative_decrease - 1) < as_predicted_within;
    done = converges(step, predicted) || (as_predicted && leaves_range_());
  } else {
    const bool idle = computed && std::abs(step.cost_change) < noise_of_cost * cost_;
    idle_ = idle ? idle_ + 1 : 0;
    predicted_ = 0.0;
    done = idle_ >= 3 || predicted < (is_start_ ? least_decrease_of_start : least_decrease) * cost_;
  }
  return done ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
}

}  // namespace poise

#include "solvers/least_squares.hpp"

#include <cmath>
#include <deque>
#include <limits>

#include <ceres/ceres.h>

#include "solvers/stationary_system.hpp"

namespace poise::solvers {
namespace {

constexpr int dense_fit_unknowns = 100;

// The unknowns that Ceres varies; the whole system is evaluated before Ceres asks for single residuals.
class Unknowns final : public ceres::EvaluationCallback {
 public:
  explicit Unknowns(StationarySystem& system) : z_(system.start()), accepted_(z_), system_(system) {}

  void PrepareForEvaluation(bool jacobians, bool fresh) override {
    if (fresh) system_.evaluate(z_);
    if (!jacobians) return;
    // Derivatives are computed only at points that Ceres steps to.
    system_.differentiate();
    accepted_ = z_;
    error_ = system_.error();
  }

  double* at(int column) { return &z_[column]; }
  const std::vector<double>& accepted() const { return accepted_; }
  double error() const { return error_; }

 private:
  std::vector<double> z_, accepted_;
  StationarySystem& system_;
  double error_ = std::numeric_limits<double>::infinity();
};

// One residual; each of its unknowns is a block of its own, which keeps the Jacobian sparse.
class Residual final : public ceres::CostFunction {
 public:
  Residual(const StationarySystem& system, int row) : system_(system), row_(row) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->assign(system.first_of(row + 1) - system.first_of(row), 1);
  }

  bool Evaluate(double const* const*, double* residual, double** jacobians) const override {
    residual[0] = system_.residual(row_);
    const int first = system_.first_of(row_);
    for (int e = first; jacobians != nullptr && e < system_.first_of(row_ + 1); ++e) {
      if (jacobians[e - first] != nullptr) *jacobians[e - first] = system_.slope(e);
    }
    return std::isfinite(residual[0]);
  }

 private:
  const StationarySystem& system_;
  int row_;
};

class Watch final : public ceres::IterationCallback {
 public:
  Watch(const Unknowns& unknowns, const SearchOptions& options, SearchResult& result)
      : unknowns_(unknowns), options_(options), result_(result) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    result_.iterations = summary.iteration;
    result_.interrupted = options_.interrupt != nullptr && options_.interrupt->load();
    const bool done = result_.interrupted || unknowns_.error() <= options_.tolerance;
    return done ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const Unknowns& unknowns_;
  const SearchOptions& options_;
  SearchResult& result_;
};

ceres::Solver::Options settings_for(int unknowns, const SearchOptions& options) {
  ceres::Solver::Options settings;
  settings.linear_solver_type = unknowns <= dense_fit_unknowns ? ceres::DENSE_QR : ceres::SPARSE_NORMAL_CHOLESKY;
  // The programs are linked without CHOLMOD, Ceres' own choice (without_cholmod.cpp).
  settings.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  settings.logging_type = ceres::SILENT;
  settings.max_num_iterations = options.iterations;
  // Little damping, so that steps are nearly Newton's, and non-monotonic steps: the valleys are narrow and curved.
  settings.min_lm_diagonal = 1e-12;
  settings.use_nonmonotonic_steps = true;
  settings.max_num_consecutive_invalid_steps = 20;
  // Ends the search at a local minimum that is not zero; near a solution the sum still decreases by a share of itself
  // in every step.
  settings.function_tolerance = 1e-8;
  settings.parameter_tolerance = 0.0;
  settings.gradient_tolerance = 0.0;
  return settings;
}

std::string in_words(const ceres::Solver::Summary& summary, const SearchResult& result) {
  if (result.interrupted) return "Ceres: interrupted";
  if (result.claims_success) return "Ceres: every residual below the tolerance";
  switch (summary.termination_type) {
    case ceres::NO_CONVERGENCE:
      return "Ceres: iteration limit";
    case ceres::CONVERGENCE:
      return "Ceres: a local minimum of the residuals that is not zero";
    default:
      return "Ceres: no step makes further progress";
  }
}

}  // namespace

SearchResult solve_with_least_squares(const Problem& problem, const std::vector<double>& start,
                                      const SearchOptions& options, const std::vector<int>& rows) {
  StationarySystem system(problem, start, rows);
  Unknowns unknowns(system);
  std::deque<Residual> residuals;
  ceres::Problem::Options parts;
  parts.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  parts.disable_all_safety_checks = true;
  parts.evaluation_callback = &unknowns;
  ceres::Problem squares(parts);
  for (int row = 0; row < system.size(); ++row) {
    std::vector<double*> blocks;
    for (int e = system.first_of(row); e < system.first_of(row + 1); ++e)
      blocks.push_back(unknowns.at(system.column_of(e)));
    // A row without variables cannot be improved, but counts in the error.
    if (!blocks.empty()) squares.AddResidualBlock(&residuals.emplace_back(system, row), nullptr, blocks);
  }
  SearchResult result;
  ceres::Solver::Options settings = settings_for(system.size(), options);
  Watch watch(unknowns, options, result);
  settings.callbacks.push_back(&watch);
  ceres::Solver::Summary summary;
  ceres::Solve(settings, &squares, &summary);
  result.x = system.x_of(unknowns.accepted());
  result.multipliers = system.multipliers_of(unknowns.accepted());
  result.evaluations = system.evaluations();
  result.claims_success = !result.interrupted && unknowns.error() <= options.tolerance;
  result.status = in_words(summary, result);
  return result;
}

}  // namespace poise::solvers

#include "benchmarks/numeric_fit.hpp"

#include <cmath>
#include <memory>

#include <ceres/ceres.h>

namespace poise::benchmarks {
namespace {

/// Nuisances are given in this unit from where they began, plus one: rad, and rad/s.
constexpr double angle_unit = 5e-3;
constexpr double rate_unit = 0.17;

struct RunResiduals {
  const FitProblem& problem;
  std::size_t run;
  const Record& record;
  std::vector<double> from;  // nuisances
  double accuracy;

  bool operator()(double const* const* blocks, double* residuals) const {
    const RunModel& model = problem.run(run);
    std::vector<double> unknowns;
    for (int i = 0; i < model.unknowns(); ++i) {
      const auto k = static_cast<std::size_t>(problem.parameters_of(run)[static_cast<std::size_t>(i)]);
      unknowns.push_back(*blocks[i] * problem.parameters()[k].scale);
    }
    std::vector<double> nuisances = from;
    const int rates = model.start_is_unknown() ? model.freedoms() : 0;
    for (int i = 0; i < model.nuisances(); ++i) {
      const double unit = i < model.nuisances() - rates ? angle_unit : rate_unit;
      nuisances[static_cast<std::size_t>(i)] += unit * (blocks[model.unknowns()][i] - 1.0);
    }
    Prediction prediction;
    model.predict(unknowns.data(), nuisances.data(), INFINITY, accuracy, false, prediction);
    if (!prediction.ok) return false;
    auto predicted = prediction.reading.begin();
    for (std::size_t k = 0; k < record.sensors.size(); ++k) {
      for (const double read : record.sensors[k].value) {
        *residuals++ = (*predicted++ - read) / problem.experiment().sensors[k].noise;
      }
    }
    return true;
  }
};

}  // namespace

NumericFit fit_numerically(const FitProblem& problem, const std::vector<Record>& records,
                           const std::vector<double>& parameters, const std::vector<std::vector<double>>& nuisances,
                           const NumericFitOptions& options) {
  std::vector<double> scaled;
  for (std::size_t i = 0; i < parameters.size(); ++i) scaled.push_back(parameters[i] / problem.parameters()[i].scale);
  std::vector<std::vector<double>> shifts;
  for (const auto& own : nuisances) shifts.emplace_back(own.size(), 1.0);
  ceres::Problem least_squares;
  ceres::NumericDiffOptions differences;
  differences.relative_step_size = options.relative_step;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& model = problem.run(r);
    auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<RunResiduals, ceres::CENTRAL>>(
        new RunResiduals{problem, r, records[r], nuisances[r], options.accuracy}, ceres::TAKE_OWNERSHIP, differences);
    std::vector<double*> blocks;
    for (const int p : problem.parameters_of(r)) {
      cost->AddParameterBlock(1);
      blocks.push_back(&scaled[static_cast<std::size_t>(p)]);
    }
    if (model.nuisances() > 0) {
      cost->AddParameterBlock(model.nuisances());
      blocks.push_back(shifts[r].data());
    }
    cost->SetNumResiduals(static_cast<int>(records[r].count()));
    least_squares.AddResidualBlock(cost.release(), nullptr, blocks);
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.logging_type = ceres::SILENT;
  solver.max_num_iterations = 60;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = 1e-14;
  solver.gradient_tolerance = 1e-12;
  solver.initial_trust_region_radius = 1e6;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &least_squares, &summary);
  NumericFit out;
  out.converged = summary.termination_type == ceres::CONVERGENCE;
  out.iterations = static_cast<int>(summary.iterations.size());
  for (std::size_t i = 0; i < scaled.size(); ++i) out.parameters.push_back(scaled[i] * problem.parameters()[i].scale);
  return out;
}

}  // namespace poise::benchmarks

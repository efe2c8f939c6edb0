#include "identification/fit/private/linear_fit.hpp"

#include <utility>

#include "solvers/linear_algebra.hpp"
#include "solvers/parallel.hpp"

namespace poise {
namespace {

Eigen::MatrixXd full_triangle_of(const LinearRun& run) {
  Eigen::MatrixXd rows = run.rows;
  if (rows.size() == 0) return {};
  if (rows.rows() < rows.cols()) rows.conservativeResizeLike(Eigen::MatrixXd::Zero(rows.cols(), rows.cols()));
  return solvers::triangular_factor(rows);
}

}  // namespace

LinearFit linearize(const FitTask& task, const Weighting& weighting, Minimum& at) {
  const FitProblem& problem = task.problem;
  const FitPoint& point = at.point;
  std::vector<std::optional<LinearRun>> computed = std::exchange(at.computed, {});
  computed.resize(problem.runs());
  LinearFit out;
  out.runs.resize(problem.runs());
  std::vector<Eigen::MatrixXd> triangles(problem.runs());
  solvers::parallel_for(problem.runs(), {.jobs = task.options.jobs}, [&](std::size_t r) {
    out.runs[r] = computed[r] ? std::move(*computed[r])
                              : problem.linearized(r, point.parameters, point.nuisances[r], &task.records[r], INFINITY,
                                                   problem.accuracy(r), weighting);
    triangles[r] = full_triangle_of(out.runs[r]);
  });
  out.identifiability = assess(problem, point.parameters, point.nuisances, triangles, weighting);
  if (out.identifiability.ok) {
    out.errors = standard_errors(problem, out.identifiability.covariance, out.runs, weighting);
  }
  return out;
}

Residuals residuals_in(const LinearRun& run) {
  Residuals e;
  for (std::size_t k = 0; k + 1 < run.first.size(); ++k) {
    const auto own = run.residuals(k);
    e.emplace_back(own.begin(), own.end());
  }
  return e;
}

}  // namespace poise

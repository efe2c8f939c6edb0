#include "identification/fit/private/following_nuisances.hpp"

#include <algorithm>
#include <utility>

#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

/// Accuracy of the motions, which only have to choose among starts.
constexpr double accuracy_of_choice = 1e-5;

}  // namespace

Minimum with_following_nuisances(const FitTask& task, const Weighting& weighting, const FitPoint& from,
                                 std::vector<double> parameters, const Frequencies& frequencies) {
  const FitProblem& problem = task.problem;
  const std::vector<double> there = frequencies.at(parameters);
  const double faster = there.empty() ? 1.0 : there.front() / frequencies.modes().front().frequency;
  Minimum out{.cost = 0.0, .point = {std::move(parameters), from.nuisances}};
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& run = problem.run(r);
    std::vector<double>& nuisances = out.point.nuisances[r];
    if (run.start_is_unknown()) {
      std::for_each(nuisances.end() - run.freedoms(), nuisances.end(), [&](double& rate) { rate *= faster; });
    }
    const Eigen::MatrixXd R =
        problem.triangle(r, out.point.parameters, nuisances, &task.records[r], INFINITY, accuracy_of_choice, weighting);
    if (R.size() == 0) return {.point = std::move(out.point)};
    const Eigen::Index n = run.nuisances();
    out.cost += R.col(R.cols() - 1).tail(R.rows() - n).squaredNorm() / 2;
    if (n == 0) continue;
    const Eigen::VectorXd step =
        solvers::minimum_norm_solution<double>(R.topLeftCorner(n, n), R.col(R.cols() - 1).head(n));
    for (Eigen::Index i = 0; i < n; ++i) nuisances[static_cast<std::size_t>(i)] -= step[i];
  }
  return out;
}

}  // namespace poise

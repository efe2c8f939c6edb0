#include "identification/fit/private/run_influence.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include "identification/fit/private/describe_fit.hpp"
#include "identification/fit/projection.hpp"
#include "identification/fit/some_runs.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/not_a_number.hpp"

namespace poise {
namespace {

/// Disagreement to first order from which a run is examined.
constexpr double suspicious_share = 3.0;
/// Where errors follow from the scatter of n runs, the one that alone makes it has the disagreement sqrt(n - 1) to
/// first order, however far it is off. Those with so large a part of that are examined, at most so many: each is a fit.
constexpr double alone_from = 0.7;
constexpr std::size_t most_examined = 2;
/// The sum of squares that is left to a fit without a run, relative: far below what moves an estimate by its error.
constexpr double ends_at = 1e-5;
/// Where the other runs scatter by more than their residuals explain, no more than their number says how much.
constexpr double chance_by_scatter = 5e-3;

/// By how much an error of so many degrees of freedom has to be larger for `disagrees_from` to have that probability.
double wider(double degrees, double chance) {
  if (!(degrees >= 1.0)) return INFINITY;
  return quantile(complement(boost::math::students_t(std::min(degrees, 1e6)), chance / 2)) / disagrees_from;
}

std::vector<std::size_t> doubtful(const FitProblem& problem, const Fit& fitted) {
  const std::vector<double>& size = fitted.errors.disagreement;
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  const bool stated = fitted.weighting.loss != Loss::student &&
                      std::all_of(sensors.begin(), sensors.end(), [](const Sensor& s) { return s.noise_known; });
  const bool by_residuals = fitted.status == FitStatus::misfit || fitted.errors.leading == StandardErrors::Kind::runs ||
                            (!stated && fitted.errors.leading != StandardErrors::Kind::white);
  std::vector<std::size_t> order(size.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return size[a] > size[b]; });
  const double alone = alone_from * std::sqrt(static_cast<double>(size.size()) - 1);
  const auto calm = [&](double from) {
    return std::find_if(order.begin(), order.end(), [&](std::size_t r) { return !(size[r] > from); });
  };
  const auto most = order.begin() + static_cast<std::ptrdiff_t>(std::min(order.size(), most_examined));
  order.erase(by_residuals ? std::min(calm(alone), most) : calm(suspicious_share), order.end());
  return order;
}

/// The part of each estimate's variance without the run by which those with it differ.
Eigen::VectorXd share(const FitProblem& problem, const LinearRun& run, std::size_t r, const Eigen::MatrixXd& V) {
  const Eigen::Index nuisances = problem.run(r).nuisances();
  const std::vector<int>& used = problem.parameters_of(r);
  const Eigen::MatrixXd a =
      unexplained(run.rows.middleCols(nuisances, problem.run(r).unknowns()), run.rows.leftCols(nuisances));
  const auto count = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(std::max(a.rows(), count), count);
  rows.topRows(a.rows()) = a;
  const Eigen::MatrixXd R = solvers::triangular_factor(rows);
  const Eigen::MatrixXd moved = R * V(used, Eigen::all);
  const Eigen::MatrixXd seen = Eigen::MatrixXd::Identity(count, count) + moved(Eigen::all, used) * R.transpose();
  return moved.cwiseProduct(seen.ldlt().solve(moved)).colwise().sum().transpose();
}

void examine(const FitProblem& problem, const std::vector<Record>& records, const LinearRun& run,
             const FitOptions& options, std::size_t r, Fit& fitted) {
  std::vector<std::size_t> kept(problem.runs());
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(r));
  const SomeRuns others(problem, records, kept);
  const Fit seed = others.seed(fitted);
  FitOptions with;
  with.from = &seed;
  with.function_tolerance = ends_at;
  with.jobs = options.jobs;
  with.interrupt = options.interrupt;
  const Fit without = fit(others.problem(), others.records(), with);
  fitted.check_evaluations += without.evaluations + without.check_evaluations;
  if (!without.usable() || !without.identifiability.ok) return;
  const auto count = static_cast<Eigen::Index>(fitted.parameters.size());
  Eigen::MatrixXd V = Eigen::MatrixXd::Zero(count, count);
  V(others.places(), others.places()) = without.identifiability.covariance;
  const Eigen::VectorXd part = share(problem, run, r, V);
  double degrees = 0.0;
  for (const NoiseTest& test : without.errors.sensors) degrees += std::fmax(0.0, test.degrees);
  const double tail = 2 * cdf(complement(boost::math::normal(), disagrees_from));
  std::vector<double> change(fitted.parameters.size(), not_a_number);
  double largest = 0.0;
  for (std::size_t i = 0; i < others.places().size(); ++i) {
    const std::size_t p = others.places()[i];
    const auto at = static_cast<Eigen::Index>(p);
    if (!std::isfinite(without.identifiability.standard_error[i]) ||
        !std::isfinite(fitted.identifiability.standard_error[p]) || !(V(at, at) > 0)) {
      continue;
    }
    change[p] = without.parameters[i] - fitted.parameters[p];
    const double scatter = without.errors.runs[i] * wider(without.errors.runs_degrees[i], chance_by_scatter);
    const double error = std::fmax(without.errors.serial[i] * wider(degrees, tail), scatter);
    const double expected = error * std::sqrt(part[at] / V(at, at));
    if (expected > 0) largest = std::max(largest, std::abs(change[p]) / expected);
  }
  fitted.errors.without_run[r] = change;
  fitted.errors.disagreement[r] = largest;
}

}  // namespace

void examine_runs(const FitProblem& problem, const std::vector<Record>& records, const std::vector<LinearRun>& linear,
                  const FitOptions& options, int most, Fit& fitted) {
  if (problem.runs() < 3) return;
  for (const std::size_t r : doubtful(problem, fitted)) {
    if (options.interrupt != nullptr && options.interrupt->load()) return;
    if (fitted.check_evaluations >= most) {
      leave_out(fitted, "fits without a run");
      return;
    }
    if (options.progress) options.progress(fmt::format("fitting without run \"{}\"", problem.run(r).run().name));
    examine(problem, records, linear[r], options, r, fitted);
  }
}

}  // namespace poise

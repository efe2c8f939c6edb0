#include "solvers/nonlinear_program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <nlopt.h>

#include "solvers/nlopt_status.hpp"

namespace poise::solvers {
namespace {

constexpr double none = 1e6;  // of f and of each constraint, where there are no values

/// NLopt asks for f and for the constraints at one point one after the other: the last evaluation is kept.
struct ProgramSearch {
  const ProgramFunction& function;
  const NonlinearProgramOptions& options;
  nlopt_opt handle = nullptr;
  Eigen::VectorXd at{};
  ProgramAt values{};
  bool has_values = false;
  Eigen::Index below = 0, equal = 0;
  NonlinearProgramResult best{};

  void go(unsigned n, const double* x) {
    const Eigen::Map<const Eigen::VectorXd> here(x, n);
    if (at.size() == here.size() && at == here) return;
    at = here;
    if (options.interrupt != nullptr && options.interrupt->load()) nlopt_force_stop(handle);
    ++best.evaluations;
    has_values = at.allFinite() && function(at, values);
    if (!has_values) return;
    double worst = 0.0;
    if (below > 0) worst = std::max(worst, values.below.maxCoeff());
    if (equal > 0) worst = std::max(worst, values.equal.cwiseAbs().maxCoeff());
    const bool keeps = worst <= options.constraint_tolerance;
    if (keeps && (!best.keeps || values.value < best.value)) {
      best.x = at;
      best.value = values.value;
      best.keeps = true;
    }
  }
};

double objective_of_program(unsigned n, const double* x, double* gradient, void* data) {
  auto& search = *static_cast<ProgramSearch*>(data);
  search.go(n, x);
  if (gradient != nullptr) {
    for (unsigned i = 0; i < n; ++i) gradient[i] = search.has_values ? search.values.gradient[i] : 0.0;
  }
  return search.has_values ? search.values.value : none;
}

void put_rows(const ProgramSearch& search, const Eigen::VectorXd& value, const Eigen::MatrixXd& by, unsigned m,
              double* result, unsigned n, double* gradient) {
  for (unsigned k = 0; k < m; ++k) {
    result[k] = search.has_values ? value[k] : none;
    if (gradient == nullptr) continue;
    for (unsigned i = 0; i < n; ++i) gradient[k * n + i] = search.has_values ? by(k, i) : 0.0;
  }
}

void rows_below(unsigned m, double* result, unsigned n, const double* x, double* gradient, void* data) {
  auto& search = *static_cast<ProgramSearch*>(data);
  search.go(n, x);
  put_rows(search, search.values.below, search.values.below_by, m, result, n, gradient);
}

void rows_equal(unsigned m, double* result, unsigned n, const double* x, double* gradient, void* data) {
  auto& search = *static_cast<ProgramSearch*>(data);
  search.go(n, x);
  put_rows(search, search.values.equal, search.values.equal_by, m, result, n, gradient);
}

nlopt_algorithm algorithm_of(ProgramMethod method) {
  switch (method) {
    case ProgramMethod::slsqp:
      return NLOPT_LD_SLSQP;
    case ProgramMethod::mma:
      return NLOPT_LD_MMA;
    case ProgramMethod::auglag:
      return NLOPT_AUGLAG;
  }
  return NLOPT_LD_SLSQP;
}

}  // namespace

NonlinearProgramResult nonlinear_program(const ProgramFunction& function, const Eigen::VectorXd& start,
                                         const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                         const NonlinearProgramOptions& options) {
  const auto n = static_cast<unsigned>(start.size());
  ProgramSearch search{function, options};
  std::vector<double> x(start.data(), start.data() + n);
  for (unsigned i = 0; i < n; ++i) x[i] = std::clamp(x[i], lower[i], upper[i]);
  search.best.x = Eigen::Map<const Eigen::VectorXd>(x.data(), n);
  ProgramAt first;
  if (!function(search.best.x, first)) {
    search.best.status = "no values at the start";
    return search.best;
  }
  search.below = first.below.size();
  search.equal = first.equal.size();
  search.best.value = first.value;
  using OwnedOpt = std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)>;
  const OwnedOpt handle(nlopt_create(algorithm_of(options.method), n), nlopt_destroy);
  search.handle = handle.get();
  nlopt_set_min_objective(handle.get(), objective_of_program, &search);
  nlopt_set_lower_bounds(handle.get(), lower.data());
  nlopt_set_upper_bounds(handle.get(), upper.data());
  const std::vector<double> tolerances(static_cast<std::size_t>(std::max(search.below, search.equal)),
                                       options.constraint_tolerance);
  if (search.below > 0) {
    nlopt_add_inequality_mconstraint(handle.get(), static_cast<unsigned>(search.below), rows_below, &search,
                                     tolerances.data());
  }
  if (search.equal > 0) {
    nlopt_add_equality_mconstraint(handle.get(), static_cast<unsigned>(search.equal), rows_equal, &search,
                                   tolerances.data());
  }
  nlopt_set_maxeval(handle.get(), options.evaluations);
  nlopt_set_xtol_rel(handle.get(), options.step_tolerance);
  const std::vector<double> least(n, options.step_tolerance);
  nlopt_set_xtol_abs(handle.get(), least.data());
  OwnedOpt local(nullptr, nlopt_destroy);
  if (options.method == ProgramMethod::auglag) {
    local = OwnedOpt(nlopt_create(NLOPT_LD_LBFGS, n), nlopt_destroy);
    nlopt_set_xtol_rel(local.get(), options.step_tolerance);
    nlopt_set_local_optimizer(handle.get(), local.get());
  }
  double value = 0.0;
  const nlopt_result status = nlopt_optimize(handle.get(), x.data(), &value);
  search.best.status = "NLopt: " + nlopt_in_words(status);
  return search.best;
}

}  // namespace poise::solvers

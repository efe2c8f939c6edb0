#include "solvers/nlopt.hpp"

#include <algorithm>
#include <limits>
#include <memory>

#include <nlopt.h>

#include "solvers/nlopt_status.hpp"

namespace poise::solvers {
namespace {

struct Search {
  const std::function<double(const double*)>* f;
  const NloptOptions* options;
  nlopt_opt handle;
  NloptResult result;

  double evaluate(unsigned n, const double* x) {
    if (options->interrupt != nullptr && options->interrupt->load()) {
      result.interrupted = true;
      nlopt_force_stop(handle);
    }
    const double value = (*f)(x);
    ++result.evaluations;
    if (value < result.value) {
      result.value = value;
      result.x.assign(x, x + n);
    }
    return value;
  }
};

double objective(unsigned n, const double* x, double*, void* search) {
  return static_cast<Search*>(search)->evaluate(n, x);
}

}  // namespace

NloptResult minimise_with_nlopt(const std::function<double(const double*)>& f, const std::vector<double>& lower,
                                const std::vector<double>& upper, std::vector<double> start,
                                const NloptOptions& options) {
  const std::size_t n = start.size();
  for (std::size_t i = 0; i < n; ++i) start[i] = std::clamp(start[i], lower[i], upper[i]);
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> handle(
      nlopt_create(NLOPT_LN_SBPLX, static_cast<unsigned>(n)), nlopt_destroy);
  Search search{&f, &options, handle.get(), {}};
  search.result.x = start;
  search.result.value = std::numeric_limits<double>::infinity();
  nlopt_set_min_objective(handle.get(), objective, &search);
  nlopt_set_lower_bounds(handle.get(), lower.data());
  nlopt_set_upper_bounds(handle.get(), upper.data());
  nlopt_set_maxeval(handle.get(), options.evaluations);
  nlopt_set_stopval(handle.get(), options.good_enough);
  nlopt_set_xtol_rel(handle.get(), options.step_tolerance);
  const std::vector<double> least(n, options.step_tolerance);
  nlopt_set_xtol_abs(handle.get(), least.data());
  double value = 0.0;
  const nlopt_result status = nlopt_optimize(handle.get(), start.data(), &value);
  search.result.good_enough = search.result.value <= options.good_enough;
  search.result.status = "NLopt: " + nlopt_in_words(status);
  return search.result;
}

}  // namespace poise::solvers

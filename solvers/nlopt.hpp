#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

namespace poise::solvers {

struct NloptOptions {
  int evaluations = 20000;       ///< of the objective, at most
  double good_enough = 0.0;      ///< ends the search where f <= good_enough
  double step_tolerance = 1e-9;  ///< ends it where all steps are shorter than that times max(|x|, 1)
  const std::atomic<bool>* interrupt = nullptr;
};

struct NloptResult {
  std::vector<double> x;  ///< the best point found, within the bounds
  double value = 0.0;     ///< f(x)
  int evaluations = 0;
  bool good_enough = false;
  bool interrupted = false;
  std::string status;  ///< as NLopt reports it
};

/// Searches a local minimum of f(x) over  lower <= x <= upper  without derivatives, by SBPLX (Rowan's
/// subspace-searching simplex) of NLopt. `start` is moved into the bounds. f must be finite; it may have kinks.
NloptResult minimise_with_nlopt(const std::function<double(const double*)>& f, const std::vector<double>& lower,
                                const std::vector<double>& upper, std::vector<double> start,
                                const NloptOptions& options = {});

}  // namespace poise::solvers

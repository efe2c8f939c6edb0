#include "solvers/restarts.hpp"

#include <cmath>
#include <random>

namespace poise::solvers {

Restarts::Restarts(NewtonSystem& system, LoopClosing& closing, StationarySearch& stationary, Descent& descent)
    : at_(system), closing_(closing), stationary_(stationary), descent_(descent) {}

void Restarts::run(bool by_descent) {
  const int most = at_.variables() <= at_.options.restarts_up_to ? at_.options.restarts : 0;
  for (int k = 0; k < most && at_.gave_up(); ++k) {
    const double reach = M_PI * (k + 1) / most;
    std::uniform_real_distribution<double> uniform(-reach, reach);
    displaced_ = at_.start;
    for (double& x : displaced_) x += uniform(at_.random);
    at_.begin_at(displaced_);
    NewtonEnd end = NewtonEnd::not_closed;
    if (by_descent)
      end = descent_.run();
    else if (closing_.run())
      end = stationary_.run();
    at_.note(end == NewtonEnd::not_closed ? NewtonEnd::stalled : end);
    at_.result.restarted = end == NewtonEnd::converged;
  }
}

}  // namespace poise::solvers

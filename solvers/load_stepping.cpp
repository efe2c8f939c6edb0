#include "solvers/load_stepping.hpp"

#include <algorithm>

namespace poise::solvers {

LoadStepping::LoadStepping(NewtonSystem& system, LoopClosing& closing, StationarySearch& stationary, Descent& descent)
    : at_(system), closing_(closing), stationary_(stationary), descent_(descent) {}

void LoadStepping::run() {
  at_.begin_at(at_.start);
  if (!closing_.run() || !at_.linearize()) return;
  at_.load = at_.residual;
  reached_ = at_.now->x;
  double release = at_.options.first_release;
  for (double let_go = 0.0; let_go < 1.0;) {
    const double next = std::min(1.0, let_go + release);
    at_.share = 1.0 - next;
    at_.begin_at(reached_);
    const NewtonEnd end = at_.seeks_minimum() ? descent_.run_from_closed() : stationary_.run();
    at_.note(end);
    if (end == NewtonEnd::interrupted || end == NewtonEnd::unbounded) break;
    if (end == NewtonEnd::converged) {
      let_go = next;
      reached_ = at_.now->x;
      release *= 2.0;
    } else {
      release *= 0.25;
      if (release < at_.options.least_release) break;
    }
  }
  at_.share = 0.0;
  at_.result.load_stepped = at_.result.end == NewtonEnd::converged;
  at_.evaluate(*at_.now);
}

}  // namespace poise::solvers

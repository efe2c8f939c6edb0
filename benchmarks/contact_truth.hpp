#pragma once

#include <vector>

#include "benchmarks/contact_work.hpp"

namespace poise::benchmarks {

/// The exact states of a problem, by the energy of its one freedom: quadratures between impacts, none of Poise's
/// equations.
struct ContactTruth {
  std::vector<ContactState> states;
  double travel = 0.0, speed = 0.0;  ///< from the start to the first impact, and there: what errors are relative to
  int impacts = 0;                   ///< until the last state, or until bounces have ended
};
ContactTruth truth_of(const ContactProblem& problem);

}  // namespace poise::benchmarks

#include "comparison/tally.hpp"

namespace poise::comparison {

void Tally::does_not_apply(const std::string& why) {
  cell_.applies = false;
  cell_.why = why;
}

void Tally::add(const Equilibrium& equilibrium, const Verdict& verdict) {
  ++cell_.starts;
  switch (verdict.kind) {
    case Verdict::Kind::converged:
      add_converged(equilibrium, verdict);
      return;
    case Verdict::Kind::false_claim:
      // The worst that can happen: its reason is the one kept.
      if (cell_.false_claims++ == 0) cell_.why = verdict.why;
      break;
    case Verdict::Kind::denied_by_check:
      ++cell_.denied_by_check;
      break;
    case Verdict::Kind::failed:
      break;
  }
  if (cell_.why.empty()) cell_.why = verdict.why;
}

Cell Tally::cell() const {
  Cell cell = cell_;
  cell.iterations = median(iterations_);
  cell.microseconds = median(microseconds_);
  return cell;
}

void Tally::add_converged(const Equilibrium& equilibrium, const Verdict& verdict) {
  ++cell_.converged;
  iterations_.push_back(equilibrium.iterations);
  microseconds_.push_back(equilibrium.microseconds);
  // In a case without an answer: how the method ended.
  if (!verdict.why.empty() && cell_.why.empty()) cell_.why = verdict.why;
  // A start that is said to lock has no error; the largest of the others stays.
  if (verdict.error && (!cell_.error || *verdict.error > *cell_.error)) {
    cell_.error = verdict.error;
    cell_.allowed = verdict.allowed;
  }
}

}  // namespace poise::comparison

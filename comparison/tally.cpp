#include "comparison/tally.hpp"

namespace poise::comparison {

void Tally::refuse(const std::string& why) {
  cell_.refused = true;
  cell_.why = why;
}

void Tally::give_up(const std::string& why) {
  ++cell_.starts;
  if (cell_.why.empty()) cell_.why = why;
}

void Tally::add(const Equilibrium& rest, const Verdict& verdict) {
  ++cell_.starts;
  switch (verdict.kind) {
    case Verdict::Kind::arrived:
      arrive(rest, verdict);
      return;
    case Verdict::Kind::inexact:
      ++cell_.inexact;
      break;
    case Verdict::Kind::wrong:
      // What is worst is what has to be told.
      if (cell_.wrong++ == 0) cell_.why = verdict.why;
      break;
    case Verdict::Kind::denied:
      ++cell_.denied;
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

void Tally::arrive(const Equilibrium& rest, const Verdict& verdict) {
  ++cell_.arrived;
  iterations_.push_back(rest.iterations);
  microseconds_.push_back(rest.microseconds);
  // Where nothing was to be found, this is how the method put it.
  if (!verdict.why.empty() && cell_.why.empty()) cell_.why = verdict.why;
  // A start that is said to lock has no error; the largest of the others stays.
  if (verdict.error && (!cell_.error || *verdict.error > *cell_.error)) {
    cell_.error = verdict.error;
    cell_.allowed = verdict.allowed;
  }
}

}  // namespace poise::comparison

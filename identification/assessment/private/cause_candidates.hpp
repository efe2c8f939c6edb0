#pragma once

// What may be wrong with the records of an experiment, one thing at a time.

#include <functional>
#include <string>
#include <vector>

#include "identification/experiment/experiment.hpp"

namespace poise {

/// The least and the most part of the shortest run that a delay may take.
inline constexpr double most_delay_part = 0.05;

struct CauseCandidate {
  std::string words;
  std::function<std::string(double)> cure;  ///< by the number
  /// Changes an experiment to what it is if this is so, with the number.
  std::function<void(Experiment&, double)> change;
  /// The number, where it is not known: where its search begins, its range, and the step of its differences; a step of
  /// 0: there is none.
  double start = 0.0, least = 0.0, most = 0.0, step = 0.0;
  /// Leaves out the beginning or the end of the records.
  enum class LeavesOut { nothing, beginning, end } leaves_out = LeavesOut::nothing;
  bool shows_late = false;  ///< over parts of the records it explains no more than others do

  bool has_number() const { return step > 0; }
};

/// Candidates for an experiment with measured runs, the likeliest first. `worst`: indices of the runs, by their
/// residuals.
std::vector<CauseCandidate> cause_candidates(const Experiment& experiment, const std::vector<std::size_t>& worst);

}  // namespace poise

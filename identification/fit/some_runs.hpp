#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// An experiment with some of the runs of another, to be fitted to these alone. Not to be moved: the problem refers to
/// the experiment.
class SomeRuns {
 public:
  /// `runs`: indices into those of `whole`, ascending; `records` one for each run of `whole`.
  SomeRuns(const FitProblem& whole, const std::vector<Record>& records, std::vector<std::size_t> runs);
  SomeRuns(const SomeRuns&) = delete;
  SomeRuns& operator=(const SomeRuns&) = delete;

  const FitProblem& problem() const { return *problem_; }
  const std::vector<Record>& records() const { return experiment_.records; }
  /// Per parameter of problem(), the one of `whole` that has its name.
  const std::vector<std::size_t>& places() const { return places_; }
  /// What FitOptions::from needs: the values that a fit of `whole` found.
  Fit seed(const Fit& of_whole) const;

 private:
  std::vector<std::size_t> runs_;
  Experiment experiment_;
  std::optional<FitProblem> problem_;
  std::vector<std::size_t> places_;
};

}  // namespace poise

#pragma once

#include <cstddef>
#include <vector>

#include "solvers/random_stream.hpp"
#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/all_equilibria/private/loop_turns.hpp"
#include "statics/all_equilibria/turns.hpp"

namespace poise {

/// Searches for equilibria from random starts: the n-th is the same whatever others there are.
class StartSampler {
 public:
  /// All must outlive this.
  StartSampler(const StaticModel& model, const Turns& turns, const LoopTurns& loops,
               const AllEquilibriaOptions& options)
      : model_(model), turns_(turns), loops_(loops), options_(options), start_(model.start()) {}

  /// Where the search from a start ended, scaled coordinates; empty where it found nothing.
  std::vector<double> run(std::size_t start) const;
  /// Searches likewise from a pose, which need not be closed.
  std::vector<double> from(const std::vector<double>& pose, bool descends) const;

 private:
  // Where springs tell turns apart most poses are wound far beyond what loads can hold: the one of least energy of
  // many, or one as it comes.
  std::vector<double> likely(std::size_t start, solvers::RandomStream& random) const;
  // Travels within the mechanism's size of the start and of zero; angles all round, and where springs or stops tell
  // turns apart within `reach` of the start and of zero.
  std::vector<double> place(double reach, solvers::RandomStream& random) const;

  const StaticModel& model_;
  const Turns& turns_;
  const LoopTurns& loops_;
  const AllEquilibriaOptions& options_;
  std::vector<double> start_;
};

}  // namespace poise

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "identification/experiment/experiment.hpp"

namespace poise::judge {

/// Which unknowns of an experiment some change of the unknowns moves that changes no motion of its mechanism and no
/// reading: the null space of d alpha/dp, and of the readings' direct derivatives, at random states of every run in 50
/// digits. Runs start anywhere and sensors read angles, or forces of linear springs.
struct ExactNulls {
  int dimension = 0;
  std::vector<bool> moved;  ///< per unknown
  bool clear = true;        ///< no pivot is between 1e-40 and 1e-13 of the largest
};

ExactNulls exact_nulls(const Experiment& experiment);

/// Poise's answer for the experiment of a seed, compared with that.
struct JudgedNulls {
  int unknowns = 0, nulls = 0, moved = 0;
  bool clear = false;        ///< of the exact answer
  bool unclear = false;      ///< Poise says so
  int false_claims = 0;      ///< numbers that a null moves, and Poise says that none does
  int withheld_wrongly = 0;  ///< numbers that no null moves, and Poise says that one does
  std::string words;

  bool agrees() const { return false_claims == 0 && withheld_wrongly == 0; }
};
JudgedNulls judge_nulls(std::uint64_t seed);

}  // namespace poise::judge

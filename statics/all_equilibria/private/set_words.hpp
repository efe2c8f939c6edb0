#pragma once

// Sets of equilibria in words.

#include <cstddef>
#include <string>

#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/all_equilibria/private/enclosed_set.hpp"
#include "statics/all_equilibria/private/loop_turns.hpp"
#include "statics/all_equilibria/private/neutral_motions.hpp"

namespace poise {

/// "1 start", "3 starts".
std::string number_of(std::size_t count, const char* one, const char* many);

/// Whether a certificate is of one of a curve or more of equilibria.
bool is_neutral(const Certificate& certificate);

/// What the statement about a set depends on besides the set. All that is referred to must outlive this.
struct SetFacts {
  const StaticModel& model;
  const AllEquilibriaOptions& options;
  const NeutralMotions& neutral;
  const EnclosedSet& proof;
  const LoopTurns& loops;
  bool wants_proof = true;
  bool fixes_motions = false;  ///< the mechanism was also searched with neutral motions fixed
  bool contradicted = false;   ///< an equilibrium was found where the proof leaves none
  bool by_proof = false;       ///< a proof that was not finished found some
  bool unreached = false;      ///< the proof found some that motion does not reach
  int unproved = 0;            ///< searches that ended where no equilibrium is proved
  int close = 0;               ///< boxes that hold an equilibrium, and perhaps others next to it
  double close_within = 0.0;   ///< how near these may be to each other
};

/// EquilibriumSet::statement of a set whose other members are known.
std::string statement_of(const EquilibriumSet& set, const SetFacts& facts);

}  // namespace poise

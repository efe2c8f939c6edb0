#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/all_equilibria/private/element_peaks.hpp"
#include "statics/all_equilibria/private/loop_turns.hpp"
#include "statics/all_equilibria/private/neutral_motions.hpp"

namespace poise {

/// What a proof says of all equilibria of a mechanism.
struct EnclosedSet {
  bool applies = false;                      ///< false: nothing is proved, see why_not
  std::string why_not{};                     ///< half a sentence: "it has a slide without limits"
  std::vector<std::vector<double>> found{};  ///< scaled coordinates of solutions, each proved to be the only one near
  std::vector<UndecidedBox> undecided{};     ///< outside these, `singular` and `found` there are none
  std::vector<UndecidedBox> singular{};      ///< as EquilibriumSet::singular
  ElementPeaks peaks{};                      ///< elements without length
  std::string within{};                      ///< range of the proof, half a sentence; empty if it is the whole
  /// Where it is given, nothing is said of equilibria in which an angle whose turns count is further from the start,
  /// rad.
  std::optional<double> reach{};
  double decided = 0.0;  ///< share of the volume, in [0, 1]
  long boxes = 0;        ///< that were examined
  bool interrupted = false;
};

/// In units of AllEquilibriaOptions::work.
constexpr double work_of_a_box(int coordinates) { return static_cast<double>(coordinates) * coordinates; }

/// The equilibria that a proof is about.
struct EnclosedPart {
  /// Not those on its branch of closed poses (statics/all_equilibria/private/off_branch.hpp); null: all.
  const NeutralMotions* without_branch_of = nullptr;
  /// Ranges of coordinates in which they are sought, unbounded of others; empty: all.
  std::vector<Interval> within{};
};

/// Encloses all equilibria by branch-and-prune over boxes of coordinates in interval arithmetic
/// (statics/all_equilibria/private/box_prover.hpp), for every combination of active stops. Found places are proved up
/// to rounding of their doubles; certificates say the rest of them.
EnclosedSet enclose_equilibria(const StaticModel& model, LoopTurns& loops, const AllEquilibriaOptions& options,
                               const EnclosedPart& part = {});

using Enclosing =
    std::function<EnclosedSet(const StaticModel&, LoopTurns&, const AllEquilibriaOptions&, const EnclosedPart&)>;

/// As all_equilibria(model, options), with what a given proof says. An equilibrium that is found where the proof leaves
/// none contradicts it: then nothing is claimed.
EquilibriumSet all_equilibria(const StaticModel& model, const AllEquilibriaOptions& options, const Enclosing& enclose);

}  // namespace poise

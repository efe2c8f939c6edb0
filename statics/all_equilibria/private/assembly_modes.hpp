#pragma once

#include <functional>
#include <vector>

#include "statics/all_equilibria/private/loop_turns.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// Follows the curves of poses of all assembly modes, for `loops` that are known(). Boxes of coordinates, angles all
/// round, are narrowed by closures in interval arithmetic (statics/all_equilibria/private/box_prover.hpp) and halved
/// until they are empty, or their closed poses are functions of the freedom and a known curve passes; where none does
/// the loops are closed and the curve is followed. Boxes of 1e-3 in which loops do not close are left out, and so are
/// travels farther than LoopTurns::far_away from the start. Where `stopped` says so, or after too many boxes, the
/// curves are not known. `repeated`: as BoxProver has it.
void find_assembly_modes(const StaticModel& model, int repeated, LoopTurns& loops,
                         const std::function<bool()>& stopped);

/// Closed poses in which a mechanism cannot move though it has one freedom: rows of joints that repeat others along the
/// curve of the start are independent there, as those of three parallel cranks in crossed poses.
struct RigidPoses {
  static constexpr double apart = 0.01;  ///< rad or mechanism sizes between poses at which rows are held against others
  std::vector<std::vector<double>> poses{};  ///< scaled coordinates, within half a turn of the start
  /// There are no others: all boxes of closed poses were narrowed and halved until they are empty, hold one of these
  /// alone, or are smaller than `apart` and near a pose that moves.
  bool are_all = false;
};

/// For mechanisms with one freedom, of whose rows `repeated`, one or more, are implied by others near the start.
RigidPoses find_rigid_poses(const StaticModel& model, int repeated, const LoopTurns& loops,
                            const std::function<bool()>& stopped);

}  // namespace poise

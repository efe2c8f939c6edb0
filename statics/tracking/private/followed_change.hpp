#pragma once

#include <atomic>
#include <limits>
#include <vector>

#include "statics/tracking/tracked_equilibrium.hpp"

namespace poise {

/// A stable equilibrium followed while numbers of its scene change.
struct FollowedChange {
  bool arrived = false;
  BodyPoses poses;          ///< where it came, of bodies, then of bars
  Scene scene;              ///< there: the one wanted if it arrived
  Transition transition{};  ///< followed or snapped
};

/// Steps that a change is tried with at most.
inline constexpr int most_tries = 200;

/// Follows the equilibrium at `poses`, in which these stops of `before` act, all numbers growing in proportion: in a
/// few steps (statics/tracking/private/small_step.hpp) where nothing happens on the way, else as statics/paths/path.hpp
/// does, with snaps. `tries`: of steps, at most.
FollowedChange follow_change(const Scene& before, const Scene& after, const BodyPoses& poses,
                             const std::vector<int>& active_stops, const TrackedOptions& options,
                             int tries = most_tries);

/// How far proved steps lead (statics/tracking/private/small_step.hpp).
struct ProvedWay {
  double part = 0.0;  ///< of the change; 1: to its end
  BodyPoses poses;    ///< there
  int tries = 0;      ///< steps that were tried
};

/// Follows the same change by proved steps alone, `tries` of them at most, or until it is interrupted.
ProvedWay follow_by_steps(const Scene& before, const Scene& after, const BodyPoses& poses,
                          const std::vector<int>& active_stops, const std::atomic<bool>* interrupt,
                          int tries = most_tries);

/// The poses that a mechanism passes whose loops are kept closed by shortest steps while the numbers change, from
/// `poses` on, in `tries` steps at most. Throws InputError where they cannot be closed.
std::vector<BodyPoses> carry(const Scene& before, const Scene& after, const BodyPoses& poses,
                             int tries = std::numeric_limits<int>::max());

}  // namespace poise

#pragma once

// Where the closures and drives of a motion lose rank, in words. Private to simulate().

#include <optional>
#include <string>
#include <vector>

#include "motion/motion_model.hpp"
#include "motion/simulate.hpp"

namespace poise {

/// A pose in which the closures and the drives of a motion are nearly dependent.
struct SingularState {
  /// Smallest over largest singular value of the closures with the drives held, of those that are not always zero.
  double closeness = 1.0;
  std::string text{};         ///< " of the loop closed by "D": crank and rod are in line"
  std::vector<int> movers{};  ///< coordinates that could move there in a second way, the most first
};

/// At scaled coordinates; `rank` is that of the closures and drives, as ReducedMotion has it. Without a rank to lose,
/// and where friction or an input holds what no drive of the scene does, there is nothing to be said: closeness 1.
SingularState singular_state(const MotionModel& model, const std::vector<double>& x, int rank);

/// The last state of a motion in which everything is driven, in scaled coordinates, rates and accelerations.
struct LastState {
  double time = 0.0;
  std::vector<double> x, v, a;
};

/// The dead centre that its drives meet within `longest` s of it, if they go on as they do there.
std::optional<SingularPlace> dead_centre_beyond(const MotionModel& model, const LastState& last, double longest);

/// "crank = 0 deg, ram = 300 mm": the position in words, of so many of what moves at most.
std::string position_in_words(const MotionModel& model, const std::vector<double>& x);

}  // namespace poise

#pragma once

#include <atomic>
#include <limits>
#include <string>
#include <vector>

#include "statics/model/static_model.hpp"

namespace poise {

struct SettleOptions {
  double run_away = 100.0;  ///< max |x - start|, rad or mechanism sizes, beyond which the mechanism runs away
  int steps = 4000;         ///< of one motion
  /// Several freedoms: distance from a watershed, rad or mechanism sizes, below which the answer is in doubt.
  double watershed = 1e-6;
  bool sides = true;    ///< also find where each side of an unstable start falls to
  bool course = false;  ///< keep the poses that the motion passes
  const std::atomic<bool>* interrupt = nullptr;
};

/// Where a mechanism comes to rest when it is released with heavy damping. Starts as not closed.
struct Settling {
  enum class End {
    settled,         ///< at rest: small displacements do not grow, or stops hold it
    start_unstable,  ///< the start is an equilibrium from which it falls; see `sides`
    runs_away,       ///< it moved farther than SettleOptions::run_away and had not come to rest
    singular,        ///< the closures lose rank on the way, and the mechanism could continue in several ways
    not_closed,      ///< the loops could not be closed from the start
    step_limit,      ///< SettleOptions::steps were not enough: loads that follow bodies drive it round, or it creeps
    interrupted
  };
  End end = End::not_closed;
  std::string why;        ///< one sentence
  std::vector<double> x;  ///< scaled coordinates: where it rests, or of start_unstable the start, or the last pose
  std::vector<int> active_stops;  ///< that hold it there: indices of Scene::stops
  /// With SettleOptions::course: scaled coordinates from the closed start to x, of start_unstable to where the first of
  /// the sides comes to rest; at most some 0.05 rad or mechanism sizes apart.
  std::vector<std::vector<double>> course;

  /// Rounding, or a displacement of less than SettleOptions::watershed, decides where it goes.
  bool in_doubt = false;
  /// How near the motion passes to one that ends elsewhere, rad or mechanism sizes. With one freedom: the distance of
  /// the start from an unstable equilibrium behind it, to first order. Infinite where none is near.
  double margin = std::numeric_limits<double>::infinity();

  /// Where it comes to rest from one side of an unstable equilibrium.
  struct Side {
    std::vector<double> direction;  ///< unit vector in scaled coordinates, from the equilibrium to that side
    End end = End::not_closed;
    std::vector<double> x;
    std::vector<int> active_stops;
  };
  /// Of start_unstable, and where the motion led onto an unstable equilibrium (then in_doubt): both sides of each
  /// direction in which it falls, one freedom: of the only direction. A side that holds is left out.
  std::vector<Side> sides;

  int freedoms = 0;         ///< at the closed start, stops not counted
  bool by_dampers = false;  ///< D is that of the scene's dampers, else the identity in scaled coordinates
  int evaluations = 0;
  int steps = 0;
  double microseconds = 0.0;
};

/// "settled", "runs away", ...
std::string to_string(Settling::End end);

/// The equilibrium that the mechanism reaches from x (scaled coordinates, closed first where loops are open):
///
///   D(x) x' = Q(x),   c(x) = 0,   lower <= stops <= upper,
///
/// the limit of motion in which damping outweighs inertia (S. H. Strogatz, "Nonlinear Dynamics and Chaos", section
/// 2.6). D is described at DampedMechanism. With one freedom (solvers::CurveMotion) no equilibrium lies between start
/// and answer; with several (solvers::DampedMotion) the motion is integrated, more accurately where displacements grow,
/// and Newton's method finishes where the energy is convex. Numerical failure is an End, never an exception.
Settling settle(const StaticModel& model, const std::vector<double>& x, const SettleOptions& options = {});

}  // namespace poise

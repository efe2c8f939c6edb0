#pragma once

#include <vector>

#include "solvers/ball.hpp"
#include "statics/proof/stability.hpp"

namespace poise {

/// Where one-way springs are exactly at their free length and stops are touched without force, the energy of a motion
/// with the rates v of `coordinates` changes by half of
///   q(v) = v^T H v + sum_k max(0, a_k.v)^2,
/// H being the reduced Hessian without those springs and a_k (`acting`) the gradient of a measure times the root of the
/// stiffness, positive where the spring acts; stops leave the motions with b_s.v <= 0 (`forbidden`).
struct Cones {
  using Ball = solvers::Ball;
  std::vector<std::vector<Ball>> hessian;  ///< H, symmetric
  std::vector<std::vector<Ball>> acting, forbidden;
};

struct StabilityOnCones {
  /// Stable: q > 0 for all motions that the stops leave. Unstable: q < 0 for one that leaves all stops. Neutral: no
  /// force acts along one that leaves all stops and springs. Unknown if none of these is proved.
  Stability stability = Stability::unknown;
  bool locked = false;  ///< proved: the stops leave no motion
};

/// Decides in ball arithmetic: directions v, as points of the surface of a cube, are divided into boxes until each is
/// forbidden or has q > 0, or a middle of one shows that q < 0; a counted number of boxes is the limit.
StabilityOnCones stability_on_cones(const Cones& cones);

/// Whether a.v < 0 for all of the forms a in one direction v; false where none is proved.
bool is_left_together(const std::vector<std::vector<solvers::Ball>>& forms);

/// Whether some motion that is neutral leaves all stops and springs: `neutral` are the first entries of v, which may be
/// chosen freely, and the others follow them so that (H v) vanishes there.
bool goes_on_beside(const Cones& cones, std::size_t neutral);

}  // namespace poise

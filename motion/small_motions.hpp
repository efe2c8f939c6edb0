#pragma once

#include <vector>

#include <Eigen/Core>

#include "motion/body_motion.hpp"
#include "motion/motion_model.hpp"
#include "motion/touched_stop.hpp"
#include "statics/model/mobility.hpp"

namespace poise {

/// The equations of small motions  q = q0 + N y  about an equilibrium at the scaled coordinates x of a model,
///   M y'' + C y' + K y = (a small force),
/// with N an orthonormal basis of the motions that closures and the stops that hold allow:
///   M = N^T M(q) N,   C = N^T D N,   K = N^T (grad2 V + sum lambda grad2 c) N.
/// In the units of the scaled scene; y are as many as there are degrees of freedom. Dry friction and drives are left
/// out.
struct SmallMotions {
  Eigen::MatrixXd basis, mass, damping, stiffness;  ///< N, M, C, K
  bool symmetric = true;                            ///< K is; not with loads that follow a body
  double largest = 0.0;                             ///< entry of the tangent, which K is the part along N of
  std::vector<TouchedStop> stops;                   ///< that press and so hold, without couplings
  /// Those that touch without a force, and that these motions do not leave where they are: the equations are those of
  /// motion away from them, and none of motion towards them.
  std::vector<TouchedStop> just_touched;
  Freedoms mobility;  ///< that the closures leave, whatever stops hold

  int freedoms() const { return static_cast<int>(basis.cols()); }
};

/// x must be an equilibrium.
SmallMotions small_motions(const MotionModel& model, const std::vector<double>& x);

/// The rates of all bodies along each column of N, SI.
std::vector<std::vector<BodyMotion>> motions_along(const MotionModel& model, const std::vector<double>& x,
                                                   const Eigen::MatrixXd& basis);

}  // namespace poise

#pragma once

#include <string>
#include <vector>

#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/release.hpp"

namespace poise {

/// The equation of motion of a scene in the f independent ones, z, of its n coordinates q, with the rates w = z':
///
///   D(z) z'' + h(z, w) + c(z) = Q(z, w, t)
///
/// D, the inertia matrix, has the kinetic energy w^T D w / 2 where no drive moves. h are the forces of inertia where
/// z'' = 0: Coriolis and centrifugal ones, and those of what drives move. c are the forces of what has an energy V,
/// gravity and everything elastic:  c = dV/dz. Q are the generalized forces of all loads and of what resists motion.
/// With B = dq/dz from the rows g(q, t) = 0 of closures, couplings and drives, whose Jacobian is J,
///
///   q' = B w + (rates of the drives),   J B = 0,   D = B^T M B,   c = B^T dV/dq.
///
/// Stops do not act. Letters are those of the lift's dynamics (docs/equations.md). SI.
struct EquationsOfMotion {
  Scene scene;
  Layout layout;
  std::vector<double> begin;     ///< the coordinates at which drives without a given start begin
  std::vector<int> independent;  ///< z, as indices of q, ascending
  std::vector<int> rows;         ///< as many of g as others of q, from which these follow
  Scales scales;                 ///< of the mechanism: lengths are compared with angles by them
  std::vector<std::string> coordinate_names, row_names;

  int coordinates() const { return layout.kept; }
  int freedoms() const { return static_cast<int>(independent.size()); }
  bool is_length(int coordinate) const { return layout.is_length(coordinate); }
};

/// Where a mechanism is: closed coordinates and their rates.
struct EquationState {
  double t = 0.0;
  std::vector<double> q, v;
};

/// A value or a rate that is asked of a state, SI.
struct AskedValue {
  Channel channel;
  double value = 0.0;
};

/// The state at the time t with these values and rates, from an origin of motions as release() has it: drives go on to
/// t while everything else stays, and values are reached with the least change of all others. Throws InputError where
/// that cannot be had.
EquationState equation_state(const MotionModel& model, const MotionOrigin& origin,
                             const std::vector<AskedValue>& places, const std::vector<AskedValue>& rates, double t);

/// The equation in coordinates that are chosen in that state, among them those `wanted` by the names of channels.
/// Throws InputError where these depend on each other, where nothing is free to move, and where the scene has what
/// makes the equation more than a function of z, w and t, such as friction that sticks.
EquationsOfMotion equations_of_motion(const MotionModel& model, const MotionOrigin& origin, const EquationState& state,
                                      const std::vector<std::string>& wanted);

/// The parts of the equation in a state, row by row. Its z and w count; the other coordinates are near where the loops
/// close.
struct EquationNumbers {
  ReducedMotion<double>::Status status = ReducedMotion<double>::Status::ok;
  std::vector<double> q, v, z, w;
  std::vector<double> D, h, c, Q;  ///< f x f, f, f, f
  std::vector<double> J;           ///< rows x n
  std::vector<double> B;           ///< n x f
  /// z'', and what it makes of all coordinates; not numbers where the status is not ok.
  std::vector<double> alpha, a;
};
EquationNumbers numbers_at(const EquationsOfMotion& equations, const EquationState& state);

}  // namespace poise

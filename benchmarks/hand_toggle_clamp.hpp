#pragma once

#include <array>

namespace poise::benchmarks {

/// Numbers of datasets/toggle_clamp.toml that a batch of variants changes; the other ones are constants.
struct HandToggleClampNumbers {
  double pull = 25.0;        ///< P, up at the grip, N
  double stiffness = 400.0;  ///< of the rubber tip, N/mm
};

/// Equilibrium of datasets/toggle_clamp.toml (mm, N, rad) by a Newton written for this one clamp: the yardstick for
/// Poise's virtual work where a stop may hold. With the angles h, l, a of handle, link and arm, the vectors
/// u_h = 24 e(h), u_l = 36 e(l) along the links, b(a) = R(a) (-36, 4) from A to B, and the over-centre gap
/// s = l - h + 6 degrees >= 0 with its moment M >= 0, N mm:
///
///   closure       u_h + u_l - b(a) + C - A = 0                                                2 equations
///   held          s = 0,                             where the start is past the stop         1 equation,
///   free          N^T Q = 0,  N the cross product of the two rows of the closure Jacobian     one or the other
///
///   Q_h = P (40 cos h - 118 sin h) - w_h (26 cos h - 48 sin h) - 24 w_l cos h,   Q_l = -18 w_l cos l,
///   Q_a = -w_a (24 cos a + sin a) - F d'(a),   F = k min(d - 14, 0),   d = |A + R(a) (86, -18) - W|
///
/// with the weights w. A held stop is released where M = -N^T Q / (N_l - N_h) is below zero, and holds where s is. The
/// stop of the wide open arm is left out: the clamp that P opens is not followed, and is reported as not converged.
struct HandToggleClampResult {
  std::array<double, 3> angles{};  ///< handle, link, arm, rad
  double clamping_force = 0.0;     ///< -F, N, with the change along the last step
  bool held = false;               ///< by the over-centre stop
  int iterations = 0;              ///< Newton steps
  bool converged = false;          ///< the last step met max |d| <= 1e-9, and the stop presses or is free
};

/// Steps with exact derivatives until max |d| <= 1e-9, that last step still applied; at most 50. Angles of `start`
/// are those of handle, link and arm.
HandToggleClampResult solve_toggle_clamp_by_hand(const std::array<double, 3>& start,
                                                 const HandToggleClampNumbers& numbers = {});

}  // namespace poise::benchmarks

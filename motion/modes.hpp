#pragma once

#include <array>
#include <complex>
#include <string>
#include <vector>

#include "motion/motion_model.hpp"
#include "motion/touched_stop.hpp"
#include "statics/model/mobility.hpp"

namespace poise {

/// One mode of free motion of a mechanism near its equilibrium: exp(s t) times a shape.
struct Vibration {
  enum class Kind {
    oscillates,  ///< stable oscillation
    decays,      ///< stable, overdamped: decays without oscillation
    neutral,     ///< no restoring force: zero frequency
    diverges,    ///< unstable without oscillation (divergence)
    flutters     ///< oscillates with growing amplitude; only with follower loads
  };
  Kind kind = Kind::oscillates;
  /// Hz: undamped, sqrt(K/M) / 2 pi, and with follower loads |s| / 2 pi; 0 if K gives no restoring force.
  double frequency = 0.0;
  /// -(s1 + s2) / (2 sqrt(s1 s2)):  -Re s / |s| if oscillating, 1 and more if decaying; 0 if neutral or diverging.
  double damping_ratio = 0.0;
  double damped_frequency = 0.0;  ///< Hz: |Im s| / 2 pi
  double growth = 0.0;            ///< 1/s: largest Re s
  /// Both exponents s, 1/s: a conjugate pair, or two real ones.
  std::array<std::complex<double>, 2> roots{};
  /// Kept coordinates of the model, SI (rad, m): components of the undamped shape, real and of unit modal mass shape^T
  /// M shape = 1, largest component (rad, mechanism sizes) positive. With follower loads the shape of the damped
  /// motion, complex, with phase zero of the largest component.
  std::vector<std::complex<double>> shape;
};

/// The linear motions of a mechanism near an equilibrium.
struct Modes {
  bool known = false;
  std::string why;                        ///< if not known: what is missing, one sentence
  int freedoms = 0;                       ///< degrees of freedom, columns of N
  int massless = 0;                       ///< directions without inertia, which follow the others (static condensation)
  std::vector<TouchedStop> stops;         ///< that press: they count as closures
  std::vector<TouchedStop> just_touched;  ///< without a force: the modes are those of motion away from them
  Freedoms mobility;                      ///< that the closures leave, whatever stops hold
  /// Unstable modes first (fastest first), then neutral ones, then by frequency.
  std::vector<Vibration> vibrations;
};

/// Small motions  q = q0 + N y  about an equilibrium at the scaled coordinates x of the model: with N a basis of the
/// null space of the closure Jacobian J (rank-revealing),
///   M y'' + C y' + K y = 0,   M = N^T M(q) N,   C = N^T D N,   K = N^T (grad2 V + sum lambda grad2 c) N,
/// lambda the multipliers of least norm in  grad V + J^T lambda = 0, D from the dampers and torsion dampers. Loads that
/// follow a body make K unsymmetric. Frequencies and shapes are those of the pencil (K, M), exponents s those of
///   (s^2 M + s C + K) u = 0.
/// Not known where it is proved that the closures leave no finite freedom: then nothing moves.
/// Left out: dry friction, which is not linear, and drives and controllers, which statics leaves out too
/// (motion/control_loop.hpp has these). x must be an equilibrium.
Modes modes_of(const MotionModel& model, const std::vector<double>& x);

}  // namespace poise

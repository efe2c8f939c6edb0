#pragma once

#include <array>
#include <complex>
#include <string>
#include <vector>

#include "motion/motion_model.hpp"

namespace poise {

/// One way in which a mechanism near its equilibrium moves freely: exp(s t) times a shape.
struct Vibration {
  enum class Kind {
    swings,    ///< comes back, through zero
    decays,    ///< comes back without swinging: overdamped
    neutral,   ///< nothing drives it back: zero frequency
    diverges,  ///< leaves without swinging
    flutters   ///< swings with growing amplitude; only loads that follow a body do that
  };
  Kind kind = Kind::swings;
  /// Hz: undamped, sqrt(K/M) / 2 pi, and with follower loads |s| / 2 pi; 0 where K does not drive it back.
  double frequency = 0.0;
  /// -(s1 + s2) / (2 sqrt(s1 s2)):  -Re s / |s| of what swings, 1 and more of what decays; 0 of neutral and diverging.
  double damping_ratio = 0.0;
  double damped_frequency = 0.0;  ///< Hz: |Im s| / 2 pi
  double growth = 0.0;            ///< 1/s: largest Re s
  /// Both exponents s, 1/s: a conjugate pair, or two real ones.
  std::array<std::complex<double>, 2> roots{};
  /// Kept coordinates of the model, SI (rad, m): parts of the undamped shape, real and of unit modal mass
  /// shape^T M shape = 1, largest part (rad, mechanism sizes) positive. With follower loads the shape of the damped
  /// motion, complex, the largest part's phase zero.
  std::vector<std::complex<double>> shape;
};

/// The linear motions of a mechanism near an equilibrium.
struct Modes {
  bool known = false;
  std::string why;   ///< where not known: what is missing, one sentence
  int freedoms = 0;  ///< columns of N
  int massless = 0;  ///< directions without inertia, which follow the others (static condensation)
  int held = 0;      ///< stops that press; they count as closed
  /// What leaves first (fastest first), then neutral ones, then by frequency.
  std::vector<Vibration> vibrations;
};

/// Small motions  q = q0 + N y  about an equilibrium at the scaled coordinates x of the model: with N a basis of the
/// null space of the closure Jacobian J (rank-revealing),
///   M y'' + C y' + K y = 0,   M = N^T M(q) N,   C = N^T D N,   K = N^T (grad2 V + sum lambda grad2 c) N,
/// lambda the multipliers of least norm in  grad V + J^T lambda = 0, D from the dampers and torsion dampers. Loads that
/// follow a body make K unsymmetric. Frequencies and shapes are those of the pencil (K, M), exponents s those of
///   (s^2 M + s C + K) u = 0.
/// Left out: dry friction, which is not linear, and drives, which statics does not know either.
/// Where x is no equilibrium the answer means nothing.
Modes modes_of(const MotionModel& model, const std::vector<double>& x);

}  // namespace poise

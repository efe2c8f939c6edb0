#pragma once

#include <atomic>
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "motion/simulate.hpp"

namespace poise {

struct RunningOptions {
  int coordinate = 0;    ///< the angle, a coordinate of the model, whose turns make the period
  int turns = 1;         ///< of it in a period
  double guess = 0.0;    ///< its rate where it starts, rad/s; 0: it starts from rest
  int most_turns = 400;  ///< periods that it may take to come near its steady running
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(int)> progress{};  ///< called with the periods followed
};

/// The size of a rate and the angle at which it is reached, rad/s and rad.
struct SpeedAt {
  double speed = 0.0, angle = 0.0;
};

/// How a machine runs once its speed is that of the turn before: SI.
struct SteadyRunning {
  bool found = false;
  std::string why;         ///< if not
  Motion motion;           ///< of one period, which begins at the angle of the start
  int turns = 1;           ///< in the period: those asked for, or as many as bring all bodies back, up to 12
  int whole_turns = 0;     ///< after so many it repeats itself, where it does not after those asked for
  double period = 0.0;     ///< s
  double direction = 1.0;  ///< 1: the angle grows
  double mean = 0.0;       ///< size of the rate, rad/s: 2 pi turns / period
  SpeedAt slowest, fastest;
  bool stable = false;                            ///< all multipliers are within the unit circle
  std::vector<std::complex<double>> multipliers;  ///< Floquet's, 2 f - 1 of them, largest first
  /// Largest difference of the state after the period from that before, over size and speed, in a motion a hundred
  /// times as accurate.
  double residual = 0.0;
  double error = 0.0;  ///< the largest difference of that motion and this one, over the travel of each coordinate
  int periods = 0;     ///< followed until Newton's method began

  /// (largest - least) / mean.
  double fluctuation() const { return (fastest.speed - slowest.speed) / mean; }
};

/// Shooting: with x the state on the section where the angle has turned by whole turns since the start - all
/// independent coordinates but the angle, and all rates - and P(x) that a period later, Newton's method solves
/// P(x) = x, from where x comes to by itself. With the state y = (z, w), its derivative Phi by that at the start, and
/// the angle k,
///   DP = Phi - y' Phi_k / y'_k   without row and column k,
/// whose eigenvalues are the multipliers; simulate() gives Phi, across events too. Angles that have turned count
/// modulo whole turns. One that it does not come to by itself is given only where it is the only one found, or the
/// motion begins near it. A second period must repeat the first: not found where a spring winds up with each turn, a
/// limit of an angle comes nearer, or other bodies are elsewhere after the turns and it matters.
///
/// Throws InputError where the scene has drives or functions of time, or the angle is none that can turn.
SteadyRunning steady_running(const MotionModel& model, const MotionState& start, const RunningOptions& options);

}  // namespace poise

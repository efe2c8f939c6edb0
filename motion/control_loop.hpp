#pragma once

#include <complex>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "motion/motion_model.hpp"

namespace poise {

/// A linear system  x' = A x + B u,  y = C x + D u, in SI, with the names of x, u and y.
struct StateSpace {
  Eigen::MatrixXd a, b, c, d;
  std::vector<std::string> states, inputs, outputs;
};

/// A controller at the equilibrium.
struct ControlAtRest {
  int element = 0;            ///< of the scene
  double value = 0.0;         ///< what it reads, rad, m, rad/s or m/s
  double effort = 0.0;        ///< N or N m
  bool limited = false;       ///< the effort is at a limit, where it does not follow what is read
  bool in_dead_band = false;  ///< the error is within the dead band
};

/// A mechanism with its controllers near an equilibrium.
struct ControlLoop {
  enum class Stability {
    stable,    ///< all poles have negative real parts
    marginal,  ///< none has a positive one, but some have a real part that is zero to rounding
    unstable
  };
  bool known = false;
  std::string why;        ///< if not known: what is missing, one sentence
  std::vector<double> x;  ///< scaled coordinates of the equilibrium
  std::vector<ControlAtRest> controllers;
  /// With the loop closed: u are the references, y what each controller reads and its effort. x are the independent
  /// coordinates, each with its rate, less their values at the equilibrium, then the states of controllers.
  StateSpace closed;
  /// The mechanism alone: u are the efforts of the controllers, y what they read.
  StateSpace open;
  std::vector<std::complex<double>> poles, open_poles;  ///< of A, 1/s: the largest real parts first
  Stability stability = Stability::unstable;
};

/// Finds the equilibrium of a mechanism with controllers that is reached from the scaled coordinates `from` by Newton's
/// method, and the exact linear system there:
///   w' = alpha(z, w, s),   s' = f(z, w, s)  at  alpha = 0, f = 0, w = 0,
/// with the independent coordinates z and the states s of the controllers. An integral has the value that keeps its
/// error zero. Loads, springs and references have the values of the scene, none of its functions of time.
/// Not known with limits of stops that are touched. Throws InputError for scenes with drives or dry friction.
ControlLoop control_loop(const MotionModel& model, const std::vector<double>& from);

}  // namespace poise

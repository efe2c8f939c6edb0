#pragma once

#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "motion/motion_model.hpp"
#include "solvers/delayed_system.hpp"

namespace poise {

/// A linear system  x' = A x + B u,  y = C x + D u, in SI, with the names of x, u and y.
struct StateSpace {
  Eigen::MatrixXd a, b, c, d;
  std::vector<std::string> states, inputs, outputs;
};

/// A controller at the equilibrium.
struct ControlAtRest {
  int element = 0;            ///< of the scene
  double value = 0.0;         ///< what it reads, SI: rad, m, rad/s, m/s, or what another one gives
  double effort = 0.0;        ///< N or N m, or what it gives to others
  bool limited = false;       ///< the effort is at a limit, where it does not follow what is read
  bool in_dead_band = false;  ///< the error is within the dead band
};

/// A controller with a delay.
struct DelayedControl {
  int element = 0;     ///< of the scene
  double delay = 0.0;  ///< s
};

/// A mechanism with its controllers, motors and blades near an equilibrium.
struct ControlLoop {
  enum class Stability {
    stable,    ///< all poles have negative real parts, of a loop with samples sizes below 1
    marginal,  ///< none has a positive one, but some have a real part that is zero to rounding
    unstable
  };
  bool known = false;
  std::string why;        ///< if not known: what is missing, one sentence
  std::vector<double> x;  ///< scaled coordinates of the equilibrium
  std::vector<double> v;  ///< their rates, of which only those that are states of controllers are not zero
  std::vector<ControlAtRest> controllers;
  std::vector<double> blade_force;  ///< of each blade across its edge, to the left of it, on the body of its point, N
  /// With the loop closed: u are the references, y what each controller reads and its effort. x are the independent
  /// coordinates, each with its rate, less their values at the equilibrium, then the states of controllers. Of the
  /// rates blades leave fewer, w = N u, of which the others are no states. With samples it is  x(k+1) = A x(k) + B
  /// u(k),  y(k) = C x(k) + D u(k)  at the times k period, behind the decision of the controllers: exact for references
  /// that are constant in between; behind delays x has what was decided so many samples before, too. Without samples,
  /// with delays what controllers give by them is an input each behind the references, d, and what they decide an
  /// output each behind the others, e: the loop is closed by  d(t) = e(t - T).
  StateSpace closed;
  /// The mechanism alone: u are the efforts of the controllers that act on it, y what those read that read a measure.
  StateSpace open;
  /// The eigenvalues of A are these, 1/s, the largest real parts first; with samples z, the largest sizes first. With
  /// delays all poles right of a line; there are infinitely many. As many as there are blades are 0, of samples z = 1:
  /// equilibria come in sets, because what blades hold of rates, C z' = 0, no force brings back.
  std::vector<std::complex<double>> poles, open_poles;
  std::vector<DelayedControl> delayed;
  double poles_right_of = 0.0;  ///< that line, 1/s
  double period = 0.0;          ///< of the samples, s; 0 without any
  /// The closed loop, without inputs; not with samples. Of blades that of the motions with C z = 0, which forces make:
  /// coordinates z = N r, r those whose rates are states. It has none of those poles.
  solvers::DelayedSystem system;
  /// `along` has the scaled coordinates of the model by each independent one of the mechanism, SI, in its column;
  /// `places` and `rates` say where these are among the states of `system`; `by_force` has the changes of all its
  /// states by scaled generalized forces on all coordinates.
  Eigen::MatrixXd along, by_force;
  std::vector<int> places, rates;
  Stability stability = Stability::unstable;
};

/// What holds the equilibria of a scene that statics does not find, "controllers", "blades" or "motors"; empty if
/// nothing does.
std::string_view what_keeps(const Scene& scene);

/// Finds the equilibrium of a mechanism with controllers that is reached from the scaled coordinates `from` by Newton's
/// method, and the exact linear system there:
///   w' = alpha(z, w, s),   s' = f(z, w, s)  at  alpha = 0, f = 0, w = 0,
/// with the independent coordinates z and the states s of the controllers. An integral has the value that keeps its
/// error zero. Loads, springs and references have the values of the scene, none of its functions of time.
/// Of controllers with a period what is held between samples takes no part in x; the zero-order hold is exact. Delays
/// are exact, too (solvers/delayed_system.hpp).
/// Not known with limits of stops that are touched, at ends of dead bands, and where controllers with delays follow
/// each other in a circle. Drives that stand still hold their measures; how far one has moved whose acceleration a
/// controller sets is a coordinate of the mechanism, and so is its rate. Throws InputError for scenes with dry friction
/// or drives that move by themselves, for drives that controllers set beside blades, for periods that differ, and for
/// periods beside delays of what is not sampled.
ControlLoop control_loop(const MotionModel& model, const std::vector<double>& from);

/// Returns the linear system that control_loop() finds from where a scene that something keeps is assembled. It returns
/// nothing where statics finds the equilibrium: nothing keeps the scene, or motors turn it and do not hold it.
std::optional<ControlLoop> loop_where_kept(const MotionModel& model);

}  // namespace poise

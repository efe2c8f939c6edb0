#pragma once

#include <optional>
#include <vector>

#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// A damped sine  offset + exp(-decay t) (a cos(omega t) + b sin(omega t)).
struct DampedSine {
  double offset = 0.0, a = 0.0, b = 0.0;
  double decay = 0.0, omega = 0.0;  ///< 1/s, rad/s
  double relative_residual = 0.0;   ///< root mean square residual, relative to that of the readings about their mean
};

/// Fits one to readings over ascending times. Empty where they complete fewer than one and a half oscillations.
std::optional<DampedSine> fit_damped_sine(const std::vector<double>& time, const std::vector<double>& reading);

/// Parameters and nuisances from which to start a fit, found without a guess.
struct OscillationStart {
  std::vector<double> parameters;
  std::vector<std::vector<double>> nuisances;  ///< per run
};

/// For lightly damped small oscillations of one degree of freedom: a damped sine per record gives omega0^2 = omega^2 +
/// decay^2 and 2 decay; with the reduced mass M, stiffness K and damping C in equilibrium, all affine in masses,
/// inertias, stiffnesses and damping,
///   omega0^2 M(p) - K(p) = 0,   2 decay M(p) - C(p) = 0
/// of all runs are linear least squares for p. Empty where the experiment is not of this kind.
std::optional<OscillationStart> start_from_oscillations(const FitProblem& problem, const std::vector<Record>& records);

}  // namespace poise

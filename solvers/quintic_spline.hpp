#pragma once

#include <array>
#include <optional>
#include <vector>

namespace poise::solvers {

/// A spline of degree 5 with four continuous derivatives: from breaks[i] to breaks[i + 1] it is
///   sum_k pieces[i][k] (t - breaks[i])^k.
struct QuinticSpline {
  std::vector<double> breaks;
  std::vector<std::array<double, 6>> pieces;
};

/// The spline through the points (t, y): at least 6 of them, t ascending. Its breaks are the points, but for three at
/// each end.
QuinticSpline interpolating_spline(const std::vector<double>& t, const std::vector<double>& y);

/// The least-squares spline with the number of breaks, of equally many points between them, that minimises Mallows'
/// estimate of its squared error,
///   sum e^2 / noise^2 + 2 coefficients
/// with the residuals e (C. L. Mallows, Some comments on C_p, Technometrics 15, 1973). At least 6 points, noise > 0.
/// Empty where the residuals of the best one exceed the noise by more than chance: noise is understated, or there are
/// fewer than two points to each break.
std::optional<QuinticSpline> smoothing_spline(const std::vector<double>& t, const std::vector<double>& y, double noise);

}  // namespace poise::solvers

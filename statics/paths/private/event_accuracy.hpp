#pragma once

// How exactly the numbers of an event are known.

#include <vector>

#include <Eigen/Core>

#include "solvers/curve.hpp"
#include "statics/proof/balance_system.hpp"

namespace poise {

/// The equations of a piece: its active rows.
KeptEquations kept_equations(const std::vector<solvers::ActiveRow>& active);

/// |sum_i row_i errors_i|, the first-order effect of errors of equations on a number, and the part of it that the radii
/// of the errors allow.
struct FirstOrderEffect {
  double whole = 0.0, spread = 0.0;
};
FirstOrderEffect effect_of(const Eigen::VectorXd& row, const std::vector<Ball>& errors);

/// Decimal digits of a number whose relative errors these are, at most 16.
int decimal_digits(double error, double rounding_effect);

}  // namespace poise

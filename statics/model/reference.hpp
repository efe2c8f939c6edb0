#pragma once

#include <string>
#include <vector>

#include "statics/model/static_model.hpp"

namespace poise {

/// The equilibrium nearest to a result, in 50 digits.
struct Reference {
  bool refined = false;              ///< Newton in 50 digits converged, close to the start
  std::string why;                   ///< if it did not
  double error = 0.0;                ///< largest difference of a scaled coordinate (rad, or length / size)
  int digits = 0;                    ///< decimal digits to which the reference itself has converged
  std::vector<double> x;             ///< scaled coordinates, rounded from 50 digits
  std::vector<std::string> decimal;  ///< coordinates in SI (rad, m), 40 digits
};

/// Refines x by Newton's method on the same equations evaluated in 50 digits (Boost.Multiprecision), stops that x
/// touches fixed at their bound. The scene as read, in double, is taken as exact.
Reference refine(const StaticModel& model, const std::vector<double>& x);

}  // namespace poise

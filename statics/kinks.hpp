#pragma once

#include <vector>

#include "statics/check.hpp"
#include "statics/static_model.hpp"

namespace poise {

/// Indices into Scene::elements of the one-way springs at their free length: |length - free length| within rounding of
/// the mechanism's size. There the second derivative of the energy is discontinuous.
std::vector<int> springs_at_kinks(const StaticModel& model, const std::vector<double>& x);

/// Stability of an equilibrium x with springs at kinks, `rows` of the constraints active:
///
///   stable    if the reduced Hessian without those springs is positive definite, for they only add to it; with one
///             degree of freedom also if it is positive on each side with the springs that act there
///   unstable  if it has a negative eigenvalue with all of them; with one degree of freedom, if negative on a side
///   unknown   otherwise
///
/// Curvatures below `zero` count as zero.
Stability stability_at_kinks(const StaticModel& model, const std::vector<double>& x, const std::vector<int>& rows,
                             const std::vector<int>& springs, double zero);

}  // namespace poise

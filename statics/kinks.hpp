#pragma once

#include <vector>

#include "statics/check.hpp"
#include "statics/static_model.hpp"

namespace poise {

/// Indices into Scene::elements of the springs that act one way only and are just about to: |length - free length|
/// within rounding of the mechanism's size. There the energy has a kink in its second derivative.
std::vector<int> springs_at_kinks(const StaticModel& model, const std::vector<double>& x);

/// Stability of an equilibrium x with springs at kinks, `rows` of the constraints holding:
///
///   stable    where the reduced Hessian without those springs is positive definite, for they only add to it; with one
///             freedom also where it is positive on each side with the springs that act there
///   unstable  where it has a negative eigenvalue with all of them; with one freedom, where it is negative on a side
///   unknown   otherwise
///
/// Curvatures below `zero` count as none.
Stability stability_at_kinks(const StaticModel& model, const std::vector<double>& x, const std::vector<int>& rows,
                             const std::vector<int>& springs, double zero);

}  // namespace poise

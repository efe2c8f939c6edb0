#pragma once

#include <vector>

#include "statics/model/static_model.hpp"
#include "statics/proof/stability.hpp"

namespace poise {

/// Stability of an equilibrium at the scaled coordinates x from its small motions (modes_of): unstable if one of them
/// diverges or flutters, stable if all oscillate or decay, neutral if one does neither. Unknown where some degree of
/// freedom has no inertia. Where loads follow bodies the signs of stiffness do not tell flutter (H. Ziegler, "Die
/// Stabilitätskriterien der Elastomechanik", 1952).
Stability dynamic_stability(const StaticModel& model, const std::vector<double>& x);

}  // namespace poise

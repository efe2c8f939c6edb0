#pragma once

// Private to statics/tracked_equilibrium.cpp.

#include <optional>
#include <vector>

#include "statics/static_model.hpp"

namespace poise {

/// The stable equilibrium x of one model, in which these stops act, followed to another model whose numbers differ by
/// so little that nothing can happen between: with
///   K = [ T  J^T ]      T the tangent of forces, J the rows of closures and active stops
///       [ J  0   ]
/// at both ends, K0 + t (K1 - K0) is regular for all 0 <= t <= 1 because |K0^-1 (K1 - K0)| is well below one, so that
/// no fold and no branch point lies between; free stops, pushes of active ones and lengths of one-way springs stay away
/// from their limits by more than a part of what they change. The models have the same scales and structure. Returns
/// the scaled coordinates there, or none where the step is too large to say so.
std::optional<std::vector<double>> followed_in_one_step(const StaticModel& from, const std::vector<double>& x,
                                                        const std::vector<int>& active_stops, const StaticModel& to);

}  // namespace poise

#pragma once

#include <optional>
#include <vector>

#include "statics/model/static_model.hpp"

namespace poise {

/// The stable equilibrium x of one model, in which these stops act, followed to another model of the same scales and
/// structure by Newton's method, with a proof that one smooth curve of stable equilibria leads there on which the same
/// stops act (statics/tracking/private/proved_segment.hpp). Returns the scaled coordinates there, or none where the
/// step is too large for that, or something happens on it.
std::optional<std::vector<double>> followed_in_one_step(const StaticModel& from, const std::vector<double>& x,
                                                        const std::vector<int>& active_stops, const StaticModel& to);

}  // namespace poise

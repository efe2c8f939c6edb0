#pragma once

#include <optional>
#include <vector>

#include "statics/static_model.hpp"

namespace poise {

/// A pose where the closures lose rank and no finite joint forces hold the loads.
struct SingularConfiguration {
  int rank = 0;         ///< of the closure Jacobian at the pose
  int rank_beside = 0;  ///< at poses close by
};

/// Tells whether the closed pose x (scaled coordinates) is such a pose: the Jacobian J of the closures has a smaller
/// rank than beside it, and the loads F have a part that no finite multipliers y balance, whatever motion is possible:
/// min |F + J^T y| > 0. None where the pose is open, or for mechanisms of more than 60 coordinates.
std::optional<SingularConfiguration> find_singular_configuration(const StaticModel& model,
                                                                 const std::vector<double>& x);

}  // namespace poise

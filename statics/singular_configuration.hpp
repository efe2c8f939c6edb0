#pragma once

#include <optional>
#include <vector>

#include "statics/static_model.hpp"

namespace poise {

/// A pose where the closures lose rank and no finite joint forces balance the loads.
struct SingularConfiguration {
  int rank = 0;         ///< of the closure Jacobian at the pose
  int rank_beside = 0;  ///< at poses close by
};

/// Whether the closed pose x (scaled coordinates) is such a pose: the constraint Jacobian J has a smaller rank than at
/// poses close by, and the loads F have a component that no finite multipliers y balance: min |F + J^T y| > 0. Empty if
/// it is not, if the pose is open, or for mechanisms of more than 60 coordinates.
std::optional<SingularConfiguration> find_singular_configuration(const StaticModel& model,
                                                                 const std::vector<double>& x);

}  // namespace poise

#pragma once

#include <optional>
#include <vector>

#include "statics/model/static_model.hpp"

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

/// The point nearest to x where the given constraint rows (equalities, and stops whose measure stays as it is) lose
/// rank, by the method of Gauss and Newton on  c(q) = 0,  J(q)^T u = 0,  u . u = 1  from the smallest singular value at
/// x. Empty if that does not converge.
std::optional<std::vector<double>> nearest_singular_point(const Mechanism<double>& mechanism,
                                                          const std::vector<double>& x, const std::vector<int>& rows);

}  // namespace poise

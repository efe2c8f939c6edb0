#pragma once

#include <optional>
#include <vector>

#include "statics/all_equilibria/private/turning_branch.hpp"
#include "statics/all_equilibria/private/written_numbers.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// A branch, and exp(i apart) in rational numbers where it is known.
struct WrittenBranch {
  TurningBranch branch;
  std::optional<std::vector<Planar<Rational>>> turn;
};

/// Of the closed pose x: what turns together there to first order, where that is proved of all poses, for all loops of
/// the mechanism; null where that is not so, or joints with a travel close loops. `part`: relative rounding of the
/// numbers of the scene.
std::optional<WrittenBranch> turning_branch(const StaticModel& model, const std::vector<double>& x, double part);

}  // namespace poise

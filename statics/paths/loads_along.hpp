#pragma once

#include <vector>

#include "statics/equilibrium/link_loads.hpp"
#include "statics/paths/path.hpp"

namespace poise {

/// Forces in an equilibrium of a varied scene.
struct LoadsAt {
  PathPoint point;
  /// By free-body statics: of joints, bars and active stops; without what holds a driven measure, whose effort the
  /// point has.
  Check check;
  std::vector<LinkLoads> links;  ///< of those with a section

  bool has_all_links() const;
};

/// Forces over the range of a number.
struct LoadsAlong {
  /// Nothing can move: the scene is a structure at all values, without a path.
  bool is_structure = false;
  Path found;
  std::vector<LoadsAt> loads;  ///< in the order of PathOptions::at, at each value in that of the path
};

/// Follows path() with these options, and finds the forces in the equilibria at PathOptions::at; of a structure
/// (solve_or_hold()) those in balance at each of these values. Throws InputError as both do.
LoadsAlong loads_along(const VariedScene& varied, const PathOptions& options);

}  // namespace poise

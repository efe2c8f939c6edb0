#pragma once

#include <string>
#include <vector>

#include "model/dimension.hpp"
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

/// Of the force of a joint or of a load of a link; SI.
struct LoadExtreme {
  double value = 0.0;  ///< not a number where there is none, infinite where it grows without bound
  double at = 0.0;     ///< value of the varied number
  double s = 0.0;      ///< of a link: where on its line
};

/// The force of a joint, or the largest load of a link, over the range.
struct LoadSeries {
  std::string item;  ///< name of the joint or link
  std::string key;   ///< size, axial; normal, shear, moment, tension, compression, deflection
  Dimension dimension{};
  std::vector<double>
      values;  ///< in each equilibrium of LoadsAlong::loads, SI; not a number where it is not determined
  /// Over the whole range: by value of a joint, by size of a link. They are sought on the curve of equilibria, or
  /// between the values asked for, to 1e-9 of the largest size. What is less than rounding is 0.
  LoadExtreme least, largest;
};

/// Forces over the range of a number.
struct LoadsAlong {
  /// Nothing can move: the scene is a structure at all values, without a path.
  bool is_structure = false;
  Path found;
  std::vector<LoadsAt> loads;  ///< in the order of PathOptions::at, at each value in that of the path
  std::vector<LoadSeries> joints, links;
};

/// Follows path() with these options, and finds the forces in the equilibria at PathOptions::at; of a structure
/// (solve_or_hold()) those in balance at each of these values, which ascend or descend. Throws InputError as both do.
LoadsAlong loads_along(const VariedScene& varied, const PathOptions& options);

}  // namespace poise

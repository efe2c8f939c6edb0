#pragma once

#include <string>
#include <vector>

#include "app/draw/figure.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/path_measures.hpp"

namespace poise::app {

/// A place on a path that charts mark and small multiples show. It refers to the path.
struct PathMark {
  std::string label;    ///< numbers of its events, from 1; with a prime for a landing; letters for ends of branches
  std::string caption;  ///< "fold, snap at load.P = 42.9 N"
  const PathPoint* point = nullptr;
  bool turns = false;  ///< a fold, branch point or snap, or a landing
};

/// The marks of a path: its start, its events with landings, and the ends of its branches; those at the same place
/// together.
std::vector<PathMark> path_marks(const VariedScene& varied, const Path& path);

/// The chart of a path in the units of the scene, one panel for each measure: the varied number upwards over the
/// measure, as load-deflection curves are drawn. Of a driven measure the effort upwards over it, and then each measure
/// over it. Unproved points are crossed. `remark` follows the name of the first measure.
std::vector<Panel> path_panels(const VariedScene& varied, const Path& path, const std::vector<SoughtQuantity>& measures,
                               const std::vector<PathMark>& marks, const std::string& remark);

/// What pages and pictures show of a path: of no measures the one that changes most.
struct PathCharts {
  std::vector<PathMark> marks;
  std::vector<SoughtQuantity> measures;
  std::vector<Panel> panels{};
};
PathCharts charts_of(const VariedScene& varied, const Path& path, const std::vector<SoughtQuantity>& measures);

/// Where points of a path are in each of its panels.
std::vector<ChartCursor> path_cursors(const VariedScene& varied, const std::vector<SoughtQuantity>& measures,
                                      const std::vector<PathPoint>& points);

}  // namespace poise::app

#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "motion/snap_motion.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/path_measures.hpp"

namespace poise::app {

/// What `poise path` was asked for.
struct PathView {
  std::vector<SoughtQuantity> measures{};   ///< shown at every point and event
  std::vector<SoughtQuantity> over_path{};  ///< shown once for each branch
  std::vector<double> at{};                 ///< SI: PathOptions::at
  PathOptions::Follow follow = PathOptions::Follow::unstable;
  /// The motions of snaps, where they were asked for, by index of the event.
  std::map<std::size_t, SnapMotion> motions{};
};

/// What `poise path` shows: events, points, and the equilibria at the values asked for; everything in JSON and, of the
/// points, in CSV, docs/json.md.
Result path_result(const VariedScene& varied, const Path& found, const PathView& view,
                   const std::vector<std::string>& settings);

}  // namespace poise::app

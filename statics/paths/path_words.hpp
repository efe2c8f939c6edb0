#pragma once

// What paths are made of, in words.

#include <optional>
#include <string>

#include "statics/paths/path.hpp"

namespace poise {

/// "fold", "branch", "stop", "slack", "snap", "hysteresis end".
std::string to_string(PathEvent::Kind kind);
/// "range", "closed", ...
std::string to_string(PathBranch::End end);
/// "traced", "no start", ...
std::string to_string(Path::Status status);
/// "proved", "critical", "failed", "not tried".
std::string to_string(PointProof proof);

/// "torque" or "force": what holds a driven measure.
std::string effort_name(const VariedScene& varied);
/// Efforts below this are rounding, SI.
double rounding_of_effort(const VariedScene& varied);

/// Where an event lies on the path.
struct EventPlace {
  int branch = -1;  ///< the first branch that has it; -1: none
  /// Of the points of that branch before and after it; empty where there is none. Of a snap: of the point from which
  /// the mechanism comes, on whichever side of it that is, and of the landing.
  std::optional<Stability> before, after;
};

/// The event lies on its branch where the way round it is shortest, in parts of the parameter's `range` and in the
/// scaled coordinates.
EventPlace place_of(const Path& path, int event, double range);

}  // namespace poise

#include "statics/paths/path_words.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace poise {
namespace {

double distance(const PathPoint& a, const PathPoint& b, double range) {
  double square = std::pow((a.parameter - b.parameter) / range, 2);
  for (std::size_t i = 0; i < std::min(a.x.size(), b.x.size()); ++i) square += std::pow(a.x[i] - b.x[i], 2);
  return std::sqrt(square);
}

bool effort_is_torque(const VariedScene& varied) {
  return varied.effort_dimension().length == dimension::torque.length;
}

}  // namespace

std::string to_string(PathEvent::Kind kind) {
  switch (kind) {
    case PathEvent::Kind::fold:
      return "fold";
    case PathEvent::Kind::branch:
      return "branch";
    case PathEvent::Kind::stop:
      return "stop";
    case PathEvent::Kind::slack:
      return "slack";
    case PathEvent::Kind::flutter:
      return "flutter";
    case PathEvent::Kind::snap:
      return "snap";
    case PathEvent::Kind::hysteresis_end:
      return "hysteresis end";
  }
  return "";
}

std::string to_string(PathBranch::End end) {
  switch (end) {
    case PathBranch::End::range:
      return "range";
    case PathBranch::End::closed:
      return "closed";
    case PathBranch::End::blocked:
      return "blocked";
    case PathBranch::End::snapped:
      return "snapped";
    case PathBranch::End::singular:
      return "singular";
    case PathBranch::End::stuck:
      return "stuck";
    case PathBranch::End::limit:
      return "limit";
    case PathBranch::End::interrupted:
      return "interrupted";
  }
  return "";
}

std::string to_string(Path::Status status) {
  switch (status) {
    case Path::Status::not_started:
      return "not started";
    case Path::Status::traced:
      return "traced";
    case Path::Status::incomplete:
      return "incomplete";
    case Path::Status::no_start:
      return "no start";
    case Path::Status::interrupted:
      return "interrupted";
  }
  return "";
}

std::string to_string(PointProof proof) {
  switch (proof) {
    case PointProof::proved:
      return "proved";
    case PointProof::critical:
      return "critical";
    case PointProof::failed:
      return "failed";
    case PointProof::not_tried:
      return "not tried";
  }
  return "";
}

std::string effort_name(const VariedScene& varied) { return effort_is_torque(varied) ? "torque" : "force"; }

double rounding_of_effort(const VariedScene& varied) {
  return 1e-13 * (effort_is_torque(varied) ? varied.scales().energy() : varied.scales().force);
}

EventPlace place_of(const Path& path, int event, double range) {
  EventPlace out;
  const PathEvent& of = path.events[static_cast<std::size_t>(event)];
  if (of.landing) out.after = of.landing->stability;
  const auto has_it = [&](const PathBranch& branch) {
    return std::find(branch.events.begin(), branch.events.end(), event) != branch.events.end();
  };
  const auto branch = std::find_if(path.branches.begin(), path.branches.end(), has_it);
  if (branch == path.branches.end()) return out;
  out.branch = static_cast<int>(branch - path.branches.begin());
  const std::vector<PathPoint>& points = branch->points;
  std::vector<double> away;
  for (const PathPoint& point : points) away.push_back(distance(point, of.at, range));
  std::size_t before = points.size(), after = points.size();  // none
  const auto same = std::find(away.begin(), away.end(), 0.0);
  if (same != away.end()) {
    const auto at = static_cast<std::size_t>(same - away.begin());
    if (at > 0) before = at - 1;
    after = at + 1;
  } else {
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const double detour = away[k] + away[k + 1] - distance(points[k], points[k + 1], range);
      if (detour >= shortest) continue;
      shortest = detour;
      before = k;
      after = k + 1;
    }
  }
  const auto at = [&](std::size_t k) { return k < points.size() ? std::optional(points[k].stability) : std::nullopt; };
  out.before = at(before);
  if (of.kind != PathEvent::Kind::snap) {
    out.after = at(after);
  } else if (at(after) == Stability::stable) {
    // The mechanism comes from the stable side, whichever way the path runs.
    out.before = Stability::stable;
  }
  return out;
}

}  // namespace poise

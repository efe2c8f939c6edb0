#include "statics/followed_change.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "solvers/newton.hpp"
#include "solvers/vectors.hpp"
#include "statics/path.hpp"
#include "statics/small_step.hpp"
#include "statics/varied_scene.hpp"

namespace poise {
namespace {

constexpr double shortest_part = 1.0 / 64;  // of a change that is followed in a few steps
constexpr int most_tries = 24;
constexpr int most_points = 500;         // of a curve, so that no change takes long
constexpr double carried_step = 0.05;    // rad or mechanism sizes
constexpr double shortest_carry = 1e-6;  // of a change

std::string in_words(const Scene& scene, const PathEvent& event) {
  const auto item = static_cast<std::size_t>(event.item);
  switch (event.kind) {
    case PathEvent::Kind::stop:
      return fmt::format("stop \"{}\" {}", scene.stops[item].name, event.on ? "comes on" : "comes off");
    case PathEvent::Kind::slack:
      return fmt::format("\"{}\" {}", scene.elements[item].name, event.on ? "acts" : "is slack");
    case PathEvent::Kind::fold:
      return "fold";
    case PathEvent::Kind::branch:
      return "branch point";
    default:
      return "";
  }
}

// Travels depend on the places of points, which may change.
Scene starting_as(Scene scene, const Scene& other) {
  scene.start = other.start;
  return scene;
}

struct Spot {
  std::unique_ptr<StaticModel> model;
  std::vector<double> x;
};

Spot start_of(const VariedScene& varied) {
  Spot out{varied.model_at(0.0), {}};
  out.x = out.model->start();
  return out;
}

// A few steps; where they end is left in `spot`. Returns the part of the change.
double step_along(const VariedScene& varied, const std::vector<int>& active_stops, Spot& spot) {
  double part = 0.0, step = 0.5;
  for (int tries = 0; part < 1.0 && step >= shortest_part && tries < most_tries; ++tries) {
    const double to = std::min(1.0, part + step);
    auto model = varied.model_at(to);
    if (auto x = followed_in_one_step(*spot.model, spot.x, active_stops, *model)) {
      spot = {std::move(model), std::move(*x)};
      part = to;
      step *= 2.0;
    } else {
      step *= 0.5;
    }
  }
  return part;
}

void trace(const VariedScene& varied, const TrackedOptions& settings, FollowedChange& out) {
  PathOptions options;
  options.from = PathOptions::From::given;
  options.start = varied.model_at(0.0)->start();
  options.follow = PathOptions::Follow::load;
  options.certify = false;
  options.courses = true;
  options.spacing = 1.0;
  options.most_points = most_points;
  options.certificate = settings.certificate;
  options.interrupt = settings.interrupt;
  Path found;
  try {
    found = path(varied, options);
  } catch (const InputError&) {
    return;  // the equilibrium does not depend on what changes
  }
  if (found.branches.empty()) return;
  for (const PathEvent& event : found.events) {
    if (event.kind == PathEvent::Kind::snap) {
      const auto model = varied.model_at(event.at.parameter);
      Transition::Course course{"the equilibrium ends at a fold", {}};
      for (const std::vector<double>& x : event.course) course.poses.push_back(model->poses(x));
      if (!course.poses.empty()) out.transition.courses.push_back(std::move(course));
    } else if (std::string words = in_words(varied.scene(), event); !words.empty()) {
      out.transition.passed.push_back(std::move(words));
    }
  }
  const PathBranch& last = found.branches.back();
  if (last.points.empty()) return;
  const PathPoint& point = last.points.back();
  out.poses = varied.model_at(point.parameter)->poses(point.x);
  out.scene = varied.scene_at(point.parameter);
  out.arrived = last.end == PathBranch::End::range && point.parameter == 1.0;
}

}  // namespace

std::optional<BodyPoses> step_to(const Scene& before, const Scene& after, const BodyPoses& poses,
                                 const std::vector<int>& active_stops) {
  const Scene here = started_at(before, poses), there = starting_as(after, here);
  const StaticModel to(there);
  const StaticModel from(here, to.scales(), &there);
  const auto x = followed_in_one_step(from, from.start(), active_stops, to);
  return x ? std::optional(to.poses(*x)) : std::nullopt;
}

FollowedChange follow_change(const Scene& before, const Scene& after, const BodyPoses& poses,
                             const std::vector<int>& active_stops, const TrackedOptions& options) {
  FollowedChange out;
  out.poses = poses;
  out.transition.kind = Transition::Kind::followed;
  const Scene here = started_at(before, poses), there = starting_as(after, here);
  const auto arrive = [&](BodyPoses at) {
    out.poses = std::move(at);
    out.scene = after;
    out.arrived = true;
    return out;
  };
  out.scene = here;
  if (auto at = step_to(before, after, poses, active_stops)) return arrive(std::move(*at));
  std::optional<VariedScene> varied;
  try {
    varied.emplace(here, there);
  } catch (const InputError&) {
    return out;  // more than numbers differs
  }
  Spot spot = start_of(*varied);
  const double part = step_along(*varied, active_stops, spot);
  if (part == 1.0) return arrive(spot.model->poses(spot.x));
  if (part > 0.0) {
    out.poses = spot.model->poses(spot.x);
    out.scene = varied->scene_at(part);
    Scene from = started_at(out.scene, out.poses);
    Scene to = starting_as(after, from);
    varied.emplace(std::move(from), std::move(to));
  }
  trace(*varied, options, out);
  if (!out.transition.courses.empty()) {
    out.transition.kind = Transition::Kind::snapped;
    out.transition.why = out.transition.courses.back().why;
  }
  return out;
}

std::vector<BodyPoses> carry(const Scene& before, const Scene& after, const BodyPoses& poses) {
  std::vector<BodyPoses> out{poses};
  std::optional<VariedScene> varied;
  try {
    const Scene here = started_at(before, poses);
    varied.emplace(here, starting_as(after, here));
  } catch (const InputError&) {
    return out;  // more than numbers differs, or nothing
  }
  solvers::NewtonOptions settings;
  settings.closing_starts = 0;
  std::vector<double> x = varied->model_at(0.0)->start();
  double part = 0.0, step = 1.0;
  while (part < 1.0) {
    const double to = std::min(1.0, part + step);
    const auto model = varied->model_at(to);
    solvers::Newton closing(model->problem(), settings);
    const solvers::NewtonResult& closed = closing.close(x);
    const bool is_near =
        closed.outcome == solvers::Outcome::converged && solvers::largest_difference(closed.x, x) < carried_step;
    if (is_near) {
      if (solvers::largest_difference(closed.x, x) > 0.0) out.push_back(model->poses(closed.x));
      x = closed.x;
      part = to;
      step *= 2.0;
      continue;
    }
    step *= 0.5;
    if (step < shortest_carry) {
      throw InputError("the loops cannot be closed near the present position; change the number by less");
    }
  }
  return out;
}

}  // namespace poise

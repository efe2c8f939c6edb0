#include "statics/tracking/private/followed_change.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "solvers/newton.hpp"
#include "solvers/vectors.hpp"
#include "statics/model/held_rows.hpp"
#include "statics/model/readings.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/varied_mechanism.hpp"
#include "statics/tracking/private/change_words.hpp"
#include "statics/tracking/private/small_step.hpp"

namespace poise {
namespace {

constexpr double shortest_part = 1e-7;                // of a change; next to a singular pose steps are short
constexpr int most_points = 500;                      // of a section, so that no change takes long
constexpr double usual_step = 0.1, fine_step = 0.02;  // of a section: parts of it, rad, mechanism sizes
constexpr int most_sections = 12;
constexpr double no_change = 1e-11;       // of a section
constexpr double no_motion = 1e-4;        // rad or mechanism sizes
constexpr double section_before = 0.01;   // of its beginning before the end of the steps, rad or mechanism sizes
constexpr double least_width = 1.0 / 64;  // of a section, parts of what is left of a change
constexpr double sections_wider = 8.0;    // than the last, where steps have not come beyond it
constexpr double carried_step = 0.05;     // rad or mechanism sizes
constexpr double shortest_carry = 1e-6;   // of a change

constexpr const char* not_proved_way = "a nearly singular place, through which the way is not proved";
constexpr const char* acts_words = "acts";
constexpr const char* is_slack_words = "is slack";

std::string in_words(const Scene& scene, const PathEvent& event) {
  const auto item = static_cast<std::size_t>(event.item);
  switch (event.kind) {
    case PathEvent::Kind::stop:
      return fmt::format("stop \"{}\" {}", scene.stops[item].name, event.on ? "comes on" : "comes off");
    case PathEvent::Kind::slack:
      return fmt::format("\"{}\" {}", scene.elements[item].name, event.on ? acts_words : is_slack_words);
    case PathEvent::Kind::fold:
      return "fold";
    case PathEvent::Kind::branch:
      return "branch point";
    default:
      return "";
  }
}

// One-way springs that act in one of two positions and are slack in the other.
void add_changes_of_springs(const Scene& before, const BodyPoses& from, const Scene& after, const BodyPoses& to,
                            std::vector<std::string>& passed) {
  const std::vector<int> springs = VariedMechanism::one_way_springs(before);
  if (springs.empty()) return;
  const Readings first = readings_of(before, from), last = readings_of(after, to);
  for (const int e : springs) {
    const auto at = static_cast<std::size_t>(e);
    if (first.elements[at].slack == last.elements[at].slack) continue;
    passed.push_back(
        fmt::format("\"{}\" {}", before.elements[at].name, first.elements[at].slack ? acts_words : is_slack_words));
  }
}

// Whether a point of one is a point of the other.
bool have_same_coordinates(const Layout& a, const Layout& b) {
  if (a.kept != b.kept) return false;
  for (int i = 0; i < a.kept; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Coordinate &one = a.coordinates[at], &other = b.coordinates[at];
    if (one.kind != other.kind || one.name != other.name) return false;
  }
  return true;
}

// A guess belongs to a body or a joint by its place.
bool have_same_places(const Scene& a, const Scene& b) {
  return a.bodies.size() == b.bodies.size() && a.joints.size() == b.joints.size();
}

// Travels depend on the places of points, which may change.
Scene starting_as(Scene scene, const Scene& other) {
  scene.start = other.start;
  return scene;
}

struct Spot {
  double part = 0.0;      // of a change
  std::vector<double> x;  // coordinates there
};

/// Proved steps from one scene towards another.
struct Stepped {
  Stepped(const Scene& before, const Scene& after, const BodyPoses& from, const std::vector<int>& active_stops,
          int& tries_left, const std::atomic<bool>* interrupt)
      : poses(from) {
    if (!have_same_places(before, after)) return;
    const Scene here = started_at(before, from), there = starting_as(after, here);
    if (in_one(here, there, active_stops)) return;
    try {
      varied.emplace(here, there);
    } catch (const InputError&) {
      return;  // more than numbers differs
    }
    std::unique_ptr<StaticModel> model = varied->model_at(0.0);
    spots.push_back({0.0, model->start()});
    int same = 0;  // steps until a longer one is tried again
    for (; part < 1.0 && step >= shortest_part && tries_left > 0; --tries_left) {
      if (interrupt != nullptr && *interrupt) break;
      const double to = std::min(1.0, part + step);
      auto next = varied->model_at(to);
      if (auto at = followed_in_one_step(*model, spots.back().x, active_stops, *next)) {
        model = std::move(next);
        part = to;
        spots.push_back({part, std::move(*at)});
        if (same-- <= 0) step *= 2.0;
      } else {
        step *= 0.5;
        same = part > 0.0 ? 3 : 0;
      }
    }
    if (part > 0.0) poses = model->poses(spots.back().x);
  }

  // The last of which some coordinate differs by so much from the end, or the first.
  const Spot& before_end(double by) const {
    const auto is_far = [&](const Spot& spot) { return solvers::largest_difference(spot.x, spots.back().x) > by; };
    const auto at = std::find_if(spots.rbegin(), spots.rend(), is_far);
    return at == spots.rend() ? spots.front() : *at;
  }

  std::vector<Spot> spots;            ///< to which they lead, where one step was too long
  double part = 0.0;                  ///< of the change, to which they lead
  double step = 0.5;                  ///< of which the last was too long
  BodyPoses poses;                    ///< there
  std::optional<VariedScene> varied;  ///< where one step was too long

 private:
  bool in_one(const Scene& here, const Scene& there, const std::vector<int>& active_stops) {
    const StaticModel to(there);
    const StaticModel from(here, to.scales());
    if (!have_same_coordinates(from.layout(), to.layout())) return false;
    const auto x = followed_in_one_step(from, from.start(), active_stops, to);
    if (!x) return false;
    poses = to.poses(*x);
    part = 1.0;
    return true;
  }
};

/// A load path over a part of a change.
struct Section {
  bool arrived = false;
  bool has_events = false;
  Scene scene;  ///< where it ends
  BodyPoses poses;
  std::vector<int> active_stops;
  std::vector<std::string> passed;
  std::vector<Transition::Course> courses;
};

// Where a curve leads on while the numbers stand still every pose is in equilibrium, and it may move in no time: from
// one stop to another, say, where the force that pressed it against one passes zero.
std::vector<Transition::Course> free_motions(const VariedScene& varied, const PathBranch& branch) {
  std::vector<Transition::Course> out;
  bool moves = false;
  for (std::size_t k = 1; k < branch.points.size(); ++k) {
    const PathPoint &from = branch.points[k - 1], &to = branch.points[k];
    const bool stands_still = std::abs(to.parameter - from.parameter) < no_change;
    if (!stands_still || solvers::largest_difference(from.x, to.x) < no_motion) {
      moves = false;
      continue;
    }
    const auto model = varied.model_at(to.parameter);
    if (!moves) out.push_back({"nothing holds it there: it moves to where it rests", {model->poses(from.x)}});
    out.back().poses.push_back(model->poses(to.x));
    moves = true;
  }
  return out;
}

// `longest_step`: parts of the section, rad, mechanism sizes. Empty where the equilibrium does not depend on what
// changes, or no equilibrium was found at its beginning.
std::optional<Section> section_along(const VariedScene& varied, double longest_step, const TrackedOptions& settings) {
  PathOptions options;
  options.from = PathOptions::From::given;
  options.start = varied.model_at(0.0)->start();
  options.follow = PathOptions::Follow::load;
  options.certify = false;
  options.courses = true;
  options.spacing = 1.0;
  options.longest_step = longest_step;
  options.most_points = most_points;
  options.certificate = settings.certificate;
  options.interrupt = settings.interrupt;
  Path found;
  try {
    found = path(varied, options);
  } catch (const InputError&) {
    return std::nullopt;
  }
  if (found.branches.empty() || found.branches.back().points.empty()) return std::nullopt;
  Section out;
  out.has_events = !found.events.empty();
  for (const PathEvent& event : found.events) {
    if (event.kind == PathEvent::Kind::snap) {
      const auto model = varied.model_at(event.at.parameter);
      Transition::Course course{
          fmt::format("it snaps at {}, where the stable equilibrium ends", place_in_words(varied, event.at.parameter)),
          {}};
      for (const std::vector<double>& x : event.course) course.poses.push_back(model->poses(x));
      if (!course.poses.empty()) out.courses.push_back(std::move(course));
    } else if (std::string words = in_words(varied.scene(), event); !words.empty()) {
      out.passed.push_back(std::move(words));
    }
  }
  for (const PathBranch& branch : found.branches) {
    for (Transition::Course& course : free_motions(varied, branch)) out.courses.push_back(std::move(course));
  }
  const PathBranch& last = found.branches.back();
  const PathPoint& point = last.points.back();
  out.poses = varied.model_at(point.parameter)->poses(point.x);
  out.scene = varied.scene_at(point.parameter);
  out.active_stops = point.active_stops;
  out.arrived = last.end == PathBranch::End::range && point.parameter == 1.0;
  return out;
}

// Where proved steps come to an end but a load path finds nothing it may have stepped over something, and takes shorter
// steps.
std::optional<Section> section_between(const Scene& from, const Scene& to, const BodyPoses& poses,
                                       const TrackedOptions& settings) {
  std::optional<VariedScene> varied;
  if (!have_same_places(from, to)) return std::nullopt;
  try {
    const Scene here = started_at(from, poses);
    varied.emplace(here, starting_as(to, here));
  } catch (const InputError&) {
    return std::nullopt;
  }
  std::optional<Section> out = section_along(*varied, usual_step, settings);
  if (!out || out->has_events || !out->arrived) return out;
  std::optional<Section> fine = section_along(*varied, fine_step, settings);
  if (fine && (fine->arrived || fine->has_events)) out = std::move(fine);
  if (!out->has_events) out->passed.emplace_back(not_proved_way);
  return out;
}

}  // namespace

ProvedWay follow_by_steps(const Scene& before, const Scene& after, const BodyPoses& poses,
                          const std::vector<int>& active_stops, const std::atomic<bool>* interrupt, int tries) {
  int tries_left = tries;
  Stepped way(before, after, poses, active_stops, tries_left, interrupt);
  return {way.part, std::move(way.poses), 1 + tries - tries_left};  // the first is the whole change in one
}

FollowedChange follow_change(const Scene& before, const Scene& after, const BodyPoses& poses,
                             const std::vector<int>& active_stops, const TrackedOptions& options, int tries) {
  FollowedChange out;
  Transition& transition = out.transition;
  transition.kind = Transition::Kind::followed;
  out.poses = poses;
  out.scene = before;
  std::vector<int> active = active_stops;
  double width = 0.0;
  int tries_left = tries;
  for (int k = 0; k < most_sections; ++k) {
    Stepped way(out.scene, after, out.poses, active, tries_left, options.interrupt);
    out.arrived = way.part == 1.0;
    if (out.arrived) {
      add_changes_of_springs(out.scene, out.poses, after, way.poses, transition.passed);
      out.poses = std::move(way.poses);
      out.scene = after;
      break;
    }
    if (!way.varied) break;
    // A short part at first, in which the path shows what has ended the steps; from a little before, because nothing
    // can be followed from a fold.
    const Spot& first = way.before_end(section_before);
    const bool is_same = width > 0.0 && way.part <= width;
    width = is_same ? sections_wider * width : std::max(way.part - first.part, least_width);
    const bool is_rest = tries_left == 0 || k + 1 == most_sections || way.part + width >= 1.0;
    const Scene next = is_rest ? after : way.varied->scene_at(way.part + width);
    const Scene begin = way.varied->scene_at(first.part);
    const BodyPoses from = way.varied->model_at(first.part)->poses(first.x);
    add_changes_of_springs(out.scene, out.poses, begin, from, transition.passed);
    std::optional<Section> section = section_between(begin, next, from, options);
    if (!section) {
      out.poses = std::move(way.poses);
      out.scene = way.varied->scene_at(way.part);
      break;
    }
    for (std::string& words : section->passed) transition.passed.push_back(std::move(words));
    for (Transition::Course& course : section->courses) transition.courses.push_back(std::move(course));
    out.scene = std::move(section->scene);
    out.poses = std::move(section->poses);
    active = std::move(section->active_stops);
    if (!section->arrived) break;
    if (!is_rest) continue;
    out.arrived = true;
    out.scene = after;
    break;
  }
  if (!transition.courses.empty()) {
    transition.kind = Transition::Kind::snapped;
    transition.why = transition.courses.back().why;
  }
  return out;
}

std::vector<BodyPoses> carry(const Scene& before, const Scene& after, const BodyPoses& poses, int tries) {
  std::vector<BodyPoses> out{poses};
  if (!have_same_places(before, after)) return out;
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
    --tries;
    const double to = std::min(1.0, part + step);
    const auto model = varied->model_at(to);
    solvers::Newton closing(model->problem(), settings);
    const solvers::NewtonResult& closed = closing.close(x);
    const bool is_near =
        closed.end == solvers::NewtonEnd::converged && solvers::largest_difference(closed.x, x) < carried_step;
    if (is_near) {
      if (solvers::largest_difference(closed.x, x) > 0.0) out.push_back(model->poses(closed.x));
      x = closed.x;
      part = to;
      step *= 2.0;
      continue;
    }
    step *= 0.5;
    if (step < shortest_carry) {
      const std::string stops = stops_at_limits(*varied->model_at(part), x);
      throw InputError(fmt::format("the loops close no further than {}, {}; change it by less",
                                   place_in_words(*varied, part),
                                   stops.empty() ? "where the links allow no motion" : "where held by " + stops));
    }
    if (tries <= 0) throw InputError("the loops are not closed in as many steps as may be taken; change it by less");
  }
  return out;
}

}  // namespace poise

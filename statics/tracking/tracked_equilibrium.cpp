#include "statics/tracking/tracked_equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "solvers/newton.hpp"
#include "statics/tracking/private/dragged_point.hpp"
#include "statics/tracking/private/followed_change.hpp"

namespace poise {
namespace {

constexpr double still = 1e-9;           // rad or mechanism sizes: it rests where it did
constexpr double expected_place = 1e-6;  // the same: a search ended where it was expected to
constexpr double near_place = 0.1;       // the same: near a position that is asked for
constexpr double cosine_of_turn = 0.95;  // of a way along which a hand holds in one direction

constexpr int few_tries = 6;  // of steps, before it is known whether a place can be reached

constexpr const char* cannot_move = "{} cannot move";
constexpr const char* no_further = "it can go no further that way";

std::string unused_name(const Scene& scene, std::string name) {
  const auto used = [&](const Stop& stop) { return stop.name == name; };
  while (std::any_of(scene.stops.begin(), scene.stops.end(), used)) name += " (drag)";
  return name;
}

Measure along(Vec2 direction, PointRef point) {
  if (direction == Vec2{1, 0}) return Measure::x_of(point);
  if (direction == Vec2{0, 1}) return Measure::y_of(point);
  return Measure::sum_of({{direction.x, Measure::x_of(point)}, {direction.y, Measure::y_of(point)}});
}

Vec2 place_of(const Scene& scene, const BodyPoses& poses, PointRef point) {
  return poses[static_cast<std::size_t>(point.body)].world(scene.local(point));
}

/// The scene with a point held in these directions at a place, m.
Scene with_hand(Scene scene, PointRef point, const std::vector<Vec2>& directions, Vec2 place) {
  const char* const names[] = {"hand x", "hand y"};
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const double value = dot(directions[k], place);
    std::string name = unused_name(scene, directions.size() == 1 ? "hand" : names[k]);
    scene.stops.push_back({.name = std::move(name), .on = along(directions[k], point), .min = value, .max = value});
  }
  return scene;
}

// Compares the bodies of a scene. Poses of bars follow from theirs, but for whole turns.
double largest_difference(const Scene& scene, const BodyPoses& a, const BodyPoses& b, double length) {
  double most = 0.0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    most = std::max({most, std::abs(a[i].angle - b[i].angle), norm(a[i].origin - b[i].origin) / length});
  }
  return most;
}

/// The number, or 0 for one so small that no scene file may hold it (Range::finite).
double writable(double value) { return std::abs(value) < 1e-50 ? 0.0 : value; }

/// Per body: a chain of joints connects it with the ground, bars left out, so that no start needs its place.
std::vector<char> jointed_to_ground(const Scene& scene) {
  std::vector<char> out(scene.bodies.size(), 0);
  out[0] = 1;
  for (bool grows = true; grows;) {
    grows = false;
    for (const Joint& joint : scene.joints) {
      char &a = out[static_cast<std::size_t>(joint.a.body)], &b = out[static_cast<std::size_t>(joint.b.body)];
      if (joint.keeps_length() || a == b) continue;
      a = b = 1;
      grows = true;
    }
  }
  return out;
}

/// Whether a part of the way of a point leads away from a unit vector along which it is held.
bool turns_away(Vec2 part, Vec2 along) { return std::abs(dot(part, along)) < cosine_of_turn * norm(part); }

/// How a dragged point came to where it is.
Transition way_of(const DraggedPoint& walk) {
  Transition out;
  if (!walk.held_up_by().empty()) {
    out.kind = Transition::Kind::blocked;
    out.why = fmt::format("stop \"{}\" holds it up", walk.held_up_by());
  } else if (walk.locked()) {
    out.kind = Transition::Kind::blocked;
    out.why = no_further;
  } else {
    out.kind = Transition::Kind::followed;
  }
  return out;
}

/// Whether the scenes have the same parts that act or hold, in the same order.
bool has_same_parts(const Scene& a, const Scene& b) {
  const auto alike = [](const auto& p, const auto& q) {
    return std::equal(p.begin(), p.end(), q.begin(), q.end(),
                      [](const auto& one, const auto& other) { return one.name == other.name; });
  };
  return alike(a.joints, b.joints) && alike(a.elements, b.elements) && alike(a.forces, b.forces) &&
         alike(a.torques, b.torques) && alike(a.stops, b.stops);
}

/// Whether the bodies of one scene can be placed as those of the other.
bool has_same_bodies(const Scene& a, const Scene& b) {
  return std::equal(a.bodies.begin(), a.bodies.end(), b.bodies.begin(), b.bodies.end(),
                    [](const Body& p, const Body& q) { return p.name == q.name; });
}

}  // namespace

std::string to_string(Transition::Kind kind) {
  switch (kind) {
    case Transition::Kind::none:
      return "none";
    case Transition::Kind::followed:
      return "followed";
    case Transition::Kind::snapped:
      return "snapped";
    case Transition::Kind::settled:
      return "settled";
    case Transition::Kind::blocked:
      return "blocked";
  }
  return "unknown";
}

Scene started_at(Scene scene, const BodyPoses& poses) {
  const Readings readings = readings_of(scene, poses);
  const std::vector<char> is_jointed = jointed_to_ground(scene);
  scene.start.angle.resize(scene.bodies.size());
  scene.start.position.resize(scene.bodies.size());
  scene.start.travel.resize(scene.joints.size());
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    scene.start.angle[i] = writable(poses[i].angle);
    // A place that is given counts for the angles of bars, of a body that needs none too.
    if (!is_jointed[i] || scene.start.position[i]) {
      scene.start.position[i] = {writable(poses[i].origin.x), writable(poses[i].origin.y)};
    }
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (scene.joints[j].has_travel()) scene.start.travel[j] = writable(readings.travel[j]);
  }
  return scene;
}

std::optional<BodyPoses> closed_near(const Scene& scene, const BodyPoses& poses) {
  const StaticModel model(started_at(scene, poses));
  if (model.mechanism().constraints() == 0) return poses;
  solvers::NewtonOptions settings;
  settings.closing_starts = 0;
  solvers::Newton closing(model.problem(), settings);
  const solvers::NewtonResult& closed = closing.close(model.start());
  if (closed.end != solvers::NewtonEnd::converged) return std::nullopt;
  return model.poses(closed.x);
}

MovedPoint moved_point(const Scene& scene, const BodyPoses& poses, PointRef point, Vec2 place,
                       const std::atomic<bool>* interrupt) {
  DraggedPoint walk(started_at(scene, poses), point, interrupt);
  if (walk.directions().empty()) throw InputError(fmt::format(cannot_move, scene.name_of(point)));
  walk.go_to(place, false);
  return {walk.poses(), way_of(walk)};
}

TrackedEquilibrium::TrackedEquilibrium(Scene scene, const TrackedOptions& options) : options_(options) {
  restore(std::move(scene));
}

void TrackedEquilibrium::restore(Scene scene) {
  Found found;
  found.model = std::make_shared<const StaticModel>(scene);
  SolveOptions solving;
  solving.certificate = options_.certificate;
  solving.interrupt = options_.interrupt;
  found.equilibrium = solve(*found.model, solving);
  if (!found.equilibrium.found()) found.equilibrium.x = assemble(*found.model);
  take(std::move(scene), std::nullopt, std::move(found));
}

void TrackedEquilibrium::stay_at(const BodyPoses& poses) {
  Found found = found_at(scene_, poses, near_place);
  if (!found.equilibrium.found()) throw InputError("no equilibrium was found there: " + found.equilibrium.why);
  take(scene_, std::nullopt, std::move(found));
}

Transition TrackedEquilibrium::settled_from_start(const std::string& why) const {
  Transition out;
  out.kind = Transition::Kind::settled;
  out.why = why;
  if (!equilibrium_.found()) return out;
  const Settling rest =
      settle(*model_, model_->start(), {.sides = false, .course = true, .interrupt = options_.interrupt});
  if (rest.end != Settling::End::settled) return out;
  Transition::Course course{why, {}};
  for (const std::vector<double>& x : rest.course) course.poses.push_back(model_->poses(x));
  course.poses.push_back(poses());
  const double way = largest_difference(scene_, course.poses.front(), course.poses.back(), model_->scales().length);
  if (way > expected_place) out.courses.push_back(std::move(course));
  return out;
}

void TrackedEquilibrium::take(Scene scene, std::optional<Hand> hand, Found found) {
  const BodyPoses poses = found.model->poses(found.equilibrium.x);
  scene_ = started_at(std::move(scene), poses);
  hand_ = std::move(hand);
  movable_.reset();
  model_ = std::move(found.model);
  equilibrium_ = std::move(found.equilibrium);
}

// `within`: rad or mechanism sizes.
TrackedEquilibrium::Found TrackedEquilibrium::found_at(Scene scene, const BodyPoses& poses, double within) const {
  Found out;
  out.model = std::make_shared<const StaticModel>(started_at(std::move(scene), poses));
  SolveOptions solving;
  solving.seek = Seek::any;
  solving.safeguards.restarts = solving.safeguards.load_stepping = false;
  solving.certificate = options_.certificate;
  solving.interrupt = options_.interrupt;
  Equilibrium& equilibrium = out.equilibrium;
  const auto distance = [&] {
    return largest_difference(scene_, poses, out.model->poses(equilibrium.x), out.model->scales().length);
  };
  equilibrium = poise::solve(*out.model, out.model->start(), solving);
  if (equilibrium.found() && equilibrium.certificate.outcome == Outcome::neutral && distance() > expected_place) {
    // The one there is sought of all that are as good.
    solving.tolerance = expected_place;
    Equilibrium nearer = poise::solve(*out.model, out.model->start(), solving);
    if (nearer.found()) equilibrium = std::move(nearer);
  }
  const double far = distance();
  if (equilibrium.found() && equilibrium.certificate.outcome != Outcome::neutral && far > within) {
    equilibrium.status = Status::elsewhere;
    equilibrium.why += fmt::format("; it left the position sought for one {:.2g} (rad or sizes) away", far);
  }
  if (!equilibrium.found()) equilibrium.x = out.model->start();
  return out;
}

// `carried`: positions that lead to the one in which it is released, with other numbers.
TrackedEquilibrium::Found TrackedEquilibrium::settled_from(Scene scene, std::vector<BodyPoses> carried, bool falls,
                                                           const std::string& why, Transition& transition,
                                                           const DragLimits& limits) const {
  Found out;
  out.model = std::make_shared<const StaticModel>(started_at(std::move(scene), carried.back()));
  const BodyPoses first = carried.front(), released = carried.back();
  Settling rest = settle(*out.model, out.model->start(),
                         {.steps = limits.settling_steps, .course = true, .interrupt = options_.interrupt});
  if (rest.end == Settling::End::not_closed) {
    throw InputError("the loops cannot be closed near the present position; change the number by less");
  }
  if (rest.end == Settling::End::start_unstable && falls && !rest.sides.empty()) {
    rest.end = rest.sides.front().end;
    rest.x = std::move(rest.sides.front().x);
  }
  // It rests where it is released, though not stable.
  if (rest.end == Settling::End::start_unstable) rest.course.clear();
  Transition::Course course{why, {}};
  for (const std::vector<double>& x : rest.course) course.poses.push_back(out.model->poses(x));
  const bool rests = rest.end == Settling::End::settled || rest.end == Settling::End::start_unstable;
  if (!rests) {
    out.equilibrium.status = Status::not_found;
    out.equilibrium.why = rest.why;
    out.equilibrium.x = rest.course.empty() ? out.model->start() : rest.course.front();
    transition.kind = Transition::Kind::settled;
    transition.why = rest.why;
    return out;
  }
  Found found = found_at(out.model->scene(), out.model->poses(rest.x), expected_place);
  const BodyPoses end = found.model->poses(found.equilibrium.x);
  const double length = out.model->scales().length;
  if (largest_difference(scene_, first, end, length) <= still) return found;
  if (found.equilibrium.found() && largest_difference(scene_, released, end, length) <= expected_place) {
    transition.kind = Transition::Kind::followed;
    return found;
  }
  transition.kind = Transition::Kind::settled;
  transition.why = why;
  course.poses.push_back(end);
  transition.courses.push_back(std::move(course));
  return found;
}

// Numbers change: what is stable is followed; from where it can be followed no further, or if it was not, it is carried
// to the last of the numbers, and released.
TrackedEquilibrium::Found TrackedEquilibrium::moved(const Position& at, const Scene& after, const std::string& why,
                                                    Transition& transition, const DragLimits& limits) const {
  BodyPoses poses = at.poses;
  Scene scene = at.scene;
  Transition way;
  if (at.is_stable) {
    const int tries = std::min(most_tries, limits.proved_steps);
    FollowedChange change = follow_change(at.scene, after, at.poses, at.active_stops, options_, tries);
    if (change.arrived) {
      Found found = found_at(after, change.poses, expected_place);
      if (found.equilibrium.found()) {
        transition = std::move(change.transition);
        return found;
      }
    }
    poses = std::move(change.poses);
    scene = std::move(change.scene);
    way = std::move(change.transition);
  }
  way.kind = Transition::Kind::none;
  way.why.clear();
  // At the end of its reach, where nothing that is proved leads on, a point is not let go.
  if (limits.settling_steps == 0 && way.courses.empty()) throw InputError(no_further);
  std::vector<BodyPoses> carried = carry(scene, after, poses, limits.proved_steps / 2);
  Found found = settled_from(after, std::move(carried), at.is_stable, why, way, limits);
  if (way.kind != Transition::Kind::settled) {
    const double far =
        largest_difference(scene_, at.poses, found.model->poses(found.equilibrium.x), found.model->scales().length);
    if (!way.courses.empty()) {
      way.kind = Transition::Kind::snapped;
      way.why = way.courses.back().why;
    } else if (far > still) {
      way.kind = Transition::Kind::followed;
    }
  }
  transition = std::move(way);
  return found;
}

TrackedEquilibrium::Position TrackedEquilibrium::position_of(const StaticModel& model, const Equilibrium& equilibrium) {
  const Certificate& certificate = equilibrium.certificate;
  const bool is_stable =
      equilibrium.found() && certificate.outcome != Outcome::neutral && certificate.stability == Stability::stable;
  return {model.scene(), model.poses(equilibrium.x), certificate.active_stops, is_stable};
}

Transition TrackedEquilibrium::change(Scene wanted) {
  Transition out;
  if (!has_same_bodies(scene_, wanted)) {
    restore(std::move(wanted));
    out.kind = Transition::Kind::settled;
    out.why = "another mechanism, which was released from its start";
    return out;
  }
  Position now = position_of(*model_, equilibrium_);
  now.is_stable = now.is_stable && has_same_parts(scene_, wanted);
  Scene scene = started_at(wanted, now.poses);
  if (hand_) scene = with_hand(std::move(scene), hand_->at, hand_->along, place_of(scene_, now.poses, hand_->at));
  Found found = moved(now, scene, "released where it was, it moved to where it rests", out);
  const double far =
      largest_difference(scene_, now.poses, found.model->poses(found.equilibrium.x), found.model->scales().length);
  if (out.kind == Transition::Kind::followed && far <= still) out.kind = Transition::Kind::none;
  take(std::move(wanted), hand_, std::move(found));
  return out;
}

Transition TrackedEquilibrium::drag(PointRef point, Vec2 place, const DragLimits& limits) {
  DraggedPoint walk(scene_, point, options_.interrupt);
  const std::vector<Vec2> along = walk.directions();
  if (along.empty() && movable_ && hand_ && hand_->at == point) return drag_back(point, place, limits);
  if (along.empty()) throw InputError(fmt::format(cannot_move, scene_.name_of(point)));
  BodyPoses begin = poses();
  Transition way = walk.freedoms() > static_cast<int>(along.size()) ? drag_in_equilibrium(point, place, limits)
                                                                    : drag_all(walk, along, point, place, limits);
  movable_ = std::move(begin);
  return way;
}

// At the very end of its way a point cannot move, to first order: it goes back to where the last drag began, and from
// there.
Transition TrackedEquilibrium::drag_back(PointRef point, Vec2 place, const DragLimits& limits) {
  const BodyPoses there = *movable_;
  const std::vector<Vec2> along = DraggedPoint(started_at(scene_, there), point).directions();
  Found before = found_at(with_hand(scene_, point, along, place_of(scene_, there, point)), there, expected_place);
  if (along.empty() || !before.equilibrium.found()) {
    throw InputError(fmt::format(cannot_move, scene_.name_of(point)));
  }
  TrackedEquilibrium now = *this;
  take(started_at(scene_, there), Hand{point, along}, std::move(before));
  try {
    return drag(point, place, limits);
  } catch (const InputError&) {
    *this = std::move(now);
    throw;
  }
}

// The hand leaves no freedom.
Transition TrackedEquilibrium::drag_all(DraggedPoint& walk, const std::vector<Vec2>& along, PointRef point, Vec2 place,
                                        const DragLimits& limits) {
  // A hand that moves in an area moves straight, where it can.
  const Vec2 from = walk.place();
  int tried = 0;
  const auto straight = [&](Vec2 to, int tries) {
    ProvedWay way = follow_by_steps(with_hand(scene_, point, along, from), with_hand(scene_, point, along, to), poses(),
                                    {}, options_.interrupt, std::min(tries, limits.proved_steps - tried));
    tried += way.tries;
    return way.part == 1.0 ? std::optional(std::move(way.poses)) : std::nullopt;
  };
  if (along.size() == 2) {
    if (const auto there = straight(place, few_tries)) {
      Found found = found_at(with_hand(scene_, point, along, place), *there, expected_place);
      if (found.equilibrium.found()) {
        take(scene_, Hand{point, along}, std::move(found));
        Transition out;
        out.kind = Transition::Kind::followed;
        out.proved_steps = tried;
        return out;
      }
    }
  }
  walk.go_to(place);
  Transition out = way_of(walk);
  walk.clear_stops();
  BodyPoses there = walk.poses();
  std::vector<Vec2> directions = walk.directions();
  if (directions.empty()) directions = along;
  if (along.size() == 2 && directions == along && tried < limits.proved_steps) {
    if (auto direct = straight(walk.place(), most_tries)) there = std::move(*direct);
  }
  Found found = found_at(with_hand(scene_, point, directions, walk.place()), there, expected_place);
  take(scene_, Hand{point, directions}, std::move(found));
  out.proved_steps = tried;
  return out;
}

// What the hand leaves free is in equilibrium all the way. At the end of its reach hardly any force holds a point, and
// what is not found there is found a little before; with limits that is where it is held already.
Transition TrackedEquilibrium::drag_in_equilibrium(PointRef point, Vec2 place, const DragLimits& limits) {
  const Vec2 from = place_of(scene_, poses(), point);
  Transition first;
  Hand hand{point, {}};
  Found found = dragged_to(place, hand, limits, first);
  if (!found.equilibrium.found() && equilibrium_.found()) {
    if (limits.near_enough > 0.0 && hand_ && hand_->at == point) {
      Transition stays;
      stays.kind = Transition::Kind::blocked;
      stays.why = no_further;
      stays.proved_steps = first.proved_steps;
      return stays;
    }
    for (const double part : {0.9, 0.5}) {
      const Vec2 there = place_of(scene_, found.model->poses(found.equilibrium.x), point);
      Transition out;
      Hand other{point, {}};
      Found nearer = dragged_to(from + part * (there - from), other, limits, out);
      first.proved_steps += out.proved_steps;
      if (!nearer.equilibrium.found()) continue;
      if (out.kind == Transition::Kind::followed) {
        out.kind = Transition::Kind::blocked;
        out.why = no_further;
      }
      out.proved_steps = first.proved_steps;
      take(scene_, std::move(other), std::move(nearer));
      return out;
    }
  }
  take(scene_, std::move(hand), std::move(found));
  return first;
}

TrackedEquilibrium::Found TrackedEquilibrium::dragged_to(Vec2 place, Hand& hand, const DragLimits& limits,
                                                         Transition& out) const {
  const std::string why = "what the hand leaves free moved to where it rests";
  Position now = position_of(*model_, equilibrium_);
  std::optional<DraggedPoint> walk(std::in_place, scene_, hand.at, options_.interrupt);
  std::vector<Vec2>& along = hand.along;
  along = walk->directions();
  std::optional<Found> found;
  std::vector<Vec2> held_along;  // in what was found, which the way may turn out of
  const auto with_hand_at = [&](Vec2 there) { return with_hand(started_at(scene_, now.poses), hand.at, along, there); };
  now.scene = with_hand_at(walk->place());
  if (!equilibrium_.found() || (hand_ && hand_->at != hand.at)) {
    found = settled_from(now.scene, {now.poses}, true, why, out, limits);
    held_along = along;
    now = position_of(*found->model, found->equilibrium);
    walk.emplace(started_at(scene_, now.poses), hand.at, options_.interrupt);
    along = walk->directions();
  }
  // The equilibrium at these poses, to which it was followed.
  const auto arrival_at = [&](const BodyPoses& there) -> std::optional<Found> {
    Found arrived = found_at(with_hand_at(place), there, expected_place);
    if (!arrived.equilibrium.found()) return std::nullopt;
    if (out.kind == Transition::Kind::none) out.kind = Transition::Kind::followed;
    return arrived;
  };
  const auto steps_to = [&](Vec2 there, int tries) {
    ProvedWay out_of = follow_by_steps(now.scene, with_hand_at(there), now.poses, now.active_stops, options_.interrupt,
                                       std::min(tries, limits.proved_steps - out.proved_steps));
    out.proved_steps += out_of.tries;
    return out_of;
  };
  const auto arrival_by_steps = [&](int tries) -> std::optional<Found> {
    const ProvedWay there = steps_to(place, tries);
    return there.part == 1.0 ? arrival_at(there.poses) : std::nullopt;
  };
  // Where it can be held just there no walk has to say how near it comes; where it is out of reach no number of steps
  // leads there.
  const bool may_go_straight = along.size() == 2 && now.is_stable;
  if (may_go_straight) {
    if (auto arrived = arrival_by_steps(few_tries)) return std::move(*arrived);
  }
  walk->go_to(place);
  Transition way = way_of(*walk);
  if (may_go_straight && limits.near_enough > 0.0 && walk->held_up_by().empty()) {
    // As far as the steps that are left lead towards where it can come.
    const double near = limits.near_enough * model_->scales().length;
    const ProvedWay part = steps_to(walk->place(), most_tries);
    const Vec2 begin = place_of(scene_, now.poses, hand.at), end = place_of(scene_, part.poses, hand.at);
    const bool is_there = part.part == 1.0 || norm(walk->place() - end) <= near;
    if (is_there || norm(end - begin) > near) {
      Found reached = found_at(with_hand_at(end), part.poses, expected_place);
      if (reached.equilibrium.found()) {
        out.kind = is_there ? way.kind : Transition::Kind::followed;
        if (is_there) out.why = way.why;
        out.unfinished = !is_there && norm(place - end) < norm(place - begin);
        return reached;
      }
    }
  } else if (may_go_straight && way.kind == Transition::Kind::followed) {
    if (auto arrived = arrival_by_steps(most_tries)) return std::move(*arrived);
  }
  // A stop that holds the walk up need not be in the way of those in equilibrium.
  if (along.size() == 2 && now.is_stable && !walk->held_up_by().empty()) {
    FollowedChange direct = follow_change(now.scene, with_hand_at(place), now.poses, now.active_stops, options_);
    if (direct.arrived && direct.transition.kind == Transition::Kind::followed) {
      if (auto arrived = arrival_at(direct.poses)) {
        for (std::string& words : direct.transition.passed) out.passed.push_back(std::move(words));
        return std::move(*arrived);
      }
    }
  }
  DragLimits last_limits = limits;
  const bool is_out_of_reach =
      walk->held_up_by().empty() && norm(walk->place() - place) > limits.near_enough * model_->scales().length;
  if (limits.near_enough > 0.0 && is_out_of_reach) last_limits.settling_steps = 0;
  // Whether it came there without a jump.
  const auto go_to = [&](Vec2 there) {
    Transition step;
    now.scene = with_hand_at(place_of(scene_, now.poses, hand.at));
    found = moved(now, with_hand_at(there), why, step, last_limits);
    held_along = along;
    now = position_of(*found->model, found->equilibrium);
    for (std::string& words : step.passed) out.passed.push_back(std::move(words));
    for (Transition::Course& course : step.courses) out.courses.push_back(std::move(course));
    const bool jumped = step.kind == Transition::Kind::snapped || step.kind == Transition::Kind::settled;
    if (jumped) {
      out.kind = step.kind;
      out.why = std::move(step.why);
    }
    return !jumped;
  };
  try {
    if (along.size() == 2) {
      go_to(walk->place());
    } else {
      // The directions in which it is held turn with the way. After a jump the way is another.
      const std::vector<Vec2>& passed = walk->passed();
      for (std::size_t k = 0; k < passed.size(); ++k) {
        const bool is_last = k + 1 == passed.size();
        if (!is_last && !turns_away(passed[k + 1] - passed[k], along.front())) continue;
        if (!go_to(passed[k]) || is_last) break;
        if (auto next = DraggedPoint(started_at(scene_, now.poses), hand.at).directions(); !next.empty()) {
          along = std::move(next);
        }
      }
    }
  } catch (const InputError&) {
    way.kind = Transition::Kind::blocked;
    way.why = no_further;
  }
  std::vector<Vec2> last = DraggedPoint(started_at(scene_, now.poses), hand.at).directions();
  if (!last.empty()) along = std::move(last);
  if (!found || held_along != along) {
    found = found_at(with_hand_at(place_of(scene_, now.poses, hand.at)), now.poses, expected_place);
  }
  if (out.kind != Transition::Kind::snapped && out.kind != Transition::Kind::settled) {
    out.kind = way.kind;
    out.why = way.why;
  }
  return std::move(*found);
}

Vec2 TrackedEquilibrium::force_of_hand() const {
  Vec2 sum{};
  if (!hand_ || !equilibrium_.found()) return sum;
  for (std::size_t k = 0; k < hand_->along.size(); ++k) {
    // The axial force alone says how large the force of a stop on a sum of measures is.
    const Reaction* const reaction = reaction_of_stop(equilibrium_.check.reactions, scene_.stops.size() + k);
    if (reaction != nullptr) sum += -reaction->axial * hand_->along[k];
  }
  return sum;
}

Transition TrackedEquilibrium::release() {
  Transition out;
  if (!hand_) return out;
  Found found = settled_from(scene_, {poses()}, false, "let go, it moved to where it rests", out);
  take(scene_, std::nullopt, std::move(found));
  return out;
}

}  // namespace poise

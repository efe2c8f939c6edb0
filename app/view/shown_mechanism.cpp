#include "app/view/shown_mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "model/couplings.hpp"
#include "statics/model/mobility.hpp"

namespace poise::app {
namespace {

/// Somebody waits for each picture, and a step of a large mechanism takes longer. A third of a px is next to nothing.
DragLimits limits_of_drag(const Scene& scene) {
  const int bodies = static_cast<int>(scene.bodies.size());
  return {.proved_steps = std::clamp(320 / bodies, 12, 64),
          .settling_steps = std::clamp(1600 / bodies, 30, 400),
          .near_enough = 5e-4};
}

/// What the message of an error says behind the place in the file.
std::string without_place(const std::string& message, const std::string& file) {
  if (file.empty() || !message.starts_with(file + ":")) return message;
  std::size_t at = file.size() + 1;
  const std::size_t digits = message.find_first_not_of("0123456789", at);
  if (digits != at && digits != std::string::npos && message[digits] == ':') at = digits + 1;
  return message.substr(std::min(message.find_first_not_of(' ', at), message.size()));
}

bool has_other_items(const Scene& a, const Scene& b) {
  return a.bodies.size() != b.bodies.size() || a.joints.size() != b.joints.size() ||
         a.elements.size() != b.elements.size() || a.stops.size() != b.stops.size() ||
         a.forces.size() != b.forces.size() || a.torques.size() != b.torques.size();
}

/// The pose of the body at the other end of a joint whose body at this end stands at `base`.
BodyPose<double> joined(const Scene& scene, std::size_t joint_index, bool from_a, const BodyPose<double>& base) {
  const Joint& joint = scene.joints[joint_index];
  const PointRef near = from_a ? joint.a : joint.b, far = from_a ? joint.b : joint.a;
  BodyPose<double> out;
  out.angle = scene.start.angle[static_cast<std::size_t>(far.body)].value_or(0.0);
  if (joint.keeps_angle()) out.angle = base.angle + (from_a ? joint.angle : -joint.angle);
  Vec2 way{};
  if (joint.has_travel()) {
    const double travel = scene.start.travel[joint_index].value_or(0.0);
    const Vec2 axis = (1.0 / norm(joint.axis)) * joint.axis * unit(from_a ? base.angle : out.angle);
    way = (from_a ? travel : -travel) * axis;
  }
  out.origin = base.world(scene.local(near)) + way - scene.local(far) * out.direction();
  return out;
}

/// Bodies that something connects, however many lie between, have one number.
class Connections {
 public:
  explicit Connections(const Scene& scene) : scene_(scene), number_(scene.bodies.size()) {
    std::iota(number_.begin(), number_.end(), 0);
    for (const Joint& joint : scene.joints) connect(joint.a.body, joint.b.body);
    for (const Element& element : scene.elements) first_of(element.on);
    for (const Stop& stop : scene.stops) first_of(stop.on);
  }

  /// The first moving body that nothing connects with the ground; 0 where there is none.
  std::size_t first_free() const {
    const auto free = std::find_if(number_.begin(), number_.end(), [&](int one) { return one != number_[0]; });
    return free == number_.end() ? 0 : static_cast<std::size_t>(free - number_.begin());
  }

 private:
  int connect(int a, int b) {
    const int from = number_[static_cast<std::size_t>(b)], to = number_[static_cast<std::size_t>(a)];
    std::replace(number_.begin(), number_.end(), from, to);
    return a;
  }

  /// Connects all bodies that a measure is taken between, and returns one of them.
  int first_of(const Measure& measure) {
    switch (measure.kind) {
      case Measure::Kind::angle:
        return connect(measure.body_a, measure.body_b);
      case Measure::Kind::distance:
      case Measure::Kind::component:
      case Measure::Kind::clearance:
      case Measure::Kind::along_outline:
      case Measure::Kind::slip_on_cam:
        return connect(measure.a.body, measure.b.body);
      case Measure::Kind::x:
      case Measure::Kind::y:
        return connect(0, measure.b.body);
      case Measure::Kind::travel:
        return scene_.joints[static_cast<std::size_t>(measure.joint)].a.body;
      case Measure::Kind::rope:
        for (const RopeContact& contact : measure.contacts) connect(measure.contacts.front().at.body, contact.at.body);
        return measure.contacts.front().at.body;
      case Measure::Kind::sum:
        for (const Measure::Term& term : measure.terms)
          connect(first_of(measure.terms.front().measure), first_of(term.measure));
        return first_of(measure.terms.front().measure);
    }
    return 0;
  }

  const Scene& scene_;
  std::vector<int> number_;
};

/// Throws InputError for what can neither rest nor be asked where it does.
void expect_something_held(const Scene& scene) {
  if (scene.bodies.size() < 2) throw InputError("no link is drawn yet");
  const std::size_t free = Connections(scene).first_free();
  if (free > 0) throw InputError(fmt::format("body \"{}\" is free: nothing holds it", scene.bodies[free].name));
}

/// Measures how far a joint is open, m.
double gap_of(const Scene& scene, const Joint& joint, const BodyPoses& poses) {
  const BodyPose<double>& a = poses[static_cast<std::size_t>(joint.a.body)];
  const Vec2 apart =
      poses[static_cast<std::size_t>(joint.b.body)].world(scene.local(joint.b)) - a.world(scene.local(joint.a));
  if (joint.keeps_length()) return std::abs(norm(apart) - joint.length);
  return joint.has_travel() ? std::abs(cross(joint.direction() * a.direction(), apart)) : norm(apart);
}

/// "pin C is 12 mm open", of the joint that is the farthest; empty where none is.
std::string widest_gap(const Scene& scene, const BodyPoses& poses) {
  double widest = 1e-9 * scene.units.length;
  std::string out;
  for (const Joint& joint : scene.joints) {
    const double gap = gap_of(scene, joint, poses);
    if (gap <= widest) continue;
    widest = gap;
    std::string kind(joint.traits().key);
    std::replace(kind.begin(), kind.end(), '_', ' ');
    out = fmt::format("{} {} is {:.3g} {} open", kind, joint.name, gap / scene.units.length, scene.units.length_name);
  }
  return out;
}

/// Whether the first of two lists of poses has those of the second in the same places, to the last bit.
bool begins_with(const BodyPoses& all, const BodyPoses& first) {
  return all.size() >= first.size() &&
         std::equal(first.begin(), first.end(), all.begin(), [](const auto& one, const auto& other) {
           return one.angle == other.angle && one.origin == other.origin;
         });
}

}  // namespace

BodyPoses drawn_poses(const Scene& scene) {
  BodyPoses out(scene.bodies.size());
  std::vector<bool> placed(scene.bodies.size(), false);
  placed[0] = true;
  const auto place_joined = [&] {
    for (bool more = true; more;) {
      more = false;
      for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        const auto a = static_cast<std::size_t>(scene.joints[j].a.body);
        const auto b = static_cast<std::size_t>(scene.joints[j].b.body);
        // A bar tells a distance, but no place.
        if (placed[a] == placed[b] || scene.joints[j].keeps_length()) continue;
        if (placed[a])
          out[b] = joined(scene, j, true, out[a]);
        else
          out[a] = joined(scene, j, false, out[b]);
        placed[a] = placed[b] = more = true;
      }
    }
  };
  place_joined();
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    if (placed[b]) continue;
    out[b] = {scene.start.position[b].value_or(Vec2{}), scene.start.angle[b].value_or(0.0)};
    placed[b] = true;
    place_joined();
  }
  return out;
}

ShownMechanism::ShownMechanism(Scene scene, const TrackedOptions& options) : options_(options) {
  settle(std::move(scene));
}

void ShownMechanism::settle(Scene scene) {
  std::string missing;
  std::optional<TrackedEquilibrium> tracked;
  try {
    expect_something_held(scene);
    tracked.emplace(scene, options_);
  } catch (const InputError& error) {
    missing = without_place(error.what(), scene.file);
    if (missing.find("nothing can move under load") != std::string::npos)
      missing = "nothing moves under load yet, which takes a link that turns or slides, and a load, a mass or a spring";
  }
  tracked_ = std::move(tracked);
  missing_ = std::move(missing);
  if (tracked_) {
    sketch_ = {};
    drawn_.clear();
  } else {
    show_sketch(std::move(scene));
  }
}

/// Where it was drawn, with its loops closed near there if they can be.
void ShownMechanism::show_sketch(Scene scene) {
  BodyPoses drawn = drawn_poses(scene);
  closes_ = false;
  try {
    if (std::optional<BodyPoses> closed = closed_near(scene, drawn)) {
      closes_ = true;
      if (!begins_with(*closed, drawn)) scene = started_at(std::move(scene), *closed);
      drawn = std::move(*closed);
    } else if (const std::string gap = widest_gap(scene, drawn); !gap.empty()) {
      missing_ = "the loops do not close: " + gap;
    }
  } catch (const InputError&) {
    // The scene contradicts itself, which was said already.
  }
  sketch_ = std::move(scene);
  drawn_ = std::move(drawn);
}

const TrackedEquilibrium& ShownMechanism::at_rest() const {
  if (!tracked_) throw InputError("the mechanism does not rest anywhere yet: " + missing_);
  return *tracked_;
}

Transition ShownMechanism::change(Scene wanted) {
  if (tracked_) {
    const bool has_others = has_other_items(tracked_->scene(), wanted);
    try {
      expect_something_held(wanted);
      TrackedEquilibrium changed = *tracked_;
      Transition way = changed.change(wanted);
      if (has_others) expect_movable(changed.model(), analyse_mobility(changed.model()));
      // Where nothing is loaded any more nothing is left that could rest.
      if (!has_others || !changed.equilibrium().x.empty()) {
        tracked_ = std::move(changed);
        return way;
      }
      wanted = changed.scene();
    } catch (const InputError&) {
      if (!has_others) throw;
    }
  }
  const bool rested = tracked_.has_value();
  settle(std::move(wanted));
  if (tracked_ && !rested) {
    return tracked_->settled_from_start(tracked_->equilibrium().found()
                                            ? "released where it was drawn, it moved to where it rests"
                                            : "the mechanism is complete, but comes to rest nowhere");
  }
  Transition out;
  out.kind = Transition::Kind::settled;
  out.why = tracked_ ? "the mechanism is complete, and rests" : rested ? "it rests nowhere any more: " + missing_ : "";
  return out;
}

void ShownMechanism::restore(Scene scene) { settle(std::move(scene)); }

Transition ShownMechanism::drag(PointRef point, Vec2 place) {
  if (tracked_) return tracked_->drag(point, place, limits_of_drag(tracked_->scene()));
  if (!closes_) throw InputError("nothing can be dragged yet: " + missing_);
  MovedPoint moved = moved_point(sketch_, drawn_, point, place, options_.interrupt);
  sketch_ = started_at(std::move(sketch_), moved.poses);
  drawn_ = std::move(moved.poses);
  return std::move(moved.transition);
}

Transition ShownMechanism::release() { return tracked_ ? tracked_->release() : Transition{}; }

void ShownMechanism::stay_at(const BodyPoses& poses) {
  if (tracked_) {
    tracked_->stay_at(poses);
  } else if (closes_ && poses.size() >= sketch_.bodies.size() && !begins_with(poses, drawn_)) {
    sketch_ = started_at(std::move(sketch_), poses);
    drawn_ = poses;
  }
}

}  // namespace poise::app

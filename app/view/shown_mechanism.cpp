#include "app/view/shown_mechanism.hpp"

#include <algorithm>
#include <utility>

namespace poise::app {
namespace {

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
    if (scene.bodies.size() < 2) throw InputError("no link is drawn yet");
    tracked.emplace(scene, options_);
  } catch (const InputError& error) {
    missing = without_place(error.what(), scene.file);
    if (missing.find("nothing can move under load") != std::string::npos)
      missing = "nothing moves under load yet, which takes a link that turns or slides, and a load, a mass or a spring";
  }
  tracked_ = std::move(tracked);
  sketch_ = tracked_ ? Scene{} : std::move(scene);
  missing_ = std::move(missing);
}

const TrackedEquilibrium& ShownMechanism::at_rest() const {
  if (!tracked_) throw InputError("the mechanism does not rest anywhere yet: " + missing_);
  return *tracked_;
}

Transition ShownMechanism::change(Scene wanted) {
  if (tracked_) {
    const bool has_others = has_other_items(tracked_->scene(), wanted);
    try {
      TrackedEquilibrium changed = *tracked_;
      Transition way = changed.change(wanted);
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
  Transition out;
  out.kind = Transition::Kind::settled;
  out.why = tracked_ ? "the mechanism is complete, and rests" : rested ? "nothing holds it any more" : "";
  return out;
}

void ShownMechanism::restore(Scene scene) { settle(std::move(scene)); }

Transition ShownMechanism::drag(PointRef point, Vec2 place) {
  at_rest();
  return tracked_->drag(point, place);
}

Transition ShownMechanism::release() { return tracked_ ? tracked_->release() : Transition{}; }

void ShownMechanism::stay_at(const BodyPoses& poses) {
  at_rest();
  tracked_->stay_at(poses);
}

}  // namespace poise::app

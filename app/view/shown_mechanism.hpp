#pragma once

#include <optional>
#include <string>

#include "statics/tracking/tracked_equilibrium.hpp"

namespace poise::app {

/// Where the bodies of a scene stand as it was drawn: at the angles, travels and places of its start, one body after
/// the other from the ground on, each so that a joint with those before it is closed. Loops need not close.
BodyPoses drawn_poses(const Scene& scene);

/// What a page shows: a mechanism where it rests, or a sketch, a scene that does not carry anything yet, where it was
/// drawn, with its loops closed near there. Joints alone decide how a sketch is moved by hand.
class ShownMechanism {
 public:
  /// Settles from the start of the scene; a sketch where it cannot rest.
  ShownMechanism(Scene scene, const TrackedOptions& options);

  /// Without the hand, with the present position as its start.
  const Scene& scene() const { return tracked_ ? tracked_->scene() : sketch_; }
  BodyPoses poses() const { return tracked_ ? tracked_->poses() : drawn_; }
  /// Null of a sketch.
  const TrackedEquilibrium* tracked() const { return tracked_ ? &*tracked_ : nullptr; }
  /// Throws InputError, saying what is missing, of a sketch.
  const TrackedEquilibrium& at_rest() const;
  /// Of a sketch: why it cannot rest, in one sentence; empty otherwise.
  const std::string& missing() const { return missing_; }
  /// Whether points can be dragged: not of a sketch whose loops are open.
  bool can_be_dragged() const { return tracked_ || closes_; }
  bool found() const { return tracked_ && tracked_->equilibrium().found(); }
  std::optional<PointRef> hand() const { return tracked_ ? tracked_->hand() : std::nullopt; }

  /// As of TrackedEquilibrium, each with the strong guarantee. A scene with other items than before that cannot rest
  /// becomes a sketch; one with other numbers is refused then.
  Transition change(Scene wanted);
  void restore(Scene scene);
  Transition drag(PointRef point, Vec2 place);
  Transition release();
  /// A sketch stays there too; its loops are closed in these poses.
  void stay_at(const BodyPoses& poses);

 private:
  void settle(Scene scene);
  void show_sketch(Scene scene);

  TrackedOptions options_;
  std::optional<TrackedEquilibrium> tracked_;
  Scene sketch_;
  BodyPoses drawn_;      // of the sketch
  bool closes_ = false;  // the loops of the sketch are closed there
  std::string missing_;
};

}  // namespace poise::app

#include "app/view/screen.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "app/draw/followed.hpp"
#include "app/draw/symbols.hpp"
#include "statics/equilibrium/answer.hpp"

namespace poise::app {
namespace {

constexpr Vec2 page_room{720.0, 460.0};
/// How many positions of a course are drawn: of large mechanisms fewer, since somebody waits for them.
std::size_t most_passed(const Scene& scene) {
  return std::clamp<std::size_t>(1600 / (scene.bodies.size() + scene.joints.size() + scene.elements.size()), 8, 40);
}

/// The scene without the hand, its force as a load.
Scene drawn_scene(const ShownMechanism& shown) {
  Scene scene = shown.scene();
  if (!shown.hand()) return scene;
  const Vec2 force = shown.at_rest().force_of_hand();
  if (norm(force) > 0.0) scene.forces.push_back({.name = "hand", .at = *shown.hand(), .vector = force});
  return scene;
}

MechanismPicture picture_of(const ShownMechanism& shown) {
  MechanismPicture picture{.poses = shown.poses(), .confirmed = shown.found()};
  if (shown.found()) add_forces(picture, shown.at_rest().model(), shown.at_rest().equilibrium());
  return picture;
}

/// Of an empty sheet a place to begin: as large as a hand.
Box extent_now(const ShownMechanism& shown) {
  Box out = world_of(shown.scene(), {.poses = shown.poses()});
  if (shown.tracked() != nullptr) return out;
  constexpr Vec2 hand{0.4, 0.25};
  if (out.empty()) out.include({});
  if (out.width() < hand.x && out.height() < hand.y) out.include(out.low + hand);
  return out;
}

/// With a third of its size to all sides.
Box with_room_to_move(Box box) {
  const double more = std::max({box.width(), box.height(), 1e-6}) / 3;
  return {box.low - Vec2{more, more}, box.high + Vec2{more, more}};
}

std::string state_in_words(const ShownMechanism& shown) {
  if (shown.tracked() == nullptr) return "a sketch: " + shown.missing();
  const Equilibrium& equilibrium = shown.tracked()->equilibrium();
  const std::string held = shown.hand() ? "held, " : "";
  return equilibrium.found() ? held + in_few_words(equilibrium) : held + "no equilibrium: " + equilibrium.why;
}

}  // namespace

Screen::Screen(const ShownMechanism& shown)
    : scene_(drawn_scene(shown)),
      world_(with_room_to_move(extent_now(shown))),
      drawer_(scene_, world_, page_room),
      view_(drawer_.view()),
      largest_force_(largest_force_of(scene_, picture_of(shown))) {}

bool Screen::shows(const ShownMechanism& shown) const {
  const Box now = extent_now(shown);
  const bool is_inside = now.low.x >= world_.low.x && now.low.y >= world_.low.y && now.high.x <= world_.high.x &&
                         now.high.y <= world_.high.y;
  // A mechanism that has become much smaller is shown larger.
  const double now_size = std::max(now.width(), now.height());
  if (shown.tracked() == nullptr) return is_inside;
  return is_inside && now_size > 0.2 * std::max(world_.width(), world_.height());
}

Drawing Screen::drawing(const ShownMechanism& shown, const Transition& transition, bool steady) {
  scene_ = drawn_scene(shown);
  MechanismPicture picture = picture_of(shown);
  if (!steady) largest_force_ = largest_force_of(scene_, picture);
  picture.largest_force = largest_force_;
  std::vector<Frame> frames;
  for (const Transition::Course& course : transition.courses) {
    for (const std::size_t k : evenly(course.poses.size(), most_passed(scene_))) {
      const MechanismPicture passed{.poses = course.poses[k], .confirmed = false, .largest_force = largest_force_};
      frames.push_back({drawer_.draw(passed), "moving: " + course.why, Tone::doubtful, false});
    }
  }
  const bool found = shown.found();
  const auto is_stable = [&] { return shown.tracked()->equilibrium().certificate.stability != Stability::unstable; };
  const bool is_sketch = shown.tracked() == nullptr;
  const Tone tone = is_sketch ? Tone::plain : found && is_stable() ? Tone::good : Tone::bad;
  frames.push_back({drawer_.draw(picture), state_in_words(shown), tone, found || is_sketch});
  find_loads(frames.back().canvas, shown);
  Drawing out = drawer_.finished(std::move(frames), scene_.title.empty() ? "the mechanism" : scene_.title);
  // A legend that becomes shorter moves nothing.
  height_ = out.height = std::max(height_, out.height);
  return out;
}

Drawing Screen::others(const OtherEquilibria::Found& found) const {
  FrameDrawer drawer(found.scene, world_, page_room, false);
  drawer.show(drawer_.area());
  std::vector<Frame> frames;
  for (const BodyPoses& poses : found.poses) {
    frames.push_back({.canvas = drawer.draw({.poses = poses, .loads = false})});
  }
  return drawer.finished(std::move(frames), "other equilibria");
}

Figure Screen::figure(const ShownMechanism& shown) {
  const Scene scene = drawn_scene(shown);
  MechanismPicture picture = picture_of(shown);
  picture.heading = state_in_words(shown);
  Figure out;
  out.title = "The mechanism";
  out.drawing = draw_frames({{.scene = &scene, .picture = std::move(picture)}}, scene.title);
  return out;
}

void Screen::find_loads(const Canvas& canvas, const ShownMechanism& shown) {
  loads_.clear();
  const Vec2 origin = px(world_.middle());  // of what was drawn
  const BodyPoses poses = shown.poses();
  for (const Force& force : shown.scene().forces) {
    for (const Canvas::Entry& entry : canvas.entries()) {
      const auto* shaft = std::get_if<shape::Line>(&entry.shape);
      if (shaft == nullptr || canvas.items()[entry.item].name != "load " + force.name) continue;
      const Vec2 at = px(poses[static_cast<std::size_t>(force.at.body)].world(scene_.local(force.at)));
      const Vec2 tail = origin + shaft->a, tip = origin + shaft->b;
      const bool ends_there = norm(tip - at) < norm(tail - at);
      loads_.push_back({force.name, at, ends_there ? tail : tip, ends_there});
      break;
    }
  }
}

Vec2 Screen::pulled(const std::string& load, Vec2 to) const {
  constexpr double least = 1e-3;  // of the largest: a force must keep a direction
  const auto arrow = std::find_if(loads_.begin(), loads_.end(), [&](const LoadArrow& one) { return one.name == load; });
  if (arrow == loads_.end()) throw InputError(fmt::format("load \"{}\" has no arrow that could be pulled", load));
  const Vec2 way = arrow->ends_there ? arrow->at - to : to - arrow->at;
  const double largest = largest_force_ > 0.0 ? largest_force_ : scene_.units.force;
  const double size = std::max(least * largest, force_of_arrow(norm(way) - drawer_.pin_radius(), largest));
  return norm(way) > 0.0 ? (size / norm(way)) * conj(way) : Vec2{size, 0.0};
}

}  // namespace poise::app

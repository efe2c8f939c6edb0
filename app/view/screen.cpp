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
constexpr std::size_t most_passed = 40;

/// The scene without the hand, its force as a load.
Scene drawn_scene(const TrackedEquilibrium& tracked) {
  Scene scene = tracked.scene();
  if (!tracked.hand()) return scene;
  const Vec2 force = tracked.force_of_hand();
  if (norm(force) > 0.0) scene.forces.push_back({.name = "hand", .at = *tracked.hand(), .vector = force});
  return scene;
}

MechanismPicture picture_of(const TrackedEquilibrium& tracked) {
  MechanismPicture picture{.poses = tracked.poses(), .confirmed = tracked.equilibrium().found()};
  if (tracked.equilibrium().found()) add_forces(picture, tracked.model(), tracked.equilibrium());
  return picture;
}

Box extent_now(const TrackedEquilibrium& tracked) { return world_of(tracked.scene(), {.poses = tracked.poses()}); }

/// With a third of its size to all sides.
Box with_room_to_move(Box box) {
  const double more = std::max({box.width(), box.height(), 1e-6}) / 3;
  return {box.low - Vec2{more, more}, box.high + Vec2{more, more}};
}

std::string state_in_words(const TrackedEquilibrium& tracked) {
  const Equilibrium& equilibrium = tracked.equilibrium();
  const std::string held = tracked.hand() ? "held, " : "";
  return equilibrium.found() ? held + in_few_words(equilibrium) : held + "no equilibrium: " + equilibrium.why;
}

}  // namespace

Screen::Screen(const TrackedEquilibrium& tracked)
    : scene_(drawn_scene(tracked)),
      world_(with_room_to_move(extent_now(tracked))),
      drawer_(scene_, world_, page_room),
      view_(drawer_.view()),
      largest_force_(largest_force_of(scene_, picture_of(tracked))) {}

bool Screen::shows(const TrackedEquilibrium& tracked) const {
  const Box now = extent_now(tracked);
  const bool is_inside = now.low.x >= world_.low.x && now.low.y >= world_.low.y && now.high.x <= world_.high.x &&
                         now.high.y <= world_.high.y;
  // A mechanism that has become much smaller is shown larger.
  const double now_size = std::max(now.width(), now.height());
  return is_inside && now_size > 0.2 * std::max(world_.width(), world_.height());
}

Drawing Screen::drawing(const TrackedEquilibrium& tracked, const Transition& transition, bool steady) {
  scene_ = drawn_scene(tracked);
  MechanismPicture picture = picture_of(tracked);
  if (!steady) largest_force_ = largest_force_of(scene_, picture);
  picture.largest_force = largest_force_;
  std::vector<Frame> frames;
  for (const Transition::Course& course : transition.courses) {
    for (const std::size_t k : evenly(course.poses.size(), most_passed)) {
      const MechanismPicture passed{.poses = course.poses[k], .confirmed = false, .largest_force = largest_force_};
      frames.push_back({drawer_.draw(passed), "moving: " + course.why, Tone::doubtful, false});
    }
  }
  const bool found = tracked.equilibrium().found();
  const Tone tone = !found                                                               ? Tone::bad
                    : tracked.equilibrium().certificate.stability == Stability::unstable ? Tone::bad
                                                                                         : Tone::good;
  frames.push_back({drawer_.draw(picture), state_in_words(tracked), tone, found});
  find_loads(frames.back().canvas, tracked);
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

Figure Screen::figure(const TrackedEquilibrium& tracked) {
  const Scene scene = drawn_scene(tracked);
  MechanismPicture picture = picture_of(tracked);
  picture.heading = state_in_words(tracked);
  Figure out;
  out.title = "The mechanism";
  out.drawing = draw_frames({{.scene = &scene, .picture = std::move(picture)}}, scene.title);
  return out;
}

void Screen::find_loads(const Canvas& canvas, const TrackedEquilibrium& tracked) {
  loads_.clear();
  const Vec2 origin = px(world_.middle());  // of what was drawn
  const BodyPoses poses = tracked.poses();
  for (const Force& force : tracked.scene().forces) {
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

#include "app/draw/frames.hpp"

#include <algorithm>
#include <utility>

#include "app/draw/sheet.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

constexpr double room_across = sheet::width - 2 * sheet::margin;

void include(Box& box, const Box& other) {
  if (other.empty()) return;
  box.include(other.low);
  box.include(other.high);
}

/// As wide as `width` at least.
Box widened(Box box, double width) {
  const double more = std::max(0.0, width - box.width()) / 2;
  box.low.x -= more;
  box.high.x += more;
  return box;
}

/// All frames of a drawing, and what they take up, px from the middle of the world.
struct DrawnFrames {
  FrameDrawer drawer;
  std::vector<Frame> frames{};
  Box bounds{};
};

void draw_all_of(DrawnFrames& into, const std::vector<const Position*>& positions) {
  for (const Position* position : positions) {
    into.drawer.use(*position->scene);
    const MechanismPicture& picture = position->picture;
    into.frames.push_back({into.drawer.draw(picture), picture.heading, position->tone, picture.confirmed});
    include(into.bounds, into.frames.back().canvas.bounds());
  }
}

DrawnFrames drawn(const std::vector<const Position*>& positions, const Box& world, Vec2 room, bool labels) {
  const Scene& scene = *positions.front()->scene;
  DrawnFrames plain{FrameDrawer(scene, world, room, false)};
  draw_all_of(plain, positions);
  if (!labels) return plain;
  DrawnFrames labelled{FrameDrawer(scene, world, room)};
  const double middle = plain.bounds.middle().x;
  labelled.drawer.show(
      {{middle - room_across / 2, plain.bounds.low.y}, {middle + room_across / 2, plain.bounds.high.y}});
  draw_all_of(labelled, positions);
  return labelled;
}

/// All positions, or of many as many as show how far things reach.
std::vector<const Position*> some_of(const std::vector<Position>& positions, std::size_t most) {
  const std::size_t step = std::max<std::size_t>(1, (positions.size() + most - 1) / most);
  std::vector<const Position*> out;
  for (std::size_t i = 0; i < positions.size(); i += step) out.push_back(&positions[i]);
  return out;
}

}  // namespace

FrameDrawer::FrameDrawer(const Scene& scene, const Box& world, Vec2 room, bool labels)
    : scene_(&scene), sizes_(sizes_for(scene, world, room)), labels_(labels) {
  constexpr double for_arrows = 60.0;
  const Vec2 half = 0.5 * sizes_.scale * Vec2{world.width(), world.height()};
  area_.include({0, 0}, for_arrows);
  area_.include(half, for_arrows);
  area_.include(-half, for_arrows);
  if (labels) {
    area_.include({room_across / 2, 0});
    area_.include({-room_across / 2, 0});
  }
}

Canvas FrameDrawer::draw(const MechanismPicture& picture) {
  Stage stage(*scene_, picture, sizes_, &choices_);
  draw_all(stage);
  stage.setter.keep_between(area_.low.x, area_.high.x);
  if (labels_) stage.set_labels();
  legend_.signs.insert(stage.signs.begin(), stage.signs.end());
  if (!stage.shadows.empty()) legend_.shadows = std::move(stage.shadows);
  legend_.forces = legend_.forces || picture.reactions;
  gravity_ = gravity_ || picture.loads;
  return std::move(stage.canvas);
}

FrameView FrameDrawer::view() const {
  return {sizes_.scale, Vec2{sheet::margin, sheet::margin} - area_.low - sizes_.scale * conj(sizes_.centre)};
}

Drawing FrameDrawer::finished(std::vector<Frame> frames, std::string description) const {
  Drawing drawing;
  drawing.description = std::move(description);
  drawing.frames = std::move(frames);
  for (Frame& frame : drawing.frames) frame.canvas.move(Vec2{sheet::margin, sheet::margin} - area_.low);
  drawing.view = view();
  const double width = area_.width();
  drawing.width = width + 2 * sheet::margin;
  double y = sheet::margin + area_.height();
  if (labels_) {
    Canvas& still = drawing.still;
    y += 34;
    still.insert(draw_scale_bar(sizes_.scale, scene_->units), "scale", {sheet::margin + 4, y});
    if (gravity_) still.insert(draw_gravity(*scene_), "gravity", {sheet::margin + width - 24, y});
    y += 34;
    const Canvas signs = draw_legend(legend_, width);
    Canvas legend;
    // What is dragged below the sheet does not run through it.
    const double bottom = 22 + std::max(0.0, signs.bounds().high.y) + sheet::margin;
    legend.polygon(
        {{-sheet::margin, 0}, {width + sheet::margin, 0}, {width + sheet::margin, bottom}, {-sheet::margin, bottom}},
        {.fill = ink::paper, .stroke = ink::none});
    legend.line({0, 0}, {width, 0}, {.stroke = ink::ghost, .width = 1});
    legend.insert(signs, "", {0, 22});
    still.insert(legend, "legend", {sheet::margin, y});
    y += 22 + std::max(0.0, signs.bounds().high.y);
  }
  drawing.height = y + sheet::margin;
  return drawing;
}

Drawing draw_frames(std::vector<Position> positions, const std::string& description, bool labels) {
  constexpr double page_height = 500.0, largest = 720.0, smallest = 100.0, least_step = 0.95;
  constexpr Vec2 small_room{320.0, 320.0};
  constexpr std::size_t examples = 40;
  Box world;
  double force = 0.0;
  for (const Position& position : positions) {
    include(world, world_of(*position.scene, position.picture));
    force = std::max(force, largest_force_of(*position.scene, position.picture));
  }
  for (Position& position : positions) position.picture.largest_force = force;

  // Drawn so large that arrows and labels fit into the page too; these keep their size.
  Vec2 room = labels ? Vec2{largest, page_height} : small_room;
  std::vector<const Position*> shown = some_of(positions, labels ? examples : positions.size());
  for (;;) {
    DrawnFrames found = drawn(shown, world, room, labels);
    const double over = labels && room.x > smallest ? found.bounds.width() - room_across : 0.0;
    if (over > 0.0) {
      room.x = std::max(smallest, std::min(room.x - over - 1.0, least_step * room.x));
    } else if (shown.size() < positions.size()) {
      shown = some_of(positions, positions.size());
    } else {
      Box area = found.bounds;
      if (labels) area = widened(area, room_across);
      found.drawer.show(area);
      return found.drawer.finished(std::move(found.frames), description);
    }
  }
}

}  // namespace poise::app

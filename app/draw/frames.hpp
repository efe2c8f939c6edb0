#pragma once

// Pictures of one mechanism in several positions, in one scale and area.

#include <string>
#include <vector>

#include "app/draw/figure.hpp"
#include "app/draw/mechanism.hpp"
#include "app/draw/stage.hpp"

namespace poise::app {

/// Draws one position after the other. Scale and area stay, and labels, supports and arrows keep their places from one
/// picture to the next where they can.
class FrameDrawer {
 public:
  /// Shows the part `world`, m, of the world in which the mechanism moves, within `room`, px; arrows and labels come on
  /// top. `scene` must outlive this. Without labels there is neither legend nor scale.
  FrameDrawer(const Scene& scene, const Box& world, Vec2 room = {720, 500}, bool labels = true);

  /// The next pictures are of another scene, which differs in numbers only and must outlive this.
  void use(const Scene& scene) { scene_ = &scene; }
  /// The area of the drawing, px from the middle of `world`; as wide as a page and as high as arrows need, unless set.
  /// What lies outside is drawn too, but labels keep between its left and right limits.
  void show(const Box& area) { area_ = area; }

  /// The mechanism in the position of the picture, of which heading and frame do not count; largest_force sets the
  /// scale of forces. The origin is the middle of `world`.
  Canvas draw(const MechanismPicture& picture);
  /// Frames drawn by this as a drawing of the area, with the legend of all pictures so far.
  Drawing finished(std::vector<Frame> frames, std::string description) const;
  const Box& area() const { return area_; }
  double pin_radius() const { return sizes_.pin_radius; }  ///< px
  /// Where the world is in that drawing.
  FrameView view() const;

 private:
  const Scene* scene_;
  Sizes sizes_;
  bool labels_;
  Box area_;
  Choices choices_;
  LegendContents legend_{.signs = {}, .shadows = {}, .forces = false};
  bool gravity_ = false;
};

/// A position of a mechanism that is to be a frame.
struct Position {
  const Scene* scene = nullptr;  ///< those of all positions differ in numbers only
  MechanismPicture picture{};    ///< its heading is the caption, `confirmed` that of the frame
  Tone tone = Tone::plain;       ///< of the caption
};

/// All positions, one at least, in one scale and area, 900 px wide at most, with arrows in one scale of forces. Without
/// labels: as small pictures, without legend and scale.
Drawing draw_frames(std::vector<Position> positions, const std::string& description, bool labels = true);

}  // namespace poise::app

#pragma once

#include <limits>
#include <string>
#include <vector>

#include "app/draw/canvas.hpp"

namespace poise::app {

/// A text that belongs to a place.
struct Label {
  std::string text;
  Vec2 anchor{};
  double gap = 8.0;    ///< distance from the anchor at which the text may begin, px
  Vec2 toward{0, -1};  ///< preferred direction from the anchor
  TextStyle style{};
};

/// Sets labels where they cover least: each takes, of many places round its anchor, the one that hides the fewest
/// lines and labels set before it. One pushed away gets a thin line to its anchor.
class LabelSetter {
 public:
  /// What labels should not cover: a line `width` px thick.
  void avoid(Vec2 a, Vec2 b, double width);
  /// The same for a disc.
  void avoid(Vec2 centre, double radius);
  /// Labels should keep between these limits.
  void keep_between(double left, double right);
  /// Length of the avoided lines, px, that run within `margin` of the line from a to b.
  double covered(Vec2 a, Vec2 b, double margin) const;
  /// Draws the label where it covers least, and keeps later ones off it.
  void set(Canvas& canvas, Label label);

 private:
  struct Obstacle {
    Vec2 a, b;
    double half_width;
  };
  double cost(const Box& box) const;

  std::vector<Obstacle> obstacles_;
  std::vector<Box> labels_;
  double left_ = -std::numeric_limits<double>::infinity(), right_ = std::numeric_limits<double>::infinity();
};

}  // namespace poise::app

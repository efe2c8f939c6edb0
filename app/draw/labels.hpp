#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "app/draw/canvas.hpp"

namespace poise::app {

/// A text that belongs to a place.
struct Label {
  std::string text;
  DrawnItem item{};
  Vec2 anchor{};
  double gap = 8.0;    ///< distance from the anchor at which the text may begin, px
  Vec2 toward{0, -1};  ///< preferred direction from the anchor
  TextStyle style{};
  std::string_view layer{};  ///< with which it is hidden; empty: "labels". Of static duration
};

/// Where a label was set in the picture before.
struct LabelPlace {
  Vec2 offset{};      ///< of the text's middle from the anchor
  double away = 0.0;  ///< beyond the gap, px
  double cost = 0.0;  ///< what it was when the place was chosen
};
/// The places of labels in the pictures before, by item and number within it.
using LabelPlaces = std::unordered_map<std::string, LabelPlace>;

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
  /// Labels keep the places that they had in the picture before, unless these have become clearly worse. `places` must
  /// outlive this, and is brought up to date.
  void remember(LabelPlaces& places) { places_ = &places; }
  /// Length of the avoided lines, px, that run within `margin` of the line from a to b.
  double covered(Vec2 a, Vec2 b, double margin) const;
  /// Draws the label where it covers least, and keeps later ones off it.
  void set(Canvas& canvas, Label label);

 private:
  struct Obstacle {
    Vec2 a, b;
    double half_width;
    Box box;  ///< round the line, without its width
  };
  /// A place for a label.
  struct Place {
    Box box;
    double away = 0.0, cost = std::numeric_limits<double>::infinity();
  };
  void add(Vec2 a, Vec2 b, double half_width);
  /// Of a box, as far as it does not exceed `limit`; from there on any number above it.
  double cost(const Box& box, double limit) const;
  Place best_place(const Label& label, double width, double height) const;
  /// That of the picture before where it is good enough, else the best one.
  Place kept_place(const Label& label, double width, double height);

  std::vector<Obstacle> obstacles_;
  std::vector<Box> labels_;
  LabelPlaces* places_ = nullptr;
  std::unordered_map<std::string, int> labels_of_;  ///< set so far, by item
  double left_ = -std::numeric_limits<double>::infinity(), right_ = std::numeric_limits<double>::infinity();
};

}  // namespace poise::app

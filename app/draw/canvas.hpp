#pragma once

// Shapes, and how they are written as SVG. Coordinates are in pixels of the page, x to the right and y down.

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "app/draw/palette.hpp"
#include "model/planar.hpp"

namespace poise::app {

/// An upright rectangle; begins empty.
struct Box {
  Vec2 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vec2 high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

  void include(Vec2 p, double margin = 0.0);
  bool empty() const { return !(low.x <= high.x); }
  double width() const { return empty() ? 0.0 : high.x - low.x; }
  double height() const { return empty() ? 0.0 : high.y - low.y; }
  Vec2 middle() const { return 0.5 * (low + high); }
};

/// How a shape is filled and drawn.
struct Paint {
  Colour fill = Colour::none;
  Colour stroke = Colour::none;
  double width = 1.0;
  std::string_view dash{};  ///< "5 3", empty for a full line; of static duration
  double opacity = 1.0;

  friend bool operator==(const Paint&, const Paint&) = default;
};

enum class Align { start, middle, end };

struct TextStyle {
  double size = 11.0;
  Colour colour = Colour::text;
  bool bold = false;
  bool italic = false;
  bool halo = true;  ///< rim of paper, so that text stays legible over lines
  Align align = Align::middle;

  friend bool operator==(const TextStyle&, const TextStyle&) = default;
};

/// Width that a text takes at least in the usual sans-serif fonts, px; rather too much than too little.
double text_width(std::string_view text, double size);

/// The text with XML's special characters escaped and those that XML forbids left out.
std::string escape_xml(std::string_view text);

/// What a canvas holds: shapes, and the groups round them.
namespace shape {
struct Line {
  Vec2 a, b;
  Paint paint;
};
struct Polyline {
  std::vector<Vec2> points;
  Paint paint;
};
struct Polygon {
  std::vector<Vec2> points;
  Paint paint;
};
struct Circle {
  Vec2 centre;
  double radius;
  Paint paint;
};
struct Arc {
  Vec2 centre;
  double radius, from, to;
  Paint paint;
};
struct Text {
  Vec2 at;
  std::string text;
  TextStyle style;
};
/// Begins a group: what it holds is `scale` times as large and then moved by `shift`.
struct Open {
  std::string id;
  Vec2 shift;
  double scale;
};
struct Close {};
}  // namespace shape
using Shape = std::variant<shape::Line, shape::Polyline, shape::Polygon, shape::Circle, shape::Arc, shape::Text,
                           shape::Open, shape::Close>;

/// A part of the mechanism that shapes belong to.
struct DrawnItem {
  std::string name{};   ///< "spring holder", the same in every position; empty: none
  std::string state{};  ///< in this position: "150.35 mm, 251.8 N, in tension"; may be empty
};

/// Collects shapes and the box that they fill.
class Canvas {
 public:
  void line(Vec2 a, Vec2 b, const Paint& paint);
  void polyline(std::vector<Vec2> points, const Paint& paint);
  void polygon(std::vector<Vec2> points, const Paint& paint);
  void circle(Vec2 centre, double radius, const Paint& paint);
  /// Part of a circle from one angle to another, rad counter-clockwise as seen, begun at `from`.
  void arc(Vec2 centre, double radius, double from, double to, const Paint& paint);
  /// One line of text with its baseline at `at`.
  void text(Vec2 at, std::string_view text, const TextStyle& style);

  /// A group, named (or not) so that it can be found by whoever edits the figure. Groups must be closed.
  void open(std::string_view id, Vec2 shift = {}, double scale = 1.0);
  void close();
  /// What the shapes drawn from here on belong to, until another item or the end of the group.
  void item(std::string name, std::string state = {});
  const DrawnItem& current() const { return items_[item_]; }

  const Box& bounds() const { return bounds_; }
  /// Takes over what another canvas holds, `scale` times as large and moved by `shift`.
  void insert(const Canvas& other, std::string_view id, Vec2 shift, double scale = 1.0);
  /// Moves all that is in groups.
  void move(Vec2 shift);

  /// A shape or group mark, and the item it belongs to, an index into items().
  struct Entry {
    Shape shape;
    std::size_t item = 0;
  };
  const std::vector<Entry>& entries() const { return entries_; }
  const std::vector<DrawnItem>& items() const { return items_; }
  /// The shapes as SVG.
  std::string elements() const;

 private:
  void add(Shape shape) { entries_.push_back({std::move(shape), item_}); }

  std::vector<Entry> entries_;
  std::vector<DrawnItem> items_{1};  // the first: none
  std::size_t item_ = 0;
  Box bounds_;
};

/// A shape where it is seen, and what it belongs to.
struct PlacedShape {
  std::string_view layer;  ///< of the innermost named group
  const DrawnItem* item = nullptr;
  Shape shape;
};
/// The shapes of a canvas without groups, in their order. They refer to the canvas.
std::vector<PlacedShape> placed_shapes(const Canvas& canvas);

/// An SVG document (1.1, UTF-8, no outside resources) on white that shows the elements of a canvas.
std::string svg_document(const Canvas& canvas, double width, double height, std::string_view title,
                         std::string_view description);

}  // namespace poise::app

#pragma once

// SVG primitives. Coordinates are in pixels of the page, x to the right and y down.

#include <limits>
#include <string>
#include <string_view>
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
};

enum class Align { start, middle, end };

struct TextStyle {
  double size = 11.0;
  Colour colour = Colour::text;
  bool bold = false;
  bool italic = false;
  bool halo = true;  ///< rim of paper, so that text stays legible over lines
  Align align = Align::middle;
};

/// Width that a text takes at least in the usual sans-serif fonts, px; rather too much than too little.
double text_width(std::string_view text, double size);

/// The text with XML's special characters escaped and those that XML forbids left out.
std::string escape_xml(std::string_view text);

/// Collects SVG elements and the box that they fill.
class Canvas {
 public:
  void line(Vec2 a, Vec2 b, const Paint& paint);
  void polyline(const std::vector<Vec2>& points, const Paint& paint);
  void polygon(const std::vector<Vec2>& points, const Paint& paint);
  void circle(Vec2 centre, double radius, const Paint& paint);
  /// Part of a circle from one angle to another, rad counter-clockwise as seen, begun at `from`.
  void arc(Vec2 centre, double radius, double from, double to, const Paint& paint);
  /// One line of text with its baseline at `at`.
  void text(Vec2 at, std::string_view text, const TextStyle& style);

  /// A group, named (or not) so that it can be found by whoever edits the figure. Groups must be closed.
  void open(std::string_view id, Vec2 shift = {}, double scale = 1.0);
  void close();

  const Box& bounds() const { return bounds_; }
  const std::string& elements() const { return elements_; }
  /// Takes over what another canvas holds, `scale` times as large and moved by `shift`.
  void insert(const Canvas& other, std::string_view id, Vec2 shift, double scale = 1.0);

 private:
  void points(std::string_view element, const std::vector<Vec2>& points, const Paint& paint);

  std::string elements_;
  Box bounds_;
};

/// An SVG document (1.1, UTF-8, no outside resources) on white that shows the elements of a canvas.
std::string svg_document(const Canvas& canvas, double width, double height, std::string_view title,
                         std::string_view description);

}  // namespace poise::app

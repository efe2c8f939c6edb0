#include "app/draw/figure_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <list>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "app/draw/chart/thinned.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

/// JSON text, written piece by piece.
class Writer {
 public:
  std::string text;

  void raw(std::string_view piece) { text += piece; }
  /// A comma, unless something begins here.
  void separate() {
    if (!text.empty() && text.back() != '[' && text.back() != '{' && text.back() != ':') text += ',';
  }
  void key(std::string_view name) {
    separate();
    text += '"';
    text += name;
    text += "\":";
  }
  void begin(char bracket) {
    separate();
    text += bracket;
  }
  void end(char bracket) { text += bracket; }

  void word(std::string_view word) {
    separate();
    text += '"';
    for (const char c : word) {
      if (c == '"' || c == '\\') {
        text += '\\';
        text += c;
      } else if (static_cast<unsigned char>(c) < 0x20U) {
        fmt::format_to(std::back_inserter(text), "\\u{:04x}", static_cast<unsigned>(c));
      } else {
        text += c;
      }
    }
    text += '"';
  }
  void flag(bool is) {
    separate();
    text += is ? "true" : "false";
  }
  void integer(long long number) {
    separate();
    fmt::format_to(std::back_inserter(text), "{}", number);
  }
  /// To six significant digits; null where it is not finite.
  void number(double value) {
    separate();
    if (std::isfinite(value))
      fmt::format_to(std::back_inserter(text), "{:.6g}", value + 0.0);
    else
      text += "null";
  }
  /// Rounded to so many decimals.
  void rounded(double value, int decimals) {
    separate();
    append_rounded(text, value, decimals);
  }

  static void append_rounded(std::string& text, double value, int decimals) {
    static constexpr double powers[] = {1, 10, 100, 1000};
    constexpr double largest = 1e12;  // px; nothing so far off is seen
    const double scaled = std::clamp(value, -largest, largest) * powers[decimals];
    long long n = std::isfinite(value) ? std::llround(scaled) : 0;
    if (n < 0) text += '-';
    n = std::abs(n);
    int places = decimals;
    while (places > 0 && n % 10 == 0) {
      n /= 10;
      --places;
    }
    const auto unit = static_cast<long long>(powers[places]);
    fmt::format_to(std::back_inserter(text), "{}", n / unit);
    if (places > 0) fmt::format_to(std::back_inserter(text), ".{:0{}}", n % unit, places);
  }
};

void add(Writer& out, std::string_view key, std::string_view word) {
  out.key(key);
  out.word(word);
}

void add(Writer& out, std::string_view key, const std::vector<double>& numbers) {
  out.key(key);
  out.begin('[');
  for (const double v : numbers) out.number(v);
  out.end(']');
}

std::string_view name_of(Align align) {
  return align == Align::start ? "start" : align == Align::end ? "end" : "middle";
}

std::string_view name_of(Tone tone) {
  switch (tone) {
    case Tone::plain:
      return "plain";
    case Tone::strong:
      return "strong";
    case Tone::good:
      return "good";
    case Tone::bad:
      return "bad";
    case Tone::doubtful:
      return "doubtful";
    case Tone::faint:
      return "faint";
  }
  return "plain";
}

/// Texts that many refer to by their numbers.
class Pool {
 public:
  std::size_t number_of(std::string&& text) {
    const auto [found, is_new] = numbers_.try_emplace(std::move(text), numbers_.size());
    if (is_new) order_.push_back(&found->first);
    return found->second;
  }
  void write(Writer& out) const {
    out.begin('[');
    for (const std::string* text : order_) {
      out.separate();
      out.raw(*text);
    }
    out.end(']');
  }

 private:
  std::unordered_map<std::string, std::size_t> numbers_;
  std::vector<const std::string*> order_;
};

/// The corners of a line without those that cannot be seen.
std::vector<Vec2> fewer(const std::vector<Vec2>& points) {
  constexpr double straight = 0.2;  // px
  std::vector<Vec2> out;
  for (std::size_t first = 0; first < points.size();) {
    out.push_back(points[first]);
    std::size_t next = first + 1;
    const auto is_straight_to = [&](std::size_t end) {
      for (std::size_t i = first + 1; i < end; ++i) {
        if (distance_to_line(points[i], points[first], points[end]) > straight) return false;
      }
      return true;
    };
    while (next + 1 < points.size() && is_straight_to(next + 1)) ++next;
    first = next;
  }
  return out;
}

/// Writes shapes with their coordinates rounded, and numbers their styles.
class ShapeWriter {
 public:
  /// Of many frames, coordinates to a tenth of a pixel instead of a hundredth, and curves by fewer points.
  explicit ShapeWriter(bool many) : many_(many), decimals_(many ? 1 : 2) {}

  std::string write(const Shape& shape) {
    Writer out;
    out.begin('[');
    std::visit([&](const auto& is) { write(out, is); }, shape);
    out.end(']');
    return std::move(out.text);
  }
  const Pool& styles() const { return styles_; }

 private:
  void head(Writer& out, std::string_view type, std::size_t style) {
    out.word(type);
    out.integer(static_cast<long long>(style));
  }
  void put(Writer& out, Vec2 p) const {
    out.rounded(p.x, decimals_);
    out.rounded(p.y, decimals_);
  }
  std::size_t style_of(const Paint& paint) {
    Writer out;
    out.begin('{');
    add(out, "fill", name_of(paint.fill));
    add(out, "stroke", name_of(paint.stroke));
    out.key("width");
    out.rounded(paint.width, 2);
    add(out, "dash", paint.dash);
    out.key("opacity");
    out.rounded(paint.opacity, 2);
    out.end('}');
    return styles_.number_of(std::move(out.text));
  }
  std::size_t style_of(const TextStyle& style) {
    Writer out;
    out.begin('{');
    out.key("size");
    out.rounded(style.size, 2);
    add(out, "colour", name_of(style.colour));
    out.key("bold");
    out.flag(style.bold);
    out.key("italic");
    out.flag(style.italic);
    out.key("halo");
    out.flag(style.halo);
    add(out, "align", name_of(style.align));
    out.end('}');
    return styles_.number_of(std::move(out.text));
  }
  void write_points(Writer& out, std::string_view type, const std::vector<Vec2>& points, const Paint& paint) {
    head(out, type, style_of(paint));
    out.begin('[');
    if (many_)
      for (const Vec2& p : fewer(points)) put(out, p);
    else
      for (const Vec2& p : points) put(out, p);
    out.end(']');
  }
  void write(Writer& out, const shape::Line& line) {
    head(out, "line", style_of(line.paint));
    put(out, line.a);
    put(out, line.b);
  }
  void write(Writer& out, const shape::Polyline& line) { write_points(out, "polyline", line.points, line.paint); }
  void write(Writer& out, const shape::Polygon& area) { write_points(out, "polygon", area.points, area.paint); }
  void write(Writer& out, const shape::Circle& circle) {
    head(out, "circle", style_of(circle.paint));
    put(out, circle.centre);
    out.rounded(circle.radius, 2);
  }
  void write(Writer& out, const shape::Arc& arc) {
    constexpr int decimals = 3;  // rad
    head(out, "arc", style_of(arc.paint));
    put(out, arc.centre);
    out.rounded(arc.radius, 2);
    out.rounded(arc.from, decimals);
    out.rounded(arc.to, decimals);
  }
  void write(Writer& out, const shape::Text& line) {
    head(out, "text", style_of(line.style));
    put(out, line.at);
    out.word(line.text);
  }
  static void write(Writer& /*unused*/, const shape::Open& /*unused*/) {}
  static void write(Writer& /*unused*/, const shape::Close& /*unused*/) {}

  bool many_;
  int decimals_;
  Pool styles_;
};

// What cannot be seen where something moves, px.
constexpr double unseen = 0.15;

bool look_alike(Vec2 a, Vec2 b) { return std::abs(a.x - b.x) < unseen && std::abs(a.y - b.y) < unseen; }

bool look_alike(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](Vec2 p, Vec2 q) { return look_alike(p, q); });
}

bool look_alike(const shape::Line& a, const shape::Line& b) {
  return a.paint == b.paint && look_alike(a.a, b.a) && look_alike(a.b, b.b);
}
bool look_alike(const shape::Polyline& a, const shape::Polyline& b) {
  return a.paint == b.paint && look_alike(a.points, b.points);
}
bool look_alike(const shape::Polygon& a, const shape::Polygon& b) {
  return a.paint == b.paint && look_alike(a.points, b.points);
}
bool look_alike(const shape::Circle& a, const shape::Circle& b) {
  return a.paint == b.paint && a.radius == b.radius && look_alike(a.centre, b.centre);
}
bool look_alike(const shape::Arc& a, const shape::Arc& b) {
  const auto ends = [](const shape::Arc& arc) {
    return std::vector{arc.centre, arc.centre + arc.radius * conj(unit(arc.from)),
                       arc.centre + arc.radius * conj(unit(arc.to))};
  };
  return a.paint == b.paint && a.radius == b.radius && look_alike(ends(a), ends(b));
}
bool look_alike(const shape::Text& a, const shape::Text& b) {
  return a.style == b.style && a.text == b.text && look_alike(a.at, b.at);
}
bool look_alike(const shape::Open& /*unused*/, const shape::Open& /*unused*/) { return false; }
bool look_alike(const shape::Close& /*unused*/, const shape::Close& /*unused*/) { return false; }

/// Of two shapes of one kind.
bool look_alike(const Shape& a, const Shape& b) {
  return std::visit([&](const auto& is) { return look_alike(is, std::get<std::decay_t<decltype(is)>>(b)); }, a);
}

/// A place in all frames for a shape of one kind: the n-th such shape of an item in a layer.
struct Slot {
  std::string layer, item;
  int number = 0;  // in the order of painting
  // The shape last written, and its number in the pool.
  Shape shape{};
  int shape_number = -1;
};

/// The slots of all frames. One that first appears in a later frame is painted after the shape that lies below it
/// there.
class Slots {
 public:
  /// The slot of each shape of a frame.
  std::vector<Slot*> of_frame(const std::vector<PlacedShape>& shapes) {
    std::vector<Slot*> out;
    std::unordered_map<std::string, int> seen;
    auto below = order_.end();
    bool first = true;
    for (const PlacedShape& placed : shapes) {
      std::string key = fmt::format("{}\n{}\n{}", placed.layer, placed.item->name, placed.shape.index());
      key += fmt::format("\n{}", seen[key]++);
      auto [found, is_new] = places_.try_emplace(std::move(key));
      if (is_new) {
        const auto place = first ? order_.begin() : std::next(below);
        found->second = order_.insert(place, {std::string(placed.layer), placed.item->name});
      }
      below = found->second;
      first = false;
      out.push_back(&*below);
    }
    return out;
  }
  /// Numbers them, when all frames are known.
  void number() {
    int n = 0;
    for (Slot& slot : order_) slot.number = n++;
  }
  const std::list<Slot>& order() const { return order_; }

 private:
  std::list<Slot> order_;
  std::unordered_map<std::string, std::list<Slot>::iterator> places_;
};

/// All that a frame shows, in slots.
struct FrameShapes {
  std::vector<std::pair<Slot*, int>> shapes;  ///< numbers in the pool
};

void write_frames(Writer& out, const std::vector<FrameShapes>& frames, std::size_t slots) {
  out.key("frames");
  out.begin('[');
  std::vector<int> before(slots, -1), now;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    now.assign(slots, -1);
    for (const auto& [slot, shape] : frames[k].shapes) now[static_cast<std::size_t>(slot->number)] = shape;
    out.begin('[');
    for (std::size_t s = 0; s < slots; ++s) {
      if (k > 0 && now[s] == before[s]) continue;
      if (k > 0) out.integer(static_cast<long long>(s));
      out.integer(now[s]);
    }
    out.end(']');
    std::swap(before, now);
  }
  out.end(']');
}

void write_texts(Writer& out, const Drawing& drawing) {
  const std::vector<Frame>& frames = drawing.frames;
  const bool captions = std::any_of(frames.begin(), frames.end(), [](const Frame& f) { return !f.caption.empty(); });
  const bool tones = std::any_of(frames.begin(), frames.end(), [](const Frame& f) { return f.tone != Tone::plain; });
  out.key("captions");
  out.begin('[');
  for (const Frame& frame : frames) {
    if (captions) out.word(frame.caption);
  }
  out.end(']');
  out.key("tones");
  out.begin('[');
  for (const Frame& frame : frames) {
    if (tones) out.word(name_of(frame.tone));
  }
  out.end(']');
  out.key("confirmed");
  out.begin('[');
  for (const Frame& frame : frames) out.flag(frame.confirmed);
  out.end(']');
}

void write_drawing(Writer& out, const Drawing& drawing) {
  // Of a single frame a page may be printed large; of many the size counts.
  const bool many = drawing.frames.size() > 1;
  ShapeWriter shapes(many);
  Slots slots;
  Pool pool;
  std::vector<FrameShapes> frames;
  const std::vector<PlacedShape> still = placed_shapes(drawing.still);
  for (const Frame& frame : drawing.frames) {
    std::vector<PlacedShape> placed = placed_shapes(frame.canvas);
    placed.insert(placed.end(), still.begin(), still.end());
    const std::vector<Slot*> taken = slots.of_frame(placed);
    FrameShapes& row = frames.emplace_back();
    for (std::size_t i = 0; i < placed.size(); ++i) {
      Slot& slot = *taken[i];
      if (slot.shape_number < 0 || !many || !look_alike(placed[i].shape, slot.shape)) {
        slot.shape_number = static_cast<int>(pool.number_of(shapes.write(placed[i].shape)));
        slot.shape = placed[i].shape;
      }
      row.shapes.emplace_back(&slot, slot.shape_number);
      // Values of the only frame go with the name.
      const DrawnItem& item = *placed[i].item;
      if (!many && !item.state.empty()) slot.item = item.name + ": " + item.state;
    }
  }
  slots.number();

  out.begin('{');
  out.key("width");
  out.rounded(drawing.width, 1);
  out.key("height");
  out.rounded(drawing.height, 1);
  add(out, "description", drawing.description);
  out.key("styles");
  shapes.styles().write(out);
  out.key("slots");
  out.begin('[');
  for (const Slot& slot : slots.order()) {
    out.begin('[');
    out.word(slot.layer);
    out.word(slot.item);
    out.end(']');
  }
  out.end(']');
  out.key("shapes");
  pool.write(out);
  write_frames(out, frames, slots.order().size());
  write_texts(out, drawing);
  out.end('}');
}

std::string_view name_of(Curve::Style style) {
  switch (style) {
    case Curve::Style::line:
      return "line";
    case Curve::Style::points:
      return "points";
    case Curve::Style::dashed:
      return "dashed";
    case Curve::Style::dotted:
      return "dotted";
    case Curve::Style::crosses:
      return "crosses";
    case Curve::Style::marked:
      return "marked";
  }
  return "line";
}

void write_curve(Writer& out, const Curve& curve, Colour colour) {
  constexpr std::size_t most = 1200;
  const bool dots = curve.style == Curve::Style::points;
  const std::vector<std::size_t> kept = dots ? every_kth(curve.x.size(), most) : thinned(curve.x, curve.y, most);
  out.begin('{');
  add(out, "name", curve.name);
  for (const auto& [key, values] : {std::pair("x", &curve.x), std::pair("y", &curve.y)}) {
    out.key(key);
    out.begin('[');
    for (const std::size_t i : kept) out.number((*values)[i]);
    out.end(']');
  }
  add(out, "style", name_of(curve.style));
  add(out, "colour", name_of(colour));
  out.end('}');
}

void write_panel(Writer& out, const Panel& panel, const ChartCursor* cursor) {
  out.begin('{');
  add(out, "title", panel.title);
  add(out, "x_label", panel.x_label);
  add(out, "y_label", panel.y_label);
  for (const auto& [key, is] : {std::pair("log_x", panel.log_x), std::pair("log_y", panel.log_y),
                                std::pair("x_falls", panel.x_falls), std::pair("tall", panel.tall)}) {
    out.key(key);
    out.flag(is);
  }
  out.key("curves");
  out.begin('[');
  std::size_t turn = 0;
  for (const Curve& curve : panel.curves) {
    const std::size_t number = curve.colour >= 0 ? static_cast<std::size_t>(curve.colour) : turn++;
    write_curve(out, curve, curve.style == Curve::Style::crosses ? ink::load : curve_colour(number));
  }
  out.end(']');
  out.key("levels");
  out.begin('[');
  for (const Level& level : panel.levels) {
    out.begin('{');
    out.key("y");
    out.number(level.y);
    add(out, "name", level.name);
    out.end('}');
  }
  out.end(']');
  out.key("bands");
  out.begin('[');
  for (const Band& band : panel.bands) {
    out.begin('{');
    out.key("low");
    out.number(band.low);
    out.key("high");
    out.number(band.high);
    add(out, "name", band.name);
    out.end('}');
  }
  out.end(']');
  out.key("marks");
  out.begin('[');
  for (const Mark& mark : panel.marks) {
    out.begin('{');
    out.key("x");
    out.number(mark.x);
    out.key("y");
    out.number(mark.y);
    add(out, "label", mark.label);
    out.end('}');
  }
  out.end(']');
  out.key("arrows");
  out.begin('[');
  for (const Arrow& arrow : panel.arrows) {
    out.begin('{');
    add(out, "from", {arrow.from_x, arrow.from_y});
    add(out, "to", {arrow.to_x, arrow.to_y});
    out.end('}');
  }
  out.end(']');
  out.key("cursor");
  if (cursor == nullptr || cursor->x.empty()) {
    out.raw("null");
  } else {
    out.begin('{');
    add(out, "x", cursor->x);
    add(out, "y", cursor->y);
    out.end('}');
  }
  out.end('}');
}

void write_charts(Writer& out, const Charts& charts) {
  out.begin('{');
  out.key("columns");
  out.integer(charts.columns);
  out.key("panels");
  out.begin('[');
  for (std::size_t i = 0; i < charts.panels.size(); ++i) {
    write_panel(out, charts.panels[i], i < charts.cursors.size() ? &charts.cursors[i] : nullptr);
  }
  out.end(']');
  out.end('}');
}

void write_play(Writer& out, const Play& play) {
  out.begin('{');
  add(out, "label", play.label);
  add(out, "unit", play.unit);
  add(out, "values", play.values);
  out.key("seconds");
  out.number(play.seconds);
  out.key("marks");
  out.begin('[');
  for (const Play::Mark& mark : play.marks) {
    out.begin('{');
    out.key("frame");
    out.integer(static_cast<long long>(mark.frame));
    add(out, "label", mark.label);
    add(out, "caption", mark.caption);
    out.end('}');
  }
  out.end(']');
  out.key("snaps");
  out.begin('[');
  for (const Play::Snap& snap : play.snaps) {
    out.begin('{');
    out.key("first");
    out.integer(static_cast<long long>(snap.first));
    out.key("last");
    out.integer(static_cast<long long>(snap.last));
    add(out, "caption", snap.caption);
    out.end('}');
  }
  out.end(']');
  out.key("rest");
  out.integer(static_cast<long long>(play.rest));
  out.key("points");
  out.begin('[');
  for (const FollowedPoint& point : play.points) {
    out.begin('{');
    add(out, "name", point.name);
    out.key("at");
    out.begin('[');
    for (const Vec2& p : point.at) {
      out.rounded(p.x, 1);
      out.rounded(p.y, 1);
    }
    out.end(']');
    out.key("traced");
    out.flag(point.traced);
    out.end('}');
  }
  out.end(']');
  out.end('}');
}

}  // namespace

std::string drawing_json(const Drawing& drawing) {
  Writer out;
  write_drawing(out, drawing);
  return std::move(out.text);
}

std::string charts_json(const Charts& charts) {
  Writer out;
  write_charts(out, charts);
  return std::move(out.text);
}

std::string figure_json(const Figure& figure) {
  const bool is_drawn = !figure.drawing.frames.empty();
  const bool are_cards = figure.drawing.frames.size() > 1 && !figure.play;
  Writer out;
  out.begin('{');
  add(out, "kind", are_cards ? "cards" : is_drawn ? "drawing" : "charts");
  add(out, "title", figure.title);
  if (is_drawn) {
    out.key("drawing");
    write_drawing(out, figure.drawing);
  }
  if (is_drawn && !are_cards) {
    out.key("play");
    if (figure.play)
      write_play(out, *figure.play);
    else
      out.raw("null");
  }
  if (!are_cards) {
    out.key("charts");
    if (is_drawn && figure.charts.panels.empty())
      out.raw("null");
    else
      write_charts(out, figure.charts);
  }
  out.end('}');
  return std::move(out.text);
}

}  // namespace poise::app

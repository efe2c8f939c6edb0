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

#include "app/draw/figure_json.hpp"
#include "app/draw/json_writer.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

std::string_view name_of(Align align) {
  return align == Align::start ? "start" : align == Align::end ? "end" : "middle";
}

/// Texts that many refer to by their numbers.
class Pool {
 public:
  std::size_t number_of(std::string&& text) {
    const auto [found, is_new] = numbers_.try_emplace(std::move(text), numbers_.size());
    if (is_new) order_.push_back(&found->first);
    return found->second;
  }
  void write(JsonWriter& out) const {
    out.begin('[');
    for (const std::string* text : order_) {
      out.json(*text);
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
    JsonWriter out;
    out.begin('[');
    std::visit([&](const auto& is) { write(out, is); }, shape);
    out.end(']');
    return out.take();
  }
  const Pool& styles() const { return styles_; }

 private:
  void head(JsonWriter& out, std::string_view type, std::size_t style) {
    out.word(type);
    out.integer(static_cast<long long>(style));
  }
  void put(JsonWriter& out, Vec2 p) const {
    out.rounded(p.x, decimals_);
    out.rounded(p.y, decimals_);
  }
  std::size_t style_of(const Paint& paint) {
    JsonWriter out;
    out.begin('{');
    out.add("fill", name_of(paint.fill));
    out.add("stroke", name_of(paint.stroke));
    out.key("width");
    out.rounded(paint.width, 2);
    out.add("dash", paint.dash);
    out.key("opacity");
    out.rounded(paint.opacity, 2);
    out.end('}');
    return styles_.number_of(out.take());
  }
  std::size_t style_of(const TextStyle& style) {
    JsonWriter out;
    out.begin('{');
    out.key("size");
    out.rounded(style.size, 2);
    out.add("colour", name_of(style.colour));
    out.key("bold");
    out.flag(style.bold);
    out.key("italic");
    out.flag(style.italic);
    out.key("halo");
    out.flag(style.halo);
    out.add("align", name_of(style.align));
    out.end('}');
    return styles_.number_of(out.take());
  }
  void write_points(JsonWriter& out, std::string_view type, const std::vector<Vec2>& points, const Paint& paint) {
    head(out, type, style_of(paint));
    out.begin('[');
    if (many_)
      for (const Vec2& p : fewer(points)) put(out, p);
    else
      for (const Vec2& p : points) put(out, p);
    out.end(']');
  }
  void write(JsonWriter& out, const shape::Line& line) {
    head(out, "line", style_of(line.paint));
    put(out, line.a);
    put(out, line.b);
  }
  void write(JsonWriter& out, const shape::Polyline& line) { write_points(out, "polyline", line.points, line.paint); }
  void write(JsonWriter& out, const shape::Polygon& area) { write_points(out, "polygon", area.points, area.paint); }
  void write(JsonWriter& out, const shape::Circle& circle) {
    head(out, "circle", style_of(circle.paint));
    put(out, circle.centre);
    out.rounded(circle.radius, 2);
  }
  void write(JsonWriter& out, const shape::Arc& arc) {
    constexpr int decimals = 3;  // rad
    head(out, "arc", style_of(arc.paint));
    put(out, arc.centre);
    out.rounded(arc.radius, 2);
    out.rounded(arc.from, decimals);
    out.rounded(arc.to, decimals);
  }
  void write(JsonWriter& out, const shape::Text& line) {
    head(out, "text", style_of(line.style));
    put(out, line.at);
    out.word(line.text);
  }
  static void write(JsonWriter& /*unused*/, const shape::Open& /*unused*/) {}
  static void write(JsonWriter& /*unused*/, const shape::Close& /*unused*/) {}

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

void write_frames(JsonWriter& out, const std::vector<FrameShapes>& frames, std::size_t slots) {
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

void write_texts(JsonWriter& out, const Drawing& drawing) {
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

}  // namespace

std::string drawing_json(const Drawing& drawing) {
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

  JsonWriter out;
  out.begin('{');
  out.key("width");
  out.rounded(drawing.width, 1);
  out.key("height");
  out.rounded(drawing.height, 1);
  out.add("description", drawing.description);
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
  return out.take();
}

}  // namespace poise::app

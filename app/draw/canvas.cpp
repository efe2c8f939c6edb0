#include "app/draw/canvas.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace poise::app {
namespace {

// Coordinates to a hundredth of a pixel, without zeros at the end.
std::string px(double v) {
  std::string text = fmt::format("{:.2f}", v);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string attributes(const Paint& paint) {
  std::string text = fmt::format(" fill=\"{}\"", light_value(paint.fill));
  if (paint.stroke != Colour::none) {
    text += fmt::format(" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\" stroke-linejoin=\"round\"",
                        light_value(paint.stroke), px(paint.width));
    if (!paint.dash.empty()) text += fmt::format(" stroke-dasharray=\"{}\"", paint.dash);
  }
  if (paint.opacity < 1.0) text += fmt::format(" opacity=\"{}\"", px(paint.opacity));
  return text;
}

double rim(const Paint& paint) { return paint.stroke == Colour::none ? 0.0 : paint.width / 2; }

// Width of a letter in ems.
double letter_width(char c) {
  static constexpr std::string_view narrow = "ijlI.,:;'|!()[]ft ";
  static constexpr std::string_view wide = "mwMW@%";
  if (narrow.find(c) != std::string_view::npos) return 0.38;
  if (wide.find(c) != std::string_view::npos) return 0.95;
  return c >= 'A' && c <= 'Z' ? 0.72 : 0.62;
}

void write_points(std::string& text, std::string_view element, const std::vector<Vec2>& points, const Paint& paint) {
  text += fmt::format("<{} points=\"", element);
  for (const Vec2& p : points) text += px(p.x) + "," + px(p.y) + " ";
  if (!points.empty()) text.pop_back();
  text += "\"" + attributes(paint) + "/>\n";
}

// SVG of each shape, appended to a text.

void write(std::string& text, const shape::Line& line) {
  text += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{}/>\n", px(line.a.x), px(line.a.y), px(line.b.x),
                      px(line.b.y), attributes(line.paint));
}

void write(std::string& text, const shape::Polyline& line) { write_points(text, "polyline", line.points, line.paint); }

void write(std::string& text, const shape::Polygon& area) { write_points(text, "polygon", area.points, area.paint); }

void write(std::string& text, const shape::Circle& circle) {
  text += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>\n", px(circle.centre.x), px(circle.centre.y),
                      px(circle.radius), attributes(circle.paint));
}

void write(std::string& text, const shape::Arc& arc) {
  const Vec2 a = arc.centre + arc.radius * conj(unit(arc.from));
  const Vec2 b = arc.centre + arc.radius * conj(unit(arc.to));
  const std::string radius = px(arc.radius);
  text += fmt::format("<path d=\"M {} {} A {} {} 0 {} {} {} {}\"{}/>\n", px(a.x), px(a.y), radius, radius,
                      std::abs(arc.to - arc.from) > M_PI ? 1 : 0, arc.to > arc.from ? 0 : 1, px(b.x), px(b.y),
                      attributes(arc.paint));
}

void write(std::string& text, const shape::Text& line) {
  const TextStyle& style = line.style;
  const char* anchor = style.align == Align::start ? "start" : style.align == Align::end ? "end" : "middle";
  text += fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\" fill=\"{}\"", px(line.at.x),
                      px(line.at.y), px(style.size), anchor, light_value(style.colour));
  if (style.bold) text += " font-weight=\"bold\"";
  if (style.italic) text += " font-style=\"italic\"";
  if (style.halo) {
    text += fmt::format(" stroke=\"{}\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\"",
                        light_value(ink::paper));
  }
  text += ">" + escape_xml(line.text) + "</text>\n";
}

void write(std::string& text, const shape::Open& group) {
  text += group.id.empty() ? "<g" : fmt::format("<g id=\"{}\"", group.id);
  std::string moved;
  if (!(group.shift == Vec2{})) moved = fmt::format("translate({} {})", px(group.shift.x), px(group.shift.y));
  if (group.scale != 1.0) moved += fmt::format("{}scale({})", moved.empty() ? "" : " ", group.scale);
  if (!moved.empty()) text += fmt::format(" transform=\"{}\"", moved);
  text += ">\n";
}

void write(std::string& text, const shape::Close& /*unused*/) { text += "</g>\n"; }

/// Takes shapes out of their groups.
struct Placing {
  Vec2 shift{};
  double scale = 1.0;

  void place(Vec2& p) const { p = scale * p + shift; }
  void place(Paint& paint) const { paint.width *= scale; }
  void place(shape::Line& line) const {
    place(line.a);
    place(line.b);
    place(line.paint);
  }
  void place_points(std::vector<Vec2>& points, Paint& paint) const {
    for (Vec2& p : points) place(p);
    place(paint);
  }
  void place(shape::Polyline& line) const { place_points(line.points, line.paint); }
  void place(shape::Polygon& area) const { place_points(area.points, area.paint); }
  void place(shape::Circle& circle) const {
    place(circle.centre);
    circle.radius *= scale;
    place(circle.paint);
  }
  void place(shape::Arc& arc) const {
    place(arc.centre);
    arc.radius *= scale;
    place(arc.paint);
  }
  void place(shape::Text& line) const {
    place(line.at);
    line.style.size *= scale;
  }
  static void place(shape::Open& /*unused*/) {}
  static void place(shape::Close& /*unused*/) {}
};

}  // namespace

void Box::include(Vec2 p, double margin) {
  low = {std::min(low.x, p.x - margin), std::min(low.y, p.y - margin)};
  high = {std::max(high.x, p.x + margin), std::max(high.y, p.y + margin)};
}

double text_width(std::string_view text, double size) {
  double ems = 0.0;
  for (char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool continues_a_letter = (byte & 0xC0U) == 0x80U;
    if (!continues_a_letter) ems += byte < 0x80U ? letter_width(c) : 0.8;
  }
  return ems * size;
}

std::string escape_xml(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        if (byte >= 0x20U && byte != 0x7FU)
          out += c;
        else if (c == '\n' || c == '\t')
          out += ' ';
    }
  }
  return out;
}

void Canvas::line(Vec2 a, Vec2 b, const Paint& paint) {
  add(shape::Line{a, b, paint});
  bounds_.include(a, rim(paint));
  bounds_.include(b, rim(paint));
}

void Canvas::polyline(std::vector<Vec2> points, const Paint& paint) {
  for (const Vec2& p : points) bounds_.include(p, rim(paint));
  add(shape::Polyline{std::move(points), paint});
}

void Canvas::polygon(std::vector<Vec2> points, const Paint& paint) {
  for (const Vec2& p : points) bounds_.include(p, rim(paint));
  add(shape::Polygon{std::move(points), paint});
}

void Canvas::circle(Vec2 centre, double radius, const Paint& paint) {
  add(shape::Circle{centre, radius, paint});
  bounds_.include(centre, radius + rim(paint));
}

void Canvas::arc(Vec2 centre, double radius, double from, double to, const Paint& paint) {
  add(shape::Arc{centre, radius, from, to, paint});
  bounds_.include(centre, radius + rim(paint));
}

void Canvas::text(Vec2 at, std::string_view text, const TextStyle& style) {
  const double width = text_width(text, style.size);
  add(shape::Text{at, std::string(text), style});
  const double left = style.align == Align::start ? 0.0 : style.align == Align::end ? width : width / 2;
  bounds_.include({at.x - left, at.y - style.size});
  bounds_.include({at.x - left + width, at.y + 0.3 * style.size});
}

void Canvas::open(std::string_view id, Vec2 shift, double scale) {
  item_ = 0;
  add(shape::Open{std::string(id), shift, scale});
}

void Canvas::close() {
  item_ = 0;
  add(shape::Close{});
}

void Canvas::item(std::string name, std::string state) {
  item_ = items_.size();
  items_.push_back({std::move(name), std::move(state)});
}

void Canvas::insert(const Canvas& other, std::string_view id, Vec2 shift, double scale) {
  open(id, shift, scale);
  const std::size_t first = items_.size() - 1;
  for (const Entry& entry : other.entries_) {
    entries_.push_back({entry.shape, entry.item == 0 ? 0 : first + entry.item});
  }
  items_.insert(items_.end(), other.items_.begin() + 1, other.items_.end());
  close();
  if (other.bounds_.empty()) return;
  bounds_.include(scale * other.bounds_.low + shift);
  bounds_.include(scale * other.bounds_.high + shift);
}

void Canvas::move(Vec2 shift) {
  int depth = 0;
  for (Entry& entry : entries_) {
    auto* open = std::get_if<shape::Open>(&entry.shape);
    if (open != nullptr && depth++ == 0) open->shift += shift;
    if (std::holds_alternative<shape::Close>(entry.shape)) --depth;
  }
  if (bounds_.empty()) return;
  bounds_.low += shift;
  bounds_.high += shift;
}

std::string Canvas::elements() const {
  std::string text;
  for (const Entry& entry : entries_) std::visit([&](const auto& shape) { write(text, shape); }, entry.shape);
  return text;
}

std::vector<PlacedShape> placed_shapes(const Canvas& canvas) {
  struct ItemGroup {
    std::string_view layer;
    Placing placing;
  };
  std::vector<ItemGroup> groups{{"", {}}};
  std::vector<PlacedShape> out;
  out.reserve(canvas.entries().size());
  for (const Canvas::Entry& entry : canvas.entries()) {
    const ItemGroup& now = groups.back();
    if (const auto* open = std::get_if<shape::Open>(&entry.shape)) {
      const std::string_view layer = open->id.empty() ? now.layer : std::string_view(open->id);
      const Placing& outer = now.placing;
      groups.push_back({layer, {outer.shift + outer.scale * open->shift, outer.scale * open->scale}});
    } else if (std::holds_alternative<shape::Close>(entry.shape)) {
      groups.pop_back();
    } else {
      out.push_back({now.layer, &canvas.items()[entry.item], entry.shape});
      std::visit([&](auto& shape) { now.placing.place(shape); }, out.back().shape);
    }
  }
  return out;
}

std::string svg_document(const Canvas& canvas, double width, double height, std::string_view title,
                         std::string_view description) {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"system-ui, -apple-system, 'Segoe UI', Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n"
      "<title>{2}</title>\n<desc>{3}</desc>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{4}</svg>\n",
      width, height, escape_xml(title), escape_xml(description), canvas.elements());
}

}  // namespace poise::app

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
  elements_ += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{}/>\n", px(a.x), px(a.y), px(b.x), px(b.y),
                           attributes(paint));
  bounds_.include(a, rim(paint));
  bounds_.include(b, rim(paint));
}

void Canvas::points(std::string_view element, const std::vector<Vec2>& points, const Paint& paint) {
  elements_ += fmt::format("<{} points=\"", element);
  for (const Vec2& p : points) {
    elements_ += px(p.x) + "," + px(p.y) + " ";
    bounds_.include(p, rim(paint));
  }
  if (!points.empty()) elements_.pop_back();
  elements_ += "\"" + attributes(paint) + "/>\n";
}

void Canvas::polyline(const std::vector<Vec2>& vertices, const Paint& paint) { points("polyline", vertices, paint); }

void Canvas::polygon(const std::vector<Vec2>& vertices, const Paint& paint) { points("polygon", vertices, paint); }

void Canvas::circle(Vec2 centre, double radius, const Paint& paint) {
  elements_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>\n", px(centre.x), px(centre.y), px(radius),
                           attributes(paint));
  bounds_.include(centre, radius + rim(paint));
}

void Canvas::arc(Vec2 centre, double radius, double from, double to, const Paint& paint) {
  const auto on_circle = [&](double angle) { return centre + radius * conj(unit(angle)); };
  const Vec2 a = on_circle(from);
  const Vec2 b = on_circle(to);
  elements_ += fmt::format("<path d=\"M {} {} A {} {} 0 {} {} {} {}\"{}/>\n", px(a.x), px(a.y), px(radius), px(radius),
                           std::abs(to - from) > M_PI ? 1 : 0, to > from ? 0 : 1, px(b.x), px(b.y), attributes(paint));
  bounds_.include(centre, radius + rim(paint));
}

void Canvas::text(Vec2 at, std::string_view text, const TextStyle& style) {
  const double width = text_width(text, style.size);
  const char* anchor = style.align == Align::start ? "start" : style.align == Align::end ? "end" : "middle";
  elements_ += fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\" fill=\"{}\"", px(at.x),
                           px(at.y), px(style.size), anchor, light_value(style.colour));
  if (style.bold) elements_ += " font-weight=\"bold\"";
  if (style.italic) elements_ += " font-style=\"italic\"";
  if (style.halo) elements_ += " stroke=\"white\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\"";
  elements_ += ">" + escape_xml(text) + "</text>\n";
  const double left = style.align == Align::start ? 0.0 : style.align == Align::end ? width : width / 2;
  bounds_.include({at.x - left, at.y - style.size});
  bounds_.include({at.x - left + width, at.y + 0.3 * style.size});
}

void Canvas::open(std::string_view id, Vec2 shift, double scale) {
  elements_ += id.empty() ? "<g" : fmt::format("<g id=\"{}\"", id);
  std::string moved;
  if (!(shift == Vec2{})) moved = fmt::format("translate({} {})", px(shift.x), px(shift.y));
  if (scale != 1.0) moved += fmt::format("{}scale({})", moved.empty() ? "" : " ", scale);
  if (!moved.empty()) elements_ += fmt::format(" transform=\"{}\"", moved);
  elements_ += ">\n";
}

void Canvas::close() { elements_ += "</g>\n"; }

void Canvas::insert(const Canvas& other, std::string_view id, Vec2 shift, double scale) {
  open(id, shift, scale);
  elements_ += other.elements_;
  close();
  if (other.bounds_.empty()) return;
  bounds_.include(scale * other.bounds_.low + shift);
  bounds_.include(scale * other.bounds_.high + shift);
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

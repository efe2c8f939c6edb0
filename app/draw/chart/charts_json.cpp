#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "app/draw/chart/thinned.hpp"
#include "app/draw/figure_json.hpp"
#include "app/draw/json_writer.hpp"
#include "app/draw/palette.hpp"

namespace poise::app {
namespace {

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

void write_curve(JsonWriter& out, const Curve& curve, Colour colour) {
  constexpr std::size_t most = 1200;
  const bool dots = curve.style == Curve::Style::points;
  const std::vector<std::size_t> kept = dots ? every_kth(curve.x.size(), most) : thinned(curve.x, curve.y, most);
  out.begin('{');
  out.add("name", curve.name);
  for (const auto& [key, values] : {std::pair("x", &curve.x), std::pair("y", &curve.y)}) {
    out.key(key);
    out.begin('[');
    for (const std::size_t i : kept) out.number((*values)[i]);
    out.end(']');
  }
  out.add("style", name_of(curve.style));
  out.add("colour", name_of(colour));
  out.end('}');
}

void write_panel(JsonWriter& out, const Panel& panel, const ChartCursor* cursor) {
  out.begin('{');
  out.add("title", panel.title);
  out.add("x_label", panel.x_label);
  out.add("y_label", panel.y_label);
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
    out.add("name", level.name);
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
    out.add("name", band.name);
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
    out.add("label", mark.label);
    out.end('}');
  }
  out.end(']');
  out.key("arrows");
  out.begin('[');
  for (const Arrow& arrow : panel.arrows) {
    out.begin('{');
    out.add("from", {arrow.from_x, arrow.from_y});
    out.add("to", {arrow.to_x, arrow.to_y});
    out.end('}');
  }
  out.end(']');
  out.key("cursor");
  if (cursor == nullptr || cursor->x.empty()) {
    out.json("null");
  } else {
    out.begin('{');
    out.add("x", cursor->x);
    out.add("y", cursor->y);
    out.end('}');
  }
  out.end('}');
}

}  // namespace

std::string charts_json(const Charts& charts) {
  JsonWriter out;
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
  return out.take();
}

}  // namespace poise::app

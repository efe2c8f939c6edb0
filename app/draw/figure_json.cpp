#include "app/draw/figure_json.hpp"

#include "app/draw/json_writer.hpp"

namespace poise::app {
namespace {

void write_play(JsonWriter& out, const Play& play) {
  out.begin('{');
  out.add("label", play.label);
  out.add("unit", play.unit);
  out.add("values", play.values);
  out.key("seconds");
  out.number(play.seconds);
  out.key("marks");
  out.begin('[');
  for (const Play::Mark& mark : play.marks) {
    out.begin('{');
    out.key("frame");
    out.integer(static_cast<long long>(mark.frame));
    out.add("label", mark.label);
    out.add("caption", mark.caption);
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
    out.add("caption", snap.caption);
    out.end('}');
  }
  out.end(']');
  out.key("rest");
  out.integer(static_cast<long long>(play.rest));
  out.key("points");
  out.begin('[');
  for (const FollowedPoint& point : play.points) {
    out.begin('{');
    out.add("name", point.name);
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

std::string figure_json(const Figure& figure) {
  const bool is_drawn = !figure.drawing.frames.empty();
  const bool are_cards = figure.drawing.frames.size() > 1 && !figure.play;
  JsonWriter out;
  out.begin('{');
  out.add("kind", are_cards && figure.switched ? "switched" : are_cards ? "cards" : is_drawn ? "drawing" : "charts");
  out.add("title", figure.title);
  if (is_drawn) {
    out.key("drawing");
    out.json(drawing_json(figure.drawing));
  }
  if (is_drawn && !are_cards) {
    out.key("play");
    if (figure.play)
      write_play(out, *figure.play);
    else
      out.json("null");
  }
  if (!are_cards) {
    out.key("charts");
    if (is_drawn && figure.charts.panels.empty())
      out.json("null");
    else
      out.json(charts_json(figure.charts));
  }
  out.end('}');
  return out.take();
}

}  // namespace poise::app

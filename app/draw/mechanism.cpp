#include "app/draw/mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"
#include "statics/answer.hpp"

namespace poise::app {
namespace {

constexpr double page_width = 900.0;
constexpr double margin = 28.0;
constexpr double room = page_width - 2 * margin;

Stage drawn(const Scene& scene, const MechanismPicture& picture, double width) {
  constexpr double page_height = 500.0;
  Stage stage(scene, picture, {width, page_height});
  draw_all(stage);
  const double middle = stage.canvas.bounds().middle().x;
  stage.setter.keep_between(middle - room / 2, middle + room / 2);
  stage.set_labels();
  return stage;
}

/// Drawn so large that arrows and labels fit into the page too; these keep their size.
Stage drawn_to_fit(const Scene& scene, const MechanismPicture& picture) {
  constexpr double largest = 720.0;
  constexpr double smallest = 100.0;
  constexpr double least_step = 0.95;
  double width = largest;
  for (;;) {
    Stage stage = drawn(scene, picture, width);
    const double over = stage.canvas.bounds().width() - room;
    if (over <= 0.0 || width <= smallest) return stage;
    width = std::max(smallest, std::min(width - over - 1.0, least_step * width));
  }
}

std::string verdict(const Equilibrium& equilibrium) {
  const std::string method = to_string(equilibrium.method);
  const bool is_answer = equilibrium.found() || equilibrium.status == Status::checked;
  if (!is_answer) return "No equilibrium proved (" + to_string(equilibrium.status) + ", " + method + ")";
  return "In equilibrium, " + in_few_words(equilibrium) + "; found by " + method;
}

const std::string& title_of(const Scene& scene) { return scene.title.empty() ? scene.file : scene.title; }

/// Direction and size of gravity.
Canvas draw_gravity(const Stage& stage) {
  Canvas canvas;
  const double size = norm(stage.scene.gravity);
  if (size == 0.0 || !stage.picture.loads) return canvas;
  const Vec2 u = stage.page_direction((1 / size) * stage.scene.gravity);
  draw_arrow(canvas, -17.0 * u, 17.0 * u, ink::dark, 2.0);
  canvas.text({-14.0, 4.0},
              "g = " + significant(in_unit(size, Quantity::length, stage.scene.units), 4) + " " +
                  stage.scene.units.length_name + "/s\u00b2",
              {.size = 11, .halo = false, .align = Align::end});
  return canvas;
}

/// A bar of a round length, 70 to 175 px.
Canvas draw_scale_bar(const Stage& stage) {
  Canvas canvas;
  const double px_per_unit = stage.scale * stage.scene.units.length;
  const double wanted = 140.0 / px_per_unit;
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  double length = decade;
  for (double step : {2.0, 5.0}) {
    if (step * decade <= wanted) length = step * decade;
  }
  const double width = length * px_per_unit;
  for (int half : {0, 1}) {
    canvas.line({half * width / 2, 0}, {(half + 1) * width / 2, 0},
                {.stroke = half == 0 ? ink::dark : ink::free_stop, .width = 4});
  }
  canvas.text({0, 17}, "0", {.halo = false});
  canvas.text({width, 17}, significant(length, 3) + " " + stage.scene.units.length_name, {.halo = false});
  return canvas;
}

using Draw = std::function<void(Canvas&)>;  // in 0 .. 34, centred on y = 0

Draw an_arrow(Colour colour, double width, const char* dash = "") {
  return [=](Canvas& c) { draw_arrow(c, {2, 0}, {32, 0}, colour, width, dash); };
}

Draw a_spring(Colour colour, double width, const char* dash = "") {
  return [=](Canvas& c) { draw_spring(c, {0, 0}, {34, 0}, {}, {.stroke = colour, .width = width, .dash = dash}); };
}

Draw a_line(Vec2 a, Vec2 b, Colour colour, double width) {
  return [=](Canvas& c) { c.line(a, b, {.stroke = colour, .width = width}); };
}

struct LegendItem {
  Sign sign;
  const char* text;
  Draw draw;
};

const std::vector<LegendItem>& legend_items() {
  static const Draw spiral = [](Canvas& c) {
    draw_spiral(c, {17, 0}, {1, 0}, 10, {.stroke = ink::spring, .width = 1.3});
  };
  static const Draw dashpot = [](Canvas& c) {
    draw_dashpot(c, {0, 0}, {34, 0}, {}, {.stroke = ink::damper, .width = 1.4});
  };
  static const Draw bar = [](Canvas& c) { draw_massless_bar(c, {3, 0}, {31, 0}, 5.0); };
  static const Draw centre = [](Canvas& c) { draw_centre_of_mass(c, {17, 0}, 5.0); };
  static const std::vector<LegendItem> items = {
      {Sign::load, "load", an_arrow(ink::load, 2.4)},
      {Sign::reaction, "joint force on the body named", an_arrow(ink::reaction, 1.5)},
      {Sign::undetermined_reaction, "* not determined by statics: minimum-norm solution",
       an_arrow(ink::reaction, 1.5, "4 3")},
      {Sign::drive, "drive", an_arrow(ink::drive, 2.0)},
      {Sign::spring, "spring, tension +", a_spring(ink::spring, 1.5)},
      {Sign::slack_spring, "slack spring", a_spring(ink::slack, 1.3, "3 3")},
      {Sign::torsion_spring, "torsion spring, moment on its second body", spiral},
      {Sign::damper, "damper, no force in equilibrium", dashpot},
      {Sign::massless_bar, "massless bar, tension +", bar},
      {Sign::centre_of_mass, "centre of mass", centre},
      {Sign::active_stop, "active stop, its force or moment", a_line({17, -8}, {17, 8}, ink::stop, 3.0)},
      {Sign::inactive_stop, "stop, not active", a_line({17, -8}, {17, 8}, ink::free_stop, 1.4)},
      {Sign::other_pose, "", a_line({4, 0}, {30, 0}, ink::ghost, 6.0)},
      {Sign::path, "path of the point named", a_line({2, 0}, {32, 0}, curve_colour(0), 1.8)}};
  return items;
}

/// The signs that occur, in rows no wider than `width`.
Canvas draw_legend(const Stage& stage, double width) {
  constexpr double sign_width = 42.0;
  constexpr double row = 24.0;
  Canvas canvas;
  Vec2 at{0, 0};
  const auto place = [&](double item_width) {
    if (at.x > 0 && at.x + item_width > width) at = {0, at.y + row};
    const Vec2 here = at;
    at.x += item_width + 22;
    return here;
  };
  const TextStyle style{.size = 11, .halo = false, .align = Align::start};
  for (const LegendItem& item : legend_items()) {
    if (!stage.signs.contains(item.sign)) continue;
    std::string text = item.text;
    // One other position is named here, several where they are.
    if (item.sign == Sign::other_pose)
      text = stage.shadows.size() == 1 ? stage.shadows.front() : "other positions";
    else if (!stage.picture.reactions)  // what follows a comma is about forces
      text = text.substr(0, text.find(','));
    const Vec2 here = place(sign_width + text_width(text, style.size));
    Canvas sign;
    item.draw(sign);
    canvas.insert(sign, "", here);
    canvas.text(here + Vec2{sign_width, 4}, text, style);
  }
  if (stage.signs.contains(Sign::load) || stage.signs.contains(Sign::reaction)) {
    const std::string text = "Arrows grow with the square root of the force.";
    TextStyle remark = style;
    remark.colour = ink::faint;
    canvas.text(place(text_width(text, style.size)) + Vec2{0, 4}, text, remark);
  }
  return canvas;
}

}  // namespace

void draw_all(Stage& stage) {
  draw_other_poses(stage);
  draw_supports(stage);
  draw_guides(stage);
  draw_bodies(stage);
  draw_centres_of_mass(stage);
  draw_springs_and_dampers(stage);
  draw_pins(stage);
  draw_stops(stage);
  draw_paths(stage);
  draw_reactions(stage);
  draw_drives(stage);
  draw_loads(stage);
}

std::vector<std::string> wrapped(const std::string& text, double size, double width) {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (longer == word || text_width(longer, size) <= width)
      lines.back() = longer;
    else
      lines.push_back(word);
  }
  return lines;
}

double draw_heading(Canvas& page, const Scene& scene, const std::string& heading, bool confirmed, Vec2 at,
                    double width) {
  double y = at.y + 18;
  const auto write = [&](const std::string& text, double size, Colour colour, bool bold) {
    for (const std::string& line : wrapped(text, size, width)) {
      page.text({at.x, y}, line, {.size = size, .colour = colour, .bold = bold, .halo = false, .align = Align::start});
      y += 1.35 * size;
    }
  };
  write(title_of(scene), 18, ink::dark, true);
  y -= 5;
  if (!scene.source.empty()) write("Source: " + scene.source, 11, ink::faint, false);
  if (!heading.empty()) write(heading, 12, confirmed ? ink::dark : ink::load, false);
  return y;
}

std::string heading_page(const Scene& scene, const std::string& heading, bool confirmed, const std::string& kind) {
  constexpr double width = 900.0;
  Canvas page;
  const double bottom = draw_heading(page, scene, heading, confirmed, {margin, margin / 2}, width - 2 * margin);
  return svg_document(page, width, bottom, kind, heading);
}

std::string draw_mechanism(const Scene& scene, const MechanismPicture& picture) {
  const Stage stage = drawn_to_fit(scene, picture);
  const Box& bounds = stage.canvas.bounds();
  const double width = std::max(room, bounds.width());

  Canvas page;
  const double below_heading =
      draw_heading(page, scene, picture.heading, picture.confirmed, {margin, margin}, width - 130) + 14;
  page.insert(draw_gravity(stage), "gravity", {margin + width - 24, margin + 22});
  page.insert(stage.canvas, "mechanism",
              {margin + (width - bounds.width()) / 2 - bounds.low.x, below_heading - bounds.low.y});
  double y = below_heading + bounds.height() + 34;
  page.insert(draw_scale_bar(stage), "scale", {margin + 4, y});
  y += 34;
  page.line({margin, y}, {margin + width, y}, {.stroke = ink::ghost, .width = 1});
  y += 22;
  const Canvas legend = draw_legend(stage, width);
  page.insert(legend, "legend", {margin, y});
  const double height = y + std::max(0.0, legend.bounds().high.y) + margin;

  return svg_document(page, width + 2 * margin, height, title_of(scene), picture.heading);
}

std::string draw_svg(const StaticModel& model, const Equilibrium& equilibrium, const std::vector<double>& start) {
  MechanismPicture picture{.poses = model.poses(equilibrium.x),
                           .heading = verdict(equilibrium),
                           .confirmed = equilibrium.found(),
                           .reactions = equilibrium.check.reactions};
  if (!start.empty()) picture.others.push_back({"starting position", model.poses(start)});
  return draw_mechanism(model.scene(), picture);
}

std::string stacked(const std::string& above, const std::string& below) {
  struct Part {
    std::string_view element;  // from "<svg" on
    double width, height;
  };
  const auto read = [](std::string_view document) {
    const std::string_view element = document.substr(document.find("<svg"));
    const auto size = [&](std::string_view key) {
      return std::strtod(element.data() + element.find(key) + key.size(), nullptr);
    };
    return Part{element, size(" width=\""), size(" height=\"")};
  };
  const Part parts[] = {read(above), read(below)};
  const double width = std::max(parts[0].width, parts[1].width);
  const double height = parts[0].height + parts[1].height;
  std::string page = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      width, height);
  double y = 0.0;
  for (const Part& part : parts) {
    page += fmt::format("<svg x=\"{:.0f}\" y=\"{:.0f}\"", 0.5 * (width - part.width), y);
    page += part.element.substr(std::string_view("<svg").size());
    y += part.height;
  }
  return page + "</svg>\n";
}

}  // namespace poise::app

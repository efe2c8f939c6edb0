#include "app/draw/legend.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "app/draw/symbols.hpp"
#include "app/result/numbers.hpp"
#include "model/quantity.hpp"

namespace poise::app {
namespace {

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
  static const Draw strut = [](Canvas& c) {
    draw_gas_strut(c, {0, 0}, {34, 0}, {}, {.stroke = ink::spring, .width = 1.4});
  };
  static const Draw dashpot = [](Canvas& c) {
    draw_dashpot(c, {0, 0}, {34, 0}, {}, {.stroke = ink::damper, .width = 1.4});
  };
  static const Draw blade = [](Canvas& c) { draw_blade(c, {17, 0}, {1, 0}, 13, ink::dark); };
  static const Draw motor = [](Canvas& c) { draw_motor(c, {17, 0}, 9, {.stroke = ink::drive, .width = 1.4}); };
  static const Draw controller = [](Canvas& c) {
    draw_controller(c, {17, 0}, 9, {.stroke = ink::drive, .width = 1.4});
  };
  static const Draw bar = [](Canvas& c) { draw_massless_bar(c, {3, 0}, {31, 0}, 5.0); };
  static const Draw pitch_circle = [](Canvas& c) {
    c.circle({17, 0}, 9, {.stroke = ink::free_stop, .width = 1.3, .dash = "7 2 2 2"});
  };
  static const Draw cam = [](Canvas& c) {
    c.polygon({{10, -6}, {17, -8}, {30, 0}, {17, 8}, {10, 6}, {8, 0}}, {.stroke = ink::stop, .width = 1.6});
  };
  static const Draw geneva = [](Canvas& c) {
    std::vector<Vec2> wheel = geneva_wheel(3);
    for (Vec2& point : wheel) point = Vec2{17, 0} + 10.0 * point;
    c.polygon(std::move(wheel), {.stroke = ink::free_stop, .width = 1.2});
  };
  static const Draw track = [](Canvas& c) {
    const std::vector<Vec2> line{{4, 4}, {9, -3}, {16, -5}, {24, 1}, {30, 4}};
    c.polyline(line, {.stroke = ink::dark, .width = 8.0});
    c.polyline(line, {.stroke = ink::support, .width = 6.0});
  };
  static const Draw rolling = [](Canvas& c) {
    c.circle({17, 0}, 7, {.stroke = ink::dark, .width = 1.3});
    c.line({4, 7}, {30, 7}, {.stroke = ink::ground, .width = 1.3});
  };
  static const Draw area = [](Canvas& c) {
    c.polygon({{2, 7}, {2, -1}, {32, -8}, {32, 7}}, {.fill = curve_colour(0), .opacity = 0.25});
    c.line({2, -1}, {32, -8}, {.stroke = curve_colour(0), .width = 1.6});
  };
  static const Draw centre = [](Canvas& c) { draw_centre_of_mass(c, {17, 0}, 5.0); };
  static const std::vector<LegendItem> items = {
      {Sign::load, "load", an_arrow(ink::load, 2.4)},
      {Sign::reaction, "joint force on the body named", an_arrow(ink::reaction, 1.5)},
      {Sign::undetermined_reaction, "* not determined by statics: minimum-norm solution",
       an_arrow(ink::reaction, 1.5, "4 3")},
      {Sign::drive, "drive", an_arrow(ink::drive, 2.0)},
      {Sign::spring, "spring, tension +", a_spring(ink::spring, 1.5)},
      {Sign::slack_spring, "slack spring", a_spring(ink::slack, 1.3, "3 3")},
      {Sign::gas_strut, "gas strut, tension +", strut},
      {Sign::torsion_spring, "torsion spring, moment on its second body", spiral},
      {Sign::damper, "damper, no force in equilibrium", dashpot},
      {Sign::motor, "motor, off in statics", motor},
      {Sign::controller, "controller, off in statics", controller},
      {Sign::massless_bar, "massless bar, tension +", bar},
      {Sign::centre_of_mass, "centre of mass", centre},
      {Sign::rope, "rope, dotted where it is slack", a_line({4, 0}, {30, 0}, ink::stop, 2.0)},
      {Sign::wheels, "gears, rack, belt or chain, at their pitch circles", pitch_circle},
      {Sign::geneva, "Geneva drive", geneva},
      {Sign::cam, "cam: path of the roller's centre, or larger where it lifts", cam},
      {Sign::track, "slot along a curve", track},
      {Sign::rolling, "wheel or curve that rolls without slipping", rolling},
      {Sign::active_stop, "active stop, its force or moment", a_line({17, -8}, {17, 8}, ink::stop, 3.0)},
      {Sign::inactive_stop, "stop, not active", a_line({17, -8}, {17, 8}, ink::free_stop, 1.4)},
      {Sign::blade, "blade: moves along its edge only", blade},
      {Sign::contact_force, "force of a contact", an_arrow(ink::stop, 1.8)},
      {Sign::impact, "impact, larger with its impulse",
       [](Canvas& c) {
         draw_burst(c, {17, 0}, 4.0, 10.0, {.stroke = ink::stop, .width = 1.8});
       }},
      {Sign::other_pose, "", a_line({4, 0}, {30, 0}, ink::ghost, 6.0)},
      {Sign::path, "path of the point named", a_line({2, 0}, {32, 0}, curve_colour(0), 1.8)},
      {Sign::bent_link, "link as it bends", a_line({2, 0}, {32, 0}, curve_colour(0), 1.8)},
      {Sign::diagram, "internal load along the link", area},
      {Sign::slip, "slips first", [](Canvas& c) {
         c.circle({17, 0}, 8.0, {.stroke = ink::load, .width = 2.2});
       }}};
  return items;
}

}  // namespace

Canvas draw_legend(const LegendContents& contents, double width) {
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
    if (!contents.signs.contains(item.sign)) continue;
    std::string text = item.text;
    // One other position is named here, several where they are.
    if (item.sign == Sign::other_pose)
      text = contents.shadows.size() == 1 ? contents.shadows.front() : "other positions";
    else if (!contents.forces)  // what follows a comma is about forces
      text = text.substr(0, text.find(','));
    const Vec2 here = place(sign_width + text_width(text, style.size));
    Canvas sign;
    item.draw(sign);
    canvas.insert(sign, "", here);
    canvas.text(here + Vec2{sign_width, 4}, text, style);
  }
  const bool has_arrows = contents.signs.contains(Sign::load) || contents.signs.contains(Sign::reaction) ||
                          contents.signs.contains(Sign::contact_force);
  if (has_arrows) {
    const std::string text = "Arrows grow with the square root of the force.";
    TextStyle remark = style;
    remark.colour = ink::faint;
    canvas.text(place(text_width(text, style.size)) + Vec2{0, 4}, text, remark);
  }
  return canvas;
}

Canvas draw_gravity(const Scene& scene) {
  Canvas canvas;
  const double size = norm(scene.gravity);
  const bool moves = std::any_of(scene.time_functions.begin(), scene.time_functions.end(),
                                 [](const TimeFunction& one) { return one.of == TimeFunction::Of::frame; });
  const TextStyle style{.size = 11, .halo = false, .align = Align::end};
  if (size == 0.0) {
    if (moves) canvas.text({10.0, 4.0}, "the frame moves", style);
    return canvas;
  }
  const Vec2 u = conj((1 / size) * scene.gravity);
  draw_arrow(canvas, -17.0 * u, 17.0 * u, ink::dark, 2.0);
  canvas.text({-14.0, 4.0},
              "g = " + significant(in_unit(size, Quantity::length, scene.units), 4) + " " + scene.units.length_name +
                  "/s\u00b2" + (moves ? ", the frame moves" : ""),
              style);
  return canvas;
}

Canvas draw_scale_bar(double scale, const Units& units) {
  Canvas canvas;
  const double px_per_unit = scale * units.length;
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
  canvas.text({width, 17}, significant(length, 3) + " " + units.length_name, {.halo = false});
  return canvas;
}

}  // namespace poise::app

#include "app/draw/mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "app/draw/sheet.hpp"
#include "app/draw/stage.hpp"
#include "statics/equilibrium/answer.hpp"

namespace poise::app {
namespace {

constexpr double room_across_page = sheet::width - 2 * sheet::margin;

Stage drawn(const Scene& scene, const MechanismPicture& picture, double width) {
  constexpr double page_height = 500.0;
  Stage stage(scene, picture, {width, page_height});
  draw_all(stage);
  const double middle = stage.canvas.bounds().middle().x;
  stage.setter.keep_between(middle - room_across_page / 2, middle + room_across_page / 2);
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
    const double over = stage.canvas.bounds().width() - room_across_page;
    if (over <= 0.0 || width <= smallest) return stage;
    width = std::max(smallest, std::min(width - over - 1.0, least_step * width));
  }
}

std::string heading_of(const Equilibrium& equilibrium) {
  const std::string method = to_string(equilibrium.method);
  const bool is_answer = equilibrium.found() || equilibrium.status == Status::checked;
  if (!is_answer) return "No equilibrium proved (" + to_string(equilibrium.status) + ", " + method + ")";
  return "In equilibrium, " + in_few_words(equilibrium) + "; found by " + method;
}

const std::string& title_of(const Scene& scene) { return scene.title.empty() ? scene.file : scene.title; }

void draw_slips(Stage& stage) {
  for (const Vec2& at : stage.picture.slipping) {
    stage.canvas.circle(stage.page(at), stage.pin_radius + 8.0, {.stroke = ink::load, .width = 2.2});
    stage.signs.insert(Sign::slip);
  }
}

// A cross with its name. One far away would leave no room for the mechanism.
void draw_crosses(Stage& stage) {
  if (stage.picture.crosses.empty()) return;
  Vec2 least{HUGE_VAL, HUGE_VAL}, most{-HUGE_VAL, -HUGE_VAL};
  for (const BodyPose<double>& pose : stage.picture.poses) {
    least = {std::min(least.x, pose.origin.x), std::min(least.y, pose.origin.y)};
    most = {std::max(most.x, pose.origin.x), std::max(most.y, pose.origin.y)};
  }
  const double reach = std::max(most.x - least.x, most.y - least.y);
  for (const auto& [at, name] : stage.picture.crosses) {
    const bool is_far =
        at.x < least.x - reach || at.x > most.x + reach || at.y < least.y - reach || at.y > most.y + reach;
    if (is_far) continue;
    const Vec2 page = stage.page(at);
    const double arm = stage.pin_radius + 3.0;
    const Paint paint{.stroke = Colour::dark, .width = 1.4};
    stage.canvas.line({page.x - arm, page.y - arm}, {page.x + arm, page.y + arm}, paint);
    stage.canvas.line({page.x - arm, page.y + arm}, {page.x + arm, page.y - arm}, paint);
    stage.label(name, page, {0, -1}, arm + 2, ink::dark);
  }
}

}  // namespace

void draw_all(Stage& stage) {
  draw_other_poses(stage);
  draw_supports(stage);
  draw_guides(stage);
  draw_tracks(stage);
  draw_bodies(stage);
  draw_centres_of_mass(stage);
  draw_springs_and_dampers(stage);
  draw_pins(stage);
  draw_slips(stage);
  draw_crosses(stage);
  draw_stops(stage);
  draw_blades(stage);
  draw_paths(stage);
  draw_diagrams(stage);
  draw_reactions(stage);
  draw_contact_forces(stage);
  draw_impacts(stage);
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
  const double bottom =
      draw_heading(page, scene, heading, confirmed, {sheet::margin, sheet::margin / 2}, width - 2 * sheet::margin);
  return svg_document(page, width, bottom, kind, heading);
}

std::string draw_mechanism(const Scene& scene, const MechanismPicture& picture) {
  const Stage stage = drawn_to_fit(scene, picture);
  const Box& bounds = stage.canvas.bounds();
  const double width = std::max(room_across_page, bounds.width());

  Canvas page;
  const double below_heading =
      draw_heading(page, scene, picture.heading, picture.confirmed, {sheet::margin, sheet::margin}, width - 130) + 14;
  page.insert(picture.loads ? draw_gravity(scene) : Canvas(), "gravity",
              {sheet::margin + width - 24, sheet::margin + 22});
  page.insert(stage.canvas, "mechanism",
              {sheet::margin + (width - bounds.width()) / 2 - bounds.low.x, below_heading - bounds.low.y});
  double y = below_heading + bounds.height() + 34;
  page.insert(draw_scale_bar(stage.scale, scene.units), "scale", {sheet::margin + 4, y});
  y += 34;
  page.line({sheet::margin, y}, {sheet::margin + width, y}, {.stroke = ink::ghost, .width = 1});
  y += 22;
  const Canvas legend = draw_legend({stage.signs, stage.shadows, picture.reactions.has_value()}, width);
  page.insert(legend, "legend", {sheet::margin, y});
  const double height = y + std::max(0.0, legend.bounds().high.y) + sheet::margin;

  return svg_document(page, width + 2 * sheet::margin, height, title_of(scene), picture.heading);
}

void add_forces(MechanismPicture& picture, const StaticModel& model, const Equilibrium& equilibrium) {
  picture.reactions = equilibrium.check.reactions;
  if (!equilibrium.found()) return;
  // Angles between bodies take two coordinates, lengths may take them all.
  const double radius = equilibrium.certificate.radius;
  picture.angle_radius = 2.0 * radius;
  picture.length_radius = radius * model.scales().length * model.mechanism().coordinates();
  for (const ElementForce& force : equilibrium.check.element_forces) picture.element_radii.push_back(force.radius);
}

MechanismPicture picture_of(const StaticModel& model, const Equilibrium& equilibrium,
                            const std::vector<double>& start) {
  MechanismPicture picture{
      .poses = model.poses(equilibrium.x), .heading = heading_of(equilibrium), .confirmed = equilibrium.found()};
  add_forces(picture, model, equilibrium);
  if (!start.empty()) picture.others.push_back({"starting position", model.poses(start)});
  return picture;
}

std::string draw_svg(const StaticModel& model, const Equilibrium& equilibrium, const std::vector<double>& start) {
  return draw_mechanism(model.scene(), picture_of(model, equilibrium, start));
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

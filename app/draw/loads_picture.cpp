#include "app/draw/loads_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <list>
#include <utility>

#include <fmt/format.h>

#include "app/draw/followed.hpp"
#include "app/draw/frames.hpp"
#include "app/draw/mechanism.hpp"
#include "app/result/numbers.hpp"

namespace poise::app {
namespace {

constexpr int parts_of_piece = 24;  // in which a piece is drawn
constexpr double same_value = 1e-6;

/// Where positive values are drawn, seen in the direction of the line.
enum class Side { left, right };

/// A quantity that is drawn along the links.
struct Drawn {
  const char* title;
  double LinkState::*value;
  Quantity quantity;
  Side side;
  Colour colour;
};

constexpr std::array<Drawn, 3> drawn_quantities{
    Drawn{"Normal force", &LinkState::normal, Quantity::force, Side::left, ink::curve_1},
    Drawn{"Shear force", &LinkState::shear, Quantity::force, Side::left, ink::curve_2},
    Drawn{"Bending moment, on the stretched side", &LinkState::moment, Quantity::moment, Side::right, ink::curve_3}};

MechanismPicture picture_of_quantity(const Poses& poses, const std::vector<LinkLoads>& links, const Drawn& drawn) {
  // A rigid link turns by a corner, one that bends by a little from place to place.
  constexpr double corner = 0.1;
  MechanismPicture picture{.poses = poses};
  for (const LinkLoads& link : links) {
    const BodyPose<double>& pose = poses[static_cast<std::size_t>(link.frame)];
    const std::size_t first = picture.diagrams.size();
    Vec2 along{};
    for (const LinkSample& sample : link.sampled(parts_of_piece)) {
      const bool turns = !link.flexible && norm(sample.along - along) > corner;
      if (picture.diagrams.size() == first || turns)
        picture.diagrams.push_back({.name = link.name, .quantity = drawn.quantity, .colour = drawn.colour});
      along = sample.along;
      Diagram& diagram = picture.diagrams.back();
      const Vec2 left = quarter_turn(sample.along) * pose.direction();
      diagram.at.push_back(pose.world(sample.state.at));
      diagram.toward.push_back(drawn.side == Side::left ? left : -left);
      diagram.value.push_back(sample.state.*drawn.value);
    }
    // What is as large on both sides of a corner is said once.
    for (std::size_t k = first + 1; k < picture.diagrams.size(); ++k) {
      const double before = largest_of({picture.diagrams[k - 1]}), here = largest_of({picture.diagrams[k]});
      picture.diagrams[k].labelled = std::abs(before - here) > same_value * here;
    }
  }
  return picture;
}

/// A factor of one digit by which the largest deflection is drawn as a tenth of the longest link.
double enlargement(const std::vector<LinkLoads>& links) {
  double length = 0.0, deflection = 0.0;
  for (const LinkLoads& link : links) {
    length = std::max(length, link.length);
    deflection = std::max(deflection, link.deflection.value);
  }
  if (deflection <= 0.0) return 1.0;
  const double factor = 0.1 * length / deflection;
  const double decade = std::pow(10.0, std::floor(std::log10(factor)));
  return std::max(1.0, std::floor(factor / decade) * decade);
}

/// Of rigid links; flexible ones are drawn as they are bent.
MechanismPicture picture_of_deflection(const Poses& poses, const std::vector<LinkLoads>& links, double factor) {
  MechanismPicture picture{.poses = poses, .paths_are_links = true};
  for (const LinkLoads& link : links) {
    if (link.flexible) continue;
    PointPath path{link.name, {}};
    for (const LinkSample& sample : link.sampled(parts_of_piece)) {
      const Vec2 at = sample.state.at + factor * sample.state.deflection;
      path.points.push_back(poses[static_cast<std::size_t>(link.frame)].world(at));
    }
    picture.paths.push_back(std::move(path));
  }
  return picture;
}

struct Titled {
  std::string title;
  MechanismPicture picture;
};

/// Those that are known.
std::vector<LinkLoads> known(const std::vector<LinkLoads>& all) {
  std::vector<LinkLoads> links;
  std::copy_if(all.begin(), all.end(), std::back_inserter(links), [](const LinkLoads& l) { return l.why.empty(); });
  return links;
}

/// What shows most of links over a range: how they bend, or, where none does, how they are pulled.
const Drawn& told_of(const std::vector<LoadsAt>& loads) {
  constexpr double negligible = 1e-9;
  double force = 0.0, moment = 0.0;
  for (const LoadsAt& here : loads) {
    for (const LinkLoads& link : here.links) {
      force = std::max(force, std::abs(link.normal.value) * link.length);
      moment = std::max(moment, std::abs(link.moment.value));
    }
  }
  return moment > negligible * force ? drawn_quantities[2] : drawn_quantities[0];
}

std::vector<Titled> pictures_of(const Poses& poses, const std::vector<LinkLoads>& all) {
  const std::vector<LinkLoads> links = known(all);
  std::vector<Titled> out;
  for (const Drawn& drawn : drawn_quantities) {
    out.push_back({drawn.title, picture_of_quantity(poses, links, drawn)});
  }
  if (std::all_of(links.begin(), links.end(), [](const LinkLoads& l) { return l.flexible; })) return out;
  const double factor = enlargement(links);
  out.push_back({fmt::format("Deflection, {} times as large", significant(factor, 4)),
                 picture_of_deflection(poses, links, factor)});
  return out;
}

}  // namespace

std::string loads_picture(const Scene& scene, const Poses& poses, const std::vector<LinkLoads>& links,
                          const std::string& heading, bool confirmed) {
  std::string out;
  for (Titled& one : pictures_of(poses, links)) {
    one.picture.heading = one.title + ". " + heading;
    one.picture.confirmed = confirmed;
    const std::string document = draw_mechanism(scene, one.picture);
    out = out.empty() ? document : stacked(out, document);
  }
  return out;
}

Figure loads_figure(const Scene& scene, const Poses& poses, const std::vector<LinkLoads>& links, bool confirmed) {
  std::vector<Position> positions;
  for (Titled& one : pictures_of(poses, links)) {
    Position& position = positions.emplace_back();
    position.scene = &scene;
    position.picture = std::move(one.picture);
    position.picture.heading = one.title;
    position.picture.confirmed = confirmed;
  }
  return {.title = "Internal loads",
          .drawing = draw_frames(std::move(positions),
                                 "Normal force, shear force, bending moment and deflection of the "
                                 "links, drawn on the mechanism"),
          .switched = true};
}

Figure loads_figure(const VariedScene& varied, const LoadsAlong& answer, std::vector<Panel> panels, bool confirmed) {
  const Drawn& told = told_of(answer.loads);
  const std::string unit = varied.unit_name().empty() ? "" : " " + varied.unit_name();
  Play play{.label = varied.name(), .unit = varied.unit_name()};
  std::list<Scene> scenes;
  std::vector<Position> positions;
  double largest = 0.0;
  bool has_diagrams = false;
  for (const std::size_t k : evenly(answer.loads.size(), most_frames(varied.scene(), true))) {
    const LoadsAt& here = answer.loads[k];
    const Poses poses = varied.model_at(here.point.parameter)->poses(here.point.x);
    const double value = here.point.parameter / varied.unit();
    scenes.push_back(varied.is_driven() ? varied.scene() : varied.scene_at(here.point.parameter));
    Position& position = positions.emplace_back(Position{.scene = &scenes.back()});
    if (here.links.empty()) {
      position.picture = {.poses = poses, .reactions = here.check.reactions};
    } else {
      position.picture = picture_of_quantity(poses, known(here.links), told);
      has_diagrams = true;
    }
    position.picture.heading = fmt::format("{} = {}{}", varied.name(), significant(value, 4), unit);
    position.picture.confirmed = confirmed;
    largest = std::max(largest, largest_of(position.picture.diagrams));
    play.values.push_back(value);
  }
  for (Position& position : positions) position.picture.largest_diagram = largest;
  Figure figure{.title = fmt::format("{} over {}", has_diagrams ? told.title : "Forces", varied.name())};
  figure.charts.panels = std::move(panels);
  figure.charts.cursors.assign(figure.charts.panels.size(), {.x = play.values});
  animate(figure, std::move(positions), std::move(play), "The mechanism with its loads over the range", {});
  return figure;
}

}  // namespace poise::app

#include "motion/driven_coordinates.hpp"

#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"

namespace poise {
namespace {

bool is_coordinate(const Measure& on) {
  return on.kind == Measure::Kind::travel || (on.kind == Measure::Kind::angle && on.body_a == 0);
}

std::string begin_of_line(const Scene& scene) { return scene.file.empty() ? "" : scene.file + ": "; }

}  // namespace

std::vector<DrivenCoordinate> driven_coordinates(const MotionModel& model) {
  const Scene& scene = model.scene();
  const Layout& layout = model.layout();
  std::vector<DrivenCoordinate> out;
  int behind = model.mechanism().coordinates();
  for (const Drive& drive : scene.drives) {
    const Measure& on = drive.on;
    DrivenCoordinate driven{.unit = on.is_angle() ? 1.0 : model.scales().length, .is_angle = on.is_angle()};
    if (!is_coordinate(on)) {
      driven.coordinate = behind++;
    } else if (on.is_angle()) {
      const Link& link = layout.links[on.body_b];
      driven.coordinate = link.frame;
      driven.zero = layout.turns[link.turn].to<double>();
      driven.start = scene.bodies[static_cast<std::size_t>(on.body_b)].name;
    } else {
      driven.coordinate = layout.travel[on.joint];
      driven.start = scene.joints[static_cast<std::size_t>(on.joint)].name;
    }
    if (driven.coordinate < 0) {
      throw InputError(
          fmt::format("{}drive \"{}\": expected a body that can turn, this one keeps its angle; drive the "
                      "joint along which it moves",
                      begin_of_line(scene), drive.name));
    }
    for (std::size_t k = 0; k < out.size(); ++k) {
      if (out[k].coordinate != driven.coordinate && scene.drives[k].name != drive.name) continue;
      throw InputError(fmt::format("{}drive \"{}\": another drive already moves the same coordinate; drive one of them",
                                   begin_of_line(scene), drive.name));
    }
    out.push_back(std::move(driven));
  }
  return out;
}

std::vector<int> measured_drives(const Scene& scene) {
  std::vector<int> out;
  for (std::size_t k = 0; k < scene.drives.size(); ++k) {
    if (!is_coordinate(scene.drives[k].on)) out.push_back(static_cast<int>(k));
  }
  return out;
}

}  // namespace poise

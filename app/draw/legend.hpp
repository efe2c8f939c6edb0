#pragma once

// What stands beside a mechanism so that its picture can be read.

#include <set>
#include <string>
#include <vector>

#include "app/draw/canvas.hpp"
#include "model/scene.hpp"

namespace poise::app {

/// Signs that the legend explains where they occur.
enum class Sign {
  load,
  reaction,
  undetermined_reaction,
  drive,
  spring,
  slack_spring,
  gas_strut,
  torsion_spring,
  damper,
  motor,
  controller,
  massless_bar,
  centre_of_mass,
  rope,
  wheels,
  geneva,
  cam,
  track,
  rolling,
  active_stop,
  inactive_stop,
  blade,
  contact_force,
  impact,
  other_pose,
  path,
  bent_link,
  diagram,
  slip
};

/// What a legend has to explain.
struct LegendContents {
  std::set<Sign> signs;
  std::vector<std::string> shadows;  ///< names of the other positions
  bool forces = true;                ///< those of joints and springs are shown
};

/// The signs, in rows no wider than `width`, from the upper left corner on.
Canvas draw_legend(const LegendContents& contents, double width);

/// Direction and size of gravity, centred; empty without any.
Canvas draw_gravity(const Scene& scene);

/// A bar of a round length, 70 to 175 px, at so many px per m.
Canvas draw_scale_bar(double scale, const Units& units);

}  // namespace poise::app

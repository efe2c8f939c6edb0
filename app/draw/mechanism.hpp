#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/mechanism.hpp"
#include "motion/inverse_dynamics.hpp"
#include "statics/equilibrium.hpp"

namespace poise::app {

/// Places of the bodies of a scene, SI; more entries than bodies are ignored.
using Poses = std::vector<BodyPose<double>>;

/// Another position of the mechanism, drawn as a shadow: "starting position", "end", ...
struct OtherPose {
  std::string name;
  Poses poses;
};

/// The curve that a point runs along, m in the world.
struct Path {
  std::string name;
  std::vector<Vec2> points;
};

/// What a picture shows of a mechanism beside its bodies, joints, springs, dampers and stops. All numbers are finite.
struct MechanismPicture {
  Poses poses;            ///< the position drawn
  std::string heading{};  ///< below the title: the verdict
  bool confirmed = true;  ///< false: the heading is a warning
  bool loads = true;      ///< forces, torques and gravity of the scene
  /// Forces of joints and active stops in this position. Where absent, springs have no forces either.
  std::optional<std::vector<Reaction>> reactions{};
  std::vector<DriveEffort> drives{};  ///< of the scene's drives, by their names
  std::vector<OtherPose> others{};    ///< those that differ visibly are drawn
  std::vector<Path> paths{};
};

/// A figure for a report (SVG 1.1, UTF-8, no outside resources), 900 px wide, with values in the scene's units. A force
/// acts on the body that its label names and at the tail of its arrow.
std::string draw_mechanism(const Scene& scene, const MechanismPicture& picture);

/// The same of an equilibrium, which need not be confirmed, with its verdict and the position at the scaled coordinates
/// `start` (none where empty).
std::string draw_svg(const StaticModel& model, const Equilibrium& equilibrium, const std::vector<double>& start);

/// Two SVG documents of this program as one, the second below the first.
std::string stacked(const std::string& above, const std::string& below);

}  // namespace poise::app

#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/draw/canvas.hpp"
#include "model/mechanism.hpp"
#include "model/quantity.hpp"
#include "motion/forces_in_time.hpp"
#include "motion/inverse_dynamics.hpp"
#include "statics/equilibrium/equilibrium.hpp"

namespace poise::app {

/// Places of the bodies of a scene, SI; more entries than bodies are ignored.
using Poses = std::vector<BodyPose<double>>;

/// Another position of the mechanism, drawn as a shadow: "starting position", "end", ...
struct OtherPose {
  std::string name;
  Poses poses;
};

/// The curve that a point runs along, m in the world.
struct PointPath {
  std::string name;
  std::vector<Vec2> points;
};

/// A quantity along a line of the mechanism, drawn as an area beside it; of several diagrams in one scale.
struct Diagram {
  std::string name;  ///< of the body
  Quantity quantity = Quantity::force;
  Colour colour = Colour::none;
  std::vector<Vec2> at{};       ///< places along the line, m in the world
  std::vector<Vec2> toward{};   ///< at each the direction, a unit vector, in which positive values are drawn
  std::vector<double> value{};  ///< at each, SI
  bool labelled = true;         ///< with its largest value
};

/// What a stop was hit with, drawn for a short while.
struct ImpactSign {
  std::size_t stop = 0;  ///< index into Scene::stops
  Vec2 at{};             ///< m in the world
  double size = 1.0;     ///< of its impulse, over the largest of the motion
  double faded = 0.0;    ///< 0 at the impact, 1 where its sign ends
  double impulse = 0.0;  ///< N s or N m s
};

/// SI; 0 where there are no values.
double largest_of(const std::vector<Diagram>& diagrams);

/// What a picture shows of a mechanism beside its bodies, joints, springs, dampers and stops. All numbers are finite.
struct MechanismPicture {
  Poses poses;            ///< the position drawn
  std::string heading{};  ///< below the title: the verdict
  bool confirmed = true;  ///< false: the heading is a warning
  bool loads = true;      ///< forces, torques and gravity of the scene
  /// Forces of joints and active stops in this position. Where absent, springs have no forces either.
  std::optional<std::vector<Reaction>> reactions{};
  std::vector<TouchingForce> touching{};  ///< of stops in a motion, where `reactions` are absent
  std::vector<ImpactSign> impacts{};
  /// To which angles, rad, and lengths, m, of the position and the forces of elements, N or N m, are known; no radii of
  /// elements where nothing is proved.
  double angle_radius = 0.0, length_radius = 0.0;
  std::vector<double> element_radii{};
  std::vector<DriveEffort> drives{};  ///< of the scene's drives, by their names
  std::vector<OtherPose> others{};    ///< those that differ visibly are drawn
  std::vector<PointPath> paths{};
  bool paths_are_links = false;  ///< the paths are the lines of links as they bend
  std::vector<Diagram> diagrams{};
  std::optional<double> largest_diagram{};  ///< SI: the value drawn farthest out; where absent, the largest of them
  /// Places, m in the world, that a cross marks with its text: "centre crank, ground", a sensor. Those far from the
  /// bodies are left out.
  std::vector<std::pair<Vec2, std::string>> crosses{};
  std::vector<Vec2> slipping{};  ///< m in the world: where what slips first is marked
  /// The part of the world, m, to which the scale fits; where absent, that which the positions and paths take up.
  std::optional<Box> frame{};
  /// The force, N, whose arrow is the longest; where absent, the largest of those drawn.
  std::optional<double> largest_force{};
};

/// A figure for a report (SVG 1.1, UTF-8, no outside resources), 900 px wide, with values in the scene's units. A force
/// acts on the body that its label names and at the tail of its arrow.
std::string draw_mechanism(const Scene& scene, const MechanismPicture& picture);

/// Adds the forces of an equilibrium, and, where it was found, to which radii they and the position are known.
void add_forces(MechanismPicture& picture, const StaticModel& model, const Equilibrium& equilibrium);

/// What a figure shows of an equilibrium, which need not be confirmed: its verdict, forces and, as a shadow, the
/// position at the scaled coordinates `start` (none where empty).
MechanismPicture picture_of(const StaticModel& model, const Equilibrium& equilibrium, const std::vector<double>& start);

/// That as an SVG document.
std::string draw_svg(const StaticModel& model, const Equilibrium& equilibrium, const std::vector<double>& start);

/// The title of a scene, its source below it, and a heading, which is a warning unless `confirmed`, from the upper left
/// corner `at` on. Returns where the last line ends, px.
double draw_heading(Canvas& page, const Scene& scene, const std::string& heading, bool confirmed, Vec2 at,
                    double width);

/// The same as an SVG document 900 px wide, to be stacked above pictures; `kind` is what they show: "positions".
std::string heading_page(const Scene& scene, const std::string& heading, bool confirmed, const std::string& kind);

/// Cuts a text into lines no wider than `width`, px.
std::vector<std::string> wrapped(const std::string& text, double size, double width);

/// Two SVG documents of this program as one, the second below the first.
std::string stacked(const std::string& above, const std::string& below);

}  // namespace poise::app

#pragma once

// What every part of a figure shares: the mechanism, its scale on the page, and the labels that wait to be set.

#include <cstddef>
#include <initializer_list>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "app/draw/canvas.hpp"
#include "app/draw/labels.hpp"
#include "app/draw/legend.hpp"
#include "app/draw/mechanism.hpp"
#include "app/result/numbers.hpp"
#include "statics/model/readings.hpp"

namespace poise::app {

/// How much of a mechanism a page can hold.
enum class Detail {
  full,     ///< everything, with names
  reduced,  ///< no names of bodies and points, no forces of inner joints
  sketch    ///< lines only: hundreds of bodies and more
};

/// A force element drawn between two points.
struct Strung {
  std::size_t element = 0;  ///< index into Scene::elements
  PointRef a, b;
};

/// The springs and dampers drawn between two points: upon a distance, or upon the travel of a joint.
std::vector<Strung> strung_of(const Scene& scene);

/// A slide between two straight bodies that are each pinned on the line of travel: a barrel and its rod.
struct Cylinder {
  std::size_t joint = 0;
  int barrel = 0, rod = 0;                ///< bodies
  Vec2 foot{}, mouth{}, piston{}, eye{};  ///< page: the barrel's pin and open end, the rod's inner end and pin
};

/// The edges of a contact's outline in this part of it, without those at which outlines are divided into parts.
std::vector<std::pair<PointRef, PointRef>> edges_of_contact(const Scene& scene, std::size_t stop);

/// The part of the world, m, that bodies, joints, springs and centres of mass take up in a position.
Box extent_of(const Scene& scene, const Readings& readings);

/// The part of the world, m, that a picture shows: its frame, or what its positions and paths take up.
Box world_of(const Scene& scene, const MechanismPicture& picture);

/// The largest force, N, that a picture draws as an arrow.
double largest_force_of(const Scene& scene, const MechanismPicture& picture);

/// Length, px, of the arrow of a force, N, where that of the largest is 84 px:  22 + 62 sqrt(force / largest). And the
/// force of a length; that of lengths up to 22 px is 0.
double length_of_arrow(double force, double largest);
double force_of_arrow(double length, double largest);

/// How large a mechanism is drawn, and in how much detail.
struct Sizes {
  Detail detail = Detail::full;
  bool shows_ground = true;  ///< supports and their reactions, even in a sketch when they are few
  double scale = 1.0;        ///< px per m
  Vec2 centre{};             ///< m: of the mechanism, the origin of the page
  double extent = 1.0;       ///< m: of the mechanism
  double bar_width = 8.0;    ///< px
  double pin_radius = 4.0;   ///< px
};

/// Those that fit a part of the world into `room`, px; arrows and labels come on top.
Sizes sizes_for(const Scene& scene, const Box& world, Vec2 room);

/// What was chosen in the pictures of a mechanism drawn before, so that nothing jumps about from one to the next.
struct Choices {
  std::unordered_map<std::string, std::size_t> taken;  ///< which of several places, by item
  LabelPlaces labels;
};

/// A mechanism on its way to the page.
class Stage : public Sizes {
 public:
  /// `room`, px, is for the mechanism itself.
  Stage(const Scene& scene, const MechanismPicture& picture, Vec2 room);
  /// One of several pictures in one scale, `before` of those drawn before; it is brought up to date.
  Stage(const Scene& scene, const MechanismPicture& picture, const Sizes& sizes, Choices* before);

  const Scene& scene;
  const MechanismPicture& picture;
  const Readings now;
  std::vector<Readings> others;
  std::vector<std::string> shadows{};  ///< names of the other positions drawn
  double largest_force = 0.0;          ///< N: whose arrow is the longest
  std::vector<Cylinder> cylinders;

  Canvas canvas;
  LabelSetter setter;
  std::vector<Label> labels;
  std::string_view label_layer{};             ///< of the labels that are asked for
  std::vector<std::pair<Vec2, Vec2>> arrows;  ///< drawn so far, tail and tip
  std::set<Sign> signs;

  /// World, m -> page, px.
  Vec2 page(Vec2 world) const { return scale * conj(world - centre); }
  Vec2 page(PointRef point) const { return page(world(scene, now, point)); }
  /// Direction on the page of a world direction.
  static Vec2 page_direction(Vec2 world) { return conj(world); }
  /// The line of travel of a joint, on the page.
  Vec2 page_axis(const Joint& joint) const {
    return page_direction(joint.direction() * unit(now.poses[joint.a.body].angle));
  }

  const std::vector<Strung>& strung() const { return strung_; }
  /// Points of a body on the page, in the position drawn.
  const std::vector<Vec2>& points_of(int body) const { return points_[static_cast<std::size_t>(body)]; }
  /// The ends of a body whose points lie on one line, or the corners of one whose points do not: those of the outline
  /// at which others touch it, or of the convex hull of its points.
  std::vector<Vec2> outline(int body, const Readings& readings) const;
  /// Directions in which things leave a place on the page: bodies, bars, springs and dampers that have a point there.
  std::vector<Vec2> members_at(Vec2 place) const;
  /// What a joint is called where it is pointed at: "pin A".
  static std::string item_of(const Joint& joint);
  /// Name of a joint fit for a figure: what the scene calls it, or else the point's name.
  std::string short_name(const Joint& joint) const;
  /// Where two bodies turn about each other: the joint they share, or the origin of `b`.
  Vec2 pivot(int a, int b) const;
  /// The cylinder that a body or a joint is part of; null where it is none.
  const Cylinder* cylinder_of_body(int body) const;
  const Cylinder* cylinder_of_joint(std::size_t joint) const;

  /// Length of the arrow for a force, px.
  double arrow_length(double force) const;
  /// "12.5 N", with a true minus sign, to four digits, and no more than are known; `radius` as `si`.
  std::string value(double si, Quantity quantity, double radius = 0.0) const;
  /// "150.35 mm": of a place or an angle, to five digits, and no more than are known of the position.
  std::string reading(double si, Quantity quantity) const;

  /// Of several places for something the one of least cost, the first of these; of that chosen in the picture before
  /// only where another is better by more than `margin`.
  std::size_t least(const std::string& item, std::initializer_list<double> costs, double margin) const;
  /// The place taken for something in the picture before where it is still free, else `choice`.
  template <class IsFree>
  std::size_t first_free(const std::string& item, std::size_t choice, IsFree is_free) const {
    if (before_ == nullptr) return choice;
    std::size_t& taken = before_->taken.try_emplace(item, choice).first->second;
    if (!is_free(taken)) taken = choice;
    return taken;
  }
  /// The place chosen for something in the first picture, or else `choice`.
  std::size_t first_choice(const std::string& item, std::size_t choice) const;

  /// Asks for a label of the canvas's item; set when everything is drawn.
  void label(std::string text, Vec2 anchor, Vec2 toward, double gap, Colour colour, double size = 11.0,
             bool italic = false);
  /// Sets all labels.
  void set_labels();

 private:
  void find_cylinders();

  std::vector<Strung> strung_;
  std::vector<std::vector<Vec2>> points_;  // of bodies, on the page
  std::vector<std::vector<Vec2>> shapes_;  // by outlines of contacts, in the frames of bodies; empty of others
  Choices* before_;
};

/// All parts of the figure, in their order, without labels.
void draw_all(Stage& stage);

// The parts of the figure, in the order in which they are drawn.
void draw_other_poses(Stage& stage);
void draw_guides(Stage& stage);
void draw_supports(Stage& stage);
void draw_bodies(Stage& stage);
void draw_springs_and_dampers(Stage& stage);
void draw_pins(Stage& stage);
void draw_stops(Stage& stage);
void draw_centres_of_mass(Stage& stage);
void draw_paths(Stage& stage);
void draw_diagrams(Stage& stage);
void draw_reactions(Stage& stage);
/// Draws the forces of what is touched, with their names where they are pointed at.
void draw_contact_forces(Stage& stage);
void draw_impacts(Stage& stage);
void draw_drives(Stage& stage);
void draw_blades(Stage& stage);
/// A rope over its points and pulleys.
void draw_rope_line(Stage& stage, const Measure& rope, const Paint& paint);
void draw_rope(Stage& stage, const Stop& stop, bool taut);
/// Pitch circles of gears, racks and belts; wheel, locking disc and pin of a Geneva drive; a cam by its pitch curve, or
/// as a shape that stands out where it lifts.
void draw_coupling(Stage& stage, const Stop& stop, bool in_contact);
/// Two wheels, m in the world: where they turn, and the radii at which they roll on one another or with a belt; 0 of
/// wheels on one axis, which are not known.
struct PitchCircles {
  Vec2 centre_a{}, centre_b{};
  double radius_a = 0.0, radius_b = 0.0;
};
PitchCircles pitch_circles(const Scene& scene, const Readings& readings, const Stop& stop);
/// Where two bodies turn against each other, m in the world.
Vec2 pivot_of(const Scene& scene, const Readings& readings, int a, int b);
/// The curve on which the centre of a cam's roller runs, seen from the cam, m: where it is with the follower at the
/// lift of every angle, turned back by as much as the cam has to turn to that angle. Empty where the scene does not say
/// where they are (model/cam_geometry.hpp).
std::vector<Vec2> pitch_curve(const Scene& scene, const Readings& readings, const Stop& stop);
/// Curved slots as bands, wheels and profiles that roll with their line or circle, chains with their sprockets. Whether
/// a stop is a row of one of these.
void draw_tracks(Stage& stage);
bool has_track(const Stop& stop);
/// Makes the box hold what is drawn of one in this position, whose first row is at this place in the scene's stops.
void include_track(const Scene& scene, const Readings& readings, std::size_t first, Box& box);
void draw_loads(Stage& stage);

}  // namespace poise::app

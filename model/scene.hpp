#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "model/planar.hpp"

namespace poise {

/// Something is wrong with what the user gave: one line "file:line: item: what was expected; a likely fix".
/// The command line answers it with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// SI value of one unit of the scene. Every number in a Scene is SI already (m, N, kg, rad); the units are kept
/// so that results can be shown in what the user wrote.
struct Units {
  std::string length_name = "m";
  std::string force_name = "N";
  std::string mass_name = "kg";
  std::string angle_name = "rad";
  double length = 1.0;
  double force = 1.0;
  double mass = 1.0;
  double angle = 1.0;
};

/// A point fixed in a body, in the body's own frame, m.
struct NamedPoint {
  std::string name;
  Vec2 at;
};

/// A rigid body. Bodies[0] of every scene is the ground, whose frame is the world's.
struct Body {
  std::string name;
  std::vector<NamedPoint> points;
  double mass = 0.0;     ///< kg
  Vec2 center{};         ///< centre of mass in the body's frame, m
  double inertia = 0.0;  ///< about the centre of mass, kg m^2
  int line = 0;          ///< where the scene file declares it
};

/// A point of a body: indices into Scene::bodies and Body::points.
struct PointRef {
  int body = 0;
  int point = 0;
};

/// A joint between points a and b.
///
/// pin          b coincides with a, the bodies turn freely
/// slide        b runs on the line through a along `axis` (fixed in a's body); angle(b) - angle(a) stays `angle`
/// pin_in_slot  b runs on that line and turns freely
/// weld         b coincides with a; angle(b) - angle(a) stays `angle`
/// bar          massless rod, keeps |b - a| = length
///
/// The travel of a slide or pin in a slot is the signed distance from a to b along the axis, m.
struct Joint {
  enum class Kind { pin, slide, pin_in_slot, weld, bar };
  Kind kind = Kind::pin;
  std::string name{};  ///< as given, or "ground.O-crank.O"
  PointRef a, b;
  Vec2 axis{1.0, 0.0};  ///< unit vector
  double angle = 0.0;   ///< rad
  double length = 0.0;  ///< m
  int line = 0;

  bool has_travel() const { return kind == Kind::slide || kind == Kind::pin_in_slot; }
  bool keeps_angle() const { return kind == Kind::slide || kind == Kind::weld; }
};

/// Line spring, energy k/2 (r - free_length)^2 with r = |b - a|; a tension (compression) spring is slack, without
/// force or energy, while r is below (above) its free length.
struct Spring {
  enum class Acts { both, tension, compression };
  std::string name;
  PointRef a, b;
  double stiffness = 0.0;    ///< N/m
  double free_length = 0.0;  ///< m
  Acts acts = Acts::both;
  int line = 0;
};

/// Torsion spring, energy k/2 (angle(b) - angle(a) - free_angle)^2, angles unwrapped: turns count.
struct TorsionSpring {
  std::string name;
  int a = 0, b = 0;         ///< bodies
  double stiffness = 0.0;   ///< N m/rad
  double free_angle = 0.0;  ///< rad
  int line = 0;
};

/// Viscous damper between two points: pulls them together with  coefficient dr/dt,  r = |b - a|.
struct Damper {
  std::string name;
  PointRef a, b;
  double coefficient = 0.0;  ///< N s/m
  int line = 0;
};

/// Viscous damper between two bodies: the torque  -coefficient d(angle(b) - angle(a))/dt  on b, its opposite on a.
struct TorsionDamper {
  std::string name;
  int a = 0, b = 0;          ///< bodies
  double coefficient = 0.0;  ///< N m s/rad
  int line = 0;
};

/// Dry friction between two bodies: the torque  -torque tanh(w / width)  on b, its opposite on a, where
/// w = d(angle(b) - angle(a))/dt: Coulomb's law made smooth, so that the bodies creep instead of sticking.
struct Friction {
  std::string name;
  int a = 0, b = 0;     ///< bodies
  double torque = 0.0;  ///< N m, of sliding
  double width = 0.01;  ///< rad/s
  int line = 0;
};

/// A motor that prescribes a quantity as a function of time t, whatever force that takes:
///   start + rate t + acceleration t^2/2 + amplitude (sin(2 pi frequency t + phase) - sin(phase)).
/// The quantity is the relative angle angle(b) - angle(a) of two bodies or the travel of a joint; rad or m.
/// Statics does not know drives.
struct Drive {
  enum class Kind { angle, travel };
  Kind kind = Kind::angle;
  std::string name;
  int body_a = 0, body_b = 0;   ///< angle
  int joint = -1;               ///< travel: index into Scene::joints
  std::optional<double> start;  ///< absent: where the mechanism stands when it is assembled
  double rate = 0.0;
  double acceleration = 0.0;
  double amplitude = 0.0;
  double frequency = 0.0;  ///< Hz
  double phase = 0.0;      ///< rad
  int line = 0;
};

/// Force at a point, N. A dead load keeps its direction in the world; a follower force keeps its direction in the
/// frame of the body `follows` and has no potential.
struct Force {
  std::string name;
  PointRef at;
  Vec2 vector{};
  int follows = -1;  ///< body, or -1 for a dead load
  int line = 0;
};

/// Torque on a body from the ground, N m, counter-clockwise positive.
struct Torque {
  std::string name;
  int body = 0;
  double value = 0.0;
  int line = 0;
};

/// A stop keeps min <= g <= max: g is the relative angle angle(b) - angle(a) of two bodies, the distance between
/// two points, or the travel of a joint.
struct Stop {
  enum class Kind { angle, distance, travel };
  Kind kind = Kind::angle;
  std::string name;
  int body_a = 0, body_b = 0;  ///< angle
  PointRef a, b;               ///< distance
  int joint = -1;              ///< travel: index into Scene::joints
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  int line = 0;
};

/// Guesses from which loops are closed and solvers start; absent guesses are zero. Angles are absolute and
/// unwrapped, in rad; travels in m; positions (world place of a body's origin, m) matter only to bodies that no chain
/// of joints, or only bars, tie to the ground.
struct Start {
  std::vector<std::optional<double>> angle;   ///< per body
  std::vector<std::optional<double>> travel;  ///< per joint
  std::vector<std::optional<Vec2>> position;  ///< per body
};

/// A planar mechanism as a person writes it down. All values SI.
struct Scene {
  std::string file;  ///< for messages
  std::string title;
  std::string source;
  Units units;
  Vec2 gravity{};  ///< m/s^2
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Spring> springs;
  std::vector<TorsionSpring> torsion_springs;
  std::vector<Damper> dampers;
  std::vector<TorsionDamper> torsion_dampers;
  std::vector<Friction> frictions;
  std::vector<Drive> drives;
  std::vector<Force> forces;
  std::vector<Torque> torques;
  std::vector<Stop> stops;
  Start start;

  /// A scene that holds only the ground.
  Scene();

  /// Building a scene in code. Each returns the index of what it added. Start guesses grow with it.
  int add_body(std::string name);
  PointRef add_point(int body, std::string name, Vec2 at);
  int add_joint(Joint joint);

  /// Coordinates of a point in its body's frame, m.
  const Vec2& local(PointRef p) const { return bodies[p.body].points[p.point].at; }
  /// "crank.B".
  std::string name_of(PointRef p) const;
};

/// Reads a scene file (TOML; grammar in docs/scene-files.md), converts to SI and checks it.
/// Throws InputError naming file, line, item, what was expected and the nearest valid name.
Scene read_scene(const std::filesystem::path& file);

/// The same from a text; `name` stands for the file in messages.
Scene parse_scene(std::string_view text, const std::string& name);

/// Sets one number of the scene, given in the scene's own units, by its path:
///   load.NAME             magnitude of force NAME along its direction, or the torque NAME
///   gravity.x | y
///   point.BODY.POINT.x | y   in the body's frame; BODY may be ground
///   body.NAME.mass | inertia | center.x | center.y
///   spring.NAME.stiffness | free_length,  torsion_spring.NAME.stiffness | free_angle
///   damper.NAME.coefficient,  torsion_damper.NAME.coefficient,  friction.NAME.torque | width
///   drive.NAME.start | rate | acceleration | amplitude | frequency | phase
///   bar.NAME.length
///   stop.NAME.min | max
///   start.NAME            guess for the angle of a body or the travel of a joint
/// Throws InputError naming the nearest valid path. Takes some 10 ns per number that the scene holds.
void set_value(Scene& scene, std::string_view path, double value);

/// The number that set_value sets, in the scene's own units: get_value(set_value(x)) = x. The limit that a stop lacks
/// is infinite, a guess that is absent 0; the start that a drive lacks is not known yet and throws InputError, and so
/// does a path that set_value does not take.
double get_value(const Scene& scene, std::string_view path);

/// SI value of one unit of that number: the scene holds get_value(scene, path) value_unit(scene, path).
double value_unit(const Scene& scene, std::string_view path);

}  // namespace poise

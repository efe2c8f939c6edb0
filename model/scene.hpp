#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/blade.hpp"
#include "model/cross_section.hpp"
#include "model/input_error.hpp"
#include "model/joint.hpp"
#include "model/laws/drive.hpp"
#include "model/laws/laws.hpp"
#include "model/laws/stop.hpp"
#include "model/measure.hpp"
#include "model/number.hpp"
#include "model/planar.hpp"
#include "model/point_ref.hpp"
#include "model/scales.hpp"
#include "model/time_function.hpp"
#include "model/units.hpp"

namespace poise {

/// A point fixed in a body, in the body's own frame, m.
struct NamedPoint {
  std::string name;
  Vec2 at;

  static const std::array<Number, 2> numbers;
};

inline constexpr std::array<Number, 2> NamedPoint::numbers{
    component_number<&NamedPoint::at, 0>("x", dimension::length),
    component_number<&NamedPoint::at, 1>("y", dimension::length)};

/// A rigid body. Bodies[0] of every scene is the ground, whose frame is the world's.
struct Body {
  std::string name;
  std::vector<NamedPoint> points;
  double mass = 0.0;     ///< kg
  Vec2 center{};         ///< centre of mass in the body's frame, m
  double inertia = 0.0;  ///< about the centre of mass, kg m^2
  int line = 0;          ///< in the scene file
  std::optional<CrossSection> section{};

  /// Bodies that are states of controllers have this inertia, kg m^2: their energies are less than the rounding of all
  /// others, and their accelerations are exact, because it is a power of two.
  static constexpr double inertia_of_states = 0x1p-120;
  static const std::array<Number, 4> numbers;
};

/// A link that bends in the equilibrium: a chain of rigid bodies, pinned one after the other along its line, and
/// springs on their angles (model/flexible_link.hpp). The scene file has it as one body.
struct FlexibleLink {
  std::string name;
  CrossSection section;      ///< its line is empty: the points belong to the bodies
  std::vector<int> bodies;   ///< in their order along the line
  std::vector<int> springs;  ///< elements of the scene, each with a stiffness in proportion to modulus second_moment
};

/// Inertia of a body about the origin of its frame: mass, first moment, moment of inertia.
template <class T>
struct BodyInertia {
  T mass{};           ///< m, kg
  Planar<T> first{};  ///< m c, kg m
  T moment{};         ///< I + m |c|^2, kg m^2
};

/// Derivative of the inertia by Body::numbers[number].
inline BodyInertia<double> inertia_by(const Body& body, int number) {
  const Vec2& c = body.center;
  switch (number) {
    case 0:
      return {1.0, c, dot(c, c)};
    case 1:
      return {0.0, {}, 1.0};
    case 2:
      return {0.0, {body.mass, 0.0}, 2 * body.mass * c.x};
    default:
      return {0.0, {0.0, body.mass}, 2 * body.mass * c.y};
  }
}

inline constexpr std::array<Number, 4> Body::numbers{
    plain_number<&Body::mass>("mass", dimension::mass, Range::not_negative),
    plain_number<&Body::inertia>("inertia", dimension::inertia, Range::not_negative),
    component_number<&Body::center, 0>("center.x", dimension::length),
    component_number<&Body::center, 1>("center.y", dimension::length)};

/// What a controller reads and gives, and where its states are: the rate of a body is its integral, that of another the
/// state of its filter or transfer function, those of three more what it holds between samples or gives after a delay
/// (ControlSignals), and the angle of another how far it has moved the drive that it sets; -1 without one. These bodies
/// turn for themselves alone, with an inertia of which no energy is seen (Body::inertia_of_states).
struct Feedback {
  enum class Source { measure, force, controller, nothing };
  /// A number to which u is added: of the law of an element, the size of a force, a torque, or the acceleration of a
  /// drive.
  struct Sets {
    TimeFunction::Of of = TimeFunction::Of::element;
    int item = 0;      ///< index into Scene::elements, forces, torques or drives
    int number = 0;    ///< of an element index into the numbers of its law
    std::string path;  ///< of the number, "damper.NAME.coefficient"
  };

  Measure reads;                    ///< where that is its source
  Source source = Source::measure;  ///< of y
  int reads_from = -1;              ///< the element whose output it reads, where that is its source
  int reads_force = -1;             ///< the element whose force it reads, where that is its source
  /// The joint whose force it reads, the one on the body of its second point, and along which axis of the world: 0 for
  /// x, 1 for y; or the drive.
  int reads_joint = -1, along = 0, reads_drive = -1;
  int follows = -1;  ///< the element whose output is added to its reference, or -1
  bool acts = true;  ///< on the measure of its element; else it gives a signal, or sets a number
  std::optional<Sets> sets{};
  Dimension signal{}, output{};  ///< of y and u
  int integral = -1, filter = -1;
  std::array<int, 3> held{-1, -1, -1};  ///< u, s', and the input of the filter or transfer function
  int course = -1;  ///< its angle is by what u has moved the drive that it sets, SI, its rate how fast

  /// Whether what it reads follows from accelerations.
  bool reads_reaction() const { return reads_joint >= 0 || reads_drive >= 0; }
  bool sets_number_of(int element) const {
    return sets && sets->of == TimeFunction::Of::element && sets->item == element;
  }
  bool sets_drive(int drive) const { return sets && sets->of == TimeFunction::Of::drive && sets->item == drive; }

  /// All bodies that are states.
  std::vector<int> states() const {
    std::vector<int> out;
    for (const int body : {integral, filter, held[0], held[1], held[2], course}) {
      if (body >= 0) out.push_back(body);
    }
    return out;
  }
};

/// A force element: a law on a measure. The torsion spring of a scene file is a linear spring on an angle.
struct Element {
  std::string table;  ///< its table in the scene file, "spring"
  std::string name;
  Measure on;
  Law law;
  int line = 0;
  std::optional<Feedback> feedback{};  ///< of a controller

  /// "torsion spring", for messages.
  std::string family() const;
};

/// Force at a point, N, or distributed evenly over the straight line between two points of a body, N/m. A dead load
/// keeps its direction in the world; a follower force keeps its direction in the frame of the body `follows` and has no
/// potential.
///
/// A force that is given by its vector has the direction of that, and none where it is zero. One that is given by a
/// direction and a size has this direction at every size, 0 and negative ones too.
struct Force {
  std::string name;
  PointRef at;
  Vec2 vector{};
  int follows = -1;  ///< body, or -1 for a dead load
  int line = 0;
  std::optional<PointRef> to{};  ///< of a distributed force: the end of the line that begins at `at`, of the same body
  /// The direction, a unit vector, of a force that is given by it and a size, which `vector` is the product of; zero of
  /// another.
  Vec2 along{};

  bool has_direction_of_its_own() const { return !(along == Vec2{}); }
  /// What the force is along, of any length; zero where it has no direction.
  const Vec2& line_of_action() const { return has_direction_of_its_own() ? along : vector; }
  /// A unit vector along it, or zero.
  Vec2 unit_or_zero() const {
    const double length = norm(vector);
    return has_direction_of_its_own() ? along : length > 0.0 ? (1 / length) * vector : Vec2{};
  }
  /// The force along that direction: |vector|, with a sign where the direction is its own.
  double size() const { return has_direction_of_its_own() ? dot(vector, along) : norm(vector); }

  /// Calls visit(point) for the points at which equal forces are equivalent to it on a rigid body: `at`, or both ends
  /// of its line.
  template <class Visit>
  void for_each_point(Visit visit) const {
    visit(at);
    if (to) visit(*to);
  }

  static const std::array<Number, 1> concentrated, distributed, concentrated_along, distributed_along;
  std::span<const Number> numbers() const {
    if (has_direction_of_its_own()) return to ? distributed_along : concentrated_along;
    return to ? distributed : concentrated;
  }
};

/// The size along the force's direction, of this dimension.
constexpr Number size_of_force(Dimension dimension, Range range) {
  Number number{"", dimension, range};
  number.get = [](const void* item) { return std::optional<double>(static_cast<const Force*>(item)->size()); };
  number.set = [](void* item, double value) {
    Force& force = *static_cast<Force*>(item);
    Vec2& F = force.vector;
    if (force.has_direction_of_its_own()) {
      F = value * force.along;
      return;
    }
    const double magnitude = norm(F);
    if (magnitude == 0.0) {
      throw InputError("expected a force with a direction, its vector is [0, 0]; give it a direction and a size");
    }
    F = {F.x / magnitude * value, F.y / magnitude * value};
  };
  number.scale = [](void* item, double factor) {
    Vec2& F = static_cast<Force*>(item)->vector;
    F = factor * F;
  };
  return number;
}
inline constexpr std::array<Number, 1> Force::concentrated{size_of_force(dimension::force, Range::not_negative)};
inline constexpr std::array<Number, 1> Force::distributed{
    size_of_force(dimension::force * dimension::length.power(-1), Range::not_negative)};
inline constexpr std::array<Number, 1> Force::concentrated_along{size_of_force(dimension::force, Range::finite)};
inline constexpr std::array<Number, 1> Force::distributed_along{
    size_of_force(dimension::force * dimension::length.power(-1), Range::finite)};

/// Torque on a body from the ground, N m, counter-clockwise positive.
struct Torque {
  std::string name;
  int body = 0;
  double value = 0.0;
  int line = 0;
  int point = -1;  ///< of the body, where it enters, or -1 where the scene does not say; only inside the body it counts

  static const std::array<Number, 1> numbers;
};

inline constexpr std::array<Number, 1> Torque::numbers{plain_number<&Torque::value>("", dimension::torque)};

/// Initial guesses for loop closing and solvers; absent guesses are zero. Angles are absolute and unwrapped, in rad;
/// travels in m; positions (of a body's origin in the world, m) are used only for bodies connected to the ground by no
/// chain of joints, or by bars only.
struct Start {
  std::vector<std::optional<double>> angle;   ///< per body
  std::vector<std::optional<double>> travel;  ///< per joint
  std::vector<std::optional<Vec2>> position;  ///< per body
};

/// A number of the table [numbers], which expressions refer to: without a unit, used as it is written.
struct SceneNumber {
  std::string name;
  double value = 0.0;
  int line = 0;

  static const std::array<Number, 1> numbers;
};

inline constexpr std::array<Number, 1> SceneNumber::numbers{plain_number<&SceneNumber::value>("", dimension::none)};

/// A quantity that the table [outputs] gives a name: an expression of the names of docs/quantities.md, as it is
/// written.
struct SceneOutput {
  std::string name;
  std::string text;
  int line = 0;
};

struct DependentNumber;

/// A planar mechanism as declared in a scene file. All values SI.
struct Scene {
  std::string file;  ///< for messages
  std::string title;
  std::string source;
  Units units;
  Vec2 gravity{};  ///< m/s^2
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Element> elements;
  std::vector<Drive> drives;
  std::vector<Force> forces;
  std::vector<Torque> torques;
  std::vector<TimeFunction> time_functions;  ///< at most one of each load and drive
  std::vector<HeldLoad> held_loads;          ///< of the scene at one time, at_time()
  std::vector<Stop> stops;
  std::vector<Blade> blades;
  std::vector<FlexibleLink> flexible_links;
  Start start;
  std::vector<SceneNumber> named_values;
  std::vector<SceneOutput> outputs;
  /// Numbers that follow from the named ones: first those that have names themselves, each behind those that it uses,
  /// then the rows of the parameter table in its order, then components without a row. Null where there are none.
  std::shared_ptr<const std::vector<DependentNumber>> dependents;
  Scales measured_in{};  ///< units of all numbers but the named ones, where scale() has changed them

  /// A scene with the ground only.
  Scene();
  // Copies and moves of all items are long: compiled once, in scene.cpp.
  Scene(const Scene&);
  Scene(Scene&&) noexcept;
  Scene& operator=(const Scene&);
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  /// For building a scene in code. Each returns the index of the new item and extends the start guesses.
  int add_body(std::string name);
  PointRef add_point(int body, std::string name, Vec2 at);
  int add_joint(Joint joint);

  /// Coordinates of a point in its body's frame, m.
  const Vec2& local(PointRef p) const { return bodies[p.body].points[p.point].at; }
  /// "crank.B".
  std::string name_of(PointRef p) const;
  /// What acts at each of the points of Force::for_each_point(), over Force::vector, in the scalar T: 1, or half the
  /// length of the line, m.
  template <class T>
  T share_at_points(const Force& force) const {
    if (!force.to) return T(1);
    return norm(planar_cast<T>(local(*force.to)) - planar_cast<T>(local(force.at))) / T(2);
  }
  /// Magnitude of the resultant of a force, N.
  double size_of(const Force& force) const {
    return (force.to ? 2.0 : 1.0) * share_at_points<double>(force) * norm(force.vector);
  }

  static const std::array<Number, 2> numbers;
};

inline constexpr std::array<Number, 2> Scene::numbers{
    component_number<&Scene::gravity, 0>("x", dimension::acceleration),
    component_number<&Scene::gravity, 1>("y", dimension::acceleration)};

/// Reads a scene file (TOML; grammar in docs/scene-files.md), converts to SI and checks it.
/// Throws InputError naming file, line, item, what was expected and the nearest valid name.
Scene read_scene(const std::filesystem::path& file);

/// The same from a text; `name` replaces the file name in messages.
Scene parse_scene(std::string_view text, const std::string& name);

/// Sets one number of the scene, given in the scene's own units, by its path:
///   numbers.NAME          of the table [numbers]; all numbers that are expressions of it follow
///   load.NAME             magnitude of force NAME along its direction, per length of a distributed one, or the torque
///                         NAME
///   gravity.x | y
///   point.BODY.POINT.x | y   in the body's frame; BODY may be ground
///   body.NAME.mass | inertia | center.x | center.y
///   body.NAME.section.area | second_moment | modulus | height | left
///   TABLE.NAME.NUMBER     of a force element: spring.NAME.stiffness, friction.NAME.torque, ...; declared with
///                         each law in model/laws/
///   drive.NAME.start | rate | acceleration | amplitude | frequency | phase
///   load.NAME.time.NUMBER | drive.NAME.time.NUMBER
///                         of a function of time: amplitude, frequency, ...; declared in model/time_function.hpp
///   bar.NAME.length,  slide.NAME.angle,  weld.NAME.angle
///   stop.NAME.min | max
///   blade.NAME.angle
///   start.NAME            guess for the angle of a body or the travel of a joint
///   start.NAME.x | y      guess for the position of a body
/// Throws InputError naming the nearest valid path, and for a number that is written as an expression; the scene is
/// then unchanged. Takes some 10 ns per number that the scene holds.
void set_value(Scene& scene, std::string_view path, double value);

/// The number that set_value sets, in the scene's own units: get_value(set_value(x)) = x. An absent limit of a stop is
/// infinite, an absent guess 0; an absent start of a drive is not known yet and throws InputError, and so does a path
/// that set_value does not accept.
double get_value(const Scene& scene, std::string_view path);

/// SI value of one unit of that number: the scene holds get_value(scene, path) value_unit(scene, path).
double value_unit(const Scene& scene, std::string_view path);

}  // namespace poise

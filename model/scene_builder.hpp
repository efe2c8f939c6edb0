#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// A measure by the names of what it is taken between; see Measure for what each is. measures::distance(...) and the
/// others make one.
struct MeasureByName {
  struct Term;

  std::string key;  ///< of a scene file: "bodies", "points", "slide", "x", "y", "sum"; empty for none
  std::vector<std::string> names;
  std::vector<Term> terms;  ///< of a sum
};

struct MeasureByName::Term {
  double factor = 1.0;
  MeasureByName measure;
};

namespace measures {
/// angle(body_b) - angle(body_a), counter-clockwise positive, not wrapped; one of them may be "ground".
MeasureByName angle(std::string body_a, std::string body_b);
/// Distance of two points "BODY.POINT" of different bodies.
MeasureByName distance(std::string a, std::string b);
/// Travel of a slide or pin in a slot: signed distance from its first point to its second along its axis.
MeasureByName travel(std::string joint);
/// World coordinate of a point "BODY.POINT".
MeasureByName x(std::string point);
MeasureByName y(std::string point);
/// Sum of factor times measure: measures::sum({{2, measures::travel("guide")}, {1, measures::x("arm.B")}}).
MeasureByName sum(std::vector<MeasureByName::Term> terms);
/// No measure: of a controller that acts on nothing.
MeasureByName nothing();
}  // namespace measures

/// Builds a scene in code, as docs/scene-files.md describes scene files: the same items, keys, units, defaults and
/// checks, for build() hands all of it to the reader of scene files.
///
///   SceneBuilder builder("press", {.length = "mm", .angle = "deg"});
///   builder.gravity({0, -9810})
///       .ground_point("O", {0, 0})
///       .body("crank", {.points = {{"O", {0, 0}}, {"B", {120, 0}}}, .mass = 0.4, .center = {60, 0}})
///       .pin("ground.O", "crank.O")
///       .element("spring", "return", measures::angle("ground", "crank"), {{"stiffness", 20}, {"free_angle", 90}})
///       .start("crank", 40);
///   const Scene scene = builder.build();
///
/// Points are named "BODY.POINT", those of the ground "ground.POINT". Items may refer to what is added later. An empty
/// name stands for the default: "a.P-b.Q" of a joint, the kind and a number of anything else ("spring 1").
class SceneBuilder {
 public:
  /// Begins a scene of that title, which is also what messages begin with. All numbers are in these units and those
  /// that follow from them (docs/scene-files.md#units), time in seconds; SI where none are given.
  explicit SceneBuilder(std::string title, const UnitNames& units = {});
  ~SceneBuilder();
  SceneBuilder(SceneBuilder&&) noexcept;
  SceneBuilder& operator=(SceneBuilder&&) noexcept;

  struct BodyData {
    std::vector<std::pair<std::string, Vec2>> points = {};  ///< in the body's own frame
    double mass = 0.0;
    Vec2 center{};         ///< centre of mass in the body's frame
    double inertia = 0.0;  ///< about the centre of mass
  };

  /// A key of a table of a scene file with its number, its word, which for a number is an expression, its flag, its two
  /// numbers (Vec2{0, 3}), its words, its numbers (std::vector<double>), its pairs of numbers, or the keys of each
  /// table of a list (Tables). A key of a table in that table has all names: {"gas.preload", 300},
  /// {"force.curve", {{0, 0}, {10, 40}}}, {"time.function", "sin(3*t)"}, {"reads.slide", "rail"}; behind "numbers." of
  /// a part the rest is one key.
  struct Key {
    Key(std::string key, double number) : name(std::move(key)), value(number) {}
    Key(std::string key, std::string word) : name(std::move(key)), value(std::move(word)) {}
    Key(std::string key, const char* word) : Key(std::move(key), std::string(word)) {}
    Key(std::string key, std::same_as<bool> auto flag) : name(std::move(key)), value(flag) {}
    Key(std::string key, std::same_as<Vec2> auto pair) : name(std::move(key)), value(pair) {}
    Key(std::string key, std::same_as<std::vector<std::string>> auto words)
        : name(std::move(key)), value(std::move(words)) {}
    Key(std::string key, std::same_as<std::vector<double>> auto numbers)
        : name(std::move(key)), value(std::move(numbers)) {}
    Key(std::string key, std::vector<Vec2> pairs) : name(std::move(key)), value(std::move(pairs)) {}
    using Tables = std::vector<std::vector<Key>>;
    Key(std::string key, std::same_as<Tables> auto tables) : name(std::move(key)), value(std::move(tables)) {}

    std::string name;
    std::variant<double, std::string, bool, std::vector<Vec2>, Vec2, std::vector<std::string>, std::vector<double>,
                 Tables>
        value;
  };

  /// A part of the law of a cam: up to the angle `to`, at which the lift is this share, or that of the part before.
  struct CamPart {
    double to = 0.0;
    std::string law;  ///< "dwell", "harmonic", "cycloidal", "polynomial_345"
    std::optional<double> lift = {};
  };

  /// What a rope touches: a point, or a pulley of a radius around it, round which the rope turns "clockwise" or
  /// "counterclockwise".
  struct RopePoint {
    RopePoint(std::string point) : at(std::move(point)) {}
    RopePoint(const char* point) : at(point) {}
    RopePoint(std::string pulley, double around, std::string way)
        : at(std::move(pulley)), radius(around), turn(std::move(way)) {}

    std::string at;
    double radius = 0.0;
    std::string turn{};  ///< empty of a point
  };

  SceneBuilder& source(std::string text);  ///< where the data come from
  /// A number that expressions refer to, or one that is such an expression itself (docs/scene-files.md#expressions).
  SceneBuilder& number(const std::string& name, double value);
  SceneBuilder& number(const std::string& name, const std::string& expression);
  /// The acceleration of gravity.
  SceneBuilder& gravity(Vec2 acceleration);
  /// The place of the fixed frame along "x" or "y" as a function of time: {{"function", "0.1*sin(3*t)"}}; with the key
  /// "as" its velocity or acceleration.
  SceneBuilder& frame(const std::string& axis, const std::vector<Key>& keys);
  /// A point of the ground.
  SceneBuilder& ground_point(const std::string& name, Vec2 at);
  /// A body with its points, mass and inertia.
  SceneBuilder& body(const std::string& name, const BodyData& data);
  /// The section of a body that was added before, with its "area", "second_moment", "modulus", "height", "left" and
  /// "profile", and the points of its line in order; both points of a body that has two where none are given.
  SceneBuilder& section(const std::string& body, const std::vector<Key>& keys,
                        const std::vector<std::string>& line = {});

  /// The items of a scene file, under the name of the part (docs/scene-files.md#parts): "at", "angle", "mirror",
  /// "scale", "on", "repeat", "step", "turn", the points of "join" and "join_next", and "numbers". The file counts from
  /// the current folder: part("strut.toml", {{"at", Vec2{2, 0}}, {"join.A", "rod.B"}, {"numbers.k", 80}}, "right").
  SceneBuilder& part(const std::string& file, const std::vector<Key>& keys = {}, const std::string& name = {});

  /// A pin of two points of different bodies, as of all joints; see Joint.
  SceneBuilder& pin(const std::string& a, const std::string& b, const std::string& name = {});
  /// A slide along an axis that is fixed in the first body, of which only the direction counts. angle: what
  /// angle(second body) - angle(first body) stays.
  SceneBuilder& slide(const std::string& a, const std::string& b, Vec2 axis, const std::string& name = {},
                      double angle = 0.0);
  /// A pin, the second point, in a straight slot of the first body through the first point, along the axis.
  SceneBuilder& pin_in_slot(const std::string& a, const std::string& b, Vec2 axis, const std::string& name = {});
  /// Two bodies that are one: the points coincide, and the angle between the bodies stays.
  SceneBuilder& weld(const std::string& a, const std::string& b, double angle = 0.0, const std::string& name = {});
  /// A distance of two points that stays.
  SceneBuilder& bar(const std::string& a, const std::string& b, double length, const std::string& name = {});

  /// Friction of the joint that was added last: "coefficient", "radius" and "torque" of a pin, "coefficient", "length"
  /// and "force" of a slide, "coefficient" and "force" of a pin in a slot (JointFriction).
  SceneBuilder& friction(const std::vector<Key>& keys);

  /// A force element with the numbers (and words) of its table in docs/scene-files.md#force-elements: "spring",
  /// "torsion_spring", "cubic_spring", "constant_force", "damper", "torsion_damper", "friction",
  /// "bump_stop", "motor".
  SceneBuilder& element(const std::string& table, const std::string& name, const MeasureByName& on,
                        const std::vector<Key>& keys);
  /// A drive with its "start", "rate", "acceleration", "amplitude", "frequency", "phase".
  SceneBuilder& drive(const std::string& name, const MeasureByName& on, const std::vector<Key>& keys = {});
  /// A stop with its "min", "max" or both; "stiffness", "damping" and "exponent" of one that yields.
  SceneBuilder& stop(const std::string& name, const MeasureByName& on, const std::vector<Key>& keys);

  /// A blade under a point, with its "angle" in the body of the point, and the body "on" which it stands.
  SceneBuilder& blade(const std::string& at, const std::vector<Key>& keys = {}, const std::string& name = {});

  /// Gears on two bodies. docs/gears-cams-ropes.md, docs/curved-slots.md and docs/rolling-profiles.md describe the
  /// tables of this and all that follow up to profiles; `keys` are the keys of these that are not named here:
  /// {{"ratio", 2}, {"carrier", "arm"}, {"internal", true}}.
  SceneBuilder& gear(const std::string& a, const std::string& b, const std::vector<Key>& keys,
                     const std::string& name = {});
  /// A belt round two bodies: "ratio", "crossed", ...
  SceneBuilder& belt(const std::string& a, const std::string& b, const std::vector<Key>& keys,
                     const std::string& name = {});
  /// A Geneva drive of a crank and a wheel: "slots", ...
  SceneBuilder& geneva(const std::string& crank, const std::string& wheel, const std::vector<Key>& keys,
                       const std::string& name = {});
  /// A rack, which is a slide, and its pinion, a body: "radius", ...
  SceneBuilder& rack(const std::string& slide, const std::string& pinion, const std::vector<Key>& keys,
                     const std::string& name = {});
  /// measures::sum(...) held at its "value".
  SceneBuilder& coupling(const MeasureByName& sum, const std::vector<Key>& keys = {}, const std::string& name = {});
  /// The angle of the cam is that of body b from body a; the profile is this law, or a key "curve" where it has no
  /// parts.
  SceneBuilder& cam(const std::string& a, const std::string& b, const MeasureByName& follower,
                    const std::vector<CamPart>& law, const std::vector<Key>& keys, const std::string& name = {});
  /// A rope over points and pulleys: "length", or "stiffness" and "free_length".
  SceneBuilder& rope(const std::vector<RopePoint>& over, const std::vector<Key>& keys, const std::string& name = {});
  /// A chain round two sprockets: "radius_a", "radius_b", "turn", ...
  SceneBuilder& chain(const std::string& a, const std::string& b, const std::vector<Key>& keys,
                      const std::string& name = {});
  /// A point of a body that touches a way through points of another, on the left of it: a segment of two points, or an
  /// outline of more; "radius" of a circle around it, "closed".
  SceneBuilder& contact(const std::string& point, const std::vector<std::string>& way,
                        const std::vector<Key>& keys = {}, const std::string& name = {});
  /// The same of an arc, clockwise around its center, or counter-clockwise with the contact inside (`hollow`).
  SceneBuilder& contact_with_arc(const std::string& point, const std::string& center, const std::string& from,
                                 const std::string& to, bool hollow = false, const std::vector<Key>& keys = {},
                                 const std::string& name = {});
  /// Outlines of two bodies that touch each other, with the contact on the left of both: "closed" of the first,
  /// "against_closed" of the other.
  SceneBuilder& contact_of_outlines(const std::vector<std::string>& outline, const std::vector<std::string>& against,
                                    const std::vector<Key>& keys = {}, const std::string& name = {});
  /// A pin in a hole that is wider than it, and one in a slot along an axis of the body of point a: "clearance".
  SceneBuilder& loose_pin(const std::string& a, const std::string& b, const std::vector<Key>& keys,
                          const std::string& name = {});
  SceneBuilder& loose_slot(const std::string& a, const std::string& b, Vec2 axis, const std::vector<Key>& keys,
                           const std::string& name = {});
  /// A pin in a slot of a circle: "radius", "from", "to".
  SceneBuilder& circular_slot(const std::string& pin, const std::string& center, const std::vector<Key>& keys,
                              const std::string& name = {});
  /// A pin in a slot along a curve, which is fixed in the body of the point `at`: "closed", ...
  SceneBuilder& curved_slot(const std::string& pin, const std::string& at, const std::vector<Vec2>& curve,
                            const std::vector<Key>& keys = {}, const std::string& name = {});
  /// A wheel that rolls on a line: "radius", ...
  SceneBuilder& rolling(const std::string& wheel, const std::string& line, Vec2 axis, const std::vector<Key>& keys,
                        const std::string& name = {});
  /// A wheel that rolls on a circle: "radius", "circle_radius", "inside", ...
  SceneBuilder& rolling_on_circle(const std::string& wheel, const std::string& center, const std::vector<Key>& keys,
                                  const std::string& name = {});
  /// A curve, fixed in the body of the point `at`, that rolls on a line.
  SceneBuilder& rolling_profile(const std::string& at, const std::vector<Vec2>& curve, const std::string& line,
                                Vec2 axis, const std::vector<Key>& keys = {}, const std::string& name = {});
  /// A curve, fixed in the body of the point `at`, that rolls on a circle: "circle_radius", ...
  SceneBuilder& rolling_profile_on_circle(const std::string& at, const std::vector<Vec2>& curve,
                                          const std::string& center, const std::vector<Key>& keys,
                                          const std::string& name = {});
  /// Convex curves, each fixed in the body of its point, that stay outside of one another: "radius", "restitution".
  SceneBuilder& curve_contact(const std::string& at, const std::vector<Vec2>& curve, const std::string& against,
                              const std::vector<Vec2>& against_curve, const std::vector<Key>& keys = {},
                              const std::string& name = {});

  /// A force at a point, which keeps its direction in the world, or in the body that it `follows`.
  SceneBuilder& force(const std::string& name, const std::string& at, Vec2 vector, const std::string& follows = {});
  /// One that has its direction at every size, 0 too.
  SceneBuilder& force_along(const std::string& name, const std::string& at, Vec2 direction, double size,
                            const std::string& follows = {});
  /// A force per length on the straight line between two points of one body.
  SceneBuilder& distributed_load(const std::string& name, const std::string& a, const std::string& b, Vec2 vector,
                                 const std::string& follows = {});
  /// One that has its direction at every size, 0 too.
  SceneBuilder& distributed_load_along(const std::string& name, const std::string& a, const std::string& b,
                                       Vec2 direction, double size, const std::string& follows = {});
  /// A torque on a body from the ground, counter-clockwise positive.
  SceneBuilder& torque(const std::string& name, const std::string& body, double value);

  /// Guess for the absolute angle of a body, or for the travel of a joint.
  SceneBuilder& start(const std::string& name, double value);
  /// Guess for the place of a body's origin in the world.
  SceneBuilder& start_position(const std::string& body, Vec2 at);

  /// A quantity with a name of its own, an expression of the names of docs/quantities.md.
  SceneBuilder& output(const std::string& name, const std::string& quantity);

  /// The scene, in SI. Throws InputError in the words in which the file reader does, with the title instead of file and
  /// line: `press: spring "return".points: expected a point of "crank", found "crank.C"; did you mean "crank.O"?`.
  /// A name that a body, a point or a guess has already is refused when the second one is added.
  Scene build() const;

  /// Writes all this as a scene file, in the order in which it was added. Its read_scene() is the scene of build(), to
  /// the last bit. Items are not checked.
  std::string text() const;

 private:
  struct Document;
  std::unique_ptr<Document> document_;
};

}  // namespace poise

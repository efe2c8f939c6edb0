#pragma once

// What can be asked of a mechanism at rest: docs/quantities.md has the grammar of the names.

#include <string>
#include <vector>

#include "model/dimension.hpp"
#include "model/measure.hpp"
#include "model/scene.hpp"

namespace poise {

/// Something that depends on the pose of a mechanism at rest, the forces in it and the numbers of its scene.
struct SoughtQuantity {
  enum class Kind {
    measure,        ///< of the pose
    element_force,  ///< T of a force element, positive where it tends to reduce its measure
    element_rate,   ///< dT/dm of a force element by the measure m that it acts on: the stiffness that is felt
    drive_force,    ///< with which what drives the measure `on` holds a driven position, positive where it tends to
                    ///< increase it
    reaction,       ///< of a joint, on the body of its second point
    stop_reaction,  ///< with which a stop pushes, >= 0
    blade_force,    ///< of a motion: across the edge of a blade, to its left, on the body of its point
    shaking,        ///< what the mechanism exerts on the ground, its moment about the origin of the world
    energy,
    kinetic_energy,  ///< of a motion
    center,          ///< x or y in the world of the instant centre of body `item` relative to body `other`
    transmission,  ///< angle between the line `on` and the normal of the motion of body `item` at the end of that line
    push,          ///< force at `point` along `direction` that holds the pose, in place of what drives it
    ratio,         ///< d(first)/d(second) along the one motion that the joints allow: of measures, the energy, forces
                   ///< of elements and expressions of these
    by_time,       ///< d(A)/dt of a motion, of one part
    stress,        ///< largest size of the stress in link `item`, which others find (RestingPlace::other)
    link_load,     ///< internal load of link `item` at the place of its line next to `point`: likewise
    frequency,     ///< of vibration mode `item`, Hz, and its damping ratio: likewise
    damping,
    load_at_fold,  ///< value of a load at the first fold of the path on which it grows
    maximum,       ///< of one quantity over a branch of a path, and so on
    minimum,
    mean,
    span,
    work,    ///< of a force over the path of its point, or its measure
    number,  ///< `constant`
    sum,     ///< of two, and so on
    difference,
    product,
    quotient
  };
  /// A part belongs to a reaction, a shaking force or a load inside of a link; axial is the tension.
  enum class Part { size, x, y, moment, axial, shear };

  std::string name;
  Kind kind = Kind::measure;
  Part part = Part::size;
  Measure on{};
  int item = -1;     ///< index of Scene::elements, joints, stops, blades, bodies or flexible_links; of a mode, from 0
  int other = -1;    ///< index of Scene::bodies
  PointRef point{};  ///< where a push acts, or a link is cut
  Vec2 direction{1.0, 0.0};  ///< of a push in the world, a unit vector
  std::string load{};        ///< of a load at a fold: its path, "load.P"
  Dimension dimension{};
  double constant = 0.0;
  std::vector<SoughtQuantity> of{};  ///< those that it is made of: one over a path or by time, else two
  bool is_output = false;            ///< the scene gives it this name: Scene::outputs

  /// What links have inside: a kind that others find.
  bool is_in_link() const { return kind == Kind::stress || kind == Kind::link_load; }
  /// Some part of it is of this kind.
  bool has(Kind wanted) const;
  /// It belongs to a path, not to a position.
  bool is_over_path() const;
};

/// What a quantity is asked of: a mechanism at rest, or one that moves.
enum class AskedOf { rest, motion };

/// Whether two measures are of the same bodies, points and joints, whatever the numbers in them.
bool is_same(const Measure& a, const Measure& b);

/// A scene by whose names quantities of positions are found that these drives hold: they are drives of it too, in place
/// of those with their names.
Scene naming_drives(Scene scene, const std::vector<Drive>& drives);

/// The quantity so called:
///   angle.BODY, angle.BODY.OTHER, travel.JOINT, x.BODY.POINT, y.BODY.POINT, along.BODY.POINT.DEGREES, length.ELEMENT
///                         measures (model/named_measures.hpp)
///   force.ELEMENT, rate.ELEMENT
///   force.DRIVE           of a drive of the scene, in a position that it holds; force.drive where all drive one
///                         measure
///   reaction.JOINT        size of the force, of a bar its tension; reaction.JOINT.x, .y, .moment, .axial, .size
///   stop.NAME             with which a stop pushes
///   shaking.x, .y, .size, .moment
///   push.BODY.POINT.DIRECTION   DIRECTION is x, y or an angle in degrees from x
///   energy
///   center.A.B.x, .y      instant centre of body A relative to body B
///   transmission.LINK.JOINT, transmission.BAR.BODY
///   stress.LINK           of a link with a section
///   normal.LINK.POINT, shear.LINK.POINT, moment.LINK.POINT   of a rigid one (statics/equilibrium/link_loads.hpp)
///   mode.N.frequency, mode.N.damping
///   fold.load.LOAD        the value of load LOAD at the first fold, from the settled equilibrium with growing size
///   NAME                  an output of the scene
///   d(A)/d(B)             of measures, energy, force.ELEMENT, and expressions of these
///   max(Q), min(Q), mean(Q), span(Q)   over a branch of a path
///   work(Q)               of a force: integral of Q over the path of its point, or its measure
/// or numbers and these with + - * / and parentheses. BODY, JOINT, BODY.POINT.x, BODY.POINT.y, ELEMENT and
/// load_at_fold.LOAD are read too: the quantity has the name above. Throws InputError with the nearest names where
/// there is none, where units do not fit, and where an output of the scene is none.
///
/// Of a motion also  energy.kinetic,  d(A)/dt  with any quantity A,  and force.ELEMENT of all elements.
SoughtQuantity find_quantity(const Scene& scene, const std::string& name, AskedOf asked_of = AskedOf::rest);

/// The outputs of a scene, in their order. Throws InputError with file and line where one is no quantity, has the name
/// of another, or uses one that is not above it.
std::vector<SoughtQuantity> outputs_of(const Scene& scene, AskedOf asked_of = AskedOf::rest);

/// The quantities of a scene that are not made of others, in the order of the rows above; of pushes those along x and
/// y, of instant centres those relative to the ground, no measures of families that have too many members for a list.
std::vector<SoughtQuantity> all_quantities(const Scene& scene, AskedOf asked_of = AskedOf::rest);
/// Their names.
std::vector<std::string> quantity_names(const Scene& scene, AskedOf asked_of = AskedOf::rest);

}  // namespace poise

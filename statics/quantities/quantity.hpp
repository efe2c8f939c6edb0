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
    reaction,       ///< of a joint, on the body of its second point
    stop_reaction,  ///< with which a stop pushes, >= 0
    energy,
    push,          ///< force at `point` along `direction` that holds the pose, in place of what drives it
    ratio,         ///< d(first)/d(second) of two measures along the one motion that the joints allow
    load_at_fold,  ///< value of a load at the first fold of the path on which it grows
    number,        ///< `constant`
    sum,           ///< of two, and so on
    difference,
    product,
    quotient
  };
  enum class Part { size, x, y, moment, axial };  ///< of a reaction; axial: tension of a bar

  std::string name;
  Kind kind = Kind::measure;
  Part part = Part::size;
  Measure on{};
  int item = -1;             ///< index of Scene::elements, joints or stops
  PointRef point{};          ///< where a push acts
  Vec2 direction{1.0, 0.0};  ///< of a push in the world, a unit vector
  std::string load{};        ///< of a load at a fold: its path, "load.P"
  Dimension dimension{};
  double constant = 0.0;
  std::vector<SoughtQuantity> of{};  ///< two, of those that are made of others

  /// Some part of it is of this kind.
  bool has(Kind wanted) const;
};

/// The quantity so called:
///   angle.BODY, angle.BODY.OTHER, travel.JOINT, x.BODY.POINT, y.BODY.POINT, along.BODY.POINT.DEGREES, length.ELEMENT
///                         measures (model/named_measures.hpp)
///   force.ELEMENT
///   reaction.JOINT        size of the force, of a bar its tension; reaction.JOINT.x, .y, .moment, .axial, .size
///   stop.NAME             with which a stop pushes
///   push.BODY.POINT.DIRECTION   DIRECTION is x, y or an angle in degrees from x
///   energy
///   fold.load.LOAD        the value of load LOAD at the first fold, from the settled equilibrium with growing size
///   d(A)/d(B)             of two measures
/// or numbers and these with + - * / and parentheses. BODY, JOINT, BODY.POINT.x, BODY.POINT.y, ELEMENT and
/// load_at_fold.LOAD are read too: the quantity has the name above. Throws InputError with the nearest names where
/// there is none, and where units do not fit.
SoughtQuantity find_quantity(const Scene& scene, const std::string& name);

/// The names of a scene's quantities, in the order of the rows above; of pushes those along x and y, no ratios and no
/// expressions, no measures of families that have too many members for a list.
std::vector<std::string> quantity_names(const Scene& scene);

}  // namespace poise

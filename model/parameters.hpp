#pragma once

// The table of all numbers of a scene. Each is declared once, with the item it belongs to (Number); the table lists
// them for all items.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// The kind of item that a number of a scene belongs to.
enum class Owner {
  scene,
  number,
  force,
  torque,
  body,
  section,
  point,
  element,
  drive,
  joint,
  stop,
  coupling,
  blade,
  start,
  time  ///< a function of time
};

/// Whether the equilibrium depends on numbers of such an owner where the item acts: not on guesses, on drives, blades
/// and functions of time, which statics leaves out, nor on sections, which matter inside of rigid bodies only; those of
/// flexible links act through the stiffness of their springs.
constexpr bool counts_in_statics(Owner owner) {
  return owner != Owner::start && owner != Owner::drive && owner != Owner::section && owner != Owner::time &&
         owner != Owner::blade;
}

/// The owner of what a function of time is of; of a frame that of gravity.
constexpr Owner owner_of(TimeFunction::Of of) {
  switch (of) {
    case TimeFunction::Of::force:
      return Owner::force;
    case TimeFunction::Of::torque:
      return Owner::torque;
    case TimeFunction::Of::drive:
      return Owner::drive;
    case TimeFunction::Of::element:
      return Owner::element;
    case TimeFunction::Of::frame:
      break;
  }
  return Owner::scene;
}

/// The place of a number in the table, which is the same for all scenes of the same structure.
struct ParameterPlace {
  Owner owner = Owner::scene;
  int item = 0;    ///< index into the owner's list; of a coupling into the stops
  int part = 0;    ///< point: index into the body's points; start: 0 angle, 1 travel, 2 place; section: 0 of a body, 1
                   ///< of a flexible link
  int number = 0;  ///< index into the item's numbers

  friend bool operator==(const ParameterPlace&, const ParameterPlace&) = default;
};

/// Whether the springs of a flexible link follow from a number of its section: from its second moment and modulus.
constexpr bool moves_springs(const ParameterPlace& place) {
  return place.owner == Owner::section && place.part == 1 && (place.number == 1 || place.number == 2);
}

/// The path of a number, "kind.name.point.number"; parts that are empty are left out.
struct ParameterPath {
  std::array<std::string_view, 4> parts;

  std::string text() const;
  /// text() == path, without building the text. The path is not split, because names may contain dots.
  bool is(std::string_view path) const;
};

/// One row of the table.
struct ParameterRow {
  ParameterPath path;
  ParameterPlace place;
  Dimension dimension;
  Range range = Range::finite;
};

/// The table, row by row, in the order of the scene.
std::vector<ParameterRow> parameter_table(const Scene& scene);

/// The row of a path. If there is none the first is empty; the second throws InputError with the nearest path.
std::optional<ParameterRow> find_parameter(const Scene& scene, std::string_view path);
ParameterRow parameter(const Scene& scene, std::string_view path);

/// SI value of a number, empty if the scene gives none.
std::optional<double> value_at(const Scene& scene, const ParameterPlace& place);

/// Sets a number, SI, without checking its range; what follows from it too. Throws InputError if it contradicts the
/// item's other numbers, or where an expression of it has no value (follow_expressions()). A number that is written as
/// an expression differs from it until the next named number is set.
void set_value_at(Scene& scene, const ParameterPlace& place, double si);

/// The same mechanism measured in `scales`: every number times Dimension::per_scale, which is exact. Lengths become
/// lengths / length, forces / force, stiffness * length / force, torques and torsional stiffness / energy; masses and
/// gravity so that weights come out in force and time stays in seconds. Angles are unchanged.
Scene scaled(const Scene& scene, const Scales& scales);
/// The same in place; scaling by the reciprocal scales undoes it.
void scale(Scene& scene, const Scales& scales);

}  // namespace poise

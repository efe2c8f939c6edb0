#pragma once

// The table of all numbers of a scene. Each is declared once, beside the item it belongs to (Number); here is where the
// items stand.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// What a number of a scene belongs to.
enum class Owner { scene, force, torque, body, point, element, drive, joint, stop, start };

/// A number of a scene: where it stands in the table, which is the same for all scenes of the same structure.
struct ParameterPlace {
  Owner owner = Owner::scene;
  int item = 0;    ///< index into the owner's list
  int part = 0;    ///< point: index into the body's points; start: 0 angle, 1 travel, 2 place
  int number = 0;  ///< index into the item's numbers

  friend bool operator==(const ParameterPlace&, const ParameterPlace&) = default;
};

/// The path of a number, "kind.name.point.number"; parts that are empty are left out.
struct ParameterPath {
  std::array<std::string_view, 4> parts;

  std::string text() const;
  /// text() == path, without making the text: names may hold dots, so the path is not taken apart.
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

/// The row of a path. The first is empty where there is none; the second throws InputError naming the nearest path.
std::optional<ParameterRow> find_parameter(const Scene& scene, std::string_view path);
ParameterRow parameter(const Scene& scene, std::string_view path);

/// SI value of a number, empty where the scene gives none.
std::optional<double> value_at(const Scene& scene, const ParameterPlace& place);

/// Sets a number, SI, whatever its range. Throws InputError where the item's other numbers forbid it.
void set_value_at(Scene& scene, const ParameterPlace& place, double si);

/// The same mechanism measured in `scales`: every number times Dimension::per_scale, which is exact. Lengths become
/// lengths / length, forces / force, stiffness * length / force, torques and torsional stiffness / energy; masses and
/// gravity so that weights come out in force and time stays in seconds. Angles are untouched.
Scene scaled(const Scene& scene, const Scales& scales);
/// The same in place; scaling by the reciprocal scales undoes it.
void scale(Scene& scene, const Scales& scales);

}  // namespace poise

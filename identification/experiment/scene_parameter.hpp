#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/parameters.hpp"
#include "motion/reduced_motion.hpp"

namespace poise {

/// A number of a scene that its motion depends on: all of parameter_table() but start guesses,
/// sections, and limits and coefficients that a stop does not have.
class SceneParameter {
 public:
  /// Empty where the scene has no such number, or motion does not depend on it.
  static std::optional<SceneParameter> find(const Scene& scene, std::string_view path);

  const std::string& path() const { return path_; }
  const ParameterPlace& place() const { return place_; }
  const Dimension& dimension() const { return dimension_; }
  /// SI value. set() checks no range: a lumped mass beside others may be negative; allows() says whether the mechanism
  /// exists: lengths that have to be > 0, and of a named number all expressions that follow from it have values.
  double get(const Scene& scene) const { return value_at(scene, place_).value_or(0.0); }
  /// A force of magnitude zero has no direction and is left unchanged.
  void set(Scene& scene, double si) const;
  bool allows(const Scene& scene, double si) const;
  /// Of a named number: the change over which some number that follows from it changes by its own size, or by the
  /// `length` of the mechanism, rad or one acceleration of 1 m/s^2 where it is geometric.
  double reach(const Scene& scene, double length) const;
  /// How the scaled scene's equations of motion change per SI unit of the number; `scene` in SI. Not of one that
  /// is_geometric(): its derivatives follow from a Variation.
  Influence influence(const Scene& scene, const Scales& scales) const;
  /// Of a named number: the numbers of drives, in the units of the scaled scene, and of functions of time that change
  /// with it, by the chain rule; `scene` in SI. Throws InputError where an expression has no derivative by it.
  std::vector<Influence::InTime> in_time(const Scene& scene, const Scales& scales) const;
  /// d(force of the element)/d(number), SI, at the measure g and its rate w; 0 where it belongs to something else.
  double force_by(const Scene& scene, int element, double g, double w) const;

  /// True for masses, inertias, stiffnesses, damping and loads: multiplying all of these by one factor changes no
  /// motion.
  bool scales_with_force() const { return dimension_.force + dimension_.mass != 0; }
  /// Number of a body's inertia.
  bool is_inertial() const { return place_.owner == Owner::body; }
  bool is_length() const { return dimension_.length == 1 && dimension_.force == 0 && dimension_.time == 0; }
  bool is_named() const { return place_.owner == Owner::number; }
  /// A number of a point, a joint or a coupling, on which the pose depends.
  static bool is_dimension(Owner owner) {
    return owner == Owner::point || owner == Owner::joint || owner == Owner::coupling;
  }
  bool is_dimension() const { return is_dimension(place_.owner) && !is_friction_; }
  /// Of the friction of a joint.
  bool is_friction() const { return is_friction_; }
  /// A limit of a stop, or a coefficient of its impacts.
  bool is_of_stop() const { return place_.owner == Owner::stop; }
  /// One whose derivatives follow from a Variation: one of these, gravity, a number of a joint's friction, the angle of
  /// a blade, or a named number, which may move all of them.
  bool is_geometric() const {
    return is_dimension() || is_friction_ || is_of_stop() || place_.owner == Owner::scene ||
           place_.owner == Owner::blade || is_named();
  }

 private:
  SceneParameter(const ParameterRow& row)
      : place_(row.place),
        dimension_(row.dimension),
        range_(row.range),
        path_(row.path.text()),
        is_friction_(row.place.owner == Owner::joint && row.path.parts[3].starts_with("friction.")) {}

  ParameterPlace place_;
  Dimension dimension_;
  Range range_;
  std::string path_;
  bool is_friction_ = false;
};

}  // namespace poise

#pragma once

// Which numbers a scene has, and where each stands in a flat array p.

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "model/couplings.hpp"
#include "model/dependent_number.hpp"
#include "model/expression_value.hpp"
#include "model/parameters.hpp"
#include "model/plain_value.hpp"
#include "model/scene.hpp"

namespace poise {

/// The numbers of a scene as an array p: the rows of parameter_table(), in the units of the scene; behind them the
/// numbers of bodies that come with curved slots and rolling wheels, and the components of forces and axes and the
/// factors of sums that are dependent numbers. Dependent numbers, and the springs of flexible links, which follow from
/// a section, stand in p like others: whoever changes p lets them follow().
class NumberList {
 public:
  explicit NumberList(const Scene& scene) : NumberList(scene, {}) {}
  /// With both components of these forces as numbers, in place of their magnitudes.
  NumberList(const Scene& scene, const std::vector<int>& vectors);

  const Scene& scene() const { return scene_; }
  const std::vector<ParameterRow>& rows() const { return rows_; }
  /// The index of the row of this place, which must be one of the table.
  int row(const ParameterPlace& place) const;
  /// p of the scene; infinite for an absent limit, 0 for an absent guess.
  const std::vector<double>& values() const { return values_; }

  /// Adds to dependent numbers by how much they follow the named ones from the scene's values to those of p, and
  /// multiplies the stiffnesses of the springs of flexible links by  E I  over that of the scene. Throws InputError
  /// where an expression has no value.
  void follow(std::vector<double>& p) const;
  /// Sets what follows from the named numbers where those that are no expressions have the values `named` and change at
  /// the rates `slopes` by as much as `step`, which is zero but for its derivatives:  a + a' step + a'' step^2 / 2,
  /// exact to second order. Then the springs of flexible links. What has no derivative is as if it did not change.
  /// Forces that follow have both components as numbers. Throws InputError as follow() does.
  template <class T>
  void follow_along(std::vector<double> named, const std::vector<double>& slopes, const T& step, T* p) const;
  /// The same where the named numbers that are no expressions have the values `named`, in a scalar that may enclose
  /// sets: sets all numbers that follow from them but the springs of flexible links. A load of a scene at one time
  /// follows with its factor as it is.
  template <class T>
  void follow_in(std::vector<T> named, T* p) const;
  /// Rows from which others follow: those of named numbers, and of the sections of flexible links.
  const std::vector<int>& leaders() const { return leaders_; }
  /// The derivatives of p by the number of such a row, along the expressions that follow from it: for each number that
  /// follows its place in p and the derivative. A number without a derivative, or without a place, is left out
  /// (why_not_followed()).
  std::vector<std::pair<int, double>> followers(int row, const std::vector<double>& p) const;
  /// Why some number that follows from that of a row has no derivative by it; empty where all have.
  std::string why_not_followed(int row) const;

  /// Places in p of the first number of each item.
  int gravity() const { return gravity_; }
  int point(PointRef point) const { return point_[at(point.body)][at(point.point)]; }
  int body(int body) const { return body_[at(body)]; }
  int force(int force) const { return force_[at(force)]; }
  int torque(int torque) const { return torque_[at(torque)]; }
  int element(int element) const { return element_[at(element)]; }
  int joint(int joint) const { return joint_[at(joint)]; }
  /// The stops of a coupling share the numbers of its first stop. A stop that a gas strut comes with has none.
  int stop(int stop) const { return stop_[at(stop)].first; }
  int blade(int blade) const { return blade_[at(blade)]; }

  /// Places in p of the components of a vector that are numbers of their own, or -1.
  struct Components {
    int x = -1, y = -1;
    bool are_whole = false;  ///< the vector is these, whatever its magnitude is
    bool vary() const { return x >= 0 || y >= 0; }
  };
  Components vector_of(int force) const { return vector_.empty() ? Components{} : vector_[at(force)]; }
  Components axis_of(int joint) const { return axis_.empty() ? Components{} : axis_[at(joint)]; }
  /// Unit vectors of the scene along a force, zero of a force of zero, and along the axis of a joint.
  const Vec2& along_force(int force) const { return along_force_[at(force)]; }
  const Vec2& along_axis(int joint) const { return along_axis_[at(joint)]; }

  /// The gas strut that a stop comes with, an index of Scene::elements, or -1 (strut_of()).
  int strut(int stop) const { return stop_[at(stop)].strut; }
  /// The kind of a coupling; null of a plain stop.
  const CouplingKind* coupling(int stop) const { return stop_[at(stop)].coupling; }
  /// The first stop of the coupling of which this is one.
  int first_row(int stop) const { return coupling(stop) == nullptr ? stop : stop - coupling(stop)->row; }
  /// Which numbers of a coupling, from its first stop, are points of its curve.
  const CurveNumbers& curve(int first) const { return stop_[at(first)].curve; }

 private:
  struct OfStop {
    int first = 0, strut = -1;
    const CouplingKind* coupling = nullptr;
    CurveNumbers curve{};
  };

  static constexpr int second_moment = 1, modulus = 2;  // of CrossSection::numbers

  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  void place_rows();
  void place_tracks();
  void place_vectors(const std::vector<int>& vectors);
  void place_dependents();
  int place_of_component(const DependentPlace& of, std::size_t item);
  void read_values();
  void follow_names(std::vector<double>& p) const;
  void add_springs_of(int row, double slope, const std::vector<double>& p,
                      std::vector<std::pair<int, double>>& out) const;

  Scene scene_;
  std::vector<ParameterRow> rows_;
  std::vector<double> values_;
  int gravity_ = 0;
  std::vector<std::vector<int>> point_;  // by body
  std::vector<int> body_, force_, torque_, element_, joint_, blade_;
  std::vector<int> section_;  // of each flexible link
  std::vector<OfStop> stop_;
  std::vector<Vec2> along_force_, along_axis_;
  std::vector<Components> vector_, axis_;  // empty where no component is a number of its own
  std::vector<int> dependent_;             // place in p of each dependent number, or -1
  std::vector<double> units_;              // in which p has it, over those of DependentNumber
  std::vector<double> followed_;           // values that follow from the scene's named numbers
  std::vector<int> leaders_;
};

template <class T>
void NumberList::follow_along(std::vector<double> named, const std::vector<double>& slopes, const T& step, T* p) const {
  if (!dependent_.empty()) {
    const std::vector<double> values = dependent_values(scene_, named, false);
    DependentDerivatives along;
    if constexpr (has_derivatives<T>) along = dependents_along(scene_, slopes, std::move(named));
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (dependent_[k] < 0) continue;
      T& number = p[dependent_[k]];
      number = T(units_[k] * values[k]);
      if constexpr (has_derivatives<T>) {
        if (std::isfinite(along.slopes[k])) number += T(units_[k] * along.slopes[k]) * step;
        if (std::isfinite(along.bends[k])) number += T(0.5 * units_[k] * along.bends[k]) * (step * step);
      }
    }
  }
  for (std::size_t l = 0; l < section_.size(); ++l) {
    const T* const now = p + section_[l];
    const double* const before = &values_[at(section_[l])];
    const T ratio = now[second_moment] * now[modulus] / T(before[second_moment] * before[modulus]);
    for (const int spring : scene_.flexible_links[l].springs) {
      p[element(spring)] = T(values_[at(element(spring))]) * ratio;
    }
  }
}

template <class T>
void NumberList::follow_in(std::vector<T> named, T* p) const {
  for (std::size_t k = 0; k < dependent_.size(); ++k) {
    const DependentNumber& one = (*scene_.dependents)[k];
    if (one.factor || one.at.of == DependentPlace::Of::left_out) continue;
    const T value = one.expression.template value_in<T>(named);
    if (one.at.place.owner == Owner::number) named[at(one.at.place.item)] = value;
    const double unit = one.dimension.unit(scene_.units) * one.dimension.per_scale(scene_.measured_in);
    if (dependent_[k] >= 0) p[dependent_[k]] = T(units_[k]) * T(unit) * value;
  }
}

}  // namespace poise

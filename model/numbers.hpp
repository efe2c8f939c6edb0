#pragma once

// The numbers of a scene as variables.

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "model/gas_struts.hpp"
#include "model/measures/sum.hpp"
#include "model/number_list.hpp"
#include "model/plain_value.hpp"
#include "model/rolling_profile.hpp"
#include "model/spline.hpp"

namespace poise {

/// A vector of a scene, with the components that are numbers of their own.
template <class T>
Planar<T> with_components(const Vec2& vector, const NumberList::Components& at, const T* p) {
  return {at.x >= 0 ? p[at.x] : T(vector.x), at.y >= 0 ? p[at.y] : T(vector.y)};
}

/// a / |a|, or zero of a zero vector.
template <class T>
Planar<T> unit_or_zero(const Planar<T>& a) {
  return choose(
      is_zero(a.x) && is_zero(a.y),
      [] {
        return Planar<T>{T(0), T(0)};
      },
      [&] { return T(T(1) / norm(a)) * a; });
}

/// The numbers of a scene in the scalar T: what bodies, joints, loads, elements and stops are, read from an array p
/// (NumberList). With p in dual numbers all that is computed from them has derivatives by the numbers; with p in balls
/// or intervals it holds for all scenes whose numbers are in these. SceneNumbers has the same functions.
///
/// Of sets of numbers a curve through points is known only where p has those of the scene; elsewhere its values are not
/// finite. In lanes (Pack) a curve that rolls is cut into the same parts for all, and unknown in all where it has a
/// cusp in one. Refers to the list and to p.
template <class T>
class Numbers {
 public:
  using Scalar = T;

  Numbers(const NumberList& list, const T* p) : list_(&list), p_(p) {}

  const Scene& scene() const { return list_->scene(); }

  /// Coordinates of a point in its body's frame.
  Planar<T> point(PointRef point) const { return vector_at(list_->point(point)); }
  const T& mass(int body) const { return p_[list_->body(body)]; }
  /// About its centre of mass.
  const T& inertia(int body) const { return p_[list_->body(body) + 1]; }
  Planar<T> center(int body) const { return vector_at(list_->body(body) + 2); }
  Planar<T> gravity() const { return vector_at(list_->gravity()); }
  /// Force::vector.
  Planar<T> force(int force) const {
    const NumberList::Components components = list_->vector_of(force);
    const Vec2& vector = scene().forces[static_cast<std::size_t>(force)].vector;
    if (components.are_whole) return with_components(vector, components, p_);
    return p_[list_->force(force)] * along_force(force);
  }
  /// A unit vector along it, zero where it has no direction.
  Planar<T> along_force(int force) const {
    const NumberList::Components components = list_->vector_of(force);
    const Force& of = scene().forces[static_cast<std::size_t>(force)];
    return components.vary() ? unit_or_zero(with_components(of.vector, components, p_))
                             : constant(list_->along_force(force), of.line_of_action());
  }
  const T& torque(int torque) const { return p_[list_->torque(torque)]; }

  /// The length that a joint keeps, of another one the angle.
  const T& kept_by(int joint) const { return p_[list_->joint(joint)]; }
  /// Joint::direction().
  Planar<T> axis(int joint) const {
    const NumberList::Components components = list_->axis_of(joint);
    const Vec2& axis = scene().joints[static_cast<std::size_t>(joint)].axis;
    return components.vary() ? unit_or_zero(with_components(axis, components, p_))
                             : constant(list_->along_axis(joint), axis);
  }

  /// Blade::angle.
  const T& blade_angle(int blade) const { return p_[list_->blade(blade)]; }

  /// One of Joint::friction_numbers().
  const T& friction(int joint, int number) const {
    const bool keeps_angle = scene().joints[static_cast<std::size_t>(joint)].keeps_angle();
    return p_[list_->joint(joint) + (keeps_angle ? 1 : 0) + number];
  }

  /// use(law) with the law of an element.
  template <class Use>
  auto with_law(int element, Use use) const {
    const T* const own = p_ + list_->element(element);
    return std::visit([&](const auto& law) { return use(law.with(own)); },
                      scene().elements[static_cast<std::size_t>(element)].law);
  }

  /// Stop::max (`upper`) or Stop::min: a number of a plain stop, of a gas strut its length and stroke, of a coupling
  /// what its kind says where it is finite.
  T limit(int stop, bool upper) const;

  /// The coefficient of restitution of a stop or coupling, and that of its friction; 0 of those without.
  T restitution(int stop) const { return number_of_stop(stop, "restitution"); }
  T stop_friction(int stop) const { return number_of_stop(stop, "friction"); }

  /// The tangent of the pressure angle of a gear or rack.
  T pressure_tangent(int stop) const {
    const Planar<T> along = unit(p_[list_->stop(stop) + pressure_angle_at]);
    return along.y / along.x;
  }

  /// A term of a sum:  factor g  of a measure g, or  factor P(g)  with a profile.
  struct Term {
    T factor;
    ProfileOf<T> of;

    bool has_profile() const { return of.profile != nullptr; }
    const ProfileOf<T>& profile() const { return of; }
    /// P and its derivatives by g.
    ProfileValue<T> at(const T& g) const { return of.at(g); }
  };
  /// Term k of a sum, of the measure of a stop of this index with the numbers of its coupling; -1 of another sum.
  Term term(const Measure& sum, std::size_t k, int stop) const;

 private:
  Planar<T> vector_at(int first) const { return {p_[first], p_[first + 1]}; }
  const Stop& stop_of(int stop) const { return scene().stops[static_cast<std::size_t>(stop)]; }

  // The direction of a vector of the scene, which is known in double, to the digits of T.
  static Planar<T> constant(const Vec2& direction_in_double, const Vec2& vector) {
    if constexpr (std::is_same_v<LaneOf<PlainOf<T>>, double>) {
      return planar_cast<T>(direction_in_double);
    } else {
      return vector == Vec2{} ? Planar<T>{T(0), T(0)} : planar_cast<T>(direction<PlainOf<T>>(vector));
    }
  }

  T number_of_stop(int stop, std::string_view key) const {
    if (list_->strut(stop) >= 0) return T(0);
    const std::span<const Number> all = stop_of(list_->first_row(stop)).numbers();
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].key == key) return p_[list_->stop(stop) + static_cast<int>(k)];
    }
    return T(0);
  }

  bool has_points_as_given(int first) const {
    const CurveNumbers& curve = list_->curve(first);
    const int at = list_->stop(first) + curve.first;
    for (int k = at; k < at + curve.points * curve.components; ++k) {
      if (!is_just(p_[k], list_->values()[static_cast<std::size_t>(k)])) return false;
    }
    return true;
  }
  // The points of the curve of a slot, or of a profile that rolls, in units of `unit`; where they are along it.
  std::vector<Planar<T>> points_of(int first, double unit = 1.0) const {
    const CurveNumbers& curve = list_->curve(first);
    const T* const at = p_ + list_->stop(first) + curve.first;
    std::vector<Planar<T>> out;
    for (int k = 0; k < curve.points; ++k) out.push_back({at[2 * k] / T(unit), at[2 * k + 1] / T(unit)});
    return out;
  }
  std::vector<T> chords_of(int first) const { return sums_of_chords(points_of(first), stop_of(first).closed); }

  void roll(int first, const Measure::Term& given, Term& out) const;
  void lead(int stop, int first, const Measure::Term& given, Term& out) const;

  const NumberList* list_;
  const T* p_;
};

template <class T>
T Numbers<T>::limit(int stop, bool upper) const {
  const int at = list_->stop(stop);
  if (const int strut = list_->strut(stop); strut >= 0) {
    const T* const of_strut = p_ + list_->element(strut);
    return upper ? of_strut[length_of_strut] : T(of_strut[length_of_strut] - of_strut[stroke_of_strut]);
  }
  const CouplingKind* const kind = list_->coupling(stop);
  if (kind == nullptr) return p_[at + (upper ? 1 : 0)];
  const Stop& of = stop_of(stop);
  const auto one_side = upper ? CouplingPart::Of::upper : CouplingPart::Of::lower;
  if (const int first = list_->first_row(stop); upper && of.to_end && list_->curve(first).points > 0) {
    // The end of the curve, and by how much the number is another.
    int end = at;
    for (const CouplingPart& part : kind->parts) {
      if (part.of == one_side) end = at + part.number;
    }
    return chords_of(first).back() + p_[end] - T(list_->values()[static_cast<std::size_t>(end)]);
  }
  const double as_given = upper ? of.max : of.min;
  if (!std::isfinite(as_given)) return T(as_given);
  T sum(0);
  bool is_number = false;
  for (const CouplingPart& part : kind->parts) {
    if (part.of != CouplingPart::Of::value && part.of != one_side) continue;
    sum += T(part.multiplier(of)) * p_[at + part.number];
    is_number = true;
  }
  return is_number ? sum : T(as_given);
}

template <class T>
typename Numbers<T>::Term Numbers<T>::term(const Measure& sum, std::size_t k, int stop) const {
  const Measure::Term& given = sum.terms[k];
  Term out{given.number < 0 ? T(given.factor) : p_[given.number],
           given.profile ? profile_of<T>(given) : ProfileOf<T>{}};
  const CouplingKind* const kind = stop < 0 ? nullptr : list_->coupling(stop);
  if (kind == nullptr) return out;
  for (const CouplingPart& part : kind->parts) {
    if (part.term != static_cast<int>(k)) continue;
    const T& number = p_[list_->stop(stop) + part.number];
    if (part.of == CouplingPart::Of::factor)
      out.factor = T(part.multiplier(stop_of(stop))) * number;
    else if (part.of == CouplingPart::Of::shift)
      out.of.shift = number;
  }
  const int first = list_->first_row(stop);
  if (!given.profile || list_->curve(first).points == 0) return out;
  if constexpr (may_enclose_set<T>) {
    if (!has_points_as_given(first)) out.of.span = T(std::numeric_limits<double>::quiet_NaN());
  } else if (is_rolling_profile(stop_of(first))) {
    roll(first, given, out);
  } else {
    lead(stop, first, given, out);
  }
  return out;
}

// The function of the curve that rolls, of which this term has one, through the points that are numbers.
template <class T>
void Numbers<T>::roll(int first, const Measure::Term& given, Term& out) const {
  if (has_points_as_given(first)) return;
  // Without dimension, as the profile.
  const double unit = std::abs(stop_of(first).on.terms[1].factor);
  const RollingCurve<T> curve(points_of(first, unit), stop_of(first).closed);
  const auto parts = curve.parts();
  if (!parts) {
    out.of.span = T(std::numeric_limits<double>::quiet_NaN());  // a cusp
    return;
  }
  out.of.rolling = std::make_shared<const ProfileIn<T>>(
      curve.function(given.profile->pieces().front().law, *parts, given.profile->at(0.0).value));
  out.of.span = curve.chords() * T(unit);
}

// The profile of a cam, or of a coordinate along a slot, through the points that are numbers.
template <class T>
void Numbers<T>::lead(int stop, int first, const Measure::Term& given, Term& out) const {
  const CurveNumbers& curve = list_->curve(first);
  const T* const points = p_ + list_->stop(first) + curve.first;
  const bool is_cam = curve.components == 1;
  std::vector<T> along, of_points;
  if (is_cam) {
    for (const Vec2& point : stop_of(first).curve) along.push_back(T(T(2) * pi_of<T>() * T(point.x)));
  } else {
    along = chords_of(first);
  }
  // Without dimension, as the profile.
  const T unit = is_cam ? T(1) : T(-given.factor);
  const int component = is_cam ? 0 : stop - first - 1;
  for (std::size_t k = 0; k < along.size(); ++k) {
    of_points.push_back(T(points[curve.components * (static_cast<int>(k) % curve.points) + component] / unit));
  }
  out.of.curve = std::make_shared<const Spline<T>>(std::move(along), of_points, is_cam || stop_of(first).closed);
}

}  // namespace poise

#pragma once

// The equations of equilibrium of a scene with all of its numbers as variables: for derivatives by the numbers, and for
// scenes that differ in numbers only. Bodies are cut free, so that every joint force is an unknown and every number of
// a scene file stands where it acts; equations of the compiled mechanism (model/mechanism.hpp) have sums of numbers.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <ceres/jet.h>

#include "model/couplings.hpp"
#include "model/dependent_number.hpp"
#include "model/gas_struts.hpp"
#include "model/measures/sum.hpp"
#include "model/parameters.hpp"
#include "model/rolling_profile.hpp"
#include "model/scene.hpp"
#include "model/spline.hpp"
#include "solvers/real50.hpp"
#include "statics/contact_loads.hpp"

namespace poise {

/// A stop that acts, on one side.
struct HeldStop {
  int stop = 0;  ///< index of Scene::stops
  bool upper = false;
};

/// The value of a scalar, without derivatives.
inline double plain_value(double a) { return a; }
inline double plain_value(const Real50& a) { return static_cast<double>(a); }
template <class T, int N>
double plain_value(const ceres::Jet<T, N>& a) {
  return plain_value(a.a);
}

/// Whether a scalar is this number, and follows from no variable.
template <class T>
bool is_just(const T& a, double number) {
  return a == T(number);
}
template <class T, int N>
bool is_just(const ceres::Jet<T, N>& a, double number) {
  return is_just(a.a, number) && (a.v.array() == T(0)).all();
}

/// Unknowns z: origin x, y and angle of each body but the ground (3 (i - 1) of body i), then one multiplier per row of
/// the joints and of the stops that act. Residual R(z, p), of the same size:
///
///   balance of body i     sum of forces x, y; sum of moments about its origin,
///   joints                pin, weld: b - a = 0; slide, pin in slot: axis x (b - a) = 0; slide, weld: angle(b) -
///   angle(a)
///                         - angle = 0; bar: |b - a| - length = 0,
///   a stop that acts      g - bound = 0.
///
/// Multipliers are efforts on body b, their opposites on a: force x, y of a pin, force normal to the axis of a slide,
/// moment, pressure of a bar, and of a stop what tends to increase its measure. Numbers p are the rows of
/// parameter_table(), in the units of the scene, which is measured in scales of its own (scaled()); behind them
/// components of forces and axes that are dependent numbers. Dependent numbers, and the springs of flexible links,
/// which follow from the section, are variables like others: residual() does not let them follow, follow() does.
class NumberedEquations {
 public:
  NumberedEquations(const Scene& scene, std::vector<HeldStop> held);

  const Scene& scene() const { return scene_; }
  const std::vector<ParameterRow>& rows() const { return rows_; }
  /// p of the scene; of an absent limit infinite, of an absent guess 0.
  const std::vector<double>& numbers() const { return numbers_; }
  /// Adds to dependent numbers by how much they follow the named ones from the scene's values to those of p, and
  /// multiplies the stiffnesses of the springs of flexible links by  E I  over that of the scene. Throws InputError
  /// where an expression has no value.
  void follow(std::vector<double>& numbers) const;
  /// Rows from which others follow: those of named numbers, and of the sections of flexible links.
  const std::vector<int>& leaders() const { return leaders_; }
  /// The derivatives of p by the number of such a row, along the expressions that follow from it: for each number that
  /// follows its place in p and the derivative, 0 where it has none or there is no such place (why_not_followed()).
  std::vector<std::pair<int, double>> followers(int row, const std::vector<double>& numbers) const;
  /// Why some number that follows from that of a row has no derivative by it; empty where all have.
  std::string why_not_followed(int row) const;
  const std::vector<HeldStop>& held() const { return held_; }
  int unknowns() const { return unknowns_; }
  int poses() const { return 3 * (static_cast<int>(scene_.bodies.size()) - 1); }
  /// First multiplier of a joint, and that of a held stop (place in held()).
  int multiplier_of_joint(int joint) const { return joint_[joint]; }
  int multiplier_of_stop(int held) const { return stop_[held]; }
  /// Adds whole turns to the constant angles of joints, of which scenes leave them out, so that they fit z.
  void count_turns(const double* z);

  template <class T>
  struct Placed {
    Planar<T> origin;
    T angle;
    Planar<T> along;
  };

  /// R(z, p); r has unknowns() values.
  template <class T>
  void residual(const T* numbers, const T* z, T* r, std::vector<Placed<T>>& placed) const;
  /// The bodies at z.
  template <class T>
  void place(const T* z, std::vector<Placed<T>>& placed) const;
  /// g of a measure.
  template <class T>
  T value(const Measure& measure, const T* numbers, const std::vector<Placed<T>>& placed) const {
    return value(measure, numbers, placed, -1);
  }
  /// g of a stop less its max (`upper`), or its min.
  template <class T>
  T overrun(int stop, bool upper, const T* numbers, const std::vector<Placed<T>>& placed) const {
    return value(scene_.stops[stop].on, numbers, placed, stop) - limit(stop, upper, numbers);
  }
  /// Static force of an element, positive where it tends to reduce its measure.
  template <class T>
  T element_force(int element, const T* numbers, const std::vector<Placed<T>>& placed) const;
  /// A gear or rack that acts on a joint by |Q|, where Q is at most `nothing`, so that there are no derivatives; null
  /// without one.
  const Stop* idle_teeth(int joint, const std::vector<double>& z, double nothing) const;
  /// Force that a joint transmits to the body of its second point.
  template <class T>
  Planar<T> joint_force(int joint, const T* numbers, const T* z, const std::vector<Placed<T>>& placed) const;
  /// Potential of loads, weights and elements; forces that follow bodies have none.
  template <class T>
  T energy(const T* numbers, const std::vector<Placed<T>>& placed) const;

 private:
  template <class T>
  Planar<T> local(PointRef point, const T* numbers) const {
    const int at = point_[point.body][point.point];
    return {numbers[at], numbers[at + 1]};
  }
  template <class T>
  static Planar<T> turned(const Planar<T>& local, const Placed<T>& body) {
    return local * body.along;
  }
  template <class T>
  Planar<T> world(PointRef point, const T* numbers, const std::vector<Placed<T>>& placed) const {
    return placed[point.body].origin + turned(local(point, numbers), placed[point.body]);
  }
  // Places in p of the components of a vector that are numbers without a row, or -1.
  struct Components {
    int x = -1, y = -1;
    bool varies() const { return x >= 0 || y >= 0; }
  };
  template <class T>
  Planar<T> axis_of(int joint, const T* numbers, const std::vector<Placed<T>>& placed) const {
    const Joint& of = scene_.joints[joint];
    return turned(axis_.empty() || !axis_[joint].varies() ? planar_cast<T>(of.direction())
                                                          : along(of.axis, axis_[joint], numbers),
                  placed[of.a.body]);
  }
  template <class T>
  static Planar<T> axis_of(const Measure& component, const std::vector<Placed<T>>& placed) {
    return turned(direction<T>(component.axis), placed[component.a.body]);
  }
  /// Of the part of a rope between the contacts k and k + 1.
  template <class T>
  RopeSpan<T> span_of(const Measure& rope, std::size_t k, const T* numbers,
                      const std::vector<Placed<T>>& placed) const {
    const RopeContact& a = rope.contacts[k];
    const RopeContact& b = rope.contacts[k + 1];
    return {world(b.at, numbers, placed) - world(a.at, numbers, placed), T(b.turn * b.radius - a.turn * a.radius)};
  }
  /// At each of the points of Force::for_each_point().
  template <class T>
  Planar<T> force_of(int force, const T* numbers, const std::vector<Placed<T>>& placed) const {
    const Force& f = scene_.forces[force];
    const Planar<T> direction = vector_.empty() || !vector_[force].varies() ? planar_cast<T>(direction_[force])
                                                                            : along(f.vector, vector_[force], numbers);
    const Planar<T> now = numbers[force_[force]] * (f.follows >= 0 ? turned(direction, placed[f.follows]) : direction);
    return f.to ? T(norm(local(*f.to, numbers) - local(f.at, numbers)) / T(2)) * now : now;
  }
  /// A vector of which some components are numbers without a row, divided by its size.
  template <class T>
  static Planar<T> along(const Vec2& vector, const Components& at, const T* numbers) {
    const Planar<T> whole{at.x >= 0 ? numbers[at.x] : T(vector.x), at.y >= 0 ? numbers[at.y] : T(vector.y)};
    return plain_value(whole.x) == 0.0 && plain_value(whole.y) == 0.0 ? Planar<T>{T(0), T(0)}
                                                                      : T(T(1) / norm(whole)) * whole;
  }
  /// Adds a force at a point of the world, and a moment, on a body.
  template <class T>
  static void push(int body, const Planar<T>& at, const Planar<T>& force, const T& moment,
                   const std::vector<Placed<T>>& placed, T* r) {
    if (body == 0) return;
    T* row = r + 3 * (body - 1);
    row[0] += force.x;
    row[1] += force.y;
    row[2] += cross(at - placed[body].origin, force) + moment;
  }
  /// An effort on a measure, positive if it tends to increase it.
  template <class T>
  void push_on(const Measure& measure, const T& effort, const T* numbers, const std::vector<Placed<T>>& placed, T* r,
               int stop = -1) const;
  /// An effort of a coupling that loads bearings, where it acts.
  template <class T>
  void push_at_contact(int stop, const T& effort, const T* numbers, const std::vector<Placed<T>>& placed, T* r) const;
  /// g of a measure; with the numbers of a coupling where it is that of the stop of this index.
  template <class T>
  T value(const Measure& measure, const T* numbers, const std::vector<Placed<T>>& placed, int stop) const;
  /// A limit of a stop, which couplings have as a number where it is finite, and gas struts in their numbers.
  template <class T>
  T limit(int stop, bool upper, const T* numbers) const {
    if (strut_[stop] >= 0) {
      const T* strut = numbers + element_[strut_[stop]];
      return upper ? strut[length_of_strut] : T(strut[length_of_strut] - strut[stroke_of_strut]);
    }
    const CouplingKind* const kind = coupling_[stop];
    if (kind == nullptr) return numbers[stop_number_[stop] + (upper ? 1 : 0)];
    const double as_given = upper ? scene_.stops[stop].max : scene_.stops[stop].min;
    if (const int first = first_row(stop); upper && scene_.stops[stop].to_end && curve_of_[first].points > 0) {
      // The end of the curve, and by how much the number is another.
      const auto part = std::find_if(kind->parts.begin(), kind->parts.end(),
                                     [](const CouplingPart& one) { return one.of == CouplingPart::Of::upper; });
      const int end = stop_number_[stop] + part->number;
      return chords_of(first, numbers).back() + numbers[end] - T(numbers_[end]);
    }
    const auto one_side = upper ? CouplingPart::Of::upper : CouplingPart::Of::lower;
    if (!std::isfinite(as_given)) return T(as_given);
    T sum(0);
    bool is_number = false;
    for (const CouplingPart& part : kind->parts) {
      if (part.of != CouplingPart::Of::value && part.of != one_side) continue;
      sum += T(part.multiplier(scene_.stops[stop])) * numbers[stop_number_[stop] + part.number];
      is_number = true;
    }
    return is_number ? sum : T(as_given);
  }
  /// A term of the measure of a stop (index -1: of another) with the coupling's numbers in it.
  template <class T>
  struct NumberedTerm {
    T factor;
    ProfileOf<T> of;
    // Where its points are numbers: over the measure less the shift; of a profile that rolls over its share of the
    // chords, whose sum is the span.
    std::optional<Spline<T>> curve{};
    std::optional<ProfileIn<T>> rolling{};

    bool has_profile() const { return of.profile != nullptr; }
    ProfileValue<T> at(const T& g) const {
      if (curve) return curve->at(T(g - of.shift));
      if (!rolling) return of.at(g);
      ProfileValue<T> p = rolling->at(T(g / of.span));
      p.first = p.first / of.span;
      return p;
    }
  };
  template <class T>
  struct NumberedCoupling;
  template <class T>
  NumberedTerm<T> term_of(const Measure& measure, std::size_t term, const T* numbers, int stop) const {
    const Measure::Term& as_given = measure.terms[term];
    NumberedTerm<T> out{T(as_given.factor), as_given.profile ? profile_of<T>(as_given) : ProfileOf<T>{}};
    const CouplingKind* const kind = stop < 0 ? nullptr : coupling_[stop];
    if (kind == nullptr) return out;
    for (const CouplingPart& part : kind->parts) {
      if (part.term != static_cast<int>(term)) continue;
      const T& number = numbers[stop_number_[stop] + part.number];
      if (part.of == CouplingPart::Of::factor)
        out.factor = T(part.multiplier(scene_.stops[stop])) * number;
      else if (part.of == CouplingPart::Of::shift)
        out.of.shift = number;
    }
    if (!as_given.profile) return out;
    if (is_rolling_profile(scene_.stops[first_row(stop)]))
      roll(stop, as_given, numbers, out);
    else
      out.curve = curve_of(stop, as_given, numbers);
    return out;
  }
  // The first stop of a coupling, of which this is one.
  int first_row(int stop) const { return coupling_[stop] == nullptr ? stop : stop - coupling_[stop]->row; }
  /// The points of the curve of a slot, or of a profile that rolls, in units of `unit`.
  template <class T>
  std::vector<Planar<T>> points_of(int first, const T* numbers, double unit = 1.0) const {
    const CurveNumbers& curve = curve_of_[first];
    const T* const at = numbers + stop_number_[first] + curve.first;
    std::vector<Planar<T>> out;
    for (int k = 0; k < curve.points; ++k) out.push_back({at[2 * k] / T(unit), at[2 * k + 1] / T(unit)});
    return out;
  }
  /// Where they are along it: sums of chords.
  template <class T>
  std::vector<T> chords_of(int first, const T* numbers) const {
    return sums_of_chords(points_of(first, numbers), scene_.stops[first].closed);
  }
  /// The function of the curve that rolls, of which this term has one, through the points that are numbers.
  template <class T>
  void roll(int stop, const Measure::Term& term, const T* numbers, NumberedTerm<T>& out) const {
    const int first = first_row(stop);
    const int at = stop_number_[first] + curve_of_[first].first, count = 2 * curve_of_[first].points;
    bool is_as_given = true;
    for (int k = at; k < at + count; ++k) is_as_given = is_as_given && is_just(numbers[k], numbers_[k]);
    if (is_as_given) return;
    // Without dimension, as the profile.
    const double unit = std::abs(scene_.stops[first].on.terms[1].factor);
    const RollingCurve<T> curve(points_of(first, numbers, unit), scene_.stops[first].closed);
    const auto parts = curve.parts();
    if (!parts) {
      out.of.span = T(std::numeric_limits<double>::quiet_NaN());  // a cusp
      return;
    }
    out.rolling = curve.function(term.profile->pieces().front().law, *parts, term.profile->at(0.0).value);
    out.of.span = curve.chords() * T(unit);
  }
  /// The profile of a cam, or of a coordinate along a slot, through the points that are numbers.
  template <class T>
  std::optional<Spline<T>> curve_of(int stop, const Measure::Term& term, const T* numbers) const {
    const int first = first_row(stop);
    const CurveNumbers& curve = curve_of_[first];
    if (curve.points == 0) return std::nullopt;
    const T* const points = numbers + stop_number_[first] + curve.first;
    const bool is_cam = curve.components == 1;
    std::vector<T> along, of_points;
    if (is_cam) {
      for (const Vec2& point : scene_.stops[first].curve) along.push_back(T(T(2) * pi_of<T>() * T(point.x)));
    } else {
      along = chords_of(first, numbers);
    }
    // Without dimension, as the profile.
    const T unit = is_cam ? T(1) : T(-term.factor);
    const int component = is_cam ? 0 : stop - first - 1;
    for (std::size_t k = 0; k < along.size(); ++k) {
      of_points.push_back(T(points[curve.components * (static_cast<int>(k) % curve.points) + component] / unit));
    }
    return Spline<T>(std::move(along), of_points, is_cam || scene_.stops[first].closed);
  }
  template <class T>
  T force_of_law(int element, const T* numbers, const T& g) const;
  template <class T>
  T energy_of_law(int element, const T* numbers, const T& g) const;

  void place_dependents();
  void follow_names(std::vector<double>& numbers) const;
  void add_springs_of(int row, double slope, const std::vector<double>& numbers,
                      std::vector<std::pair<int, double>>& out) const;

  Scene scene_;
  std::vector<HeldStop> held_;
  std::vector<ParameterRow> rows_;
  std::vector<double> numbers_;
  int unknowns_ = 0;
  // Places of the items' first numbers in p, of points and bodies by body.
  int gravity_ = 0;
  std::vector<std::vector<int>> point_;
  std::vector<int> body_, element_, force_, torque_, joint_number_, stop_number_;
  std::vector<int> strut_;                            // of each stop, see strut_of()
  std::vector<const CouplingKind*> coupling_;         // of each stop, null of a plain one
  std::vector<CurveNumbers> curve_of_;                // of each stop that is the first of a coupling
  std::vector<std::optional<ContactPlace>> contact_;  // of each stop that loads bearings
  std::vector<Vec2> direction_;                       // of each force
  // Empty where no component is a number of its own.
  std::vector<Components> vector_, axis_;
  std::vector<int> dependent_;    // place in p of each dependent number, or -1
  std::vector<double> followed_;  // values that follow from the scene's named numbers
  std::vector<double> turns_;     // of each joint, rad
  std::vector<int> joint_, stop_;
  std::vector<int> section_;  // of each flexible link
  std::vector<int> leaders_;
};

/// d energy / d number of a law, at the measure g.
template <class S>
S energy_by_number(const LinearSpring& law, int number, const S& g) {
  if (law.slack(g)) return S(0);
  const S u = g - S(law.free_length);
  return number == 0 ? S(u * u / S(2)) : S(-S(law.stiffness) * u);
}
template <class S>
S energy_by_number(const CubicSpring& law, int number, const S& g) {
  const S u = g - S(law.free_length);
  if (number == 0) return u * u / S(2);
  return number == 1 ? S(u * u * u * u / S(4)) : S(-law.at_rest(g).value);
}
template <class S>
S energy_by_number(const ConstantForce&, int /*number*/, const S& g) {
  return g;
}
template <class S>
S energy_by_number(const PreloadedSpring& law, int number, const S& g) {
  const S u = g - S(law.length);
  if (number == 0) return u * u / S(2);
  return number == 1 ? u : S(-law.at_rest(g).value);
}
template <class S>
S energy_by_number(const CurveSpring& law, int number, const S& g) {
  return law.energy_by(number, g);
}
template <class S>
S energy_by_number(const GasStrut& law, int number, const S& g) {
  return law.energy_by(number, g);
}
template <class S>
S energy_by_number(const BumpStop& law, int number, const S& g) {
  return law.energy_by(number, g);
}

/// The law with other numbers.
template <class T>
Law with_numbers(Law law, const T* numbers) {
  std::visit(
      [&](auto& l) {
        int k = 0;
        for (const Number& number : numbers_of_law(l)) number.set(&l, plain_value(numbers[k++]));
      },
      law);
  return law;
}

template <class T>
inline constexpr bool is_jet = false;
template <class T, int N>
inline constexpr bool is_jet<ceres::Jet<T, N>> = true;

// Of a Jet, whose values are the law's own numbers:  value + sum_k by_number(law, k) (p_k - value of p_k),  exact to
// first order. `numbers` are those of the law.
template <class T, class Derivative>
T with_change_of_numbers(const Law& law, const T* numbers, T value, Derivative by_number) {
  if constexpr (is_jet<T>) {
    std::visit(
        [&]<class L>(const L& l) {
          if constexpr (StoresEnergy<L>) {
            for (std::size_t k = 0; k < numbers_of_law(l).size(); ++k) {
              value += by_number(l, static_cast<int>(k)) * (numbers[k] - T(plain_value(numbers[k])));
            }
          }
        },
        law);
  }
  return value;
}

template <class T>
T NumberedEquations::force_of_law(int element, const T* numbers, const T& g) const {
  const T* own = numbers + element_[element];
  const Law law = with_numbers(scene_.elements[element].law, own);
  return with_change_of_numbers(law, own, force_at_rest(law, g).value,
                                [&](const auto& l, int k) { return l.force_by(k, g, T(0)); });
}

template <class T>
T NumberedEquations::energy_of_law(int element, const T* numbers, const T& g) const {
  const T* own = numbers + element_[element];
  const Law law = with_numbers(scene_.elements[element].law, own);
  return with_change_of_numbers(law, own, T(poise::energy(law, g)),
                                [&](const auto& l, int k) { return energy_by_number(l, k, g); });
}

template <class T>
void NumberedEquations::place(const T* z, std::vector<Placed<T>>& placed) const {
  placed.resize(scene_.bodies.size());
  placed[0] = {{T(0), T(0)}, T(0), {T(1), T(0)}};
  for (std::size_t i = 1; i < placed.size(); ++i) {
    const T* at = z + 3 * (i - 1);
    placed[i] = {{at[0], at[1]}, at[2], unit(at[2])};
  }
}

template <class T>
T NumberedEquations::value(const Measure& measure, const T* numbers, const std::vector<Placed<T>>& placed,
                           int stop) const {
  switch (measure.kind) {
    case Measure::Kind::angle:
      return placed[measure.body_b].angle - placed[measure.body_a].angle;
    case Measure::Kind::distance: {
      const Planar<T> d = world(measure.b, numbers, placed) - world(measure.a, numbers, placed);
      return plain_value(d.x) == 0.0 && plain_value(d.y) == 0.0 ? T(0) : norm(d);
    }
    case Measure::Kind::travel: {
      const Joint& joint = scene_.joints[measure.joint];
      return dot(axis_of(measure.joint, numbers, placed),
                 world(joint.b, numbers, placed) - world(joint.a, numbers, placed));
    }
    case Measure::Kind::x:
      return world(measure.b, numbers, placed).x;
    case Measure::Kind::y:
      return world(measure.b, numbers, placed).y;
    case Measure::Kind::component:
      return dot(axis_of(measure, placed), world(measure.b, numbers, placed) - world(measure.a, numbers, placed));
    case Measure::Kind::rope: {
      T length(0);
      Planar<T> before{};
      for (std::size_t k = 0; k + 1 < measure.contacts.size(); ++k) {
        const RopeSpan<T> span = span_of(measure, k, numbers, placed);
        const RopeContact& contact = measure.contacts[k];
        if (k > 0 && contact.radius > 0) length += T(contact.radius) * rope_wrap(before, span.along, contact.turn);
        length += span.length;
        before = span.along;
      }
      return length;
    }
    case Measure::Kind::sum:
      break;
  }
  T sum(0);
  for (std::size_t k = 0; k < measure.terms.size(); ++k) {
    const NumberedTerm<T> term = term_of(measure, k, numbers, stop);
    const T g = value(measure.terms[k].measure, numbers, placed);
    sum += term.factor * (term.has_profile() ? term.at(g).value : g);
  }
  return sum;
}

template <class T>
void NumberedEquations::push_on(const Measure& measure, const T& effort, const T* numbers,
                                const std::vector<Placed<T>>& placed, T* r, int stop) const {
  const auto between = [&](int a, int b, const Planar<T>& at_a, const Planar<T>& at_b, const Planar<T>& force) {
    push(a, at_a, -force, T(0), placed, r);
    push(b, at_b, force, T(0), placed, r);
  };
  switch (measure.kind) {
    case Measure::Kind::angle:
      push(measure.body_a, placed[measure.body_a].origin, {T(0), T(0)}, T(-effort), placed, r);
      push(measure.body_b, placed[measure.body_b].origin, {T(0), T(0)}, effort, placed, r);
      return;
    case Measure::Kind::distance: {
      const Planar<T> a = world(measure.a, numbers, placed), b = world(measure.b, numbers, placed);
      const Planar<T> d = b - a;
      if (plain_value(d.x) == 0.0 && plain_value(d.y) == 0.0) return;
      between(measure.a.body, measure.b.body, a, b, T(effort / norm(d)) * d);
      return;
    }
    case Measure::Kind::travel: {
      const Joint& joint = scene_.joints[measure.joint];
      const Planar<T> at = world(joint.b, numbers, placed);
      between(joint.a.body, joint.b.body, at, at, effort * axis_of(measure.joint, numbers, placed));
      return;
    }
    case Measure::Kind::x:
    case Measure::Kind::y: {
      const Planar<T> at = world(measure.b, numbers, placed);
      const Planar<T> force = measure.kind == Measure::Kind::x ? Planar<T>{effort, T(0)} : Planar<T>{T(0), effort};
      push(measure.b.body, at, force, T(0), placed, r);
      return;
    }
    case Measure::Kind::component: {
      const Planar<T> at = world(measure.b, numbers, placed);
      between(measure.a.body, measure.b.body, at, at, effort * axis_of(measure, placed));
      return;
    }
    case Measure::Kind::rope:
      // At the centres of pulleys, about which the pulls on their rims have no moment together.
      for (std::size_t k = 0; k + 1 < measure.contacts.size(); ++k) {
        const PointRef a = measure.contacts[k].at, b = measure.contacts[k + 1].at;
        between(a.body, b.body, world(a, numbers, placed), world(b, numbers, placed),
                effort * span_of(measure, k, numbers, placed).along);
      }
      return;
    case Measure::Kind::sum:
      break;
  }
  for (std::size_t k = 0; k < measure.terms.size(); ++k) {
    const NumberedTerm<T> term = term_of(measure, k, numbers, stop);
    const Measure& of = measure.terms[k].measure;
    T share = term.factor * effort;
    if (term.has_profile()) share = share * term.at(value(of, numbers, placed)).first;
    push_on(of, share, numbers, placed, r);
  }
}

template <class T>
T NumberedEquations::element_force(int element, const T* numbers, const std::vector<Placed<T>>& placed) const {
  return force_of_law(element, numbers, value(scene_.elements[element].on, numbers, placed));
}

template <class T>
Planar<T> NumberedEquations::joint_force(int joint, const T* numbers, const T* z,
                                         const std::vector<Placed<T>>& placed) const {
  const Joint& of = scene_.joints[joint];
  const T* effort = z + joint_[joint];
  if (of.keeps_length()) {
    const Planar<T> d = world(of.b, numbers, placed) - world(of.a, numbers, placed);
    return T(effort[0] / norm(d)) * d;
  }
  if (of.has_travel()) return effort[0] * quarter_turn(axis_of(joint, numbers, placed));
  return {effort[0], effort[1]};
}

template <class T>
T NumberedEquations::energy(const T* numbers, const std::vector<Placed<T>>& placed) const {
  T sum(0);
  const Planar<T> gravity{numbers[gravity_], numbers[gravity_ + 1]};
  for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
    const T* body = numbers + body_[i];
    sum -= body[0] * dot(gravity, placed[i].origin + turned(Planar<T>{body[2], body[3]}, placed[i]));
  }
  for (std::size_t f = 0; f < scene_.forces.size(); ++f) {
    const Planar<T> force = force_of(static_cast<int>(f), numbers, placed);
    sum -= dot(force, world(scene_.forces[f].at, numbers, placed));
    if (scene_.forces[f].to) sum -= dot(force, world(*scene_.forces[f].to, numbers, placed));
  }
  for (std::size_t t = 0; t < scene_.torques.size(); ++t) {
    sum -= numbers[torque_[t]] * placed[scene_.torques[t].body].angle;
  }
  for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
    sum += energy_of_law(static_cast<int>(e), numbers, value(scene_.elements[e].on, numbers, placed));
  }
  return sum;
}

/// A coupling with its numbers, as contact_load() asks for it.
template <class T>
struct NumberedEquations::NumberedCoupling {
  using Scalar = T;

  const NumberedEquations& equations;
  const Stop& stop;
  int index;
  const T* numbers;
  const std::vector<Placed<T>>& placed;

  Planar<T> world(PointRef p) const { return equations.world(p, numbers, placed); }
  Planar<T> axis(int joint) const { return equations.axis_of(joint, numbers, placed); }
  T factor() const { return equations.term_of(stop.on, 1, numbers, index).factor; }
  T slope() const {
    const NumberedTerm<T> term = equations.term_of(stop.on, 1, numbers, index);
    return term.factor * term.at(equations.value(stop.on.terms[1].measure, numbers, placed)).first;
  }
  T pressure_tangent() const {
    using std::tan;
    return tan(numbers[equations.stop_number_[index] + pressure_angle_at]);
  }
};

template <class T>
void NumberedEquations::push_at_contact(int stop, const T& effort, const T* numbers,
                                        const std::vector<Placed<T>>& placed, T* r) const {
  using std::abs;
  const NumberedCoupling<T> coupling{*this, scene_.stops[stop], stop, numbers, placed};
  const std::optional<ContactLoad<T>> load = contact_load(coupling, *contact_[stop]);
  if (!load) return push_on(scene_.stops[stop].on, effort, numbers, placed, r, stop);
  const Planar<T> force = effort * load->force + T(abs(effort)) * load->separating;
  push(load->body_b, load->at, force, T(0), placed, r);
  push(load->body_a, load->at, -force, T(0), placed, r);
}

template <class T>
void NumberedEquations::residual(const T* numbers, const T* z, T* r, std::vector<Placed<T>>& placed) const {
  place(z, placed);
  for (int i = 0; i < unknowns_; ++i) r[i] = T(0);
  const Planar<T> gravity{numbers[gravity_], numbers[gravity_ + 1]};
  for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
    const T* body = numbers + body_[i];
    const Planar<T> center = placed[i].origin + turned(Planar<T>{body[2], body[3]}, placed[i]);
    push(static_cast<int>(i), center, body[0] * gravity, T(0), placed, r);
  }
  for (std::size_t f = 0; f < scene_.forces.size(); ++f) {
    const Force& load = scene_.forces[f];
    const Planar<T> force = force_of(static_cast<int>(f), numbers, placed);
    push(load.at.body, world(load.at, numbers, placed), force, T(0), placed, r);
    if (load.to) push(load.to->body, world(*load.to, numbers, placed), force, T(0), placed, r);
  }
  for (std::size_t t = 0; t < scene_.torques.size(); ++t) {
    const int body = scene_.torques[t].body;
    push(body, placed[body].origin, {T(0), T(0)}, numbers[torque_[t]], placed, r);
  }
  for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
    const Element& element = scene_.elements[e];
    if (!stores_energy(element.law)) continue;
    const T g = value(element.on, numbers, placed);
    if (element.on.kind == Measure::Kind::distance && plain_value(g) == 0.0) {
      // A spring of free length zero whose points coincide: its force is k (b - a).
      const Planar<T> a = world(element.on.a, numbers, placed), b = world(element.on.b, numbers, placed);
      const Planar<T> force = numbers[element_[e]] * (b - a);
      push(element.on.a.body, a, force, T(0), placed, r);
      push(element.on.b.body, b, -force, T(0), placed, r);
      continue;
    }
    push_on(element.on, T(-force_of_law(static_cast<int>(e), numbers, g)), numbers, placed, r);
  }
  for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
    const Joint& joint = scene_.joints[j];
    const Planar<T> a = world(joint.a, numbers, placed), b = world(joint.b, numbers, placed);
    const auto act = [&](const Planar<T>& force, const T& moment) {
      push(joint.a.body, b, -force, T(-moment), placed, r);
      push(joint.b.body, b, force, moment, placed, r);
    };
    int row = joint_[j];
    act(joint_force(static_cast<int>(j), numbers, z, placed), T(0));
    if (joint.keeps_length()) {
      r[row] = norm(b - a) - numbers[joint_number_[j]];
      continue;
    }
    if (joint.has_travel()) {
      r[row++] = cross(axis_of(static_cast<int>(j), numbers, placed), b - a);
    } else {
      r[row++] = b.x - a.x;
      r[row++] = b.y - a.y;
    }
    if (joint.keeps_angle()) {
      act({T(0), T(0)}, z[row]);
      r[row] = placed[joint.b.body].angle - placed[joint.a.body].angle - numbers[joint_number_[j]] - T(turns_[j]);
    }
  }
  for (std::size_t h = 0; h < held_.size(); ++h) {
    const int s = held_[h].stop;
    if (contact_[s])
      push_at_contact(s, z[stop_[h]], numbers, placed, r);
    else
      push_on(scene_.stops[s].on, z[stop_[h]], numbers, placed, r, s);
    r[stop_[h]] = value(scene_.stops[s].on, numbers, placed, s) - limit(s, held_[h].upper, numbers);
  }
}

}  // namespace poise

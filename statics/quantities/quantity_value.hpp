#pragma once

// Values of quantities, in the scalar of the places of the bodies and of the numbers.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "model/plain_value.hpp"
#include "statics/quantities/numbered_equations.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// The one motion that joints and acting stops allow: rates of the places of the bodies, poses() values.
template <class T>
struct OneMotion {
  std::vector<T> rates;  ///< empty where there is none, or more than one
  int freedoms = 0;
};

/// `released`: a place in acting() from which on stops are left out of what holds, -1 of none. By elimination with
/// pivots that the values choose, so that in dual numbers the motion has its derivatives.
template <class T>
OneMotion<T> one_motion(const NumberedEquations& equations, const NumberedEquations::Bodies<T>& bodies,
                        const std::vector<NumberedEquations::Placed<T>>& placed, int released) {
  constexpr double rank_tolerance = 1e-9;
  const auto n = static_cast<std::size_t>(equations.poses());
  std::vector<std::vector<T>> rows;
  const int end = released >= 0 ? equations.multiplier_of_stop(released) : equations.unknowns();
  for (int k = equations.poses(); k < end; ++k) {
    rows.push_back(equations.row_gradient(k, bodies, placed));
  }
  std::vector<std::size_t> columns(n);
  for (std::size_t i = 0; i < n; ++i) columns[i] = i;
  std::size_t rank = 0;
  double first = 0.0;
  for (; rank < std::min(rows.size(), n); ++rank) {
    std::size_t row = rank, column = rank;
    double largest = 0.0;
    for (std::size_t i = rank; i < rows.size(); ++i) {
      for (std::size_t j = rank; j < n; ++j) {
        const double size = std::abs(plain_value(rows[i][columns[j]]));
        if (size <= largest) continue;
        largest = size;
        row = i;
        column = j;
      }
    }
    if (rank == 0) first = largest;
    if (!(largest > rank_tolerance * first)) break;
    std::swap(rows[rank], rows[row]);
    std::swap(columns[rank], columns[column]);
    for (std::size_t i = rank + 1; i < rows.size(); ++i) {
      const T part = rows[i][columns[rank]] / rows[rank][columns[rank]];
      for (std::size_t j = rank; j < n; ++j) rows[i][columns[j]] -= part * rows[rank][columns[j]];
    }
  }
  OneMotion<T> out;
  out.freedoms = static_cast<int>(n - rank);
  if (out.freedoms != 1) return out;
  out.rates.assign(n, T(0));
  out.rates[columns[rank]] = T(1);
  for (std::size_t i = rank; i-- > 0;) {
    T sum(0);
    for (std::size_t j = i + 1; j < n; ++j) sum += rows[i][columns[j]] * out.rates[columns[j]];
    out.rates[columns[i]] = -sum / rows[i][columns[i]];
  }
  return out;
}

/// Where a quantity is asked for: bodies at z with the numbers p, in the scalar T. Refers to the equations.
template <class T>
class QuantityPlace {
 public:
  /// `driven`: a place in acting() from which on the stops are drives, in whose stead a push holds the pose and which
  /// d(A)/d(B) leaves out of what holds; -1 of none.
  QuantityPlace(const NumberedEquations& equations, const T* numbers, const T* z, int driven = -1)
      : equations_(equations), numbers_(numbers), z_(z), driven_(driven) {
    equations.place(z, placed_);
  }

  /// From now on the motion is the one with these rates of the places, whatever joints and stops allow.
  void move(std::vector<T> rates) {
    motion_ = {std::move(rates), 1};
    has_motion_ = true;
  }
  /// In how many ways joints and stops let it move.
  int freedoms() { return motion().empty() ? motion_.freedoms : 1; }
  /// Counts forces besides loads and elements: generalized ones on the places of the bodies, poses() values, and their
  /// resultant on the ground.
  void add_beside(const std::vector<double>& on_places, const GroundForce<double>& on_ground) {
    beside_ = on_places;
    beside_on_ground_ = on_ground;
  }

  /// In the units of the equations' scene. Not a number where the quantity is undefined.
  T value(const SoughtQuantity& of);
  /// Why the value found last is undefined, in one sentence; empty where it is a number.
  const std::string& why() const { return why_; }

 private:
  static constexpr double still = 1e-12;  // parts of a motion below which a rate is rounding

  NumberedEquations::Bodies<T> bodies() const { return equations_.bodies(numbers_, placed_); }
  /// Rates of the one motion; empty where there is none, which why() says.
  const std::vector<T>& motion();
  double speed();  // the size of its rates
  T along_motion(const std::vector<T>& gradient);
  /// How fast something changes along the motion, and the size of what that is the sum of.
  struct Rate {
    T value;
    double size = 0.0;
    bool is_zero() const { return std::abs(plain_value(value)) <= still * size; }
  };
  Rate rate_along_motion(const std::vector<T>& gradient);
  /// Of a measure, the energy, the force of an element, or an expression of these.
  Rate rate(const SoughtQuantity& of);
  /// Velocity in the motion of the point of a body that is at a place of the world, and rate of its angle.
  Planar<T> velocity(int body, const Planar<T>& at);
  T turning(int body) { return body == 0 ? T(0) : motion()[static_cast<std::size_t>(3 * (body - 1) + 2)]; }
  T undefined(std::string why) {
    if (why_.empty()) why_ = std::move(why);
    return T(std::numeric_limits<double>::quiet_NaN());
  }
  T part_of(const SoughtQuantity& of);
  T reaction(const SoughtQuantity& of) const;
  T stop_reaction(int stop) const;
  T drive_force(const SoughtQuantity& of);
  T shaking(const SoughtQuantity& of) const;
  T push(const SoughtQuantity& of);
  T ratio(const SoughtQuantity& of);
  T center(const SoughtQuantity& of);
  T transmission(const SoughtQuantity& of);

  const NumberedEquations& equations_;
  const T* numbers_;
  const T* z_;
  int driven_;
  std::vector<NumberedEquations::Placed<T>> placed_;
  OneMotion<T> motion_;
  bool has_motion_ = false;
  std::vector<double> beside_;  // empty: none
  GroundForce<double> beside_on_ground_;
  std::string why_;
};

template <class T>
const std::vector<T>& QuantityPlace<T>::motion() {
  if (!has_motion_) motion_ = one_motion(equations_, bodies(), placed_, driven_);
  has_motion_ = true;
  if (motion_.freedoms == 0) undefined("nothing can move");
  if (motion_.freedoms > 1) {
    undefined("it can move in " + std::to_string(motion_.freedoms) + " ways; expected one that is driven");
  }
  return motion_.rates;
}

template <class T>
double QuantityPlace<T>::speed() {
  double sum = 0.0;
  for (const T& rate : motion()) sum += plain_value(rate) * plain_value(rate);
  return std::sqrt(sum);
}

template <class T>
T QuantityPlace<T>::along_motion(const std::vector<T>& gradient) {
  T sum(0);
  for (std::size_t i = 0; i < gradient.size(); ++i) sum += gradient[i] * motion_.rates[i];
  return sum;
}

template <class T>
auto QuantityPlace<T>::rate_along_motion(const std::vector<T>& gradient) -> Rate {
  double size = 0.0;
  for (const T& one : gradient) size += plain_value(one) * plain_value(one);
  return {along_motion(gradient), std::sqrt(size) * speed()};
}

template <class T>
auto QuantityPlace<T>::rate(const SoughtQuantity& of) -> Rate {
  using Kind = SoughtQuantity::Kind;
  const auto size_of = [](const T& value) { return std::abs(plain_value(value)); };
  switch (of.kind) {
    case Kind::measure:
      return rate_along_motion(equations_.measure_gradient(of.on, bodies(), placed_));
    case Kind::energy: {
      std::vector<T> applied(motion_.rates.size(), T(0));
      equations_.push_applied(bodies(), placed_, applied.data());
      Rate out = rate_along_motion(applied);
      out.value = -out.value;
      return out;
    }
    case Kind::element_force: {
      const Measure& on = equations_.scene().elements[static_cast<std::size_t>(of.item)].on;
      const Rate along = rate_along_motion(equations_.measure_gradient(on, bodies(), placed_));
      const T slope = bodies().element_rate(of.item);
      return {slope * along.value, size_of(slope) * along.size};
    }
    case Kind::number:
      return {T(0), 0.0};
    default:
      break;
  }
  const Rate a = rate(of.of[0]), b = rate(of.of[1]);
  if (of.kind == Kind::sum) return {a.value + b.value, a.size + b.size};
  if (of.kind == Kind::difference) return {a.value - b.value, a.size + b.size};
  const T x = part_of(of.of[0]), y = part_of(of.of[1]);
  if (of.kind == Kind::product) return {a.value * y + x * b.value, a.size * size_of(y) + size_of(x) * b.size};
  return {(a.value - x / y * b.value) / y, (a.size + size_of(x / y) * b.size) / size_of(y)};
}

template <class T>
Planar<T> QuantityPlace<T>::velocity(int body, const Planar<T>& at) {
  if (body == 0) return {};
  const auto first = static_cast<std::size_t>(3 * (body - 1));
  const std::vector<T>& rates = motion();
  return Planar<T>{rates[first], rates[first + 1]} +
         rates[first + 2] * quarter_turn(at - placed_[static_cast<std::size_t>(body)].origin);
}

template <class T>
T QuantityPlace<T>::reaction(const SoughtQuantity& of) const {
  const Joint& joint = equations_.scene().joints[static_cast<std::size_t>(of.item)];
  const int first = equations_.multiplier_of_joint(of.item);
  if (of.part == SoughtQuantity::Part::axial) return -z_[first];
  if (of.part == SoughtQuantity::Part::moment) return z_[first + joint.traits().constraints() - 1];
  const Planar<T> force = bodies().joint_effort(of.item, z_ + first).force;
  if (of.part == SoughtQuantity::Part::x) return force.x;
  return of.part == SoughtQuantity::Part::y ? force.y : norm(force);
}

template <class T>
T QuantityPlace<T>::stop_reaction(int stop) const {
  for (std::size_t h = 0; h < equations_.acting().size(); ++h) {
    if (equations_.acting()[h].stop != stop) continue;
    const T& effort = z_[equations_.multiplier_of_stop(static_cast<int>(h))];
    return equations_.acting()[h].upper ? T(-effort) : effort;
  }
  return T(0);
}

template <class T>
T QuantityPlace<T>::drive_force(const SoughtQuantity& of) {
  for (std::size_t h = static_cast<std::size_t>(std::max(driven_, 0)); h < equations_.acting().size(); ++h) {
    const Stop& stop = equations_.scene().stops[static_cast<std::size_t>(equations_.acting()[h].stop)];
    if (driven_ >= 0 && is_same(stop.on, of.on)) return z_[equations_.multiplier_of_stop(static_cast<int>(h))];
  }
  return undefined("nothing is driven here that " + of.name + " would be the effort of");
}

template <class T>
T QuantityPlace<T>::shaking(const SoughtQuantity& of) const {
  GroundForce<T> on = equations_.on_ground(bodies(), z_);
  on.force += planar_cast<T>(beside_on_ground_.force);
  on.moment += T(beside_on_ground_.moment);
  if (of.part == SoughtQuantity::Part::moment) return on.moment;
  if (of.part == SoughtQuantity::Part::x) return on.force.x;
  return of.part == SoughtQuantity::Part::y ? on.force.y : norm(on.force);
}

// P along e at a point, in the one motion t:  P e . v + (power of loads and elements) = 0.
template <class T>
T QuantityPlace<T>::push(const SoughtQuantity& of) {
  if (motion().empty()) return undefined("");
  std::vector<T> applied(motion_.rates.size(), T(0));
  for (std::size_t i = 0; i < beside_.size(); ++i) applied[i] = T(beside_[i]);
  equations_.push_applied(bodies(), placed_, applied.data());
  std::vector<T> along = equations_.measure_gradient(Measure::x_of(of.point), bodies(), placed_);
  const std::vector<T> along_y = equations_.measure_gradient(Measure::y_of(of.point), bodies(), placed_);
  for (std::size_t i = 0; i < along.size(); ++i) {
    along[i] = T(of.direction.x) * along[i] + T(of.direction.y) * along_y[i];
  }
  const Rate moves = rate_along_motion(along);
  if (moves.is_zero()) return undefined("the point does not move along that direction here");
  return -along_motion(applied) / moves.value;
}

template <class T>
T QuantityPlace<T>::ratio(const SoughtQuantity& of) {
  if (motion().empty()) return undefined("");
  const Rate b = rate(of.of[1]);
  if (b.is_zero()) return undefined(of.of[1].name + " stands still here");
  return rate(of.of[0]).value / b.value;
}

// The point c of the world at which both bodies have one velocity:  u + w i c = 0,  with u the relative velocity of the
// points of both that are at the origin of the world, and w the relative rate of their angles.
template <class T>
T QuantityPlace<T>::center(const SoughtQuantity& of) {
  if (motion().empty()) return undefined("");
  const T turns = turning(of.item) - turning(of.other);
  if (std::abs(plain_value(turns)) <= still * speed()) {
    return undefined("the two bodies do not turn relative to each other here");
  }
  const Planar<T> apart = velocity(of.item, {}) - velocity(of.other, {});
  return of.part == SoughtQuantity::Part::x ? T(-apart.y / turns) : T(apart.x / turns);
}

template <class T>
T QuantityPlace<T>::transmission(const SoughtQuantity& of) {
  using std::abs;
  using std::atan2;
  if (motion().empty()) return undefined("");
  const Planar<T> end = bodies().world(of.on.b);
  const Planar<T> line = end - bodies().world(of.on.a);
  if (is_zero(line.x) && is_zero(line.y)) return undefined("the two joints coincide here");
  const Planar<T> v = velocity(of.item, end);
  if (std::hypot(plain_value(v.x), plain_value(v.y)) <= still * speed()) {
    return undefined("the joint stands still here");
  }
  return atan2(T(abs(dot(line, v))), T(abs(cross(line, v))));
}

template <class T>
T QuantityPlace<T>::value(const SoughtQuantity& of) {
  why_.clear();
  T out = part_of(of);
  if (!std::isfinite(plain_value(out))) return undefined("it is divided by zero here");
  return out;
}

template <class T>
T QuantityPlace<T>::part_of(const SoughtQuantity& of) {
  using Kind = SoughtQuantity::Kind;
  switch (of.kind) {
    case Kind::measure:
      return bodies().value(of.on);
    case Kind::element_force: {
      const Element& element = equations_.scene().elements[static_cast<std::size_t>(of.item)];
      if (!stores_energy(element.law)) return undefined("a " + element.family() + " has no force at rest");
      return bodies().element_force(of.item);
    }
    case Kind::element_rate:
      return bodies().element_rate(of.item);
    case Kind::drive_force:
      return drive_force(of);
    case Kind::energy:
      return bodies().energy();
    case Kind::stop_reaction:
      return stop_reaction(of.item);
    case Kind::reaction:
      return reaction(of);
    case Kind::shaking:
      return shaking(of);
    case Kind::push:
      return push(of);
    case Kind::ratio:
      return ratio(of);
    case Kind::center:
      return center(of);
    case Kind::transmission:
      return transmission(of);
    case Kind::number:
      return T(of.constant);
    case Kind::sum:
      return part_of(of.of[0]) + part_of(of.of[1]);
    case Kind::difference:
      return part_of(of.of[0]) - part_of(of.of[1]);
    case Kind::product:
      return part_of(of.of[0]) * part_of(of.of[1]);
    case Kind::quotient:
      return part_of(of.of[0]) / part_of(of.of[1]);
    case Kind::kinetic_energy:
      return T(0);
    case Kind::by_time:
      return undefined("nothing changes with time at rest");
    case Kind::stress:
    case Kind::link_load:
    case Kind::frequency:
    case Kind::damping:
    case Kind::blade_force:
      return undefined("it is not known here");
    case Kind::maximum:
    case Kind::minimum:
    case Kind::mean:
    case Kind::span:
    case Kind::work:
      return undefined(of.name + " belongs to a path, not to a position");
    case Kind::load_at_fold:
      return undefined("a load at a fold belongs to a path, not to a position");
  }
  return undefined("");
}

/// Value of a quantity at z and its derivatives, in the units of the equations' scene; `driven` as of QuantityPlace.
struct QuantityGradient {
  double value = 0.0;
  std::string why;  ///< it has none, in one sentence
  Eigen::VectorXd by_unknowns, by_numbers;
};
QuantityGradient gradient_of(const SoughtQuantity& of, const NumberedEquations& equations,
                             const std::vector<double>& numbers, const std::vector<double>& z, int driven = -1);
/// Its derivatives by the efforts of joints and acting stops alone.
Eigen::VectorXd gradient_by_efforts(const SoughtQuantity& of, const NumberedEquations& equations,
                                    const std::vector<double>& z, int driven);

}  // namespace poise

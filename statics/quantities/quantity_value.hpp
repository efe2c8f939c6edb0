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

/// `released`: an acting stop (place in acting()) that is left out of what holds, -1 of none. By elimination with
/// pivots that the values choose, so that in dual numbers the motion has its derivatives.
template <class T>
OneMotion<T> one_motion(const NumberedEquations& equations, const NumberedEquations::Bodies<T>& bodies,
                        const std::vector<NumberedEquations::Placed<T>>& placed, int released) {
  constexpr double rank_tolerance = 1e-9;
  const auto n = static_cast<std::size_t>(equations.poses());
  std::vector<std::vector<T>> rows;
  for (int k = equations.poses(); k < equations.unknowns(); ++k) {
    if (released >= 0 && k == equations.multiplier_of_stop(released)) continue;
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
  /// `driven`: an acting stop (place in acting()) in whose stead a push holds the pose, -1 of none.
  QuantityPlace(const NumberedEquations& equations, const T* numbers, const T* z, int driven = -1)
      : equations_(equations), numbers_(numbers), z_(z), driven_(driven) {
    equations.place(z, placed_);
  }

  /// In the units of the equations' scene. Not a number where the quantity is undefined (why_undefined()).
  T value(const SoughtQuantity& of);

 private:
  NumberedEquations::Bodies<T> bodies() const { return equations_.bodies(numbers_, placed_); }
  const OneMotion<T>& motion() {
    if (!has_motion_) motion_ = one_motion(equations_, bodies(), placed_, driven_);
    has_motion_ = true;
    return motion_;
  }
  T along_motion(const std::vector<T>& gradient) {
    T sum(0);
    for (std::size_t i = 0; i < gradient.size(); ++i) sum += gradient[i] * motion().rates[i];
    return sum;
  }
  static T undefined() { return T(std::numeric_limits<double>::quiet_NaN()); }
  T reaction(const SoughtQuantity& of) const;
  T stop_reaction(int stop) const;
  T push(const SoughtQuantity& of);
  T ratio(const SoughtQuantity& of);

  const NumberedEquations& equations_;
  const T* numbers_;
  const T* z_;
  int driven_;
  std::vector<NumberedEquations::Placed<T>> placed_;
  OneMotion<T> motion_;
  bool has_motion_ = false;
};

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

// P along e at a point, in the one motion t:  P e . v + (power of loads and elements) = 0.
template <class T>
T QuantityPlace<T>::push(const SoughtQuantity& of) {
  if (motion().rates.empty()) return undefined();
  std::vector<T> applied(motion().rates.size(), T(0));
  equations_.push_applied(bodies(), placed_, applied.data());
  const std::vector<T> along_x = equations_.measure_gradient(Measure::x_of(of.point), bodies(), placed_);
  const std::vector<T> along_y = equations_.measure_gradient(Measure::y_of(of.point), bodies(), placed_);
  const T rate = T(of.direction.x) * along_motion(along_x) + T(of.direction.y) * along_motion(along_y);
  return -along_motion(applied) / rate;
}

template <class T>
T QuantityPlace<T>::ratio(const SoughtQuantity& of) {
  if (motion().rates.empty()) return undefined();
  const T a = along_motion(equations_.measure_gradient(of.of[0].on, bodies(), placed_));
  const T b = along_motion(equations_.measure_gradient(of.of[1].on, bodies(), placed_));
  return a / b;
}

template <class T>
T QuantityPlace<T>::value(const SoughtQuantity& of) {
  using Kind = SoughtQuantity::Kind;
  switch (of.kind) {
    case Kind::measure:
      return bodies().value(of.on);
    case Kind::element_force:
      return bodies().element_force(of.item);
    case Kind::energy:
      return bodies().energy();
    case Kind::stop_reaction:
      return stop_reaction(of.item);
    case Kind::reaction:
      return reaction(of);
    case Kind::push:
      return push(of);
    case Kind::ratio:
      return ratio(of);
    case Kind::number:
      return T(of.constant);
    case Kind::sum:
      return value(of.of[0]) + value(of.of[1]);
    case Kind::difference:
      return value(of.of[0]) - value(of.of[1]);
    case Kind::product:
      return value(of.of[0]) * value(of.of[1]);
    case Kind::quotient:
      return value(of.of[0]) / value(of.of[1]);
    case Kind::load_at_fold:
      break;
  }
  return undefined();
}

/// Value of a quantity at z and its derivatives, in the units of the equations' scene.
struct QuantityGradient {
  double value = 0.0;
  Eigen::VectorXd by_unknowns, by_numbers;
};
QuantityGradient gradient_of(const SoughtQuantity& of, const NumberedEquations& equations,
                             const std::vector<double>& numbers, const std::vector<double>& z);

/// Why a quantity has no value there, in one sentence; empty where it has one. `driven` as of QuantityPlace.
std::string why_undefined(const SoughtQuantity& of, const NumberedEquations& equations, const std::vector<double>& z,
                          int driven = -1);

}  // namespace poise

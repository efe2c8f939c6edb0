#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "model/input_error.hpp"
#include "model/laws/law_force.hpp"
#include "model/number.hpp"
#include "model/select.hpp"

namespace poise {

/// What a controller knows at an instant, in the units of the scene; its states are in SI in every scene.
template <class S>
struct ControlSignals {
  S value{};     ///< y: what it reads, a measure or the rate of one
  S rate{};      ///< y', of a measure
  S integral{};  ///< s
  S place{};     ///< the integral of x
  S filtered{};  ///< x
};

/// What follows from these.
template <class S>
struct ControlOutputs {
  S effort{};     ///< u, positive if it tends to increase the measure that it acts on: N or N m
  S integral{};   ///< s'
  S filtered{};   ///< x'
  S unlimited{};  ///< u without its limits
};

/// A number and its derivative along one direction.
template <class S>
struct Tangent {
  S value{}, slope{};

  Tangent() = default;
  Tangent(const S& of) : value(of), slope(0) {}
  Tangent(const S& of, const S& along) : value(of), slope(along) {}

  friend Tangent operator+(const Tangent& a, const Tangent& b) { return {a.value + b.value, a.slope + b.slope}; }
  friend Tangent operator-(const Tangent& a, const Tangent& b) { return {a.value - b.value, a.slope - b.slope}; }
  friend Tangent operator-(const Tangent& a) { return {-a.value, -a.slope}; }
  friend Tangent operator*(const Tangent& a, const Tangent& b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
  friend Tangent operator/(const Tangent& a, const Tangent& b) {
    const S ratio = a.value / b.value;
    return {ratio, (a.slope - ratio * b.slope) / b.value};
  }
  friend auto operator<(const Tangent& a, const Tangent& b) { return a.value < b.value; }
  friend auto operator>(const Tangent& a, const Tangent& b) { return a.value > b.value; }
};

/// Of scalars in lanes.
template <int M, class S>
Tangent<S> select(const Mask<M>& condition, const Tangent<S>& a, const Tangent<S>& b) {
  return {select(condition, a.value, b.value), select(condition, a.slope, b.slope)};
}

/// A controller: the effort u on a measure by the error e = r - y of a signal y against its reference r, another
/// measure or the rate of one (Feedback). With d(e) the error without its dead band,
///   v = kp d(e) + ki s - kd y' + G d(e),   u = v between min and max,
///   s' = d(e) + (u - v) / (ki Tt),
/// where y' is that of the signal itself, or of the signal behind a filter of the time constant Tf:
///   y' = (y - x) / Tf,   x' = y';
/// and G is a transfer function of first or second order,
///   (n0 + n1 p + n2 p^2) / (d0 + d1 p + d2 p^2):   of first order x' = (d(e) - d0 x) / d1, v = n0 x + n1 x',
/// of second order x'' for x' in the same way. Back-calculation with the tracking time Tt keeps s from running away
/// while u is limited (K. J. Astrom, L. Rundqwist, Integrator windup and how to avoid it, ACC 1989). All of it is
/// continuous: derivatives jump at the dead band and the limits.
///
/// The states s and x are the rates of two bodies that turn for themselves alone (Feedback), x behind the first order
/// of G the angle of the second.
template <class N>
struct ControllerOf {
  enum Id {
    proportional,
    integral,
    derivative,
    filter,
    reference,
    dead_band,
    min,
    max,
    tracking_time,
    numerator,
    denominator = numerator + 3,
    count = denominator + 3
  };
  std::array<N, count> values{};
  unsigned given = 1U << reference;                  ///< one bit for each of them that the controller has
  int order = 0;                                     ///< of G: 1 or 2, 0 without one
  bool of_rate = false;                              ///< whether y is the rate of the measure
  double unit = 1.0;                                 ///< y is y of SI times this: a power of two
  std::shared_ptr<const std::vector<Number>> all{};  ///< its numbers, those that are given

  bool has(int id) const { return (given >> id & 1U) != 0; }

  template <class P>
  ControllerOf<P> with(const P* p) const {
    ControllerOf<P> out;
    out.given = given;
    out.order = order;
    out.of_rate = of_rate;
    out.unit = unit;
    out.all = all;
    for (int id = 0; id < count; ++id) {
      if (has(id)) out.values[static_cast<std::size_t>(id)] = *p++;
    }
    return out;
  }

  template <class S>
  ControlOutputs<S> respond(const ControlSignals<S>& in) const {
    const auto number = [this](int id) { return S(values[static_cast<std::size_t>(id)]); };
    const S scale(unit), back(1.0 / unit);
    S error = number(reference) - in.value;
    if (has(dead_band)) {
      const S half = number(dead_band), lower = -half;
      const S beyond = select(error < lower, S(error - lower), S(0.0));
      error = select(error > half, S(error - half), beyond);
    }
    ControlOutputs<S> out;
    S v(0.0);
    if (has(proportional)) v = v + number(proportional) * error;
    if (has(integral)) v = v + number(integral) * (scale * in.integral);
    if (has(derivative)) {
      const S rate = has(filter) ? S((in.value - scale * in.filtered) / number(filter)) : in.rate;
      v = v - number(derivative) * rate;
      if (has(filter)) out.filtered = back * rate;
    }
    if (order > 0) {
      const S x = scale * in.filtered;
      const S below = order == 1 ? S(number(denominator) * x)
                                 : S(number(denominator) * (scale * in.place) + number(denominator + 1) * x);
      const S change = (error - below) / number(denominator + order);
      const std::array<S, 3> powers =
          order == 1 ? std::array<S, 3>{x, change, S(0.0)} : std::array<S, 3>{scale * in.place, x, change};
      for (int k = 0; k <= order; ++k) {
        if (has(numerator + k)) v = v + number(numerator + k) * powers[static_cast<std::size_t>(k)];
      }
      out.filtered = back * change;
    }
    out.unlimited = v;
    S u = v;
    if (has(max)) u = select(u > number(max), number(max), u);
    if (has(min)) u = select(u < number(min), number(min), u);
    out.effort = u;
    if (has(tracking_time)) error = error + (u - v) / (number(integral) * number(tracking_time));
    if (has(integral)) out.integral = back * error;
    return out;
  }

  /// The derivative of respond() by numbers()[number].
  template <class S>
  ControlOutputs<S> respond_by(int number, const ControlSignals<S>& in) const {
    std::vector<Tangent<S>> own;
    for (int id = 0; id < count; ++id) {
      if (has(id)) own.emplace_back(S(values[static_cast<std::size_t>(id)]));
    }
    own[static_cast<std::size_t>(number)].slope = S(1.0);
    return slopes(
        with(own.data()).respond(ControlSignals<Tangent<S>>{in.value, in.rate, in.integral, in.place, in.filtered}));
  }
  /// Its change where the signals change.
  template <class S>
  ControlOutputs<S> respond_along(const ControlSignals<S>& in, const ControlSignals<S>& change) const {
    return slopes(respond(ControlSignals<Tangent<S>>{{in.value, change.value},
                                                     {in.rate, change.rate},
                                                     {in.integral, change.integral},
                                                     {in.place, change.place},
                                                     {in.filtered, change.filtered}}));
  }
  template <class S>
  static ControlOutputs<S> slopes(const ControlOutputs<Tangent<S>>& of) {
    return {of.effort.slope, of.integral.slope, of.filtered.slope, of.unlimited.slope};
  }

  /// Its effort is no function of the measure that it acts on: see respond_by().
  template <class S>
  S force_by(int, const S&, const S&) const {
    return S(0.0);
  }

  std::string_view idle() const { return ""; }
  void rescale(double measure, double) { unit *= measure; }
  std::span<const Number> all_numbers() const {
    return all ? std::span<const Number>(*all) : std::span<const Number>();
  }

  /// Gives it the numbers of `given`, of a controller that reads an angle or a length and, of a transfer function, an
  /// `order`.
  void declare(bool reads_angle);

  static constexpr int affine_numbers = 0;
  static constexpr std::string_view left_out = "controllers are off in statics";
  static constexpr std::array tables{LawTable{"controller"}};
  static constexpr std::array<Number, 0> numbers{};
};

using Controller = ControllerOf<double>;

namespace detail {

/// Throws InputError where a number of a controller contradicts others; see controller.cpp.
void set_number_of_controller(Controller& controller, int id, double value);

}  // namespace detail

/// The number of this id, without its key and dimension.
template <int Id>
constexpr Number number_of_controller() {
  Number number{};
  number.get = [](const void* item) { return std::optional<double>(static_cast<const Controller*>(item)->values[Id]); };
  number.set = [](void* item, double value) {
    detail::set_number_of_controller(*static_cast<Controller*>(item), Id, value);
  };
  number.scale = [](void* item, double factor) { static_cast<Controller*>(item)->values[Id] *= factor; };
  return number;
}

template <>
void ControllerOf<double>::declare(bool reads_angle);

}  // namespace poise

#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "model/indexed_key.hpp"
#include "model/input_error.hpp"
#include "model/laws/force_curve.hpp"
#include "model/laws/law_force.hpp"
#include "model/number.hpp"
#include "model/select.hpp"

namespace poise {

/// What a controller knows at an instant, in the units of the scene; its states are in SI in every scene.
template <class S>
struct ControlSignals {
  S value{};     ///< y: what it reads, a measure or the rate of one, or what another controller gives
  S rate{};      ///< y', of a measure
  S followed{};  ///< what the controller that it follows adds to its reference
  S integral{};  ///< s
  S place{};     ///< the integral of x
  S filtered{};  ///< x
  /// What one with a period holds since its last sample: u, s', and what its filter or transfer function has; of one
  /// with a delay the u that it gives.
  S held_effort{}, held_integral{}, held_input{};

  /// The same in another scalar: use(member of these) of each.
  template <class P, class Use>
  ControlSignals<P> each(Use use) const {
    using M = S ControlSignals::*;
    const auto of = [&](M member) { return use(member); };
    return {of(&ControlSignals::value),       of(&ControlSignals::rate),          of(&ControlSignals::followed),
            of(&ControlSignals::integral),    of(&ControlSignals::place),         of(&ControlSignals::filtered),
            of(&ControlSignals::held_effort), of(&ControlSignals::held_integral), of(&ControlSignals::held_input)};
  }
};

/// What follows from these.
template <class S>
struct ControlOutputs {
  S effort{};     ///< u, positive if it tends to increase the measure that it acts on: N or N m
  S integral{};   ///< s'
  S filtered{};   ///< x'
  S unlimited{};  ///< u without its limits
  S input{};      ///< what its filter or transfer function has: y, or d(e), in SI
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

template <class S>
inline constexpr bool is_tangent = false;
template <class S>
inline constexpr bool is_tangent<Tangent<S>> = true;

/// Of scalars in lanes.
template <int M, class S>
Tangent<S> select(const Mask<M>& condition, const Tangent<S>& a, const Tangent<S>& b) {
  return {select(condition, a.value, b.value), select(condition, a.slope, b.slope)};
}

/// A controller: the effort u on a measure by the error e = r - y of a signal y against its reference r, another
/// measure or the rate of one (Feedback), or a signal u that other controllers read. With d(e) the error without its
/// dead band and F a curve through points (ForceCurve),
///   v = kp d(e) + ki s - kd y' + G d(e) + F(d(e)),   u = v between min and max,
///   s' = d(e) + (u - v) / (ki Tt),
/// where y' is that of the signal itself, or of the signal behind a filter of the time constant Tf:
///   y' = (y - x) / Tf,   x' = y';
/// and G is a transfer function of first or second order,
///   (n0 + n1 p + n2 p^2) / (d0 + d1 p + d2 p^2):   of first order x' = (d(e) - d0 x) / d1, v = n0 x + n1 x',
/// of second order x'' for x' in the same way. Back-calculation with the tracking time Tt keeps s from running away
/// while u is limited (K. J. Astrom, L. Rundqwist, Integrator windup and how to avoid it, ACC 1989). All of it is
/// continuous: derivatives jump at the dead band and the limits.
///
/// With a period T it decides at the times k T alone: what it has there, u, s' and the input of its filter or transfer
/// function, it holds until the next one, so that s and x at these times are those of the exact zero-order hold.
///
/// With a delay T it gives at t the u that it decided at t - T; s and x are those of the time itself.
///
/// The states s and x are the rates of two bodies that turn for themselves alone (Feedback), x behind the first order
/// of G the angle of the second; what is held or delayed is the rate of one more body each, in SI.
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
    period,
    delay,
    numerator,
    denominator = numerator + 3,
    count = denominator + 3
  };
  std::array<N, count> values{};
  unsigned given = 1U << reference;                  ///< one bit for each of them that the controller has
  int order = 0;                                     ///< of G: 1 or 2, 0 without one
  bool of_rate = false;                              ///< whether y is the rate of the measure
  double unit = 1.0;                                 ///< y is y of SI times this: a power of two
  double effort_unit = 1.0;                          ///< u is u of SI times this
  std::shared_ptr<const ForceCurve> curve{};         ///< F, or null
  const N* curve_values = nullptr;                   ///< of its points, where these are numbers of another scalar
  bool numbered_points = false;                      ///< whether each of these is a number
  std::shared_ptr<const std::vector<Number>> all{};  ///< its numbers, those that are given

  static constexpr std::size_t most_points = 64;

  bool has(int id) const { return (given >> id & 1U) != 0; }
  /// Whether what it gives is a state of its own.
  bool holds() const { return has(period) || has(delay); }
  /// Whether u depends on y and the reference of the same instant, not on states alone: of a controller with a period
  /// at its samples.
  bool decides_at_once() const {
    if (has(delay)) return false;
    return has(proportional) || has(derivative) || curve != nullptr || (order > 0 && has(numerator + order));
  }
  /// The same at any instant.
  bool is_direct() const { return !has(period) && decides_at_once(); }
  int plain_numbers() const { return std::popcount(given); }
  std::size_t numbers_of_points() const { return numbered_points ? curve->points() : 0; }

  template <class P>
  ControllerOf<P> with(const P* p) const {
    ControllerOf<P> out;
    out.given = given;
    out.order = order;
    out.of_rate = of_rate;
    out.unit = unit;
    out.effort_unit = effort_unit;
    out.curve = curve;
    out.numbered_points = numbered_points;
    out.all = all;
    for (int id = 0; id < count; ++id) {
      if (has(id)) out.values[static_cast<std::size_t>(id)] = *p++;
    }
    if constexpr (std::is_same_v<P, double>) {
      for (std::size_t k = 0; k < numbers_of_points(); ++k) out.set_point(k, p[k]);
    } else if constexpr (!is_tangent<P>) {
      if (numbered_points) out.curve_values = p;
    }
    return out;
  }
  /// All its numbers as they are.
  std::vector<N> all_values() const {
    std::vector<N> out;
    for (int id = 0; id < count; ++id) {
      if (has(id)) out.push_back(values[static_cast<std::size_t>(id)]);
    }
    for (std::size_t k = 0; k < numbers_of_points(); ++k) {
      out.push_back(curve_values != nullptr ? curve_values[k] : N(curve->forces()[k]));
    }
    return out;
  }
  void set_point(std::size_t point, double value) {
    if (curve->forces()[point] != value) curve = std::make_shared<const ForceCurve>(curve->with_force(point, value));
  }

  /// What it does: with a period or a delay by what it holds.
  template <class S>
  ControlOutputs<S> respond(const ControlSignals<S>& in) const {
    return respond(in, S(0.0));
  }
  /// What it decides by what it knows: what it does, with a period what it holds from a sample on, with a delay what it
  /// gives later.
  template <class S>
  ControlOutputs<S> decide(const ControlSignals<S>& in) const {
    return decide(in, S(0.0));
  }

  /// The derivatives of respond() and decide() by numbers()[number].
  template <class S>
  ControlOutputs<S> respond_by(int number, const ControlSignals<S>& in) const {
    return by_number(number, in,
                     [](const auto& law, const auto& at, const auto& more) { return law.respond(at, more); });
  }
  template <class S>
  ControlOutputs<S> decide_by(int number, const ControlSignals<S>& in) const {
    return by_number(number, in,
                     [](const auto& law, const auto& at, const auto& more) { return law.decide(at, more); });
  }
  /// Their changes where the signals change.
  template <class S>
  ControlOutputs<S> respond_along(const ControlSignals<S>& in, const ControlSignals<S>& change) const {
    return slopes(respond(tangents(in, change)));
  }
  template <class S>
  ControlOutputs<S> decide_along(const ControlSignals<S>& in, const ControlSignals<S>& change) const {
    return slopes(decide(tangents(in, change)));
  }
  template <class S>
  static ControlSignals<Tangent<S>> tangents(const ControlSignals<S>& in, const ControlSignals<S>& change) {
    return in.template each<Tangent<S>>([&](auto member) { return Tangent<S>(in.*member, change.*member); });
  }

  /// d(e).
  template <class S>
  S beyond_dead_band(const S& error) const {
    if (!has(dead_band)) return error;
    const S half = number_of<S>(dead_band), lower = -half;
    const S beyond = select(error < lower, S(error - lower), S(0.0));
    return select(error > half, S(error - half), beyond);
  }

  /// Its effort is no function of the measure that it acts on: see respond_by().
  template <class S>
  S force_by(int, const S&, const S&) const {
    return S(0.0);
  }

  std::string_view idle() const { return ""; }
  void rescale(double measure, double effort) {
    unit *= measure;
    effort_unit *= effort;
    if (curve) curve = std::make_shared<const ForceCurve>(curve->rescaled(measure, effort));
  }
  std::span<const Number> all_numbers() const {
    return all ? std::span<const Number>(*all) : std::span<const Number>();
  }

  /// Gives it the numbers of `given`, its curve and, of a transfer function, an `order`: y has the dimension `read`,
  /// and u that of the effort on what it acts on, or `output` where it acts on nothing.
  void declare(const Dimension& read, bool acts, const Dimension& output);

  static constexpr int affine_numbers = 0;
  static constexpr std::string_view left_out = "controllers are off in statics";
  static constexpr std::array tables{LawTable{"controller"}};
  static constexpr std::array<Number, 0> numbers{};

 private:
  template <class>
  friend struct ControllerOf;

  template <class S>
  S number_of(int id) const {
    return S(values[static_cast<std::size_t>(id)]);
  }

  template <class S>
  S along_curve(const S& error) const {
    if constexpr (is_tangent<S>) {
      const auto [value, slope] = curve->force(error.value);
      return S(value, slope * error.slope);
    } else if constexpr (!std::is_same_v<N, double>) {
      if (curve_values != nullptr) return CurveThrough<N>(curve->x(), curve_values).force(error).first;
    }
    if constexpr (!is_tangent<S>) return curve->force(error).first;
  }

  /// x', where x has this input in SI: the signal itself of a filter, or d(e).
  template <class S>
  S change_of_state(const ControlSignals<S>& in, const S& input) const {
    if (order == 0) return (input - in.filtered) / number_of<S>(filter);
    const S below = order == 1 ? S(number_of<S>(denominator) * in.filtered)
                               : S(number_of<S>(denominator) * in.place + number_of<S>(denominator + 1) * in.filtered);
    return (input - below) / number_of<S>(denominator + order);
  }
  bool has_state() const { return order > 0 || has(filter); }

  template <class S>
  ControlOutputs<S> respond(const ControlSignals<S>& in, const S& more) const {
    ControlOutputs<S> out;
    if (!has(period)) {
      out = decide(in, more);
      if (has(delay)) out.effort = S(effort_unit) * in.held_effort;
      return out;
    }
    out.effort = out.unlimited = S(effort_unit) * in.held_effort;
    if (has(integral)) out.integral = in.held_integral;
    if (has_state()) out.filtered = change_of_state(in, in.held_input);
    return out;
  }

  // `more` is added to v.
  template <class S>
  ControlOutputs<S> decide(const ControlSignals<S>& in, const S& more) const {
    const S scale(unit), back(1.0 / unit);
    S error = beyond_dead_band(S(number_of<S>(reference) + in.followed - in.value));
    ControlOutputs<S> out;
    S v = more;
    if (has(proportional)) v = v + number_of<S>(proportional) * error;
    if (has(integral)) v = v + number_of<S>(integral) * (scale * in.integral);
    if (curve) v = v + along_curve(error);
    if (has_state()) {
      out.input = back * (order > 0 ? error : in.value);
      out.filtered = change_of_state(in, out.input);
    }
    if (has(derivative)) v = v - number_of<S>(derivative) * (has(filter) ? S(scale * out.filtered) : in.rate);
    if (order > 0) {
      const S x = scale * in.filtered, change = scale * out.filtered;
      const std::array<S, 3> powers =
          order == 1 ? std::array<S, 3>{x, change, S(0.0)} : std::array<S, 3>{scale * in.place, x, change};
      for (int k = 0; k <= order; ++k) {
        if (has(numerator + k)) v = v + number_of<S>(numerator + k) * powers[static_cast<std::size_t>(k)];
      }
    }
    out.unlimited = v;
    S u = v;
    if (has(max)) u = select(u > number_of<S>(max), number_of<S>(max), u);
    if (has(min)) u = select(u < number_of<S>(min), number_of<S>(min), u);
    out.effort = u;
    if (has(tracking_time)) error = error + (u - v) / (number_of<S>(integral) * number_of<S>(tracking_time));
    if (has(integral)) out.integral = back * error;
    return out;
  }

  template <class S, class Use>
  ControlOutputs<S> by_number(int number, const ControlSignals<S>& in, Use use) const {
    std::vector<Tangent<S>> own;
    for (int id = 0; id < count; ++id) {
      if (has(id)) own.emplace_back(S(values[static_cast<std::size_t>(id)]));
    }
    Tangent<S> more(S(0.0));
    if (number < plain_numbers()) {
      own[static_cast<std::size_t>(number)].slope = S(1.0);
    } else {
      const S error = beyond_dead_band(S(number_of<S>(reference) + in.followed - in.value));
      more.slope = curve->force_by(static_cast<std::size_t>(number - plain_numbers()), error);
    }
    return slopes(use(with(own.data()), tangents(in, ControlSignals<S>{}), more));
  }

  template <class S>
  static ControlOutputs<S> slopes(const ControlOutputs<Tangent<S>>& of) {
    return {of.effort.slope, of.integral.slope, of.filtered.slope, of.unlimited.slope, of.input.slope};
  }
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
void ControllerOf<double>::declare(const Dimension& read, bool acts, const Dimension& output);

}  // namespace poise

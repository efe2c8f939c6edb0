#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "model/input_error.hpp"
#include "model/laws/law_force.hpp"
#include "model/laws/powers.hpp"
#include "model/number.hpp"
#include "model/plain_value.hpp"

namespace poise {

/// Stop that yields (K. H. Hunt, F. R. E. Crossley, "Coefficient of restitution interpreted as damping in vibroimpact",
/// J. Appl. Mech. 42, 1975): at the depth d beyond min or max, d = g - max or min - g, it pushes back with
///   F = k u (d/u)^n (1 + a d')  where that is positive, else 0,  V = k u^2 (d/u)^(n + 1) / (n + 1),
/// where u is the unit of g in the scene file: there the number k is the force at d = 1. It never pulls. At rest
/// F = k u (d/u)^n.
template <class N>
struct CompliantStopOf {
  N min = N(0), max = N(0);  ///< m or rad, where it has them
  N stiffness = N(0);        ///< k: N/m or N m/rad
  N damping = N(0);          ///< a: s/m or s/rad
  N exponent = N(1);         ///< n
  bool has_min = false, has_max = true;
  double unit = 1.0;  ///< u: m or rad

  template <class P>
  CompliantStopOf<P> with(const P* p) const {
    CompliantStopOf<P> out;
    out.has_min = has_min;
    out.has_max = has_max;
    out.unit = unit;
    if (has_min) out.min = *p++;
    out.stiffness = p[0];
    out.damping = p[1];
    out.exponent = p[2];
    if (has_max) out.max = p[3];
    return out;
  }

  template <class S>
  auto slack(const S& g) const {
    using Condition = decltype(g <= S(max));
    return (has_max ? g <= S(max) : Condition(true)) && (has_min ? g >= S(min) : Condition(true));
  }

  template <class S>
  S energy(const S& g) const {
    return on_sides<S>(g, [&](const S& depth, double) { return force(depth) * depth / (S(exponent) + S(1)); });
  }

  template <class S>
  LawForce<S> at_rest(const S& g) const {
    return on_sides<LawForce<S>>(g, [&](const S& depth, double side) {
      return LawForce<S>{S(side) * force(depth), slope(depth), S(0)};
    });
  }

  template <class S>
  LawForce<S> resisting(const S& g, const S& rate) const {
    return on_sides<LawForce<S>>(g, [&](const S& depth, double side) {
      const LawForce<S> part = damping_part(S(S(side) * rate));
      const S whole = force(depth);
      return LawForce<S>{S(side) * whole * part.value, slope(depth) * part.value, whole * part.by_rate};
    });
  }

  template <class S>
  S force_by(int number, const S& g, const S& rate) const {
    const int id = has_min ? number : number + 1;
    return on_sides<S>(g, [&](const S& depth, double side) -> S {
      const LawForce<S> part = damping_part(S(S(side) * rate));
      const S whole = S(1) + part.value;
      switch (id) {
        case 0:
          return side < 0 ? S(-slope(depth) * whole) : S(0);
        case 1:
          return S(side) * power(depth) * S(unit) * whole;
        case 2:
          return S(side) * force(depth) * damping_part_by_damping(S(S(side) * rate));
        case 3:
          return S(side) * force(depth) * log_of(S(depth / S(unit))) * whole;
        default:
          return side > 0 ? S(-slope(depth) * whole) : S(0);
      }
    });
  }

  std::vector<N> measure_borders() const {
    std::vector<N> out;
    if (has_min) out.push_back(min);
    if (has_max) out.push_back(max);
    return out;
  }
  std::vector<N> rate_borders() const {
    std::vector<N> out;
    if (has_min) out.push_back(N(1) / damping);
    if (has_max) out.push_back(N(-1) / damping);
    return out;
  }

  /// Throws InputError unless it may have these limits.
  void expect_limits(double lower, double upper) const {
    if (has_min && has_max && !(lower <= upper)) {
      throw InputError("expected min <= max; set the other limit first");
    }
  }

  double force_scale(double change) const { return stiffness * change; }

  std::string_view idle() const { return stiffness == 0.0 ? "its stiffness is zero" : ""; }

  bool damps_small_motion() const { return !is_just(damping, 0.0); }

  void rescale(double measure, double) { unit *= measure; }

  // T is affine in the stiffness alone, which is not always the first.
  static constexpr int affine_numbers = 0;
  // Tables [[stop]] are read as such where they have a stiffness.
  static constexpr std::array<LawTable, 0> tables{};
  static const std::array<Number, 5> numbers;
  std::span<const Number> all_numbers() const;

 private:
  // The sum of f(depth, side) of the sides that it has, side 1 beyond max and -1 beyond min, zero of its kind inside.
  template <class Out, class S, class F>
  Out on_sides(const S& g, F f) const {
    const auto side_of = [&](const S& beyond, double side) -> Out {
      return by_pieces(beyond, std::array{0.0},
                       [&](std::size_t piece, const S& depth) { return piece == 0 ? Out{} : Out(f(depth, side)); });
    };
    Out out{};
    if (has_max) out = side_of(S(g - S(max)), 1.0);
    if (!has_min) return out;
    const Out lower = side_of(S(S(min) - g), -1.0);
    return has_max ? sum(out, lower) : lower;
  }
  template <class S>
  static S sum(const S& a, const S& b) {
    return a + b;
  }
  template <class S>
  static LawForce<S> sum(const LawForce<S>& a, const LawForce<S>& b) {
    return {a.value + b.value, a.by_measure + b.by_measure, a.by_rate + b.by_rate};
  }

  // (d/u)^n, and the force and its slope.
  template <class S>
  S power(const S& depth) const {
    const S x = depth / S(unit);
    return is_just(exponent, 1.0) ? x : power_of(x, S(exponent));
  }
  template <class S>
  S force(const S& depth) const {
    return S(stiffness) * S(unit) * power(depth);
  }
  template <class S>
  S slope(const S& depth) const {
    if (is_just(exponent, 1.0)) return S(stiffness);
    return S(stiffness) * S(exponent) * power_of(S(depth / S(unit)), S(S(exponent) - S(1)));
  }

  // a d', and -1 where that is less, with its derivatives by d' and by a.
  template <class S>
  LawForce<S> damping_part(const S& inwards) const {
    return by_pieces(S(S(damping) * inwards), std::array{-1.0}, [&](std::size_t piece, const S& part) {
      return piece == 0 ? LawForce<S>{S(-1), S(0), S(0)} : LawForce<S>{part, S(0), S(damping)};
    });
  }
  template <class S>
  S damping_part_by_damping(const S& inwards) const {
    return by_pieces(S(S(damping) * inwards), std::array{-1.0},
                     [&](std::size_t piece, const S&) { return piece == 0 ? S(0) : inwards; });
  }
};

using CompliantStop = CompliantStopOf<double>;

template <>
inline constexpr std::array<Number, 5> CompliantStopOf<double>::numbers = [] {
  Number lower = plain_number<&CompliantStop::min>("min", {});
  lower.measure_power = 1;
  lower.range_of_measure = true;
  lower.set = [](void* item, double value) {
    auto& stop = *static_cast<CompliantStop*>(item);
    stop.expect_limits(value, stop.max);
    stop.min = value;
  };
  Number k = plain_number<&CompliantStop::stiffness>("stiffness", {}, Range::not_negative);
  k.effort_power = 1;
  k.measure_power = -1;
  k.needed = Number::Needed::always;
  Number a = plain_number<&CompliantStop::damping>("damping", dimension::time, Range::not_negative);
  a.measure_power = -1;
  Number n = plain_number<&CompliantStop::exponent>("exponent", {}, Range::positive);
  n.set = [](void* item, double value) {
    if (!(value >= 1.0)) throw InputError("expected an exponent of at least 1; 1.5 is that of round bodies");
    static_cast<CompliantStop*>(item)->exponent = value;
  };
  Number upper = lower;
  upper.key = "max";
  upper.get = [](const void* item) { return std::optional<double>(static_cast<const CompliantStop*>(item)->max); };
  upper.set = [](void* item, double value) {
    auto& stop = *static_cast<CompliantStop*>(item);
    stop.expect_limits(stop.min, value);
    stop.max = value;
  };
  upper.scale = [](void* item, double factor) { static_cast<CompliantStop*>(item)->max *= factor; };
  return std::array{lower, k, a, n, upper};
}();

template <>
inline std::span<const Number> CompliantStopOf<double>::all_numbers() const {
  const std::span<const Number> all(numbers);
  return all.subspan(has_min ? 0 : 1, (has_min ? 1 : 0) + 3 + (has_max ? 1 : 0));
}

}  // namespace poise

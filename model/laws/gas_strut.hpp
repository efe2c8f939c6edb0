#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "model/input_error.hpp"
#include "model/laws/law_force.hpp"
#include "model/number.hpp"

namespace poise {

/// Gas strut by the numbers of its data sheet: it pushes with the force F at the length L, where its rod is out, and
/// with r F where the rod is in by the stroke s. Its gas obeys p V^n = constant, n = 1 if it moves slowly (isothermal)
/// up to 1.4 if fast (adiabatic), and the rod takes a part of its volume that is proportional to u = L - g:
///   T = -F f(u/s),  f(y) = (1 - b y)^-n,  b = 1 - r^(-1/n), the part that the whole stroke takes,
///   V = F s I(u/s),  I(y) = e G((n - 1) e) / b,  e = -ln(1 - b y),  G(c) = (exp(c) - 1)/c,
/// which for n = 1 is the logarithm (G = 1). Beyond its stroke, 0 <= y <= 1, f goes on along its tangents.
/// Its oil damps, and more so over the last part s_e of the way out, at whose end the rod is out:
///   T = (c + c_e max(0, min(1, 1 - u/s_e))) dg/dt  more.
template <class N>
struct GasStrutOf {
  N preload = N(0);   ///< F: N
  N length = N(1);    ///< L: m
  N stroke = N(1);    ///< s: m
  N ratio = N(1.3);   ///< r
  N exponent = N(1);  ///< n
  bool damps = false;
  N damping = N(0);      ///< c: N s/m, if it damps
  N end_damping = N(0);  ///< c_e: N s/m
  N end_stroke = N(1);   ///< s_e: m

  template <class P>
  GasStrutOf<P> with(const P* p) const {
    GasStrutOf<P> out{p[0], p[1], p[2], p[3], p[4], damps};
    if (!damps) return out;
    out.damping = p[5];
    out.end_damping = p[6];
    out.end_stroke = p[7];
    return out;
  }

  template <class S>
  S energy(const S& g) const {
    const Gas<S> gas(*this);
    return S(preload) * S(stroke) * along(g, [&](std::size_t k, const S& y) { return gas.work(k, y); });
  }

  template <class S>
  LawForce<S> at_rest(const S& g) const {
    const Gas<S> gas(*this);
    const LawForce<S> push = along(g, [&](std::size_t k, const S& y) {
      return LawForce<S>{gas.force(k, y), gas.slope(k, y), S(0)};
    });
    return {-S(preload) * push.value, S(preload) / S(stroke) * push.by_measure, S(0)};
  }

  template <class S>
  LawForce<S> resisting(const S& g, const S& rate) const {
    if (!damps) return {};
    const LawForce<S> end = near_its_end(g);
    const S coefficient = S(damping) + S(end_damping) * end.value;
    return {coefficient * rate, S(end_damping) * end.by_measure * rate, coefficient};
  }

  template <class S>
  S force_by(int number, const S& g, const S& rate) const {
    if (number == 5) return rate;
    if (number >= 6) {
      const LawForce<S> end = near_its_end(g);
      return number == 6 ? S(end.value * rate)
                         : S(S(end_damping) * end.by_measure * (S(length) - g) / S(end_stroke) * rate);
    }
    const S of_gas = force_of_gas_by(number, g);
    return number == 1 && damps ? S(of_gas - resisting(g, rate).by_measure) : of_gas;
  }

  std::vector<N> measure_borders() const {
    std::vector<N> out{length - stroke, length};
    if (damps) out.push_back(length - end_stroke);
    return out;
  }

  double force_scale(double) const { return preload * ratio; }

  std::string_view idle() const { return preload == 0.0 ? "its preload is zero" : ""; }

  bool damps_small_motion() const { return damps; }

  static constexpr int affine_numbers = 1;
  static constexpr std::array tables{LawTable{"spring", false, "gas"}};
  static const std::array<Number, 5> numbers;
  /// The numbers that one that damps has behind these.
  static const std::array<Number, 3> numbers_of_damping;
  std::span<const Number> all_numbers() const;

 private:
  template <class S>
  S force_of_gas_by(int number, const S& g) const {
    const Gas<S> gas(*this);
    return along(g, [&](std::size_t k, const S& y) -> S {
      switch (number) {
        case 0:
          return -gas.force(k, y);
        case 1:
          return -S(preload) / S(stroke) * gas.slope(k, y);
        case 2:
          return S(preload) / S(stroke) * y * gas.slope(k, y);
        case 3:
          return -S(preload) * gas.force_by_ratio(k, y);
        default:
          return -S(preload) * gas.force_by_exponent(k, y);
      }
    });
  }

  template <class S, class Piece>
  auto along(const S& g, Piece piece) const {
    return by_pieces(S((S(length) - g) / S(stroke)), std::array{0.0, 1.0}, piece);
  }

  // How far it is in the last part of the way out, 0 to 1, and the slope of that.
  template <class S>
  LawForce<S> near_its_end(const S& g) const {
    const S part = S(1) - (S(length) - g) / S(end_stroke);
    return by_pieces(part, std::array{0.0, 1.0}, [&](std::size_t k, const S& y) {
      return k == 1 ? LawForce<S>{y, S(1) / S(end_stroke), S(0)} : LawForce<S>{S(k == 0 ? 0 : 1), S(0), S(0)};
    });
  }

  /// f, f', I and their derivatives by r and n: in piece 0 before the stroke, 1 in it, 2 behind it.
  template <class S>
  struct Gas {
    explicit Gas(const GasStrutOf& strut)
        : r_(strut.ratio), n_(strut.exponent), log_r_(log_of_one_plus(S(r_ - S(1)))), b_(-grown(S(-log_r_ / n_))) {}

    S force(std::size_t piece, const S& y) const {
      using std::exp;
      if (piece == 0) return S(1) + n_ * b_ * y;
      if (piece == 2) return r_ + last_slope() * (y - S(1));
      return exp(n_ * e(y));
    }
    S slope(std::size_t piece, const S& y) const {
      using std::exp;
      if (piece == 0) return n_ * b_;
      if (piece == 2) return last_slope();
      return n_ * b_ * exp((n_ + S(1)) * e(y));
    }
    S work(std::size_t piece, const S& y) const {
      if (piece == 0) return y + n_ * b_ * y * y / S(2);
      if (piece == 2) {
        const S beyond = y - S(1);
        return work(1, S(1)) + (r_ + last_slope() * beyond / S(2)) * beyond;
      }
      return e(y) * mean_exp(S((n_ - S(1)) * e(y))) / b_;
    }

    S force_by_ratio(std::size_t piece, const S& y) const {
      if (piece == 0) return n_ * y * b_by_ratio();
      if (piece == 2) return S(1) + last_slope_by_ratio() * (y - S(1));
      return force_by_b(y) * b_by_ratio();
    }
    S force_by_exponent(std::size_t piece, const S& y) const {
      if (piece == 0) return (b_ + n_ * b_by_exponent()) * y;
      if (piece == 2) return last_slope_by_exponent() * (y - S(1));
      return e(y) * force(1, y) + force_by_b(y) * b_by_exponent();
    }

   private:
    S e(const S& y) const { return -log_of_one_plus(S(-b_ * y)); }
    S b_by_ratio() const { return (S(1) - b_) / (n_ * r_); }
    S b_by_exponent() const { return -(S(1) - b_) * log_r_ / (n_ * n_); }
    S force_by_b(const S& y) const { return y / b_ * slope(1, y); }

    // f' at the end of the stroke, n r (r^(1/n) - 1).
    S last_slope() const { return n_ * b_ * r_ / (S(1) - b_); }
    S last_slope_by_ratio() const { return last_slope() / r_ + S(1) / (S(1) - b_); }
    S last_slope_by_exponent() const { return last_slope() / n_ - r_ * log_r_ / (n_ * (S(1) - b_)); }

    static S log_of_one_plus(const S& x) {
      using std::log;
      using std::log1p;
      if constexpr (std::is_same_v<LaneOf<S>, double>) {
        return log1p(x);
      } else {
        return log(S(1) + x);
      }
    }

    // exp(x) - 1.
    static S grown(const S& x) {
      using std::exp;
      using std::expm1;
      if constexpr (std::is_same_v<LaneOf<S>, double>) {
        return expm1(x);
      } else {
        return exp(x) - S(1);
      }
    }

    // (exp(c) - 1) / c.
    static S mean_exp(const S& c) {
      using std::exp;
      return choose(
          c > S(1) || c < S(-1), [&] { return S((exp(c) - S(1)) / c); }, [&] { return mean_exp_near_zero(c); });
    }
    static S mean_exp_near_zero(const S& c) {
      using std::exp;
      if constexpr (may_enclose_set<S>) {
        return hull(S(1), exp(c));
      } else {
        constexpr int terms = std::numeric_limits<S>::digits > std::numeric_limits<double>::digits ? 42 : 18;
        S sum(0), term(1);
        for (int k = 0; k <= terms; ++k) {
          sum += term / S(k + 1);
          term *= c / S(k + 1);
        }
        return sum;
      }
    }

    S r_, n_, log_r_, b_;
  };
};

using GasStrut = GasStrutOf<double>;

namespace gas_numbers {

inline constexpr std::array<Number, 8> all = [] {
  Number F = plain_number<&GasStrut::preload>("gas.preload", {}, Range::not_negative);
  F.effort_power = 1;
  F.needed = Number::Needed::always;
  Number L = plain_number<&GasStrut::length>("gas.length", {});
  L.measure_power = 1;
  L.range_of_measure = true;
  L.needed = Number::Needed::always;
  Number s = plain_number<&GasStrut::stroke>("gas.stroke", {}, Range::positive);
  s.measure_power = 1;
  s.needed = Number::Needed::always;
  Number r = plain_number<&GasStrut::ratio>("gas.ratio", {}, Range::positive);
  r.needed = Number::Needed::always;
  r.set = [](void* item, double value) {
    if (!(value > 1.0)) {
      throw InputError(
          "expected a ratio above 1, the force with the rod in over that with the rod out; a force that stays the same "
          "is a constant_force");
    }
    static_cast<GasStrut*>(item)->ratio = value;
  };
  Number n = plain_number<&GasStrut::exponent>("gas.exponent", {}, Range::positive);
  Number c = plain_number<&GasStrut::damping>("gas.damping", dimension::time, Range::not_negative);
  c.effort_power = 1;
  c.measure_power = -1;
  Number ce = c;
  ce.key = "gas.end_damping";
  ce.get = [](const void* item) { return std::optional<double>(static_cast<const GasStrut*>(item)->end_damping); };
  ce.set = [](void* item, double value) { static_cast<GasStrut*>(item)->end_damping = value; };
  ce.scale = [](void* item, double factor) { static_cast<GasStrut*>(item)->end_damping *= factor; };
  Number se = plain_number<&GasStrut::end_stroke>("gas.end_stroke", {}, Range::positive);
  se.measure_power = 1;
  return std::array{F, L, s, r, n, c, ce, se};
}();

}  // namespace gas_numbers

template <>
inline constexpr std::array<Number, 5> GasStrutOf<double>::numbers{
    gas_numbers::all[0], gas_numbers::all[1], gas_numbers::all[2], gas_numbers::all[3], gas_numbers::all[4]};
template <>
inline constexpr std::array<Number, 3> GasStrutOf<double>::numbers_of_damping{gas_numbers::all[5], gas_numbers::all[6],
                                                                              gas_numbers::all[7]};
template <>
inline std::span<const Number> GasStrutOf<double>::all_numbers() const {
  return std::span(gas_numbers::all).first(damps ? 8 : 5);
}

}  // namespace poise

#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <type_traits>

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
template <class N>
struct GasStrutOf {
  N preload = N(0);   ///< F: N
  N length = N(1);    ///< L: m
  N stroke = N(1);    ///< s: m
  N ratio = N(1.3);   ///< r
  N exponent = N(1);  ///< n

  template <class P>
  GasStrutOf<P> with(const P* p) const {
    return {p[0], p[1], p[2], p[3], p[4]};
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
  S force_by(int number, const S& g, const S&) const {
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

  double force_scale(double) const { return preload * ratio; }

  std::string_view idle() const { return preload == 0.0 ? "its preload is zero" : ""; }

  static constexpr int affine_numbers = 1;
  static constexpr std::array tables{LawTable{"spring", false, "gas"}};
  static const std::array<Number, 5> numbers;

 private:
  template <class S, class Piece>
  auto along(const S& g, Piece piece) const {
    return by_pieces(S((S(length) - g) / S(stroke)), std::array{0.0, 1.0}, piece);
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

template <>
inline constexpr std::array<Number, 5> GasStrutOf<double>::numbers = [] {
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
  return std::array{F, L, s, r, n};
}();

}  // namespace poise

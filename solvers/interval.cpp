#include "solvers/interval.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

namespace poise::solvers {
namespace {

// pi/2 as a sum: two numbers of 33 bits, whose products with small integers are exact, and the rest, which lies between
// neighbouring doubles (the digits of fdlibm's e_rem_pio2.c).
constexpr double half_pi_1 = 0x1.921fb544p+0;
constexpr double half_pi_2 = 0x1.0b4611a6p-34;
constexpr double half_pi_rest_below = 0x1.3198a2e037073p-69;
constexpr double half_pi_rest_above = 0x1.3198a2e037074p-69;

// Beyond it angles are not reduced.
constexpr double largest_angle = 1e5;
// More than the error of a multiple of pi/2 up to it, as a double.
constexpr double beside = 1e-6;

Interval half_pi_times(double k) {
  return Interval(k) * Interval(half_pi_1) +
         (Interval(k) * Interval(half_pi_2) + Interval(k) * Interval(half_pi_rest_below, half_pi_rest_above));
}

constexpr std::size_t terms = 9;

// 1/3!, 1/5!, ... and 1/2!, 1/4!, ...
struct Coefficients {
  std::array<Interval, terms> sine, cosine;

  Coefficients() {
    const RoundingUp up;
    Interval factorial(1);
    for (int i = 0; i < static_cast<int>(terms); ++i) {
      factorial *= Interval(2 * i + 2);
      cosine[i] = Interval(1) / factorial;
      factorial *= Interval(2 * i + 3);
      sine[i] = Interval(1) / factorial;
    }
  }
};

// 1 - c_0 z + c_1 z^2 - ... for 0 <= z <= 1: the last term bounds the rest after the one before it. By Horner's scheme
// p_i = c_i - z p_(i+1), and all p_i are positive: p_i >= c_i - c_(i+1) > 0.
template <std::size_t Terms>
Interval series(const std::array<Interval, Terms>& c, const Interval& z) {
  const double least = z.lower() > 0 ? z.lower() : 0.0;
  const double greatest = z.upper();
  Interval p = with_zero(c[Terms - 1]);
  for (int i = static_cast<int>(Terms) - 2; i >= 0; --i) {
    p = Interval::from(c[i].minus_lower() + greatest * p.upper(), c[i].upper() + least * p.minus_lower());
  }
  return Interval::from(-1 + greatest * p.upper(), 1 + least * p.minus_lower());
}

struct Direction {
  Interval x, y;
};

// Of one angle.
Direction direction_at(double angle) {
  static const Coefficients coefficients;
  const double k = std::floor(angle * (2 / std::numbers::pi) + 0.5);
  const double k_1 = k * half_pi_1;  // exact, as k has at most 17 bits
  const double k_2 = k * half_pi_2;
  const Interval r = (Interval::from(k_1 - angle, angle - k_1) - Interval(k_2)) -
                     Interval(k) * Interval(half_pi_rest_below, half_pi_rest_above);
  const Interval z = square(r);
  const Interval s = r * series(coefficients.sine, z);
  const Interval c = series(coefficients.cosine, z);
  switch (static_cast<int>(k) & 3) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

// An enclosure of the angle of the vector (x, y), 0 < x, y: a guess, corrected by the slope that is left when the
// vector is turned back by it.
Interval corrected_angle(double x, double y) {
  const double guess = std::atan2(y, x);
  const Direction d = direction_at(guess);
  const Interval along = d.x * Interval(x) + d.y * Interval(y);
  const Interval across = d.x * Interval(y) - d.y * Interval(x);
  const double slope = (across / along).magnitude();
  return Interval(guess) + Interval(-slope, slope);
}

// Angles of the vectors (parts, j), and 1/3, 1/5, ...
struct Arcs {
  static constexpr int parts = 32;
  static constexpr std::size_t arc_terms = 6;
  std::array<Interval, parts + 1> of;
  std::array<Interval, arc_terms> coefficients;
  Interval quarter, half;  // of a turn

  Arcs() {
    const RoundingUp up;
    for (int j = 1; j <= parts; ++j) of[j] = corrected_angle(parts, j);
    for (int i = 0; i < static_cast<int>(arc_terms); ++i) coefficients[i] = Interval(1) / Interval(2 * i + 3);
    quarter = half_pi_times(1);
    half = half_pi_times(2);
  }
};

// An enclosure of the angle of the vector (x, y) that is not zero: mirrored so that 0 <= y <= x, turned back by the
// nearest of the table, and by the series of the arc tangent of what is left, at most 1/64.
Interval angle_of_point(double x, double y, double near) {
  static const Arcs arcs;
  constexpr double largest_slope = 0.02;
  constexpr double most_turns = 1e4;
  const bool steep = std::abs(y) > std::abs(x);
  const double a = steep ? std::abs(y) : std::abs(x);
  const double b = steep ? std::abs(x) : std::abs(y);
  const double slope = b / a;
  if (!(slope <= 1.0)) return Interval::entire();
  const int j = static_cast<int>(std::floor(slope * Arcs::parts + 0.5));
  const Interval nearest(static_cast<double>(j) / Arcs::parts);
  const Interval t = (Interval(b) - Interval(a) * nearest) / (Interval(a) + Interval(b) * nearest);
  if (!(t.magnitude() < largest_slope)) return Interval::entire();
  Interval angle = arcs.of[std::min(j, Arcs::parts)] + t * series(arcs.coefficients, square(t));
  if (steep) angle = arcs.quarter - angle;
  if (x < 0) angle = arcs.half - angle;
  if (y < 0) angle = -angle;
  const double turns = std::floor((near - angle.middle()) / (2 * std::numbers::pi) + 0.5);
  if (turns == 0) return angle;
  return std::abs(turns) <= most_turns ? angle + half_pi_times(4 * turns) : Interval::entire();
}

// ln 2 as a sum: a number of 33 bits, whose products with small integers are exact, and the rest, which lies between
// neighbouring doubles (0.b17217f7d1cf79abc9e3b398... in base 16).
constexpr double ln_2_high = 0x1.62e42feep-1;
constexpr double ln_2_rest_below = 0x1.a39ef35793c76p-33;
constexpr double ln_2_rest_above = 0x1.a39ef35793c77p-33;

// Exponents beyond it have results that are not in the range of normal doubles.
constexpr double largest_exponent = 708.0;
constexpr int exponential_terms = 16;

// Encloses the exponential of one number, of |x| <= largest_exponent. By Horner's scheme, from the tail
// 1 + r/17 + r^2/(17 18) + ... on, which for |r| < 0.4 lies between 1 - 0.4 and 1/(1 - 0.4).
Interval exp_at(double x) {
  const double k = std::floor(x * std::numbers::log2e + 0.5);
  const double k_high = k * ln_2_high;  // exact, as k has at most 11 bits
  const Interval r = Interval::from(k_high - x, x - k_high) - Interval(k) * Interval(ln_2_rest_below, ln_2_rest_above);
  Interval p(0.6, 1.7);
  for (int i = exponential_terms; i > 0; --i) p = Interval(1) + r * p / Interval(i);
  return p * Interval(std::ldexp(1.0, static_cast<int>(k)));
}

// Encloses the logarithm of one positive number.
Interval log_at(double x) {
  constexpr double trusted = 0.1;
  const double guess = std::log(x);
  if (!(std::abs(guess) <= largest_exponent)) return Interval::entire();
  const Interval t = Interval(x) * exp_at(-guess) - Interval(1);
  if (!(t.magnitude() < trusted)) return Interval::entire();
  const Interval least = Interval(t.lower()) / (Interval(1) + Interval(t.lower()));
  return Interval(guess) + Interval(least.lower(), t.upper());
}

}  // namespace

Interval exp(const Interval& a) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (std::isnan(a.lower()) || std::isnan(a.upper())) return a;
  const double below = std::min(a.lower(), largest_exponent);
  const double above = std::max(a.upper(), -largest_exponent);
  const double lower = below < -largest_exponent ? 0.0 : exp_at(below).lower();
  return {lower, above > largest_exponent ? infinity : exp_at(above).upper()};
}

Interval log(const Interval& a) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (std::isnan(a.lower()) || std::isnan(a.upper())) return a;
  const double lower = a.lower() > 0 ? log_at(a.lower()).lower() : -infinity;
  // Of smaller numbers, or where none is positive, the bound of this one.
  constexpr double least_positive = 1e-300;
  return {lower, log_at(std::max(a.upper(), least_positive)).upper()};
}

void sin_cos(const Interval& angle, Interval& sine, Interval& cosine) {
  sine = Interval(-1, 1);
  cosine = Interval(-1, 1);
  if (!(angle.magnitude() <= largest_angle) || angle.width() >= 2 * std::numbers::pi) return;
  const Direction a = direction_at(angle.lower());
  Direction ends = a;
  if (angle.width() > 0) {
    const Direction b = direction_at(angle.upper());
    ends = {hull(a.x, b.x), hull(a.y, b.y)};
    // Extreme values at multiples of pi/2 that may be within.
    const int last = static_cast<int>(std::floor(angle.upper() * (2 / std::numbers::pi))) + 1;
    for (int j = static_cast<int>(std::floor(angle.lower() * (2 / std::numbers::pi))); j <= last; ++j) {
      const double near = j * (std::numbers::pi / 2);
      if (near < angle.lower() - beside || near > angle.upper() + beside) continue;
      Interval at = half_pi_times(j);
      if (!at.meet(angle)) continue;
      Interval& extreme = j % 2 == 0 ? ends.x : ends.y;
      extreme = hull(extreme, Interval((j & 3) < 2 ? 1 : -1));
    }
  }
  sine.meet(ends.y);
  cosine.meet(ends.x);
}

Interval angle_of(const Interval& x, const Interval& y, double near) {
  if (!x.excludes_zero() && !y.excludes_zero()) return Interval::entire();
  if (!x.bounded() || !y.bounded()) return Interval::entire();
  // The corners that are first and last counter-clockwise.
  const bool right = x.lower() > 0;
  const bool left = x.upper() < 0;
  const bool above = y.lower() > 0;
  const bool below = y.upper() < 0;
  const double first_x = above ? x.upper() : (below || right ? x.lower() : x.upper());
  const double last_x = above ? x.lower() : (below || !right ? x.upper() : x.lower());
  const double first_y = right ? y.lower() : (left || !above ? y.upper() : y.lower());
  const double last_y = right ? y.upper() : (left || above ? y.lower() : y.upper());
  const Interval first = angle_of_point(first_x, first_y, near);
  if (!first.bounded()) return first;
  const Interval last = angle_of_point(last_x, last_y, first.middle() + std::numbers::pi / 2);
  return {first.lower(), last.upper()};
}

// The vector (c, sqrt(1 - c^2)) turns clockwise where c grows, and where its height shrinks on the right.
Interval arc_cosine(const Interval& c) {
  const auto height = [](double x) { return sqrt(Interval(1) - square(Interval(x))); };
  const double right = std::min(c.upper(), 1.0);
  const double left = std::max(c.lower(), -1.0);
  const Interval first = height(right);
  const Interval last = height(left);
  const Interval below = angle_of_point(right, right > 0 ? first.lower() : first.upper(), 0.5);
  const Interval above = angle_of_point(left, left > 0 ? last.upper() : last.lower(), 0.5);
  return {std::max(below.lower(), 0.0), above.upper()};
}

}  // namespace poise::solvers

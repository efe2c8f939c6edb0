#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "model/planar.hpp"
#include "model/select.hpp"
#include "model/set_valued.hpp"
#include "model/spline.hpp"

namespace poise {

/// Of sets of values.
template <class S>
ProfileValue<S> hull(const ProfileValue<S>& a, const ProfileValue<S>& b) {
  return {hull(a.value, b.value), hull(a.first, b.first), hull(a.second, b.second), hull(a.third, b.third)};
}

/// How a piece of a profile goes (ProfileIn).
enum class ProfileLaw {
  polynomial,
  harmonic,
  cycloidal,
  geneva,
  tangent_angle,
  arc_length,
  along_tangent,
  across_tangent
};

/// A function P(u) of a number, both without dimension: the lift of a cam over its angle, a coordinate along a curve.
/// It is made of pieces; in each, with s = (u - from) / (to - from) from 0 to 1,
///
///   polynomial   P = sum_k c_k s^k
///   harmonic     P = c_0 + c_1 (1 - cos(pi s)) / 2
///   cycloidal    P = c_0 + c_1 (s - sin(2 pi s) / (2 pi))
///   geneva       P = c_0 + c_1 atan2(c_2 sin f, 1 - c_2 cos f),  f = c_3 + c_4 s,  0 < c_2 < 1
///
/// (R. L. Norton, "Cam Design and Manufacturing Handbook", 2009, chapter 2: simple harmonic, cycloidal displacement and
/// the polynomial 3-4-5, P = c_0 + c_1 (10 s^3 - 15 s^4 + 6 s^5).) Of a curve r = (X, Y) of a body that rolls on
/// another (model/rolling_profile.hpp), with t = s - 1/2 and r = sum_k (c_1+k, c_5+k) t^k for k from 0 to 3,
///
///   tangent_angle   P = c_0 + the angle from r'(0) to r'(t), rad
///   arc_length      P = c_0 + int_0^t |r'|
///   along_tangent   P = r.r' / |r'|
///   across_tangent  P = r'xr / |r'|
///
/// where is_short() of their pieces. A periodic one repeats: P(u + 1) = P(u) + rise, its pieces reach from 0 to 1.
/// Another goes on beyond its ends along its tangents there. Coefficients are scalars C: double of a Profile, dual
/// numbers where the function has derivatives by the numbers that they follow from.
template <class C>
class ProfileIn {
 public:
  using Law = ProfileLaw;
  static constexpr int degree = 5;
  struct Piece {
    C from = C(0), to = C(1);
    Law law = Law::polynomial;
    std::array<C, 9> c{};
  };

  /// Pieces in order, each from where the last ends; continuous up to rounding of their coefficients.
  ProfileIn(std::vector<Piece> pieces, bool periodic, C rise = C(0))
      : pieces_(std::move(pieces)), rise_(rise), periodic_(periodic) {
    borders_.push_back(pieces_.front().from);
    for (const Piece& piece : pieces_) borders_.push_back(piece.to);
  }

  /// A piece of a standard law from P = begin to P = end; "dwell", "harmonic", "cycloidal", "polynomial_345".
  static Piece standard(std::string_view law, double from, double to, double begin, double end);
  /// The names of these laws.
  static constexpr std::array<std::string_view, 4> laws{"dwell", "harmonic", "cycloidal", "polynomial_345"};
  /// It counts the slots by which the wheel of a Geneva drive has turned, at a share u of a turn of its crank from
  /// where the pin is deepest in a slot: with the angle f = 2 pi u of the crank and k = sin(pi / slots), while the pin
  /// is in the slot, cos f >= k,  P = slots / (2 pi) atan2(k sin f, 1 - k cos f);  else the wheel rests. P(u + 1) =
  /// P(u) + 1. `slots` is at least 3.
  static ProfileIn geneva(int slots);
  /// The Spline through the points (u_k, P_k).
  static ProfileIn spline(const std::vector<C>& u, const std::vector<C>& p, bool periodic,
                          bool has_curved_ends = false);

  /// Whether a piece of a curve, in all lanes of C, turns by less than a right angle from its middle to |t| = most_t,
  /// and has, with |r'|^2 = sum_j q_j t^j,  sum_j>0 |q_j| (4 most_t)^j < q_0,  so that the series of its arc length
  /// converges.
  static bool is_short(const Piece& piece);
  static constexpr double most_t = 0.5625;

  const std::vector<Piece>& pieces() const { return pieces_; }
  bool periodic() const { return periodic_; }
  /// Whether it is another function a whole period on: it does not repeat, or rises with each.
  bool counts_periods() const { return !periodic_ || any(rise_ != C(0)); }

  /// P(u); for sets of numbers it encloses the values and derivatives of all pieces that u may be in.
  template <class S>
  ProfileValue<S> at(const S& u) const;
  /// The same of one piece, also beyond its ends.
  template <class S>
  static ProfileValue<S> on(const Piece& piece, const S& u);

 private:
  template <class S>
  ProfileValue<S> along_end(bool last, const S& u) const;
  template <class S>
  ProfileValue<S> in_turns(const S& u) const;
  template <class S>
  static auto turns_before(const S& u);
  template <class S>
  static ProfileValue<S> on_geneva(const Piece& piece, const S& s);
  template <class S>
  static std::array<Planar<S>, 4> curve(const Piece& piece, const S& t);
  template <class S>
  static ProfileValue<S> on_curve(const Piece& piece, const S& t);
  template <class S>
  static S value_on_curve(const Piece& piece, const S& t);
  template <class S>
  static S length_from_middle(const Piece& piece, const S& t);

  std::vector<Piece> pieces_;
  std::vector<C> borders_;  // of the pieces, both ends included
  C rise_;                  // of a period
  bool periodic_;
};

using Profile = ProfileIn<double>;

template <class C>
ProfileIn<C> ProfileIn<C>::spline(const std::vector<C>& u, const std::vector<C>& p, bool periodic,
                                  bool has_curved_ends) {
  const Spline<C> curve(u, p, periodic, has_curved_ends);
  std::vector<Piece> out;
  for (std::size_t k = 0; k + 1 < u.size(); ++k) {
    Piece piece{u[k], u[k + 1]};
    std::copy(curve.coefficients()[k].begin(), curve.coefficients()[k].end(), piece.c.begin());
    out.push_back(piece);
  }
  return {std::move(out), periodic};
}

template <class C>
bool ProfileIn<C>::is_short(const Piece& piece) {
  using std::abs;
  const auto c = [&](std::size_t k) { return Planar<C>{piece.c[1 + k], piece.c[5 + k]}; };
  const Planar<C> a = c(1), b = C(2) * c(2), d = C(3) * c(3);
  const C q_0 = dot(a, a);
  const C margin(0.99);  // for rounding, also of the scalars that evaluate the piece
  C sum(0), power(1);
  for (const C& q : {C(C(2) * dot(a, b)), C(dot(b, b) + C(2) * dot(a, d)), C(C(2) * dot(b, d)), dot(d, d)}) {
    power = power * C(4 * most_t);
    sum = sum + abs(q) * power;
  }
  const C turned_back = C(most_t) * abs(dot(a, b)) + C(most_t * most_t) * abs(dot(a, d));
  return all(sum < margin * q_0 && turned_back < margin * q_0);
}

// r and its three derivatives.
template <class C>
template <class S>
std::array<Planar<S>, 4> ProfileIn<C>::curve(const Piece& piece, const S& t) {
  const auto c = [&](std::size_t k) { return Planar<S>{S(piece.c[1 + k]), S(piece.c[5 + k])}; };
  const Planar<S> third = S(6) * c(3), twice = S(2) * c(2);
  return {c(0) + t * (c(1) + t * (c(2) + t * c(3))), c(1) + t * (twice + S(t / S(2)) * third), twice + t * third,
          third};
}

// |r'| = sum_k y_k t^k is the square root of q = sum_j q_j t^j, so that 2 q y' = q' y gives
//   y_k = sum_j q_j (3 j - 2 k) y_(k - j) / (2 k q_0),  j = 1, ..., 4.
// With |3 j - 2 k| <= 2 k for j <= k, and sum_j |q_j| |4 t|^j <= q_0 of short pieces, |y_k t^k| <= 4^-k y_0: what the
// first n terms of the integral leave out is less than 4^-n |y_0 t|.
template <class C>
template <class S>
S ProfileIn<C>::length_from_middle(const Piece& piece, const S& t) {
  constexpr int terms = may_enclose_set<S> ? 72 : std::numeric_limits<S>::digits / 2 + 2;
  const auto c = [&](std::size_t k) { return Planar<S>{S(piece.c[1 + k]), S(piece.c[5 + k])}; };
  const Planar<S> a = c(1), b = S(2) * c(2), d = S(3) * c(3);
  const S half = S(1) / (S(2) * dot(a, a)), square = t * t;
  const std::array<S, 4> q{S(S(2) * dot(a, b) * half * t), S((dot(b, b) + S(2) * dot(a, d)) * half * square),
                           S(S(2) * dot(b, d) * half * square * t), S(dot(d, d) * half * square * square)};
  const S first = norm(a) * t;
  std::array<S, 4> last{first, S(0), S(0), S(0)};  // y_k t^(k + 1) at k modulo 4
  S sum = first;
  for (int k = 1; k < terms; ++k) {
    S next(0);
    for (int j = 1; j <= 4; ++j) {
      next += S(3 * j - 2 * k) * q[static_cast<std::size_t>(j - 1)] * last[static_cast<std::size_t>((k - j) & 3)];
    }
    next = next / S(k);
    sum += next / S(k + 1);
    last[static_cast<std::size_t>(k & 3)] = next;
  }
  if constexpr (may_enclose_set<S>) {
    const S rest = first * S(0x1p-144);
    sum += hull(S(-rest), rest);
  }
  return sum;
}

template <class C>
template <class S>
S ProfileIn<C>::value_on_curve(const Piece& piece, const S& t) {
  const auto r = curve(piece, t);
  switch (piece.law) {
    case Law::tangent_angle: {
      const Planar<S> middle{S(piece.c[2]), S(piece.c[6])};
      const Planar<S> turned{dot(middle, r[1]), cross(middle, r[1])};  // to the right of zero
      return S(piece.c[0]) + full_angle_of(quarter_turn(turned)) - pi_of<S>() / S(2);
    }
    case Law::arc_length:
      return S(piece.c[0]) + length_from_middle(piece, t);
    case Law::along_tangent:
      return dot(r[0], r[1]) / norm(r[1]);
    default:
      return cross(r[1], r[0]) / norm(r[1]);
  }
}

// With the angle a, the speed l = |r'|, and p along and h across the tangent:  a' = r'xr'' / l^2,  p' = a' h + l,
// h' = -a' p. Of sets the value is that of a number in the middle and the slope over the set (mean value theorem).
template <class C>
template <class S>
ProfileValue<S> ProfileIn<C>::on_curve(const Piece& piece, const S& t) {
  const auto [r, r1, r2, r3] = curve(piece, t);
  const S square = dot(r1, r1), inward = dot(r1, r2);
  const S by_square = S(2) * inward, by_2_square = S(2) * (dot(r2, r2) + dot(r1, r3));
  const S a1 = cross(r1, r2) / square;
  const S a2 = (cross(r1, r3) - a1 * by_square) / square;
  const S a3 = (cross(r2, r3) - S(2) * a2 * by_square - a1 * by_2_square) / square;
  const S l = norm(r1);
  const S l1 = inward / l;
  const S l2 = (by_2_square / S(2) - l1 * l1) / l;
  ProfileValue<S> out;
  if (piece.law == Law::tangent_angle) {
    out = {S(0), a1, a2, a3};
  } else if (piece.law == Law::arc_length) {
    out = {S(0), l, l1, l2};
  } else {
    const S p = dot(r, r1) / l, h = cross(r1, r) / l;
    const S p1 = a1 * h + l, h1 = -(a1 * p);
    const S p2 = a2 * h + a1 * h1 + l1, h2 = -(a2 * p + a1 * p1);
    if (piece.law == Law::along_tangent)
      out = {S(0), p1, p2, S(a3 * h + S(2) * a2 * h1 + a1 * h2 + l2)};
    else
      out = {S(0), h1, h2, S(-(a3 * p + S(2) * a2 * p1 + a1 * p2))};
  }
  if constexpr (may_enclose_set<S>) {
    const S middle = middle_of(t);
    if (abs(middle) <= S(most_t))
      out.value = value_on_curve(piece, middle) + out.first * (t - middle);
    else
      out.value = S(1) / hull(S(-1), S(1));  // nothing is known so far beyond the piece
  } else {
    out.value = value_on_curve(piece, t);
  }
  return out;
}

// With D = 1 - 2 k cos f + k^2, the square of the pin's distance from the wheel's axis over that of the axes:
//   psi' = k (cos f - k) / D,  psi'' = -k (1 - k^2) sin f / D^2,  psi''' = k (1 - k^2) (4 k sin^2 f / D - cos f) / D^2.
template <class C>
template <class S>
ProfileValue<S> ProfileIn<C>::on_geneva(const Piece& piece, const S& s) {
  const S k(piece.c[2]), turned(piece.c[4]);
  const Planar<S> crank = unit(S(S(piece.c[3]) + turned * s));
  const Planar<S> pin{S(1) - k * crank.x, k * crank.y};  // to the right of zero
  const S square = S(1) - S(2) * k * crank.x + k * k;
  const S bend = k * (S(1) - k * k) / (square * square);
  const S factor(piece.c[1]);
  return {S(piece.c[0]) + factor * (full_angle_of(quarter_turn(pin)) - pi_of<S>() / S(2)),
          factor * turned * k * (crank.x - k) / square, -(factor * turned * turned * bend * crank.y),
          factor * turned * turned * turned * bend * (S(4) * k * crank.y * crank.y / square - crank.x)};
}

template <class C>
template <class S>
ProfileValue<S> ProfileIn<C>::on(const Piece& piece, const S& u) {
  const S length = S(piece.to) - S(piece.from);
  const S s = (u - S(piece.from)) / length;
  ProfileValue<S> by_s;
  switch (piece.law) {
    case Law::polynomial:
      for (int k = degree; k >= 0; --k) {
        by_s.third = by_s.third * s + S(3) * by_s.second;
        by_s.second = by_s.second * s + S(2) * by_s.first;
        by_s.first = by_s.first * s + by_s.value;
        by_s.value = by_s.value * s + S(piece.c[static_cast<std::size_t>(k)]);
      }
      break;
    case Law::harmonic: {
      const S pi = pi_of<S>();
      const Planar<S> turn = unit(S(pi * s));
      const S half = S(piece.c[1]) / S(2);
      by_s = {S(piece.c[0]) + half * (S(1) - turn.x), half * pi * turn.y, half * pi * pi * turn.x,
              -(half * pi * pi * pi * turn.y)};
      break;
    }
    case Law::cycloidal: {
      const S full = S(2) * pi_of<S>();
      const Planar<S> turn = unit(S(full * s));
      const S rise = S(piece.c[1]);
      by_s = {S(piece.c[0]) + rise * (s - turn.y / full), rise * (S(1) - turn.x), rise * full * turn.y,
              rise * full * full * turn.x};
      break;
    }
    case Law::geneva:
      by_s = on_geneva(piece, s);
      break;
    default:
      by_s = on_curve(piece, S(s - S(0.5)));
  }
  return {by_s.value, by_s.first / length, by_s.second / (length * length), by_s.third / (length * length * length)};
}

template <class C>
template <class S>
ProfileValue<S> ProfileIn<C>::along_end(bool last, const S& u) const {
  const Piece& piece = last ? pieces_.back() : pieces_.front();
  const S end = S(last ? piece.to : piece.from);
  const ProfileValue<S> there = on(piece, end);
  return {there.value + there.first * (u - end), there.first, S(0), S(0)};
}

template <class C>
template <class S>
ProfileValue<S> ProfileIn<C>::at(const S& u) const {
  if (periodic_) return in_turns(u);
  return by_pieces(u, borders_, [&](std::size_t k, const S& part) {
    if (k == 0) return along_end(false, part);
    return k == borders_.size() ? along_end(true, part) : on(pieces_[k - 1], part);
  });
}

// How many whole turns u is beyond, a double, or in lanes one for each.
template <class C>
template <class S>
auto ProfileIn<C>::turns_before(const S& u) {
  if constexpr (has_lanes<S>) {
    return S::of_each([&](int lane) { return turns_before(u[lane]); });
  } else {
    constexpr double most_turns = 1e6;
    double turns = 0.0;
    while (turns < most_turns && u >= S(turns + 1)) ++turns;
    while (turns > -most_turns && u < S(turns)) --turns;
    return turns;
  }
}

template <class C>
template <class S>
ProfileValue<S> ProfileIn<C>::in_turns(const S& u) const {
  const auto turns = turns_before(u);
  const S in_turn = u - S(turns);
  const auto inside = std::span(borders_).subspan(1, pieces_.size() - 1);
  const auto in_one_turn = [&](const S& v) {
    return by_pieces(v, inside, [&](std::size_t k, const S& part) { return on(pieces_[k], part); });
  };
  if constexpr (!may_enclose_set<S>) {
    ProfileValue<S> out = in_one_turn(in_turn);
    if (any(rise_ != C(0))) out.value += S(rise_) * S(turns);
    return out;
  } else {
    // A set around a multiple of the period reaches into the turn before or after; a wider one may be anywhere, by as
    // many periods from its place in one as they differ.
    const S period = hull(S(0), S(1));
    if (!(in_turn >= S(-1) && in_turn <= S(2))) {
      ProfileValue<S> anywhere = in_one_turn(period);
      if (any(rise_ != C(0))) anywhere.value += S(rise_) * (u - period);
      return anywhere;
    }
    ProfileValue<S> out;
    bool is_first = true;
    for (const int shift : {-1, 0, 1}) {
      const S shifted = in_turn - S(shift);
      if (shifted < S(0) || shifted > S(1)) continue;
      ProfileValue<S> part = in_one_turn(within(shifted, 0.0, 1.0));
      if (any(rise_ != C(0))) part.value += S(rise_) * S(turns + shift);
      out = is_first ? part : hull(out, part);
      is_first = false;
    }
    return out;
  }
}

}  // namespace poise

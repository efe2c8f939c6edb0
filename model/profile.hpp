#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "model/planar.hpp"
#include "model/set_valued.hpp"
#include "model/spline.hpp"

namespace poise {

/// Of sets of values.
template <class S>
ProfileValue<S> hull(const ProfileValue<S>& a, const ProfileValue<S>& b) {
  return {hull(a.value, b.value), hull(a.first, b.first), hull(a.second, b.second), hull(a.third, b.third)};
}

/// A function P(u) of a number, both without dimension: the lift of a cam over its angle, a coordinate along a curve.
/// It is made of pieces; in each, with s = (u - from) / (to - from) from 0 to 1,
///
///   polynomial   P = sum_k c_k s^k
///   harmonic     P = c_0 + c_1 (1 - cos(pi s)) / 2
///   cycloidal    P = c_0 + c_1 (s - sin(2 pi s) / (2 pi))
///
/// (R. L. Norton, "Cam Design and Manufacturing Handbook", 2009, chapter 2: simple harmonic, cycloidal displacement and
/// the polynomial 3-4-5, P = c_0 + c_1 (10 s^3 - 15 s^4 + 6 s^5).) A periodic one repeats: P(u + 1) = P(u), its pieces
/// reach from 0 to 1. Another goes on beyond its ends along its tangents there.
class Profile {
 public:
  enum class Law { polynomial, harmonic, cycloidal };
  static constexpr int degree = 5;
  struct Piece {
    double from = 0.0, to = 1.0;
    Law law = Law::polynomial;
    std::array<double, degree + 1> c{};
  };

  /// Pieces in order, each from where the last ends; continuous up to rounding of their coefficients.
  Profile(std::vector<Piece> pieces, bool periodic) : pieces_(std::move(pieces)), periodic_(periodic) {
    borders_.push_back(pieces_.front().from);
    for (const Piece& piece : pieces_) borders_.push_back(piece.to);
  }

  /// A piece of a standard law from P = begin to P = end; "dwell", "harmonic", "cycloidal", "polynomial_345".
  static Piece standard(std::string_view law, double from, double to, double begin, double end);
  /// The names of these laws.
  static constexpr std::array<std::string_view, 4> laws{"dwell", "harmonic", "cycloidal", "polynomial_345"};
  /// The Spline through the points (u_k, P_k).
  static Profile spline(const std::vector<double>& u, const std::vector<double>& p, bool periodic);

  const std::vector<Piece>& pieces() const { return pieces_; }
  bool periodic() const { return periodic_; }

  /// P(u); for sets of numbers it encloses the values and derivatives of all pieces that u may be in.
  template <class S>
  ProfileValue<S> at(const S& u) const;

 private:
  template <class S>
  static ProfileValue<S> on(const Piece& piece, const S& u);
  template <class S>
  ProfileValue<S> along_end(bool last, const S& u) const;
  template <class S>
  ProfileValue<S> in_turns(const S& u) const;

  std::vector<Piece> pieces_;
  std::vector<double> borders_;  // of the pieces, both ends included
  bool periodic_;
};

template <class S>
ProfileValue<S> Profile::on(const Piece& piece, const S& u) {
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
  }
  return {by_s.value, by_s.first / length, by_s.second / (length * length), by_s.third / (length * length * length)};
}

template <class S>
ProfileValue<S> Profile::along_end(bool last, const S& u) const {
  const Piece& piece = last ? pieces_.back() : pieces_.front();
  const S end = S(last ? piece.to : piece.from);
  const ProfileValue<S> there = on(piece, end);
  return {there.value + there.first * (u - end), there.first, S(0), S(0)};
}

template <class S>
ProfileValue<S> Profile::at(const S& u) const {
  if (periodic_) return in_turns(u);
  return by_pieces(u, borders_, [&](std::size_t k, const S& part) {
    if (k == 0) return along_end(false, part);
    return k == borders_.size() ? along_end(true, part) : on(pieces_[k - 1], part);
  });
}

template <class S>
ProfileValue<S> Profile::in_turns(const S& u) const {
  constexpr double most_turns = 1e6;
  double turns = 0.0;
  while (turns < most_turns && u >= S(turns + 1)) ++turns;
  while (turns > -most_turns && u < S(turns)) --turns;
  const S in_turn = u - S(turns);
  const auto inside = std::span(borders_).subspan(1, pieces_.size() - 1);
  const auto in_one_turn = [&](const S& v) {
    return by_pieces(v, inside, [&](std::size_t k, const S& part) { return on(pieces_[k], part); });
  };
  if constexpr (!may_enclose_set<S>) {
    return in_one_turn(in_turn);
  } else {
    // A set around a multiple of the period reaches into the turn before or after; a wider one may be anywhere.
    if (!(in_turn >= S(-1) && in_turn <= S(2))) return in_one_turn(hull(S(0), S(1)));
    ProfileValue<S> out;
    bool is_first = true;
    for (const int shift : {-1, 0, 1}) {
      const S shifted = in_turn - S(shift);
      if (shifted < S(0) || shifted > S(1)) continue;
      const ProfileValue<S> part = in_one_turn(within(shifted, 0.0, 1.0));
      out = is_first ? part : hull(out, part);
      is_first = false;
    }
    return out;
  }
}

}  // namespace poise

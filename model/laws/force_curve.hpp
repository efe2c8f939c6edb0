#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "model/laws/law_force.hpp"

namespace poise {

/// A curve F(x) through points of ascending x with forces of the scalar N: cubic on each piece, continuous with its
/// slope, and monotone wherever the points are. The slope at a point inside is 0 where the secants d0, d1 beside it
/// differ in sign or one is zero, otherwise their weighted harmonic mean
///   1 / (a/d0 + (1 - a)/d1),   a = (h0 + 2 h1) / (3 (h0 + h1)),   h0, h1 the widths of the pieces
/// (F. N. Fritsch, J. Butland, "A method for constructing local monotone piecewise cubic interpolants", SIAM J. Sci.
/// Stat. Comput. 5, 1984; K. W. Brodlie's weights). At an end it is the one for which the curvature is zero there,
/// (3 d - slope at the next point) / 2, which keeps the piece monotone: beyond its ends the curve goes on along the
/// tangents, and there its curvature is continuous too. Two points make a line.
/// Refers to the points, whose x may be scalars with derivatives too.
template <class N, class X = double>
class CurveThrough {
 public:
  CurveThrough(std::span<const X> x, const N* force) : x_(x), force_(force) {}

  std::size_t points() const { return x_.size(); }

  /// F0 + t (m0 + t (c2 + t c3)) at the distance t from the beginning of a piece.
  template <class S>
  struct Piece {
    S force, first, second, third;

    S value(const S& t) const { return force + t * (first + t * (second + t * third)); }
    S slope(const S& t) const { return first + t * (S(2) * second + t * (S(3) * third)); }
    S work(const S& t) const { return t * (force + t * (first / S(2) + t * (second / S(3) + t * (third / S(4))))); }
  };

  /// F and dF/dx, with piece_at(k) the pieces.
  template <class S, class PieceAt>
  std::pair<S, S> force(const S& x, PieceAt piece_at) const {
    const LawForce<S> out = by_pieces(x, x_, [&](std::size_t k, const S& part) {
      const Piece<S> piece = piece_at(k);
      const S t = part - S(begin(k));
      return LawForce<S>{piece.value(t), piece.slope(t), S(0)};
    });
    return {out.value, out.by_measure};
  }
  template <class S>
  std::pair<S, S> force(const S& x) const {
    return force(x, [&](std::size_t k) { return piece<S>(k); });
  }

  /// W(x), the integral of F from the first point to x: exact on each piece. work_before(k) is that of the pieces
  /// before.
  template <class S, class PieceAt, class WorkBefore>
  S work(const S& x, PieceAt piece_at, WorkBefore work_before) const {
    return by_pieces(x, x_, [&](std::size_t k, const S& part) -> S {
      return work_before(k) + piece_at(k).work(part - S(begin(k)));
    });
  }
  template <class S>
  S work(const S& x) const {
    const auto piece_at = [&](std::size_t k) { return piece<S>(k); };
    return work(x, piece_at, [&](std::size_t k) -> S {
      S out(0);
      for (std::size_t before = 1; before < k; ++before) out += piece<S>(before).work(width<S>(before));
      return out;
    });
  }

  /// Where the distances of piece k count from. Piece 0 lies before the first point, piece points() behind the last.
  X begin(std::size_t k) const { return x_[k == 0 ? 0 : k - 1]; }

  template <class S>
  S width(std::size_t k) const {
    return S(x_[k]) - S(x_[k - 1]);
  }
  template <class S>
  S secant(std::size_t k) const {
    return (S(force_[k]) - S(force_[k - 1])) / width<S>(k);
  }

  /// By the values and slopes at both ends of a piece.
  template <class S>
  static Piece<S> hermite(const S& h, const S& from, const S& to, const S& first, const S& last) {
    const S d = (to - from) / h;
    return {from, first, (S(3) * d - S(2) * first - last) / h, (first + last - S(2) * d) / (h * h)};
  }

  template <class S>
  Piece<S> piece(std::size_t k) const {
    if (k == 0 || k == points()) return {S(force_[k == 0 ? 0 : k - 1]), slope_at<S>(k == 0 ? 0 : k - 1), S(0), S(0)};
    return hermite(width<S>(k), S(force_[k - 1]), S(force_[k]), slope_at<S>(k - 1), slope_at<S>(k));
  }

  template <class S>
  S slope_at(std::size_t point) const {
    if (points() == 2) return secant<S>(1);
    const std::size_t last = points() - 1;
    if (point == 0) return (S(3) * secant<S>(1) - slope_inside<S>(1)) / S(2);
    if (point == last) return (S(3) * secant<S>(last) - slope_inside<S>(last - 1)) / S(2);
    return slope_inside<S>(point);
  }

  template <class S>
  S share(std::size_t point) const {
    const S before = width<S>(point), after = width<S>(point + 1);
    return (before + S(2) * after) / (S(3) * (before + after));
  }

  template <class S>
  static auto agree_in_sign(const S& a, const S& b) {
    return (a > S(0) && b > S(0)) || (a < S(0) && b < S(0));
  }
  /// Or one of them is zero. In sets of numbers neither of both may be certain.
  template <class S>
  static bool differ_in_sign(const S& a, const S& b) {
    return (a <= S(0) && b >= S(0)) || (a >= S(0) && b <= S(0));
  }

  template <class S>
  S slope_inside(std::size_t point) const {
    const S before = secant<S>(point), after = secant<S>(point + 1);
    const S a = share<S>(point);
    const auto agree = agree_in_sign(before, after);
    if constexpr (may_enclose_set<S>) {
      if (!agree && !differ_in_sign(before, after)) {
        // The mean lies between zero and either of these, and so the narrower one.
        const S by_before = before / a, by_after = after / (S(1) - a);
        return hull(S(0), abs(by_before) < abs(by_after) ? by_before : by_after);
      }
    }
    return choose(
        agree, [&] { return S(S(1) / (a / before + (S(1) - a) / after)); }, [] { return S(0); });
  }

 private:
  std::span<const X> x_;
  const N* force_;
};

/// Such a curve with its points, and its pieces in double.
class ForceCurve {
 public:
  /// Two points or more, all finite, of ascending x.
  ForceCurve(std::vector<double> x, std::vector<double> force) : x_(std::move(x)), force_(std::move(force)) {
    const CurveThrough<double> curve = through();
    for (std::size_t k = 0; k <= points(); ++k) pieces_.push_back(curve.piece<double>(k));
    work_.push_back(0.0);
    for (std::size_t k = 1; k < points(); ++k) {
      work_.push_back(work_.back() + pieces_[k].work(x_[k] - x_[k - 1]));
    }
  }

  std::size_t points() const { return x_.size(); }
  std::span<const double> x() const { return x_; }
  std::span<const double> forces() const { return force_; }

  /// max |F| of the points.
  double largest() const {
    double out = 0.0;
    for (const double f : force_) out = std::max(out, std::abs(f));
    return out;
  }

  /// The curve with another force at one point; x times m, forces times e.
  ForceCurve with_force(std::size_t point, double force) const {
    std::vector<double> changed = force_;
    changed[point] = force;
    return {x_, std::move(changed)};
  }
  ForceCurve rescaled(double m, double e) const {
    std::vector<double> wider = x_, higher = force_;
    for (double& x : wider) x *= m;
    for (double& f : higher) f *= e;
    return {std::move(wider), std::move(higher)};
  }

  /// F and dF/dx.
  template <class S>
  std::pair<S, S> force(const S& x) const {
    return through().force(x, [&](std::size_t k) { return piece_at<S>(k); });
  }

  /// W(x), the integral of F from the first point to x: exact on each piece.
  template <class S>
  S work(const S& x) const {
    if constexpr (as_stored<S>) {
      const auto work_before = [&](std::size_t k) { return k < 2 ? S(0) : S(work_[k - 1]); };
      return through().work(
          x, [&](std::size_t k) { return piece_at<S>(k); }, work_before);
    } else {
      return through().work(x);
    }
  }

  /// Derivative of F(x) by the force at one point. Where a secant beside a point is zero its slope has no derivative by
  /// the forces; the one of the side on which it stays zero is taken.
  template <class S>
  S force_by(std::size_t point, const S& x) const {
    return by_pieces(x, x_, [&](std::size_t k, const S& part) -> S {
      return piece_by<S>(k, point).value(part - S(through().begin(k)));
    });
  }
  /// The same between the points k and k + 1, as  sum_j out[j] (x - x_k)^j.
  std::array<double, 4> cubic_by(std::size_t k, std::size_t point) const {
    const Piece<double> piece = piece_by<double>(k + 1, point);
    return {piece.force, piece.first, piece.second, piece.third};
  }
  /// Whether those by the forces exist at every x.
  bool has_derivatives_by(std::size_t point) const {
    const bool flat_before = point > 0 && force_[point] == force_[point - 1];
    const bool flat_after = point + 1 < points() && force_[point] == force_[point + 1];
    return points() == 2 || !(flat_before || flat_after);
  }

 private:
  template <class S>
  using Piece = CurveThrough<double>::Piece<S>;

  CurveThrough<double> through() const { return {x_, force_.data()}; }

  // What double holds is not what a scalar of more digits, or one that encloses, needs: these compute it anew.
  template <class S>
  static constexpr bool as_stored =
      std::numeric_limits<S>::is_specialized&& std::numeric_limits<S>::digits <= std::numeric_limits<double>::digits;

  template <class S>
  Piece<S> piece_at(std::size_t k) const {
    if constexpr (as_stored<S>) {
      const Piece<double>& p = pieces_[k];
      return {S(p.force), S(p.first), S(p.second), S(p.third)};
    } else {
      return through().piece<S>(k);
    }
  }

  template <class S>
  S width(std::size_t k) const {
    return through().width<S>(k);
  }
  template <class S>
  S secant(std::size_t k) const {
    return through().secant<S>(k);
  }

  // What the slope changes by when the secants beside the point change by so much.
  template <class S>
  S slope_inside_by(std::size_t point, const S& change_before, const S& change_after) const {
    const S before = secant<S>(point), after = secant<S>(point + 1);
    const S a = through().share<S>(point);
    const auto agree = CurveThrough<double>::agree_in_sign(before, after);
    if constexpr (may_enclose_set<S>) {
      if (!agree && !CurveThrough<double>::differ_in_sign(before, after))
        return hull(S(0), S(change_before / a)) + hull(S(0), S(change_after / (S(1) - a)));
    }
    return choose(
        agree,
        [&] {
          const S to_before = S(1) / (a + (S(1) - a) * before / after);  // slope / before
          const S to_after = S(1) / (a * after / before + (S(1) - a));
          return S(a * to_before * to_before * change_before + (S(1) - a) * to_after * to_after * change_after);
        },
        [] { return S(0); });
  }

  /// Of piece k, its derivative by the force at one point.
  template <class S>
  Piece<S> piece_by(std::size_t k, std::size_t point) const {
    const auto at = [&](std::size_t other) { return other == point ? S(1) : S(0); };
    const auto secant_by = [&](std::size_t piece) -> S { return (at(piece) - at(piece - 1)) / width<S>(piece); };
    const auto inside_by = [&](std::size_t other) {
      return slope_inside_by<S>(other, secant_by(other), secant_by(other + 1));
    };
    const std::size_t last = points() - 1;
    const auto slope_by = [&](std::size_t other) -> S {
      if (last == 1) return secant_by(1);
      if (other == 0) return (S(3) * secant_by(1) - inside_by(1)) / S(2);
      if (other == last) return (S(3) * secant_by(last) - inside_by(last - 1)) / S(2);
      return inside_by(other);
    };
    if (k == 0 || k == points()) return {at(k == 0 ? 0 : last), slope_by(k == 0 ? 0 : last), S(0), S(0)};
    return CurveThrough<double>::hermite(width<S>(k), at(k - 1), at(k), slope_by(k - 1), slope_by(k));
  }

  std::vector<double> x_, force_, work_;  // work_: at the points
  std::vector<Piece<double>> pieces_;
};

}  // namespace poise

#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "model/planar.hpp"
#include "model/profile.hpp"
#include "model/scene.hpp"

namespace poise {

/// Where points are along the polygon through them, in scalars T: sums of chords from the first; of a closed one with
/// the first point once more at the end.
template <class T>
std::vector<T> sums_of_chords(const std::vector<Planar<T>>& points, bool is_closed) {
  std::vector<T> along{T(0)};
  for (std::size_t k = 1; k < points.size() + (is_closed ? 1 : 0); ++k) {
    along.push_back(along.back() + norm(points[k % points.size()] - points[k - 1]));
  }
  return along;
}

/// A curve of a body that rolls on another, in scalars T: in dual numbers with exact derivatives by its points. It is
/// the cubic spline r(u) through them, u from 0 to 1 over the sum of its chords; a closed one repeats, an open one has
/// ends as curved as what is behind them.
template <class T>
class RollingCurve {
 public:
  /// Of a piece of the spline what lies from s = begin to s = end on it.
  struct Part {
    std::size_t piece = 0;
    double begin = 0.0, end = 1.0;
  };

  /// Through three points or more, m, each unlike the one before; of a closed curve without the first once more.
  RollingCurve(const std::vector<Planar<T>>& points, bool is_closed) : is_closed_(is_closed) {
    std::vector<T> u = sums_of_chords(points, is_closed), x, y;
    chords_ = u.back();
    for (std::size_t k = 0; k < u.size(); ++k) {
      u[k] = T(u[k] / chords_);
      x.push_back(points[k % points.size()].x);
      y.push_back(points[k % points.size()].y);
    }
    u.back() = T(1);
    x_ = ProfileIn<T>::spline(u, x, is_closed, true).pieces();
    y_ = ProfileIn<T>::spline(u, y, is_closed, true).pieces();
  }

  /// The sum of its chords, m.
  const T& chords() const { return chords_; }
  /// r(u) as two splines.
  std::pair<ProfileIn<T>, ProfileIn<T>> components() const {
    return {ProfileIn<T>(x_, is_closed_), ProfileIn<T>(y_, is_closed_)};
  }

  /// Short ones (ProfileIn::is_short), in order; none if the curve comes to a stop somewhere, or nearly so, as in a
  /// cusp.
  std::optional<std::vector<Part>> parts() const {
    std::vector<Part> out;
    for (std::size_t k = 0; k < x_.size(); ++k) {
      if (!add_parts({k, 0.0, 1.0}, 0, out)) return std::nullopt;
    }
    return out;
  }

  /// One of its functions (RollingProfile). The angle at the first point is within half a turn of `near`; with that 0
  /// in (-pi, pi].
  ProfileIn<T> function(ProfileLaw law, const std::vector<Part>& parts, double near = 0.0) const {
    std::vector<Piece> pieces;
    for (const Part& part : parts) {
      pieces.push_back(part_of(part));
      pieces.back().law = law;
    }
    if (law != ProfileLaw::tangent_angle && law != ProfileLaw::arc_length) return {std::move(pieces), is_closed_};
    using std::atan2;
    using std::floor;
    const T turn = T(2) * pi_of<T>();
    const auto turns = [&](const T& angle) { return T(floor(T(angle / turn + T(0.5)))); };
    T begin(0);
    if (law == ProfileLaw::tangent_angle) {
      const auto slope = [](const std::vector<Piece>& of) {
        return ProfileIn<T>::on(of.front(), of.front().from).first;
      };
      begin = atan2(slope(y_), slope(x_));
      begin = begin + turn * turns(T(near) - begin);
    }
    const T rise = follow(begin, pieces) - begin;
    return {std::move(pieces), is_closed_, law == ProfileLaw::tangent_angle ? T(turn * turns(rise)) : rise};
  }

 private:
  using Piece = typename ProfileIn<T>::Piece;
  // So many halvings of a piece of the spline are enough but where it nearly stops.
  static constexpr int most_halvings = 12;

  /// About its middle.
  Piece part_of(const Part& part) const {
    const Piece &x = x_[part.piece], &y = y_[part.piece];
    const auto u = [&](double s) {
      if (s == 0.0) return x.from;
      return s == 1.0 ? x.to : T(x.from + T(s) * (x.to - x.from));
    };
    Piece out{u(part.begin), u(part.end)};
    const T s(0.5 * (part.begin + part.end)), w(part.end - part.begin);
    std::size_t first = 1;
    for (const auto* piece : {&x, &y}) {
      const auto& c = piece->c;
      out.c[first] = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
      out.c[first + 1] = w * (c[1] + s * (T(2) * c[2] + T(3) * s * c[3]));
      out.c[first + 2] = w * w * (c[2] + T(3) * s * c[3]);
      out.c[first + 3] = w * w * w * c[3];
      first += 4;
    }
    return out;
  }

  bool add_parts(const Part& part, int halvings, std::vector<Part>& out) const {
    if (ProfileIn<T>::is_short(part_of(part))) {
      out.push_back(part);
      return true;
    }
    if (halvings == most_halvings) return false;
    const double middle = 0.5 * (part.begin + part.end);
    return add_parts({part.piece, part.begin, middle}, halvings + 1, out) &&
           add_parts({part.piece, middle, part.end}, halvings + 1, out);
  }

  /// Lets the pieces go on from each to the next, from `begin` on. Returns where they end.
  static T follow(T begin, std::vector<Piece>& pieces) {
    for (Piece& piece : pieces) {
      piece.c[0] = T(0);
      const T first = ProfileIn<T>::on(piece, piece.from).value, last = ProfileIn<T>::on(piece, piece.to).value;
      piece.c[0] = begin - first;
      begin = piece.c[0] + last;
    }
    return begin;
  }

  std::vector<Piece> x_, y_;  // of the splines
  T chords_{};
  bool is_closed_;
};

/// The functions of such a curve. With the tangent's angle a from the x axis of the body,
///
///   angle    a, rad, unwrapped
///   length   arc from the first point, m
///   along    r.(cos a, sin a), m
///   across   r.(-sin a, cos a), m: - the distance of the tangent from the origin where that is on its left
///
/// along' = angle' across + length',  across' = -angle' along.  The curvature is angle' / length', positive where the
/// curve bends to its left.
struct RollingProfile {
  double chords = 0.0;  ///< their sum, m
  std::shared_ptr<const Profile> angle, length, along, across;

  const std::shared_ptr<const Profile>& of(ProfileLaw law) const;
};

/// Through points as RollingCurve, and with its first angle near `near`. None if the curve comes to a stop.
std::optional<RollingProfile> rolling_profile(const std::vector<Vec2>& points, bool is_closed, double near = 0.0);
/// The same of a curve that rolls on what has the curvature `least`, 1/m, to the left positive: throws InputError where
/// it stops, as in a cusp, closes clockwise, goes round more than once, or is nowhere more curved than that.
RollingProfile rolling_profile_on(double least, const std::vector<Vec2>& points, bool is_closed, double near = 0.0);

/// Whether a curve of that angle bends to its left everywhere. With r = c_1 + c_2 t + c_3 t^2 + c_4 t^3 of a piece,
///   r' x r'' = 2 c_2 x c_3 + 6 t c_2 x c_4 + 6 t^2 c_3 x c_4 > 0,  |t| <= 1/2.
bool is_convex(const Profile& angle);

/// Where the curve of a profile that rolls, or the first of a contact of curves, or the one that it is against, has its
/// point at u, m, from its origin and along the axes of its body; `rows` are its stops, from the first on.
Vec2 point_of_profile(const Stop* rows, double u, bool is_against = false);
/// From where to where it rolls, as u: of an open one between its ends, of a closed one all round.
std::pair<double, double> range_of_profile(const Scene& scene, std::size_t first);

}  // namespace poise

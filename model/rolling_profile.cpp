#include "model/rolling_profile.hpp"

#include <cmath>
#include <utility>

#include "model/couplings.hpp"

namespace poise {
namespace {

// So many halvings of a piece of the spline are enough but where it nearly stops.
constexpr int most_halvings = 12;

using Pieces = std::vector<Profile::Piece>;

/// The part of a piece of the spline from s = begin to s = end, about its middle.
Profile::Piece part_of(const Profile::Piece& x, const Profile::Piece& y, double begin, double end) {
  const auto u = [&](double s) {
    if (s == 0.0) return x.from;
    return s == 1.0 ? x.to : x.from + s * (x.to - x.from);
  };
  Profile::Piece out{u(begin), u(end)};
  const double s = 0.5 * (begin + end), w = end - begin;
  std::size_t first = 1;
  for (const auto& c : {x.c, y.c}) {
    out.c[first] = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
    out.c[first + 1] = w * (c[1] + s * (2 * c[2] + 3 * s * c[3]));
    out.c[first + 2] = w * w * (c[2] + 3 * s * c[3]);
    out.c[first + 3] = w * w * w * c[3];
    first += 4;
  }
  return out;
}

/// Short pieces of the curve; false where it stops.
bool add_parts(const Profile::Piece& x, const Profile::Piece& y, double begin, double end, int halvings, Pieces& out) {
  const Profile::Piece whole = part_of(x, y, begin, end);
  if (Profile::is_short(whole)) {
    out.push_back(whole);
    return true;
  }
  if (halvings == most_halvings) return false;
  const double middle = 0.5 * (begin + end);
  return add_parts(x, y, begin, middle, halvings + 1, out) && add_parts(x, y, middle, end, halvings + 1, out);
}

/// The pieces with a law whose value is `begin` at the first of them, and goes on from each to the next. Returns where
/// it ends.
double follow(Profile::Law law, double begin, Pieces& pieces) {
  for (Profile::Piece& piece : pieces) {
    piece.law = law;
    piece.c[0] = 0.0;
    const Profile alone({piece}, false);
    const double first = alone.at(piece.from).value, last = alone.at(piece.to).value;
    piece.c[0] = begin - first;
    begin = piece.c[0] + last;
  }
  return begin;
}

}  // namespace

std::vector<double> sums_of_chords(const std::vector<Vec2>& points, bool is_closed) {
  std::vector<double> along{0.0};
  for (std::size_t k = 1; k < points.size() + (is_closed ? 1 : 0); ++k) {
    along.push_back(along.back() + norm(points[k % points.size()] - points[k - 1]));
  }
  return along;
}

std::optional<RollingProfile> rolling_profile(const std::vector<Vec2>& points, bool is_closed) {
  // A closed curve has its first point at its end already.
  std::vector<double> u = sums_of_chords(points, false), x, y;
  for (const Vec2& point : points) {
    x.push_back(point.x);
    y.push_back(point.y);
  }
  RollingProfile out;
  out.chords = u.back();
  for (double& one : u) one /= out.chords;
  u.back() = 1.0;
  const Profile of_x = Profile::spline(u, x, is_closed, true), of_y = Profile::spline(u, y, is_closed, true);
  Pieces pieces;
  for (std::size_t k = 0; k < of_x.pieces().size(); ++k) {
    if (!add_parts(of_x.pieces()[k], of_y.pieces()[k], 0.0, 1.0, 0, pieces)) return std::nullopt;
  }
  const auto profile = [&](Profile::Law law, double begin) {
    const double rise = follow(law, begin, pieces) - begin;
    const double turns = std::round(rise / (2 * M_PI));
    return std::make_shared<const Profile>(pieces, is_closed,
                                           law == Profile::Law::tangent_angle ? 2 * M_PI * turns : rise);
  };
  out.angle = profile(Profile::Law::tangent_angle, std::atan2(of_y.at(0.0).first, of_x.at(0.0).first));
  out.length = profile(Profile::Law::arc_length, 0.0);
  const auto plain = [&](Profile::Law law) {
    for (Profile::Piece& piece : pieces) {
      piece.law = law;
      piece.c[0] = 0.0;
    }
    return std::make_shared<const Profile>(pieces, is_closed);
  };
  out.along = plain(Profile::Law::along_tangent);
  out.across = plain(Profile::Law::across_tangent);
  return out;
}

Vec2 point_of_profile(const Stop* rows, double u) {
  const auto value = [&](int row, std::size_t term) {
    const Measure::Term& of = rows[row].on.terms[term];
    return std::abs(of.factor) * of.profile->at(u).value;
  };
  return Vec2{value(1, 1), value(0, 1)} * unit(value(2, 1));
}

std::pair<double, double> range_of_profile(const Scene& scene, std::size_t first) {
  const double span = scene.stops[first].on.terms[1].span;
  for (std::size_t s = first + 1; s < scene.stops.size(); ++s) {
    const Stop& row = scene.stops[s];
    const CouplingKind* const kind = coupling_kind(row);
    if (kind == nullptr || kind->row == 0) break;
    if (row.table.ends_with("_ends")) return {row.min / span, row.max / span};
  }
  return {0.0, 1.0};
}

}  // namespace poise

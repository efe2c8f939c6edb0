#include "design/synthesis/centre_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "design/synthesis/private/dyad_equations.hpp"
#include "design/synthesis/private/exact_algebra.hpp"

namespace poise {
namespace synthesis {
namespace {

/// A polynomial of t whose coefficients are polynomials of s.
using PlanePolynomial = std::vector<BallPolynomial>;

PlanePolynomial times(const PlanePolynomial& a, const PlanePolynomial& b) {
  PlanePolynomial out(a.size() + b.size() - 1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) out[i + j] = out[i + j] + a[i] * b[j];
  }
  return out;
}

PlanePolynomial combined(PlanePolynomial a, const PlanePolynomial& b, int factor) {
  a.resize(std::max(a.size(), b.size()));
  for (std::size_t i = 0; i < b.size(); ++i) a[i] = a[i] + BallPolynomial{Ball(factor)} * b[i];
  return a;
}

/// The pivots at + s along + t across, all in the frame of the task.
struct Grid {
  Vec2 at{}, along{}, across{};
};

/// A form c + x ux + y uy on a grid.
PlanePolynomial on_grid(const Ball& c, const Ball& x, const Ball& y, const Grid& g) {
  const auto dot_with = [&](const Vec2& v) { return x * Ball(v.x) + y * Ball(v.y); };
  return {{c + dot_with(g.at), dot_with(g.along)}, {dot_with(g.across)}};
}

/// The conditions of the positions less that of the first one, linear in the pin w: rows of the factors of wx and wy
/// and of the rest, as functions of the pivot.
using PinRows = std::array<std::array<PlanePolynomial, 3>, 3>;

PinRows pin_rows(std::span<const BodyPosition> four, const DyadFrame& frame, const Grid& grid) {
  const BallRows rows = dyad_equations(four, frame);
  PinRows out;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto less = [&](std::size_t k) { return rows[i + 1][k] - rows[0][k]; };
    const Ball p = less(scalar), q = less(vector);
    out[i][0] = on_grid(less(moving_x), p, q, grid);
    out[i][1] = on_grid(less(moving_y), -q, p, grid);
    out[i][2] = on_grid(less(one), less(fixed_x), less(fixed_y), grid);
  }
  return out;
}

/// Their determinant, which is 0 on the curve of centres.
PlanePolynomial determinant_of(const PinRows& m) {
  PlanePolynomial out{{Ball()}};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
    const PlanePolynomial minor = combined(times(m[1][a], m[2][b]), times(m[1][b], m[2][a]), -1);
    out = combined(std::move(out), times(m[0][k], minor), 1);
  }
  return out;
}

/// The discriminant of a cubic of t, a polynomial of s.
BallPolynomial discriminant_of(const PlanePolynomial& cubic) {
  const BallPolynomial &a = cubic[3], &b = cubic[2], &c = cubic[1], &d = cubic[0];
  const auto number = [](int factor) { return BallPolynomial{Ball(factor)}; };
  return number(18) * a * b * c * d - number(4) * b * b * b * d + b * b * c * c - number(4) * a * c * c * c -
         number(27) * a * a * d * d;
}

/// Without the coefficients at its end that are 0 to rounding, of a polynomial of numbers of the size 1.
BallPolynomial trimmed(BallPolynomial p) {
  constexpr double nothing = 1e-13;
  double largest = 0.0;
  for (const Ball& one : p) largest = std::max(largest, std::abs(one.middle()));
  while (!p.empty() && std::abs(p.back().middle()) <= nothing * largest) p.pop_back();
  return p;
}

/// The link with this pivot at t on a line, s = 0; empty where its pin is at infinity.
std::optional<GuidingDyad> link_at(const PinRows& rows, const Grid& line, const Ball& t, const DyadFrame& frame) {
  constexpr double nothing = 1e-10;
  std::array<std::array<Ball, 3>, 3> m;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const PlanePolynomial& form = rows[i][k];
      m[i][k] = form[0][0] + t * form[1][0];
    }
  }
  std::size_t best = 0;
  Ball largest;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const Ball minor = m[i][0] * m[j][1] - m[i][1] * m[j][0];
    if (std::abs(minor.middle()) > std::abs(largest.middle())) {
      largest = minor;
      best = i;
    }
  }
  if (!(std::abs(largest.middle()) > nothing)) return std::nullopt;
  const auto &a = m[best], &b = m[(best + 1) % 3];
  const Ball wx = (a[1] * b[2] - a[2] * b[1]) / largest, wy = (a[2] * b[0] - a[0] * b[2]) / largest;
  const Ball ux = Ball(line.at.x) + t * Ball(line.across.x), uy = Ball(line.at.y) + t * Ball(line.across.y);
  GuidingDyad out;
  out.fixed = frame.middle + frame.size * Vec2{ux.middle(), uy.middle()};
  out.moving = frame.size * Vec2{wx.middle(), wy.middle()};
  out.radius = frame.size * std::max({ux.radius(), uy.radius(), wx.radius(), wy.radius()});
  return out;
}

/// The links with pivots on a line of the frame; `proved` where these are proved to be all of it.
std::vector<GuidingDyad> links_on(std::span<const BodyPosition> four, const DyadFrame& frame, const Grid& line,
                                  bool& proved) {
  const PinRows rows = pin_rows(four, frame, line);
  BallPolynomial on_line;
  for (const BallPolynomial& one : determinant_of(rows)) on_line.push_back(one.front());
  const PolynomialRoots roots = roots_of(trimmed(std::move(on_line)));
  proved = roots.isolated;
  std::vector<GuidingDyad> out;
  for (const Ball& t : roots.real) {
    auto link = link_at(rows, line, t, frame);
    if (!link) continue;
    link->proved = roots.isolated;
    link->length = norm(world_of(four.front(), link->moving) - link->fixed);
    out.push_back(*link);
  }
  return out;
}

/// The links of a line across the asymptote.
struct Line {
  double s = 0.0;
  std::vector<GuidingDyad> links;
  bool proved = false;
};
using Lines = std::vector<Line>;

/// Lines between two turns of the curve, so many and where the curve is steep more.
Lines lines_between(std::span<const BodyPosition> four, const DyadFrame& frame, Grid grid, const Vec2& ends,
                    int number) {
  constexpr double most_apart = 0.2;
  constexpr std::size_t most_lines = 400;
  const auto line_at = [&](double s) {
    Line out{s, {}, false};
    grid.at = s * grid.along;
    out.links = links_on(four, frame, grid, out.proved);
    return out;
  };
  Lines out;
  for (int i = 0; i < number; ++i) {
    // Closer to each other near the ends, where arcs meet.
    const double part = 0.5 - 0.5 * std::cos(std::numbers::pi * (i + 0.5) / number);
    out.push_back(line_at(ends.x + part * (ends.y - ends.x)));
  }
  const auto far_apart = [&](const Line& a, const Line& b) {
    for (std::size_t k = 0; k < std::min(a.links.size(), b.links.size()); ++k) {
      if (norm(a.links[k].fixed - b.links[k].fixed) > most_apart * frame.size) return true;
    }
    return false;
  };
  for (std::size_t k = 1; k < out.size() && out.size() < most_lines;) {
    if (far_apart(out[k - 1], out[k])) {
      out.insert(out.begin() + static_cast<std::ptrdiff_t>(k), line_at(0.5 * (out[k - 1].s + out[k].s)));
    } else {
      ++k;
    }
  }
  return out;
}

/// The direction of the asymptote: the terms of the third degree are (x^2 + y^2)(a x + b y); none where these are 0.
std::optional<Vec2> asymptote_of(std::span<const BodyPosition> four, const DyadFrame& frame) {
  constexpr double nothing = 1e-12;
  const auto leading = [&](const Vec2& direction) {
    const PlanePolynomial cubic = determinant_of(pin_rows(four, frame, {{}, quarter_turn(direction), direction}));
    return cubic[3].front().middle();
  };
  const Vec2 normal{leading({1, 0}), leading({0, 1})};
  const double size = norm(normal);
  if (!(size > nothing)) return std::nullopt;
  return (1 / size) * quarter_turn(normal);
}

/// The slides of four positions: solutions of the linear conditions with a pivot, or a pin, at infinity.
void add_slides(std::span<const BodyPosition> four, const DyadFrame& frame, std::vector<GuidingDyad>& out) {
  for (const bool on_ground : {true, false}) {
    const std::size_t far_x = on_ground ? fixed_x : moving_x, far_y = on_ground ? fixed_y : moving_y;
    BallRows rows;
    for (const std::vector<Ball>& row : dyad_equations(four, frame)) {
      rows.push_back({row[far_x], row[far_y], row[squares], row[scalar], row[vector]});
    }
    const BallRows found = null_space(std::move(rows));
    if (found.size() != 1) continue;
    const auto value = [&](std::size_t k) { return found.front()[k].middle(); };
    out.push_back(slide_of(on_ground, {value(0), value(1)}, {value(3), value(4)}, frame));
  }
}

std::optional<Vec2> circle_centre(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 p = b - a, q = c - a;
  const double area = 2 * cross(p, q);
  if (std::abs(area) <= 1e-12 * (dot(p, p) + dot(q, q))) return std::nullopt;
  return a + (1 / area) * Vec2{q.y * dot(p, p) - p.y * dot(q, q), p.x * dot(q, q) - q.x * dot(p, p)};
}

}  // namespace
}  // namespace synthesis

CentreCurve centre_curve(std::span<const BodyPosition> four, int points_on_arc) {
  using namespace synthesis;
  CentreCurve out;
  const DyadFrame frame = frame_of(four);
  const auto along = asymptote_of(four, frame);
  if (!along) {
    out.dependent = true;
    return out;
  }
  Grid grid{{}, *along, quarter_turn(*along)};
  const PolynomialRoots turns = roots_of(trimmed(discriminant_of(determinant_of(pin_rows(four, frame, grid)))));
  out.complete = turns.isolated;
  constexpr double beyond = 6.0;
  std::vector<double> ends;
  for (const Ball& s : turns.real) ends.push_back(s.middle());
  const double first = ends.empty() ? 0.0 : std::min(0.0, ends.front());
  const double last = ends.empty() ? 0.0 : std::max(0.0, ends.back());
  ends.insert(ends.begin(), first - beyond);
  ends.push_back(last + beyond);
  for (std::size_t k = 1; k < ends.size(); ++k) {
    const Lines lines = lines_between(four, frame, grid, {ends[k - 1], ends[k]}, points_on_arc);
    std::size_t arcs = 0;
    for (const Line& line : lines) {
      out.complete = out.complete && line.proved;
      arcs = std::max(arcs, line.links.size());
    }
    for (std::size_t arc = 0; arc < arcs; ++arc) {
      ++out.arcs;
      for (const Line& line : lines) {
        if (arc < line.links.size()) out.links.push_back({out.arcs, line.links[arc]});
      }
    }
  }
  add_slides(four, frame, out.slides);
  return out;
}

std::vector<GuidingDyad> links_on_line(std::span<const BodyPosition> four, const Vec2& at, const Vec2& direction) {
  using namespace synthesis;
  const DyadFrame frame = frame_of(four);
  bool proved = false;
  const Vec2 across = (1 / norm(direction)) * direction;
  return links_on(four, frame, {(1 / frame.size) * (at - frame.middle), quarter_turn(across), across}, proved);
}

std::optional<GuidingDyad> link_near(std::span<const BodyPosition> four, const CentreCurve& curve, const Vec2& place) {
  using namespace synthesis;
  if (curve.links.empty()) return std::nullopt;
  const DyadFrame frame = frame_of(four);
  const auto distance = [&](const GuidingDyad& link) { return norm(link.fixed - place); };
  GuidingDyad best = std::min_element(curve.links.begin(), curve.links.end(), [&](const auto& a, const auto& b) {
                       return distance(a.link) < distance(b.link);
                     })->link;
  // Towards the foot of the place on the tangent, then to the curve across it, while that comes nearer.
  constexpr int most_steps = 200;
  constexpr double least_part = 1e-9;
  double part = 1.0;
  for (int step = 0; step < most_steps && part > least_part; ++step) {
    const Vec2 at = (1 / frame.size) * (best.fixed - frame.middle);
    const PlanePolynomial around = determinant_of(pin_rows(four, frame, {at, {1, 0}, {0, 1}}));
    const Vec2 gradient{around[0][1].middle(), around[1][0].middle()};
    if (norm(gradient) == 0.0) break;
    const Vec2 tangent = (1 / norm(gradient)) * quarter_turn(gradient);
    const Vec2 foot = best.fixed + part * dot(place - best.fixed, tangent) * tangent;
    const std::vector<GuidingDyad> next = links_on_line(four, foot, gradient);
    const auto nearest = std::min_element(next.begin(), next.end(), [&](const GuidingDyad& a, const GuidingDyad& b) {
      return norm(a.fixed - foot) < norm(b.fixed - foot);
    });
    if (nearest != next.end() && distance(*nearest) < distance(best)) {
      best = *nearest;
    } else {
      part *= 0.5;
    }
  }
  return best;
}

std::optional<GuidingDyad> link_with_pin(std::span<const BodyPosition> three, const Vec2& moving) {
  const auto centre =
      synthesis::circle_centre(world_of(three[0], moving), world_of(three[1], moving), world_of(three[2], moving));
  if (!centre) return std::nullopt;
  GuidingDyad out;
  out.fixed = *centre;
  out.moving = moving;
  out.length = norm(world_of(three[0], moving) - *centre);
  return out;
}

std::optional<GuidingDyad> link_with_pivot(std::span<const BodyPosition> three, const Vec2& fixed) {
  const auto in_body = [&](const BodyPosition& p) { return unit(-p.angle) * (fixed - p.at); };
  const auto centre = synthesis::circle_centre(in_body(three[0]), in_body(three[1]), in_body(three[2]));
  if (!centre) return std::nullopt;
  GuidingDyad out;
  out.fixed = fixed;
  out.moving = *centre;
  out.length = norm(world_of(three[0], *centre) - fixed);
  return out;
}

}  // namespace poise

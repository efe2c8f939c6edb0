#include "design/synthesis/dyads.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "design/synthesis/private/dyad_equations.hpp"
#include "design/synthesis/private/exact_algebra.hpp"

namespace poise {
namespace synthesis {
namespace {

using BallVector = std::vector<Ball>;

/// A quadratic form of three variables, by coefficients of the products of variables i <= j.
struct Conic {
  Ball of[3][3];
};

/// The form a(y) b(y) - (c(y) d(y) + s e(y) f(y)) of linear forms of y, each a column of `basis`.
Conic conic_of(const BallRows& basis, std::array<std::size_t, 6> columns, int s) {
  Conic out;
  const auto add = [&](std::size_t a, std::size_t b, int factor) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        out.of[std::min(i, j)][std::max(i, j)] += Ball(factor) * basis[i][a] * basis[j][b];
      }
    }
  };
  add(columns[0], columns[1], 1);
  add(columns[2], columns[3], -1);
  add(columns[4], columns[5], -s);
  return out;
}

/// As polynomials of y_0 with y_1 = 1: the coefficients of 1, y_2 and y_2^2.
std::array<BallPolynomial, 3> in_last(const Conic& c) {
  return {BallPolynomial{c.of[1][1], c.of[0][1], c.of[0][0]}, BallPolynomial{c.of[1][2], c.of[0][2]},
          BallPolynomial{c.of[2][2]}};
}

/// Points where two conics meet.
struct Meeting {
  bool isolated = false;
  int others = 0;                  // that are not real
  std::vector<BallVector> points;  // homogeneous coordinates
};

std::optional<Meeting> meeting_of(const Conic& first, const Conic& second) {
  const auto a = in_last(first), b = in_last(second);
  const BallPolynomial outer = a[2] * b[0] - b[2] * a[0], left = a[2] * b[1] - b[2] * a[1];
  const BallPolynomial right = a[1] * b[0] - b[1] * a[0];
  const PolynomialRoots roots = roots_of(outer * outer - left * right);
  Meeting out{roots.isolated, roots.others, {}};
  for (const Ball& x : roots.real) {
    const Ball below = value_of(left, x);
    if (below.contains_zero()) return std::nullopt;
    out.points.push_back({x, Ball(1), -value_of(outer, x) / below});
  }
  return out;
}

BallRows turned(const BallRows& basis, int attempt) {
  const auto rotation = generic_rotation(basis.size(), attempt);
  BallRows out(basis.size(), BallVector(basis.front().size()));
  for (std::size_t i = 0; i < basis.size(); ++i) {
    for (std::size_t k = 0; k < basis.size(); ++k) {
      for (std::size_t j = 0; j < basis[k].size(); ++j) out[i][j] += Ball(rotation[i][k]) * basis[k][j];
    }
  }
  return out;
}

Vec2 middle_of(const Ball& x, const Ball& y) { return {x.middle(), y.middle()}; }

/// The dyad of a solution of the linear conditions, its largest entry 1.
GuidingDyad dyad_of(const BallVector& v, const DyadFrame& frame) {
  constexpr double nothing = 1e-12;
  double largest = 0.0;
  for (const Ball& one : v) largest = std::max(largest, std::abs(one.middle()));
  GuidingDyad out;
  const Vec2 w = middle_of(v[moving_x], v[moving_y]), u = middle_of(v[fixed_x], v[fixed_y]);
  if (std::abs(v[one].middle()) > nothing * largest) {
    const Ball ux = v[fixed_x] / v[one], uy = v[fixed_y] / v[one], wx = v[moving_x] / v[one], wy = v[moving_y] / v[one];
    out.fixed = frame.middle + frame.size * middle_of(ux, uy);
    out.moving = frame.size * middle_of(wx, wy);
    out.radius = frame.size * std::max({ux.radius(), uy.radius(), wx.radius(), wy.radius()});
    out.proved = true;
    return out;
  }
  const bool on_ground = norm(u) > norm(w);
  return slide_of(on_ground, on_ground ? u : w, middle_of(v[scalar], v[vector]), frame);
}

}  // namespace

GuidingDyad slide_of(bool on_ground, const Vec2& far, const Vec2& products, const DyadFrame& frame) {
  GuidingDyad out;
  const double square = dot(far, far);
  out.axis = (1 / std::sqrt(square)) * quarter_turn(far);
  if (on_ground) {
    out.kind = GuidingDyad::Kind::slide_on_ground;
    out.moving = (frame.size / square) * (far * conj(products));
  } else {
    out.kind = GuidingDyad::Kind::slide_on_body;
    out.fixed = frame.middle + (frame.size / square) * (far * products);
  }
  return out;
}

DyadFrame frame_of(std::span<const BodyPosition> positions) {
  DyadFrame out;
  for (const BodyPosition& p : positions) out.middle += (1.0 / static_cast<double>(positions.size())) * p.at;
  for (const BodyPosition& p : positions) out.size = std::max(out.size, norm(p.at - out.middle));
  if (out.size == 0.0) out.size = 1.0;
  return out;
}

BallRows dyad_equations(std::span<const BodyPosition> positions, const DyadFrame& frame) {
  BallRows out;
  for (const BodyPosition& p : positions) {
    const Ball size(frame.size), two(2);
    const Ball x = (Ball(p.at.x) - Ball(frame.middle.x)) / size, y = (Ball(p.at.y) - Ball(frame.middle.y)) / size;
    const Ball c = cos(Ball(p.angle)), s = sin(Ball(p.angle));
    BallVector row(unknowns_of_dyad);
    row[one] = x * x + y * y;
    row[moving_x] = two * (c * x + s * y);
    row[moving_y] = two * (c * y - s * x);
    row[fixed_x] = -two * x;
    row[fixed_y] = -two * y;
    row[squares] = Ball(1);
    row[scalar] = -two * c;
    row[vector] = -two * s;
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace synthesis

Vec2 world_of(const BodyPosition& position, const Vec2& point) { return position.at + unit(position.angle) * point; }

double misfit_of(const GuidingDyad& dyad, std::span<const BodyPosition> positions) {
  double least = INFINITY, most = -INFINITY;
  for (const BodyPosition& p : positions) {
    double value = 0.0;
    switch (dyad.kind) {
      case GuidingDyad::Kind::link:
        value = norm(world_of(p, dyad.moving) - dyad.fixed);
        break;
      case GuidingDyad::Kind::slide_on_ground:
        value = cross(dyad.axis, world_of(p, dyad.moving));
        break;
      case GuidingDyad::Kind::slide_on_body:
        value = cross(dyad.axis, unit(-p.angle) * (dyad.fixed - p.at));
        break;
    }
    least = std::min(least, value);
    most = std::max(most, value);
  }
  return most - least;
}

FiveDyads dyads_through(std::span<const BodyPosition> five) {
  using namespace synthesis;
  FiveDyads out;
  const DyadFrame frame = frame_of(five);
  const BallRows plane = null_space(dyad_equations(five, frame));
  if (plane.empty()) {
    out.dependent = true;
    return out;
  }
  // Two solutions may lie on one line with the centre of elimination, or one may be at its infinity: then other
  // coordinates of the plane are taken.
  constexpr int most_attempts = 5;
  constexpr double near_solution = 1e-10;
  std::optional<Meeting> meeting;
  BallRows basis;
  for (int attempt = 0; attempt < most_attempts && (!meeting || !meeting->isolated); ++attempt) {
    basis = turned(plane, attempt);
    auto next = meeting_of(conic_of(basis, {scalar, one, fixed_x, moving_x, fixed_y, moving_y}, 1),
                           conic_of(basis, {vector, one, fixed_y, moving_x, fixed_x, moving_y}, -1));
    if (next) meeting = std::move(next);
  }
  if (!meeting) return out;
  out.complete = meeting->isolated;
  out.complex = meeting->others;
  for (const BallVector& point : meeting->points) {
    BallVector v(unknowns_of_dyad);
    for (std::size_t i = 0; i < point.size(); ++i) {
      for (std::size_t j = 0; j < v.size(); ++j) v[j] += point[i] * basis[i][j];
    }
    GuidingDyad dyad = dyad_of(v, frame);
    dyad.proved = dyad.proved && out.complete;
    if (dyad.kind == GuidingDyad::Kind::link) dyad.length = norm(world_of(five.front(), dyad.moving) - dyad.fixed);
    // Near a multiple solution may be places that are none.
    const double size = frame.size + norm(dyad.fixed - frame.middle) + norm(dyad.moving);
    if (!out.complete && misfit_of(dyad, five) > near_solution * size) continue;
    out.dyads.push_back(dyad);
  }
  std::sort(out.dyads.begin(), out.dyads.end(), [](const GuidingDyad& a, const GuidingDyad& b) {
    return std::pair(static_cast<int>(a.kind), a.fixed.x) < std::pair(static_cast<int>(b.kind), b.fixed.x);
  });
  return out;
}

}  // namespace poise

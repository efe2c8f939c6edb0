#include "model/outline_parts.hpp"

#include <cmath>
#include <cstddef>

#include "model/input_error.hpp"

namespace poise {
namespace outlines {
namespace {

using Corners = std::vector<OutlinePoint>;

/// The angle from one direction to another, counter-clockwise.
double turned(Vec2 from, Vec2 to) { return std::atan2(cross(from, to), dot(from, to)); }

/// The angle by which the way turns to the left at a point of it.
double turn_at(const Corners& way, std::size_t k) {
  const std::size_t n = way.size();
  const Vec2 at = way[k].at;
  return turned(at - way[(k + n - 1) % n].at, way[(k + 1) % n].at - at);
}

constexpr double rounding = 1e-9;

bool is_convex(const Corners& way) {
  for (std::size_t k = 0; k < way.size(); ++k) {
    if (turn_at(way, k) > rounding) return false;
  }
  return true;
}

Outline polygon(const Corners& way, bool backed = false) {
  Outline out{Outline::Form::polygon, {}, backed};
  for (const OutlinePoint& one : way) out.points.push_back(one.point);
  return out;
}

/// Whether no other point of the way is in the triangle of a point and its neighbours.
bool is_ear(const Corners& way, std::size_t k) {
  const std::size_t n = way.size();
  const std::size_t before = (k + n - 1) % n, behind = (k + 1) % n;
  const Vec2 a = way[before].at, b = way[k].at, c = way[behind].at;
  for (std::size_t other = 0; other < n; ++other) {
    if (other == before || other == k || other == behind) continue;
    const Vec2 p = way[other].at;
    if (cross(b - a, p - a) <= 0.0 && cross(c - b, p - b) <= 0.0 && cross(a - c, p - c) <= 0.0) return false;
  }
  return true;
}

std::vector<Outline> filled(Corners way) {
  std::vector<Outline> out;
  while (!is_convex(way)) {
    std::size_t sharpest = way.size();
    double least = -rounding;
    for (std::size_t k = 0; k < way.size(); ++k) {
      const double turn = turn_at(way, k);
      if (turn >= least || !is_ear(way, k)) continue;
      least = turn;
      sharpest = k;
    }
    if (sharpest == way.size()) throw InputError("expected an outline that does not cross itself");
    const std::size_t n = way.size();
    out.push_back(polygon({way[(sharpest + n - 1) % n], way[sharpest], way[(sharpest + 1) % n]}));
    way.erase(way.begin() + static_cast<std::ptrdiff_t>(sharpest));
  }
  out.insert(out.begin(), polygon(way));
  return out;
}

Outline closed_behind(const Corners& way) {
  const Vec2 chord = way.back().at - way.front().at;
  const double at_first = turned(chord, way[1].at - way[0].at);
  const double at_last = turned(way.back().at - way[way.size() - 2].at, chord);
  constexpr double widest = 0.75 * M_PI - 0.01;
  return polygon(way, at_first < widest && at_last < widest);
}

std::vector<Outline> cut(const Corners& way) {
  std::vector<Outline> out;
  Corners part{way[0], way[1]};
  double sum = 0.0;
  for (std::size_t k = 2; k < way.size(); ++k) {
    const double turn = turned(way[k - 1].at - way[k - 2].at, way[k].at - way[k - 1].at);
    sum -= turn;
    if (turn > rounding || sum > M_PI - 0.01) {
      out.push_back(closed_behind(part));
      part = {way[k - 1]};
      sum = 0.0;
    }
    part.push_back(way[k]);
  }
  out.push_back(closed_behind(part));
  return out;
}

}  // namespace
}  // namespace outlines

std::vector<Outline> parts_of_outline(const std::vector<OutlinePoint>& way, bool closed) {
  using namespace outlines;
  if (!closed) return cut(way);
  double around = 0.0;
  for (std::size_t k = 0; k < way.size(); ++k) around += turn_at(way, k);
  if (std::abs(std::abs(around) - 2 * M_PI) > 1.0) throw InputError("expected an outline that does not cross itself");
  if (around < 0.0) return filled(way);
  // From one of its corners to the left, which it has, back to it.
  Corners open;
  std::size_t first = 0;
  while (first < way.size() && !(turn_at(way, first) > rounding)) ++first;
  for (std::size_t k = 0; k <= way.size(); ++k) open.push_back(way[(first + k) % way.size()]);
  return cut(open);
}

}  // namespace poise

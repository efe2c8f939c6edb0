#include "design/synthesis/path_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace poise {
namespace {

constexpr double half_circle = std::numbers::pi;

/// In [0, period).
double modulo(double t, double period) {
  const double out = t - period * std::floor(t / period);
  return out < period ? out : 0.0;
}

// The angles of one circuit about their middle, and how far they reach from there.
struct CrankInterval {
  double middle = 0.0, reach = 0.0;
};

CrankInterval interval_at(const CrankRange& range, double angle) {
  const double nearest = std::acos(std::min(range.greatest, 1.0)), farthest = std::acos(std::max(range.least, -1.0));
  if (range.divided()) {
    const double side = std::sin(angle - range.zero) < 0.0 ? -1.0 : 1.0;
    return {range.zero + 0.5 * side * (nearest + farthest), 0.5 * (farthest - nearest)};
  }
  if (range.greatest >= 1.0) return {range.zero, farthest};
  return {range.zero + half_circle, half_circle - nearest};
}

// From the middle of an interval, in [-pi, pi].
double from_middle(const CrankInterval& interval, double angle) {
  return std::remainder(angle - interval.middle, 2 * half_circle);
}

// Where a visit is on its circuit, which returns to its begin after a period.
double place_on_circuit(const CrankRange& range, const PathVisit& visit) {
  if (range.full()) return modulo(visit.angle, 2 * half_circle);
  const CrankInterval interval = interval_at(range, visit.angle);
  const double at = std::clamp(from_middle(interval, visit.angle), -interval.reach, interval.reach);
  return visit.closure > 0 ? at + interval.reach : 3 * interval.reach - at;
}

double period_of(const CrankRange& range, double angle) {
  return range.full() ? 2 * half_circle : 4 * interval_at(range, angle).reach;
}

// Which of the circuits, 0 where there is one.
int circuit_index(const CrankRange& range, const PathVisit& visit) {
  if (range.full()) return visit.closure;
  if (!range.divided()) return 0;
  return std::sin(visit.angle - range.zero) < 0.0 ? -1 : 1;
}

bool in_order(const std::vector<double>& places, double period) {
  double forward = 0.0, backward = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    forward += modulo(places[i] - places[i - 1], period);
    backward += modulo(places[i - 1] - places[i], period);
  }
  return std::min(forward, backward) < period;
}

bool monotone(const std::vector<double>& places) {
  return std::is_sorted(places.begin(), places.end()) || std::is_sorted(places.rbegin(), places.rend());
}

double folded_angle(double cosine) { return std::acos(std::clamp(std::abs(cosine), 0.0, 1.0)); }

}  // namespace

CrankRange crank_range(PathLinkage linkage, std::span<const double> x) {
  const double crank = std::exp(x[at_crank]), coupler = std::exp(x[at_coupler]);
  if (linkage == PathLinkage::slider_crank) {
    return {x[at_b] + 0.5 * half_circle, (x[at_b + 1] - coupler) / crank, (x[at_b + 1] + coupler) / crank};
  }
  const double output = std::exp(x[at_output]);
  const Vec2 ground{x[at_b] - x[at_a], x[at_b + 1] - x[at_a + 1]};
  const double twice = 2 * norm(ground) * crank, squares = dot(ground, ground) + crank * crank;
  const double longest = coupler + output, least = coupler - output;
  return {std::atan2(ground.y, ground.x), (squares - longest * longest) / twice, (squares - least * least) / twice};
}

std::vector<PathVisit> visits_of(PathLinkage linkage, std::span<const double> x, std::span<const Vec2> places) {
  const double crank = std::exp(x[at_crank]), coupler = std::exp(x[at_coupler]), output = std::exp(x[at_output]);
  const Vec2 pivot{x[at_a], x[at_a + 1]}, far{x[at_b], x[at_b + 1]}, arm{x[at_point], x[at_point + 1]};
  const double length = norm(arm);
  const Vec2 across = linkage == PathLinkage::four_bar ? Vec2{} : quarter_turn(unit(x[at_b]));
  std::vector<PathVisit> out;
  for (const Vec2& place : places) {
    const Vec2 away = place - pivot;
    const double distance = norm(away);
    PathVisit best{std::atan2(away.y, away.x), 1};
    double least = std::numeric_limits<double>::infinity();
    const double along = (distance * distance + crank * crank - length * length) / (2 * distance * crank);
    for (const double side : {1.0, -1.0}) {
      if (length <= 1e-12 * coupler || !(distance > 0.0)) break;
      const double angle = std::atan2(away.y, away.x) + side * std::acos(std::clamp(along, -1.0, 1.0));
      const Vec2 pin = pivot + crank * unit(angle);
      const Vec2 turned = (place - pin) * conj(arm);
      const double size = norm(turned);
      if (!(size > 0.0)) continue;
      const Vec2 direction = (1 / size) * turned;
      const Vec2 end = pin + coupler * direction;
      const double miss = linkage == PathLinkage::four_bar ? std::abs(norm(end - far) - output)
                                                           : std::abs(dot(end - pivot, across) - x[at_b + 1]);
      if (miss >= least) continue;
      const Vec2 base = linkage == PathLinkage::four_bar ? far - pin : across;
      least = miss;
      best = {angle, cross(base, direction) < 0.0 ? -1 : 1};
    }
    out.push_back(best);
  }
  return out;
}

PathDefects defects_of(const CrankRange& range, std::span<const PathVisit> visits, bool order, bool full_turn) {
  PathDefects out;
  out.turn = full_turn && !range.full();
  if (visits.empty()) return out;
  for (const PathVisit& visit : visits) {
    out.circuit = out.circuit || circuit_index(range, visit) != circuit_index(range, visits[0]);
    out.branch = out.branch || visit.closure != visits[0].closure;
  }
  if (out.circuit) out.branch = false;
  if (out.circuit || !order) return out;
  std::vector<double> places;
  for (const PathVisit& visit : visits) places.push_back(place_on_circuit(range, visit));
  out.order = range.full() || out.branch ? !in_order(places, period_of(range, visits[0].angle)) : !monotone(places);
  return out;
}

std::string to_string(const PathDefects& defects) {
  std::string out;
  const auto add = [&](bool has, const char* name) {
    if (has) out += (out.empty() ? "" : ", ") + std::string(name);
  };
  add(defects.circuit, "circuit");
  add(defects.branch, "branch");
  add(defects.order, "order");
  add(defects.turn, "no full turn");
  add(defects.transmission, "transmission");
  return out.empty() ? "none" : out;
}

double least_transmission(PathLinkage linkage, std::span<const double> x, const CrankRange& range,
                          std::span<const PathVisit> visits) {
  const double crank = std::exp(x[at_crank]), coupler = std::exp(x[at_coupler]), output = std::exp(x[at_output]);
  const Vec2 ground{x[at_b] - x[at_a], x[at_b + 1] - x[at_a + 1]};
  // The angle at the output follows from the cosine of the crank's angle from `zero`.
  const auto angle_at = [&](double cosine) {
    if (linkage == PathLinkage::slider_crank) return folded_angle((x[at_b + 1] - crank * cosine) / coupler);
    const double square = dot(ground, ground) + crank * crank - 2 * norm(ground) * crank * cosine;
    return folded_angle((coupler * coupler + output * output - square) / (2 * coupler * output));
  };
  if (range.full()) return std::min(angle_at(1.0), angle_at(-1.0));
  double least = 0.5 * half_circle;
  for (const PathVisit& visit : visits) least = std::min(least, angle_at(std::cos(visit.angle - range.zero)));
  return least;
}

std::vector<PathVisit> once_round(const CrankRange& range, const PathVisit& from, int count) {
  std::vector<PathVisit> out;
  for (int k = 0; k < count; ++k) {
    const double turn = 2 * half_circle * k / count;
    if (range.full()) {
      out.push_back({from.angle + turn, from.closure});
    } else {
      const CrankInterval interval = interval_at(range, from.angle);
      out.push_back({interval.middle - interval.reach * std::cos(turn), turn < half_circle ? 1 : -1});
    }
  }
  return out;
}

}  // namespace poise

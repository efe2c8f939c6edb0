#include "design/synthesis/path_models.hpp"

#include <algorithm>
#include <cmath>

#include <ceres/jet.h>

namespace poise {
namespace {

// Derivatives by the unknowns of the linkage, and behind them that of the point.
using PathDual = ceres::Jet<double, path_unknowns + 1>;
using PathDuals = std::array<PathDual, path_unknowns>;

constexpr double weight_of_limits = 10.0;
constexpr double weight_of_gaps = 3.0;

PathDuals duals_of(std::span<const double> x) {
  PathDuals out;
  for (int j = 0; j < path_unknowns; ++j) out[j] = PathDual(x[j], j);
  return out;
}

double value_of(double x) { return x; }
double value_of(const PathDual& x) { return x.a; }

template <class T>
struct CouplerPlaceOf {
  Planar<T> point;
  T gap;
};

// The direction of the coupler, of length 1, of a triangle whose side from the crank's pin along `base` has the part
// `along` of the coupler's length; at the nearest dead point where that is beyond 1.
template <class T>
Planar<T> triangle_turn(const T& along, int closure) {
  using std::sqrt;
  const double a = value_of(along);
  if (!(std::abs(a) < 1.0)) return {T(a < 0.0 ? -1.0 : 1.0), T(0.0)};
  return {along, T(static_cast<double>(closure)) * sqrt(T(1.0) - along * along)};
}

template <class T, class X>
CouplerPlaceOf<T> coupler_place_of(PathLinkage linkage, const X& x, const T& angle, int closure) {
  using std::abs;
  using std::cos;
  using std::exp;
  using std::sin;
  const T crank = exp(x[at_crank]), coupler = exp(x[at_coupler]);
  const Planar<T> pivot{x[at_a], x[at_a + 1]};
  const Planar<T> pin = pivot + crank * Planar<T>{cos(angle), sin(angle)};
  Planar<T> base;  // of length 1
  T along;
  if (linkage == PathLinkage::four_bar) {
    const T output = exp(x[at_output]);
    const Planar<T> diagonal = Planar<T>{x[at_b], x[at_b + 1]} - pin;
    const T distance = norm(diagonal);
    base = (T(1.0) / distance) * diagonal;
    along = (distance * distance + coupler * coupler - output * output) / (T(2.0) * distance * coupler);
  } else {
    // The slider's pin is on a line; `base` is across it, towards it where the distance is positive.
    const Planar<T> line{cos(x[at_b]), sin(x[at_b])};
    base = quarter_turn(line);
    along = (x[at_b + 1] - dot(pin - pivot, base)) / coupler;
  }
  const Planar<T> direction = base * triangle_turn(along, closure);
  const T reach = abs(along) - T(1.0);
  return {pin + direction * Planar<T>{x[at_point], x[at_point + 1]}, value_of(reach) > 0.0 ? coupler * reach : T(0.0)};
}

template <class T, class X>
std::vector<T> beyond_limits_of(PathLinkage linkage, const X& x, const PathLimits& limits) {
  using std::abs;
  using std::exp;
  const T crank = exp(x[at_crank]), coupler = exp(x[at_coupler]);
  const bool four_bar = linkage == PathLinkage::four_bar;
  const Planar<T> a{x[at_a], x[at_a + 1]}, b{x[at_b], x[at_b + 1]};
  const Planar<T> point{x[at_point], x[at_point + 1]};
  std::vector<T> lengths{crank, coupler};
  std::vector<T> out;
  if (four_bar) {
    lengths.push_back(exp(x[at_output]));
    lengths.push_back(norm(b - a));
  }
  for (const T& length : lengths) {
    out.push_back(T(limits.shortest) - length);
    out.push_back(length - T(limits.longest));
  }
  out.push_back(norm(point) - T(limits.longest));
  if (limits.full_turn) {
    const T margin(limits.margin_of_turn);
    const T most(std::cos(limits.transmission));
    if (four_bar) {
      const T ground = lengths[3], output = lengths[2];
      out.push_back(ground + crank - coupler - output + margin);
      out.push_back(abs(coupler - output) - abs(ground - crank) + margin);
      for (const T& diagonal : {ground - crank, ground + crank}) {
        if (limits.transmission == 0.0) break;
        const T squares = coupler * coupler + output * output - diagonal * diagonal;
        out.push_back(abs(squares) / (T(2.0) * coupler * output) - most);
      }
    } else {
      out.push_back(abs(x[at_b + 1]) + crank - coupler + margin);
      if (limits.transmission > 0.0) out.push_back((abs(x[at_b + 1]) + crank) / coupler - most);
    }
  }
  if (limits.within) {
    const auto& [low, high] = *limits.within;
    for (const Planar<T>& pivot : four_bar ? std::vector<Planar<T>>{a, b} : std::vector<Planar<T>>{a}) {
      out.push_back(T(low.x) - pivot.x);
      out.push_back(T(low.y) - pivot.y);
      out.push_back(pivot.x - T(high.x));
      out.push_back(pivot.y - T(high.y));
    }
  }
  return out;
}

void write_row(const PathDual& value, int row, std::span<double> residuals, std::span<double> by_shared) {
  residuals[row] = value.a;
  for (int j = 0; j < path_unknowns; ++j) by_shared[row * path_unknowns + j] = value.v[j];
}

void forget_column(int column, int rows, std::span<double> by_shared) {
  for (int row = 0; row < rows; ++row) by_shared[row * path_unknowns + column] = 0.0;
}

void forget_pivots(int rows, std::span<double> by_shared) {
  for (int column = at_a; column < at_crank; ++column) forget_column(column, rows, by_shared);
}

}  // namespace

PathFit::PathFit(const Task& task, std::vector<int> closures) : task_(task), closures_(std::move(closures)) {
  const PathVector zero{};
  shifts_.assign(beyond_limits_of<double>(task.linkage, zero, task.limits).size(), 0.0);
}

bool PathFit::evaluate(int point, std::span<const double> x, double t, std::span<double> residuals,
                       std::span<double> by_shared, std::span<double> by_own) const {
  const PathDuals unknowns = duals_of(x);
  PathDual angle = task_.timed ? PathDual(t) : PathDual(t, path_unknowns);
  if (task_.timed && task_.start_free) angle += unknowns[at_start];
  if (task_.from_ground) {
    angle += atan2(unknowns[at_b + 1] - unknowns[at_a + 1], unknowns[at_b] - unknowns[at_a]);
  }
  const CouplerPlaceOf<PathDual> pose = coupler_place_of(task_.linkage, unknowns, angle, closures_[point]);
  const std::array rows{pose.point.x - task_.points[point].x, pose.point.y - task_.points[point].y,
                        weight_of_gaps * pose.gap};
  for (int row = 0; row < 3; ++row) {
    write_row(rows[row], row, residuals, by_shared);
    by_own[row] = rows[row].v[path_unknowns];
  }
  if (task_.pivots_given) forget_pivots(3, by_shared);
  return true;
}

bool PathFit::evaluate_more(std::span<const double> x, std::span<double> residuals, std::span<double> by_shared) const {
  const std::vector<PathDual> beyond = beyond_limits_of<PathDual>(task_.linkage, duals_of(x), task_.limits);
  for (std::size_t k = 0; k < beyond.size(); ++k) {
    const PathDual shifted = beyond[k] + shifts_[k];
    write_row(shifted.a > 0.0 ? weight_of_limits * shifted : PathDual(0.0), static_cast<int>(k), residuals, by_shared);
  }
  if (task_.pivots_given) forget_pivots(more_rows(), by_shared);
  return true;
}

double PathFit::tighten(std::span<const double> x) {
  const std::vector<double> beyond = beyond_limits(task_.linkage, x, task_.limits);
  double worst = 0.0;
  for (std::size_t k = 0; k < beyond.size(); ++k) {
    worst = std::max(worst, beyond[k]);
    shifts_[k] = std::max(0.0, shifts_[k] + beyond[k]);
  }
  return worst;
}

CouplerPlace coupler_place(PathLinkage linkage, std::span<const double> x, double crank_angle, int closure) {
  const CouplerPlaceOf<double> pose = coupler_place_of(linkage, x, crank_angle, closure);
  return {pose.point, pose.gap};
}

std::vector<double> beyond_limits(PathLinkage linkage, std::span<const double> x, const PathLimits& limits) {
  return beyond_limits_of<double>(linkage, x, limits);
}

FourBar four_bar_of(std::span<const double> x) {
  return {{x[at_a], x[at_a + 1]},  {x[at_b], x[at_b + 1]}, std::exp(x[at_crank]),
          std::exp(x[at_coupler]), std::exp(x[at_output]), {x[at_point], x[at_point + 1]}};
}

PathVector unknowns_of(const FourBar& linkage) {
  return {linkage.a.x,
          linkage.a.y,
          linkage.b.x,
          linkage.b.y,
          std::log(linkage.input),
          std::log(linkage.coupler),
          std::log(linkage.output),
          linkage.point.x,
          linkage.point.y,
          0.0};
}

bool LinkFit::evaluate(int point, std::span<const double> x, double t, std::span<double> residuals,
                       std::span<double> by_shared, std::span<double> by_own) const {
  const PathDuals u = duals_of(x);
  const PathDual angle = own(point) ? PathDual(t, path_unknowns) : PathDual(t);
  const Planar<PathDual> turn{cos(angle), sin(angle)};
  const Planar<PathDual> at{PathDual(points_[point].x), PathDual(points_[point].y)};
  const auto short_of = [&](int k) {
    const Planar<PathDual> pivot{u[2 * k], u[2 * k + 1]}, arm{u[4 + 2 * k], u[5 + 2 * k]};
    return norm(at - turn * arm - pivot) - u[8 + k];
  };
  const PathDual first = short_of(0), second = short_of(1);
  PathDual apart = (u[8] - u[9]) * (u[8] - u[9]);
  for (const int j : {0, 1, 4, 5}) apart += (u[j] - u[j + 2]) * (u[j] - u[j + 2]);
  const PathDual share = sqrt(apart / (PathDual(1.0) + apart));
  const std::array rows{first, (second - first) / share};
  for (int row = 0; row < 2; ++row) {
    write_row(rows[row], row, residuals, by_shared);
    by_own[row] = rows[row].v[path_unknowns];
  }
  if (pivots_given_) {
    for (int column = 0; column < 4; ++column) forget_column(column, 2, by_shared);
  }
  return true;
}

}  // namespace poise

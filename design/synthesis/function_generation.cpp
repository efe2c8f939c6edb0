#include "design/synthesis/function_generation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "design/synthesis/private/exact_algebra.hpp"

namespace poise {
namespace synthesis {
namespace {

using BallVector = std::vector<Ball>;

/// Freudenstein's equation at a pair of turns, as a row of a linear system: of
///   K1, K2, K3, 1                                              where both starts are given,
///   K1, K2 cos phi0, K2 sin phi0, K3, cos phi0, sin phi0       where that of the input is free,
///   K1 cos psi0, K1 sin psi0, K2, K3, cos psi0, sin psi0       where that of the output is, or
///   K1 cos psi0, K1 sin psi0, K2 cos phi0, K2 sin phi0, K3, cos(phi0 - psi0), sin(phi0 - psi0).
BallVector equation_of(const FunctionTask& task, const Vec2& turns) {
  const Ball phi = Ball(turns.x) + Ball(task.input_start.value_or(0.0));
  const Ball psi = Ball(turns.y) + Ball(task.output_start.value_or(0.0));
  const bool phi_free = !task.input_start, psi_free = !task.output_start;
  BallVector row{cos(psi)};
  if (psi_free) row.push_back(-sin(psi));
  row.push_back(-cos(phi));
  if (phi_free) row.push_back(sin(phi));
  row.emplace_back(1);
  row.push_back(-cos(phi - psi));
  if (phi_free) {
    row.push_back(sin(phi - psi));
  } else if (psi_free) {
    row.push_back(-sin(phi - psi));
  }
  return row;
}

/// Two entries, of which the second is missing where a start is given.
struct Part {
  std::size_t first;
  bool has_second;
};

/// Where the entries of K1, K2, K3 and of the last term are.
struct Places {
  Part k1, k2, last;
  std::size_t k3;
};

Places places_of(const FunctionTask& task) {
  const bool phi_free = !task.input_start, psi_free = !task.output_start;
  Places out{};
  out.k1 = {0, psi_free};
  out.k2 = {psi_free ? 2u : 1u, phi_free};
  out.k3 = out.k2.first + (phi_free ? 2 : 1);
  out.last = {out.k3 + 1, phi_free || psi_free};
  return out;
}

/// What says that products are what they are: that the directions of its parts agree, as a polynomial on the line of
/// the solutions first + x second.
BallPolynomial condition_of(const FunctionTask& task, const BallRows& line) {
  const Places at = places_of(task);
  const auto on_line = [&](std::size_t k) { return BallPolynomial{line[0][k], line[1][k]}; };
  const auto direction = [&](const Part& part) { return std::pair(on_line(part.first), on_line(part.first + 1)); };
  const auto [ex, ey] = direction(at.last);
  if (!at.k1.has_second || !at.k2.has_second) {
    const auto [x, y] = direction(at.k1.has_second ? at.k1 : at.k2);
    return x * ey - y * ex;
  }
  const auto [ax, ay] = direction(at.k1);
  const auto [cx, cy] = direction(at.k2);
  // The imaginary part of (K2 part) conj(K1 part) conj(last).
  return (cy * ax - cx * ay) * ex - (cx * ax + cy * ay) * ey;
}

/// Signed lengths and starts from a solution of the linear system; empty where a link is infinite.
std::optional<FunctionLinkage> linkage_of(const FunctionTask& task, const BallVector& solution) {
  constexpr double nothing = 1e-12;
  const Places at = places_of(task);
  const auto value = [&](std::size_t k) { return solution[k].middle(); };
  const auto part = [&](const Part& p) { return Vec2{value(p.first), p.has_second ? value(p.first + 1) : 0.0}; };
  double scale = 1 / norm(part(at.last));
  const Vec2 k1 = part(at.k1), k2 = part(at.k2), last = part(at.last);
  if (!std::isfinite(scale) || norm(k1) * scale < nothing || norm(k2) * scale < nothing) return std::nullopt;
  FunctionLinkage out;
  double ratio1 = 0.0, ratio2 = 0.0;
  const auto angle = [](const Vec2& v) { return std::atan2(v.y, v.x); };
  if (at.k1.has_second && at.k2.has_second) {
    // Half a turn of a start changes the sign of a link: both are made positive.
    if (dot(k2 * conj(k1), last) < 0.0) scale = -scale;
    out.output_start = angle(scale * k1);
    out.input_start = angle(scale * k2);
    ratio1 = norm(scale * k1);
    ratio2 = norm(scale * k2);
  } else if (at.k2.has_second) {
    if (k1.x * scale < 0.0) scale = -scale;
    out.input_start = angle(scale * last);
    out.output_start = *task.output_start;
    ratio1 = scale * k1.x;
    ratio2 = scale * scale * dot(k2, last);
  } else if (at.k1.has_second) {
    if (k2.x * scale < 0.0) scale = -scale;
    out.output_start = angle(scale * last);
    out.input_start = *task.input_start;
    ratio1 = scale * scale * dot(k1, last);
    ratio2 = scale * k2.x;
  } else {
    scale = 1 / last.x;
    out.input_start = *task.input_start;
    out.output_start = *task.output_start;
    ratio1 = scale * k1.x;
    ratio2 = scale * k2.x;
  }
  const double ratio3 = scale * value(at.k3);
  const double a = 1 / ratio1, c = 1 / ratio2;
  out.input = task.ground * a;
  out.output = task.ground * c;
  const double square = a * a + c * c + 1 - 2 * a * c * ratio3;
  out.linkage = {
      {}, {task.ground, 0.0}, std::abs(out.input), task.ground * std::sqrt(std::max(0.0, square)), std::abs(out.output),
      {}};
  return out;
}

double wrapped_angle(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

double drawn_angle(double angle, double length) { return length < 0.0 ? angle + std::numbers::pi : angle; }

/// How a linkage has its pairs: closure, misfit and defects.
void check_pairs(const FunctionTask& task, FunctionLinkage& linkage) {
  std::vector<InputPosition> positions;
  bool same = true;
  for (const Vec2& turns : task.turns) {
    const double phi = linkage.input_start + turns.x, psi = linkage.output_start + turns.y;
    const Vec2 input_pin = linkage.input * unit(phi);
    const Vec2 output_pin = linkage.linkage.b + linkage.output * unit(psi);
    const int closure = cross(linkage.linkage.b - input_pin, output_pin - input_pin) < 0.0 ? -1 : 1;
    positions.push_back({drawn_angle(phi, linkage.input), closure});
    same = same && closure == positions.front().closure;
    const auto pose = pose_of(linkage.linkage, positions.back().angle, closure);
    const double psi_there = pose ? drawn_angle(pose->output_angle, linkage.output) : INFINITY;
    linkage.misfit = std::max(linkage.misfit, pose ? std::abs(wrapped_angle(psi_there - psi)) : INFINITY);
  }
  if (!same) {
    linkage.passage = passage_of(linkage.linkage, positions);
    return;
  }
  linkage.closure = positions.front().closure;
  linkage.passage = passage_over(linkage.linkage, drawn_angle(linkage.input_start + task.first, linkage.input),
                                 drawn_angle(linkage.input_start + task.last, linkage.input), linkage.closure);
}

/// Adds the solutions first + x second of all zeros of the condition.
void solve_on_line(const FunctionTask& task, const BallRows& line, FunctionLinkages& out) {
  constexpr int most_attempts = 5;
  PolynomialRoots roots;
  BallRows turned;
  for (int attempt = 0; attempt < most_attempts && !roots.isolated; ++attempt) {
    const auto rotation = generic_rotation(2, attempt);
    turned.assign(2, BallVector(line.front().size()));
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        for (std::size_t j = 0; j < line[k].size(); ++j) turned[i][j] += Ball(rotation[i][k]) * line[k][j];
      }
    }
    roots = roots_of(condition_of(task, turned));
  }
  out.complete = roots.isolated;
  out.complex = roots.others;
  for (const Ball& x : roots.real) {
    BallVector solution(line.front().size());
    for (std::size_t j = 0; j < solution.size(); ++j) solution[j] = turned[0][j] + x * turned[1][j];
    if (auto linkage = linkage_of(task, solution)) {
      linkage->proved = roots.isolated;
      out.linkages.push_back(*linkage);
    } else {
      ++out.infinite;
    }
  }
}

}  // namespace
}  // namespace synthesis

double WantedFunction::value(double x) const { return y.value(std::array{x}); }

Vec2 WantedFunction::turns_at(double x) const {
  const double start = value(from);
  return {input_turn * (x - from) / (to - from), output_turn * (value(x) - start) / (value(to) - start)};
}

std::vector<double> chebyshev_points(double from, double to, int n) {
  std::vector<double> out;
  for (int k = 0; k < n; ++k) {
    out.push_back(0.5 * (from + to) - 0.5 * (to - from) * std::cos(std::numbers::pi * (2 * k + 1) / (2 * n)));
  }
  return out;
}

FunctionLinkages linkages_for(const FunctionTask& task) {
  using namespace synthesis;
  FunctionLinkages out;
  BallRows rows;
  for (const Vec2& turns : task.turns) rows.push_back(equation_of(task, turns));
  const BallRows solutions = null_space(std::move(rows));
  if (solutions.empty()) {
    out.dependent = true;
    return out;
  }
  if (solutions.size() == 1) {
    out.complete = true;
    if (auto linkage = linkage_of(task, solutions.front())) {
      linkage->proved = true;
      out.linkages.push_back(*linkage);
    } else {
      out.infinite = 1;
    }
  } else {
    solve_on_line(task, solutions, out);
  }
  for (FunctionLinkage& one : out.linkages) check_pairs(task, one);
  std::sort(out.linkages.begin(), out.linkages.end(), [](const FunctionLinkage& a, const FunctionLinkage& b) {
    return std::pair(a.linkage.input, a.linkage.output) < std::pair(b.linkage.input, b.linkage.output);
  });
  return out;
}

}  // namespace poise

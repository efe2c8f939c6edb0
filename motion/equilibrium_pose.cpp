#include "motion/equilibrium_pose.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "solvers/newton.hpp"
#include "statics/equilibrium_problem.hpp"
#include "statics/mobility.hpp"

namespace poise {
namespace {

// Loops open by less than this (rad, mechanism sizes) are closed to double precision.
constexpr double closed_within = 1e-14;
// Loops that remain open by more than this are an error.
constexpr double open_beyond = 1e-9;

double largest_gap(const MotionModel& motion, const std::vector<double>& x) {
  const Mechanism<double>& m = motion.mechanism();
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> c(m.constraints());
  m.place(x.data(), pose.data());
  m.constraint(x.data(), pose.data(), c.data());
  double widest = 0.0;
  for (int r = 0; r < m.equalities(); ++r) widest = std::max(widest, std::abs(c[r]));
  return widest;
}

}  // namespace

std::vector<double> motion_coordinates(const MotionModel& motion, const StaticModel& statics,
                                       const std::vector<double>& static_x) {
  const Layout& from = statics.layout();
  const Layout& to = motion.layout();
  const std::vector<double> static_q = statics.to_si(static_x);
  std::vector<double> q = motion.to_si(motion.start());
  for (int i = 0; i < to.kept; ++i) {
    const Coordinate& wanted = to.coordinates[i];
    const auto end = from.coordinates.begin() + from.kept;
    const auto same = std::find_if(from.coordinates.begin(), end,
                                   [&](const Coordinate& c) { return c.kind == wanted.kind && c.name == wanted.name; });
    if (same != end) q[i] = static_q[same - from.coordinates.begin()];
  }
  return closed_from(motion, motion.from_si(std::move(q)));
}

std::vector<double> closed_from(const MotionModel& motion, std::vector<double> x) {
  if (largest_gap(motion, x) <= closed_within) return x;
  const EquilibriumProblem problem(motion.mechanism());
  solvers::NewtonOptions options;
  options.closing_starts = 0;
  solvers::Newton newton(problem, options);
  x = newton.close(x).x;
  const double gap = largest_gap(motion, x);
  if (gap > open_beyond) {
    throw InputError(
        fmt::format("{}its loops remain open by {:.3g} of its size in motion; expected a pose "
                    "that closes them; try another [start]",
                    where(motion), gap));
  }
  return x;
}

}  // namespace poise

#include "motion/equilibrium_pose.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "solvers/newton.hpp"
#include "statics/model/equilibrium_problem.hpp"
#include "statics/model/mobility.hpp"

namespace poise {
namespace {

// Loops open by less than this (rad, mechanism sizes) are closed to double precision.
constexpr double pose_closed_within = 1e-14;
// Loops that remain open by more than this are an error.
constexpr double pose_open_beyond = 1e-9;

/// Sets the coordinates that cut joints make to poses of the bodies, SI.
template <class Find>
void place_what_is_cut(const MotionModel& motion, const std::vector<BodyPose<double>>& poses, const Find& find,
                       std::vector<double>& q) {
  const Layout& layout = motion.layout();
  const auto turn = [&](const Link& link) { return layout.turns[static_cast<std::size_t>(link.turn)].to<double>(); };
  for (std::size_t i = 1; i < layout.links.size(); ++i) {
    const Link& link = layout.links[i];
    if (link.frame >= 0 && link.frame < layout.kept && find(layout.coordinates[link.frame]) == nullptr) {
      q[static_cast<std::size_t>(link.frame)] = poses[i].angle - turn(link);
    }
    for (const Arm& arm : link.arms) {
      if (!layout.is_length(arm.coordinate) || arm.coordinate >= layout.kept) continue;
      const Coordinate& c = layout.coordinates[arm.coordinate];
      const double unit = motion.scales().length;
      if (c.name.empty()) {
        q[static_cast<std::size_t>(arm.coordinate)] =
            (arm.arm.x != 0 ? poses[i].origin.x : poses[i].origin.y) - unit * c.origin;
      }
    }
  }
  // The second closure of a slide is that of its carriage's end, whose travel is its last arm.
  for (std::size_t c = 1; c < layout.closures.size(); ++c) {
    const auto joint = static_cast<std::size_t>(layout.closures[c].joint);
    if (layout.closures[c - 1].joint != layout.closures[c].joint || layout.travel[joint] < 0) continue;
    q[static_cast<std::size_t>(layout.closures[c].arms.back().coordinate)] =
        q[static_cast<std::size_t>(layout.travel[joint])] + motion.scene().joints[joint].friction->length / 2;
  }
}

}  // namespace

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

std::vector<double> motion_coordinates(const MotionModel& motion, const StaticModel& statics,
                                       const std::vector<double>& static_x) {
  return coordinates_in(motion, statics, static_x);
}

bool has_cuts(const Layout& layout) {
  return std::any_of(layout.coordinates.begin(), layout.coordinates.end(),
                     [](const Coordinate& c) { return c.name.empty(); });
}

std::vector<double> coordinates_in(const MotionModel& motion, const ScaledModel& other, const std::vector<double>& x) {
  const Layout& from = other.layout();
  const Layout& to = motion.layout();
  const std::vector<double> known = other.to_si(x);
  std::vector<double> q = motion.to_si(motion.start());
  const auto find = [&](const Coordinate& wanted) -> const double* {
    const auto end = from.coordinates.begin() + from.kept;
    const auto same = std::find_if(from.coordinates.begin(), end,
                                   [&](const Coordinate& c) { return c.kind == wanted.kind && c.name == wanted.name; });
    return same != end ? &known[static_cast<std::size_t>(same - from.coordinates.begin())] : nullptr;
  };
  for (int i = 0; i < to.kept; ++i) {
    if (const double* same = find(to.coordinates[i])) q[static_cast<std::size_t>(i)] = *same;
  }
  if (has_cuts(to)) place_what_is_cut(motion, other.poses(x), find, q);
  return closed_from(motion, motion.from_si(std::move(q)));
}

std::vector<double> closed_from(const MotionModel& motion, std::vector<double> x) {
  if (largest_gap(motion, x) <= pose_closed_within) return x;
  const EquilibriumProblem problem(motion.mechanism());
  solvers::NewtonOptions options;
  options.closing_starts = 0;
  solvers::Newton newton(problem, options);
  x = newton.close(x).x;
  const double gap = largest_gap(motion, x);
  if (gap > pose_open_beyond) {
    throw InputError(
        fmt::format("{}its loops remain open by {:.3g} of its size in motion; expected a position "
                    "that closes them; try another [start]",
                    where(motion), gap));
  }
  return x;
}

}  // namespace poise

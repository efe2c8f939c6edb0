#include "motion/forces_along.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "motion/dead_point.hpp"
#include "motion/simulate.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise {
namespace {

/// Throws InputError where the drives begin in a pose that a stop bars.
void expect_within_stops(const Scene& scene, const Forces& forces) {
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    if (forces.overrun[s] == 0.0) continue;
    const Quantity quantity = quantity_of(scene.stops[s].on);
    throw InputError(
        fmt::format("{}: drive: the position in which the drives begin is beyond the stop \"{}\" by {:.6g} {}; "
                    "expected one within the stops; change a drive's start, or say --drive NAME=VALUE",
                    scene.file, scene.stops[s].name, in_unit(forces.overrun[s], quantity, scene.units),
                    unit_name(quantity, scene.units)));
  }
}

/// Of a single pose.
std::vector<std::vector<double>> dead_point_at(const MotionModel& model, const std::vector<double>& x) {
  const Scene& scene = model.scene();
  if (!is_dead_point(model, x, scene.drives)) return {};
  const std::vector<BodyPose<double>> poses = model.poses(x);
  std::vector<double> values;
  for (const Drive& drive : scene.drives) values.push_back(value_of(scene, drive.on, poses));
  return {values};
}

/// Throws InputError where loads depend on a time that the poses of a range do not have.
void expect_no_functions(const Scene& scene) {
  for (const TimeFunction& function : scene.time_functions) {
    if (function.of == TimeFunction::Of::drive) continue;
    throw InputError(
        fmt::format("{}: load \"{}\" follows a function of time, and the positions of a range have no time; expected "
                    "--motion FILE, a record as poise motion writes it, in place of the range",
                    scene.file, name_of(scene, function)));
  }
}

/// The forces in the pose at the time t, with the loads of that time. The layout, and so the coordinates, are those of
/// the model.
Forces forces_at(const MotionModel& model, double t, const std::vector<double>& x, const std::vector<double>& v,
                 const std::vector<double>& a) {
  const Scene& scene = model.scene();
  if (scene.time_functions.empty()) return forces_of(model, x, v, a, scene.drives);
  const MotionModel then(at_time(scene, t), model.scales(), loads_in_time(scene));
  return forces_of(then, x, v, a, scene.drives);
}

}  // namespace

bool ForcesAlong::balanced() const {
  return std::all_of(poses.begin(), poses.end(),
                     [&](const Forces& f) { return f.imbalance <= tolerance * f.largest_force; });
}

ForcesAlong forces_in_place(const MotionModel& model) {
  ForcesAlong out;
  const std::vector<double> x = model.from_si(start_motion(model, {}).q);
  const std::vector<double> still(x.size(), 0.0);
  out.poses.push_back(forces_at(model, 0.0, x, still, still));
  expect_within_stops(model.scene(), out.poses.front());
  out.dead_points = dead_point_at(model, x);
  return out;
}

ForcesAlong forces_over(const MotionModel& model, const std::vector<DriveRange>& ranges, const SweepOptions& options,
                        bool moving) {
  const Scene& scene = model.scene();
  const std::size_t first = first_moving(ranges);
  expect_no_functions(scene);
  const KinematicsResult path = sweep(scene, ranges, options);
  ForcesAlong out;
  out.complete = path.complete;
  out.why = path.why;
  out.stop = path.stop;
  const bool single = path.samples.size() == 1;
  if (!single) {
    out.along = ranges[first].name;
    out.measure = quantity_of(scene.drives[first].on);
  }
  for (const KinematicSample& at : path.samples) {
    const std::vector<double> still(at.q.size(), 0.0);
    if (!single) out.at.push_back(at.drive[first]);
    out.poses.push_back(forces_of(model, model.from_si(at.q), moving ? model.from_si(at.rate) : still,
                                  moving ? model.from_si(at.acceleration) : still, scene.drives));
  }
  for (const SingularPose& pose : path.singular) {
    const bool ends = pose.kind == SingularPose::Kind::dead_centre;
    if (!ends && pose.before_range) continue;
    if (is_dead_point(model, model.from_si(pose.q), scene.drives)) out.dead_points.push_back(pose.drive);
  }
  if (single && out.dead_points.empty()) out.dead_points = dead_point_at(model, model.from_si(path.samples.front().q));
  return out;
}

ForcesAlong forces_along(const MotionModel& model, const std::vector<double>& time, const GivenMotion& motion) {
  refuse_blades(model.scene(), "forces along a given motion");
  ForcesAlong out;
  out.along = "time";
  out.at = time;
  out.tolerance = 1e-6;
  for (std::size_t k = 0; k < time.size(); ++k) {
    out.poses.push_back(forces_at(model, time[k], motion.x[k], motion.v[k], motion.a[k]));
  }
  return out;
}

}  // namespace poise

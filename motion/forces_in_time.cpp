#include "motion/forces_in_time.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "motion/quantities_along.hpp"
#include "statics/bodies/body_forces.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise {
namespace {

/// Bodies of a simulated motion balance to the accuracy of its accelerations.
constexpr double balanced_in_motion = 1e-6;
/// What motors may leave unbalanced, over the largest generalized force.
constexpr double made_within = 1e-7;

/// Powers of all forces that are no joint forces, W.
struct Powers {
  std::vector<double> drives;
  double driven = 0.0, others = 0.0;  ///< of drives; of loads and elements less what joints lose
  double sizes = 0.0;
};

/// The rate of the kinetic energy.
double kinetic_rate(const Scene& scene, const std::vector<BodyMotion>& motions) {
  double out = 0.0;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const BodyMotion& motion = motions[i];
    out += body.mass * dot(motion.velocity_of(body.center), motion.acceleration_of(body.center)) +
           body.inertia * motion.rate * motion.angular_acceleration;
  }
  return out;
}

Powers powers_of(const Scene& then, const Forces& forces) {
  Powers out;
  const auto add = [&](double power) {
    if (std::isnan(power)) return;  // of friction that shares its load with others, which stands still
    out.others += power;
    out.sizes += std::abs(power);
  };
  BodyForces(then, poses_of(forces.motions))
      .push_loads(
          [&](std::string_view, const std::string&, int body, const Vec2& at, const Vec2& force, double moment) {
            const BodyMotion& motion = forces.motions[static_cast<std::size_t>(body)];
            add(dot(force, motion.velocity_at(at)) + moment * motion.rate);
          });
  for (std::size_t e = 0; e < then.elements.size(); ++e) {
    add(-forces.element_force[e] * rate_of(then, forces.motions, then.elements[e].on));
  }
  for (const SlidingJoint& one : forces.friction.joints) add(-one.lost());
  for (const SlidingStop& one : forces.friction.stops) add(-one.lost());
  for (const DriveEffort& drive : forces.drives) {
    out.drives.push_back(drive.power);
    out.driven += drive.power;
    out.sizes += std::abs(drive.power);
  }
  return out;
}

struct OfLinkInTime {
  const char* key;
  LargestOnLink LinkLoads::*value;
  Dimension dimension;
};
constexpr Dimension stress_in_time = dimension::force * dimension::length.power(-2);
constexpr std::array<OfLinkInTime, 5> of_link_in_time{{{"normal", &LinkLoads::normal, dimension::force},
                                                       {"shear", &LinkLoads::shear, dimension::force},
                                                       {"moment", &LinkLoads::moment, dimension::torque},
                                                       {"tension", &LinkLoads::tension, stress_in_time},
                                                       {"compression", &LinkLoads::compression, stress_in_time}}};

/// Finds the forces at one time after the other.
class ForcesOverTime {
 public:
  ForcesOverTime(const Scene& scene, const MotionModel& model, const Motion& motion, const ForcesInTimeOptions& options)
      : model_(model), states_(model, motion), scene_(scene), made_(scene) {
    if (options.motors.empty()) return;
    motors_.emplace(model, options.motors);
    made_.drives = options.motors;
    forget_functions_of_drives(made_);
  }

  const std::optional<MotorEfforts>& motors() const { return motors_; }
  const MovingState& state(double t) { return states_.at(t); }
  /// The scene at that time, with motors in place of its drives.
  Scene then(double t) const {
    if (scene_.time_functions.empty()) return made_;
    Scene out = at_time(scene_, t);
    out.drives = made_.drives;
    return out;
  }

  /// Finds them with the drives of the scene, or with motors.
  Forces at(double t, const Scene& then, MotorsFound* found = nullptr) {
    const MovingState& state = states_.at(t);
    if (!motors_) return finished(forces_in_motion(then, model_, state.x, state.v, state.a, states_.fastest()));
    Scene driven = then;
    driven.drives = scene_.drives;
    const MotorsFound motors =
        motors_->at(state, forces_in_motion(driven, model_, state.x, state.v, state.a, states_.fastest()));
    if (found != nullptr) *found = motors;
    return finished(forces_in_motion(then, model_, state.x, state.v, state.a, states_.fastest(), &motors.efforts));
  }

 private:
  Forces finished(Forces forces) const {
    forces.overrun.assign(scene_.stops.size(), 0.0);
    return forces;
  }

  const MotionModel& model_;
  StatesAlong states_;
  const Scene& scene_;
  Scene made_;
  std::optional<MotorEfforts> motors_;
};

/// Times between which powers are integrated: nodes, their middles and the times of the record.
std::vector<double> grid_of(const std::vector<double>& nodes, const std::vector<double>& times) {
  std::vector<double> out(nodes.begin(), nodes.end());
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) out.push_back((nodes[k] + nodes[k + 1]) / 2);
  out.insert(out.end(), times.begin(), times.end());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

void add_links(ForceHistory& out, const Scene& then, const MotionModel& model, const MovingState& state,
               const Forces& forces) {
  const std::vector<LinkLoads> links = link_loads(then, model.poses(state.x), in_motion(then, forces));
  if (out.links.empty()) {
    for (const LinkLoads& link : links) {
      for (const OfLinkInTime& of : of_link_in_time) out.links.push_back({link.name, of.key, of.dimension});
    }
  }
  std::size_t k = 0;
  for (const LinkLoads& link : links) {
    for (const OfLinkInTime& of : of_link_in_time) {
      LinkCourse& course = out.links[k++];
      course.value.push_back(link.why.empty() ? link.*of.value : LargestOnLink{std::nan(""), std::nan("")});
      const double now = std::abs(course.value.back().value);
      const double before = std::abs(course.value[course.largest].value);
      if (!std::isnan(now) && (std::isnan(before) || now > before)) course.largest = course.value.size() - 1;
    }
    if (link.why.empty()) continue;
    const bool is_new = std::none_of(out.without_loads.begin(), out.without_loads.end(),
                                     [&](const std::string& one) { return one.starts_with(link.name + ": "); });
    if (is_new) out.without_loads.push_back(link.name + ": " + link.why);
  }
}

/// The forces of stops that can open among those of one time.
std::vector<TouchingForce> touching_of(const Scene& then, const Forces& forces) {
  std::vector<TouchingForce> out;
  if (forces.friction.has_no_forces()) return out;
  const std::vector<BodyPose<double>> poses = poses_of(forces.motions);
  for (const Reaction& one : forces.reactions) {
    if (!one.of_stop() || !one.determined) continue;
    const auto stop = static_cast<std::size_t>(one.stop);
    if (then.stops[stop].min == then.stops[stop].max) continue;  // a coupling, which never opens
    TouchingForce found{.stop = stop,
                        .body_a = one.body_a,
                        .body_b = one.body_b,
                        .at = one.at,
                        .force = one.force,
                        .pressing = norm(one.force),
                        .moment = one.moment};
    for (const SlidingStop& friction : forces.friction.stops) {
      if (friction.stop != one.stop || std::isnan(friction.effort)) continue;
      for (const UnitEffort& unit : unit_efforts(then, friction.on, poses))
        found.force = found.force + friction.effort * unit.force;
    }
    out.push_back(found);
  }
  return out;
}

}  // namespace

std::vector<std::vector<TouchingForce>> touching_forces(const Scene& scene, const MotionModel& model,
                                                        const Motion& motion, const std::vector<double>& times) {
  ForcesOverTime over(scene, model, motion, {});
  std::vector<std::vector<TouchingForce>> out;
  for (const double t : times) {
    const Scene then = over.then(t);
    out.push_back(touching_of(then, over.at(t, then)));
  }
  return out;
}

ForceHistory forces_in_time(const Scene& scene, const MotionModel& model, const Motion& motion,
                            const MotionRecord& record, const ForcesInTimeOptions& options) {
  ForceHistory out;
  out.found.along = "time";
  out.found.at = record.time;
  out.found.tolerance = balanced_in_motion;
  const std::vector<double>& nodes = motion.trajectory.t;
  ForcesOverTime over(scene, model, motion, options);
  const auto stopped = [&] { return options.interrupt != nullptr && options.interrupt->load(); };
  if (over.motors()) {
    out.motors = MotorsInTime{.motors = options.motors,
                              .freedoms = over.motors()->freedoms(over.state(nodes.front())),
                              .size = model.scales().length};
  }
  const bool with_links = has_links(scene);
  double needed = 0.0, left = 0.0, largest_force = 0.0, power_left = 0.0, powers = 0.0;
  for (const double t : record.time) {
    if (stopped()) break;
    const Scene then = over.then(t);
    MotorsFound motors;
    Forces forces = over.at(t, then, &motors);
    const Powers power = powers_of(then, forces);
    if (!forces.friction.has_no_forces()) {
      if (forces.imbalance >= out.imbalance) out.worst_body = forces.worst_body;
      out.imbalance = std::max(out.imbalance, forces.imbalance);
      largest_force = std::max(largest_force, forces.largest_force);
      const double kinetic = kinetic_rate(then, forces.motions);
      power_left = std::max(power_left, std::abs(kinetic - power.driven - power.others));
      powers = std::max(powers, power.sizes + std::abs(kinetic));
    }
    if (out.motors) {
      needed = std::max(needed, motors.needed);
      if (motors.left > left || out.motors->unbalanced.empty()) {
        out.motors->unbalanced = motors.unbalanced;
        out.motors->at = t;
      }
      left = std::max(left, motors.left);
    }
    if (with_links) add_links(out, then, model, over.state(t), forces);
    out.found.poses.push_back(std::move(forces));
    if (options.progress) options.progress(t);
  }
  if (largest_force > 0.0) out.imbalance /= largest_force;
  // Powers and energies of a mechanism at rest are rounding alone.
  constexpr double at_rest = 1e-12;
  const double nothing = at_rest * largest_force * model.scales().length;
  if (powers > nothing / nodes.back()) out.power_error = power_left / powers;
  if (out.found.poses.size() < record.time.size()) {
    out.found.at.resize(out.found.poses.size());
    out.found.complete = false;
    out.found.why = "interrupted";
  }

  // Work by Gauss's rule of three points.
  constexpr double place = 0.7745966692414834;
  const std::size_t drives = out.found.poses.empty() ? 0 : out.found.poses.front().drives.size();
  out.work.resize(drives);
  std::vector<double> work(drives, 0.0);
  double sum = 0.0, most = 0.0, least = 0.0, energy_left = 0.0, driven = 0.0, struck = 0.0;
  std::size_t next = 0, node = 0;
  const std::vector<double> grid = grid_of(nodes, out.found.at);
  for (std::size_t k = 0; k < grid.size() && next < out.found.at.size() && !stopped(); ++k) {
    if (k > 0) {
      const double half = (grid[k] - grid[k - 1]) / 2, middle = (grid[k] + grid[k - 1]) / 2;
      for (const auto& [at, weight] :
           {std::pair{-place, 5.0 / 9}, std::pair{0.0, 8.0 / 9}, std::pair{place, 5.0 / 9}}) {
        const double t = middle + half * at;
        const Scene then = over.then(t);
        const Powers power = powers_of(then, over.at(t, then));
        for (std::size_t d = 0; d < drives; ++d) work[d] += half * weight * power.drives[d];
        sum += half * weight * (power.driven + power.others);
        driven += half * weight * power.sizes;
      }
    }
    if (grid[k] != out.found.at[next]) continue;
    for (std::size_t d = 0; d < drives; ++d) out.work[d].push_back(work[d]);
    // Impacts, at which there are two nodes, take energy at once.
    for (; node + 1 < nodes.size() && nodes[node + 1] <= grid[k]; ++node) {
      if (nodes[node] == nodes[node + 1]) struck += motion.kinetic[node + 1] - motion.kinetic[node];
    }
    const double kinetic = record.kinetic[next] - record.kinetic.front() - struck;
    energy_left = std::max(energy_left, std::abs(kinetic - sum));
    most = std::max({most, std::abs(kinetic), std::abs(sum)});
    least = std::max(least, driven);
    ++next;
  }
  if (std::max(most, least) > nothing) out.energy_error = energy_left / std::max(most, least);
  for (std::vector<double>& one : out.work) one.resize(out.found.at.size(), std::nan(""));

  if (!out.motors) return out;
  MotorsInTime& motors = *out.motors;
  motors.left = needed > 0.0 ? left / needed : 0.0;
  motors.is_made = motors.left <= made_within;
  if (motors.is_made) motors.unbalanced.clear();
  if (!motors.is_made || stopped()) return out;
  const auto efforts_at = [&](double t) {
    const Scene then = over.then(t);
    std::vector<double> efforts;
    for (const DriveEffort& drive : over.at(t, then).drives) efforts.push_back(drive.value);
    return efforts;
  };
  motors.followed = fed_back(model, motion, motors.motors, efforts_at, options.accuracy, options.interrupt);
  return out;
}

}  // namespace poise

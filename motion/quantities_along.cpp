#include "motion/quantities_along.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "model/joint_friction.hpp"
#include "motion/blades.hpp"
#include "motion/controller_efforts.hpp"
#include "motion/loads_in_motion.hpp"
#include "motion/private/golden_section.hpp"
#include "statics/bodies/body_forces.hpp"
#include "statics/quantities/quantity_value.hpp"

namespace poise {
namespace {

using Kind = SoughtQuantity::Kind;
using Part = SoughtQuantity::Part;

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
/// Rates below this, over the fastest, are none.
constexpr double no_rate = 1e-9;

/// A stop whose limits are equal, which acts in motion too.
bool is_coupling(const Stop& stop) { return stop.min == stop.max; }

std::vector<ActingStop> couplings_of(const Scene& scene) {
  std::vector<ActingStop> out;
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    if (is_coupling(scene.stops[s])) out.push_back({static_cast<int>(s), false});
  }
  return out;
}

double kinetic_energy(const Scene& scene, const std::vector<BodyMotion>& motions) {
  double twice = 0.0;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const Vec2 velocity = motions[i].velocity_of(body.center);
    twice += body.mass * dot(velocity, velocity) + body.inertia * motions[i].rate * motions[i].rate;
  }
  return twice / 2;
}

/// The place of the point of a push along its direction.
Measure along_of(const SoughtQuantity& push) {
  return Measure::sum_of({{.factor = push.direction.x, .measure = Measure::x_of(push.point)},
                          {.factor = push.direction.y, .measure = Measure::y_of(push.point)}});
}

double reaction_part(const Reaction& reaction, Part part) {
  switch (part) {
    case Part::x:
      return reaction.force.x;
    case Part::y:
      return reaction.force.y;
    case Part::moment:
      return reaction.moment;
    case Part::axial:
      return reaction.axial;
    case Part::shear:
    case Part::size:
      break;
  }
  return norm(reaction.force);
}

/// What the mechanism exerts on the ground: all other forces on the bodies less the rates of their momentum, and the
/// same of moments about the origin of the world.
double shaking(const Scene& then, const std::vector<BodyMotion>& motions, Part part) {
  Vec2 force{};
  double moment = 0.0;
  const auto add = [&](const Vec2& at, const Vec2& one, double turning) {
    force += one;
    moment += cross(at, one) + turning;
  };
  const std::vector<BodyPose<double>> poses = poses_of(motions);
  BodyForces(then, poses)
      .push_loads([&](std::string_view, const std::string&, int body, const Vec2& at, const Vec2& one, double turning) {
        if (body != 0) add(at, one, turning);
      });
  for (std::size_t i = 1; i < then.bodies.size(); ++i) {
    const Body& body = then.bodies[i];
    add(poses[i].world(body.center), -body.mass * motions[i].acceleration_of(body.center),
        -body.inertia * motions[i].angular_acceleration);
  }
  if (part == Part::moment) return moment;
  return part == Part::x ? force.x : part == Part::y ? force.y : norm(force);
}

}  // namespace

bool is_constant_in_time(const SoughtQuantity& of) {
  switch (of.kind) {
    case Kind::number:
    case Kind::maximum:
    case Kind::minimum:
    case Kind::mean:
    case Kind::span:
    case Kind::work:
      return true;
    case Kind::sum:
    case Kind::difference:
    case Kind::product:
    case Kind::quotient:
      return is_constant_in_time(of.of[0]) && is_constant_in_time(of.of[1]);
    default:
      return false;
  }
}

void refuse_at_rest_only(const Scene& scene, const SoughtQuantity& of) {
  if (of.has(Kind::load_at_fold)) {
    throw InputError(of.name + ": a load at a fold belongs to equilibria, not to a motion; expected another quantity");
  }
  if (of.has(Kind::push) && scene.drives.size() != 1) {
    throw InputError(
        fmt::format("{}: a push takes the place of the drive of a motion, and this one has {}; expected "
                    "another quantity, or one [[drive]] in the scene",
                    of.name, scene.drives.empty() ? "none" : "several"));
  }
  if (of.kind == Kind::frequency || of.kind == Kind::damping) {
    throw InputError(of.name + ": it belongs to an equilibrium, not to a motion; expected another quantity");
  }
  for (const SoughtQuantity& part : of.of) refuse_at_rest_only(scene, part);
}

/// The equations of the scaled scene with its couplings, and one motion.
struct MovingQuantities::Place {
  explicit Place(const Scene& scaled) : equations(scaled, couplings_of(scaled)) {}

  NumberedEquations equations;
};

MovingQuantities::MovingQuantities(const Scene& scene, const MotionModel& model)
    : scene_(scene), model_(model), place_(std::make_unique<Place>(model.scaled_scene())) {}

MovingQuantities::~MovingQuantities() = default;

bool MovingQuantities::needs_forces(const SoughtQuantity& of) {
  switch (of.kind) {
    case Kind::element_force:
    case Kind::drive_force:
    case Kind::reaction:
    case Kind::stop_reaction:
    case Kind::blade_force:
    case Kind::push:
    case Kind::stress:
    case Kind::link_load:
      return true;
    default:
      return std::any_of(of.of.begin(), of.of.end(), needs_forces);
  }
}

double MovingQuantities::in_place(const SoughtQuantity& of, const std::vector<BodyMotion>& motions,
                                  bool of_one_freedom) const {
  const NumberedEquations& equations = place_->equations;
  const double per_length = model_.scales().per_length();
  std::vector<double> z, rates;
  for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
    const BodyMotion& one = motions[i];
    z.insert(z.end(), {one.pose.origin.x * per_length, one.pose.origin.y * per_length, one.pose.angle});
    rates.insert(rates.end(), {one.velocity.x * per_length, one.velocity.y * per_length, one.rate});
  }
  z.resize(static_cast<std::size_t>(equations.unknowns()), 0.0);
  QuantityPlace<double> at(equations, equations.numbers().data(), z.data());
  if (at.freedoms() != 1) {
    if (of_one_freedom) return undefined;
    at.move(std::move(rates));
  }
  return at.value(of) / of.dimension.per_scale(model_.scales());
}

double MovingQuantities::effort(const SoughtQuantity& of, const Forces& forces) const {
  if (forces.friction.has_no_forces()) return undefined;
  for (std::size_t k = 0; k < forces.drives.size(); ++k) {
    if (!is_same(scene_.drives[k].on, of.on)) continue;
    return forces.drives[k].determined ? forces.drives[k].value : undefined;
  }
  return undefined;
}

// P dp = F dg  with g the measure of the drive and p = e . (x, y), both along the motion.
double MovingQuantities::push(const SoughtQuantity& of, const Forces& forces) const {
  const Measure& driven = scene_.drives.front().on;
  SoughtQuantity lever{
      .name = "lever", .kind = Kind::ratio, .dimension = driven.dimension() * dimension::length.power(-1)};
  lever.of = {{.name = "drive", .on = driven}, {.name = "point", .on = along_of(of)}};
  return effort({.name = "drive", .kind = Kind::drive_force, .on = driven}, forces) *
         in_place(lever, forces.motions, true);
}

double MovingQuantities::in_link(const SoughtQuantity& of, const Forces& forces, const Scene& then) const {
  if (forces.friction.has_no_forces()) return undefined;
  ForcesInMotion acting = in_motion(then, forces);
  // Accelerations between steps are known to the accuracy of the motion, imbalance() tells how well.
  acting.balanced = false;
  return load_in_link(of, then, link_loads(then, poses_of(forces.motions), acting)).value;
}

double MovingQuantities::rate(const SoughtQuantity& of, const Forces& forces, const Scene& then) const {
  switch (of.kind) {
    case Kind::number:
      return 0.0;
    case Kind::measure:
      return rate_of(scene_, forces.motions, of.on);
    case Kind::sum:
      return rate(of.of[0], forces, then) + rate(of.of[1], forces, then);
    case Kind::difference:
      return rate(of.of[0], forces, then) - rate(of.of[1], forces, then);
    case Kind::product:
      return rate(of.of[0], forces, then) * value(of.of[1], forces, then) +
             value(of.of[0], forces, then) * rate(of.of[1], forces, then);
    case Kind::quotient: {
      const double by = value(of.of[1], forces, then);
      return (rate(of.of[0], forces, then) - value(of.of[0], forces, then) / by * rate(of.of[1], forces, then)) / by;
    }
    default:
      return undefined;
  }
}

double MovingQuantities::value(const SoughtQuantity& of, const Forces& forces, const Scene& then) const {
  switch (of.kind) {
    case Kind::measure:
      return value_of(scene_, of.on, poses_of(forces.motions));
    case Kind::energy:
      return BodyForces(scene_, poses_of(forces.motions)).energy();
    case Kind::kinetic_energy:
      return kinetic_energy(scene_, forces.motions);
    case Kind::element_force:
      return forces.element_force[static_cast<std::size_t>(of.item)];
    case Kind::reaction: {
      const Reaction& reaction = forces.reactions[static_cast<std::size_t>(of.item)];
      return reaction.determined && !forces.friction.has_no_forces() ? reaction_part(reaction, of.part) : undefined;
    }
    case Kind::stop_reaction: {
      const Reaction* const reaction = reaction_of_stop(forces.reactions, static_cast<std::size_t>(of.item));
      if (reaction == nullptr) return 0.0;
      if (!reaction->determined || forces.friction.has_no_forces()) return undefined;
      return scene_.stops[static_cast<std::size_t>(of.item)].on.is_angle() ? reaction->moment : -reaction->axial;
    }
    case Kind::blade_force:
      return blade_force(scene_, static_cast<std::size_t>(of.item), forces);
    case Kind::drive_force:
      return effort(of, forces);
    case Kind::push:
      return push(of, forces);
    case Kind::shaking:
      return shaking(then, forces.motions, of.part);
    case Kind::element_rate:
    case Kind::ratio:
    case Kind::center:
    case Kind::transmission:
      return in_place(of, forces.motions, false);
    case Kind::by_time:
      return rate(of.of[0], forces, then);
    case Kind::number:
      return of.constant;
    case Kind::sum:
      return value(of.of[0], forces, then) + value(of.of[1], forces, then);
    case Kind::difference:
      return value(of.of[0], forces, then) - value(of.of[1], forces, then);
    case Kind::product:
      return value(of.of[0], forces, then) * value(of.of[1], forces, then);
    case Kind::quotient: {
      const double out = value(of.of[0], forces, then) / value(of.of[1], forces, then);
      return std::isfinite(out) ? out : undefined;
    }
    case Kind::stress:
    case Kind::link_load:
      return in_link(of, forces, then);
    case Kind::frequency:
    case Kind::damping:
    case Kind::maximum:
    case Kind::minimum:
    case Kind::mean:
    case Kind::span:
    case Kind::work:
    case Kind::load_at_fold:
      break;
  }
  return undefined;
}

namespace {

/// Loads of inertia and of what resists motion; friction that does not slide is asked for as if it were driven.
class MovingLoads {
 public:
  /// `motions` are measured from any point of the world; `efforts` of the drives, if they are known.
  MovingLoads(const Scene& scene, const std::vector<BodyMotion>& motions, double size, double fastest,
              const std::vector<double>* efforts)
      : scene_(scene), motions_(motions), poses_(poses_of(motions)), size_(size), fastest_(fastest) {
    additions.blades = true;
    if (efforts == nullptr) {
      additions.drives = scene.drives;
    } else {
      for (std::size_t k = 0; k < efforts->size(); ++k) add_effort_on(scene.drives[k].on, (*efforts)[k], additions);
    }
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
      const Body& body = scene.bodies[i];
      additions.loads.push_back({static_cast<int>(i), motions[i].pose.world(body.center),
                                 -body.mass * motions[i].acceleration_of(body.center),
                                 -body.inertia * motions[i].angular_acceleration});
    }
    for (std::size_t e = 0; e < scene.elements.size(); ++e) add_resistance(e);
    for (int j = 0; j < static_cast<int>(scene.joints.size()); ++j) {
      const Joint& joint = scene.joints[static_cast<std::size_t>(j)];
      if (!joint.friction || !joint.can_rub()) continue;
      const Measure on =
          joint.has_travel() ? Measure::travel_of(j) : Measure::angle_between(joint.a.body, joint.b.body);
      if (stands_still(on))
        hold(on, {.joint = j});
      else
        sliding.push_back({.joint = j, .on = on, .rate = rate_of(scene, motions, on)});
    }
    for (int k = 0; k < static_cast<int>(scene.stops.size()); ++k) {
      const Stop& stop = scene.stops[static_cast<std::size_t>(k)];
      sides.push_back(is_coupling(stop) ? 2 : touched(stop));
      if (sides.back() == 0 || !stop.friction) continue;
      const Measure on = *tangent_of(scene, k);
      if (stands_still(on))
        hold(on, {.stop = k});
      else
        rubbing.push_back({.stop = k, .on = on, .rate = rate_of(scene, motions, on)});
    }
  }

  Additions additions{};
  std::vector<double> element_force{};  ///< of what resists motion
  std::vector<int> sides{};             ///< of stops, as of balance(): couplings, and what is touched and stays
  struct Held {
    int element = -1, joint = -1, stop = -1;
  };
  std::vector<Held> held{};             ///< of the drives behind those of the scene: what friction it is
  std::vector<SlidingJoint> sliding{};  ///< joints with friction that move, without their efforts
  std::vector<SlidingStop> rubbing{};   ///< stops with friction that are touched and along which something slides

  /// All loads with these efforts of what slides, positive where they tend to increase their measures.
  Additions with(const SlidingFriction& friction) const {
    Additions out = additions;
    for (const SlidingJoint& one : friction.joints) add_effort_on(one.on, one.effort, out);
    for (const SlidingStop& one : friction.stops) add_effort_on(one.on, one.effort, out);
    return out;
  }

 private:
  /// Positive where it tends to increase the measure.
  void add_effort_on(const Measure& on, double effort, Additions& to) const {
    for (const UnitEffort& unit : unit_efforts(scene_, on, poses_)) {
      to.loads.push_back({unit.body_a, unit.a, -effort * unit.force, -effort * unit.moment});
      to.loads.push_back({unit.body_b, unit.b, effort * unit.force, effort * unit.moment});
    }
  }

  /// 1 at its max, -1 at its min, where it stays; else 0.
  int touched(const Stop& stop) const {
    constexpr double no_gap = 1e-9;
    if (!stands_still(stop.on)) return 0;
    const double value = value_of(scene_, stop.on, poses_), near = no_gap * (stop.on.is_angle() ? 1.0 : size_);
    return std::abs(value - stop.max) < near ? 1 : std::abs(value - stop.min) < near ? -1 : 0;
  }

  bool stands_still(const Measure& on) const {
    return std::abs(rate_of(scene_, motions_, on)) <= no_rate * fastest_ * (on.is_angle() ? 1.0 : size_);
  }

  /// Whether it stands for a joint's friction (resisted_by_joints()), which is found with the force in the joint.
  bool is_of_joint(int element) const {
    for (int j = 0; j < static_cast<int>(scene_.joints.size()); ++j) {
      if (friction_element(scene_, j) == element) return true;
    }
    return false;
  }

  void hold(const Measure& on, const Held& what) {
    additions.drives.push_back({.name = "friction", .on = on, .start = {}});
    held.push_back(what);
  }

  void add_resistance(std::size_t element) {
    const Element& of = scene_.elements[element];
    element_force.push_back(0.0);
    if (of.feedback) {
      element_force.back() = -control_outputs(scene_, of, motions_).effort;
      if (of.feedback->acts) add_effort_on(of.on, -element_force.back(), additions);
      return;
    }
    if (!resists_motion(of.law) || is_of_joint(static_cast<int>(element))) return;
    const auto* const friction = std::get_if<DryFriction>(&of.law);
    if (friction != nullptr && friction->width == 0.0 && stands_still(of.on)) {
      hold(of.on, {.element = static_cast<int>(element)});
      return;
    }
    const double force =
        force_of_motion(of.law, value_of(scene_, of.on, poses_), rate_of(scene_, motions_, of.on)).value;
    element_force.back() = force;
    add_effort_on(of.on, -force, additions);
  }

  const Scene& scene_;
  const std::vector<BodyMotion>& motions_;
  std::vector<BodyPose<double>> poses_;
  double size_, fastest_;
};

/// Friction of joints in a motion that takes place: it fits the accelerations, so that the bodies balance with it only.
/// The efforts are bounds under the joint forces that they make; each follows from the last until they stay.
FreeBodies balance_in_motion(const Scene& then, const MovingLoads& loads, const std::vector<BodyMotion>& motions,
                             double size, SlidingFriction& friction) {
  using State = SlidingFriction::State;
  const std::vector<int>& sides = loads.sides;
  const std::vector<BodyPose<double>> poses = poses_of(motions);
  friction.joints = loads.sliding;
  friction.stops = loads.rubbing;
  if (friction.joints.empty() && friction.stops.empty()) return balance(then, poses, sides, size, loads.additions);
  constexpr int most = 200;
  constexpr double stays = 1e-13;
  friction.state = State::several;
  FreeBodies bodies;
  for (int step = 0; step < most && friction.state == State::several; ++step) {
    bodies = balance(then, poses, sides, size, loads.with(friction));
    double change = 0.0;
    for (SlidingStop& one : friction.stops) {
      const auto stop = static_cast<std::size_t>(one.stop);
      const Reaction* const reaction = reaction_of_stop(bodies.reactions, stop);
      const double bound = *then.stops[stop].friction * (reaction == nullptr ? 0.0 : std::abs(reaction->axial));
      const double effort = one.rate < 0.0 ? bound : -bound;
      change = std::max(change, std::abs(effort - one.effort));
      one.effort = effort;
    }
    for (SlidingJoint& one : friction.joints) {
      const Joint& joint = then.joints[static_cast<std::size_t>(one.joint)];
      const Reaction& reaction = bodies.reactions[static_cast<std::size_t>(one.joint)];
      if (!reaction.determined && grip_factor(joint) != 0.0) {
        friction.state = State::undetermined;
        friction.because_of = one.joint;
      }
      one.bound = friction_bound(joint, reaction);
      const double effort = one.rate < 0.0 ? one.bound : -one.bound;
      change = std::max(change, std::abs(effort - one.effort) / (one.on.is_angle() ? size : 1.0));
      one.effort = effort;
    }
    if (friction.state == State::several && change <= stays * bodies.largest_force) friction.state = State::solved;
  }
  for (const SlidingJoint& one : friction.joints) friction.lost_in_joints += one.lost();
  return bodies;
}

}  // namespace

Forces forces_in_motion(const Scene& given, const MotionModel& model, const std::vector<double>& x,
                        const std::vector<double>& v, const std::vector<double>& a, double fastest,
                        const std::vector<double>* efforts) {
  Forces out;
  out.motions = body_motions(model, x, v, a);
  std::vector<BodyMotion> motions = out.motions;
  const std::vector<BodyPose<double>> poses = model.poses_from_anchor(x);
  for (std::size_t i = 0; i < motions.size(); ++i) motions[i].pose = poses[i];
  for (const double one : v) fastest = std::max(fastest, std::abs(one));
  const double size = model.scales().length;
  std::optional<Scene> room;
  const Scene& then = with_set_numbers(given, motions, room);
  const MovingLoads loads(then, motions, size, fastest, efforts);
  FreeBodies bodies = balance_in_motion(then, loads, motions, size, out.friction);
  out.element_force = loads.element_force;
  for (std::size_t e = 0; e < then.elements.size(); ++e) out.element_force[e] += bodies.element_force[e];
  const std::size_t first_drive = bodies.reactions.size() - loads.additions.drives.size();
  const auto add_drive = [&](const Drive& drive, double value, bool determined) {
    const double rate = rate_of(then, motions, drive.on);
    out.drives.push_back({drive.name, drive.on.is_angle(), value, rate, value * rate, determined});
  };
  const std::size_t sought = efforts == nullptr ? then.drives.size() : 0;
  for (std::size_t k = sought; k < then.drives.size(); ++k) add_drive(then.drives[k], (*efforts)[k], true);
  for (std::size_t k = 0; k < loads.additions.drives.size(); ++k) {
    const Drive& drive = loads.additions.drives[k];
    const Reaction& found = bodies.reactions[first_drive + k];
    const double value = drive.on.is_angle() ? found.moment : -found.axial;
    if (k < sought) {
      add_drive(drive, value, found.determined);
      continue;
    }
    const auto& [element, joint, stop] = loads.held[k - sought];
    const double holding = found.determined ? value : undefined;
    if (element >= 0)
      out.element_force[static_cast<std::size_t>(element)] = -holding;
    else if (stop >= 0)
      out.friction.stops.push_back({.stop = stop, .on = drive.on, .effort = holding});
    else
      out.friction.joints.push_back({.joint = joint, .on = drive.on, .effort = holding});
  }
  bodies.reactions.resize(first_drive);
  out.reactions = std::move(bodies.reactions);
  out.redundancy = bodies.redundancy;
  out.imbalance = bodies.imbalance;
  out.worst_body = then.bodies.size() > 1 ? then.bodies[static_cast<std::size_t>(bodies.worst_body)].name : "";
  out.largest_force = bodies.largest_force;
  return out;
}

namespace {

/// Chebyshev's points of an interval, between -1 and 1.
constexpr std::size_t chebyshev_points = 12;
double chebyshev_point(std::size_t k) {
  return std::cos((static_cast<double>(k) + 0.5) * std::numbers::pi / chebyshev_points);
}

/// The Chebyshev coefficients of the derivative, by the argument in -1..1, of the polynomial with these values at the
/// points.
std::vector<double> slopes_of(const std::array<double, chebyshev_points>& values) {
  constexpr std::size_t n = chebyshev_points;
  std::vector<double> c(n, 0.0), slopes(n + 1, 0.0);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < n; ++k) {
      c[j] += 2.0 / n * values[k] *
              std::cos(static_cast<double>(j) * (static_cast<double>(k) + 0.5) * std::numbers::pi / n);
    }
  }
  for (std::size_t j = n - 1; j-- > 0;) {
    slopes[j] = slopes[j + 2] + 2.0 * static_cast<double>(j + 1) * c[j + 1];
  }
  slopes[0] /= 2;
  slopes.resize(n - 1);
  return slopes;
}

/// The series at s, by Clenshaw's recurrence.
double series_at(const std::vector<double>& coefficients, double s) {
  double next = 0.0, after = 0.0;
  for (std::size_t j = coefficients.size() - 1; j > 0; --j) {
    const double here = coefficients[j] + 2 * s * next - after;
    after = next;
    next = here;
  }
  return coefficients[0] + s * next - after;
}

/// Whether accelerations between two times of a motion are rounding, magnified by the square of how near these are, as
/// on both sides of a border that a step ends at.
bool are_one_time(const std::vector<double>& nodes, double from, double to) {
  constexpr double one_time = 1e-6;  // of the motion
  return to - from <= one_time * (nodes.back() - nodes.front());
}

/// Places at which extremes are looked for: all nodes, at which something may jump, with both sides of them, and
/// between.
std::vector<double> places_between(const std::vector<double>& nodes) {
  constexpr int parts = 8;
  std::vector<double> out;
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const double from = nodes[k], to = nodes[k + 1];
    if (from == to) continue;
    const int inner = are_one_time(nodes, from, to) ? 1 : parts;
    for (int i = 0; i < inner; ++i) out.push_back(from + (to - from) * i / inner);
    out.push_back(std::nextafter(to, from));
  }
  out.push_back(nodes.back());
  return out;
}

/// Gauss's rule of five points between each two nodes, exact for polynomials of degree 9: visit(t, weight).
template <class Visit>
void for_each_gauss_point(const std::vector<double>& nodes, Visit visit) {
  constexpr std::array<std::pair<double, double>, 5> gauss{{{-0.9061798459386640, 0.2369268850561891},
                                                            {-0.5384693101056831, 0.4786286704993665},
                                                            {0.0, 128.0 / 225},
                                                            {0.5384693101056831, 0.4786286704993665},
                                                            {0.9061798459386640, 0.2369268850561891}}};
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    const double half = (nodes[k + 1] - nodes[k]) / 2;
    if (half == 0.0) continue;
    if (are_one_time(nodes, nodes[k], nodes[k + 1])) {
      visit(nodes[k], 2 * half);
      continue;
    }
    for (const auto& [place, weight] : gauss) visit(nodes[k] + half * (1 + place), weight * half);
  }
}

/// The force of which the work is asked for: of a push, an element or a drive, perhaps times a number.
const SoughtQuantity& force_in(const SoughtQuantity& of) {
  if (of.of.empty()) return of;
  return force_in(of.of[0].kind == Kind::number ? of.of[1] : of.of[0]);
}

}  // namespace

QuantitiesAlong::QuantitiesAlong(const Scene& scene, const MotionModel& model, const Motion& motion)
    : scene_(scene),
      model_(model),
      path_(motion.trajectory),
      quantities_(scene, model),
      states_(model, motion),
      at_(undefined) {}

const Forces& QuantitiesAlong::state(double t, bool with_forces) {
  if (t == at_ && (has_forces_ || !with_forces)) return forces_;
  const auto& [x, v, a] = states_.at(t);
  at_ = t;
  has_forces_ = with_forces;
  if (!with_forces) {
    forces_ = Forces{};
    forces_.motions = body_motions(model_, x, v, a);
    return forces_;
  }
  forces_ = forces_in_motion(then(t), model_, x, v, a, states_.fastest());
  if (forces_.friction.has_no_forces()) return forces_;
  imbalance_ = std::max(imbalance_, forces_.imbalance);
  largest_force_ = std::max(largest_force_, forces_.largest_force);
  return forces_;
}

const Scene& QuantitiesAlong::then(double t) {
  if (scene_.time_functions.empty()) return scene_;
  if (!then_ || then_at_ != t) then_ = at_time(scene_, t);
  then_at_ = t;
  return *then_;
}

// The later of two where t is a node, as TrajectoryReader has it.
std::size_t QuantitiesAlong::interval_at(double t) const {
  const std::vector<double>& times = path_.t;
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  auto interval = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - times.begin() - 1, 0));
  interval = std::min(interval, times.size() - 2);
  while (interval > 0 && times[interval] == times[interval + 1]) --interval;
  return interval;
}

double QuantitiesAlong::rate(const SoughtQuantity& of, double t) {
  if (!MovingQuantities::needs_forces(of)) {
    const SoughtQuantity by_time{.name = "rate", .kind = Kind::by_time, .of = {of}};
    const double exact = quantities_.value(by_time, state(t, false), then(t));
    if (!std::isnan(exact)) return exact;
  }
  const std::size_t interval = interval_at(t);
  const double from = path_.t[interval], half = (path_.t[interval + 1] - from) / 2;
  auto found =
      std::find_if(polynomials_.begin(), polynomials_.end(), [&](const Polynomial& one) { return one.of == of.name; });
  if (found == polynomials_.end() || found->interval != interval) {
    std::array<double, chebyshev_points> values{};
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = value(of, from + half * (1 + chebyshev_point(k)));
    // value() may have added others.
    found = std::find_if(polynomials_.begin(), polynomials_.end(),
                         [&](const Polynomial& one) { return one.of == of.name; });
    if (found == polynomials_.end()) found = polynomials_.insert(polynomials_.end(), Polynomial{of.name, interval, {}});
    found->interval = interval;
    found->slopes = slopes_of(values);
  }
  return series_at(found->slopes, (t - from) / half - 1) / half;
}

double QuantitiesAlong::value(const SoughtQuantity& of, double t) {
  switch (of.kind) {
    case Kind::maximum:
    case Kind::minimum:
    case Kind::mean:
    case Kind::span:
    case Kind::work:
      return over_motion(of);
    case Kind::by_time:
      return rate(of.of[0], t);
    case Kind::sum:
      return value(of.of[0], t) + value(of.of[1], t);
    case Kind::difference:
      return value(of.of[0], t) - value(of.of[1], t);
    case Kind::product:
      return value(of.of[0], t) * value(of.of[1], t);
    case Kind::quotient: {
      const double out = value(of.of[0], t) / value(of.of[1], t);
      return std::isfinite(out) ? out : undefined;
    }
    default:
      return quantities_.value(of, state(t, MovingQuantities::needs_forces(of)), then(t));
  }
}

double QuantitiesAlong::work(const SoughtQuantity& of, double t) {
  const SoughtQuantity& force = force_in(of);
  const Measure on = force.kind == Kind::push          ? along_of(force)
                     : force.kind == Kind::drive_force ? force.on
                                                       : scene_.elements[static_cast<std::size_t>(force.item)].on;
  return value(of, t) * rate_of(scene_, state(t, false).motions, on);
}

double QuantitiesAlong::over_motion(const SoughtQuantity& of) {
  const auto known =
      std::find_if(over_motion_.begin(), over_motion_.end(), [&](const auto& one) { return one.first == of.name; });
  if (known != over_motion_.end()) return known->second;
  double out = 0.0;
  if (of.kind == Kind::work) {
    for_each_gauss_point(path_.t, [&](double t, double weight) { out += weight * work(of.of[0], t); });
  } else {
    const QuantityRange range = ranges({of.of[0]}).front();
    out = of.kind == Kind::maximum   ? range.greatest.value
          : of.kind == Kind::minimum ? range.least.value
          : of.kind == Kind::mean    ? range.mean
                                     : range.greatest.value - range.least.value;
  }
  over_motion_.emplace_back(of.name, out);
  return out;
}

std::vector<QuantityRange> QuantitiesAlong::ranges(const std::vector<SoughtQuantity>& of) {
  const std::vector<double> times = places_between(path_.t);
  std::vector<std::vector<double>> values(of.size());
  for (const double t : times) {
    for (std::size_t k = 0; k < of.size(); ++k) values[k].push_back(value(of[k], t));
  }
  std::vector<QuantityRange> out(of.size());
  for_each_gauss_point(path_.t, [&](double t, double weight) {
    for (std::size_t k = 0; k < of.size(); ++k) out[k].mean += weight * value(of[k], t);
  });
  for (std::size_t k = 0; k < of.size(); ++k) {
    out[k].mean /= path_.t.back() - path_.t.front();
    const auto is_none = [](double value) { return std::isnan(value); };
    if (std::any_of(values[k].begin(), values[k].end(), is_none)) out[k].mean = undefined;
    out[k].least = extreme(of[k], times, values[k], 1.0);
    out[k].greatest = extreme(of[k], times, values[k], -1.0);
  }
  return out;
}

// It is sought around each sample that is least among its neighbours, and beside which the value can be less than all
// others.
ValueInTime QuantitiesAlong::extreme(const SoughtQuantity& of, const std::vector<double>& times,
                                     const std::vector<double>& values, double sign) {
  std::size_t best = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isnan(values[k])) return {undefined, undefined};
    if (sign * values[k] < sign * values[best]) best = k;
  }
  ValueInTime found{times[best], values[best]};
  const auto refine = [&](std::size_t from) {
    constexpr double narrow = 1e-8;  // of an interval: rounding of the value hides what is nearer
    const ValueAt refined = least_between([&](double t) { return sign * value(of, t); }, times[from], times[from + 1],
                                          narrow * (times[from + 1] - times[from]));
    if (refined.value < sign * found.value) found = {refined.at, sign * refined.value};
  };
  const auto fall = [&](std::size_t from, std::size_t to) { return sign * (values[from] - values[to]); };
  for (std::size_t k = 0; k < values.size(); ++k) {
    // Where something jumps, or nodes are at one time, an interval has no length.
    const bool has_left = k > 0 && !are_one_time(path_.t, times[k - 1], times[k]);
    const bool has_right = k + 1 < times.size() && !are_one_time(path_.t, times[k], times[k + 1]);
    const double left = has_left ? fall(k - 1, k) : 0.0, right = has_right ? fall(k + 1, k) : 0.0;
    if (left < 0.0 || right < 0.0) continue;
    // A parabola through the three falls below the middle one by less than the larger difference; where both are zero,
    // as of the force of a spring that is slack, not at all.
    if (sign * values[k] - std::max(left, right) >= sign * found.value) continue;
    if (has_left) refine(k - 1);
    if (has_right) refine(k);
  }
  return found;
}

}  // namespace poise

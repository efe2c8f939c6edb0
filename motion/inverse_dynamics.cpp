#include "motion/inverse_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <variant>

#include "model/joint_friction.hpp"
#include "model/meshing.hpp"
#include "motion/controller_efforts.hpp"
#include "motion/stop_room.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/bodies/free_bodies.hpp"
#include "statics/model/curvature.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Distance within which a stop is touched, rad or mechanism sizes.
constexpr double touching = 1e-8;
// Rates below this, of scaled coordinates along a unit direction, are rounding.
constexpr double rate_tolerance = 1e-9;
// Share of the largest force that rounding may leave unbalanced.
constexpr double balanced_within = 1e-9;

// Whether pins and welds keep two points together.
bool coincide(const Scene& scene, const PointRef& p, const PointRef& q) {
  const std::vector<PointRef> reached = coincident_points(scene, p);
  return std::any_of(reached.begin(), reached.end(),
                     [&](const PointRef& r) { return r.body == q.body && scene.local(r) == scene.local(q); });
}

// Whether two measures that are no sums, angles or travels are of the same points.
bool is_same(const Scene& scene, const Measure& one, const Measure& other) {
  if (one.kind != other.kind) return false;
  switch (one.kind) {
    case Measure::Kind::distance:
      return (coincide(scene, one.a, other.a) && coincide(scene, one.b, other.b)) ||
             (coincide(scene, one.a, other.b) && coincide(scene, one.b, other.a));
    case Measure::Kind::x:
    case Measure::Kind::y:
      return coincide(scene, one.b, other.b);
    case Measure::Kind::component:
      return one.a == other.a && coincide(scene, one.b, other.b) && cross(one.axis, other.axis) == 0.0;
    case Measure::Kind::clearance:
    case Measure::Kind::along_outline:
      return one.outline == other.outline && one.b == other.b && one.radius == other.radius;
    case Measure::Kind::slip_on_cam:
      return one.stop == other.stop;
    case Measure::Kind::rope:
      return one.contacts.size() == other.contacts.size() &&
             std::equal(one.contacts.begin(), one.contacts.end(), other.contacts.begin(),
                        [](const RopeContact& p, const RopeContact& q) {
                          return p.at == q.at && p.radius == q.radius && p.turn == q.turn;
                        });
    default:
      return false;
  }
}

// Whether a measure depends on a driven one only.
bool is_parallel(const MotionModel& model, const Measure& measure, const Measure& driven) {
  const Scene& scene = model.scene();
  if (driven.kind == Measure::Kind::angle) {
    const auto frames = [&](const Measure& m) {
      const auto frame = [&](int body) { return model.layout().links[static_cast<std::size_t>(body)].frame; };
      return std::minmax({frame(m.body_a), frame(m.body_b)});
    };
    return measure.kind == Measure::Kind::angle && frames(measure) == frames(driven);
  }
  if (driven.kind == Measure::Kind::distance && measure.kind == Measure::Kind::travel) {
    return is_parallel(model, driven, measure);
  }
  if (driven.kind != Measure::Kind::travel) return is_same(scene, measure, driven);
  if (measure.kind == Measure::Kind::travel) return measure.joint == driven.joint;
  if (measure.kind != Measure::Kind::distance) return false;
  const Joint& joint = scene.joints[static_cast<std::size_t>(driven.joint)];
  const bool between_both = joint.kind == Joint::Kind::slide &&
                            std::minmax({measure.a.body, measure.b.body}) == std::minmax({joint.a.body, joint.b.body});
  return between_both || (coincide(scene, measure.a, joint.a) && coincide(scene, measure.b, joint.b)) ||
         (coincide(scene, measure.a, joint.b) && coincide(scene, measure.b, joint.a));
}

class InverseDynamics {
 public:
  InverseDynamics(const MotionModel& model, const std::vector<double>& x, const std::vector<double>& v,
                  const std::vector<double>& a, const std::vector<Drive>& drives)
      : model_(model),
        motions_(from_anchor(model, x, out_.motions = body_motions(model, x, v, a))),
        scene_(with_set_numbers(model.scene(), motions_, room_)),
        m_(model.mechanism()),
        x_(x),
        v_(v),
        a_(a) {
    additions_.drives = drives;
    additions_.blades = true;
  }

  Forces forces() {
    add_inertia();
    add_resistance();
    balance_bodies();
    look_at_phasors();
    return out_;
  }

 private:
  static std::vector<BodyMotion> from_anchor(const MotionModel& model, const std::vector<double>& x,
                                             std::vector<BodyMotion> motions) {
    const std::vector<BodyPose<double>> poses = model.poses_from_anchor(x);
    for (std::size_t i = 0; i < poses.size(); ++i) motions[i].pose = poses[i];
    return motions;
  }

  void add_inertia() {
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      const Body& body = scene_.bodies[i];
      const BodyMotion& motion = motions_[i];
      additions_.loads.push_back({static_cast<int>(i), motion.pose.world(body.center),
                                  -body.mass * motion.acceleration_of(body.center),
                                  -body.inertia * motion.angular_acceleration});
    }
  }

  void add_resistance() {
    const std::vector<BodyPose<double>> poses = poses_of(motions_);
    for (const Element& e : scene_.elements) {
      double& force = out_.element_force.emplace_back(0.0);
      if (!resists_motion(e.law) && !e.feedback) continue;
      force = e.feedback ? -control_outputs(scene_, e, motions_).effort
                         : force_of_motion(e.law, value_of(scene_, e.on, poses), rate_of(scene_, motions_, e.on)).value;
      if (e.feedback && !e.feedback->acts) continue;
      std::vector<BodyLoad>& loads = std::holds_alternative<DryFriction>(e.law) ? dry_friction_ : additions_.loads;
      if (std::holds_alternative<DryFriction>(e.law)) lost_in_elements_ += force * rate_of(scene_, motions_, e.on);
      for (const UnitEffort& effort : unit_efforts(scene_, e.on, poses)) {
        loads.push_back({effort.body_a, effort.a, force * effort.force, force * effort.moment});
        loads.push_back({effort.body_b, effort.b, -force * effort.force, -force * effort.moment});
      }
    }
  }

  // Per stop: +1 at its max, -1 at its min, 2 at both, 0 not touching or idle.
  std::vector<int> pressable_stops() {
    const std::vector<StopRoom> rooms = stop_rooms(model_, x_);
    std::vector<int> sides, touched;
    for (std::size_t s = 0; s < rooms.size(); ++s) {
      const bool at_max = rooms[s].past_max >= -touching;
      const bool at_min = rooms[s].past_min >= -touching;
      sides.push_back(at_max && at_min ? 2 : at_max ? 1 : at_min ? -1 : 0);
      if (sides.back() != 0) touched.push_back(static_cast<int>(s));
      const double unit = scene_.stops[s].on.is_angle() ? 1.0 : model_.scales().length;
      out_.overrun.push_back(rooms[s].overrun() > touching ? unit * rooms[s].overrun() : 0.0);
    }
    for (const int s : decided_by_drives(touched)) {
      sides[s] = 0;
      out_.idle_stops.push_back(scene_.stops[s].name);
    }
    return sides;
  }

  // Stops whose rate is a linear combination of the drives' rates for every motion that the loops permit.
  std::vector<int> decided_by_drives(const std::vector<int>& stops) const {
    if (stops.empty() || additions_.drives.empty()) return {};
    std::vector<int> closure_rows(m_.equalities()), stop_rows;
    std::iota(closure_rows.begin(), closure_rows.end(), 0);
    for (const int s : stops) stop_rows.push_back(m_.stop_row(s));
    const MatrixXd basis = ReducedHessian(m_, x_, closure_rows).basis;
    const MatrixXd stop_rates = (DensePoint<double>(m_, x_, stop_rows).jacobian * basis).transpose();
    MatrixXd drive_rates(basis.cols(), static_cast<Index>(additions_.drives.size()));
    const std::vector<double> none(x_.size(), 0.0);
    for (Index k = 0; k < basis.cols(); ++k) {
      const auto direction = basis.col(k);
      const std::vector<BodyMotion> motions = body_motions(model_, x_, {direction.begin(), direction.end()}, none);
      for (Index d = 0; d < drive_rates.cols(); ++d) {
        const Drive& drive = additions_.drives[static_cast<std::size_t>(d)];
        const double unit = drive.on.is_angle() ? 1.0 : model_.scales().length;
        drive_rates(k, d) = rate_of(scene_, motions, drive.on) / unit;
      }
    }
    // At a dead centre of the drives their rates are rounding only.
    if (drive_rates.size() == 0 || drive_rates.cwiseAbs().maxCoeff() < rate_tolerance) return {};
    const solvers::LeastSquares<double> drives(drive_rates, solvers::known_to::closed_point);
    std::vector<int> decided;
    for (std::size_t k = 0; k < stops.size(); ++k) {
      const VectorXd rates = stop_rates.col(static_cast<Index>(k));
      if ((rates - drive_rates * drives.solve(rates)).norm() <= rate_tolerance) decided.push_back(stops[k]);
    }
    return decided;
  }

  // Efforts of the drives and their power without any friction.
  void look_at_efforts_without(const std::vector<int>& sides, SlidingFriction& friction) const {
    const FreeBodies bodies = balance(scene_, poses_of(motions_), sides, model_.scales().length, additions_);
    for (const DriveEffort& effort : efforts_of(bodies)) {
      friction.efforts_without.push_back(effort.value);
      friction.driven_without += effort.power;
    }
  }

  std::vector<DriveEffort> efforts_of(const FreeBodies& bodies) const {
    std::vector<DriveEffort> out;
    const auto first_drive = bodies.reactions.end() - static_cast<std::ptrdiff_t>(additions_.drives.size());
    for (std::size_t k = 0; k < additions_.drives.size(); ++k) {
      const Drive& drive = additions_.drives[k];
      const Reaction& found = first_drive[static_cast<std::ptrdiff_t>(k)];
      DriveEffort effort{drive.name, drive.on.is_angle(), 0.0, rate_of(scene_, motions_, drive.on),
                         0.0,        found.determined};
      effort.value = effort.is_angle ? found.moment / first_moment(drive.on) : -found.axial;
      effort.power = effort.value * effort.rate;
      out.push_back(std::move(effort));
    }
    return out;
  }

  // The moment of a unit effort on an angle: 1, or of a sum that of its first term, which the reaction shows.
  double first_moment(const Measure& angle) const {
    for (const UnitEffort& unit : unit_efforts(scene_, angle, poses_of(motions_))) {
      if (unit.moment != 0.0) return unit.moment;
    }
    return 1.0;
  }

  void balance_bodies() {
    std::vector<int> sides = pressable_stops();
    SlidingFriction without;
    if (!joints_with_friction(scene_).empty()) look_at_efforts_without(sides, without);
    additions_.loads.insert(additions_.loads.end(), dry_friction_.begin(), dry_friction_.end());
    double fastest = 0.0;
    for (const double rate : v_) fastest = std::max(fastest, std::abs(rate));
    const auto found = [&] {
      return sliding_friction({scene_, motions_, sides, model_.scales().length, additions_, fastest});
    };
    Slid slid = found();
    for (const int s : slid.bodies.pulling) out_.pulling.push_back({static_cast<std::size_t>(s), sides[s] == 1});
    for (const PullingStop& one : out_.pulling) sides[one.stop] = 2;
    if (!out_.pulling.empty()) slid = found();
    SlidingFriction& friction = slid.friction;
    FreeBodies& bodies = slid.bodies;
    friction.efforts_without = std::move(without.efforts_without);
    friction.driven_without = without.driven_without;
    friction.lost_in_elements = lost_in_elements_;
    out_.friction = std::move(friction);
    out_.drives = efforts_of(bodies);
    out_.reactions.assign(bodies.reactions.begin(),
                          bodies.reactions.end() - static_cast<std::ptrdiff_t>(additions_.drives.size()));
    for (std::size_t i = 0; i < scene_.elements.size(); ++i) out_.element_force[i] += bodies.element_force[i];
    out_.redundancy = bodies.redundancy;
    out_.imbalance = bodies.imbalance;
    out_.worst_body = scene_.bodies.size() > 1 ? scene_.bodies[bodies.worst_body].name : "";
    out_.largest_force = bodies.largest_force;
    out_.balanced = out_.pulling.empty() && out_.imbalance <= balanced_within * out_.largest_force;
    pressing_ = std::move(bodies.pressing);
  }

  // The same motion in the phasor model: power, and virtual work along every free direction.
  void look_at_phasors() {
    std::vector<int> rows(m_.equalities());
    std::iota(rows.begin(), rows.end(), 0);
    for (int s : pressing_) rows.push_back(m_.stop_row(s));
    const ReducedHessian free(m_, x_, rows);
    std::vector<Planar<double>> pose(m_.pose_size());
    m_.place(x_.data(), pose.data());

    const std::size_t n = x_.size();
    std::vector<Planar<double>> velocity(n), acceleration(n), bending(n), push(n);
    m_.phasors().first(pose.data(), v_.data(), velocity.data());
    m_.phasors().first(pose.data(), a_.data(), acceleration.data());
    m_.phasors().second(pose.data(), v_.data(), v_.data(), bending.data());
    for (std::size_t t = 0; t < n; ++t) acceleration[t] += bending[t];
    out_.loop_error = std::max(opening(velocity), opening(acceleration));

    VectorXd inertia = VectorXd::Zero(static_cast<Index>(n));
    model_.inertia().weigh(acceleration.data(), push.data());
    m_.phasors().add_projection(pose.data(), push.data(), inertia.data());
    for (Index k = 0; k < inertia.size(); ++k) inertia[k] += model_.inertia().moment(static_cast<int>(k)) * a_[k];
    VectorXd loads(inertia.size());
    m_.negative_force(x_.data(), pose.data(), loads.data());
    VectorXd resistance = VectorXd::Zero(inertia.size());
    std::vector<double> resistances(static_cast<std::size_t>(m_.resistances_size()));
    m_.resist(pose.data(), v_.data(), nullptr, resistances.data());
    m_.add_resistance(resistances.data(), resistance.data());

    const double energy = model_.scales().energy();
    const Eigen::Map<const VectorXd> rates(v_.data(), static_cast<Index>(n));
    PowerBalance& power = out_.power;
    power.kinetic = energy * inertia.dot(rates);
    power.potential = energy * loads.dot(rates);
    power.resisted = energy * resistance.dot(rates);
    power.rubbed = out_.friction.lost_in_joints;
    for (const DriveEffort& drive : out_.drives) power.driven += drive.power;
    const double fastest = rates.size() > 0 ? rates.cwiseAbs().maxCoeff() : 0.0;
    const double size = out_.largest_force * model_.scales().length * fastest + std::abs(power.driven);
    const double left_over = power.kinetic + power.potential + power.resisted + power.rubbed - power.driven;
    if (size > 0) power.error = std::abs(left_over) / size;

    const VectorXd left = energy * free.basis.transpose() * (inertia + loads + resistance);
    const std::vector<double> none(n, 0.0);
    for (Index k = 0; k < left.size(); ++k) {
      const auto direction = free.basis.col(k);
      const std::vector<BodyMotion> motions = body_motions(model_, x_, {direction.begin(), direction.end()}, none);
      double work = left[k];
      for (std::size_t d = 0; d < out_.drives.size(); ++d) {
        work -= out_.drives[d].value * rate_of(scene_, motions, additions_.drives[d].on);
      }
      for (const Reaction& one : out_.reactions) {
        for (const Blade& blade : scene_.blades) {
          if (one.kind == "blade" && one.name == blade.name) work -= work_of(blade, one.force, motions);
        }
      }
      for (const SlidingJoint& one : out_.friction.joints) {
        work -= one.effort * rate_of(scene_, motions, one.on);
      }
      if (out_.largest_force == 0.0) continue;
      out_.work_error = std::max(out_.work_error, std::abs(work) / (out_.largest_force * model_.scales().length));
    }
  }

  // The rate of work of a force of a blade on the body of its point, along a direction, is that against its other body.
  double work_of(const Blade& blade, Vec2 force, const std::vector<BodyMotion>& along) const {
    const Vec2 place = along[static_cast<std::size_t>(blade.at.body)].pose.world(scene_.local(blade.at));
    return dot(force, along[static_cast<std::size_t>(blade.at.body)].velocity_at(place) -
                          along[static_cast<std::size_t>(blade.on)].velocity_at(place));
  }

  // Largest derivative of the closures by the derivatives of the phasors, over the largest of these.
  double opening(const std::vector<Planar<double>>& derivative) const {
    double largest = 0.0;
    for (const Planar<double>& d : derivative) largest = std::max(largest, norm(d));
    if (largest == 0.0) return 0.0;
    std::vector<double> c(m_.equalities());
    m_.closures_of(derivative.data(), c.data());
    double widest = 0.0;
    for (double value : c) widest = std::max(widest, std::abs(value));
    return widest / largest;
  }

  const MotionModel& model_;
  Forces out_;
  std::vector<BodyMotion> motions_;  // measured from the anchor
  std::optional<Scene> room_;
  const Scene& scene_;  // with the numbers that controllers set
  const Mechanism<double>& m_;
  const std::vector<double>&x_, &v_, &a_;
  Additions additions_;
  std::vector<BodyLoad> dry_friction_;  // of [[friction]]
  double lost_in_elements_ = 0.0;       // by it
  std::vector<int> pressing_;
};

}  // namespace

std::vector<ParallelElement> parallel_elements(const MotionModel& model, const std::vector<Drive>& drives) {
  const std::vector<Element>& elements = model.scene().elements;
  std::vector<ParallelElement> out;
  for (const Drive& drive : drives) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if (is_parallel(model, elements[i].on, drive.on)) out.push_back({i, drive.name});
    }
  }
  return out;
}

Forces forces_of(const MotionModel& model, const std::vector<double>& x, const std::vector<double>& v,
                 const std::vector<double>& a, const std::vector<Drive>& drives) {
  return InverseDynamics(model, x, v, a, drives).forces();
}

std::vector<SourcedForce> forces_on_bodies(const Scene& scene, const Forces& forces) {
  std::vector<BodyPose<double>> poses = poses_of(forces.motions);
  const Vec2 from_anchor = poses.front().origin;
  for (BodyPose<double>& pose : poses) pose.origin = pose.origin - from_anchor;
  std::vector<SourcedForce> out = forces_on_bodies(scene, poses, forces.element_force, forces.reactions);
  for (std::size_t d = 0; d < forces.drives.size(); ++d) {
    add_effort(scene, poses, scene.drives[d].on, forces.drives[d].value, "drive", forces.drives[d].name, out);
  }
  for (const SlidingJoint& one : forces.friction.joints) {
    add_effort(scene, poses, one.on, one.effort, "friction", scene.joints[static_cast<std::size_t>(one.joint)].name,
               out);
  }
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const BodyMotion& motion = forces.motions[i];
    const BodyForce inertia{.body = static_cast<int>(i),
                            .at = poses[i].world(body.center),
                            .force = -body.mass * motion.acceleration_of(body.center),
                            .moment = -body.inertia * motion.angular_acceleration};
    if (norm(inertia.force) != 0.0 || inertia.moment != 0.0) out.push_back({"inertia", body.name, inertia});
  }
  return out;
}

}  // namespace poise

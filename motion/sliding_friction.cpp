#include "motion/sliding_friction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "model/joint_friction.hpp"
#include "motion/friction_forces.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/bodies/contact_loads.hpp"
#include "statics/friction/held.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double no_sliding_rate = 1e-9;  // of the fastest
constexpr double out_of_balance = 1e-6;   // of the largest force
constexpr double contracts_below = 0.999999;
constexpr double forces_agree_within = 1e-12;  // of the largest force, of the equations g = B(g)
constexpr double confirmed_within = 1e-9;      // the same of the bodies cut free with these efforts
constexpr double no_power = 1e-9;  // of what is lost: as in a dead centre, where nothing but friction takes power

/// What a bound depends on: the force in a joint, and the couple about its point.
struct Carried {
  Vec2 force{};
  double moment = 0.0;
};

Carried operator+(const Carried& a, const Carried& b) { return {a.force + b.force, a.moment + b.moment}; }
Carried operator-(const Carried& a, const Carried& b) { return {a.force - b.force, a.moment - b.moment}; }
Carried operator*(double k, const Carried& a) { return {k * a.force, k * a.moment}; }

Carried carried(const Reaction& reaction) { return {reaction.force, reaction.moment}; }

/// The couple matters, and its factor.
double couple_factor(const Joint& joint) {
  const JointFriction& friction = *joint.friction;
  return joint.has_travel() && joint.keeps_angle() && friction.length > 0.0 ? 2.0 / friction.length : 0.0;
}

double bound_of(const Joint& joint, const Carried& at) {
  const JointFriction& friction = *joint.friction;
  const double constant = joint.has_travel() ? friction.force : friction.torque;
  return grip_factor(joint) * std::max(norm(at.force), couple_factor(joint) * std::abs(at.moment)) + constant;
}

/// Derivative of the bound where the joint carries `at` and what it carries changes by `by`.
double bound_by(const Joint& joint, const Carried& at, const Carried& by) {
  const double couple = couple_factor(joint);
  const double size = norm(at.force);
  if (couple * std::abs(at.moment) > size) {
    return grip_factor(joint) * couple * (at.moment < 0 ? -by.moment : by.moment);
  }
  return size > 0.0 ? grip_factor(joint) * dot(at.force, by.force) / size : grip_factor(joint) * norm(by.force);
}

/// The largest that the derivative can be.
double steepest_bound(const Joint& joint, const Carried& by) {
  return grip_factor(joint) * std::max(norm(by.force), couple_factor(joint) * std::abs(by.moment));
}

/// Solves g = k B(g), with g over the unit of its joint: 1 N, or 1 N times the size of a torque.
class SlidingSolver {
 public:
  explicit SlidingSolver(const SlidingProblem& problem) : p_(problem), sides_(problem.sides) {}

  Slid run() {
    out_.bodies = balance(p_.scene, poses_of(p_.motions), p_.sides, p_.size, p_.additions);
    find_joints();
    if (out_.friction.state == SlidingFriction::State::none) return std::move(out_);
    if (joints().empty()) {
      out_.friction.state = SlidingFriction::State::still;
      return std::move(out_);
    }
    if (out_.bodies.imbalance > out_of_balance * out_.bodies.largest_force) {
      out_.friction.state = SlidingFriction::State::unbalanced;
      return std::move(out_);
    }
    for (const SlidingJoint& one : joints()) {
      if (grip_factor(joint_of(one)) == 0.0 || reaction_of(out_.bodies, one).determined) continue;
      out_.friction.state = SlidingFriction::State::undetermined;
      out_.friction.because_of = one.joint;
      return std::move(out_);
    }
    // Stops may begin or cease to press with friction: once more with those that do then.
    FreeBodies reference = out_.bodies;
    for (int round = 0; round < 4; ++round) {
      press(reference);
      respond();
      const std::optional<VectorXd> g = solved();
      if (!g) return std::move(out_);
      FreeBodies found = with(*g, p_.sides);
      if (confirmed(*g, found)) {
        accept(*g, std::move(found));
        return std::move(out_);
      }
      reference = std::move(found);
    }
    out_.friction.state = SlidingFriction::State::several;
    return std::move(out_);
  }

 private:
  std::vector<SlidingJoint>& joints() { return out_.friction.joints; }
  const Joint& joint_of(const SlidingJoint& one) const { return p_.scene.joints[static_cast<std::size_t>(one.joint)]; }
  // Reactions come in the order of the joints.
  static const Reaction& reaction_of(const FreeBodies& bodies, const SlidingJoint& one) {
    return bodies.reactions[static_cast<std::size_t>(one.joint)];
  }
  double unit(std::size_t i) const { return out_.friction.joints[i].on.is_angle() ? p_.size : 1.0; }
  static double sign_of(const SlidingJoint& one) { return one.rate < 0 ? -1.0 : 1.0; }

  void find_joints() {
    for (const Rubbing& one : rubbing(p_.scene)) {
      if (one.joint < 0) continue;
      out_.friction.state = SlidingFriction::State::solved;
      const double rate = rate_of(p_.scene, p_.motions, one.on);
      const bool is_angle = one.on.is_angle();
      if (std::abs(rate) <= no_sliding_rate * p_.fastest * (is_angle ? 1.0 : p_.size)) {
        out_.friction.at_rest.push_back(one.joint);
        continue;
      }
      SlidingJoint& joint = out_.friction.joints.emplace_back();
      joint.joint = one.joint;
      joint.on = one.on;
      joint.rate = rate;
    }
  }

  // The stops that press act both ways while responses are found: these are linear.
  void press(const FreeBodies& bodies) {
    sides_.assign(p_.sides.size(), 0);
    for (const int stop : bodies.pressing) sides_[static_cast<std::size_t>(stop)] = 2;
  }

  FreeBodies with(const VectorXd& g, const std::vector<int>& sides) {
    return balance(p_.scene, poses_of(p_.motions), sides, p_.size, additions_with(g));
  }

  Additions additions_with(const VectorXd& g) {
    Additions additions = p_.additions;
    const std::vector<BodyPose<double>> poses = poses_of(p_.motions);
    for (std::size_t i = 0; i < joints().size(); ++i) {
      const double effort = -sign_of(joints()[i]) * g[static_cast<Index>(i)] * unit(i);
      for (const UnitEffort& by : unit_efforts(p_.scene, joints()[i].on, poses)) {
        additions.loads.push_back({by.body_b, by.b, effort * by.force, effort * by.moment});
        additions.loads.push_back({by.body_a, by.a, -effort * by.force, -effort * by.moment});
      }
    }
    return additions;
  }

  // Teeth that push their wheels apart by the size of their effort.
  struct Teeth {
    int stop = 0;
    std::size_t reaction = 0;           // index of FreeBodies::reactions
    double without = 0.0;               // effort without friction
    std::vector<double> by{};           // and more of it for each effort of friction
    std::vector<Carried> separating{};  // what joints carry more where they push by 1
    double at(const VectorXd& g) const {
      double out = without;
      for (std::size_t j = 0; j < by.size(); ++j) out += g[static_cast<Index>(j)] * by[j];
      return out;
    }
  };

  // Reactions of stops come behind those of joints, of those that act.
  void find_teeth() {
    teeth_.clear();
    std::size_t reaction = p_.scene.joints.size();
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      if (sides_[s] == 0) continue;
      if (separates(p_.scene.stops[s])) teeth_.push_back({static_cast<int>(s), reaction});
      ++reaction;
    }
  }

  double effort_of_teeth(const Teeth& teeth, const FreeBodies& bodies) const {
    return effort_of(p_.scene.stops[static_cast<std::size_t>(teeth.stop)], bodies.reactions[teeth.reaction]);
  }

  void respond_to_teeth(const FreeBodies& none) {
    const std::vector<BodyPose<double>> poses = poses_of(p_.motions);
    for (Teeth& teeth : teeth_) {
      const ContactLoad<double> contact = contact_load(BodyForces(p_.scene, poses), teeth.stop).value();
      const double size = norm(contact.separating);
      const Vec2 push = (scale_ / size) * contact.separating;
      Additions additions = p_.additions;
      additions.teeth_separate = false;
      additions.loads.push_back({contact.body_b, contact.at, push, 0.0});
      additions.loads.push_back({contact.body_a, contact.at, -push, 0.0});
      const FreeBodies pushed = balance(p_.scene, poses, sides_, p_.size, additions);
      teeth.without = effort_of_teeth(teeth, none);
      for (const SlidingJoint& one : joints()) {
        teeth.separating.push_back(size / scale_ *
                                   (carried(reaction_of(pushed, one)) - carried(reaction_of(none, one))));
      }
    }
  }

  // The same without what is not linear in the efforts.
  FreeBodies linearly_with(const VectorXd& g) {
    Additions additions = additions_with(g);
    additions.teeth_separate = false;
    return balance(p_.scene, poses_of(p_.motions), sides_, p_.size, additions);
  }

  // What all joints carry without friction, and more of it for each effort.
  void respond() {
    const std::size_t n = joints().size();
    const FreeBodies none = linearly_with(VectorXd::Zero(static_cast<Index>(n)));
    find_teeth();
    scale_ = none.largest_force > 0.0 ? none.largest_force : 1.0;
    without_.clear();
    by_.assign(n, {});
    for (const SlidingJoint& one : joints()) without_.push_back(carried(reaction_of(none, one)));
    respond_to_teeth(none);
    lipschitz_ = MatrixXd::Zero(static_cast<Index>(n), static_cast<Index>(n));
    for (std::size_t j = 0; j < n; ++j) {
      const FreeBodies one = linearly_with(scale_ * VectorXd::Unit(static_cast<Index>(n), static_cast<Index>(j)));
      for (Teeth& teeth : teeth_) teeth.by.push_back((effort_of_teeth(teeth, one) - teeth.without) / scale_);
      for (std::size_t i = 0; i < n; ++i) {
        by_[j].push_back(1.0 / scale_ * (carried(reaction_of(one, joints()[i])) - without_[i]));
        double& steepest = lipschitz_(static_cast<Index>(i), static_cast<Index>(j));
        steepest = steepest_bound(joint_of(joints()[i]), by_[j][i]) / unit(i);
        for (const Teeth& teeth : teeth_) {
          steepest += std::abs(teeth.by[j]) * steepest_bound(joint_of(joints()[i]), teeth.separating[i]) / unit(i);
        }
      }
    }
  }

  Carried carries(std::size_t i, const VectorXd& g) const {
    Carried out = without_[i];
    for (std::size_t j = 0; j < by_.size(); ++j) out = out + g[static_cast<Index>(j)] * by_[j][i];
    for (const Teeth& teeth : teeth_) out = out + std::abs(teeth.at(g)) * teeth.separating[i];
    return out;
  }

  // Derivative of carries() by an effort.
  Carried carries_by(std::size_t i, std::size_t j, const VectorXd& g) const {
    Carried out = by_[j][i];
    for (const Teeth& teeth : teeth_) out = out + (teeth.at(g) < 0 ? -teeth.by[j] : teeth.by[j]) * teeth.separating[i];
    return out;
  }

  // g - k B(g).
  VectorXd residual(const VectorXd& g, double k) const {
    VectorXd out = g;
    for (std::size_t i = 0; i < by_.size(); ++i) {
      out[static_cast<Index>(i)] -= k * bound_of(joint_of(out_.friction.joints[i]), carries(i, g)) / unit(i);
    }
    return out;
  }

  MatrixXd jacobian(const VectorXd& g, double k) const {
    MatrixXd out = MatrixXd::Identity(g.size(), g.size());
    for (std::size_t i = 0; i < by_.size(); ++i) {
      const Carried at = carries(i, g);
      for (std::size_t j = 0; j < by_.size(); ++j) {
        out(static_cast<Index>(i), static_cast<Index>(j)) -=
            k * bound_by(joint_of(out_.friction.joints[i]), at, carries_by(i, j, g)) / unit(i);
      }
    }
    return out;
  }

  static double size_of(const VectorXd& v) { return v.cwiseAbs().maxCoeff(); }

  // Newton's method from g; where a step does not come nearer, the step of the fixed point B.
  std::optional<VectorXd> newton(VectorXd g, double k, int most_steps) const {
    for (int step = 0; step < most_steps; ++step) {
      const VectorXd r = residual(g, k);
      const double left = size_of(r);
      if (!std::isfinite(left)) return std::nullopt;
      if (left <= forces_agree_within * std::max(scale_, size_of(g))) {
        if (g.minCoeff() < -forces_agree_within * scale_) return std::nullopt;
        return g;
      }
      const Eigen::FullPivLU<MatrixXd> factors(jacobian(g, k));
      const VectorXd next = factors.isInvertible() ? VectorXd(g - factors.solve(r)) : VectorXd(g - r);
      g = size_of(residual(next, k)) < left ? next : VectorXd(g - r);
    }
    return std::nullopt;
  }

  bool contracts() const { return lipschitz_.eigenvalues().cwiseAbs().maxCoeff() < contracts_below; }

  // From k = 0 to 1; where it cannot be followed any further, that k, and nothing.
  std::optional<VectorXd> followed(double& k) const {
    VectorXd g = VectorXd::Zero(static_cast<Index>(by_.size()));
    double step = 1.0 / 32;
    for (k = 0.0; k < 1.0;) {
      const double next_k = std::min(1.0, k + step);
      const std::optional<VectorXd> next = newton(g, next_k, 30);
      // The branch that begins without friction has a positive determinant; that of the other side of a pole or a fold
      // has not.
      if (next && jacobian(*next, next_k).determinant() > 0.0) {
        g = *next;
        k = next_k;
        step = std::min(1.0 / 32, 2 * step);
      } else if (step > 1e-9) {
        step *= 0.5;
      } else {
        return std::nullopt;
      }
    }
    return g;
  }

  // The same equations in the sizes of the forces in joints, and of the efforts of teeth behind them.
  FrictionForces sizes() const {
    std::vector<FrictionForces::Size> kinds;
    std::vector<Vec2> normals;
    for (const SlidingJoint& one : out_.friction.joints) {
      const Joint& joint = joint_of(one);
      kinds.push_back(!joint.has_travel()          ? FrictionForces::Size::pin
                      : couple_factor(joint) > 0.0 ? FrictionForces::Size::carriage
                                                   : FrictionForces::Size::normal);
      const BodyMotion& line = p_.motions[static_cast<std::size_t>(joint.a.body)];
      normals.push_back(joint.has_travel() ? quarter_turn(direction<double>(joint.axis) * line.pose.direction())
                                           : Vec2{});
    }
    kinds.resize(by_.size() + teeth_.size(), FrictionForces::Size::normal);
    FrictionForces out(std::move(kinds));
    const auto components = [&](std::size_t i, const Carried& at) -> Planar<double> {
      const Joint& joint = joint_of(out_.friction.joints[i]);
      if (!joint.has_travel()) return at.force;
      return {dot(normals[i], at.force), couple_factor(joint) * at.moment};
    };
    // An effort over its unit is its constant part and `grip` times the size.
    for (std::size_t i = 0; i < by_.size(); ++i) out.force(i) = components(i, without_[i]);
    for (std::size_t t = 0; t < teeth_.size(); ++t) {
      const std::size_t at = by_.size() + t;
      out.force(at) = {teeth_[t].without, 0.0};
      for (std::size_t i = 0; i < by_.size(); ++i) out.response(i, at) = components(i, teeth_[t].separating[i]);
    }
    for (std::size_t j = 0; j < by_.size(); ++j) {
      const Joint& joint = joint_of(out_.friction.joints[j]);
      const double constant = bound_of(joint, {}) / unit(j), grip = grip_factor(joint) / unit(j);
      for (std::size_t i = 0; i < by_.size(); ++i) {
        const Planar<double> by = components(i, by_[j][i]);
        out.force(i) += constant * by;
        out.response(i, j) = grip * by;
      }
      for (std::size_t t = 0; t < teeth_.size(); ++t) {
        out.force(by_.size() + t).x += constant * teeth_[t].by[j];
        out.response(by_.size() + t, j) = {grip * teeth_[t].by[j], 0.0};
      }
    }
    return out;
  }

  // The solution, or nothing and why.
  std::optional<VectorXd> solved() {
    if (contracts()) {
      std::optional<VectorXd> g = newton(VectorXd::Zero(static_cast<Index>(by_.size())), 1.0, 5000);
      if (!g) out_.friction.state = SlidingFriction::State::several;
      return g;
    }
    const FrictionForces::All all = sizes().all();
    if (!all.complete || all.sizes.size() > 1) {
      out_.friction.state = SlidingFriction::State::several;
      return std::nullopt;
    }
    if (all.sizes.empty()) {
      out_.friction.state = SlidingFriction::State::locked;
      followed(out_.friction.lock_at);
      return std::nullopt;
    }
    VectorXd g(static_cast<Index>(by_.size()));
    for (std::size_t i = 0; i < by_.size(); ++i) {
      const Joint& joint = joint_of(out_.friction.joints[i]);
      g[static_cast<Index>(i)] = (bound_of(joint, {}) + grip_factor(joint) * all.sizes.front()[i]) / unit(i);
    }
    // One that does not follow from less friction, on the other side of a pole, is not the only possibility: there is
    // none near it with less.
    if (!(jacobian(g, 1.0).determinant() > 0.0)) {
      out_.friction.state = SlidingFriction::State::several;
      return std::nullopt;
    }
    return newton(g, 1.0, 30);
  }

  // The bodies cut free with these efforts agree with the responses.
  bool confirmed(const VectorXd& g, const FreeBodies& found) const {
    const double most = confirmed_within * std::max(scale_, size_of(g));
    for (std::size_t i = 0; i < by_.size(); ++i) {
      const SlidingJoint& one = out_.friction.joints[i];
      const double bound = friction_bound(joint_of(one), reaction_of(found, one)) / unit(i);
      if (!(std::abs(bound - g[static_cast<Index>(i)]) <= most)) return false;
    }
    return found.imbalance <= most;
  }

  void accept(const VectorXd& g, FreeBodies found) {
    for (std::size_t i = 0; i < by_.size(); ++i) {
      SlidingJoint& one = joints()[i];
      one.effort = -sign_of(one) * g[static_cast<Index>(i)] * unit(i);
      one.bound = friction_bound(joint_of(one), reaction_of(found, one));
      out_.friction.lost_in_joints += one.lost();
    }
    out_.bodies = std::move(found);
  }

  const SlidingProblem& p_;
  std::vector<int> sides_;
  std::vector<Carried> without_;
  std::vector<std::vector<Carried>> by_;  // [j][i]: of an effort j at the joint i
  std::vector<Teeth> teeth_;
  MatrixXd lipschitz_;
  double scale_ = 1.0;
  Slid out_;
};

}  // namespace

std::optional<double> SlidingFriction::efficiency() const {
  if (state != State::solved || !(driven_without > no_power * lost())) return std::nullopt;
  return driven_without / (driven_without + lost());
}

std::optional<double> SlidingFriction::efficiency_back() const {
  if (state != State::solved || !(driven_without < -no_power * lost())) return std::nullopt;
  return std::max(0.0, 1.0 + lost() / driven_without);
}

double friction_bound(const Joint& joint, const Reaction& reaction) { return bound_of(joint, carried(reaction)); }

Slid sliding_friction(const SlidingProblem& problem) { return SlidingSolver(problem).run(); }

}  // namespace poise

#include "benchmarks/simbody_solver.hpp"

#include <chrono>
#include <stdexcept>

#include <Simbody.h>

namespace poise::benchmarks {
namespace {

using SimTK::Real;
using SimTK::State;
using SimTK::Transform;
using SimTK::Vec3;
using Plain = PlainMechanism;

Vec3 in_space(const Plain::Vector& v) { return {v.x, v.y, 0.0}; }

SimTK::Rotation turned(double angle) { return {angle, SimTK::ZAxis}; }

SimTK::Body rigid(const Plain::Body& body) {
  const Vec3 center = in_space(body.center);
  const SimTK::Inertia about_center(body.inertia, body.inertia, body.inertia);
  return SimTK::Body::Rigid(SimTK::MassProperties(body.mass, center, about_center + SimTK::Inertia(center, body.mass)));
}

// How a body hangs on the tree. A pin's q is the angle of the body less that of its parent, a slide's its travel.
struct Branch {
  int parent = -1, joint = -1;
  int q = -1;  // its place in Simbody's coordinates
  SimTK::MobilizedBodyIndex index;
};

double angle_of(int body, const std::vector<Branch>& branches, const Plain& mechanism, const SimTK::Vector& q) {
  double sum = 0.0;
  for (; body != 0; body = branches[body].parent) {
    const Plain::Joint& joint = mechanism.joints[branches[body].joint];
    sum += joint.is_slide ? joint.angle : q[branches[body].q];
  }
  return sum;
}

// Loads whose potential Simbody does not count (its constant forces have none) or does not know (springs that act one
// way).
class Loads : public SimTK::Force::Custom::Implementation {
 public:
  Loads(const Plain& mechanism, const std::vector<Branch>& branches, const SimTK::SimbodyMatterSubsystem& matter)
      : mechanism_(mechanism), branches_(branches), matter_(matter) {}

  bool dependsOnlyOnPositions() const override { return true; }
  void realizePosition(const State&) const override { ++evaluations; }

  void calcForce(const State& state, SimTK::Vector_<SimTK::SpatialVec>& forces, SimTK::Vector_<Vec3>&,
                 SimTK::Vector&) const override {
    for (const Plain::Force& f : mechanism_.forces) {
      body(f.at.body).applyForceToBodyPoint(state, in_space(f.at.at), in_space(f.force), forces);
    }
    for (const Plain::Torque& t : mechanism_.torques) {
      body(t.body).applyBodyTorque(state, Vec3(0.0, 0.0, t.torque), forces);
    }
    for (const Plain::Spring& s : mechanism_.springs) {
      if (s.pulls && s.pushes) continue;
      const Vec3 d = place(state, s.b) - place(state, s.a);
      const Vec3 pull = s.stiffness * stretch(s, d.norm()) / d.norm() * d;
      body(s.a.body).applyForceToBodyPoint(state, in_space(s.a.at), pull, forces);
      body(s.b.body).applyForceToBodyPoint(state, in_space(s.b.at), -pull, forces);
    }
  }

  Real calcPotentialEnergy(const State& state) const override {
    Real energy = 0.0;
    for (const Plain::Force& f : mechanism_.forces) energy -= SimTK::dot(in_space(f.force), place(state, f.at));
    for (const Plain::Torque& t : mechanism_.torques) {
      energy -= t.torque * angle_of(t.body, branches_, mechanism_, state.getQ());
    }
    for (const Plain::Spring& s : mechanism_.springs) {
      if (s.pulls && s.pushes) continue;
      const Real by = stretch(s, (place(state, s.b) - place(state, s.a)).norm());
      energy += 0.5 * s.stiffness * by * by;
    }
    return energy;
  }

  mutable long evaluations = 0;

 private:
  static Real stretch(const Plain::Spring& spring, Real length) {
    const Real by = length - spring.free_length;
    return (by > 0.0 ? spring.pulls : spring.pushes) ? by : 0.0;
  }
  const SimTK::MobilizedBody& body(int i) const { return matter_.getMobilizedBody(branches_[i].index); }
  Vec3 place(const State& state, const Plain::Place& p) const {
    return body(p.body).findStationLocationInGround(state, in_space(p.at));
  }

  const Plain& mechanism_;
  const std::vector<Branch>& branches_;
  const SimTK::SimbodyMatterSubsystem& matter_;
};

// min V(q) where the loops close, as LocalEnergyMinimizer has it, but with the exact Jacobian of the constraints.
class EnergyProgram : public SimTK::OptimizerSystem {
 public:
  EnergyProgram(const SimTK::MultibodySystem& system, const SimTK::SimbodyMatterSubsystem& matter, const State& state)
      : OptimizerSystem(state.getNQ()), system_(system), matter_(matter), state_(state) {
    system_.realize(state_, SimTK::Stage::Position);
    setNumEqualityConstraints(state_.getNQErr());
  }

  int objectiveFunc(const SimTK::Vector& q, bool fresh, Real& energy) const override {
    at(q, fresh, SimTK::Stage::Dynamics);
    energy = system_.calcPotentialEnergy(state_);
    return 0;
  }
  int gradientFunc(const SimTK::Vector& q, bool fresh, SimTK::Vector& gradient) const override {
    at(q, fresh, SimTK::Stage::Dynamics);
    SimTK::Vector force;
    matter_.multiplyBySystemJacobianTranspose(state_, system_.getRigidBodyForces(state_, SimTK::Stage::Dynamics),
                                              force);
    force += system_.getMobilityForces(state_, SimTK::Stage::Dynamics);
    for (int k = 0; k < force.size(); ++k) gradient[k] = -force[k];
    return 0;
  }
  int constraintFunc(const SimTK::Vector& q, bool fresh, SimTK::Vector& error) const override {
    at(q, fresh, SimTK::Stage::Position);
    error = state_.getQErr();
    return 0;
  }
  int constraintJacobian(const SimTK::Vector& q, bool fresh, SimTK::Matrix& jacobian) const override {
    at(q, fresh, SimTK::Stage::Position);
    SimTK::Matrix derivative;
    matter_.calcPq(state_, derivative);
    jacobian = derivative;
    return 0;
  }

 private:
  void at(const SimTK::Vector& q, bool fresh, SimTK::Stage stage) const {
    if (fresh) state_.updQ() = q;
    system_.realize(state_, stage);
  }

  const SimTK::MultibodySystem& system_;
  const SimTK::SimbodyMatterSubsystem& matter_;
  mutable State state_;
};

// A tree of mobilizers, Pin about z and Slider, breadth first from the ground. A pin left over holds its point in two
// planes: a Ball would hold z too, which nothing frees, and Simbody would meet constraints that depend on each other.
class SimbodySolver : public PlainSolver {
 public:
  explicit SimbodySolver(const Plain& mechanism)
      : mechanism_(mechanism),
        branches_(mechanism.bodies.size()),
        used_(mechanism.joints.size(), 0),
        matter_(system_),
        forces_(system_) {
    if (!mechanism.stops.empty()) throw std::invalid_argument("stops are not translated for Simbody");
    branches_[0].index = matter_.getGround().getMobilizedBodyIndex();
    grow_tree();
    close_loops();
    add_loads();
    start_ = system_.realizeTopology();
    system_.realizeModel(start_);
    for (std::size_t body = 1; body < branches_.size(); ++body) {
      branches_[body].q = static_cast<int>(matter_.getMobilizedBody(branches_[body].index).getFirstQIndex(start_));
    }
    program_ = std::make_unique<EnergyProgram>(system_, matter_, start_);
  }

  void start_from(const PlainPose& pose) override {
    for (std::size_t body = 1; body < branches_.size(); ++body) {
      const Branch& branch = branches_[body];
      start_.updQ()[branch.q] = mechanism_.joints[branch.joint].is_slide ? pose.travel[branch.joint]
                                                                         : pose.angle[body] - pose.angle[branch.parent];
    }
  }

  Result solve(int method, double tolerance, int times) override {
    const long before = loads_->evaluations;
    SimTK::Vector q;
    const double seconds = method == 0 ? minimize(tolerance, times, q) : optimize(tolerance, times, q);
    return {seconds, (loads_->evaluations - before) / times, true, pose(q)};
  }

 private:
  template <class Work>
  static double seconds_of(const Work& work, int times) {
    const auto begin = std::chrono::steady_clock::now();
    for (int k = 0; k < times; ++k) work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / times;
  }

  double minimize(double tolerance, int times, SimTK::Vector& q) {
    State state = start_;
    const double seconds = seconds_of(
        [&] {
          state.updQ() = start_.getQ();
          SimTK::LocalEnergyMinimizer::minimizeEnergy(system_, state, tolerance);
        },
        times);
    q = state.getQ();
    return seconds;
  }

  double optimize(double tolerance, int times, SimTK::Vector& q) {
    SimTK::Optimizer optimizer(*program_);
    optimizer.setConvergenceTolerance(tolerance);
    optimizer.setConstraintTolerance(tolerance);
    return seconds_of(
        [&] {
          q = start_.getQ();
          optimizer.optimize(q);
        },
        times);
  }

  PlainPose pose(const SimTK::Vector& q) const {
    PlainPose pose{std::vector<double>(branches_.size()), std::vector<double>(mechanism_.joints.size())};
    for (std::size_t body = 1; body < branches_.size(); ++body) {
      pose.angle[body] = angle_of(static_cast<int>(body), branches_, mechanism_, q);
      const Branch& branch = branches_[body];
      if (mechanism_.joints[branch.joint].is_slide) pose.travel[branch.joint] = q[branch.q];
    }
    return pose;
  }

  SimTK::MobilizedBody& body(int i) { return matter_.updMobilizedBody(branches_[i].index); }

  void grow_tree() {
    std::vector<int> reached = {0};
    for (std::size_t next = 0; next < reached.size(); ++next) {
      const int parent = reached[next];
      for (std::size_t j = 0; j < mechanism_.joints.size(); ++j) {
        const Plain::Joint& joint = mechanism_.joints[j];
        if (joint.a.body != parent && joint.b.body != parent) continue;
        const int child = joint.a.body == parent ? joint.b.body : joint.a.body;
        if (child == 0 || branches_[child].parent >= 0) continue;
        hang(child, parent, static_cast<int>(j));
        reached.push_back(child);
      }
    }
    if (reached.size() != branches_.size()) throw std::invalid_argument("a body that no joints tie to the ground");
  }

  void hang(int child, int parent, int j) {
    const Plain::Joint& joint = mechanism_.joints[j];
    const bool forwards = joint.a.body == parent;
    const Vec3 from = in_space(forwards ? joint.a.at : joint.b.at), to = in_space(forwards ? joint.b.at : joint.a.at);
    const SimTK::Body hung = rigid(mechanism_.bodies[child]);
    Branch& branch = branches_[child];
    if (!joint.is_slide) {
      const SimTK::MobilizedBody::Pin pin(body(parent), Transform(from), hung, Transform(to));
      branch.index = pin.getMobilizedBodyIndex();
    } else if (forwards) {
      const SimTK::MobilizedBody::Slider slider(body(parent), Transform(turned(joint.axis), from), hung,
                                                Transform(turned(joint.axis - joint.angle), to));
      branch.index = slider.getMobilizedBodyIndex();
    } else {
      throw std::invalid_argument("a slide that leads towards the ground");
    }
    branch.parent = parent;
    branch.joint = j;
    used_[j] = 1;
  }

  void close_loops() {
    for (std::size_t j = 0; j < mechanism_.joints.size(); ++j) {
      if (used_[j]) continue;
      const Plain::Joint& joint = mechanism_.joints[j];
      if (joint.is_slide) throw std::invalid_argument("a slide that closes a loop");
      const bool b_is_ground = joint.b.body == 0;  // planes at rest cost least
      const Plain::Place& plane = b_is_ground ? joint.b : joint.a;
      const Plain::Place& held = b_is_ground ? joint.a : joint.b;
      const auto hold = [&](const SimTK::UnitVec3& normal, double height) {
        SimTK::Constraint::PointInPlane(body(plane.body), normal, height, body(held.body), in_space(held.at));
      };
      hold(SimTK::UnitVec3(SimTK::XAxis), plane.at.x);
      hold(SimTK::UnitVec3(SimTK::YAxis), plane.at.y);
    }
  }

  void add_loads() {
    if (mechanism_.gravity.x != 0.0 || mechanism_.gravity.y != 0.0) {
      SimTK::Force::UniformGravity(forces_, matter_, in_space(mechanism_.gravity));
    }
    for (const Plain::Spring& s : mechanism_.springs) {
      if (!s.pulls || !s.pushes) continue;
      SimTK::Force::TwoPointLinearSpring(forces_, body(s.a.body), in_space(s.a.at), body(s.b.body), in_space(s.b.at),
                                         s.stiffness, s.free_length);
    }
    loads_ = new Loads(mechanism_, branches_, matter_);
    SimTK::Force::Custom(forces_, loads_);
  }

  const Plain mechanism_;
  std::vector<Branch> branches_;
  std::vector<char> used_;  // joints
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  Loads* loads_ = nullptr;  // Simbody's to delete
  State start_;
  std::unique_ptr<EnergyProgram> program_;
};

}  // namespace

std::unique_ptr<PlainSolver> simbody_solver(const PlainMechanism& mechanism) {
  return std::make_unique<SimbodySolver>(mechanism);
}

}  // namespace poise::benchmarks

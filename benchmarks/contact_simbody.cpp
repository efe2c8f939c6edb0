// Simbody 3.7: an integrator with error control (Runge-Kutta-Merson, which its examples use), events that it localizes,
// and impacts by handlers of them. (Its compliant contacts rebound with a part of the speed that depends on the speed.)

#include <algorithm>
#include <cmath>

#include <Simbody.h>

#include "benchmarks/contact_work.hpp"

namespace poise::benchmarks {
namespace {

using SimTK::Real;
using SimTK::State;
using SimTK::Transform;
using SimTK::Vec3;

SimTK::Body uniform(const Vec3& center, double inertia) {
  const SimTK::Inertia about_center(inertia, inertia, inertia);
  return SimTK::Body::Rigid(SimTK::MassProperties(1.0, center, about_center + SimTK::Inertia(center, 1.0)));
}

// Turns round what falls through a limit of a coordinate of a mechanism with one freedom: all its rates are in
// proportion. What has passed the limit is put where it would have rebounded to, since Simbody sees no event in a step
// from below the limit over a bounce to below the limit. Bounces that are lower than the accuracy are over.
class Rebound : public SimTK::TriggeredEventHandler {
 public:
  Rebound(const SimTK::MobilizedBody& body, double limit, double restitution, double least)
      : TriggeredEventHandler(SimTK::Stage::Position),
        body_(body),
        limit_(limit),
        restitution_(restitution),
        least_(least) {
    getTriggerInfo().setTriggerOnRisingSignTransition(false);
  }
  Real getValue(const State& state) const override { return body_.getOneQ(state, 0) - limit_; }
  void handleEvent(State& state, Real, bool&) const override {
    const Real rate = body_.getOneU(state, 0);
    if (rate >= 0.0) return;
    state.updQ() += (1 + restitution_) * (limit_ - body_.getOneQ(state, 0)) / rate * state.getU();
    state.updU() *= -restitution_;
    if (body_.getOneU(state, 0) > least_) return;
    state.updU() = 0.0;
    body_.lock(state);
  }

 private:
  SimTK::MobilizedBody body_;
  double limit_, restitution_, least_;
};

// Two planes that hold a corner of the block in its place.
struct Corner {
  SimTK::Constraint::PointInPlane x, y;
  Corner(SimTK::MobilizedBody& ground, SimTK::MobilizedBody& block, double at, double height, bool holds)
      : x(ground, SimTK::UnitVec3(SimTK::XAxis), at, block, Vec3(at, height, 0.0)),
        y(ground, SimTK::UnitVec3(SimTK::YAxis), 0.0, block, Vec3(at, height, 0.0)) {
    x.setDisabledByDefault(!holds);
    y.setDisabledByDefault(!holds);
  }
  void hold(State& state, bool holds) const {
    for (const SimTK::Constraint* plane :
         {static_cast<const SimTK::Constraint*>(&x), static_cast<const SimTK::Constraint*>(&y)}) {
      holds ? plane->enable(state) : plane->disable(state);
    }
  }
};

// Where the block stands upright the other corner holds from there on, from the impulse that stops it.
class Rocking : public SimTK::TriggeredEventHandler {
 public:
  Rocking(const SimTK::MultibodySystem& system, const SimTK::SimbodyMatterSubsystem& matter,
          const SimTK::MobilizedBody& block, const Corner& left, const Corner& right)
      : TriggeredEventHandler(SimTK::Stage::Position),
        system_(system),
        matter_(matter),
        block_(block),
        left_(left),
        right_(right) {}
  Real getValue(const State& state) const override { return block_.getOneQ(state, 0); }
  void handleEvent(State& state, Real, bool&) const override {
    const bool to_left = block_.getOneU(state, 0) > 0.0;
    left_.hold(state, to_left);
    right_.hold(state, !to_left);
    system_.realize(state, SimTK::Stage::Velocity);
    SimTK::Matrix mobility;
    SimTK::Vector rate, impulse, force, change;
    matter_.calcProjectedMInv(state, mobility);
    matter_.multiplyByG(state, state.getU(), rate);
    SimTK::FactorLU(mobility).solve(rate, impulse);
    matter_.multiplyByGTranspose(state, impulse, force);
    matter_.multiplyByMInv(state, force, change);
    state.updU() -= change;
  }

 private:
  const SimTK::MultibodySystem& system_;
  const SimTK::SimbodyMatterSubsystem& matter_;
  SimTK::MobilizedBody block_;
  Corner left_, right_;
};

class SimbodyMotion : public ContactMotion {
 public:
  SimbodyMotion(const ContactProblem& problem, double accuracy)
      : problem_(problem), accuracy_(accuracy), matter_(system_), forces_(system_) {
    SimTK::Force::UniformGravity(forces_, matter_, Vec3(0.0, -gravity, 0.0));
    if (problem.scene == ContactScene::ball) make_ball();
    if (problem.scene == ContactScene::block) make_block();
    if (problem.scene == ContactScene::toggle) make_toggle();
    start_ = system_.realizeTopology();
    system_.realizeModel(start_);
    place();
  }

  void begin() override {
    stepper_.reset();  // which refers to the integrator
    integrator_ = std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system_);
    integrator_->setAccuracy(accuracy_);
    stepper_ = std::make_unique<SimTK::TimeStepper>(system_, *integrator_);
    stepper_->initialize(start_);
  }

  std::vector<ContactState> move() override {
    std::vector<ContactState> out;
    for (double time : problem_.times) {
      stepper_->stepTo(time);
      const State& state = integrator_->getState();
      out.push_back({read_.getOneQ(state, 0), read_.getOneU(state, 0)});
    }
    return out;
  }

 private:
  // The speed of a bounce that rises by this part of a metre; lower ones are lost in the rounding of events.
  double least() const { return std::sqrt(2 * gravity * std::max(accuracy_, 1e-7)); }

  void make_ball() {
    const SimTK::Rotation up(SimTK::Pi / 2, SimTK::ZAxis);
    read_ = SimTK::MobilizedBody::Slider(matter_.Ground(), Transform(up), uniform(Vec3(0.0), 1.0), Transform(up));
    const BallSizes sizes;
    system_.addEventHandler(new Rebound(read_, 0.0, sizes.restitution, least()));  // Simbody's to delete
  }
  void make_block() {
    const BlockSizes sizes;
    const double b = sizes.half_width, h = sizes.half_height;
    read_ =
        SimTK::MobilizedBody::Planar(matter_.Ground(), Transform(), uniform(Vec3(0.0), sizes.inertia()), Transform());
    const Corner left(matter_.Ground(), read_, -b, -h, false), right(matter_.Ground(), read_, b, -h, true);
    system_.addEventHandler(new Rocking(system_, matter_, read_, left, right));
  }
  void make_toggle() {
    const ToggleSizes sizes;
    const SimTK::Body rod = uniform(Vec3(0.5, 0.0, 0.0), sizes.inertia());
    read_ = SimTK::MobilizedBody::Pin(matter_.Ground(), Transform(), rod, Transform());
    second_ = SimTK::MobilizedBody::Pin(read_, Transform(Vec3(1.0, 0.0, 0.0)), rod, Transform());
    ram_ = SimTK::MobilizedBody::Slider(matter_.Ground(), Transform(), uniform(Vec3(0.0), 1.0), Transform());
    const Vec3 end(1.0, 0.0, 0.0);
    SimTK::Constraint::PointInPlane(ram_, SimTK::UnitVec3(SimTK::XAxis), 0.0, second_, end);
    SimTK::Constraint::PointInPlane(ram_, SimTK::UnitVec3(SimTK::YAxis), 0.0, second_, end);
    system_.addEventHandler(new Rebound(read_, sizes.stop, sizes.restitution, least()));
  }

  void place() {
    if (problem_.scene == ContactScene::ball) read_.setOneQ(start_, 0, BallSizes().height);
    if (problem_.scene == ContactScene::block) {
      const BlockSizes sizes;
      read_.setOneQ(start_, 0, sizes.angle());
      read_.setOneQ(start_, 1, sizes.x());
      read_.setOneQ(start_, 2, sizes.y());
    }
    if (problem_.scene == ContactScene::toggle) {
      const double from = ToggleSizes().from;
      read_.setOneQ(start_, 0, from);
      second_.setOneQ(start_, 0, -2 * from);
      ram_.setOneQ(start_, 0, 2 * std::cos(from));
    }
  }

  ContactProblem problem_;
  double accuracy_;
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::MobilizedBody read_, second_, ram_;
  State start_;
  std::unique_ptr<SimTK::Integrator> integrator_;
  std::unique_ptr<SimTK::TimeStepper> stepper_;
};

}  // namespace

std::vector<ContactSetting> simbody_settings(const ContactProblem& problem) {
  std::vector<ContactSetting> out;
  // At 1e-8 and below events are lost in the rounding of a bounce, and the ball falls through the floor.
  for (int digit = 1; digit <= 7; ++digit) {
    const double accuracy = std::pow(10.0, -digit);
    out.push_back({"Simbody, RKM, handlers", "accuracy 1e-" + std::to_string(digit),
                   [=] { return std::make_unique<SimbodyMotion>(problem, accuracy); }});
  }
  return out;
}

}  // namespace poise::benchmarks

#include "tests/exchange/robots.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "comparison/random.hpp"
#include "model/inertia.hpp"
#include "model/scene_builder.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "statics/model/mobility.hpp"

namespace poise::test {
namespace {

using comparison::Random;

// A body while the mechanism is drawn: where it is, and the points that joints need.
struct Drawn {
  std::string name;
  double angle = 0.0;
  Vec2 origin{};
  SceneBuilder::BodyData data{};

  Vec2 local(Vec2 world) const { return (world - origin) * unit(-angle); }
  Vec2 world(Vec2 at) const { return origin + at * unit(angle); }
  std::string add(Vec2 at) {
    data.points.emplace_back(fmt::format("P{}", data.points.size()), at);
    return name + "." + data.points.back().first;
  }
};

class RobotMaker {
 public:
  RobotMaker(std::uint64_t seed, const RobotWish& wish)
      : random_(seed), wish_(wish), builder_(fmt::format("robot {}", seed)) {}

  Scene make() {
    const double tilt = random_.chance(0.5) ? 0.0 : random_.uniform(-3.0, 3.0);
    builder_.gravity(Vec2{0.0, -9.81} * unit(tilt));
    bodies_.push_back({.name = "ground"});
    const int count = 2 + random_.index(4) + 2 * wish_.loops;
    for (int k = 0; k < count; ++k) add_body(k);
    if (wish_.free_body) add_free();
    for (int k = 0; k < wish_.loops; ++k) close();
    for (const auto& [name, at] : bodies_.front().data.points) builder_.ground_point(name, at);
    for (std::size_t k = 1; k < bodies_.size(); ++k) builder_.body(bodies_[k].name, bodies_[k].data);
    add_effects();
    for (std::size_t k = 1; k < bodies_.size(); ++k) builder_.start(bodies_[k].name, bodies_[k].angle);
    return builder_.build();
  }

 private:
  struct Moving {
    std::string name;
    bool slides = false;
    MeasureByName on;
    double value = 0.0;
  };

  Vec2 vector(double size) { return {random_.uniform(-size, size), random_.uniform(-size, size)}; }

  Drawn& new_body(const std::string& name) {
    bodies_.push_back({.name = name, .angle = random_.uniform(-1.5, 1.5)});
    Drawn& body = bodies_.back();
    body.data.mass = random_.uniform(0.5, 3.0);
    body.data.inertia = random_.uniform(0.05, 0.5);
    body.data.center = vector(0.4);
    return body;
  }

  void add_body(int k) {
    const std::size_t parent =
        random_.chance(0.6) ? bodies_.size() - 1 : static_cast<std::size_t>(random_.index(bodies_.size()));
    Drawn& body = new_body(fmt::format("b{}", k));
    Drawn& other = bodies_[parent];
    const Vec2 on_parent = vector(0.8), on_body = vector(0.5);
    const std::string name = fmt::format("j{}", k);
    const double kind = random_.uniform(0.0, 1.0);
    // Joints lead from the ground or to it.
    const bool forward = random_.chance(0.6);
    const Vec2 axis = vector(1.0);
    const double travel = wish_.at_zero ? 0.0 : random_.uniform(-0.6, 0.6);
    const bool has_travel = kind > 0.6 && kind < 0.95, is_weld = kind >= 0.95;
    const bool keeps_angle = (kind > 0.6 && kind < 0.8) || is_weld;
    if (wish_.at_zero && !keeps_angle) body.angle = other.angle;
    Drawn& a = forward ? other : body;
    const Vec2 along = unit(a.angle) * direction<double>(axis);
    const Vec2 place = other.world(on_parent) + (has_travel ? (forward ? travel : -travel) * along : Vec2{});
    body.origin = place - on_body * unit(body.angle);
    const std::string of_parent = other.add(on_parent), own = body.add(on_body);
    const std::string& first = forward ? of_parent : own;
    const std::string& second = forward ? own : of_parent;
    const double turn = forward ? body.angle - other.angle : other.angle - body.angle;
    if (is_weld) {
      builder_.weld(first, second, turn, name);
    } else if (has_travel) {
      if (keeps_angle)
        builder_.slide(first, second, axis, name, turn);
      else
        builder_.pin_in_slot(first, second, axis, name);
      builder_.start(name, travel);
      moving_.push_back({name, true, measures::travel(name), travel});
    } else {
      builder_.pin(first, second, name);
      moving_.push_back({name, false, measures::angle(a.name, forward ? body.name : other.name), turn});
    }
    if (wish_.friction && !is_weld && random_.chance(0.3)) {
      builder_.friction({{has_travel ? "force" : "torque", random_.uniform(0.1, 1.0)}});
    }
    freedoms_ += is_weld ? 0 : has_travel && !keeps_angle ? 2 : 1;
  }

  void add_free() {
    Drawn& body = new_body("free");
    body.origin = vector(1.0);
    builder_.start_position(body.name, body.origin);
    free_point_ = body.add(vector(0.5));
  }

  // A pin at a place of two bodies, or a bar, closes it; a pin takes two freedoms.
  void close() {
    const std::size_t count = bodies_.size() - (wish_.free_body ? 1 : 0);
    Drawn& last = bodies_[count - 1];
    Drawn& other = bodies_[static_cast<std::size_t>(random_.index(count - 1))];
    const Vec2 at = last.world(vector(0.8));
    const std::string name = fmt::format("c{}", closures_++);
    if (freedoms_ >= 3 && random_.chance(0.7)) {
      builder_.pin(other.add(other.local(at)), last.add(last.local(at)), name);
      freedoms_ -= 2;
    } else if (freedoms_ >= 2) {
      const Vec2 from = vector(1.0);
      builder_.bar(other.add(other.local(from)), last.add(last.local(at)), norm(at - from), name);
      freedoms_ -= 1;
    }
  }

  void add_effects() {
    for (const Moving& joint : moving_) {
      const std::string free = joint.slides ? "free_length" : "free_angle";
      if (random_.chance(0.4)) {
        builder_.element("spring", joint.name, joint.on,
                         {{"stiffness", random_.uniform(5.0, 50.0)}, {free, joint.value + random_.uniform(-0.3, 0.3)}});
      }
      if (random_.chance(0.3)) {
        builder_.element("spring", joint.name + " second", joint.on,
                         {{"stiffness", random_.uniform(5.0, 50.0)},
                          {"preload", random_.uniform(-1.0, 1.0)},
                          {joint.slides ? "length" : "angle", joint.value}});
      }
      if (random_.chance(0.4)) {
        builder_.element("damper", joint.name, joint.on, {{"coefficient", random_.uniform(0.1, 2.0)}});
      }
      if (random_.chance(0.3)) {
        builder_.stop(joint.name, joint.on,
                      {{"min", joint.value - 1.0}, {"max", joint.value + random_.uniform(0.5, 2.0)}});
      }
    }
    if (moving_.size() > 2 && freedoms_ > 1 && random_.chance(0.5)) couple();
    if (!wish_.lines) return;
    const std::size_t a = bodies_.size() - 1, b = a > 1 ? a - 1 : 0;
    builder_.element("spring", "between", measures::distance(bodies_[b].name + ".P0", bodies_[a].name + ".P0"),
                     {{"stiffness", random_.uniform(5.0, 50.0)}, {"free_length", random_.uniform(0.1, 1.0)}});
    if (!free_point_.empty()) {
      builder_.element("spring", "tether", measures::distance("ground.P0", free_point_),
                       {{"stiffness", 20.0}, {"free_length", 0.2}});
    }
    builder_.element("damper", "across", measures::angle("ground", bodies_[a].name), {{"coefficient", 0.3}});
    builder_.element("spring", "wound", measures::angle("ground", bodies_[a].name), {{"stiffness", 4.0}});
    if (moving_.size() > 1 && moving_[0].slides == moving_[1].slides) {
      builder_.element("spring", "sum", measures::sum({{1.5, moving_[0].on}, {-0.5, moving_[1].on}}),
                       {{"stiffness", 7.0}, {moving_[0].slides ? "free_length" : "free_angle", 0.2}});
    }
  }

  void couple() {
    const double factor = random_.uniform(0.4, 2.0);
    const Moving& one = moving_[moving_.size() - 1];
    const Moving& two = moving_[0];
    builder_.coupling(measures::sum({{1.0, one.on}, {-factor, two.on}}), {{"value", one.value - factor * two.value}},
                      "geared");
  }

  Random random_;
  RobotWish wish_;
  SceneBuilder builder_;
  std::vector<Drawn> bodies_;
  std::vector<Moving> moving_;
  std::string free_point_;
  int freedoms_ = 0, closures_ = 0;
};

}  // namespace

Scene random_robot(std::uint64_t seed, const RobotWish& wish) { return RobotMaker(seed, wish).make(); }

std::vector<BodyPose<double>> poses_at_start(const Scene& scene) {
  const MotionModel model(scene);
  return model.poses(close_loops(model));
}

std::vector<BodyMotion> released(const Scene& scene) {
  const MotionModel model(scene);
  const std::vector<double> x = close_loops(model);
  ReducedMotion<double> motion(model.scaled_scene(), model.mechanism(), model.inertia());
  if (motion.begin(0.0, x.data()) != ReducedMotion<double>::Status::ok) throw std::runtime_error("no coordinates");
  std::vector<double> z, w(static_cast<std::size_t>(motion.freedoms()), 0.0);
  for (const int i : motion.independent()) z.push_back(x[static_cast<std::size_t>(i)]);
  if (motion.evaluate(0.0, z.data(), w.data()) != ReducedMotion<double>::Status::ok) {
    throw std::runtime_error("no accelerations");
  }
  const auto all = [&](const double* values) { return std::vector<double>(values, values + x.size()); };
  return body_motions(model, all(motion.q()), all(motion.v()), all(motion.a()));
}

}  // namespace poise::test

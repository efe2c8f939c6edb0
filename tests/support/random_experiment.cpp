#include "tests/support/random_experiment.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "model/parameters.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::test {
namespace {

/// A mechanism that grows body by body around a pose.
class Growth {
 public:
  explicit Growth(Random& random) : random_(random) { scene_.bodies[0].points.push_back({"O", {0, 0}}); }

  /// A link on the point `from` of the world, pinned there, with its end where it says.
  int link(PointRef from, Vec2 from_at, Vec2 to) {
    const int body = scene_.add_body(fmt::format("link{}", scene_.bodies.size()));
    const Vec2 along = to - from_at;
    const double angle = std::atan2(along.y, along.x);
    scene_.add_point(body, "a", {0, 0});
    scene_.add_point(body, "b", {norm(along), 0});
    const Vec2 p = local();
    scene_.add_point(body, "p", p);
    scene_.start.angle[static_cast<std::size_t>(body)] = angle;
    Joint pin;
    pin.name = fmt::format("pin{}", body);
    pin.a = from;
    pin.b = {body, 0};
    scene_.add_joint(pin);
    at_.resize(scene_.bodies.size());
    at_[static_cast<std::size_t>(body)] = from_at + p * unit(angle);
    return body;
  }

  /// A block that slides on a body which stands at `angle` there, through a point of it.
  int block(PointRef on, Vec2 on_at, double angle_of_body, double travel) {
    const int body = scene_.add_body(fmt::format("block{}", scene_.bodies.size()));
    scene_.add_point(body, "a", {0, 0});
    const Vec2 p = local();
    scene_.add_point(body, "b", p);
    scene_.add_point(body, "p", local());
    Joint slide;
    slide.kind = Joint::Kind::slide;
    slide.name = fmt::format("slide{}", body);
    slide.a = on;
    slide.b = {body, 0};
    slide.axis = unit(random_.uniform(-3.0, 3.0));
    slide.angle = random_.uniform(-1.0, 1.0);
    const int joint = scene_.add_joint(slide);
    const double angle = angle_of_body + slide.angle;
    scene_.start.travel[static_cast<std::size_t>(joint)] = travel;
    scene_.start.angle[static_cast<std::size_t>(body)] = angle;
    at_.resize(scene_.bodies.size());
    block_at_ = on_at + travel * (slide.axis * unit(angle_of_body));
    at_[static_cast<std::size_t>(body)] = block_at_ + p * unit(angle);
    return body;
  }

  Vec2 place() { return {random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0)}; }
  Vec2 local() { return {random_.uniform(0.1, 0.6), random_.uniform(-0.4, 0.4)}; }
  Vec2 step(double least, double more) {
    const Vec2 direction = unit(random_.uniform(-3.0, 3.0));
    return (least + random_.uniform(0.0, more)) * direction;
  }
  PointRef ground(Vec2 at) {
    scene_.bodies[0].points.push_back({fmt::format("G{}", scene_.bodies[0].points.size()), at});
    return {0, static_cast<int>(scene_.bodies[0].points.size()) - 1};
  }
  /// A second pin or slide that closes a loop.
  void pin(PointRef a, PointRef b) {
    Joint joint;
    joint.name = fmt::format("closing{}", scene_.joints.size());
    joint.a = a;
    joint.b = b;
    scene_.add_joint(joint);
  }

  /// From a point of the mechanism over two links, or a link and a block, to the ground.
  int dyad(PointRef from, Vec2 from_at) {
    const Vec2 knee = from_at + step(0.5, 0.6);
    const int coupler = link(from, from_at, knee);
    const Vec2 foot = knee + step(0.5, 0.6);
    if (random_.chance(0.3)) {
      const int slider = block(ground(foot), foot, 0.0, random_.uniform(-0.3, 0.3));
      // The ground is moved so that the block's origin is the knee.
      scene_.bodies[0].points.back().at = scene_.bodies[0].points.back().at + (knee - block_at_);
      pin({coupler, 1}, {slider, 0});
    } else {
      const int rocker = link(ground(foot), foot, knee);
      pin({coupler, 1}, {rocker, 1});
    }
    return coupler;
  }

  Scene chain() {
    Vec2 end{0, 0};
    PointRef on{0, 0};
    double angle = 0.0;
    const int links = 1 + random_.index(3);
    for (int i = 0; i < links; ++i) {
      int body = 0;
      if (random_.chance(0.3)) {
        body = block(on, end, angle, random_.uniform(-0.5, 0.5));
        end = at_[static_cast<std::size_t>(body)];
      } else {
        const Vec2 next = end + step(0.3, 0.7);
        body = link(on, end, next);
        end = next;
      }
      angle = scene_.start.angle[static_cast<std::size_t>(body)].value_or(0.0);
      on = {body, 1};
    }
    return scene_;
  }

  Scene loops(int dyads) {
    const Vec2 end = step(0.3, 0.4);
    const int crank = link({0, 0}, {0, 0}, end);
    int coupler = dyad({crank, 1}, end);
    for (int i = 1; i < dyads; ++i) coupler = dyad({coupler, 2}, at_[static_cast<std::size_t>(coupler)]);
    return scene_;
  }

 private:
  Random& random_;
  Scene scene_;
  std::vector<Vec2> at_;  // of every body's point p, or b of a block
  Vec2 block_at_{};
};

Scene random_motion_scene(Random& random, std::uint64_t seed) {
  Scene scene;
  const int kind = random.index(5);
  if (kind == 4) {
    for (std::uint64_t next = 0;; ++next) {
      PlantedMechanism planted = plant_mechanism(1000 * seed + next, {.loops = random.index(3)});
      if (planted.redundant > 0 || planted.hangs_on_bars) continue;
      scene = std::move(planted.scene);
      break;
    }
    for (Element& element : scene.elements) {
      if (auto* spring = std::get_if<LinearSpring>(&element.law)) spring->acts = LinearSpring::Acts::both;
    }
  } else {
    Growth growth(random);
    scene = kind < 2 ? growth.chain() : growth.loops(kind - 1);
    if (random.chance(0.8)) scene.gravity = {random.chance(0.3) ? random.uniform(-3.0, 3.0) : 0.0, -9.81};
  }
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    Body& body = scene.bodies[b];
    body.mass = random.uniform(0.5, 3.0);
    body.center = {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)};
    if (random.chance(0.2)) body.center = {};
    body.inertia = random.uniform(0.02, 0.3);
  }
  const auto any_body = [&] { return random.index(scene.bodies.size()); };
  const auto any_point = [&](int body) {
    if (scene.bodies[static_cast<std::size_t>(body)].points.empty()) scene.add_point(body, "o", {0, 0});
    return PointRef{body, random.index(scene.bodies[static_cast<std::size_t>(body)].points.size())};
  };
  const int elements = 1 + random.index(4);
  for (int i = 0; i < elements; ++i) {
    const int a = any_body();
    const int b = 1 + random.index(scene.bodies.size() - 1);
    if (a == b) continue;
    const std::string name = fmt::format("element{}", i);
    switch (random.index(5)) {
      case 0: {
        const double free_length = random.uniform(0.1, 0.6), stiffness = random.uniform(20, 200);
        const PointRef end = any_point(b);
        scene.elements.push_back(line_spring(name, any_point(a), end, stiffness, free_length));
        break;
      }
      case 1: {
        const double free_angle = random.uniform(-1, 1);
        scene.elements.push_back(torsion_spring(name, a, b, random.uniform(2, 20), free_angle));
        break;
      }
      case 2: {
        const double coefficient = random.uniform(0.5, 3);
        const PointRef end = any_point(b);
        scene.elements.push_back(line_damper(name, any_point(a), end, coefficient));
        break;
      }
      case 3:
        scene.elements.push_back(torsion_damper(name, a, b, random.uniform(0.1, 1)));
        break;
      default:
        scene.elements.push_back(friction(name, a, b, random.uniform(0.1, 1), 0.7));
    }
  }
  if (random.chance(0.3)) {
    const int body = 1 + random.index(scene.bodies.size() - 1);
    const PointRef at = any_point(body);
    scene.forces.push_back({});
    scene.forces.back().name = "push";
    scene.forces.back().at = at;
    scene.forces.back().vector = {0, random.uniform(-5, 5)};
  }
  // The direction of a force is a rounded number unless it is along an axis.
  for (Force& force : scene.forces) force.vector = {norm(force.vector), 0};
  return scene;
}

}  // namespace

Experiment random_experiment(std::uint64_t seed) {
  Random random(seed);
  Experiment out;
  out.scene = random_motion_scene(random, seed);
  const Scene& scene = out.scene;
  std::vector<ParameterRow> rows;
  for (const ParameterRow& row : parameter_table(scene)) {
    const Owner owner = row.place.owner;
    const bool acts = (owner == Owner::body && row.place.item > 0) || owner == Owner::element ||
                      owner == Owner::force || owner == Owner::torque;
    if (acts && value_at(scene, row.place)) rows.push_back(row);
  }
  const double share = random.uniform(0.15, 1.0);
  std::vector<std::string> known;
  for (const ParameterRow& row : rows) {
    if (!random.chance(share)) {
      known.push_back(row.path.text());
      continue;
    }
    Unknown unknown;
    unknown.path = unknown.name = row.path.text();
    out.unknowns.push_back(unknown);
  }
  if (out.unknowns.empty()) {
    Unknown unknown;
    unknown.path = unknown.name = rows.front().path.text();
    out.unknowns.push_back(unknown);
  }
  if (random.chance(0.15)) {
    Unknown& weighed = out.unknowns[static_cast<std::size_t>(random.index(out.unknowns.size()))];
    weighed.prior = get_value(scene, weighed.path);
    weighed.prior_deviation = 0.1;
  }
  Sensor sensor;
  sensor.name = sensor.column = "reading";
  sensor.noise = 1e-4;
  sensor.on = Measure::angle_between(0, 1 + random.index(scene.bodies.size() - 1));
  for (std::size_t i = 0; i < scene.elements.size() && random.chance(0.4); ++i) {
    const auto* spring = std::get_if<LinearSpring>(&scene.elements[i].law);
    if (spring == nullptr || scene.elements[i].on.is_angle()) continue;
    sensor.on = scene.elements[i].on;
    sensor.element = static_cast<int>(i);
  }
  out.sensors = {sensor};
  Run run;
  run.name = "run";
  run.sample_rate = 100;
  run.duration = 0.1;
  out.runs = {run};
  if (random.chance(0.3) && !known.empty()) {
    run.name = "changed";
    const std::string& path = known[static_cast<std::size_t>(random.index(known.size()))];
    run.changes.push_back({path, 1.3 * get_value(scene, path) + (get_value(scene, path) == 0 ? 0.1 : 0.0), 0});
    out.runs.push_back(run);
  }
  return out;
}

}  // namespace poise::test

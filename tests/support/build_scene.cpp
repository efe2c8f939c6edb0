#include "tests/support/build_scene.hpp"

#include <cmath>
#include <stdexcept>

#include "tests/support/elements.hpp"

namespace poise::test {
namespace {

Joint joint_between(const Scene& scene, Joint::Kind kind, const std::string& a, const std::string& b,
                    const std::string& name) {
  Joint joint;
  joint.kind = kind;
  joint.name = name;
  joint.a = point(scene, a);
  joint.b = point(scene, b);
  return joint;
}

// Half the angle that an arc of `length` over `span` subtends:  span / length = sin(h) / h.
double half_angle_of_arc(double span, double length) {
  double low = 0.0;
  double high = M_PI;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (std::sin(middle) / middle > span / length ? low : high) = middle;
  }
  return low;
}

}  // namespace

PointRef point(const Scene& scene, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  // Chains refer to the bodies added last: search from the end.
  for (std::size_t i = scene.bodies.size(); i-- > 0;) {
    const Body& body = scene.bodies[i];
    if (body.name.size() != dot || name.compare(0, dot, body.name) != 0) continue;
    for (std::size_t p = 0; p < body.points.size(); ++p) {
      if (name.compare(dot + 1, std::string::npos, body.points[p].name) == 0) {
        return {static_cast<int>(i), static_cast<int>(p)};
      }
    }
  }
  throw std::out_of_range("the scene has no point \"" + name + "\"");
}

int add_link(Scene& scene, const std::string& name, double length, double mass) {
  const int body = scene.add_body(name);
  scene.add_point(body, "a", {0.0, 0.0});
  scene.add_point(body, "m", {0.5 * length, 0.0});
  scene.add_point(body, "b", {length, 0.0});
  scene.bodies[body].mass = mass;
  scene.bodies[body].center = {0.5 * length, 0.0};
  return body;
}

void add_link(SceneBuilder& builder, const std::string& name, double length, double mass) {
  builder.body(name, {.points = {{"a", {0.0, 0.0}}, {"m", {0.5 * length, 0.0}}, {"b", {length, 0.0}}},
                      .mass = mass,
                      .center = {0.5 * length, 0.0}});
}

int add_pin(Scene& scene, const std::string& a, const std::string& b, const std::string& name) {
  return scene.add_joint(joint_between(scene, Joint::Kind::pin, a, b, name));
}

int add_slide(Scene& scene, const std::string& a, const std::string& b, Vec2 axis, const std::string& name) {
  Joint joint = joint_between(scene, Joint::Kind::slide, a, b, name);
  joint.axis = axis;
  return scene.add_joint(joint);
}

int add_pin_in_slot(Scene& scene, const std::string& a, const std::string& b, Vec2 axis, const std::string& name) {
  Joint joint = joint_between(scene, Joint::Kind::pin_in_slot, a, b, name);
  joint.axis = axis;
  return scene.add_joint(joint);
}

int add_bar(Scene& scene, const std::string& a, const std::string& b, double length, const std::string& name) {
  Joint joint = joint_between(scene, Joint::Kind::bar, a, b, name);
  joint.length = length;
  return scene.add_joint(joint);
}

void add_force(Scene& scene, const std::string& at, Vec2 vector, const std::string& name) {
  Force force;
  force.name = name;
  force.at = point(scene, at);
  force.vector = vector;
  scene.forces.push_back(force);
}

void add_stop(Scene& scene, const std::string& name, const Measure& on, double min, double max) {
  Stop stop;
  stop.name = name;
  stop.on = on;
  stop.min = min;
  stop.max = max;
  scene.stops.push_back(stop);
}

void add_stop(Scene& scene, const std::string& name, int a, int b, double min, double max) {
  add_stop(scene, name, Measure::angle_between(a, b), min, max);
}

void add_torsion_spring(Scene& scene, int a, int b, double stiffness, double free_angle) {
  const std::string name = "torsion spring " + std::to_string(count_of(scene, "torsion_spring") + 1);
  scene.elements.push_back(torsion_spring(name, a, b, stiffness, free_angle));
}

namespace {

SceneBuilder chain_builder(int count, double length, double mass) {
  SceneBuilder builder("chain");
  builder.ground_point("O", {0.0, 0.0});
  std::string end = "ground.O";
  for (int i = 1; i <= count; ++i) {
    const std::string link = std::to_string(i);
    add_link(builder, link, length, mass);
    builder.pin(end, link + ".a", "joint" + link);
    end = link + ".b";
  }
  return builder;
}

}  // namespace

Scene chain(int count, double length, double mass) { return chain_builder(count, length, mass).build(); }

Scene hanging_chain(int count, double total_length, double total_weight, double span) {
  SceneBuilder builder = chain_builder(count, total_length / count, total_weight / count);
  builder.gravity({0.0, -1.0}).ground_point("E", {span, 0.0});
  builder.pin(std::to_string(count) + ".b", "ground.E", "end");
  const double half = half_angle_of_arc(span, total_length);
  for (int i = 1; i <= count; ++i) builder.start(std::to_string(i), half * (2.0 * i - 1.0 - count) / count);
  return builder.build();
}

Scene scissor(int stages, double arm_weight, double load, double theta) {
  SceneBuilder builder("scissor");
  builder.gravity({0.0, -1.0}).ground_point("O", {0.0, 0.0});
  std::string left = "ground.O";
  std::string right;
  for (int s = 1; s <= stages; ++s) {
    const std::string rise = "rise" + std::to_string(s);
    const std::string fall = "fall" + std::to_string(s);
    add_link(builder, rise, 1.0, arm_weight);
    add_link(builder, fall, 1.0, arm_weight);
    builder.start(rise, theta).start(fall, M_PI - theta);
    builder.pin(left, rise + ".a");
    if (s == 1)
      builder.pin_in_slot("ground.O", fall + ".a", {1.0, 0.0}, "base");
    else
      builder.pin(right, fall + ".a");
    builder.pin(rise + ".m", fall + ".m");
    // Arms cross: what rises from the left ends on the right.
    left = fall + ".b";
    right = rise + ".b";
  }
  builder.body("platform", {.points = {{"left", {0.0, 0.0}}, {"middle", {0.5 * std::cos(theta), 0.0}}}})
      .pin(left, "platform.left")
      .pin_in_slot("platform.left", right, {1.0, 0.0}, "top")
      .force("W", "platform.middle", {0.0, -load})
      .start("base", std::cos(theta))
      .start("top", std::cos(theta));
  return builder.build();
}

Scene lever() {
  return parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.lever]
points = { O = [0, 0], load = [-0.25, 0], foot = [0.5, 0] }
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[force]]
name = "P"
at = "lever.load"
vector = [0, 40]
[[stop]]
name = "foot"
y = "lever.foot"
min = 0
)",
                     "lever.toml");
}

Scene windows(int count) {
  SceneBuilder builder("windows");
  builder.gravity({0.0, -1.0});
  for (int i = 0; i <= count; ++i) {
    const std::string number = std::to_string(i);
    builder.ground_point("O" + number, {static_cast<double>(i), 0.0});
    add_link(builder, "post" + number, 1.0, 1.0);
    builder.pin("ground.O" + number, "post" + number + ".a");
  }
  for (int i = 1; i <= count; ++i) {
    const std::string beam = "beam" + std::to_string(i);
    add_link(builder, beam, 1.0, 1.0);
    builder.pin("post" + std::to_string(i - 1) + ".b", beam + ".a");
    builder.pin(beam + ".b", "post" + std::to_string(i) + ".b");
  }
  return builder.build();
}

Scene parallelogram(int cranks, double angle, double load) {
  Scene scene;
  for (int i = 0; i < cranks; ++i) {
    const std::string number = std::to_string(i);
    scene.add_point(0, "A" + number, {static_cast<double>(i), 0.0});
    scene.start.angle[add_link(scene, number, 1.0)] = angle;
    add_pin(scene, "ground.A" + number, number + ".a", "A" + number);
  }
  const int coupler = scene.add_body("coupler");
  scene.start.angle[coupler] = 0.0;
  for (int i = 0; i < cranks; ++i) {
    const std::string number = std::to_string(i);
    scene.add_point(coupler, "B" + number, {static_cast<double>(i), 0.0});
    add_pin(scene, number + ".b", "coupler.B" + number, "B" + number);
  }
  add_force(scene, "coupler.B1", {0.0, -load}, "W");
  Torque torque;
  torque.name = "T";
  torque.body = 1;
  torque.value = load * std::cos(angle);
  scene.torques.push_back(torque);
  return scene;
}

}  // namespace poise::test

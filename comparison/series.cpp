#include "comparison/series.hpp"

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "solvers/root.hpp"

namespace poise::comparison {
namespace {

// A uniform bar from point a, its origin, to point b.
struct Bar {
  PointRef a, b;
};

Bar add_bar(Scene& scene, const std::string& name, double length, double mass, double angle) {
  const int body = scene.add_body(name);
  scene.bodies[body].mass = mass;
  scene.bodies[body].center = {0.5 * length, 0.0};
  scene.bodies[body].inertia = mass * length * length / 12.0;
  scene.start.angle[body] = angle;
  return {scene.add_point(body, "a", {0.0, 0.0}), scene.add_point(body, "b", {length, 0.0})};
}

void pin(Scene& scene, PointRef a, PointRef b) {
  scene.add_joint({.kind = Joint::Kind::pin, .name = {}, .a = a, .b = b});
}

}  // namespace

std::vector<double> arc_start(int links) {
  // The span decreases as the arc closes, from 1 at phi = 0 to 0 at a full circle.
  solvers::Bracket turn{0.0, 2.0 * M_PI / links};
  solvers::bisect(turn,
                  [&](double phi) { return std::sin(0.5 * links * phi) / (links * std::sin(0.5 * phi)) > chain_span; });
  std::vector<double> angles(links);
  for (int i = 0; i < links; ++i) angles[i] = (i - 0.5 * (links - 1)) * turn.from;
  return angles;
}

Scene hanging_chain_scene(int links) {
  Scene scene;
  scene.file = "hanging chain";
  scene.gravity = {0.0, -10.0};
  PointRef end = scene.add_point(0, "L", {0.0, 0.0});
  const PointRef last = scene.add_point(0, "R", {chain_span, 0.0});
  const std::vector<double> angles = arc_start(links);
  for (int i = 0; i < links; ++i) {
    const Bar bar = add_bar(scene, "bar" + std::to_string(i + 1), 1.0 / links, 0.1 / links, angles[i]);
    pin(scene, end, bar.a);
    end = bar.b;
  }
  pin(scene, end, last);
  return scene;
}

Scene window_ladder_scene(int windows) {
  constexpr double half_opening = 0.5, tilt = 0.1, straight_down = -M_PI / 2;  // rad
  Scene scene;
  scene.file = "window ladder";
  scene.gravity = {0.0, -9.81};
  PointRef top = scene.add_point(0, "O", {0.0, 0.0});
  for (int k = 0; k < windows; ++k) {
    const std::string number = std::to_string(k + 1);
    const double down = straight_down + (k % 2 == 0 ? tilt : -tilt);
    const Bar left = add_bar(scene, "left" + number, 1.0, 1.0, down - half_opening);
    const Bar right = add_bar(scene, "right" + number, 1.0, 1.0, down + half_opening);
    const Bar under_left = add_bar(scene, "under_left" + number, 1.0, 1.0, down + half_opening);
    const Bar under_right = add_bar(scene, "under_right" + number, 1.0, 1.0, down - half_opening);
    pin(scene, top, left.a);
    pin(scene, top, right.a);
    pin(scene, left.b, under_left.a);
    pin(scene, right.b, under_right.a);
    pin(scene, under_left.b, under_right.b);
    scene.elements.push_back({.table = "spring",
                              .name = "spring" + number,
                              .on = Measure::distance_between(left.b, right.b),
                              .law = LinearSpring{.stiffness = 50.0 * windows, .free_length = 1.2}});
    top = under_left.b;
  }
  return scene;
}

Scene balanced_arms_scene(int arms) {
  Scene scene;
  scene.file = "balanced arms";
  scene.gravity = {0.0, -10.0};
  for (int i = 0; i < arms; ++i) {
    const std::string number = std::to_string(i + 1);
    const PointRef pivot = scene.add_point(0, "O" + number, {1.0 * i, 0.0});
    const PointRef hook = scene.add_point(0, "hook" + number, {1.0 * i, 0.5});
    const Bar arm = add_bar(scene, "arm" + number, 1.0, 1.0, 0.5);
    const PointRef eye = scene.add_point(arm.a.body, "eye", {0.25, 0.0});
    pin(scene, pivot, arm.a);
    scene.elements.push_back({.table = "spring",
                              .name = "spring" + number,
                              .on = Measure::distance_between(hook, eye),
                              .law = LinearSpring{.stiffness = 40.0, .free_length = 0.0}});
  }
  const PointRef pivot = scene.add_point(0, "O", {-1.0, 0.0});
  pin(scene, pivot, add_bar(scene, "pendulum", 1.0, 1.0, -1.0).a);
  return scene;
}

Scene truss_beside_pendulums_scene(int pendulums) {
  Scene scene;
  scene.file = "truss beside pendulums";
  scene.gravity = {0.0, -10.0};
  const PointRef hinge = scene.add_point(0, "hinge", {-1.0, 0.0});
  const PointRef rail = scene.add_point(0, "rail", {0.0, 0.0});
  const PointRef load = scene.add_point(scene.add_body("block"), "P", {0.0, 0.0});
  const int slide =
      scene.add_joint({.kind = Joint::Kind::slide, .name = "rail", .a = rail, .b = load, .axis = {0.0, 1.0}});
  scene.start.travel[static_cast<std::size_t>(slide)] = 0.40049620273255365;
  scene.elements.push_back({.table = "spring",
                            .name = "bar",
                            .on = Measure::distance_between(hinge, load),
                            .law = LinearSpring{.stiffness = 1000.0, .free_length = 1.25}});
  scene.forces.push_back({.name = "P", .at = load, .vector = {0.0, -64.23847289438795}});
  for (int i = 0; i < pendulums; ++i) {
    const std::string number = std::to_string(i + 1);
    const PointRef pivot = scene.add_point(0, "O" + number, {2.0 * (i + 1), 0.0});
    pin(scene, pivot, add_bar(scene, "pendulum" + number, 1.0, 1.0, -1.5).a);
  }
  return scene;
}

const std::vector<std::string>& series_names() {
  static const std::vector<std::string> names = {"hanging chain", "window ladder", "balanced arms",
                                                 "truss beside pendulums"};
  return names;
}

Scene series_scene(const std::string& name, int size) {
  if (name == series_names()[0]) return hanging_chain_scene(size);
  if (name == series_names()[1]) return window_ladder_scene(size);
  if (name == series_names()[2]) return balanced_arms_scene(size);
  if (name == series_names()[3]) return truss_beside_pendulums_scene(size);
  throw InputError(fmt::format("series: expected {}, found \"{}\"", fmt::join(series_names(), " or "), name));
}

}  // namespace poise::comparison

// A spring-loaded press: its equilibrium, and the path of its ram.

#include <cstdio>

#include <poise/poise.hpp>

using poise::measures::angle;

int main() try {
  poise::SceneBuilder builder("press", {.length = "mm", .angle = "deg"});
  builder.gravity({0, -9810})
      .ground_point("O", {0, 0})
      .body("crank", {.points = {{"O", {0, 0}}, {"B", {120, 0}}}, .mass = 0.4, .center = {60, 0}, .inertia = 480})
      .body("rod", {.points = {{"B", {0, 0}}, {"C", {250, 0}}}, .mass = 0.6, .center = {125, 0}, .inertia = 3125})
      .body("ram", {.points = {{"C", {0, 0}}}, .mass = 2.5})
      .pin("ground.O", "crank.O", "O")
      .pin("crank.B", "rod.B", "B")
      .pin("rod.C", "ram.C", "C")
      .slide("ground.O", "ram.C", {1, 0}, "guide")
      .element("torsion_spring", "return", angle("ground", "crank"), {{"stiffness", 50}, {"free_angle", 90}})
      .force("P", "ram.C", {-40, 0})
      .start("crank", 40)
      .start("rod", -20)
      .start("guide", 330);
  const poise::Scene scene = builder.build();

  const poise::NamedEquilibrium found = solve(scene).in_scene_units();
  std::printf("%s, %s\n", to_string(found.result().status).c_str(),
              to_string(found.result().certificate.stability).c_str());
  std::printf("crank at %.3f deg, ram at %.3f mm\n", found.angle("crank"), found.point("ram.C").x);
  const poise::Vec2 pin = found.reaction("B").force;
  std::printf("spring torque %.1f N mm, pin B carries [%.3f, %.3f] N\n", found.force("return"), pin.x, pin.y);

  constexpr double degree = 3.14159265358979 / 180;
  const poise::KinematicsResult path = poise::sweep(scene, {{"crank", 30 * degree, 90 * degree}}, {.steps = 3});
  for (const poise::KinematicSample& sample : path.samples) {
    const poise::NamedPose at = poise::NamedPose(scene, poses_of(sample.bodies)).in_scene_units();
    std::printf("crank %.0f deg, ram %.3f mm\n", at.angle("crank"), at.travel("guide"));
  }
  return found.found() ? 0 : 1;
} catch (const poise::InputError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}

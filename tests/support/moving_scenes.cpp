#include "tests/support/moving_scenes.hpp"

#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/every_measure.hpp"

namespace poise::test {

Scene four_bar_with_everything() {
  return parse_scene(R"(
title = "four-bar"
gravity = [0.3, -9.81]
[ground]
points = { A = [0, 0], D = [1.1, 0.2], S = [0.4, 1.5] }
[body.crank]
points = { A = [0, 0], B = [0.4, 0] }
mass = 1.2
center = [0.2, 0.03]
inertia = 0.02
[body.coupler]
points = { B = [0, 0], C = [1.0, 0], P = [0.5, 0.4] }
mass = 2
center = [0.45, 0.1]
inertia = 0.2
[body.rocker]
points = { D = [0, 0], C = [0.8, 0] }
mass = 1.5
center = [0.4, -0.05]
inertia = 0.1
[[pin]]
points = ["ground.A", "crank.A"]
[[pin]]
points = ["crank.B", "coupler.B"]
[[pin]]
points = ["ground.D", "rocker.D"]
[[pin]]
points = ["coupler.C", "rocker.C"]
[[spring]]
points = ["ground.S", "coupler.P"]
stiffness = 60
free_length = 0.5
[[damper]]
points = ["ground.A", "coupler.P"]
coefficient = 3
[[torsion_spring]]
bodies = ["crank", "coupler"]
stiffness = 4
free_angle = -0.7
[[torsion_damper]]
bodies = ["ground", "crank"]
coefficient = 0.2
[[friction]]
bodies = ["coupler", "rocker"]
torque = 0.8
width = 0.7
[[force]]
name = "F"
at = "coupler.P"
vector = [3, -2]
[[torque]]
name = "T"
on = "rocker"
value = 1.1
[start]
crank = 1.0
coupler = 0.3
rocker = 1.8
)",
                     "four_bar_with_everything");
}

Scene four_bar_with_follower() {
  Scene scene = four_bar_with_everything();
  add_force(scene, "coupler.P", {2, 5}, "pusher");
  scene.forces.back().follows = 3;
  return scene;
}

Scene quick_return() {
  return parse_scene(R"(
title = "quick return"
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], A = [0.1, -0.6], E = [0.8, 0.3] }
[body.crank]
points = { O = [0, 0], B = [0.25, 0] }
mass = 0.9
center = [0.1, 0.02]
inertia = 0.01
[body.rocker]
points = { A = [0, 0], S = [0.2, 0.05] }
mass = 2
center = [0.5, 0.02]
inertia = 0.15
[body.block]
points = { c = [0, 0] }
mass = 0.4
center = [0.03, -0.04]
inertia = 0.002
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["ground.A", "rocker.A"]
[[pin_in_slot]]
name = "slot"
points = ["rocker.A", "crank.B"]
axis = [1, 0.1]
[[slide]]
name = "rail"
points = ["rocker.S", "block.c"]
axis = [0.6, 0.8]
angle = 0.3
[[spring]]
points = ["rocker.A", "block.c"]
stiffness = 300
free_length = 0.25
[[damper]]
points = ["ground.E", "block.c"]
coefficient = 1.5
[[torsion_damper]]
bodies = ["crank", "rocker"]
coefficient = 0.05
[start]
crank = 0.4
rocker = 1.2
slot = 0.7
rail = 0.15
)",
                     "quick_return");
}

Scene quick_return_with_every_measure() {
  Scene scene = quick_return();
  Random random(5);
  add_elements_upon_every_measure(scene, random);
  for (int k = 0; k < count_of(scene, "spring"); ++k)
    law<LinearSpring>(scene, "spring", k).acts = LinearSpring::Acts::both;
  return scene;
}

Scene driven_five_bar() {
  return parse_scene(R"(
title = "driven five-bar"
gravity = [0, -9.81]
[ground]
points = { A = [0, 0], R = [0, -0.1] }
[body.crank]
points = { A = [0, 0], B = [0.3, 0] }
mass = 0.7
center = [0.1, 0.01]
inertia = 0.006
[body.left]
points = { B = [0, 0], C = [0.9, 0] }
mass = 1.1
center = [0.4, 0.05]
inertia = 0.07
[body.right]
points = { D = [0, 0], C = [0.8, 0] }
mass = 1.3
center = [0.4, 0]
inertia = 0.08
[body.swing]
points = { E = [0, 0], D = [0.5, 0] }
mass = 0.8
center = [0.3, -0.02]
inertia = 0.03
[body.carriage]
points = { E = [0, 0] }
mass = 3
[[pin]]
points = ["ground.A", "crank.A"]
[[pin]]
points = ["crank.B", "left.B"]
[[pin]]
points = ["left.C", "right.C"]
[[pin]]
points = ["right.D", "swing.D"]
[[pin]]
points = ["carriage.E", "swing.E"]
[[slide]]
name = "track"
points = ["ground.R", "carriage.E"]
axis = [1, 0.05]
[[spring]]
points = ["carriage.E", "left.C"]
stiffness = 80
free_length = 0.6
[[damper]]
points = ["ground.A", "right.D"]
coefficient = 2
[[drive]]
name = "motor"
bodies = ["ground", "crank"]
rate = 2
amplitude = 0.3
frequency = 0.8
phase = 0.4
[[drive]]
name = "shaker"
slide = "track"
amplitude = 0.08
acceleration = 0.05
frequency = 0.7
[start]
crank = 0.5
left = 0.7
right = 2.2
swing = 1.3
track = 1.0
)",
                     "driven_five_bar");
}

}  // namespace poise::test

#include "tests/support/moving_scenes.hpp"

#include "model/joint_friction.hpp"
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

Scene rubbing_planet() {
  return resisted_by_joints(parse_scene(R"(
gravity = [0.3, -9.81]
[ground]
points = { O = [0.1, 0.2], S = [0.5, 0.4] }
[body.sun]
points = { O = [0, 0] }
mass = 0.7
center = [0.004, 0.002]
inertia = 0.002
[body.arm]
points = { O = [0, 0], Q = [0.05, 0] }
mass = 0.5
center = [0.03, 0.01]
inertia = 0.001
[body.planet]
points = { Q = [0, 0], P = [0.02, 0.01] }
mass = 0.6
center = [0.002, -0.001]
inertia = 0.0008
[[pin]]
name = "sun shaft"
points = ["ground.O", "sun.O"]
friction = { radius = 0.008, coefficient = 0.2 }
[[pin]]
name = "arm shaft"
points = ["ground.O", "arm.O"]
friction = { radius = 0.01, coefficient = 0.15 }
[[pin]]
name = "planet pin"
points = ["arm.Q", "planet.Q"]
friction = { radius = 0.006, coefficient = 0.1 }
[[torque]]
name = "T"
on = "sun"
value = 2
[[spring]]
points = ["ground.S", "planet.P"]
stiffness = 30
free_length = 0.2
[[gear]]
name = "inner"
bodies = ["sun", "planet"]
carrier = "arm"
ratio = 0.66666666666666663
pressure_angle = 0.35
[[gear]]
name = "outer"
bodies = ["planet", "ground"]
carrier = "arm"
ratio = 0.375
internal = true
pressure_angle = 0.3
)",
                                        "rubbing_planet"));
}

Scene rubbing_rack() {
  return resisted_by_joints(parse_scene(R"(
gravity = [0.3, -9.81]
[ground]
points = { B = [0.1, 0.2], S = [1.5, 0.4] }
[body.beam]
points = { B = [0, 0], C = [0.6, 0.05], G = [0.2, -0.06] }
mass = 2
center = [0.4, 0]
inertia = 0.1
[body.pinion]
points = { C = [0, 0], P = [0.05, 0] }
mass = 0.8
center = [0.01, 0.005]
inertia = 0.004
[body.rack]
points = { R = [0, 0], T = [0.3, 0.02] }
mass = 0.9
center = [0.1, 0.01]
inertia = 0.01
[[pin]]
name = "bearing"
points = ["ground.B", "beam.B"]
friction = { radius = 0.02, coefficient = 0.2 }
[[pin]]
name = "hub"
points = ["beam.C", "pinion.C"]
friction = { radius = 0.01, coefficient = 0.1 }
[[slide]]
name = "guide"
points = ["beam.G", "rack.R"]
axis = [1, 0.1]
friction = { coefficient = 0.1, length = 0.2 }
[[rack]]
name = "teeth"
slide = "guide"
pinion = "pinion"
carrier = "beam"
radius = 0.08
pressure_angle = 0.35
[[spring]]
name = "pull"
points = ["ground.S", "rack.T"]
stiffness = 40
free_length = 0.3
[[torque]]
name = "T"
on = "pinion"
value = 0.9
[[torsion_spring]]
bodies = ["ground", "beam"]
stiffness = 30
[start]
beam = 0.3
guide = 0.25
)",
                                        "rubbing_rack"));
}

Scene rubbing_rollers() {
  return resisted_by_joints(parse_scene(R"(
gravity = [0.3, -9.81]
[ground]
points = { O = [0, 0], G = [0.01, 0], L = [0.35, 0.1], C = [0.14, 0.02] }
[body.cam]
points = { O = [0, 0] }
mass = 1
center = [0.005, 0.002]
inertia = 0.004
[body.ram]
points = { A = [0, 0], R = [0.002, -0.08], S = [0.01, 0.1] }
mass = 0.5
center = [0.01, 0.05]
inertia = 0.002
[body.wheel]
points = { C = [0, 0] }
mass = 0.8
inertia = 0.003
[body.lever]
points = { L = [0, 0], R = [-0.2, 0.01], E = [0.1, 0] }
mass = 0.4
center = [-0.05, 0]
inertia = 0.003
[[pin]]
name = "shaft"
points = ["ground.O", "cam.O"]
friction = { radius = 0.01, coefficient = 0.2 }
[[slide]]
name = "guide"
points = ["ground.G", "ram.A"]
axis = [0, 1]
friction = { coefficient = 0.15, length = 0.15 }
[[pin]]
name = "axle"
points = ["ground.C", "wheel.C"]
friction = { radius = 0.008, coefficient = 0.15 }
[[pin]]
name = "pivot"
points = ["ground.L", "lever.L"]
friction = { radius = 0.01, coefficient = 0.2 }
[[cam]]
name = "rise"
bodies = ["ground", "cam"]
follower = { slide = "guide" }
roller = "ram.R"
curve = [[0, 0.1], [1.4, 0.4], [3, 1], [4.4, 0.6], [6.283185307179586, 0.1]]
lift = 0.02
base = 0.14
guided = true
[[cam]]
name = "swing"
bodies = ["ground", "wheel"]
follower = { bodies = ["ground", "lever"] }
roller = "lever.R"
curve = [[0, 0], [1.5, 0.5], [3.1, 1], [4.7, 0.5], [6.283185307179586, 0]]
lift = 0.15
base = -0.1
guided = true
[[torsion_spring]]
bodies = ["ground", "cam"]
stiffness = 1
free_angle = 1.5
[[torque]]
on = "wheel"
value = 0.3
[[spring]]
name = "push"
points = ["ram.S", "lever.E"]
stiffness = 60
free_length = 0.3
)",
                                        "rubbing_rollers"));
}

}  // namespace poise::test

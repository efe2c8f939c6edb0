#pragma once

// Small scenes for tests of the command line.

#include <string>

namespace poise::app_tests {

/// A weight on a rod that hangs from a pin; in equilibrium at -pi/2 (stable) and pi/2 (unstable), 5 N in the pin.
inline constexpr const char* pendulum = R"(title = "Pendulum"
gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0], tip = [2, 0] }
mass = 0.5
center = [2, 0]
[[pin]]
name = "hinge"
points = ["ground.O", "rod.O"]
[[force]]
name = "P"
at = "rod.tip"
vector = [0, -1]
[start]
rod = -1.2
)";

/// The same in the units of a workshop, with names that XML and JSON must escape.
inline constexpr const char* workshop_pendulum = R"(title = "Rod & \"pin\" <test>"
source = "ours"
[units]
length = "mm"
force = "kN"
angle = "deg"
[ground]
points = { O = [0, 0] }
[body."a<b"]
points = { "O&1" = [0, 0], tip = [200, 0] }
[[pin]]
name = "\"hinge\""
points = ["ground.O", "a<b.O&1"]
[[force]]
name = "<P>"
at = "a<b.tip"
vector = [3, 0]
[start]
"a<b" = 20
)";

/// A force that follows its rod, held by a torsion spring: no potential, in equilibrium at 1 rad.
inline constexpr const char* follower = R"(title = "Follower"
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0], tip = [1, 0] }
[[pin]]
points = ["ground.O", "rod.O"]
[[torsion_spring]]
name = "spring"
bodies = ["ground", "rod"]
stiffness = 2
[[force]]
name = "jet"
at = "rod.tip"
vector = [0, 2]
follows = "rod"
[start]
rod = 0.5
)";

/// A block pushed along a rail that never stops it: no equilibrium anywhere.
inline constexpr const char* runaway = R"(title = "Runaway"
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[force]]
name = "push"
at = "block.C"
vector = [1, 0]
)";

/// A block pushed against the end of its rail.
inline constexpr const char* against_the_stop = R"(title = "Against the stop"
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[force]]
name = "push"
at = "block.C"
vector = [7, 0]
[[stop]]
name = "end"
slide = "rail"
max = 0.25
)";

/// A lever with a moment of 9.81 N m by its weight, in a hinge with a dry friction of 12 N m; and what else statics
/// leaves out.
inline constexpr const char* rusty_lever = R"(title = "Rusty lever"
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.lever]
points = { O = [0, 0], tip = [1, 0] }
mass = 1
center = [1, 0]
inertia = 0.1
[[pin]]
points = ["ground.O", "lever.O"]
[[friction]]
name = "rust"
bodies = ["ground", "lever"]
torque = 12
[[torsion_damper]]
name = "grease"
bodies = ["ground", "lever"]
coefficient = 0.5
[[force]]
name = "nothing"
at = "lever.tip"
vector = [0, 0]
[start]
lever = -1
)";

/// A tray that hangs on two springs of 100 N/m and nothing else: 10 N on it stretch them by 0.05 m.
inline constexpr const char* hung_tray = R"(title = "Hung tray"
[units]
length = "mm"
[ground]
points = { A = [0, 0], B = [1000, 0] }
[body.tray]
points = { a = [-500, 0], b = [500, 0], m = [0, 0] }
[[spring]]
name = "left"
points = ["ground.A", "tray.a"]
stiffness = 0.1
free_length = 400
[[spring]]
name = "right"
points = ["ground.B", "tray.b"]
stiffness = 0.1
free_length = 400
[[force]]
name = "load"
at = "tray.m"
vector = [0, -10]
[start]
position = { tray = [490, -430] }
)";

/// Two links of 1 m that cannot span 5 m.
inline constexpr const char* open_loop = R"(title = "Too short"
gravity = [0, -10]
[ground]
points = { A = [0, 0], D = [5, 0] }
[body.left]
points = { A = [0, 0], B = [1, 0] }
mass = 1
center = [0.5, 0]
[body.right]
points = { B = [0, 0], D = [1, 0] }
mass = 1
center = [0.5, 0]
[[pin]]
name = "A"
points = ["ground.A", "left.A"]
[[pin]]
name = "B"
points = ["left.B", "right.B"]
[[pin]]
name = "D"
points = ["right.D", "ground.D"]
[start]
left = 0.3
right = -0.3
)";

/// A chain of n links hanging from one pin.
inline std::string hanging_links(int n) {
  std::string text = "title = \"Links\"\ngravity = [0, -10]\n[ground]\npoints = { O = [0, 0] }\n";
  for (int i = 0; i < n; ++i) {
    const std::string name = "link" + std::to_string(i);
    const std::string before = i == 0 ? "ground.O" : "link" + std::to_string(i - 1) + ".b";
    text += "[body." + name + "]\npoints = { a = [0, 0], b = [1, 0] }\nmass = 1\ncenter = [0.5, 0]\n";
    text.append("[[pin]]\npoints = [\"").append(before).append("\", \"").append(name).append(".a\"]\n");
  }
  text += "[start]\n";
  for (int i = 0; i < n; ++i) text += "link" + std::to_string(i) + " = -1.5\n";
  return text;
}

}  // namespace poise::app_tests

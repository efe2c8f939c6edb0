#pragma once

// A toggle under a load below that of its fold, whose swings identify its spring: two bars of 0.3 m, 0.2 rad above the
// line of their pivots, press a block of 4 kg against the spring. With the bars at the angle a above the line the load
//   P = 2 k (l0 - 1 + 0.6 cos a) tan a,  N,
// is in equilibrium, and is largest where cos^3 a = (1 - l0) / 0.6.

#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

namespace poise::test {

inline constexpr double rig_stiffness = 10000.0, rig_free_length = 0.412;

inline std::string rig_scene() {
  return fmt::format(R"(
[ground]
points = {{ O = [0, 0], wall = [1, 0] }}
[body.left]
points = {{ O = [0, 0], knee = [0.3, 0] }}
[body.right]
points = {{ knee = [0, 0], C = [0.3, 0] }}
[body.block]
points = {{ C = [0, 0] }}
mass = 4
[[pin]]
name = "O"
points = ["ground.O", "left.O"]
[[pin]]
name = "knee"
points = ["left.knee", "right.knee"]
[[pin]]
name = "C"
points = ["right.C", "block.C"]
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[spring]]
name = "rubber"
points = ["ground.wall", "block.C"]
stiffness = {}
free_length = {}
[[damper]]
name = "block"
points = ["ground.wall", "block.C"]
coefficient = 10
[[force]]
name = "P"
at = "left.knee"
vector = [0, -8]
[start]
left = 0.19
right = -0.19
rail = 0.589
)",
                     rig_stiffness, rig_free_length);
}

/// An experiment on "rig.toml" beside it; its record is simulated with this seed. Further unknowns are TOML tables.
inline std::string rig_experiment(std::uint64_t seed, const std::string& further = "") {
  return fmt::format(R"(
scene = "rig.toml"
[[sensor]]
name = "left"
angle = "left"
noise = 4e-3
[[unknown]]
path = "spring.rubber.stiffness"
name = "k"
start = 9000
min = 1000
[[unknown]]
path = "spring.rubber.free_length"
name = "l0"
start = 0.411
[[unknown]]
path = "damper.block.coefficient"
name = "c"
start = 15
min = 0
[[run]]
name = "swing"
release = {{ left = 0.22 }}
duration = 1.5
rate = 100
seed = {}
{})",
                     seed, further);
}

/// The angle of the fold, rad, and its load, N.
inline double rig_fold_angle() { return std::acos(std::cbrt((1 - rig_free_length) / 0.6)); }
inline double rig_snap_load() {
  const double a = rig_fold_angle();
  return 2 * rig_stiffness * (rig_free_length - 1 + 0.6 * std::cos(a)) * std::tan(a);
}

}  // namespace poise::test

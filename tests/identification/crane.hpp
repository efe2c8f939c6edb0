#pragma once

#include <string>

namespace poise::test {

/// A pendulum on a carriage that is driven along a rail, in a wind; a motor turns the pendulum against the carriage's
/// frame. Further lines of the motor's torque (its value), of the wind's force and of the drive "belt"; the angle from
/// which the pendulum starts.
inline std::string crane(const std::string& motor, const std::string& wind, const std::string& belt,
                         const std::string& angle) {
  return R"(
title = "crane"
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.cart]
points = { O = [0, 0] }
mass = 3
[body.arm]
points = { A = [0, 0], T = [0.4, 0] }
mass = 1.3
center = [0.3, 0]
inertia = 0.05
[[slide]]
name = "rail"
points = ["ground.O", "cart.O"]
axis = [1, 0]
[[pin]]
points = ["cart.O", "arm.A"]
[[torsion_damper]]
name = "grease"
bodies = ["cart", "arm"]
coefficient = 0.08
[[torque]]
name = "motor"
on = "arm"
)" + motor +
         R"(
[[force]]
name = "wind"
at = "arm.T"
vector = [0.5, 0]
)" + wind +
         R"(
[[drive]]
name = "belt"
slide = "rail"
)" + belt +
         R"(
[start]
arm = )" +
         angle + "\n";
}

}  // namespace poise::test

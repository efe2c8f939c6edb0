#pragma once

namespace poise::test {

/// A ball of 0.2 kg falls by 0.5 m on a slope of 30 deg, on which it rolls down, held by friction.
inline constexpr const char* ball_on_slope = R"(gravity = [0, -9.81]
[ground]
points = { A = [-1, 0.57735026918962573], B = [1, -0.57735026918962573] }
[body.ball]
points = { C = [0, 0] }
mass = 0.2
inertia = 0.001
[[contact]]
name = "slope"
point = "ball.C"
radius = 0.1
segment = ["ground.A", "ground.B"]
friction = 0.3
[start]
position = { ball = [0, 0.61547005383792515] }
)";

}  // namespace poise::test

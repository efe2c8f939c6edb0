#pragma once

#include <cmath>

#include "tests/identification/experiments.hpp"

namespace poise::test {

// A wheel of inertia I on a torsion spring k with a damper that does nothing, released at the angle a: it moves as
// a cos(w t), w^2 = k / I.
struct Wheel {
  static constexpr double inertia = 0.5, stiffness = 20, noise = 1e-4, angle = 0.3;
  Experiment experiment;

  explicit Wheel(int runs) {
    experiment.scene = parse_scene(R"(
      [ground]
      points = { O = [0, 0] }
      [body.wheel]
      points = { O = [0, 0] }
      inertia = 0.5
      [[pin]]
      points = ["ground.O", "wheel.O"]
      [[torsion_spring]]
      name = "coil"
      bodies = ["ground", "wheel"]
      stiffness = 20
      [[torsion_damper]]
      name = "air"
      bodies = ["ground", "wheel"]
      coefficient = 0
    )",
                                   "wheel.toml");
    experiment.sensors = {test::angle_of(experiment.scene, "wheel", noise)};
    experiment.unknowns = {test::unknown("torsion_spring.coil.stiffness")};
    Release turn;
    turn.body = 1;
    turn.value = angle;
    for (int r = 0; r < runs; ++r) experiment.runs.push_back(test::simulated(100, 50, {turn}));
  }

  static double at(double time) { return angle * std::cos(std::sqrt(stiffness / inertia) * time); }
};

}  // namespace poise::test

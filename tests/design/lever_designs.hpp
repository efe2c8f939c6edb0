#pragma once

#include <cmath>
#include <string>

#include "design/goals/design_search.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::test {

/// A lever on a coil, SI, whose center of mass is `center` from its pivot. Held at the angle a it takes the torque
///   T = k (a - a0) + m g c cos(a).
struct SprungLever {
  double stiffness = 5.0, free_angle = 0.2, mass = 2.0, center = 0.3, gravity = 10.0;

  double torque(double angle) const {
    return stiffness * (angle - free_angle) + mass * gravity * center * std::cos(angle);
  }
  std::string text() const;
};

/// The design of a text that names "scene.toml", with that scene beside it, as it is read.
GoalProblem read_design_text(const app_tests::TempFolder& folder, const std::string& scene, const std::string& design);

/// What is found on one thread.
GoalDesign design_of(const app_tests::TempFolder& folder, const std::string& scene, const std::string& design,
                     GoalSearchOptions options = {});

}  // namespace poise::test

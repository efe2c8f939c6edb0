#pragma once

// What tests of slots and rolling contacts share.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/modes.hpp"
#include "motion/motion_model.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::test {

inline double tolerance(Method method) { return method == Method::virtual_work ? 1e-11 : 1e-7; }

/// Found by both methods and proved.
inline std::vector<Equilibrium> found_both_ways(const StaticModel& model) {
  std::vector<Equilibrium> out;
  for (const Method method : {Method::virtual_work, Method::energy}) {
    out.push_back(solve(model, by(method, Seek::stable)));
    EXPECT_EQ(out.back().status, Status::confirmed) << out.back().why;
  }
  return out;
}

/// Of the one vibration about the stable equilibrium next to the scene's start, rad/s.
inline double frequency_of(const Scene& scene) {
  const MotionModel model(scene);
  const StaticModel rest(scene);
  const Equilibrium found = solve(rest, by(Method::virtual_work, Seek::stable));
  EXPECT_TRUE(found.found()) << found.why;
  const Modes modes = modes_of(model, motion_coordinates(model, rest, found.x));
  EXPECT_TRUE(modes.known) << modes.why;
  EXPECT_EQ(modes.freedoms, 1);
  return 2 * std::numbers::pi * modes.vibrations.at(0).frequency;
}

/// Derivatives of an angle by numbers of the scene against central differences.
inline void expect_sensitivities(const std::string& text, const std::string& quantity,
                                 const std::vector<std::string>& among) {
  const Scene scene = parse_scene(text, "scene.toml");
  const StaticModel model(scene);
  const Sensitivities found = sensitivities(model, {find_quantity(scene, quantity)});
  ASSERT_EQ(found.of.size(), 1U) << found.why;
  std::vector<std::string> seen;
  for (const Sensitivity& of : found.of[0].by) {
    if (!of.why.empty() || std::find(among.begin(), among.end(), of.number) == among.end()) continue;
    seen.push_back(of.number);
    const auto value = [&](double change) {
      Scene changed = scene;
      set_value(changed, of.number, get_value(scene, of.number) + change);
      const StaticModel there(changed);
      const Equilibrium equilibrium = solve(there, by(Method::virtual_work, Seek::any));
      EXPECT_TRUE(equilibrium.found()) << equilibrium.why;
      const std::string body = quantity.substr(quantity.find('.') + 1);
      return angle_of(there, equilibrium.x, body);
    };
    constexpr double h = 1e-4;
    const double slope = (8 * (value(h) - value(-h)) - (value(2 * h) - value(-2 * h))) / (12 * h);
    EXPECT_NEAR(of.derivative, slope, 1e-7 * (1.0 + std::abs(slope))) << of.number;
  }
  EXPECT_EQ(seen.size(), among.size());
}

}  // namespace poise::test

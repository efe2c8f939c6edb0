// The equations of free bodies in scalars of their numbers: dual numbers against differences in 50 digits, balls and
// intervals around 50 digits, and the same forces as those of the scene's own numbers.

#include "statics/bodies/body_forces.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/couplings.hpp"
#include "solvers/real50.hpp"
#include "statics/bodies/ball_measures.hpp"
#include "statics/bodies/free_body_equations.hpp"
#include "statics/model/ball_mechanism.hpp"
#include "statics/model/interval_mechanism.hpp"
#include "statics/quantities/linear_response.hpp"
#include "statics/quantities/numbered_equations.hpp"
#include "tests/support/every_measure.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::statics_body_forces_test {
namespace {

struct Case {
  std::string name;
  Scene scene;
};

/// Parts of every kind: loads, also distributed ones and such that follow bodies; joints; springs, gas struts, curves;
/// ropes over pulleys; gears, racks and cams with and without contact forces; slots, rolling wheels and profiles;
/// flexible links; and elements upon every kind of measure.
std::vector<Case> cases() {
  std::vector<Case> out;
  for (const char* name :
       {"toggle_clamp", "four_bar_gravity", "lift", "gas_lid", "knee_press", "hencky_cantilever", "block_and_tackle",
        "planetary_gear", "eccentric_chain", "cam_follower", "offset_cam", "arc_slot", "curved_slot", "rolling_wheel",
        "rocking_chair", "friction/hoist", "hard/follower_four_bar", "structures/three_hinged_portal"}) {
    out.push_back({name, read_scene(test::dataset(name + std::string(".toml")))});
  }
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3),
                          .followers = seed % 2 == 0,
                          .stops = true,
                          .other_laws = true,
                          .couplings = true};
    out.push_back({fmt::format("seed {}", seed), test::plant_mechanism(seed, wish).scene});
    test::Random random(seed);
    if (seed <= 3) test::add_elements_upon_every_measure(out.back().scene, random, true);
  }
  return out;
}

/// All stops hold at a limit that they have, in a pose beside the start, with joint forces at random.
struct State {
  NumberedEquations equations;
  std::vector<double> z;
};

State state_of(const Scene& given, std::uint64_t seed) {
  const StaticModel model(given);
  const Scene scene = model.scaled_scene();
  std::vector<ActingStop> acting;
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    acting.push_back({static_cast<int>(s), std::isfinite(scene.stops[s].max)});
  }
  State out{{scene, acting}, poses_of(model, model.start())};
  test::Random random(seed);
  for (double& pose : out.z) pose += random.uniform(-0.01, 0.01);
  out.equations.count_turns(out.z.data());
  while (static_cast<int>(out.z.size()) < out.equations.unknowns()) out.z.push_back(random.uniform(-1.0, 1.0));
  return out;
}

template <class T>
std::vector<T> residual(const State& state, const std::vector<T>& numbers) {
  const std::vector<T> z(state.z.begin(), state.z.end());
  std::vector<T> out(z.size());
  std::vector<NumberedEquations::Placed<T>> placed;
  state.equations.residual(numbers.data(), z.data(), out.data(), placed);
  return out;
}

template <class T>
std::vector<T> numbers_in(const State& state) {
  return {state.equations.numbers().begin(), state.equations.numbers().end()};
}

TEST(BodyForces, HaveTheDerivativesByEveryNumberThatDifferencesIn50DigitsHave) {
  const Real50 h("1e-18");
  int compared = 0;
  for (const Case& one : cases()) {
    const State state = state_of(one.scene, 1);
    const std::vector<double>& numbers = state.equations.numbers();
    const ResidualDerivatives found = differentiate(state.equations, numbers, state.z, true);
    ASSERT_TRUE(found.residual.allFinite()) << one.name;
    const std::vector<int>& leaders = state.equations.list()->leaders();
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const bool leads = std::find(leaders.begin(), leaders.end(), static_cast<int>(k)) != leaders.end();
      if (leads || !std::isfinite(numbers[k])) continue;
      std::vector<Real50> more = numbers_in<Real50>(state), less = more;
      more[k] += h;
      less[k] -= h;
      const std::vector<Real50> above = residual(state, more), below = residual(state, less);
      const auto column = found.by_numbers.col(static_cast<Eigen::Index>(k));
      const double allowed = 1e-11 * (1.0 + column.cwiseAbs().maxCoeff());
      for (std::size_t i = 0; i < above.size(); ++i) {
        const auto difference = static_cast<double>((above[i] - below[i]) / (2 * h));
        EXPECT_NEAR(column[static_cast<Eigen::Index>(i)], difference, allowed)
            << one.name << ": row " << i << " by "
            << (k < state.equations.rows().size() ? state.equations.rows()[k].path.text() : std::to_string(k));
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 20000);
}

bool has_curve(const Scene& scene) {
  return std::any_of(scene.stops.begin(), scene.stops.end(),
                     [](const Stop& stop) { return curve_numbers_of(stop).points > 0; });
}

Ball ball_of(const Real50& x) {
  const auto high = static_cast<double>(x);
  return Ball(high) + Ball(static_cast<double>(x - high));
}

// Of a curve through points as given the function is known in double.
constexpr double rounding_of_curves = 1e-11;

TEST(BodyForces, OfNumbersInBallsEncloseThoseIn50Digits) {
  for (const Case& one : cases()) {
    const State state = state_of(one.scene, 2);
    const bool curved = has_curve(one.scene);
    for (const double share : {0.0, 1e-6}) {
      if (curved && share > 0.0) continue;
      std::vector<Ball> balls;
      std::vector<Real50> inside;
      test::Random random(3);
      for (const double number : state.equations.numbers()) {
        balls.push_back(std::isfinite(number) ? Ball(number).widened(share * std::abs(number)) : Ball(number));
        inside.emplace_back(number + (std::isfinite(number) ? share * random.uniform(-0.9, 0.9) * number : 0.0));
      }
      const std::vector<Ball> found = residual(state, balls);
      const std::vector<Real50> exact = residual(state, inside);
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_TRUE(found[i].is_finite()) << one.name << ": row " << i;
        EXPECT_TRUE(found[i].widened(curved ? rounding_of_curves : 1e-30).contains(ball_of(exact[i])))
            << one.name << ": row " << i << " " << found[i].middle() << " " << exact[i];
        EXPECT_LT(found[i].radius(), share == 0.0 ? 1e-25 : 1e-2) << one.name << ": row " << i;
      }
    }
  }
}

std::vector<Interval> enclosed(const State& state, const std::vector<Interval>& numbers) {
  const solvers::RoundingUp upwards;
  return residual(state, numbers);
}

TEST(BodyForces, OfNumbersInIntervalsEncloseThoseIn50Digits) {
  for (const Case& one : cases()) {
    const State state = state_of(one.scene, 4);
    const std::vector<Interval> found = enclosed(state, numbers_in<Interval>(state));
    const std::vector<Real50> exact = residual(state, numbers_in<Real50>(state));
    const double slack = has_curve(one.scene) ? rounding_of_curves : 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_TRUE(found[i].bounded()) << one.name << ": row " << i;
      EXPECT_TRUE(Real50(found[i].lower()) - slack <= exact[i] && exact[i] <= Real50(found[i].upper()) + slack)
          << one.name << ": row " << i << " [" << found[i].lower() << ", " << found[i].upper() << "] " << exact[i];
    }
  }
}

// A curve through points that may be others is not known: nothing is concluded from it.
TEST(BodyForces, OfACurveThroughSetsOfPointsAreNotKnown) {
  const State state = state_of(read_scene(test::dataset("curved_slot.toml")), 5);
  std::vector<Ball> balls;
  for (const double number : state.equations.numbers()) balls.push_back(Ball(number).widened(1e-9));
  const std::vector<Ball> found = residual(state, balls);
  EXPECT_TRUE(std::any_of(found.begin(), found.end(), [](const Ball& ball) { return !ball.is_finite(); }));
}

// One set of equations: columns of efforts times efforts, and loads, are the residual; and those of the scene's own
// numbers are those of the numbers as variables.
TEST(BodyForces, OfVariableNumbersAreThoseOfTheScene) {
  for (const Case& one : cases()) {
    const State state = state_of(one.scene, 6);
    const NumberedEquations& equations = state.equations;
    const Scene& scene = equations.scene();
    std::vector<double> expected(state.z.size());
    std::vector<NumberedEquations::Placed<double>> placed;
    equations.residual(equations.numbers().data(), state.z.data(), expected.data(), placed);
    const auto bodies = equations.bodies(equations.numbers().data(), placed);
    std::vector<BodyPose<double>> poses;
    for (const auto& body : placed) poses.push_back({body.origin, body.angle});

    const auto balance = [&](auto free) {
      std::vector<double> out(static_cast<std::size_t>(equations.poses()), 0.0);
      const auto push = [&](int body, const Vec2& at, const Vec2& force, double moment) {
        if (body == 0) return;
        const auto row = static_cast<std::size_t>(3 * (body - 1));
        out[row] += force.x;
        out[row + 1] += force.y;
        out[row + 2] += free.turning(body, at, force, moment);
      };
      free.push_loads(push);
      free.push_elements(push);
      free.add_joints();
      for (std::size_t h = 0; h < equations.acting().size(); ++h) {
        const double effort = state.z[static_cast<std::size_t>(equations.multiplier_of_stop(static_cast<int>(h)))];
        free.add_stop(equations.acting()[h].stop, 2, effort < 0 ? -1.0 : 1.0);
      }
      for (std::size_t u = 0; u < free.unknowns().size(); ++u) {
        const double effort = state.z[static_cast<std::size_t>(equations.poses()) + u];
        free.for_each_entry(free.unknowns()[u],
                            [&](int row, double value) { out[static_cast<std::size_t>(row)] += effort * value; });
      }
      return out;
    };
    const std::vector<double> of_scene = balance(FreeBodyEquations(scene, poses, 1.0));
    const std::vector<double> of_numbers =
        balance(FreeBodyEquations<PlacedBody<double>, Numbers<double>>(bodies, placed, 1.0));
    for (std::size_t i = 0; i < of_scene.size(); ++i) {
      const double allowed = 1e-11 * (1.0 + std::abs(expected[i]));
      EXPECT_NEAR(of_scene[i], expected[i], allowed) << one.name << ": row " << i;
      EXPECT_NEAR(of_numbers[i], expected[i], allowed) << one.name << ": row " << i;
    }
    const BodyForces of_poses(scene, poses);
    for (int s = 0; s < static_cast<int>(scene.stops.size()); ++s) {
      const double value = of_poses.value(scene.stops[static_cast<std::size_t>(s)].on);
      EXPECT_NEAR(bodies.value(scene.stops[static_cast<std::size_t>(s)].on, s), value, 1e-11 * (1 + std::abs(value)))
          << one.name << ": " << scene.stops[static_cast<std::size_t>(s)].name;
    }
    EXPECT_NEAR(bodies.energy(), of_poses.energy(), 1e-11 * (1 + std::abs(of_poses.energy()))) << one.name;
  }
}

}  // namespace
}  // namespace poise::statics_body_forces_test

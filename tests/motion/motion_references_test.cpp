// Simulated motions against datasets/motion_answers.json and datasets/lift_dynamics.json, computed apart from Poise.

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "motion/modes.hpp"
#include "motion/simulate.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/motions.hpp"

namespace poise::motion_references_test {
namespace {

using nlohmann::json;
using test::dataset;
using test::number;

const json& answers(const std::string& scene) {
  static const json all = test::read_json(dataset("motion_answers.json"));
  return all.at(scene);
}

void expect_states(const std::string& name, const test::Release& release) {
  const MotionModel model(read_scene(dataset(name)));
  const json& known = answers(name);
  for (const json& state : known.at("states")) {
    SCOPED_TRACE(state.dump());
    const Motion motion = test::moved(model, test::released(model, release), number(state.at("t")));
    const test::PointState end = test::end_of(model, motion, known.at("point").get<std::string>());
    EXPECT_NEAR(end.place.x, number(state.at("x")), 1e-9);
    EXPECT_NEAR(end.place.y, number(state.at("y")), 1e-9);
    EXPECT_LT(motion.energy_error, 1e-10);
    if (!state.contains("vx")) continue;
    EXPECT_NEAR(end.velocity.x, number(state.at("vx")), 1e-9 * 7);
    EXPECT_NEAR(end.velocity.y, number(state.at("vy")), 1e-9 * 7);
  }
}

TEST(MotionReferences, PendulumOfA01) { expect_states("pendulum_a01.toml", {}); }

TEST(MotionReferences, WindowsOfA02) { expect_states("nfb2.toml", {{}, {{"post0", -1.0}}}); }

// All bars lie in line wherever the posts are level.
TEST(MotionReferences, WindowsPassTheirSingularPosesAndSaySo) {
  const MotionModel model(read_scene(dataset("nfb2.toml")));
  const Motion motion = test::moved(model, test::released(model, {{}, {{"post0", -1.0}}}), 20.0);
  const auto post = static_cast<std::size_t>(test::coordinate_of(model, "post0"));
  // Twice in each of 10.3 turns, which begin upright.
  ASSERT_EQ(motion.singular.size(), 20u);
  const std::vector<test::Reading> there = test::read_at(motion, motion.singular);
  for (std::size_t k = 0; k < there.size(); ++k) {
    EXPECT_NEAR(there[k].q[post], -M_PI * static_cast<double>(k), 1e-3) << motion.singular[k];
  }
}

// Rounding of the loops grows by the inverse cube of the distance from the pose at which a stage is evaluated.
TEST(MotionReferences, WindowsPassAtAnySpeed) {
  const MotionModel model(read_scene(dataset("nfb2.toml")));
  const auto post = static_cast<std::size_t>(test::coordinate_of(model, "post0"));
  for (double rate = -0.3; rate > -3.0; rate -= 0.137) {
    SCOPED_TRACE(rate);
    const Motion motion = test::moved(model, test::released(model, {{}, {{"post0", rate}}}), 10.0);
    EXPECT_LT(motion.energy_error, 1e-10);
    const std::vector<double> end = test::q_at(motion, motion.trajectory.nodes() - 1);
    EXPECT_EQ(motion.singular.size(), static_cast<std::size_t>(std::floor(-end[post] / M_PI) + 1));
    EXPECT_NEAR(std::sin((end[post] - end[static_cast<std::size_t>(test::coordinate_of(model, "post2"))]) / 2), 0.0,
                1e-9);
  }
}

TEST(MotionReferences, AndrewsSqueezer) {
  const MotionModel model(read_scene(dataset("andrews.toml")));
  const json& known = answers("andrews.toml");
  // The test set's coordinates from the angles of the bodies.
  const auto relative = [&](const std::vector<double>& q) {
    std::vector<double> k(8);
    for (int i = 1; i <= 7; ++i) {
      k[static_cast<std::size_t>(i)] =
          q[static_cast<std::size_t>(test::coordinate_of(model, std::string("k").append(std::to_string(i))))];
    }
    return std::vector<double>{k[1], k[2] - k[1], k[3], k[4] - k[5], k[5], k[6] - k[7], k[7]};
  };
  const MotionState start = test::released(model, {});
  const std::vector<double> begin = relative(start.q);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(begin[i], number(known.at("q0")[i]), 1e-14) << i;
  const Motion motion = test::moved(model, start, number(known.at("t")));
  const std::size_t last = motion.trajectory.nodes() - 1;
  const std::vector<double> q = relative(test::q_at(motion, last));
  const std::vector<double> v = relative(test::v_at(motion, last));
  for (std::size_t i = 0; i < 7; ++i) {
    const double q_known = number(known.at("q")[i]);
    const double v_known = number(known.at("qdot")[i]);
    EXPECT_NEAR(q[i], q_known, 1e-7 * std::abs(q_known)) << i;
    EXPECT_NEAR(v[i], v_known, 1e-7 * std::abs(v_known)) << i;
  }
  EXPECT_LT(motion.energy_error, 1e-10);
}

Scene undamped_lift() {
  Scene scene = read_scene(dataset("lift.toml"));
  test::erase_elements(scene, "damper");
  return scene;
}

TEST(MotionReferences, UndampedLiftKeepsItsEnergyForAMinute) {
  const MotionModel model(undamped_lift());
  const std::vector<double> equilibrium = test::equilibrium_of(model);
  const double obd = equilibrium[static_cast<std::size_t>(test::coordinate_of(model, "obd"))];
  for (double swing : {0.005, 0.05}) {
    const MotionState start = test::released(model, {{{"obd", obd + swing}}, {}}, &equilibrium);
    const Motion motion = test::moved(model, start, 60.0);
    EXPECT_LT(motion.energy_error, 1e-10);
    const double drift =
        motion.kinetic.back() + motion.potential.back() - motion.kinetic.front() - motion.potential.front();
    double exchanged = 0.0;
    for (double kinetic : motion.kinetic) exchanged = std::max(exchanged, kinetic);
    EXPECT_LT(std::abs(drift), 1e-10 * exchanged);
  }
}

// Period from rest to rest: times at which the boom turns round.
double frequency_of_swing(const MotionModel& model, const std::vector<double>& equilibrium, double swing) {
  const int obd = test::coordinate_of(model, "obd");
  const double place = equilibrium[static_cast<std::size_t>(obd)];
  const MotionState start = test::released(model, {{{"obd", place + swing}}, {}}, &equilibrium);
  const Motion motion = test::moved(model, start, 4.0);
  std::vector<double> turns{0.0};
  TrajectoryReader reader(motion.trajectory, {obd});
  const auto rate = [&](double t) {
    reader.at(t);
    return reader.v(0);
  };
  constexpr double tick = 0.01;
  for (double t = tick; t + tick < 4.0; t += tick) {
    double low = t;
    double high = t + tick;
    if (rate(low) * rate(high) > 0) continue;
    const double sign = rate(low);
    for (int k = 0; k < 50; ++k) {
      const double middle = (low + high) / 2;
      (rate(middle) * sign > 0 ? low : high) = middle;
    }
    turns.push_back(low);
  }
  const std::size_t whole = (turns.size() - 1) / 2;
  return static_cast<double>(whole) / turns[2 * whole];
}

TEST(MotionReferences, SmallSwingOfTheLiftHasItsNaturalFrequency) {
  const MotionModel model(undamped_lift());
  const std::vector<double> equilibrium = test::equilibrium_of(model);
  const Modes modes = modes_of(model, model.from_si(equilibrium));
  ASSERT_EQ(modes.vibrations.size(), 1u);
  const double natural = modes.vibrations[0].frequency;
  // The frequency of a swing falls off with its square.
  EXPECT_NEAR(frequency_of_swing(model, equilibrium, 1e-5), natural, 1e-8 * natural);
  EXPECT_NEAR(frequency_of_swing(model, equilibrium, 1e-3), natural, 1e-4 * natural);
  const json reference = test::read_json(dataset("lift_dynamics.json"));
  for (const json& entry : reference.at("entries")) {
    if (entry.at("frac") == 0.5 && entry.at("payload") == 200.0) {
      EXPECT_NEAR(natural, entry.at("f_Hz").get<double>(), 1e-10 * natural);
    }
  }
}

}  // namespace
}  // namespace poise::motion_references_test

// Forces of teeth and rollers in joints with friction, in motion.

#include "motion/bearing_loads.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/joint_friction.hpp"
#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/moving_scenes.hpp"

namespace poise::bearing_loads_test {
namespace {

MotionModel model_of(const std::string& text) { return MotionModel(resisted_by_joints(parse_scene(text, "test"))); }

constexpr double pressure = 0.35;

// Two wheels with axes 0.5 apart in bearings of the friction circles 0.02 and 0.03, mu / sqrt(1 + mu^2) times the
// radius; a torque on the first.
std::string wheels(const std::string& gear, double torque, const std::string& more = "") {
  return fmt::format(R"(
[ground]
points = {{ A = [0, 0], B = [0.3, 0.4] }}
[body.a]
points = {{ A = [0, 0] }}
mass = 1
inertia = 0.02
[body.b]
points = {{ B = [0, 0] }}
mass = 3
inertia = 0.3
[[pin]]
name = "A"
points = ["ground.A", "a.A"]
friction = {{ radius = 0.1, coefficient = 0.20412414523193151 }}
[[pin]]
name = "B"
points = ["ground.B", "b.B"]
friction = {{ radius = 0.15, coefficient = 0.20412414523193151 }}
[[gear]]
name = "teeth"
bodies = ["a", "b"]
{}
pressure_angle = {}
phase = 0
[[torque]]
name = "T"
on = "a"
value = {:.17g}
{})",
                     gear, pressure, torque, more);
}

// Both pins carry F / cos(pressure) of the tooth force F alone. With pitch radii r_a, r_b, rates that have the sign s
// of the motion of a, and friction circles c:
//   J_a alpha = T - r_a F - s c_a |F| / cos,   J_b (r_a / r_b) alpha = r_b F - s c_b |F| / cos
TEST(BearingLoads, AccelerateAPairOfWheelsAsItsClosedForm) {
  constexpr double c_a = 0.02, c_b = 0.03, J_a = 0.02, J_b = 0.3;
  const double steep = 1 / std::cos(pressure);
  struct Case {
    std::string gear;
    double r_a, r_b;
  };
  for (const Case& one :
       {Case{"ratio = 0.25", 0.1, 0.4}, Case{"ratio = 4", 0.4, 0.1}, Case{"ratio = 0.5\ninternal = true", 0.5, 1.0}}) {
    for (const double torque : {5.0, -5.0}) {
      // The wheels start with the torque, so that F has its sign s, and |F| = s F.
      const double s = torque > 0 ? 1.0 : -1.0, ratio = one.r_a / one.r_b;
      const double by_b = J_b * ratio / (one.r_b - c_b * steep);
      const double alpha = torque / (J_a + (one.r_a + c_a * steep) * by_b);
      const MotionModel model = model_of(wheels(one.gear, torque));
      const Motion motion = test::moved(model, test::released(model, {{}, {{"a", s * 0.7}}}), 1.5);
      const auto a = static_cast<std::size_t>(test::coordinate_of(model, "a"));
      std::vector<double> times;
      for (int k = 0; k <= 15; ++k) times.push_back(0.1 * k);
      const std::vector<test::Reading> read = test::read_at(motion, times);
      for (std::size_t i = 0; i < times.size(); ++i) {
        const double t = times[i];
        ASSERT_NEAR(read[i].q[a], s * 0.7 * t + alpha * t * t / 2, 1e-11) << one.gear << " " << torque << " at " << t;
      }
      EXPECT_LT(motion.energy_error, 1e-12);
    }
  }
}

// A torsion spring swings the wheels. With x the angle of a, b at -ratio x, the sign s of the rate of x and the tooth
// force F, positive where a drives b forwards,
//   J_b ratio alpha = r_b F - s c_b |F| steep - K ratio x,   J_a alpha = -r_a F - s c_a |F| steep,
// so that each change of flanks changes the friction.
class SwingingWheels {
 public:
  double acceleration(double x, double s) const {
    // Of the two flanks the one whose force has its sign; both have none where F = 0.
    double out = 0.0;
    for (const double f : {1.0, -1.0}) {
      const double on_b = r_b - s * f * c_b * steep, on_a = r_a + s * f * c_a * steep;
      const double alpha = -on_a / on_b * K * ratio * x / (J_a + on_a / on_b * J_b * ratio);
      const double force = (J_b * ratio * alpha + K * ratio * x) / on_b;
      if (f * force >= 0) out = alpha;
    }
    return out;
  }
  static constexpr double r_a = 0.1, r_b = 0.4, c_a = 0.02, c_b = 0.03, J_a = 0.02, J_b = 0.3, K = 40.0, ratio = 0.25;
  const double steep = 1 / std::cos(pressure);
};

// On each side of rest and each flank the motion is harmonic, alpha = -w^2 x: it turns where its rate is zero.
TEST(BearingLoads, SwingThroughBothFlanksOfTheTeeth) {
  const MotionModel model =
      model_of(wheels("ratio = 0.25", 0.0, "[[torsion_spring]]\nbodies = [\"ground\", \"b\"]\nstiffness = 40\n"));
  const auto a = static_cast<std::size_t>(test::coordinate_of(model, "a"));
  constexpr double x0 = 0.8;
  const Motion motion = test::moved(model, test::released(model, {{{"a", x0}, {"b", -0.25 * x0}}, {}}), 4.0);
  EXPECT_LT(motion.energy_error, 1e-11);
  const SwingingWheels wheels;
  // From rest at x0 with s = -1 until x = 0, where the spring and the inertias both vanish, so that F does; thence to
  // rest at -x1 with w2: x1 w2 = x0 w1.
  double x = x0, t = 0.0;
  std::vector<double> times, expected;
  for (double s = -1.0; t < 3.0; s = -s) {
    const double in = std::sqrt(-wheels.acceleration(x, s) / x), out = std::sqrt(-wheels.acceleration(-x, s) / -x);
    ASSERT_NE(in, out);
    constexpr double quarter = 1.5707963267948966;
    for (const double share : {0.3, 0.9}) {
      times.push_back(t + share * quarter / in);
      expected.push_back(x * std::cos(share * quarter));
    }
    t += quarter / in;
    const double next = -x * in / out;
    for (const double share : {0.2, 0.8}) {
      times.push_back(t + share * quarter / out);
      expected.push_back(next * std::sin(share * quarter));
    }
    t += quarter / out;
    x = next;
  }
  ASSERT_LT(times.back(), 4.0);
  const std::vector<test::Reading> read = test::read_at(motion, times);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(read[i].q[a], expected[i], 1e-10) << times[i];
}

// Where the motion passes, the bodies cut free need no drive: forces and events of a whole motion at once.
void expect_free_motion(const Scene& scene, const std::vector<std::string>& freedoms, const test::Release& release) {
  const MotionModel model(scene);
  std::vector<Drive> drives;
  for (const std::string& freedom : freedoms) drives.push_back(find_drive(scene, freedom));
  MotionOptions options;
  options.duration = 0.6;
  options.accuracy = 1e-10;
  const Motion motion = simulate(model, test::released(model, release), options);
  ASSERT_TRUE(motion.completed()) << motion.why;
  EXPECT_LT(motion.energy_error, 1e-9);
  int rubbing = 0;
  constexpr double step = 1e-4;
  for (double t = 0.0131; t < 0.6; t += 0.0377) {
    const std::vector<test::Reading> read = test::read_at(motion, {t - 2 * step, t - step, t, t + step, t + 2 * step});
    std::vector<double> a(read[2].v.size());
    double bend = 0.0;  // an event within the difference
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double wide = (read[4].v[i] - read[0].v[i]) / (4 * step),
                   narrow = (read[3].v[i] - read[1].v[i]) / (2 * step);
      a[i] = (4 * narrow - wide) / 3;
      bend = std::max(bend, std::abs(wide - narrow) / (1 + std::abs(narrow)));
    }
    if (bend > 1e-4) continue;
    const Forces forces =
        forces_of(model, model.from_si(read[2].q), model.from_si(read[2].v), model.from_si(a), drives);
    if (forces.friction.state != SlidingFriction::State::solved || !forces.friction.at_rest.empty()) continue;
    ++rubbing;
    for (const DriveEffort& drive : forces.drives) EXPECT_NEAR(drive.value, 0.0, 1e-5 * forces.largest_force) << t;
  }
  EXPECT_GT(rubbing, 6);
}

TEST(BearingLoads, MoveAsBodiesCutFreeDo) {
  expect_free_motion(test::rubbing_planet(), {"sun"}, {{}, {{"sun", 3.0}}});
  expect_free_motion(test::rubbing_rack(), {"beam", "guide"}, {{}, {{"beam", 0.5}}});
  expect_free_motion(test::rubbing_rollers(), {"cam", "wheel"}, {{}, {{"cam", 6.0}, {"wheel", 3.0}}});
}

// Teeth press both shafts: the weight moves beyond the torques up to which statics proves that it is held.
TEST(BearingLoads, AHoistMovesWhereItIsNotHeld) {
  Scene scene = resisted_by_joints(read_scene(test::dataset("friction/hoist.toml")));
  for (int body = 1; body <= 2; ++body) {
    scene.bodies[static_cast<std::size_t>(body)].mass = body;
    scene.bodies[static_cast<std::size_t>(body)].inertia = 0.01 * body;
  }
  for (const auto& [torque, sense] : {std::pair{46841.3, -1}, {46841.6, 0}, {53221.3, 0}, {53221.6, 1}}) {
    set_value(scene, "load.M", torque);
    const MotionModel model(scene);
    const Motion motion = test::moved(model, start_motion(model, {}), 0.2);
    const auto pinion = static_cast<std::size_t>(test::coordinate_of(model, "pinion"));
    const double rate = test::v_at(motion, motion.trajectory.nodes() - 1)[pinion];
    EXPECT_EQ(rate > 1e-6 ? 1 : rate < -1e-6 ? -1 : 0, sense) << torque << ": " << rate;
  }
}

// Two pairs of teeth side by side share their force in no way that is known.
TEST(BearingLoads, TeethThatRepeatEachOtherLeaveThePinsOpen) {
  const std::string twice =
      wheels("ratio = 0.25", 1.0, "[[gear]]\nname = \"second\"\nbodies = [\"a\", \"b\"]\nratio = 0.25\nphase = 0\n");
  const MotionModel model = model_of(twice);
  const std::string message = test::message_of([&] {
    test::moved(model, test::released(model, {{}, {{"a", 1.0}}}), 0.1);
  });
  EXPECT_NE(message.find("pin \"A\".friction: the mechanism is statically indeterminate"), std::string::npos)
      << message;
}

}  // namespace
}  // namespace poise::bearing_loads_test

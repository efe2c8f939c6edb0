// Geneva drives against the geometry of a pin in a slot.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/profile.hpp"
#include "model/text_file.hpp"
#include "motion/kinematics.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"

namespace poise::geneva_test {
namespace {

using std::numbers::pi;

constexpr double crank_inertia = 3e-4, wheel_inertia = 2e-4;

std::string drive_of(int slots, const std::string& more) {
  return fmt::format(R"(
[ground]
points = {{ A = [0, 0], B = [0.04, 0.03] }}
[body.crank]
points = {{ A = [0, 0] }}
inertia = {1}
[body.wheel]
points = {{ B = [0, 0] }}
inertia = {2}
[[pin]]
name = "A"
points = ["ground.A", "crank.A"]
[[pin]]
name = "B"
points = ["ground.B", "wheel.B"]
[[geneva]]
name = "indexer"
bodies = ["crank", "wheel"]
slots = {0}
{3}
)",
                     slots, crank_inertia, wheel_inertia, more);
}

/// Of the wheel, clockwise from where the pin is on the line of the axes, by the angle of the crank from there.
struct Turned {
  double angle, by_crank, bend;
};

/// Trigonometry gives it: the pin is at r (cos f, sin f) from the crank's axis, and the slot goes from the wheel's axis
/// at c to it.
Turned turned(int slots, double crank) {
  const double step = 2 * pi / slots, k = std::sin(pi / slots);
  const double turns = std::round(crank / (2 * pi)), f = crank - 2 * pi * turns;
  if (std::cos(f) <= k) return {step * (turns + std::copysign(0.5, f)), 0.0, 0.0};
  const double square = 1 - 2 * k * std::cos(f) + k * k;
  return {step * turns + std::atan2(k * std::sin(f), 1 - k * std::cos(f)), k * (std::cos(f) - k) / square,
          -k * (1 - k * k) * std::sin(f) / (square * square)};
}

TEST(Geneva, TheWheelFollowsThePinInItsSlot) {
  for (const int slots : {3, 4, 5, 6, 12}) {
    SCOPED_TRACE(slots);
    constexpr double phase = 0.7, offset = 0.2, rate = 11.0, turns = 3.0;
    const Scene scene = parse_scene(
        drive_of(slots, fmt::format("phase = {}\noffset = {}\n[start]\ncrank = -2.5\n", phase, offset)), "scene.toml");
    const KinematicsResult swept =
        sweep(scene, {{.name = "crank", .from = phase - pi, .to = phase - pi + 2 * pi * turns}},
              {.steps = 600, .rate = rate});
    ASSERT_TRUE(swept.complete) << swept.why;
    double fastest = 0.0;
    for (const KinematicSample& sample : swept.samples) {
      const double crank = sample.drive[0] - phase;
      const Turned known = turned(slots, crank);
      EXPECT_NEAR(sample.bodies[2].pose.angle, offset - known.angle, 1e-12);
      EXPECT_NEAR(sample.bodies[2].rate, -known.by_crank * rate, 1e-11 * rate);
      fastest = std::max(fastest, std::abs(sample.bodies[2].rate) / rate);
      // At the ends of the slot either side is right.
      if (std::abs(std::cos(crank) - std::sin(pi / slots)) < 1e-6) continue;
      EXPECT_NEAR(sample.bodies[2].angular_acceleration, -known.bend * rate * rate, 1e-9 * rate * rate);
    }
    // The middle of the slot is a sample.
    const double k = std::sin(pi / slots);
    EXPECT_NEAR(fastest, k / (1 - k), 1e-12);
    EXPECT_NEAR(swept.samples.back().bodies[2].pose.angle - swept.samples.front().bodies[2].pose.angle,
                -turns * 2 * pi / slots, 1e-12);
  }
}

// Where the pin enters, the slot has the direction in which the pin moves, so that the wheel's rate is zero; its
// acceleration jumps from zero to w^2 tan(pi / n). It is greatest where psi''' = 0:  2 k x^2 + (1 + k^2) x = 4 k,  x =
// cos f.
TEST(Geneva, AccelerationsJumpAndAreGreatestWhereTheyShouldBe) {
  for (const int slots : {3, 4, 5, 6, 9}) {
    SCOPED_TRACE(slots);
    const double k = std::sin(pi / slots), b = 1 + k * k;
    const double greatest = -turned(slots, std::acos((std::sqrt(b * b + 32 * k * k) - b) / (4 * k))).bend;
    const Profile profile = Profile::geneva(slots);
    const double unit = slots * 2 * pi;  // of P'' over that of the wheel's angle by the crank's:  n / (2 pi) (2 pi)^2
    const double in_slot = std::acos(std::sin(pi / slots)) / (2 * pi);
    const ProfileValue<double> before = profile.at(1 - in_slot - 1e-12), after = profile.at(1 - in_slot + 1e-12);
    EXPECT_EQ(before.second, 0.0);
    EXPECT_NEAR(after.second / unit, std::tan(pi / slots), 1e-9);
    EXPECT_NEAR(after.first, 0.0, 1e-9);
    double most = 0.0;
    for (int i = 0; i <= 100000; ++i) most = std::max(most, std::abs(profile.at(i / 100000.0).second) / unit);
    EXPECT_NEAR(most, greatest, 1e-6 * greatest);
  }
}

// Driven at w against a torque M on the wheel: the power of the drive is that of M and what the wheel's inertia takes,
//   T = (M + J psi'' w^2) psi'.
TEST(Geneva, ADriveCarriesTheWheelAndItsLoad) {
  constexpr double w = 20.0, load = 0.3;
  for (const int slots : {3, 4, 8}) {
    SCOPED_TRACE(slots);
    const MotionModel model(parse_scene(drive_of(slots, fmt::format(R"([[drive]]
name = "motor"
bodies = ["ground", "crank"]
rate = {}
start = -2
[[torque]]
name = "M"
on = "wheel"
value = {}
[start]
crank = -2
)",
                                                                    w, load)),
                                        "scene.toml"));
    const Motion motion = test::moved(model, test::released(model, {}), 0.9);
    EXPECT_LT(motion.energy_error, 1e-10);
    const auto wheel = static_cast<std::size_t>(test::coordinate_of(model, "wheel"));
    const double start = turned(slots, -2.0).angle;
    const double in_slot = std::acos(std::sin(pi / slots));
    int entries = 0;
    const Trajectory& path = motion.trajectory;
    for (std::size_t n = 0; n < path.nodes(); ++n) {
      const double crank = w * path.t[n] - 2.0;
      const Turned known = turned(slots, crank);
      const double end = std::abs(std::remainder(crank, 2 * pi)) - in_slot;
      EXPECT_NEAR(test::q_at(motion, n)[wheel], start - known.angle, 5e-11);
      EXPECT_NEAR(test::v_at(motion, n)[wheel], -known.by_crank * w, 1e-8);
      if (n > 0 && path.t[n] == path.t[n - 1] && std::abs(end) < 1e-9) ++entries;
      if (std::abs(end) < 1e-9) continue;
      EXPECT_NEAR(motion.drive_force[0][n], (load + wheel_inertia * known.bend * w * w) * known.by_crank, 1e-8);
    }
    // 18 rad: steps end where the pin enters and leaves, twice a turn.
    EXPECT_EQ(entries, slots == 3 ? 6 : entries);
    EXPECT_GE(entries, 5);
  }
}

// A crank that is free, spun once: (J + J_wheel psi'^2) rate^2 is constant, over many turns and back.
TEST(Geneva, AFreeCrankKeepsItsEnergy) {
  for (const double rate : {30.0, -30.0}) {
    const MotionModel model(parse_scene(drive_of(4, "[start]\ncrank = 1.5\n"), "scene.toml"));
    const Motion motion = test::moved(model, test::released(model, {{}, {{"crank", rate}}}), 2.0);
    EXPECT_LT(motion.energy_error, 1e-9);
    const auto crank = static_cast<std::size_t>(test::coordinate_of(model, "crank"));
    const double start = turned(4, 1.5).by_crank;
    const double energy = (crank_inertia + wheel_inertia * start * start) * rate * rate;
    double slowest = std::abs(rate);
    for (std::size_t n = 0; n < motion.trajectory.nodes(); ++n) {
      const double slope = turned(4, test::q_at(motion, n)[crank]).by_crank, v = test::v_at(motion, n)[crank];
      EXPECT_NEAR((crank_inertia + wheel_inertia * slope * slope) * v * v, energy, 1e-9 * energy);
      slowest = std::min(slowest, std::abs(v));
    }
    const double most = 1 + std::sqrt(2.0);  // k / (1 - k)
    EXPECT_NEAR(slowest, std::sqrt(energy / (crank_inertia + wheel_inertia * most * most)), 0.02 * slowest);
  }
}

// k (free - crank) = -M psi'(crank - phase): a spring on the crank holds a torque M on the wheel that would turn it
// clockwise, as the crank does.
TEST(Geneva, ASpringOnTheCrankHoldsTheWheel) {
  constexpr double stiffness = 2.0, load = -0.4, free_angle = 0.3, phase = 0.1;
  const Scene scene = parse_scene(drive_of(5, fmt::format(R"(phase = {}
offset = 0
[[torsion_spring]]
name = "holder"
bodies = ["ground", "crank"]
stiffness = {}
free_angle = {}
[[torque]]
name = "M"
on = "wheel"
value = {}
[start]
crank = 0.3
)",
                                                          phase, stiffness, free_angle, load)),
                                  "scene.toml");
  double crank = free_angle;
  double slope = 0.0;
  for (int k = 0; k < 50; ++k) {
    const Turned now = turned(5, crank - phase);
    slope = stiffness + load * now.bend;
    crank -= (stiffness * (crank - free_angle) + load * now.by_crank) / slope;
  }
  const StaticModel model(scene);
  for (const Method method : {Method::virtual_work, Method::energy}) {
    const Equilibrium found = solve(model, test::by(method, Seek::stable));
    EXPECT_EQ(found.status, Status::confirmed) << found.why;
    const double near = method == Method::virtual_work ? 1e-12 : 1e-7;
    EXPECT_NEAR(test::angle_of(model, found.x, "crank"), crank, near);
    EXPECT_NEAR(test::angle_of(model, found.x, "wheel"), -turned(5, crank - phase).angle, near);
    EXPECT_EQ(test::reaction_of(found.check, "indexer").kind, "geneva");
    EXPECT_NEAR(std::abs(test::reaction_of(found.check, "indexer").moment), std::abs(load), 1e-7);
  }
  // d crank / d phase = M psi'' / slope; the offset moves the wheel alone.
  const Sensitivities by =
      sensitivities(model, {find_quantity(scene, "angle.crank"), find_quantity(scene, "angle.wheel")});
  ASSERT_EQ(by.of.size(), 2U) << by.why;
  const auto derivative = [&](std::size_t of, const std::string& number) {
    for (const Sensitivity& one : by.of[of].by) {
      if (one.number == number) return one.derivative;
    }
    return std::nan("");
  };
  EXPECT_NEAR(derivative(0, "geneva.indexer.phase"), load * turned(5, crank - phase).bend / slope, 1e-9);
  EXPECT_NEAR(derivative(0, "geneva.indexer.offset"), 0.0, 1e-12);
  EXPECT_NEAR(derivative(1, "geneva.indexer.offset"), 1.0, 1e-12);
}

// While the pin is out of the slots the locking disc carries the wheel's load, and the crank none of it.
TEST(Geneva, AWheelThatDwellsIsLocked) {
  const Scene scene = parse_scene(drive_of(4, R"([[torsion_spring]]
name = "holder"
bodies = ["ground", "crank"]
stiffness = 2
free_angle = 2
[[torque]]
name = "M"
on = "wheel"
value = 100
[start]
crank = 1.9
wheel = 0.5
)"),
                                  "scene.toml");
  const StaticModel model(scene);
  const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::stable));
  EXPECT_EQ(found.status, Status::confirmed) << found.why;
  EXPECT_NEAR(test::angle_of(model, found.x, "crank"), 2.0, 1e-12);
  EXPECT_NEAR(test::angle_of(model, found.x, "wheel"), 0.5, 1e-12);  // where [start] puts it
  EXPECT_NEAR(std::abs(test::reaction_of(found.check, "indexer").moment), 100.0, 1e-9);
}

TEST(Geneva, IsTheSameInAPartThatIsTurnedAndMirrored) {
  const std::string file = test::dataset("machines/main.toml").string();
  const auto angles_of = [&](const std::string& text, const std::string& part, double from, double to) {
    const Scene scene = parse_scene(text, file);
    const KinematicsResult out = sweep(scene, {{.name = part + "crank", .from = from, .to = to}}, {.steps = 90});
    EXPECT_TRUE(out.complete) << out.why;
    const auto wheel = static_cast<std::size_t>(std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                                             [&](const Body& b) { return b.name == part + "wheel"; }) -
                                                scene.bodies.begin());
    std::vector<double> angles;
    for (const KinematicSample& sample : out.samples) angles.push_back(sample.bodies[wheel].pose.angle);
    return angles;
  };
  const std::string own = read_text_file(test::dataset("machines/geneva.toml"));
  const std::vector<double> alone = angles_of(own, "", pi, pi + 7);
  const std::vector<double> mirrored = angles_of(
      "[[part]]\nname = \"P\"\nfile = \"geneva.toml\"\nangle = 0.4\nmirror = true\n", "P.", 0.4 - pi, 0.4 - pi - 7);
  ASSERT_EQ(alone.size(), mirrored.size());
  EXPECT_LT(alone.back(), alone.front() - 1.0);
  for (std::size_t k = 0; k < alone.size(); ++k) {
    EXPECT_NEAR(mirrored[k] - mirrored[0], alone[0] - alone[k], 1e-11);
  }
}

TEST(Geneva, SaysWhatIsWrongWithItsTable) {
  const auto with = [](const std::string& table) {
    return test::message_of([&] {
      parse_scene(
          "[ground]\npoints = { A = [0, 0] }\n[body.a]\npoints = { A = [0, 0] }\n[body.b]\npoints = { B = [0, 0] }\n"
          "[[geneva]]\n" +
              table,
          "scene.toml");
    });
  };
  const std::string bodies = "bodies = [\"a\", \"b\"]\n";
  EXPECT_EQ(with(bodies),
            "scene.toml:7: geneva 1: expected the key slots, the number of slots of the wheel; add slots = 4");
  EXPECT_NE(with(bodies + "slots = 2").find("3"), std::string::npos);
  EXPECT_NE(with(bodies + "slots = 4.5").find("whole number"), std::string::npos);
  EXPECT_NE(with(bodies + "slots = 1000").find("from 3 to 360, found 1000"), std::string::npos);
  EXPECT_NE(with(bodies + "slots = 4\ncarrier = \"a\"").find("carries both wheels"), std::string::npos);
  EXPECT_NE(with(bodies + "slots = 4\nratio = 2").find("ratio"), std::string::npos);
}

}  // namespace
}  // namespace poise::geneva_test

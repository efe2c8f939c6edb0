// Motion across the borders of the pieces of profiles.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/motions.hpp"
#include "tests/support/seed.hpp"

namespace poise::profile_borders_test {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

/// A valve of 0.12 kg on a spring of 40 N/mm, lifted by 9 mm between the angles rise and top, let down until shut.
std::string valve(const std::string& law, double rise, double top, double shut, double phase, const std::string& more) {
  return fmt::format(R"(
[ground]
points = {{ O = [0, 0], S = [0, -0.08] }}
[body.cam]
points = {{ O = [0, 0] }}
inertia = 5e-4
[body.valve]
points = {{ T = [0, 0], B = [0, -0.03] }}
mass = 0.12
[[pin]]
name = "camshaft"
points = ["ground.O", "cam.O"]
[[slide]]
name = "guide"
points = ["ground.O", "valve.T"]
axis = [0, -1]
[[cam]]
name = "lobe"
bodies = ["ground", "cam"]
follower = {{ slide = "guide" }}
law = [{{ to = {1}, lift = 0, law = "dwell" }}, {{ to = {2}, lift = 1, law = "{0}" }}, {{ to = {3}, lift = 0, law = "{0}" }},
       {{ to = 6.283185307179586, law = "dwell" }}]
lift = 0.009
base = 0.016
phase = {4}
guided = true
[[spring]]
name = "valve spring"
points = ["ground.S", "valve.B"]
stiffness = 4e4
free_length = 0.06
{5}
)",
                     law, rise, top, shut, phase, more);
}

constexpr const char* engine = R"(
[[drive]]
name = "engine"
bodies = ["ground", "cam"]
start = 0
rate = 200
[start]
guide = 0.016
)";

// Follower and torque of the shaft: x = b + l P(u), T = (F(x) + m x'') dx/da, with F of the spring against the travel.
TEST(ProfileBorders, AValveFollowsItsLawAndTheShaftCarriesIt) {
  const double rise = 2.0, top = 3.0, shut = 4.1, omega = 200;
  for (const std::string law : {"harmonic", "cycloidal", "polynomial_345"}) {
    const MotionModel model(parse_scene(valve(law, rise, top, shut, 0.0, engine), "test"));
    const Motion motion = test::moved(model, test::released(model, {}), 0.1);
    EXPECT_LT(motion.energy_error, 1e-9) << law;
    const Profile profile(
        {Profile::standard("dwell", 0, rise / two_pi, 0, 0), Profile::standard(law, rise / two_pi, top / two_pi, 0, 1),
         Profile::standard(law, top / two_pi, shut / two_pi, 1, 0), Profile::standard("dwell", shut / two_pi, 1, 0, 0)},
        true);
    std::vector<double> times;
    for (int k = 1; k < 400; ++k) times.push_back(0.1 * k / 400.0);
    const std::vector<test::Reading> read = test::read_at(motion, times);
    const auto guide = static_cast<std::size_t>(test::coordinate_of(model, "guide"));
    double apart = 0.0, rate_apart = 0.0;
    for (std::size_t k = 0; k < times.size(); ++k) {
      const ProfileValue<double> p = profile.at(omega * times[k] / two_pi);
      apart = std::max(apart, std::abs(read[k].q[guide] - (0.016 + 0.009 * p.value)));
      rate_apart = std::max(rate_apart, std::abs(read[k].v[guide] - 0.009 * p.first * omega / two_pi));
    }
    EXPECT_LT(apart, 1e-12) << law;
    EXPECT_LT(rate_apart, 1e-8) << law;
    // At nodes, of which two stand at each border.
    const Trajectory& path = motion.trajectory;
    int borders = 0;
    for (std::size_t n = 0; n < path.nodes(); ++n) {
      borders += n > 0 && path.t[n] == path.t[n - 1] ? 1 : 0;
      const double u = omega * path.t[n] / two_pi;
      const double at_border = std::abs(u - std::round(u));
      if (std::any_of(profile.pieces().begin(), profile.pieces().end(), [&](const Profile::Piece& piece) {
            return std::abs(u - std::floor(u) - piece.from) < 1e-9 || at_border < 1e-9;
          })) {
        continue;
      }
      const ProfileValue<double> p = profile.at(u);
      const double x = 0.016 + 0.009 * p.value, by_angle = 0.009 * p.first / two_pi;
      const double inertia = 0.12 * 0.009 * p.second * (omega / two_pi) * (omega / two_pi);
      // The spring is compressed by 0.06 - (0.08 - 0.03 - x), and pushes the valve back.
      const double spring = 4e4 * (0.06 - (0.05 - x));
      EXPECT_NEAR(motion.drive_force[0][n], (spring + inertia) * by_angle, 1e-7) << law << " at " << u;
    }
    EXPECT_GE(borders, 9) << law;
  }
}

// Laws of all kinds, parts down to a degree, phases and rates of both signs; turned by its own inertia alone the cam
// may be stopped by the spring and turn back, anywhere in the law.
TEST(ProfileBorders, RandomCamsBalanceTheirEnergy) {
  std::mt19937 random(static_cast<unsigned>(test::seed(3)));
  const auto any = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  for (int k = 0; k < 150; ++k) {
    double angles[3] = {any(0.3, 6.0), any(0.3, 6.0), any(0.3, 6.0)};
    std::sort(angles, angles + 3);
    for (int i = 1; i < 3; ++i) angles[i] = std::max(angles[i], angles[i - 1] + 0.02);
    const std::string law = std::vector<std::string>{"harmonic", "cycloidal", "polynomial_345"}[random() % 3];
    const bool is_driven = k % 2 == 0;
    const std::string start = fmt::format("[start]\ncam = {}\nguide = 0.016\n", any(-3, 3));
    const double acceleration = any(-2000, 2000);
    const std::string drive =
        fmt::format("[[drive]]\nname = \"engine\"\nbodies = [\"ground\", \"cam\"]\nrate = {}\nacceleration = {}\n",
                    any(-200, 200), acceleration);
    const MotionModel model(
        parse_scene(valve(law, angles[0], angles[1], angles[2], any(-3, 3), (is_driven ? drive : "") + start), "test"));
    const test::Release release = is_driven ? test::Release{} : test::Release{{}, {{"cam", any(-200, 200)}}};
    const Motion motion = test::moved(model, test::released(model, release), 0.06);
    EXPECT_LT(motion.energy_error, 1e-8) << k << " " << law;
    EXPECT_LT(motion.steps, 5000) << k << " " << law;
  }
}

}  // namespace
}  // namespace poise::profile_borders_test

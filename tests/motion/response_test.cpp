// The response to a number that swings against closed forms, and against the equations of ReducedMotion.

#include "motion/response.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "motion/equilibrium_pose.hpp"
#include "motion/reduced_motion.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/seed.hpp"

namespace poise::response_test {
namespace {

using Complex = std::complex<double>;
using Kind = Resonance::Kind;

/// About the equilibrium next to the start.
struct About {
  About(const Scene& given, const std::string& excited, const std::string& of)
      : scene(scene_at_rest(given)), statics(scene), model(scene), excitation(excitation_of(scene, excited)) {
    const Equilibrium equilibrium = solve(statics);
    why = equilibrium.found() ? "" : equilibrium.why;
    x = motion_coordinates(model, statics, equilibrium.x);
    quantity = find_quantity(scene, of, AskedOf::motion);
    response = std::make_unique<FrequencyResponse>(model, x, excitation, quantity);
  }

  Complex at(double frequency) const { return response->at(frequency); }

  Scene scene;
  StaticModel statics;
  MotionModel model;
  Excitation excitation;
  SoughtQuantity quantity;
  std::vector<double> x;
  std::string why;  ///< there is no equilibrium
  std::unique_ptr<FrequencyResponse> response;
};

Scene scene_of(const std::string& text) { return test::model_of(text).scene(); }

/// A mass of 2 kg on a spring of 50 N/m, w = 5 rad/s, with a damper.
std::string machine(double coefficient) {
  std::string text = R"(
[ground]
points = { O = [0, 0] }
[body.table]
points = { P = [0, 0] }
mass = 2
[[slide]]
name = "guide"
points = ["ground.O", "table.P"]
axis = [0, 1]
[[spring]]
name = "mount"
slide = "guide"
stiffness = 50
free_length = 0
[[force]]
name = "P"
at = "table.P"
direction = [0, 1]
size = 0
)";
  if (coefficient > 0) {
    text += "[[damper]]\nname = \"film\"\nslide = \"guide\"\ncoefficient = " + std::to_string(coefficient) + "\n";
  }
  return text;
}

/// The machine without damper, with an absorber of 0.2 kg on it, tuned to `stiffness`.
std::string with_absorber(double stiffness, double coefficient) {
  return machine(0) + R"(
[body.absorber]
points = { Q = [0, 0] }
mass = 0.2
[[slide]]
name = "second"
points = ["table.P", "absorber.Q"]
axis = [0, 1]
[[spring]]
name = "leaf"
slide = "second"
free_length = 0
stiffness = )" +
         std::to_string(stiffness) +
         (coefficient > 0
              ? "\n[[damper]]\nname = \"oil\"\nslide = \"second\"\ncoefficient = " + std::to_string(coefficient) + "\n"
              : "\n");
}

std::vector<Resonance> of_kind(const std::vector<Resonance>& all, Kind kind) {
  std::vector<Resonance> out;
  for (const Resonance& one : all) {
    if (one.kind == kind) out.push_back(one);
  }
  return out;
}

TEST(Response, OneMassHasItsClosedForm) {
  constexpr double m = 2, k = 50, c = 4;
  const About about(scene_of(machine(c)), "load.P", "y.table.P");
  for (const double f : {0.01, 0.3, 5 / (2 * M_PI), 1.0, 7.0, 300.0}) {
    const Complex s(0, 2 * M_PI * f);
    const Complex expected = 1.0 / (m * s * s + c * s + k);
    EXPECT_NEAR(std::abs(about.at(f) - expected), 0.0, 1e-14 * std::abs(expected)) << f;
  }
  // Largest at w sqrt(1 - 2 z^2), F/k / (2 z sqrt(1 - z^2)); at w the phase is -90 degrees.
  constexpr double z = 0.2;
  const std::vector<Resonance> found = about.response->resonances(0.01, 10);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, Kind::peak);
  EXPECT_EQ(found[0].mode, 0);
  EXPECT_NEAR(found[0].frequency, 5 * std::sqrt(1 - 2 * z * z) / (2 * M_PI), 1e-9);
  EXPECT_NEAR(std::abs(found[0].value), 1 / k / (2 * z * std::sqrt(1 - z * z)), 1e-15);
  EXPECT_NEAR(std::arg(about.at(5 / (2 * M_PI))), -M_PI / 2, 1e-14);
}

TEST(Response, ForceOfTheMountIsTransmitted) {
  constexpr double m = 2, k = 50, c = 4;
  const About about(scene_of(machine(c)), "load.P", "force.mount + force.film");
  for (const double f : {0.1, 0.9, 4.0}) {
    const Complex s(0, 2 * M_PI * f);
    const Complex expected = (k + c * s) / (m * s * s + c * s + k);
    EXPECT_NEAR(std::abs(about.at(f) - expected), 0.0, 1e-13) << f;
  }
}

// Shaken at the foot of its spring, the mass moves by k / (m s^2 + c s + k); the force of the spring sees the foot too.
TEST(Response, FreeLengthShakesTheFoot) {
  constexpr double m = 2, k = 50, c = 4;
  const Scene scene = scene_of(machine(c));
  const About mass(scene, "spring.mount.free_length", "y.table.P");
  const About force(scene, "spring.mount.free_length", "force.mount");
  const About rate(scene, "spring.mount.free_length", "d(y.table.P)/dt");
  for (const double f : {0.1, 0.9, 4.0}) {
    const Complex s(0, 2 * M_PI * f);
    const Complex expected = k / (m * s * s + c * s + k);
    EXPECT_NEAR(std::abs(mass.at(f) - expected), 0.0, 1e-13) << f;
    EXPECT_NEAR(std::abs(force.at(f) - k * (expected - 1.0)), 0.0, 1e-12) << f;
    EXPECT_NEAR(std::abs(rate.at(f) - s * expected), 0.0, 1e-12) << f;
  }
}

// Two masses that only a spring joins: above 0 Hz both move, at 0 Hz nothing holds them.
TEST(Response, WhatNothingHoldsHasNoStaticResponse) {
  std::string text = with_absorber(4.2, 0);
  const std::size_t mount = text.find("[[spring]]\nname = \"mount\"");
  text.erase(mount, text.find("[[force]]") - mount);
  const About about(scene_of(text), "load.P", "y.table.P");
  ASSERT_EQ(about.why, "");
  EXPECT_TRUE(std::isnan(about.at(0.0).real()));
  const double square = std::pow(2 * M_PI * 0.2, 2);
  EXPECT_NEAR(about.at(0.2).real(), (4.2 - 0.2 * square) / (-square * (2.2 * 4.2 - 0.4 * square)), 1e-10);
}

TEST(Response, UndampedResonanceIsUnbounded) {
  const About about(scene_of(machine(0)), "load.P", "y.table.P");
  const std::vector<Resonance> found = about.response->resonances(0.1, 10);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, Kind::unbounded);
  EXPECT_EQ(found[0].mode, 0);
  EXPECT_NEAR(found[0].frequency, 5 / (2 * M_PI), 1e-14);
  EXPECT_FALSE(std::isfinite(std::abs(found[0].value)));
  EXPECT_TRUE(about.response->is_undamped());
  EXPECT_EQ(about.at(3.0).imag(), 0.0);
}

// J. P. Den Hartog, "Mechanical Vibrations", chapter 3: at the absorber's own frequency the machine rests.
TEST(Response, AbsorberStopsItsMachine) {
  const double stiffness = 4.2;
  const About about(scene_of(with_absorber(stiffness, 0)), "load.P", "y.table.P");
  const std::vector<Resonance> found = about.response->resonances(0.1, 10);
  const std::vector<Resonance> rests = of_kind(found, Kind::rest);
  ASSERT_EQ(rests.size(), 1U);
  EXPECT_NEAR(rests[0].frequency, std::sqrt(stiffness / 0.2) / (2 * M_PI), 1e-12);
  // Both natural frequencies: 2 (50 + k - 2 w^2) ... of the characteristic equation.
  ASSERT_EQ(of_kind(found, Kind::unbounded).size(), 2U);
  for (const Resonance& one : of_kind(found, Kind::unbounded)) {
    const double square = std::pow(2 * M_PI * one.frequency, 2);
    EXPECT_NEAR((50 + stiffness - 2 * square) * (stiffness - 0.2 * square), stiffness * stiffness, 1e-10);
  }
  const double square = std::pow(2 * M_PI * 0.5, 2);
  const double expected =
      (stiffness - 0.2 * square) / ((50 + stiffness - 2 * square) * (stiffness - 0.2 * square) - stiffness * stiffness);
  EXPECT_NEAR(about.at(0.5).real(), expected, 1e-14);
}

// A damped absorber: two peaks and a trough, and whatever its damping the response passes two points (Den Hartog).
TEST(Response, DampedAbsorberHasTwoPeaksAndPassesTheFixedPoints) {
  constexpr double mu = 0.1, stiffness = 50 * mu / (1.1 * 1.1);
  const double coefficient = 2 * 0.2 * 5 * std::sqrt(3 * mu / (8 * std::pow(1 + mu, 3)));
  const About about(scene_of(with_absorber(stiffness, coefficient)), "load.P", "y.table.P");
  const std::vector<Resonance> found = about.response->resonances(0.1, 10);
  EXPECT_EQ(of_kind(found, Kind::peak).size(), 2U);
  EXPECT_EQ(of_kind(found, Kind::least).size(), 1U);
  // Tuned so, both points are sqrt(1 + 2/mu) F/k high, at g^2 = 1 / (1 + mu) (1 -+ sqrt(mu / (2 + mu))).
  for (const double sign : {-1.0, 1.0}) {
    const double g = std::sqrt((1 + sign * std::sqrt(mu / (2 + mu))) / (1 + mu));
    EXPECT_NEAR(std::abs(about.at(5 * g / (2 * M_PI))), std::sqrt(1 + 2 / mu) / 50, 1e-7) << sign;
  }
  for (const Resonance& one : found) {
    const double step = 1e-5 * one.frequency, here = std::abs(one.value);
    const double sign = one.kind == Kind::peak ? 1 : -1;
    EXPECT_LT(sign * std::abs(about.at(one.frequency - step)), sign * here);
    EXPECT_LT(sign * std::abs(about.at(one.frequency + step)), sign * here);
  }
}

// Nothing joins two machines: neither answers to the load of the other, nor is unbounded for it.
TEST(Response, WhatIsNotReachedRests) {
  const std::string pair = machine(0) + R"(
[body.other]
points = { P = [0, 0] }
mass = 2
[[slide]]
name = "beside"
points = ["ground.O", "other.P"]
axis = [0, 1]
[[spring]]
name = "its mount"
slide = "beside"
stiffness = 50
free_length = 0
)";
  const About one(scene_of(pair), "load.P", "y.table.P");
  EXPECT_EQ(of_kind(one.response->resonances(0.1, 10), Kind::unbounded).size(), 1U);
  const About other(scene_of(pair), "load.P", "y.other.P");
  EXPECT_TRUE(other.response->resonances(0.1, 10).empty());
  EXPECT_EQ(std::abs(other.at(1.0)), 0.0);
}

TEST(Response, AbsorberOnASymmetricTableIsSilent) {
  const std::string text = R"(
[ground]
points = { O = [0, 0], A = [-1, 0], B = [1, 0] }
[body.left]
points = { P = [0, 0] }
mass = 1
[body.right]
points = { P = [0, 0] }
mass = 1
[body.table]
points = { P = [0, 0] }
mass = 3
[[slide]]
name = "guide"
points = ["ground.O", "table.P"]
axis = [0, 1]
[[slide]]
name = "one"
points = ["table.P", "left.P"]
axis = [0, 1]
[[slide]]
name = "two"
points = ["table.P", "right.P"]
axis = [0, 1]
[[spring]]
name = "mount"
slide = "guide"
stiffness = 50
free_length = 0
[[spring]]
name = "first leaf"
slide = "one"
stiffness = 9
free_length = 0
[[spring]]
name = "second leaf"
slide = "two"
stiffness = 9
free_length = 0
[[force]]
name = "P"
at = "table.P"
direction = [0, 1]
size = 0
[[force]]
name = "L"
at = "left.P"
direction = [0, 1]
size = 0
)";
  const Scene scene = scene_of(text);
  const About table(scene, "load.P", "y.table.P");
  const std::vector<SilentMode> silent = table.response->silent_modes();
  ASSERT_EQ(silent.size(), 1U);
  EXPECT_FALSE(silent[0].is_driven);
  const double frequency = table.response->modes().vibrations[static_cast<std::size_t>(silent[0].mode)].frequency;
  EXPECT_NEAR(frequency, 3 / (2 * M_PI), 1e-12);  // the leaves swing against each other
  const About from_left(scene, "load.L", "y.table.P");
  ASSERT_EQ(from_left.response->silent_modes().size(), 1U);
  EXPECT_TRUE(from_left.response->silent_modes()[0].is_driven);
  EXPECT_FALSE(from_left.response->silent_modes()[0].is_seen);
  for (const About* about : {&table, &from_left}) {
    EXPECT_EQ(of_kind(about->response->resonances(0.1, 10), Kind::unbounded).size(), 2U);
  }
}

TEST(Response, RefusesWhatHasNone) {
  const Scene scene = scene_of(machine(4));
  for (const auto& [path, words] :
       {std::pair("body.table.mass", "nothing swings with it"), std::pair("damper.film.coefficient", "nothing swings"),
        std::pair("load.Q", "load.P")}) {
    const std::string message = test::message_of([&, name = path] { excitation_of(scene, name); });
    EXPECT_NE(message.find(words), std::string::npos) << message;
  }
  const std::string message = test::message_of(
      [&] { refuse_without_response(scene, find_quantity(scene, "reaction.guide", AskedOf::motion)); });
  EXPECT_NE(message.find("its response is not known; expected"), std::string::npos) << message;
  Scene without = scene;
  without.forces[0].along = {};
  EXPECT_NE(test::message_of([&] { excitation_of(without, "load.P"); }).find("direction"), std::string::npos);
}

// What figure 2 of the lift paper was of, by closed forms.
TEST(Response, LinkAfOfTheLiftVibratesAsItsClosedForms) {
  const nlohmann::json known = test::read_json(test::dataset("lift_response.json"));
  int compared = 0;
  for (const nlohmann::json& entry : known.at("entries")) {
    // [start] and free length of the scene are those of half the stroke.
    if (entry.at("frac") != 0.5) continue;
    SCOPED_TRACE(entry.dump());
    ++compared;
    Scene scene = read_scene(test::dataset("lift.toml"));
    set_value_at(scene, parameter(scene, "body.payload.mass").place, entry.at("payload").get<double>());
    set_value_at(scene, parameter(scene, "spring.oil.free_length").place, entry.at("free_length").get<double>());
    const About about(scene, "spring.oil.free_length", "angle.fa");
    const Vibration& mode = about.response->modes().vibrations.at(0);
    EXPECT_NEAR(mode.frequency, entry.at("f_Hz").get<double>(), 1e-8);
    EXPECT_NEAR(mode.damping_ratio, entry.at("zeta").get<double>(), 1e-9);
    const auto part = [&](const std::string& body) {
      const auto& all = about.model.layout().coordinates;
      const auto found = std::find_if(all.begin(), all.end(), [&](const Coordinate& one) { return one.name == body; });
      return mode.shape[static_cast<std::size_t>(found - all.begin())].real();
    };
    EXPECT_NEAR(part("fa") / part("obd"), entry.at("dfa_dq").get<double>(), 1e-9);
    const std::vector<Resonance> found = about.response->resonances(0.1, 50);
    ASSERT_EQ(found.size(), 1U);
    std::vector<nlohmann::json> at = entry.at("at");
    at.push_back(entry.at("peak"));
    EXPECT_NEAR(found[0].frequency, at.back().at("f_Hz").get<double>(), 1e-8);
    for (const nlohmann::json& one : at) {
      const Complex value = about.at(one.at("f_Hz").get<double>());
      EXPECT_NEAR(std::abs(value), one.at("amplitude").get<double>(), 1e-7 * std::abs(value));
      EXPECT_NEAR(std::arg(value) * 180 / M_PI, one.at("phase_deg").get<double>(), 1e-5);
    }
  }
  EXPECT_EQ(compared, 3);
}

/// A random mechanism with inertia and damping everywhere.
Scene weighty_scene(std::uint64_t seed, bool followers) {
  Scene scene = test::plant_mechanism(seed, {.loops = static_cast<int>(seed % 3), .followers = followers}).scene;
  test::Random random(seed);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    Body& body = scene.bodies[i];
    if (body.inertia == 0.0) body.inertia = 0.1 + random.uniform(0.0, 1.0);
    Element& damper = scene.elements.emplace_back();
    damper.table = "torsion_damper";
    damper.name = "air on " + body.name;
    damper.on = Measure::angle_between(0, static_cast<int>(i));
    damper.law = Damper{0.3 * random.uniform(0.0, 1.0)};
  }
  return scene;
}

/// The last load of a scene, by its path.
std::string last_load(const Scene& scene) {
  return "load." + (scene.torques.empty() ? scene.forces.back().name : scene.torques.back().name);
}

// The equations of motion in independent coordinates, linearised: y'' = A y + D y' + b p.
TEST(Response, RandomMechanismsMoveAsTheirEquationsOfMotion) {
  const int scenes = test::cases(12, 100);
  int compared = 0;
  for (int k = 0; k < scenes; ++k) {
    const std::uint64_t seed = test::seed(4200) + static_cast<std::uint64_t>(k);
    SCOPED_TRACE(seed);
    const Scene scene = weighty_scene(seed, k % 4 == 0);
    if (scene.torques.empty() && scene.forces.empty()) continue;
    const std::string body = scene.bodies.back().name;
    const About about(scene, last_load(scene), "x." + body + "." + scene.bodies.back().points.front().name);
    if (!about.why.empty()) continue;
    const MotionModel& model = about.model;
    ReducedMotion<double> reduced(model.scaled_scene(), model.mechanism(), model.inertia());
    ASSERT_EQ(reduced.begin(0.0, about.x.data()), ReducedMotion<double>::Status::ok);
    const int f = reduced.freedoms();
    std::vector<double> z, w(static_cast<std::size_t>(f), 0.0);
    for (const int i : reduced.independent()) z.push_back(about.x[static_cast<std::size_t>(i)]);
    const ReducedMotion<double>::Status status = reduced.evaluate(0.0, z.data(), w.data());
    if (status == ReducedMotion<double>::Status::no_inertia) continue;
    ASSERT_EQ(status, ReducedMotion<double>::Status::ok);
    reduced.linearize();
    Influence influence;
    influence.force = about.excitation.number;
    influence.by = about.excitation.dimension.per_scale(model.scales());
    Eigen::VectorXd by(f);
    reduced.influence(influence, by.data());
    std::vector<BodyPose<double>> poses = model.poses(about.x);
    Eigen::VectorXd reads(f);
    for (int j = 0; j < f; ++j) {
      const std::vector<double> along(reduced.B(j), reduced.B(j) + reduced.coordinates());
      const std::vector<BodyMotion> motions =
          body_motions(model, about.x, along, std::vector<double>(along.size(), 0.0));
      reads[j] = motions[scene.bodies.size() - 1].velocity_of(scene.bodies.back().points.front().at).x;
    }
    for (const double frequency : {0.05, 0.4, 3.0}) {
      const Complex s(0, 2 * M_PI * frequency);
      Eigen::MatrixXcd matrix = s * s * Eigen::MatrixXcd::Identity(f, f);
      for (int j = 0; j < f; ++j) {
        for (int i = 0; i < f; ++i) matrix(i, j) -= reduced.alpha_z(j)[i] + s * reduced.alpha_w(j)[i];
      }
      const Eigen::VectorXcd y = matrix.fullPivLu().solve(by.cast<Complex>());
      const Complex expected = reads.cast<Complex>().cwiseProduct(y).sum();
      const double size = reads.cwiseAbs().dot(y.cwiseAbs());
      EXPECT_NEAR(std::abs(about.at(frequency) - expected), 0.0, 1e-9 * size + 1e-15) << frequency;
    }
    // At 0 Hz it is the derivative of statics.
    const Sensitivities known = sensitivities(about.statics, {about.quantity});
    if (!known.why.empty() || !known.of.front().why.empty()) continue;
    for (const Sensitivity& one : known.of.front().by) {
      if (one.number != about.excitation.path || !one.why.empty()) continue;
      EXPECT_NEAR(about.at(0.0).real(), one.derivative, 1e-8 * std::abs(one.derivative) + 1e-12);
      ++compared;
    }
  }
  EXPECT_GT(compared, scenes / 2);
}

}  // namespace
}  // namespace poise::response_test

// Equilibria that force elements upon every kind of measure keep, against closed forms, and confirmed body by body.

#include "tests/support/elements.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/every_measure.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/vector_mechanics.hpp"

namespace poise::elements_test {
namespace {

constexpr Method methods[] = {Method::virtual_work, Method::energy};

double tolerance(Method method) { return method == Method::energy ? 1e-8 : 1e-12; }

Equilibrium found_by(const StaticModel& model, Method method, const char* stability) {
  const Equilibrium found = solve(model, test::by(method));
  EXPECT_EQ(found.status, Status::confirmed) << to_string(method) << ": " << found.why;
  EXPECT_TRUE(found.check.is_equilibrium()) << found.check.objection;
  EXPECT_EQ(to_string(found.certificate.stability), stability) << to_string(method);
  return found;
}

// A block of 2 kg under 10 m/s^2 on a rail that climbs by 3 in 5, from 1 m along it: 12 N pull it down.
Scene block_on_a_rail(const std::string& elements) {
  return parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0.3, 0.1], S = [5, 5] }
    [body.block]
    points = { c = [0, 0], eye = [0.2, 0.1] }
    mass = 2
    [[slide]]
    name = "guide"
    points = ["ground.O", "block.c"]
    axis = [0.8, 0.6]
    [start]
    guide = 1
  )" + elements,
                     "block.toml");
}

void expect_travel(const std::string& elements, double travel) {
  const StaticModel model(block_on_a_rail(elements));
  for (const Method method : methods) {
    const Equilibrium found = found_by(model, method, "stable");
    EXPECT_NEAR(test::travel_of(model, found.x, "guide"), travel, tolerance(method)) << to_string(method);
  }
}

TEST(Elements, SpringOnASlide) {
  // 40 (s - L0) + 12 = 0
  expect_travel("[[spring]]\nslide = \"guide\"\nstiffness = 40\nfree_length = 2\n", 1.7);
  expect_travel("[[spring]]\nslide = \"guide\"\nstiffness = 40\nfree_length = -2\n", -2.3);
  // One that can only press is pressed.
  expect_travel("[[spring]]\nslide = \"guide\"\nstiffness = 40\nfree_length = 2\nacts = \"compression\"\n", 1.7);
  // 40 (s - 2) + 10 (s + 2) + 12 = 0 with the second pulling back.
  expect_travel(
      "[[spring]]\nslide = \"guide\"\nstiffness = 40\nfree_length = 2\n"
      "[[spring]]\nslide = \"guide\"\nstiffness = 10\nfree_length = -2\nacts = \"tension\"\n",
      0.96);
}

TEST(Elements, CubicSpring) {
  // 2 u + u^3 + 12 = 0 at u = s - 3 = -2;  a softening one:  40 u - u^3 + 12 = 0 at its root next to -0.3.
  expect_travel("[[cubic_spring]]\nslide = \"guide\"\nstiffness = 2\ncubic = 1\nfree_length = 3\n", 1.0);
  const double p = -40.0 / 3;
  const double u = 2 * std::sqrt(-p) * std::cos(std::acos(6 / std::sqrt(-p * p * p)) / 3 - 2 * M_PI / 3);
  expect_travel("[[cubic_spring]]\nslide = \"guide\"\nstiffness = 40\ncubic = -1\nfree_length = 3\n", 3 + u);
}

TEST(Elements, PreloadedSpring) {
  // 8 + 40 (s - 2) + 12 = 0
  expect_travel("[[spring]]\nslide = \"guide\"\nstiffness = 40\npreload = 8\nlength = 2\n", 1.5);
}

TEST(Elements, SpringCurves) {
  // The line -80 + 40 s; and a curve that is -12 at one of its points, where two pieces meet.
  expect_travel("[[spring]]\nslide = \"guide\"\nforce = { curve = [[0, -80], [4, 80]] }\n", 1.7);
  expect_travel("[[spring]]\nslide = \"guide\"\nforce.curve = [[0, -40], [1.25, -12], [2, 0], [3, 30]]\n", 1.25);
  expect_travel("[[spring]]\nslide = \"guide\"\nscale = 2\nshift = 0.5\nforce.curve = [[0, -9], [0.7, -6], [4, 5]]\n",
                1.2);
}

TEST(Elements, GasStrut) {
  // 10 / (1 - y/2) = 12 at y = (3 - s)/2 = 1/3
  expect_travel(
      "[[spring]]\nslide = \"guide\"\ngas = { preload = 10, length = 3, stroke = 2, ratio = 2, friction = 1 }\n",
      7.0 / 3);
}

TEST(Elements, GasStrutHeldByItsStop) {
  // 20 N out and more in lift the block up to the length of the strut.
  const StaticModel model(
      block_on_a_rail("[[spring]]\nslide = \"guide\"\ngas = { preload = 20, length = 3, stroke = 2.5, ratio = 2 }\n"));
  for (const Method method : methods) {
    const Equilibrium found = found_by(model, method, "stable");
    EXPECT_NEAR(test::travel_of(model, found.x, "guide"), 3.0, tolerance(method)) << to_string(method);
  }
}

TEST(Elements, BumpStop) {
  // 3 (u/0.5)^2 = 12 at u = 2.5 - s = 1
  expect_travel("[[bump_stop]]\nslide = \"guide\"\nforce = 3\nfree_length = 2.5\ndepth = 0.5\n", 1.5);
}

TEST(Elements, StopThatYields) {
  // 96 d^1.5 = 12 at d = 0.5 - s = 1/4, and 24 d = 12 beyond the other limit where it is pulled up with 24 N.
  expect_travel("[[stop]]\nslide = \"guide\"\nmin = 0.5\nstiffness = 96\nexponent = 1.5\ndamping = 3\n", 0.25);
  expect_travel(
      "[[stop]]\nslide = \"guide\"\nmin = 0.5\nmax = 2\nstiffness = 24\n"
      "[[constant_force]]\nslide = \"guide\"\nforce = -24\n",
      2.5);
}

TEST(Elements, SpringOnAnXAndAY) {
  // x of the eye is 0.5 + 0.8 s, y is 0.2 + 0.6 s:  0.8 50 (x - 4) + 12 = 0,  0.6 50 (y - 4) + 12 = 0.
  expect_travel("[[spring]]\nx = \"block.eye\"\nstiffness = 50\nfree_length = 4\n", (3.7 - 0.5) / 0.8);
  expect_travel("[[spring]]\ny = \"block.eye\"\nstiffness = 50\nfree_length = 4\n", (3.6 - 0.2) / 0.6);
  expect_travel("[[spring]]\ny = \"block.eye\"\nstiffness = 50\nfree_length = -1\n", (-1.4 - 0.2) / 0.6);
}

TEST(Elements, ConstantForces) {
  // A counterweight of 20 N on a rope along the rail holds more than 12 N; the spring takes the rest:
  //   40 (s - 2) + 12 - 20 = 0.
  const std::string spring = "[[spring]]\nslide = \"guide\"\nstiffness = 40\nfree_length = 2\n";
  expect_travel(spring + "[[constant_force]]\nslide = \"guide\"\nforce = -20\n", 2.2);
  // Upwards at the eye: 0.6 20 = 12 N along the rail.
  expect_travel(spring + "[[constant_force]]\ny = \"block.eye\"\nforce = -20\n", 2.0);
}

TEST(Elements, DampersAndFrictionStayOutOfStatics) {
  expect_travel(
      "[[spring]]\nslide = \"guide\"\nstiffness = 40\nfree_length = 2\n[[damper]]\nslide = \"guide\"\ncoefficient = 5\n"
      "[[friction]]\nslide = \"guide\"\nforce = 3\nwidth = 0.1\n",
      1.7);
}

// Two blocks on vertical rails. A tackle takes twice the left one's travel and the right one's:
//   T = 300 (2 s + r - 4),  2 T + 80 = 0 on the left,  T + 50 + 200 (r - 1) = 0 on the right.
TEST(Elements, SpringOnASumIsATackle) {
  const StaticModel model(parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { L = [0, 0], R = [1, 0] }
    [body.left]
    points = { c = [0, 0] }
    mass = 8
    [body.right]
    points = { c = [0, 0] }
    mass = 5
    [[slide]]
    name = "s"
    points = ["ground.L", "left.c"]
    axis = [0, 1]
    [[slide]]
    name = "r"
    points = ["ground.R", "right.c"]
    axis = [0, 1]
    [[spring]]
    name = "tackle"
    sum = [{ factor = 2, slide = "s" }, { factor = 1, slide = "r" }]
    stiffness = 300
    free_length = 4
    [[spring]]
    name = "hanger"
    slide = "r"
    stiffness = 200
    free_length = 1
  )",
                                      "tackle.toml"));
  const double r = 1 - (50.0 - 40.0) / 200;
  const double s = (4 - 40.0 / 300 - r) / 2;
  for (const Method method : methods) {
    const Equilibrium found = found_by(model, method, "stable");
    EXPECT_NEAR(test::travel_of(model, found.x, "r"), r, 10 * tolerance(method));
    EXPECT_NEAR(test::travel_of(model, found.x, "s"), s, 10 * tolerance(method));
  }
}

// Two wheels with an elastic mesh, k (q1 + 3 q2 - f), a torque M on the first and a coil on the second:
//   k (q1 + 3 q2 - f) = M,  3 M + c q2 = 0.
TEST(Elements, SpringOnASumOfAnglesIsAMesh) {
  const StaticModel model(parse_scene(R"(
    [ground]
    points = { A = [0, 0], B = [1, 0] }
    [body.one]
    points = { A = [0, 0] }
    [body.two]
    points = { B = [0, 0] }
    [[pin]]
    points = ["ground.A", "one.A"]
    [[pin]]
    points = ["ground.B", "two.B"]
    [[spring]]
    sum = [{ factor = 1, bodies = ["ground", "one"] }, { factor = 3, bodies = ["ground", "two"] }]
    stiffness = 20
    free_angle = 0.5
    [[torsion_spring]]
    bodies = ["ground", "two"]
    stiffness = 15
    [[torque]]
    on = "one"
    value = 4
  )",
                                      "mesh.toml"));
  for (const Method method : methods) {
    const Equilibrium found = found_by(model, method, "stable");
    EXPECT_NEAR(test::angle_of(model, found.x, "two"), -0.8, 10 * tolerance(method));
    EXPECT_NEAR(test::angle_of(model, found.x, "one"), 0.5 + 4.0 / 20 + 2.4, 10 * tolerance(method));
  }
}

// An arm of 2 m with 30 N at its tip, at q from the horizontal.
Scene arm(double q, const std::string& elements) {
  return parse_scene(fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ O = [0, 0], S = [0, 3] }}
    [body.arm]
    points = {{ O = [0, 0], P = [2, 0] }}
    mass = 3
    center = [2, 0]
    [[pin]]
    points = ["ground.O", "arm.O"]
    {}
    [start]
    arm = {}
  )",
                                 elements, q),
                     "arm.toml");
}

// The spring's far end rides along a wall, so that it stays level:  V = 30 2 sin q + k/2 (2 cos q)^2  has rests at
// sin q = 30 / 2 k, which fall, and upright, which stands where k 2 > 30.
TEST(Elements, LevelSpringHoldsAnArmUpright) {
  const std::string spring = "[[spring]]\nx = \"arm.P\"\nstiffness = 25\nfree_length = 0\n";
  const StaticModel leaning(arm(0.6, spring));
  const Equilibrium falls = found_by(leaning, Method::virtual_work, "unstable");
  EXPECT_NEAR(test::angle_of(leaning, falls.x, "arm"), std::asin(0.6), 1e-12);
  const StaticModel upright(arm(1.5, spring));
  for (const Method method : methods) {
    const Equilibrium stands = found_by(upright, method, "stable");
    EXPECT_NEAR(test::angle_of(upright, stands.x, "arm"), M_PI_2, tolerance(method));
  }
}

// A counterweight of F = 25 N on a rope over S, 3 m above the hinge: V = 30 2 sin q + F r  rests where
// r = 3 F / 30, and falls.
TEST(Elements, CounterweightOnARopeBalancesAnArm) {
  const double r = 2.5;
  const double sine = (2 * 2 + 3 * 3 - r * r) / (2 * 2 * 3);
  const StaticModel model(arm(0.5, "[[constant_force]]\npoints = [\"ground.S\", \"arm.P\"]\nforce = 25\n"));
  const Equilibrium found = found_by(model, Method::virtual_work, "unstable");
  EXPECT_NEAR(test::angle_of(model, found.x, "arm"), std::asin(sine), 1e-12);
}

// A clockwork of 15 N m winds a coil by 15 / 10 rad.
TEST(Elements, ClockworkWindsACoil) {
  const StaticModel model(parse_scene(R"(
    [ground]
    points = { O = [0, 0] }
    [body.wheel]
    points = { O = [0, 0] }
    [[pin]]
    points = ["ground.O", "wheel.O"]
    [[constant_force]]
    bodies = ["ground", "wheel"]
    torque = -15
    [[torsion_spring]]
    bodies = ["ground", "wheel"]
    stiffness = 10
  )",
                                      "clockwork.toml"));
  for (const Method method : methods) {
    const Equilibrium found = found_by(model, method, "stable");
    EXPECT_NEAR(test::angle_of(model, found.x, "wheel"), 1.5, tolerance(method));
  }
}

// Three ways to stop the block at half a metre along the rail.
TEST(Elements, StopsUponEveryMeasureHold) {
  for (const std::string& on :
       {std::string("y = \"block.eye\"\nmin = 0.5"), std::string("x = \"block.eye\"\nmin = 0.9"),
        std::string("sum = [{ factor = -2, slide = \"guide\" }]\nmax = -1")}) {
    SCOPED_TRACE(on);
    const StaticModel model(block_on_a_rail("[[stop]]\nname = \"rest\"\n" + on + "\n"));
    for (const Method method : methods) {
      const Equilibrium found = found_by(model, method, "stable");
      EXPECT_NEAR(test::travel_of(model, found.x, "guide"), 0.5, tolerance(method));
      EXPECT_EQ(test::reaction_of(found.check, "rest").kind, "stop");
    }
  }
}

// The check cuts every body free, independent of the phasor model; energies come from the poses of the bodies.
TEST(Elements, UponEveryMeasureOfRandomMechanismsAreConfirmedBodyByBody) {
  int confirmed = 0;
  const int count = test::cases(20, 60);
  for (int k = 1; k <= count; ++k) {
    const std::uint64_t seed = test::seed(static_cast<std::uint64_t>(k));
    SCOPED_TRACE(seed);
    test::Random random(seed);
    Scene scene = test::plant_mechanism(seed, {.loops = static_cast<int>(seed % 4)}).in_equilibrium;
    test::add_elements_upon_every_measure(scene, random, true);
    const StaticModel model(scene);
    const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::stable));
    if (!found.found()) continue;
    ASSERT_EQ(found.status, Status::confirmed) << found.why;
    ++confirmed;
    const std::vector<double> other = assemble(model);
    const auto energy = [&](const std::vector<double>& x) {
      std::vector<Planar<double>> pose(model.mechanism().pose_size());
      model.mechanism().place(x.data(), pose.data());
      return model.mechanism().energy(x.data(), pose.data()) * model.scales().energy();
    };
    const double from = test::potential_energy(scene, model.poses(other));
    const double to = test::potential_energy(scene, model.poses(found.x));
    EXPECT_NEAR(found.energy.value() - energy(other), to - from,
                1e-10 * (std::abs(from) + std::abs(to) + std::abs(found.energy.value())));
  }
  EXPECT_GT(confirmed, 2 * count / 3);
}

}  // namespace
}  // namespace poise::elements_test

#include "motion/contact_forces.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "model/read_scene.hpp"

namespace poise::contact_forces_test {
namespace {

constexpr double turn = 2 * M_PI, degree = M_PI / 180;

/// A follower of `mass` on a cam, pushed down by a spring with `preload` where the share is 0, and weight.
struct Follower {
  double mass = 0.5, stiffness = 800.0, preload = 20.0, gravity = 9.81, lift = 0.02;
  std::string law, guided = "false";

  Scene scene() const {
    const auto number = [](double value) { return std::to_string(value); };
    const double base = 0.05;
    return parse_scene("gravity = [0, " + number(-gravity) + R"(]
[ground]
points = { O = [0, 0] }
[body.cam]
points = { O = [0, 0] }
inertia = 0.01
[body.follower]
points = { T = [0, 0] }
mass = )" + number(mass) + R"(
[[pin]]
name = "shaft"
points = ["ground.O", "cam.O"]
[[slide]]
name = "guide"
points = ["ground.O", "follower.T"]
axis = [0, 1]
[[cam]]
name = "lobe"
bodies = ["ground", "cam"]
follower = { slide = "guide" }
base = 0.05
lift = )" + number(lift) +
                           "\nguided = " + guided + "\nlaw = [" + law + R"(]
[[spring]]
slide = "guide"
stiffness = )" + number(stiffness) +
                           "\nfree_length = " + std::to_string(base - preload / stiffness) +
                           "\n[start]\ncam = 0\nguide = 0.05\n",
                       "follower.toml");
  }
};

/// The same with all that a range over one turn needs.
struct Driven {
  explicit Driven(Scene scene) {
    scene.drives.push_back(find_drive(scene, "cam"));
    held = contacts_to_hold(scene);
    contacts = contacts_along(scene, held);
    model.emplace(held_in_contact(scene, held));
  }
  std::vector<Contact> held, contacts;
  std::optional<MotionModel> model;
  std::vector<DriveRange> ranges{{"cam", 0.0, turn}};
};

/// y = e (1 - cos) of an eccentric, e = 10 mm: two harmonic halves.
Follower eccentric() {
  Follower out;
  out.law =
      "{ to = 3.14159265358979312, lift = 1, law = \"harmonic\" }, "
      "{ to = 6.28318530717958623, lift = 0, law = \"harmonic\" }";
  return out;
}

Follower cycloidal(double rise_degrees, const std::string& rest) {
  Follower out;
  char rise[32];
  std::snprintf(rise, sizeof rise, "%.17g", rise_degrees * degree);
  out.law = std::string("{ to = ") + rise + ", lift = 1, law = \"cycloidal\" }, " + rest;
  return out;
}

// N = m w^2 e cos + k e (1 - cos) + F0 + m g is least at 180 degrees, where it vanishes at
// w^2 = (2 k e + F0 + m g) / (m e).
TEST(LiftOff, OfAnEccentric) {
  const Driven driven(eccentric().scene());
  ASSERT_EQ(driven.held.size(), 1U);
  const std::vector<LiftOff> found = lift_offs(*driven.model, driven.ranges, {}, driven.contacts);
  ASSERT_EQ(found.size(), 1U);
  ASSERT_TRUE(found[0].rate);
  EXPECT_NEAR(*found[0].rate, std::sqrt((2 * 800 * 0.01 + 20 + 0.5 * 9.81) / (0.5 * 0.01)), 1e-10);
  EXPECT_NEAR(*found[0].rate, 90.4488805901, 1e-9);
  EXPECT_NEAR(found[0].at, M_PI, 1e-7);
}

TEST(LiftOff, OfACycloidalRise) {
  Follower follower =
      cycloidal(90, "{ to = 3, law = \"dwell\" }, { to = 6.28318530717958623, lift = 0, law = \"harmonic\" }");
  const Driven driven(follower.scene());
  const std::vector<LiftOff> found = lift_offs(*driven.model, {{"cam", 0.0, M_PI / 2}}, {.steps = 90}, driven.contacts);
  ASSERT_TRUE(found.at(0).rate);
  // w^2 = -(k y + F0 + m g) / (m y''), least where this is, by golden sections.
  const double rise = M_PI / 2, h = 0.02;
  const auto square = [&](double a) {
    const double s = a / rise;
    const double y = h * (s - std::sin(turn * s) / turn), bend = h * turn * std::sin(turn * s) / (rise * rise);
    return -(800 * y + 20 + 0.5 * 9.81) / (0.5 * bend);
  };
  double from = 0.55 * rise, to = 0.95 * rise;
  for (int k = 0; k < 100; ++k) {
    const double a = from + 0.382 * (to - from), b = from + 0.618 * (to - from);
    (square(a) < square(b) ? to : from) = square(a) < square(b) ? b : a;
  }
  EXPECT_NEAR(*found[0].rate, std::sqrt(square(from)), 1e-10);
  EXPECT_NEAR(found[0].at, from, 1e-7);
  EXPECT_NEAR(*found[0].rate, 39.3166158, 1e-7);
  EXPECT_NEAR(found[0].at / degree, 66.51, 0.005);
}

// A rise of 10 mm in 90 degrees, dwell to 120, return to 210, without gravity: 1625.77 rpm.
TEST(LiftOff, OfAValve) {
  Follower follower = cycloidal(90,
                                "{ to = 2.09439510239319549, law = \"dwell\" }, "
                                "{ to = 3.66519142918809208, lift = 0, law = \"cycloidal\" }, "
                                "{ to = 6.28318530717958623, law = \"dwell\" }");
  follower.mass = 0.35;
  follower.stiffness = 12000;
  follower.preload = 150;
  follower.gravity = 0;
  follower.lift = 0.01;
  const Driven driven(follower.scene());
  const std::vector<LiftOff> found = lift_offs(*driven.model, driven.ranges, {}, driven.contacts);
  ASSERT_TRUE(found.at(0).rate);
  EXPECT_NEAR(*found[0].rate * 30 / M_PI, 1625.77, 0.005);
}

// Beyond that speed N vanishes at cos = -(k e + F0 + m g) / (m e w^2 - k e), twice.
TEST(ContactForces, AreNegativeBetweenTwoPlaces) {
  const double w = 100.0, off = std::acos(-(800 * 0.01 + 20 + 0.5 * 9.81) / (0.5 * 0.01 * w * w - 800 * 0.01));
  for (const bool guided : {false, true}) {
    Follower follower = eccentric();
    follower.guided = guided ? "true" : "false";
    const Driven driven(follower.scene());
    const SweepOptions options{.steps = 50, .rate = w};
    const ForcesAlong found = forces_over(*driven.model, driven.ranges, options, true);
    EXPECT_TRUE(found.balanced());
    const std::vector<ContactCourse> courses =
        contact_courses(*driven.model, driven.ranges, options, true, driven.contacts, found);
    ASSERT_EQ(courses.size(), 1U);
    EXPECT_EQ(courses[0].contact.guided, guided);
    EXPECT_TRUE(courses[0].pulls);
    EXPECT_NEAR(courses[0].least, 2 * 800 * 0.01 + 20 + 0.5 * 9.81 - 0.5 * 0.01 * w * w, 1e-10);
    EXPECT_NEAR(courses[0].least_at, M_PI, 1e-7);
    ASSERT_EQ(courses[0].changes.size(), 2U);
    EXPECT_NEAR(courses[0].changes[0].at, off, 1e-13);
    EXPECT_FALSE(courses[0].changes[0].presses);
    EXPECT_NEAR(courses[0].changes[1].at, turn - off, 1e-13);
    EXPECT_TRUE(courses[0].changes[1].presses);
  }
}

// Just beyond, between two samples: 73 of them stand at multiples of 5 degrees, and N is negative within 0.9 degrees.
TEST(ContactForces, AreFoundBetweenSamples) {
  const Driven driven(eccentric().scene());
  const double w = 90.4488805901 * (1 + 1e-5);
  const std::vector<DriveRange> ranges{{"cam", 0.0 + 2.5 * degree, turn + 2.5 * degree}};
  const SweepOptions options{.rate = w};
  const ForcesAlong found = forces_over(*driven.model, ranges, options, true);
  for (const Forces& pose : found.poses) EXPECT_GT(pose.reactions.size(), 0U);
  const std::vector<ContactCourse> courses =
      contact_courses(*driven.model, ranges, options, true, driven.contacts, found);
  ASSERT_EQ(courses.at(0).changes.size(), 2U);
  const double off = std::acos(-(800 * 0.01 + 20 + 0.5 * 9.81) / (0.5 * 0.01 * w * w - 800 * 0.01));
  EXPECT_NEAR(courses[0].changes[0].at, off, 1e-11);
  EXPECT_NEAR(courses[0].changes[1].at, turn - off, 1e-11);
}

// Both freedoms are driven: no contact is held.
TEST(ContactForces, HoldNothingThatIsDriven) {
  Scene scene = eccentric().scene();
  scene.drives.push_back(find_drive(scene, "cam"));
  scene.drives.push_back(find_drive(scene, "guide"));
  EXPECT_TRUE(contacts_to_hold(scene).empty());
}

// A hoist: its rope of tension m (g + r alpha cos...) is slack beyond some rate of an eccentric drum.
TEST(LiftOff, OfARopeThatALoadHangsOn) {
  const Scene given = parse_scene(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], P = [0.1, 1] }
[body.crank]
points = { O = [0, 0], A = [0.1, 0] }
inertia = 1
[body.load]
points = { C = [0, 0] }
mass = 3
[[pin]]
points = ["ground.O", "crank.O"]
[[slide]]
name = "hang"
points = ["ground.O", "load.C"]
axis = [0, 1]
[[rope]]
name = "cord"
over = ["crank.A", "load.C"]
length = 1
[start]
crank = 0
hang = -0.99
)",
                                  "hoist.toml");
  Scene scene = given;
  scene.drives = {find_drive(scene, "crank")};
  const std::vector<Contact> held = contacts_to_hold(scene);
  ASSERT_EQ(held.size(), 1U);
  EXPECT_TRUE(held[0].at_max);
  const MotionModel model(held_in_contact(scene, held));
  const std::vector<LiftOff> found = lift_offs(model, {{"crank", 0.0, turn}}, {}, held);
  ASSERT_TRUE(found.at(0).rate);
  // The load is at y = r sin - sqrt(l^2 - r^2 cos^2); the rope is slack where it falls faster than g.
  const double r = 0.1, l = 1.0;
  const auto place = [&](double a) { return r * std::sin(a) - std::sqrt(l * l - r * r * std::cos(a) * std::cos(a)); };
  const double d = 1e-3, a = M_PI / 2;
  const double bend =
      (-place(a - 2 * d) + 16 * place(a - d) - 30 * place(a) + 16 * place(a + d) - place(a + 2 * d)) / (12 * d * d);
  EXPECT_NEAR(found[0].at, a, 1e-6);
  EXPECT_NEAR(*found[0].rate, std::sqrt(-9.81 / bend), 1e-6);
}

}  // namespace
}  // namespace poise::contact_forces_test

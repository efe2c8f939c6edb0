// Contacts between bodies, backlash and pins with clearance at rest, against closed forms.

#include "tests/support/contacts.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"

namespace poise::contacts_test {
namespace {

using std::numbers::pi;
using test::by;
using test::found_both_ways;
using test::tolerance;

double size_of(const Check& check, const std::string& name) { return norm(test::reaction_of(check, name).force); }

// A ball of 20 N and radius 0.1 in a groove whose faces fall by 30 degrees to its bottom and rise by 60 degrees.
std::string groove(const std::string& contact) {
  return fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ A = [{:.17g}, {:.17g}], B = [0, 0], C = [{:.17g}, {:.17g}] }}
    [body.ball]
    points = {{ P = [0, 0] }}
    mass = 2
    [[contact]]
    name = "groove"
    point = "ball.P"
    radius = 0.1
    {}
    [start.position]
    ball = [0.02, 0.2]
  )",
                     -std::cos(pi / 6), std::sin(pi / 6), std::cos(pi / 3), std::sin(pi / 3), contact);
}

// In the corner both faces, which are square to each other, press: W cos 30 and W cos 60.
TEST(Contacts, ABallLiesInAGroove) {
  const StaticModel model(parse_scene(groove("outline = [\"ground.A\", \"ground.B\", \"ground.C\"]"), "groove.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    const Vec2 at = test::place_of(model, found.x, "ball.P");
    const Vec2 expected = 0.1 * (unit(pi / 3) + unit(5 * pi / 6));
    EXPECT_NEAR(at.x, expected.x, tolerance(found.method));
    EXPECT_NEAR(at.y, expected.y, tolerance(found.method));
    EXPECT_NEAR(size_of(found.check, "groove"), 20 * std::cos(pi / 6), 1e-5);
    EXPECT_NEAR(size_of(found.check, "groove part 1"), 20 * std::cos(pi / 3), 1e-5);
  }
}

// A lever of weight W, l from its pin to its centre of mass, that lies on a round bar of radius r: its edge touches it
// at the distance s = |OC|^2 - r^2 from the pin, or its end at s = L where that is less.
std::string lever(double length) {
  return fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ O = [0, 0], C = [0.4, -0.3] }}
    [body.lever]
    points = {{ O = [0, 0], E = [{}, 0] }}
    center = [0.3, 0]
    mass = 5
    [[pin]]
    points = ["ground.O", "lever.O"]
    [[contact]]
    name = "bar"
    point = "ground.C"
    radius = 0.1
    segment = ["lever.E", "lever.O"]
    [start]
    lever = -0.2
  )",
                     length);
}

TEST(Contacts, ALeverLiesOnABar) {
  const StaticModel model(parse_scene(lever(0.7), "lever.toml"));
  const double s = std::sqrt(0.25 - 0.01);
  const double angle = std::atan2(-0.3, 0.4) + std::asin(0.1 / 0.5);
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::angle_of(model, found.x, "lever"), angle, tolerance(found.method));
    const Reaction& bar = test::reaction_of(found.check, "bar");
    EXPECT_NEAR(norm(bar.force), 50 * 0.3 * std::cos(angle) / s, 1e-5);
    EXPECT_NEAR(bar.at.x, s * std::cos(angle), tolerance(found.method));
    EXPECT_NEAR(bar.at.y, s * std::sin(angle), tolerance(found.method));
  }
}

// With a lever that ends before that place its end rests on the bar, with a force towards the middle of the bar.
TEST(Contacts, TheEndOfALeverLiesOnABar) {
  const double L = 0.45;
  const StaticModel model(parse_scene(lever(L), "lever.toml"));
  const double between = std::acos((L * L + 0.25 - 0.01) / (2 * L * 0.5));
  const double angle = std::atan2(-0.3, 0.4) + between;
  const Vec2 end = L * unit(angle), away = 10.0 * (end - Vec2{0.4, -0.3});
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::angle_of(model, found.x, "lever"), angle, tolerance(found.method));
    EXPECT_NEAR(size_of(found.check, "bar"), 50 * 0.3 * std::cos(angle) / cross(end, away), 1e-5);
  }
}

TEST(Contacts, KnowDerivativesByTheirNumbers) {
  const Scene scene = parse_scene(lever(0.7), "lever.toml");
  const Sensitivities found = sensitivities(StaticModel(scene), {find_quantity(scene, "angle.lever")});
  ASSERT_EQ(found.of.size(), 1U) << found.why;
  const auto by = [&](const std::string& number) {
    for (const Sensitivity& one : found.of[0].by) {
      if (one.number == number) return one.derivative;
    }
    return std::nan("");
  };
  const double s = std::sqrt(0.25 - 0.01);
  EXPECT_NEAR(by("contact.bar.radius"), 1 / s, 1e-9);
  // The bar moves square to the edge by n, and the edge about its pin by s.
  const double angle = std::atan2(-0.3, 0.4) + std::asin(0.1 / 0.5);
  EXPECT_NEAR(by("point.ground.C.y"), std::cos(angle) / s, 1e-9);
  EXPECT_NEAR(by("point.lever.E.y"), -1 / 0.7, 1e-9) << "the edge turns in its lever";
}

// A ball in a bowl, and on a dome, on which it does not stay: at the bottom of a hollow arc, with the force of its
// weight.
TEST(Contacts, ABallRestsInABowl) {
  const std::string bowl = R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 1], A = [-1, 1], B = [1, 1] }
    [body.ball]
    points = { P = [0, 0] }
    mass = 2
    [[contact]]
    name = "bowl"
    point = "ball.P"
    radius = 0.2
    arc = { center = "ground.O", from = "ground.A", to = "ground.B", hollow = true }
    [start.position]
    ball = [0.3, 0.4]
  )";
  const StaticModel model(parse_scene(bowl, "bowl.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    const Vec2 at = test::place_of(model, found.x, "ball.P");
    EXPECT_NEAR(at.x, 0.0, 1e-6);
    EXPECT_NEAR(at.y, 0.2, tolerance(found.method));
    EXPECT_NEAR(size_of(found.check, "bowl"), 20.0, 1e-6);
  }
}

// The hook of the dataset: the bolt pulls with 20 N and P at 10 mm below its pin against 400 N mm.
TEST(Contacts, AHookHoldsItsBolt) {
  for (const double pull : {0.0, 15.0, 19.9}) {
    Scene scene = read_scene(test::dataset("hook_latch.toml"));
    set_value(scene, "load.P", pull);
    const StaticModel model(scene);
    for (const Equilibrium& found : found_both_ways(model)) {
      EXPECT_NEAR(test::place_of(model, found.x, "bolt.C").x, -0.068, tolerance(found.method));
      EXPECT_NEAR(size_of(found.check, "catch part 1"), 20 + pull, 1e-5);
      EXPECT_NEAR(std::abs(test::reaction_of(found.check, "rest").moment), 0.4 - 0.01 * (20 + pull), 1e-6);
    }
  }
  Scene scene = read_scene(test::dataset("hook_latch.toml"));
  set_value(scene, "load.P", 20.1);
  const StaticModel model(scene);
  const Equilibrium out = solve(model, by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(out.found());
  EXPECT_LT(test::place_of(model, out.x, "bolt.C").x, -0.1) << "the hook has let it go";
}

// The tip of the pawl of the dataset, a circle of 1 mm, is where it touches the face of a tooth and the back of the one
// before: its centre is where lines beside both, 1 mm away, cross. There two forces of one outline balance the weight's
// torque and the pawl's spring.
TEST(Contacts, AWheelIsLockedByItsPawl) {
  const StaticModel model(read_scene(test::dataset("ratchet.toml")));
  const auto point = [](double radius, double angle) { return radius * unit(angle); };
  const Vec2 root = point(42, pi / 2), tip = point(50, pi / 2 + 0.03), before = point(50, 2 * pi / 3 + 0.03);
  const auto left_of = [](Vec2 from, Vec2 to) { return quarter_turn((1 / norm(to - from)) * (to - from)); };
  const Vec2 back = left_of(before, root), face = left_of(root, tip);
  const double h_back = dot(back, root) + 1, h_face = dot(face, root) + 1, area = cross(back, face);
  const Vec2 centre{(h_back * face.y - h_face * back.y) / area, (back.x * h_face - face.x * h_back) / area};
  for (const Equilibrium& found : found_both_ways(model)) {
    const Vec2 at = 1000.0 * test::place_of(model, found.x, "pawl.tip");
    EXPECT_NEAR(norm(at), norm(centre), 1e-4) << "points of the file have four decimals";
    const double turned = std::atan2(cross(centre, at), dot(centre, at));
    EXPECT_NEAR(test::angle_of(model, found.x, "wheel"), turned, 1e-5);
    const Vec2 n_back = back * unit(turned), n_face = face * unit(turned), arm = at - Vec2{-60, 50};
    // Moments about the axle and the pin of the pawl, N mm.
    const double spring = 2 * (-30 - test::angle_of(model, found.x, "pawl") * 180 / pi);
    const double a = cross(at, n_back), b = cross(at, n_face), c = cross(arm, n_back), d = cross(arm, n_face);
    const double of_back = (500 * d + spring * b) / (a * d - b * c),
                 of_face = (-spring * a - 500 * c) / (a * d - b * c);
    EXPECT_NEAR(size_of(found.check, "tip part 3"), of_back, 1e-3);
    EXPECT_NEAR(size_of(found.check, "tip part 8"), of_face, 1e-3);
  }
}

// A wheel with a backlash of 2 degrees turns to the flank that its torque presses it on.
TEST(Contacts, TeethWithBacklashLieOnTheSideThatTheyArePressedOn) {
  for (const double torque : {3.0, -3.0}) {
    const Scene scene = parse_scene(fmt::format(R"(
      [units]
      angle = "deg"
      [ground]
      points = {{ O = [0, 0], Q = [3, 0] }}
      [body.a]
      points = {{ O = [0, 0] }}
      [body.b]
      points = {{ Q = [0, 0] }}
      [[pin]]
      points = ["ground.O", "a.O"]
      [[pin]]
      points = ["ground.Q", "b.Q"]
      [[gear]]
      name = "mesh"
      bodies = ["a", "b"]
      ratio = 0.5
      phase = 10
      backlash = 2
      [[torsion_spring]]
      bodies = ["ground", "a"]
      stiffness = 0.5
      free_angle = 0
      [[torque]]
      name = "M"
      on = "b"
      value = {}
    )",
                                                torque),
                                    "mesh.toml");
    EXPECT_NEAR(get_value(scene, "gear.mesh.backlash"), 2.0, 1e-12);
    EXPECT_NEAR(get_value(scene, "gear.mesh.phase"), 10.0, 1e-12);
    const StaticModel model(scene);
    for (const Equilibrium& found : found_both_ways(model)) {
      // k a = -torque / 2 (in N m per degree).
      const double a = -0.5 * torque / 0.5;
      EXPECT_NEAR(test::angle_of(model, found.x, "a") * 180 / pi, a, 1e-5);
      EXPECT_NEAR(test::angle_of(model, found.x, "b") * 180 / pi, 10 - 0.5 * a + (torque > 0 ? 1 : -1), 1e-5);
    }
    Scene other = scene;
    set_value(other, "gear.mesh.phase", 30.0);
    EXPECT_NEAR(get_value(other, "gear.mesh.backlash"), 2.0, 1e-12);
    set_value(other, "gear.mesh.backlash", 4.0);
    EXPECT_NEAR(get_value(other, "gear.mesh.phase"), 30.0, 1e-12);
  }
}

// A weight in a hole that is wider than its pin hangs below the middle by as much.
TEST(Contacts, AWeightHangsLooselyOnItsPin) {
  const StaticModel model(parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 0] }
    [body.weight]
    points = { P = [0, 0.3] }
    mass = 2
    [[loose_pin]]
    name = "hole"
    points = ["ground.O", "weight.P"]
    clearance = 0.01
    [start.position]
    weight = [0.004, -0.306]
  )",
                                      "loose.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    const Vec2 at = test::place_of(model, found.x, "weight.P");
    EXPECT_NEAR(at.x, 0.0, 1e-5);
    EXPECT_NEAR(at.y, -0.01, tolerance(found.method));
    EXPECT_NEAR(size_of(found.check, "hole"), 20.0, 1e-5);
  }
}

std::string message(const std::string& contact) {
  return test::message_of([&] { parse_scene(groove(contact), "groove.toml"); });
}

TEST(Contacts, RefuseWhatIsNoOutline) {
  const auto has = [](const std::string& contact, const std::string& part) {
    EXPECT_NE(message(contact).find(part), std::string::npos) << message(contact);
  };
  has("", "expected one of the keys segment, arc and outline");
  has("segment = [\"ground.A\", \"ground.B\"]\noutline = [\"ground.A\", \"ground.B\"]",
      "expected one of the keys segment, arc and outline");
  has("segment = [\"ground.A\", \"ball.P\"]", "expected a point of another body than that of the key point");
  has("segment = [\"ground.A\", \"ground.A\"]", "expected another place than that of the point before");
  has("segment = [\"ground.A\", \"ground.B\", \"ground.C\"]", "several edges are an outline");
  has("outline = [\"ground.A\", \"ground.X\"]", "ground.X");
  has("closed = true\noutline = [\"ground.A\", \"ground.B\"]", "three points or more");
  has("arc = { center = \"ground.A\", from = \"ground.B\", to = \"ground.C\" }", "as far from the center");
  has("closed = true\nsegment = [\"ground.A\", \"ground.B\"]", "leave closed out");
}

// A plate of length l and thickness t below the pin's line, that lies on a block with a corner at C and a top to the
// left of it, as outlines of both: the corner of the block touches the lower edge of a long plate, and the lower
// corner of a short one the top of the block.
std::string plate_on_block(double length, double start = -0.4) {
  return fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ O = [0, 0], D = [0.1, -0.3], C = [0.4, -0.3], F = [0.4, -1.3], G = [0.1, -1.3] }}
    [body.plate]
    points = {{ O = [0, 0], E = [{0}, 0], H = [{0}, -0.1], I = [0, -0.1] }}
    center = [0.3, 0]
    mass = 5
    [[pin]]
    points = ["ground.O", "plate.O"]
    [[contact]]
    name = "lies"
    outline = ["plate.O", "plate.E", "plate.H", "plate.I"]
    closed = true
    against = ["ground.D", "ground.C", "ground.F", "ground.G"]
    against_closed = true
    [start]
    plate = {1}
  )",
                     length, start);
}

const Reaction& only_pressing(const Check& check) {
  const Reaction* out = nullptr;
  for (const Reaction& one : check.reactions) {
    if (!one.name.starts_with("lies")) continue;
    EXPECT_EQ(out, nullptr) << one.name;
    out = &one;
  }
  return *out;
}

TEST(Contacts, AnOutlineLiesOnACornerOfAnother) {
  const StaticModel model(parse_scene(plate_on_block(0.7), "plate.toml"));
  const double angle = std::atan2(-0.3, 0.4) + std::asin(0.1 / 0.5), s = std::sqrt(0.25 - 0.01);
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::angle_of(model, found.x, "plate"), angle, tolerance(found.method));
    const Reaction& force = only_pressing(found.check);
    EXPECT_NEAR(norm(force.force), 50 * 0.3 * std::cos(angle) / s, 1e-5);
    EXPECT_NEAR(force.at.x, 0.4, tolerance(found.method));
    EXPECT_NEAR(force.at.y, -0.3, tolerance(found.method));
  }
}

TEST(Contacts, ACornerOfAnOutlineLiesOnAnother) {
  const double length = 0.35, diagonal = std::hypot(length, 0.1);
  const StaticModel model(parse_scene(plate_on_block(length), "plate.toml"));
  const double angle = std::asin(-0.3 / diagonal) + std::atan2(0.1, length);
  const double x = length * std::cos(angle) + 0.1 * std::sin(angle);
  ASSERT_GT(x, 0.1);
  ASSERT_LT(x, 0.4);
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::angle_of(model, found.x, "plate"), angle, tolerance(found.method));
    const Reaction& force = only_pressing(found.check);
    EXPECT_NEAR(std::abs(force.force.y), 50 * 0.3 * std::cos(angle) / x, 1e-5);
    EXPECT_NEAR(force.force.x, 0.0, 1e-5);
    EXPECT_NEAR(force.at.x, x, tolerance(found.method));
  }
}

// A plate may lean with its end on the side of the block where no corner of one is in the other, and yet go through it:
// by itself Newton's method converges to that, and is told to look elsewhere.
TEST(Contacts, OutlinesThatCrossAreNoEquilibrium) {
  const StaticModel model(parse_scene(plate_on_block(0.7, -0.83), "plate.toml"));
  const Equilibrium found = solve(model, by(Method::virtual_work, Seek::any));
  const double through = -0.82763505551160432;
  if (found.found()) {
    EXPECT_GT(std::abs(test::angle_of(model, found.x, "plate") - through), 0.1);
  }
  const Check judged = check(model, {through});
  EXPECT_FALSE(judged.keeps_contacts);
  EXPECT_NE(judged.objection.find("has outlines that cross each other"), std::string::npos) << judged.objection;
}

// With a cover of a given thickness: the same plate, thicker by that.
TEST(Contacts, OutlinesStayApartByTheirRadius) {
  Scene scene = parse_scene(plate_on_block(0.7), "plate.toml");
  set_value(scene, "contact.lies.radius", 0.05);
  const StaticModel model(scene);
  const Equilibrium found = solve(model, by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(found.found()) << found.why;
  EXPECT_NEAR(test::angle_of(model, found.x, "plate"), std::atan2(-0.3, 0.4) + std::asin(0.15 / 0.5), 1e-10);
}

TEST(Contacts, SaysWhatIsWrongWithTwoOutlines) {
  const auto with = [](const std::string& contact) {
    return test::message_of([&] {
      parse_scene(
          "[ground]\npoints = { A = [0, 0], B = [1, 0], C = [1, -1] }\n[body.b]\n"
          "points = { P = [0, 0], Q = [1, 0], R = [0, 1] }\n[[contact]]\n" +
              contact,
          "scene.toml");
    });
  };
  const std::string ground = "outline = [\"ground.A\", \"ground.B\", \"ground.C\"]\n";
  EXPECT_NE(with(ground + "against = [\"ground.A\", \"ground.B\"]").find("another body than that of the key outline"),
            std::string::npos);
  EXPECT_NE(with(ground + "point = \"b.P\"\nagainst = [\"b.P\", \"b.Q\"]").find("point"), std::string::npos);
  EXPECT_NE(with(ground + "against = [\"b.P\"]").find("expected two points or more"), std::string::npos);
  EXPECT_NE(with("against = [\"b.P\", \"b.Q\"]").find("outline"), std::string::npos);
  // Two holes have no corners that stand out.
  EXPECT_NE(with("outline = [\"ground.A\", \"ground.C\", \"ground.B\"]\nclosed = true\n"
                 "against = [\"b.P\", \"b.Q\", \"b.R\"]\nagainst_closed = true")
                .find("found two holes"),
            std::string::npos);
  EXPECT_EQ(with(ground + "closed = true\nagainst = [\"b.P\", \"b.Q\"]"), "");
}

}  // namespace
}  // namespace poise::contacts_test

// Gears, racks, belts, cams, ropes and sums that hold, against closed forms.

#include "model/couplings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/text_file.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/kinematics.hpp"
#include "motion/modes.hpp"
#include "motion/motion_model.hpp"
#include "motion/simulate.hpp"
#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"

namespace poise::couplings_test {
namespace {

using std::numbers::pi;

double tolerance(Method method) { return method == Method::virtual_work ? 1e-12 : 1e-7; }

/// Found by both methods and proved.
std::vector<Equilibrium> found_both_ways(const StaticModel& model, Seek seek = Seek::stable) {
  std::vector<Equilibrium> out;
  for (const Method method : {Method::virtual_work, Method::energy}) {
    out.push_back(solve(model, test::by(method, seek)));
    EXPECT_EQ(out.back().status, Status::confirmed) << out.back().why;
  }
  return out;
}

std::string message_of(const std::string& text) {
  return test::message_of([&] { parse_scene(text, "scene.toml"); });
}

// Sun 20, planet 30, ring 80 teeth, the ring held. Willis: (sun - carrier) / (0 - carrier) = -80 / 20, so that the sun
// turns five times as fast as the arm that carries the planet, and a torque on the sun acts fivefold on it.
const std::string planetary = read_text_file(test::dataset("planetary_gear.toml"));

TEST(Couplings, APlanetaryGearHasTheRatioOfWillis) {
  const StaticModel model(parse_scene(planetary, "planetary.toml"));
  const Mobility mobility = analyse_mobility(model);
  EXPECT_EQ(mobility.freedoms, 1);
  EXPECT_EQ(mobility.gruebler, 1);
  for (const Equilibrium& found : found_both_ways(model)) {
    const double near = tolerance(found.method);
    EXPECT_NEAR(test::angle_of(model, found.x, "arm"), 0.5, near);
    EXPECT_NEAR(test::angle_of(model, found.x, "sun"), 2.5, near);
    // The planet turns against the carrier by -20/30 of what the sun does.
    EXPECT_NEAR(test::angle_of(model, found.x, "planet"), 0.5 - 2.0 / 3.0 * 2.0, near);
    // The moment on the planet that the sun's 2 N m become, and the ring's, which balances it.
    EXPECT_NEAR(std::abs(test::reaction_of(found.check, "sun and planet").moment), 3.0, 1e-6);
    EXPECT_EQ(test::reaction_of(found.check, "sun and planet").kind, "gear");
  }
}

TEST(Couplings, AGearTrainDrivenOnceMovesAsWillisSays) {
  const Scene scene = parse_scene(planetary, "planetary.toml");
  const KinematicsResult swept = sweep(scene, {{.name = "sun", .from = 0.0, .to = 10.0}}, {.steps = 5});
  EXPECT_TRUE(swept.complete) << swept.why;
  ASSERT_EQ(swept.samples.size(), 6U);
  for (const KinematicSample& sample : swept.samples) {
    EXPECT_NEAR(sample.bodies[2].pose.angle, 0.2 * sample.drive[0], 1e-12);
    EXPECT_NEAR(sample.bodies[2].rate, 0.2, 1e-12);
  }
}

// The inertia of the train at the carrier: 2 + 0.3 5^2 + 0.5 (planet's rate)^2, planet = 1 - 2/3 4 = -5/3.
TEST(Couplings, AGearTrainSwingsWithItsReducedInertia) {
  const MotionModel model(parse_scene(planetary, "planetary.toml"));
  const StaticModel rest(parse_scene(planetary, "planetary.toml"));
  const Equilibrium found = solve(rest, test::by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(found.found());
  const Modes modes = modes_of(model, motion_coordinates(model, rest, found.x));
  ASSERT_TRUE(modes.known) << modes.why;
  ASSERT_EQ(modes.freedoms, 1);
  const double inertia = 2.0 + 0.3 * 25.0 + 0.5 * 25.0 / 9.0;
  EXPECT_NEAR(modes.vibrations.front().frequency, std::sqrt(20.0 / inertia) / (2 * pi), 1e-10);
}

TEST(Couplings, ARatioHasItsExactSensitivity) {
  // arm = motor / stiffness (1 + 1 / (ratio ratio')): of the sun's angle against the carrier.
  const Scene scene = parse_scene(planetary, "planetary.toml");
  const StaticModel model(scene);
  const Sensitivities found = sensitivities(model, {find_quantity(scene, "angle.arm")});
  ASSERT_EQ(found.of.size(), 1U) << found.why;
  const double i = 2.0 / 3.0, j = 0.375;
  for (const Sensitivity& by : found.of[0].by) {
    if (by.number == "gear.sun and planet.ratio") {
      EXPECT_NEAR(by.derivative, -0.1 / (i * i * j), 1e-10);
    }
    if (by.number == "gear.planet and ring.ratio") {
      EXPECT_NEAR(by.derivative, -0.1 / (i * j * j), 1e-10);
    }
    if (by.number == "load.motor") {
      EXPECT_NEAR(by.derivative, 0.25, 1e-12);
    }
  }
  const auto has = [&](const std::string& number) {
    return std::any_of(found.of[0].by.begin(), found.of[0].by.end(),
                       [&](const Sensitivity& by) { return by.number == number && by.why.empty(); });
  };
  EXPECT_TRUE(has("gear.sun and planet.ratio"));
  EXPECT_TRUE(has("gear.planet and ring.phase"));
}

TEST(Couplings, TwoGearsThatRepeatOneAnotherAreNamed) {
  const StaticModel model(parse_scene(planetary + R"(
    [[belt]]
    name = "repeats"
    bodies = ["sun", "planet"]
    carrier = "arm"
    ratio = 0.66666666666666666
    crossed = true
  )",
                                      "planetary.toml"));
  const Mobility mobility = analyse_mobility(model);
  EXPECT_EQ(mobility.freedoms, 1);
  EXPECT_NE(std::find(mobility.redundant.begin(), mobility.redundant.end(), "repeats"), mobility.redundant.end());
}

TEST(Couplings, ALockedTrainHasNoFreedomLeft) {
  EXPECT_THROW(assemble(StaticModel(parse_scene(planetary + R"(
    [[belt]]
    bodies = ["sun", "planet"]
    carrier = "arm"
    ratio = 2
  )",
                                                "locked.toml"))),
               InputError);
}

// Torque M on a pinion of radius r pushes the rack by M / r against a spring.
TEST(Couplings, ARackCarriesTheTorqueOverTheRadius) {
  const StaticModel model(parse_scene(R"(
    [units]
    length = "mm"
    [ground]
    points = { O = [0, 0], R = [0, -30] }
    [body.pinion]
    points = { O = [0, 0] }
    [body.rack]
    points = { R = [0, 0] }
    [[pin]]
    points = ["ground.O", "pinion.O"]
    [[slide]]
    name = "guide"
    points = ["ground.R", "rack.R"]
    axis = [1, 0]
    [[rack]]
    name = "teeth"
    slide = "guide"
    pinion = "pinion"
    radius = 30
    [[torque]]
    on = "pinion"
    value = 600
    [[spring]]
    slide = "guide"
    stiffness = 4
    free_length = 0
  )",
                                      "rack.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::travel_of(model, found.x, "guide"), 5e-3, tolerance(found.method));
    EXPECT_NEAR(test::angle_of(model, found.x, "pinion"), 5.0 / 30.0, tolerance(found.method));
    EXPECT_NEAR(norm(test::reaction_of(found.check, "teeth").force), 20.0, 1e-5);
  }
}

// A differential hoist as one sum: twice the block's height follows the difference of two drums.
TEST(Couplings, ASumOfAnglesAndLengthsHolds) {
  const StaticModel model(parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 0], B = [1, 0] }
    [body.drum]
    points = { O = [0, 0] }
    [body.block]
    points = { B = [0, 0] }
    mass = 30
    [[pin]]
    points = ["ground.O", "drum.O"]
    [[slide]]
    name = "hoist"
    points = ["ground.B", "block.B"]
    axis = [0, 1]
    [[coupling]]
    name = "chain"
    sum = [{ factor = 2, slide = "hoist" }, { factor = -0.02, bodies = ["ground", "drum"] }]
    value = 0
    [[torsion_spring]]
    bodies = ["ground", "drum"]
    stiffness = 6
  )",
                                      "hoist.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    // 300 N on half of 0.02 m.
    EXPECT_NEAR(test::angle_of(model, found.x, "drum"), -0.5, tolerance(found.method));
    EXPECT_NEAR(test::travel_of(model, found.x, "hoist"), -0.005, tolerance(found.method));
  }
}

// --- ropes ----------------------------------------------------------------------------------------------------------

// A block on a pulley of radius r that hangs in a rope with vertical parts: L = 2 h + pi r, tension W / 2.
std::string hanging_block(const std::string& rope, double half_span = 0.1) {
  return fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ A = [{0}, 0], B = [{1}, 0], O = [0, 0] }}
    [body.block]
    points = {{ C = [0, 0] }}
    mass = 8
    [[slide]]
    name = "guide"
    points = ["ground.O", "block.C"]
    axis = [0, -1]
    [[rope]]
    name = "rope"
    over = ["ground.A", {{ pulley = "block.C", radius = 0.1, turn = "counterclockwise" }}, "ground.B"]
    {2}
    [start]
    guide = 1
  )",
                     -half_span, half_span, rope);
}

TEST(Ropes, ABlockHangsInTwoParts) {
  const StaticModel model(parse_scene(hanging_block("length = 3"), "block.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::travel_of(model, found.x, "guide"), 0.5 * (3 - 0.1 * pi), tolerance(found.method));
    const Reaction& tension = test::reaction_of(found.check, "rope");
    EXPECT_NEAR(tension.axial, 40.0, 1e-6);
    EXPECT_EQ(tension.kind, "rope");
  }
}

TEST(Ropes, AStretchingRopeIsASpringThatPullsOnly) {
  const StaticModel model(parse_scene(hanging_block("stiffness = 2000\nfree_length = 3"), "block.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    // 40 N stretch it by 20 mm, the block sinks by half of that.
    EXPECT_NEAR(test::travel_of(model, found.x, "guide"), 0.5 * (3.02 - 0.1 * pi), tolerance(found.method));
  }
}

// Oblique parts: with the slope angle a of a part against the vertical, h = half_span / tan a + ..., tension W / (2 cos
// a); the length is that of the tangents by elementary geometry.
TEST(Ropes, ObliquePartsCarryTheirShare) {
  const double half_span = 0.6, length = 3.0, r = 0.1;
  const StaticModel model(parse_scene(hanging_block("length = 3", half_span), "block.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    const double h = test::travel_of(model, found.x, "guide");
    const double apart = std::hypot(half_span, h);
    const double straight = std::sqrt(apart * apart - r * r);
    // From the vertical: that of the line of centres, less the angle of the tangent against it.
    const double slope = std::atan2(half_span, h) - std::asin(r / apart);
    EXPECT_NEAR(2 * straight + r * (pi - 2 * slope), length, 1e-7);
    EXPECT_NEAR(test::reaction_of(found.check, "rope").axial, 40.0 / std::cos(slope), 1e-5);
  }
}

TEST(Ropes, ARopeThatIsLongEnoughIsSlack) {
  const StaticModel model(parse_scene(hanging_block("length = 3") + R"(
    [[stop]]
    name = "floor"
    slide = "guide"
    max = 1.2
  )",
                                      "block.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::travel_of(model, found.x, "guide"), 1.2, tolerance(found.method));
    for (const Reaction& reaction : found.check.reactions) EXPECT_NE(reaction.name, "rope");
  }
}

// Of two weights on a rope over a pulley the lighter is drawn up to its rim, where no straight part is left.
TEST(Ropes, ARopeWithoutStraightPartIsNamed) {
  const auto scene = [](double light) {
    return parse_scene(fmt::format(R"(
      gravity = [0, -10]
      [ground]
      points = {{ O = [0, 0], L = [0.1, 0], R = [-0.1, 0] }}
      [body.light]
      points = {{ A = [0, 0] }}
      mass = 1
      [body.heavy]
      points = {{ A = [0, 0] }}
      mass = 3
      [[slide]]
      name = "up"
      points = ["ground.O", "light.A"]
      axis = [0, -1]
      [[slide]]
      name = "down"
      points = ["ground.R", "heavy.A"]
      axis = [0, -1]
      [[rope]]
      name = "cable"
      over = ["light.A", {{ pulley = "ground.O", radius = 0.1, turn = "counterclockwise" }}, "heavy.A"]
      stiffness = 1e4
      free_length = 2
      [start]
      up = {}
      down = 1
    )",
                                   light),
                       "weights.toml");
  };
  const StaticModel inside(scene(0.05));
  EXPECT_NE(solve(inside, inside.start())
                .why.find("rope \"cable\" has no straight part: its point \"light.A\" reaches the "
                          "rim of its pulley \"ground.O\""),
            std::string::npos)
      << solve(inside, inside.start()).why;
  const MotionModel model(scene(1.0));
  MotionOptions options;
  options.duration = 5;
  const Motion motion = simulate(model, start_motion(model, {}), options);
  EXPECT_EQ(motion.status, MotionStatus::stuck);
  EXPECT_NE(motion.why.find("rope \"cable\" has no straight part"), std::string::npos) << motion.why;
  const std::vector<double> q = test::q_at(motion, motion.trajectory.nodes() - 1);
  EXPECT_NEAR(q[static_cast<std::size_t>(test::coordinate_of(model, "up"))], 0.1, 1e-4);
}

// A rope that would have to pass on the other side of its pulley does not touch it.
TEST(Ropes, ARopeOffItsPulleyIsNoEquilibrium) {
  const std::string text = R"(
    gravity = [0, -10]
    [ground]
    points = { A = [-1, 0], B = [1, 0], C = [0, 0.3] }
    [body.load]
    points = { P = [0, 0] }
    mass = 1
    [[slide]]
    name = "guide"
    points = ["ground.B", "load.P"]
    axis = [0, -1]
    [[rope]]
    over = ["ground.A", { pulley = "ground.C", radius = 0.1, turn = "counterclockwise" }, "load.P"]
    length = 2.5
    [start]
    guide = 0.3
  )";
  const Equilibrium found =
      solve(StaticModel(parse_scene(text, "off.toml")), test::by(Method::virtual_work, Seek::any));
  EXPECT_NE(found.status, Status::confirmed);
}

// --- cams -----------------------------------------------------------------------------------------------------------

// The cam of datasets/ with more in its scene.
std::string cam(const std::string& more) { return read_text_file(test::dataset("cam_follower.toml")) + more; }

TEST(Cams, TheFollowersWeightTurnsTheCamBack) {
  const StaticModel model(parse_scene(cam(""), "cam.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    const double angle = test::angle_of(model, found.x, "cam");
    const double s = angle / (2 * pi / 3);
    const double lift = 0.02 * s * s * s * (10 - 15 * s + 6 * s * s);
    const double slope = 0.02 * 30 * s * s * (1 - s) * (1 - s) / (2 * pi / 3);
    EXPECT_NEAR(test::travel_of(model, found.x, "guide"), 0.05 + lift, 1e-7);
    EXPECT_NEAR(0.01 * 180 / pi * (70 * pi / 180 - angle), 30 * slope, 1e-5);
    EXPECT_NEAR(test::reaction_of(found.check, "lobe").force.y, 30.0, 1e-6);
  }
}

TEST(Cams, AFollowerThatIsPulledUpLiftsOff) {
  const StaticModel model(parse_scene(cam(R"(
    [[force]]
    at = "follower.T"
    vector = [0, 50]
    [[stop]]
    name = "above"
    slide = "guide"
    max = 0.1
  )"),
                                      "cam.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::travel_of(model, found.x, "guide"), 0.1, tolerance(found.method));
    EXPECT_NEAR(test::angle_of(model, found.x, "cam"), 70 * pi / 180, tolerance(found.method));
  }
}

TEST(Cams, AGuidedFollowerIsPulledDown) {
  std::string text = cam(R"(
    [[force]]
    at = "follower.T"
    vector = [0, 50]
  )");
  text.insert(text.find("base = 0.05"), "guided = true\n    ");
  const StaticModel guided(parse_scene(text, "cam.toml"));
  EXPECT_EQ(analyse_mobility(guided).freedoms, 1);
  for (const Equilibrium& found : found_both_ways(guided)) {
    EXPECT_NEAR(test::reaction_of(found.check, "lobe").force.y, -20.0, 1e-6);
  }
}

// --- input ----------------------------------------------------------------------------------------------------------

TEST(Couplings, TakeTheirConstantFromTheStart) {
  const Scene scene = parse_scene(planetary + "[start]\nsun = 1\nplanet = 2\narm = 0.5\n", "planetary.toml");
  EXPECT_NEAR(get_value(scene, "gear.sun and planet.phase"), 1.5 + 2.0 / 3.0 * 0.5, 1e-15);
  EXPECT_NEAR(get_value(scene, "gear.planet and ring.phase"), -0.5 - 0.375 * 1.5, 1e-15);
}

// A carrier without a guess that a slide keeps at 0.5 to the ground, by way of a body that a weld turns by 0.2 more.
TEST(Couplings, TakeTheirConstantFromAnglesThatJointsKeep) {
  const Scene scene = parse_scene(R"(
    ground.points = { O = [0, 0], S = [1, 0] }
    body.sledge.points = { O = [0, 0] }
    body.carrier.points = { O = [0, 0] }
    body.wheel.points = { O = [0, 0] }
    slide = [{ points = ["ground.S", "sledge.O"], axis = [1, 0], angle = 0.3 }]
    weld = [{ points = ["carrier.O", "sledge.O"], angle = -0.2 }]
    pin = [{ points = ["ground.O", "wheel.O"] }]
    gear = [{ name = "g", bodies = ["wheel", "ground"], carrier = "carrier", ratio = 2 }]
    start.wheel = 0.1
  )",
                                  "kept.toml");
  // (0 - 0.5) + 2 (0.1 - 0.5)
  EXPECT_NEAR(get_value(scene, "gear.g.phase"), -1.3, 1e-15);
}

TEST(Couplings, AreTheSameInOtherUnits) {
  Scene scene = parse_scene(cam(""), "cam.toml");
  const double before = scene.stops[0].on.terms[1].factor;
  Scene other = scaled(scene, {.length = 0.25, .force = 8.0});
  EXPECT_EQ(other.stops[0].on.terms[1].factor, 4 * before);
  EXPECT_EQ(other.stops[0].min, 4 * scene.stops[0].min);
  scale(other, {.length = 4.0, .force = 0.125});
  EXPECT_EQ(other.stops[0].on.terms[1].factor, before);
}

TEST(Couplings, NameWhatIsWrong) {
  const auto with = [&](const std::string& more) { return message_of(planetary + more); };
  EXPECT_NE(with("[[gear]]\nbodies = [\"sun\", \"planet\"]\n").find("ratio"), std::string::npos);
  EXPECT_NE(with("[[gear]]\nbodies = [\"sun\", \"plannet\"]\nratio = 1\n").find("did you mean \"planet\""),
            std::string::npos);
  EXPECT_NE(with("[[gear]]\nbodies = [\"sun\", \"planet\"]\nratio = -1\n").find("> 0"), std::string::npos);
  EXPECT_NE(with("[[gear]]\nbodies = [\"sun\", \"planet\"]\ncarrier = \"sun\"\nratio = 1\n").find("carries both"),
            std::string::npos);
  EXPECT_NE(with("[[rope]]\nover = [\"ground.O\"]\nlength = 1\n").find("two points"), std::string::npos);
  EXPECT_NE(with("[[rope]]\nover = [\"ground.O\", \"arm.Q\"]\n").find("length"), std::string::npos);
  EXPECT_NE(with("[[coupling]]\nsum = [{ factor = 1, x = \"arm.Q\" }]\n").find("value"), std::string::npos);
  EXPECT_NE(with("[[gear]]\nname = \"sun and planet\"\nbodies = [\"sun\", \"planet\"]\nratio = 1\n").find("taken"),
            std::string::npos);
  const auto cam_with = [&](const std::string& from, const std::string& to) {
    std::string text = cam("");
    text.replace(text.find(from), from.size(), to);
    return message_of(text);
  };
  EXPECT_NE(cam_with("{ to = 360, law = \"dwell\" }", "{ to = 350, law = \"dwell\" }").find("full turn"),
            std::string::npos);
  EXPECT_NE(cam_with("{ to = 300, lift = 0, law", "{ to = 300, lift = 0.5, law").find("same lift"), std::string::npos);
  EXPECT_NE(cam_with("\"cycloidal\"", "\"cyclodal\"").find("did you mean \"cycloidal\""), std::string::npos);
  EXPECT_NE(cam_with("{ to = 180, law", "{ to = 100, law").find("greater angle"), std::string::npos);
}

}  // namespace
}  // namespace poise::couplings_test

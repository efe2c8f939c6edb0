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

// --- chains ---------------------------------------------------------------------------------------------------------

/// A torque on sprocket a, whose shaft is at the origin, and a torsion spring on b, with these centres in the
/// sprockets.
std::string chain_drive(Vec2 a, Vec2 b, const std::string& coupling) {
  return fmt::format(R"(
    [ground]
    points = {{ O = [0, 0], Q = [0.3, 0.4] }}
    [body.a]
    points = {{ O = [0, 0], C = [{}, {}] }}
    inertia = 0.02
    [body.b]
    points = {{ Q = [0, 0], C = [{}, {}] }}
    inertia = 0.05
    [[pin]]
    name = "shaft a"
    points = ["ground.O", "a.O"]
    [[pin]]
    name = "shaft b"
    points = ["ground.Q", "b.Q"]
    [[torque]]
    name = "motor"
    on = "a"
    value = 6
    [[torsion_spring]]
    name = "load"
    bodies = ["ground", "b"]
    stiffness = 12
    {}
  )",
                     a.x, a.y, b.x, b.y, coupling);
}

std::string chain_of(const std::string& more) {
  return "[[chain]]\nname = \"chain\"\na = \"a.C\"\nb = \"b.C\"\nradius_a = 0.05\nradius_b = 0.08\n" + more;
}

/// The straight line that touches both circles, from one with centre A to one with centre B, by their distances from
/// it: counted to the right of its direction, as the centres are of a strand that passes clockwise.
struct Tangent {
  Vec2 along{}, from{};
};
Tangent tangent(Vec2 A, Vec2 B, double right_a, double right_b) {
  const Vec2 d = B - A;
  // The direction in which B is by right_b - right_a further to the right than A.
  const Vec2 along = unit(std::atan2(d.y, d.x) + std::asin((right_b - right_a) / norm(d)));
  return {along, A + right_a * quarter_turn(along)};
}

/// Of a line that pulls, about a shaft: its torque per force.
double arm_about(Vec2 shaft, const Tangent& line) {
  const Vec2 r = line.from - shaft;
  return r.x * line.along.y - r.y * line.along.x;
}

struct Strand {
  std::string keys;
  double right_a, right_b;
};
const std::vector<Strand> strands{{"", -0.05, -0.08},
                                  {"turn = \"clockwise\"", 0.05, 0.08},
                                  {"crossed = true", -0.05, 0.08},
                                  {"turn = \"clockwise\"\ncrossed = true", 0.05, -0.08}};

// With the centres on the shafts it is a belt, whose ratio is that of the radii.
TEST(Chains, OnTheirShaftsTheyAreBelts) {
  for (const bool is_crossed : {false, true}) {
    const std::string crossed = is_crossed ? "crossed = true\n" : "turn = \"clockwise\"\n";
    const StaticModel belt(
        parse_scene(chain_drive({}, {},
                                std::string("[[belt]]\nname = \"chain\"\nbodies = [\"a\", \"b\"]\nratio = 0.625\n") +
                                    (is_crossed ? "crossed = true\n" : "")),
                    "belt.toml"));
    const StaticModel chain(parse_scene(chain_drive({}, {}, chain_of(crossed)), "chain.toml"));
    EXPECT_EQ(analyse_mobility(chain).freedoms, 1);
    EXPECT_EQ(analyse_mobility(chain).gruebler, 1);
    const Equilibrium known = solve(belt, test::by(Method::virtual_work, Seek::stable));
    for (const Equilibrium& found : found_both_ways(chain)) {
      EXPECT_NEAR(test::angle_of(chain, found.x, "a"), test::angle_of(belt, known.x, "a"), tolerance(found.method));
      EXPECT_NEAR(test::angle_of(chain, found.x, "b"), test::angle_of(belt, known.x, "b"), tolerance(found.method));
      EXPECT_NEAR(norm(test::reaction_of(found.check, "chain").force), 6 / 0.05, 1e-5);
    }
  }
}

// Over more than two turns of the sprocket: the strand goes round with none.
TEST(Chains, TheirRatioIsThatOfTheArmsOfTheStrand) {
  const Vec2 a{0.02, 0.005}, b{-0.01, 0.03}, Q{0.3, 0.4};
  for (const Strand& strand : strands) {
    const Scene scene = parse_scene(chain_drive(a, b, chain_of(strand.keys)), "chain.toml");
    const KinematicsResult swept = sweep(scene, {{.name = "a", .from = 0.0, .to = 14.0}}, {.steps = 28});
    ASSERT_TRUE(swept.complete) << swept.why;
    for (const KinematicSample& sample : swept.samples) {
      const Vec2 A = sample.bodies[1].pose.world(a), B = sample.bodies[2].pose.world(b);
      const Tangent line = tangent(A, B, strand.right_a, strand.right_b);
      EXPECT_NEAR(sample.bodies[2].rate, arm_about({}, line) / arm_about(Q, line), 1e-10);
      EXPECT_NEAR(sample.bodies[3].pose.angle, std::atan2(line.along.y, line.along.x), 1e-10);
    }
  }
}

// The strand winds off a and on b: with the rims' arcs from one mark in each sprocket it stays as long as it is. All
// may be carried round by an arm, and the strand with them.
TEST(Chains, KeepTheirLengthWhileTheyAreCarriedRound) {
  const std::string arm = R"(
    [body.arm]
    points = { O = [0, 0], P = [0, 0], Q = [0.3, 0.4] }
    [[pin]]
    points = ["ground.O", "arm.O"]
  )";
  std::string text = chain_drive({0.02, 0.005}, {-0.01, 0.03}, chain_of("") + arm);
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("[\"ground.O\", \"a.O\"]", "[\"arm.P\", \"a.O\"]");
  replace("[\"ground.Q\", \"b.Q\"]", "[\"arm.Q\", \"b.Q\"]");
  const Scene scene = parse_scene(text, "chain.toml");
  const KinematicsResult swept =
      sweep(scene, {{.name = "arm", .from = 0.0, .to = 9.0}, {.name = "a", .from = 0.0, .to = 5.0}}, {.steps = 18});
  ASSERT_TRUE(swept.complete) << swept.why;
  double turned = 0.0, first = 0.0, before = 0.0;
  for (const KinematicSample& sample : swept.samples) {
    const Vec2 A = sample.bodies[1].pose.world({0.02, 0.005}), B = sample.bodies[2].pose.world({-0.01, 0.03});
    const Tangent line = tangent(A, B, -0.05, -0.08);
    const double straight = dot(B - A, line.along);
    const double angle = std::atan2(line.along.y, line.along.x);
    const bool is_first = &sample == &swept.samples.front();
    turned = is_first ? angle : turned + std::remainder(angle - before, 2 * pi);
    before = angle;
    const double length =
        straight + 0.05 * (turned - sample.bodies[1].pose.angle) - 0.08 * (turned - sample.bodies[2].pose.angle);
    if (is_first) first = length;
    EXPECT_NEAR(length, first, 1e-12);
  }
  EXPECT_GT(turned, 2 * pi);
}

// The motor's torque over the arm of the strand is its tension, which loads both shafts along it.
TEST(Chains, TheTensionLoadsTheShafts) {
  const Vec2 a{0.02, 0.005}, b{-0.01, 0.03}, Q{0.3, 0.4};
  for (const Strand& strand : strands) {
    const StaticModel model(parse_scene(chain_drive(a, b, chain_of(strand.keys)), "chain.toml"));
    for (const Equilibrium& found : found_both_ways(model)) {
      const double at_b = test::angle_of(model, found.x, "b");
      const Tangent line = tangent(test::place_of(model, found.x, "a.C"), test::place_of(model, found.x, "b.C"),
                                   strand.right_a, strand.right_b);
      const double tension = -6 / arm_about({}, line);
      EXPECT_NEAR(12 * at_b, -tension * arm_about(Q, line), 1e-5);
      EXPECT_NEAR(norm(test::reaction_of(found.check, "chain").force), std::abs(tension), 1e-4);
      EXPECT_LT(norm(test::reaction_of(found.check, "chain line").force), 1e-5);
      EXPECT_NEAR(norm(test::reaction_of(found.check, "shaft a").force), std::abs(tension), 1e-4);
      EXPECT_NEAR(norm(test::reaction_of(found.check, "shaft b").force), std::abs(tension), 1e-4);
    }
  }
}

// One that may go slack holds where the motor winds it on, and lets go where the motor would push.
TEST(Chains, MayGoSlack) {
  const std::string held = R"(
    [[torsion_spring]]
    bodies = ["ground", "a"]
    stiffness = 3
  )";
  const auto drive = [&](const std::string& keys) {
    return parse_scene(chain_drive({0.02, 0.005}, {-0.01, 0.03}, chain_of(keys) + held), "chain.toml");
  };
  const StaticModel tight(drive("turn = \"clockwise\"\nslack = true")), both(drive("turn = \"clockwise\""));
  const Equilibrium known = solve(both, test::by(Method::virtual_work, Seek::stable));
  for (const Equilibrium& found : found_both_ways(tight)) {
    EXPECT_NEAR(test::angle_of(tight, found.x, "a"), test::angle_of(both, known.x, "a"), tolerance(found.method));
  }
  const StaticModel loose(drive("slack = true"));
  for (const Equilibrium& found : found_both_ways(loose)) {
    EXPECT_NEAR(test::angle_of(loose, found.x, "a"), 2.0, tolerance(found.method));
    EXPECT_NEAR(test::angle_of(loose, found.x, "b"), 0.0, tolerance(found.method));
  }
}

TEST(Chains, NumbersHaveTheirExactSensitivities) {
  for (const Strand& strand : strands) {
    const Scene scene = parse_scene(chain_drive({0.02, 0.005}, {-0.01, 0.03}, chain_of(strand.keys)), "chain.toml");
    const Sensitivities found = sensitivities(StaticModel(scene), {find_quantity(scene, "angle.a")});
    ASSERT_EQ(found.of.size(), 1U) << found.why;
    const auto angle_with = [&](const std::string& number, double value) {
      Scene changed = scene;
      set_value(changed, number, value);
      const StaticModel model(changed);
      const Equilibrium at = solve(model, test::by(Method::virtual_work, Seek::stable));
      EXPECT_EQ(at.status, Status::confirmed) << at.why;
      return test::angle_of(model, at.x, "a");
    };
    int met = 0;
    for (const std::string number :
         {"chain.chain.radius_a", "chain.chain.radius_b", "chain.chain.length", "point.a.C.x", "point.b.C.y"}) {
      for (const Sensitivity& by : found.of[0].by) {
        if (by.number != number) continue;
        ++met;
        constexpr double h = 2e-6;
        const double value = get_value(scene, number);
        const double slope = (angle_with(number, value + h) - angle_with(number, value - h)) / (2 * h);
        EXPECT_NEAR(by.derivative, slope, 1e-6 * (1 + std::abs(slope))) << number << " " << strand.keys;
      }
    }
    EXPECT_EQ(met, 5);
  }
}

TEST(Chains, AreTheSameInOtherUnits) {
  const Scene scene = parse_scene(chain_drive({0.02, 0.005}, {}, chain_of("crossed = true")), "chain.toml");
  Scene other = scaled(scene, {.length = 0.25, .force = 8.0});
  for (const std::size_t row : {0U, 1U, 2U}) EXPECT_EQ(other.stops[row].min, 4 * scene.stops[row].min);
  EXPECT_EQ(other.stops[0].on.terms[1].factor, -0.2);
  EXPECT_EQ(other.stops[1].min, -4 * 0.13);
}

TEST(Chains, NameWhatIsWrong) {
  const auto with = [&](const std::string& chain) { return message_of(chain_drive({}, {}, "[[chain]]\n" + chain)); };
  const auto has = [&](const std::string& chain, const std::string& words) {
    EXPECT_NE(with(chain).find(words), std::string::npos) << with(chain);
  };
  const std::string ends = "a = \"a.C\"\nb = \"b.C\"\n";
  has(ends + "radius_a = 0.1\n", "radius_b");
  has(ends + "radius_a = 0.1\nradius_b = 0\n", "> 0");
  has("a = \"a.C\"\nradius_a = 0.1\nradius_b = 0.1\n", "expected the key b");
  has("a = \"a.C\"\nb = \"a.O\"\nradius_a = 0.1\nradius_b = 0.1\n", "another body than that of the key a");
  has("a = \"a.C\"\nb = \"b.D\"\nradius_a = 0.1\nradius_b = 0.1\n", "expected a point of \"b\"");
  has(ends + "radius_a = 0.1\nradius_b = 0.1\nturn = \"clokwise\"\n", "did you mean \"clockwise\"");
  has(ends + "radius_a = 0.1\nradius_b = 0.7\n", "move the centres apart");
  has(ends + "radius_a = 0.2\nradius_b = 0.4\ncrossed = true\n", "sum of the radii, 0.6, found 0.5");
  has(ends + "radius_a = 0.1\nradius_b = 0.1\nbodies = [\"a\", \"b\"]\n", "bodies");
}

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

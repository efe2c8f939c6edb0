// Internal loads against closed forms, and against sums from the other end of the line.

#include "statics/equilibrium/link_loads.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise::link_loads_test {
namespace {

/// A scene with all of its links.
struct Loaded {
  explicit Loaded(const std::string& text) : Loaded(parse_scene(text, "beam.toml")) {}
  explicit Loaded(Scene of) : model(std::move(of)), equilibrium(solve_or_hold(model)) {
    links = link_loads(model.scene(), model.poses(equilibrium.x), equilibrium.check);
  }

  /// The state at s of a link, behind what acts there.
  LinkState at(std::size_t link, double s) const {
    const LinkPiece* piece = &links[link].pieces.front();
    for (const LinkPiece& one : links[link].pieces) {
      if (one.from <= s) piece = &one;
    }
    return links[link].at(*piece, s);
  }

  StaticModel model;
  Equilibrium equilibrium;
  std::vector<LinkLoads> links;
};

Scene dataset(const std::string& name) { return read_scene(std::string(POISE_SOURCE_DIR) + "/datasets/" + name); }

constexpr double stiffness = 2.1e11 * 8e-6;

const std::string beam = R"(
gravity = [0, -10]
[ground]
points = { A = [0, 0], B = [4, 0] }
[body.beam]
points = { A = [0, 0], B = [4, 0] }
mass = 60
center = [2, 0]
[body.beam.section]
area = 3e-3
second_moment = 8e-6
modulus = 2.1e11
height = 0.2
)";

const std::string on_two_supports = beam + R"(
[[pin]]
points = ["ground.A", "beam.A"]
[[pin_in_slot]]
points = ["ground.B", "beam.B"]
axis = [1, 0]
)";

TEST(LinkLoads, WeightOfABeamOnTwoSupports) {
  const Loaded found(on_two_supports);
  const LinkLoads& link = found.links.at(0);
  ASSERT_EQ(link.why, "");
  const double q = 60 * 10 / 4.0, length = 4.0;
  EXPECT_NEAR(link.moment.value, q * length * length / 8, 1e-10);
  EXPECT_NEAR(link.moment.s, 2.0, 1e-12);
  EXPECT_NEAR(found.at(0, 0.0).shear, q * length / 2, 1e-10);
  EXPECT_NEAR(found.at(0, 4.0).shear, -q * length / 2, 1e-10);
  EXPECT_NEAR(link.normal.value, 0.0, 1e-10);
  EXPECT_NEAR(link.deflection.value, 5 * q * std::pow(length, 4) / (384 * stiffness), 1e-15);
  EXPECT_NEAR(link.deflection.s, 2.0, 1e-6);
  EXPECT_NEAR(found.at(0, 2.0).deflection.y, -link.deflection.value, 1e-15);
  EXPECT_NEAR(link.turn_first, -q * std::pow(length, 3) / (24 * stiffness), 1e-16);
  EXPECT_NEAR(link.turn_last, q * std::pow(length, 3) / (24 * stiffness), 1e-16);
  // Sagging: the lower fibres, on the right of the line, are stretched.
  EXPECT_NEAR(link.tension.value, 300 * 0.1 / 8e-6, 1e-6);
  EXPECT_NEAR(found.at(0, 2.0).stress_right, link.tension.value, 1e-6);
  EXPECT_NEAR(link.compression.value, -300 * 0.1 / 8e-6, 1e-6);
  EXPECT_LT(link.imbalance, 1e-13);
  EXPECT_FALSE(link.buckling_factor);
}

// The force of a coupling is no joint's: it acts on the measures that it binds.
TEST(LinkLoads, ACouplingHoldsABeamAsASupportDoes) {
  const Loaded found(beam + R"(
[[pin]]
points = ["ground.A", "beam.A"]
[[coupling]]
sum = [{ factor = 2, y = "beam.B" }]
value = 0
)");
  const LinkLoads& link = found.links.at(0);
  ASSERT_EQ(link.why, "");
  EXPECT_NEAR(link.moment.value, 150 * 16.0 / 8, 1e-10);
  EXPECT_NEAR(found.at(0, 4.0).shear, -300, 1e-10);
  EXPECT_LT(link.imbalance, 1e-13);
}

TEST(LinkLoads, FibresAtUnequalDistances) {
  const Loaded found(on_two_supports + "[[force]]\nat = \"beam.B\"\nvector = [9000, 0]\n");
  Scene scene = found.model.scene();
  set_value(scene, "body.beam.section.left", 0.05);
  const Loaded eccentric(scene);
  EXPECT_NEAR(eccentric.links.at(0).tension.value, 9000 / 3e-3 + 300 * 0.15 / 8e-6, 1e-6);
  EXPECT_NEAR(eccentric.at(0, 2.0).stress_left, 9000 / 3e-3 - 300 * 0.05 / 8e-6, 1e-6);
  EXPECT_THROW(set_value(scene, "body.beam.section.left", 0.21), InputError);
  EXPECT_THROW(set_value(scene, "body.beam.section.height", 0.04), InputError);
}

TEST(LinkLoads, Cantilever) {
  const Loaded found(beam + R"(
[[weld]]
points = ["ground.A", "beam.A"]
[[force]]
at = "beam.B"
vector = [0, -500]
)");
  const LinkLoads& link = found.links.at(0);
  ASSERT_EQ(link.why, "");
  const double q = 150, load = 500, length = 4.0;
  EXPECT_NEAR(link.moment.value, -(load * length + q * length * length / 2), 1e-9);
  EXPECT_EQ(link.moment.s, 0.0);
  EXPECT_NEAR(found.at(0, 3.0).moment, -(load + q / 2), 1e-9);
  EXPECT_NEAR(found.at(0, 3.0).shear, load + q, 1e-10);
  // The line through both ends turns against the clamp by the deflection of the tip over the length.
  const double tip = load * std::pow(length, 3) / (3 * stiffness) + q * std::pow(length, 4) / (8 * stiffness);
  EXPECT_NEAR(link.turn_first * length, tip, 1e-14);
  EXPECT_NEAR(link.turn_first - link.turn_last,
              load * length * length / (2 * stiffness) + q * std::pow(length, 3) / (6 * stiffness), 1e-15);
}

TEST(LinkLoads, DistributedLoadOnAPartOfTheLine) {
  Scene scene = parse_scene(on_two_supports + R"(
[[distributed_load]]
name = "q"
points = ["beam.A", "beam.B"]
vector = [0, -800]
)",
                            "beam.toml");
  scene.gravity = {};
  // Over the first quarter, given against the direction of the line.
  const PointRef quarter = scene.add_point(1, "Q", {1, 0});
  scene.forces[0].to = scene.forces[0].at;
  scene.forces[0].at = quarter;
  const Loaded found(scene);
  ASSERT_EQ(found.links.at(0).why, "");
  const double left = 800 * 3.5 / 4;
  EXPECT_NEAR(found.at(0, 0.0).shear, left, 1e-10);
  EXPECT_NEAR(found.links[0].moment.value, left * left / (2 * 800), 1e-9);
  EXPECT_NEAR(found.links[0].moment.s, left / 800, 1e-12);
  EXPECT_NEAR(found.at(0, 2.5).shear, -800 * 0.5 / 4, 1e-10);
}

TEST(LinkLoads, ThreeHingedPortal) {
  const Loaded found(dataset("structures/three_hinged_portal.toml"));
  ASSERT_EQ(found.links.size(), 3U);
  for (const LinkLoads& link : found.links) ASSERT_EQ(link.why, "");
  const double q = 12e3, wind = 9e3, span = 6, height = 4;
  const double thrust = q * span * span / (8 * height);
  const double up = q * span / 2, tilt = wind * height / span;
  const LinkLoads& post = found.links[0];
  EXPECT_NEAR(post.normal.value, -(up - tilt), 1e-7);
  // The line goes up, its left is outside, and that is stretched.
  EXPECT_NEAR(post.moment.value, -(thrust - wind / 2) * height, 1e-7);
  EXPECT_NEAR(post.moment.s, height, 1e-12);
  EXPECT_NEAR(found.at(0, 1.0).moment, -(thrust - wind / 2) * 1.0, 1e-7);
  const LinkState corner = found.at(1, 0.0), ridge = found.at(1, 3.0);
  EXPECT_NEAR(corner.normal, -(thrust + wind / 2), 1e-7);
  EXPECT_NEAR(corner.shear, up - tilt, 1e-7);
  EXPECT_NEAR(corner.moment, -(thrust - wind / 2) * height, 1e-7);
  EXPECT_NEAR(ridge.moment, 0.0, 1e-7);
  EXPECT_NEAR(ridge.shear, -tilt, 1e-7);
  const LinkLoads& right = found.links[2];
  EXPECT_NEAR(std::abs(right.moment.value), (thrust + wind / 2) * height, 1e-7);
  EXPECT_NEAR(right.moment.s, 3.0, 1e-12);
  EXPECT_NEAR(right.normal.value, -(up + tilt), 1e-7);
  EXPECT_NEAR(found.at(2, 7.0).moment, 0.0, 1e-7);
  for (const LinkLoads& link : found.links) EXPECT_LT(link.imbalance, 1e-12);
}

/// A bent link that hangs from a pin in an equilibrium, with a spring, a follower load beside its line and a couple.
const std::string crane = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], S = [-1, 2] }
[body.jib]
points = { O = [0, 0], K = [2, 0.3], T = [3, 1.2], beside = [1.2, 0.9] }
mass = 40
center = [1.4, 0.5]
[body.jib.section]
profile = "box 0.08x0.12x0.006"
modulus = 2e11
line = ["O", "K", "T"]
[body.hook]
points = { T = [0, 0], H = [0, -0.6] }
mass = 30
center = [0, -0.6]
[[pin]]
name = "foot"
points = ["ground.O", "jib.O"]
[[pin]]
name = "tip"
points = ["jib.T", "hook.T"]
[[spring]]
name = "stay"
points = ["ground.S", "jib.K"]
stiffness = 800
free_length = 1.5
[[force]]
name = "F"
at = "jib.beside"
vector = [20, -55]
follows = "jib"
[[distributed_load]]
name = "ice"
points = ["jib.O", "jib.K"]
vector = [3, -18]
follows = "hook"
[[torque]]
name = "M"
at = "jib.K"
value = 25
[start]
jib = 0.3
)";

TEST(LinkLoads, AgreeWithSumsFromTheOtherEnd) {
  const Loaded found(crane);
  ASSERT_TRUE(found.equilibrium.found()) << found.equilibrium.why;
  const LinkLoads& link = found.links.at(0);
  ASSERT_EQ(link.why, "");
  EXPECT_LT(link.imbalance, 1e-12);
  std::size_t arms = 0;
  for (const LinkAction& action : link.actions) arms += action.arm > 0.0;
  EXPECT_EQ(arms, 2U);  // the weight and F
  const double knee = std::hypot(2, 0.3);
  const auto place = [&](double s) {
    const Vec2 first = (1 / knee) * Vec2{2, 0.3}, second = (1 / std::hypot(1, 0.9)) * Vec2{1, 0.9};
    return s <= knee ? s * first : knee * first + (s - knee) * second;
  };
  for (const double s : {0.1, 0.9, 1.7, knee + 0.05, knee + 0.8}) {
    Vec2 sum{};
    double moment = 0.0;
    const Vec2 cut = place(s);
    for (const LinkAction& action : link.actions) {
      if (action.s < s) continue;
      sum += action.force;
      moment += action.moment + cross(place(action.s) - cut, action.force);
    }
    for (const LineAction& action : link.line_actions) {
      constexpr int parts = 1000;  // the middles of even parts give the exact moment of each on a straight line
      for (int k = 0; k < parts; ++k) {
        const double from = std::max(action.from, s);
        if (from >= action.to) break;
        const double step = (action.to - from) / parts;
        const Vec2 force = step * action.per_length;
        sum += force;
        moment += cross(place(from + (k + 0.5) * step) - cut, force);
      }
    }
    const LinkState state = found.at(0, s);
    const Vec2 along = s < knee ? (1 / knee) * Vec2{2, 0.3} : (1 / std::hypot(1, 0.9)) * Vec2{1, 0.9};
    EXPECT_NEAR(state.normal, dot(sum, along), 1e-9) << s;
    EXPECT_NEAR(state.shear, -dot(sum, quarter_turn(along)), 1e-9) << s;
    EXPECT_NEAR(state.moment, moment, 1e-9) << s;
  }
}

TEST(LinkLoads, DeflectionIsTheIntegralOfTheCurvature) {
  const Loaded found(crane);
  const LinkLoads& link = found.links.at(0);
  const CrossSection& section = link.section;
  const double ei = section.modulus * section.second_moment;
  double largest = 0.0;
  for (const LinkPiece& piece : link.pieces) {
    constexpr int parts = 400;
    const double step = (piece.to - piece.from) / parts;
    for (int k = 0; k < parts; ++k) {
      const double s = piece.from + (k + 0.5) * step;
      const LinkState before = link.at(piece, s - 0.5 * step), after = link.at(piece, s + 0.5 * step);
      const LinkState middle = link.at(piece, s);
      EXPECT_NEAR((after.turn - before.turn) / step, middle.moment / ei, 1e-9);
      const Vec2 slope = (1 / step) * (after.deflection - before.deflection);
      EXPECT_NEAR(norm(slope - middle.turn * quarter_turn(piece.along)), 0.0, 1e-9);
      largest = std::max(largest, norm(middle.deflection));
    }
  }
  EXPECT_GE(link.deflection.value, largest);
  EXPECT_LT(link.deflection.value, largest * 1.0001);
  // The ends stay on their line.
  const Vec2 chord{3, 1.2};
  const LinkPiece& last = link.pieces.back();
  EXPECT_NEAR(cross(chord, link.at(last, last.to).deflection), 0.0, 1e-15);
  EXPECT_EQ(norm(link.pieces.front().deflection), 0.0);
}

TEST(LinkLoads, BucklingOfATwoForceLink) {
  const std::string text = R"(
[ground]
points = { A = [0, 0], C = [0, 3] }
[body.strut]
points = { A = [0, 0], B = [3, 0] }
[body.strut.section]
profile = "tube 0.06x0.003"
modulus = 2.1e11
[body.beam]
points = { C = [0, 0], B = [3, -3], T = [4, -4] }
[body.beam.section]
profile = "IPE 100"
modulus = 2.1e11
line = ["C", "B", "T"]
[[pin]]
points = ["ground.A", "strut.A"]
[[pin]]
points = ["ground.C", "beam.C"]
[[pin]]
points = ["strut.B", "beam.B"]
[[force]]
name = "P"
at = "beam.T"
vector = [0, -5000]
)";
  const Loaded found(text);
  const LinkLoads& strut = found.links.at(0);
  ASSERT_EQ(strut.why, "");
  // Moments about C: the strut's force has the arm 3.
  const double compression = 5000 * 4 / 3.0;
  EXPECT_NEAR(strut.normal.value, -compression, 1e-8);
  const double euler = M_PI * M_PI * 2.1e11 * M_PI / 64 * (std::pow(0.06, 4) - std::pow(0.054, 4)) / 9;
  ASSERT_TRUE(strut.buckling_factor);
  EXPECT_NEAR(*strut.buckling_factor, euler / compression, 1e-10 * euler / compression);
  EXPECT_FALSE(found.links.at(1).buckling_factor);
  Scene pulled = found.model.scene();
  pulled.forces[0].vector = {0, 5000};
  EXPECT_FALSE(Loaded(pulled).links.at(0).buckling_factor);
}

TEST(LinkLoads, RefusesByName) {
  // Clamped at both ends: statics does not determine the clamps.
  const Loaded clamped(beam + R"(
[[weld]]
name = "left"
points = ["ground.A", "beam.A"]
[[weld]]
name = "right"
points = ["ground.B", "beam.B"]
)");
  EXPECT_NE(clamped.links.at(0).why.find("does not determine the force of weld left"), std::string::npos)
      << clamped.links.at(0).why;
  EXPECT_TRUE(clamped.links[0].pieces.empty());
  // A couple that may enter anywhere.
  const std::string pinned = beam + "[[pin]]\npoints = [\"ground.A\", \"beam.A\"]\n";
  const Loaded hung(pinned + "[[torque]]\nname = \"T\"\non = \"beam\"\nvalue = 900\n[start]\nbeam = 0.3\n");
  EXPECT_EQ(hung.links.at(0).why, "");  // through the one joint with the ground
  const Loaded spread(pinned + R"(
[body.other]
points = { P = [0, 0] }
mass = 1
[[weld]]
points = ["beam.B", "other.P"]
[[torsion_spring]]
name = "far"
bodies = ["ground", "other"]
stiffness = 400
)");
  EXPECT_EQ(spread.links.at(0).why, "");  // it acts on the other body, and through the weld
  const Loaded unknown(pinned + R"(
[body.other]
points = { P = [0, 0], Q = [3, 0] }
[body.other.section]
profile = "round 0.03"
modulus = 2e11
[[pin]]
points = ["beam.B", "other.P"]
[[torsion_spring]]
name = "far"
bodies = ["ground", "other"]
stiffness = 400
[[force]]
at = "other.Q"
vector = [40, 30]
)");
  EXPECT_NE(unknown.links.at(1).why.find("where the moment of torsion spring far enters it is not known"),
            std::string::npos)
      << unknown.links.at(1).why;
  EXPECT_EQ(unknown.links.at(0).why, "");
}

TEST(LinkLoads, RefusesATreeThatItsLineDoesNotVisit) {
  const Loaded found(R"(
[ground]
points = { A = [0, 0], B = [4, 0] }
[body.plate]
points = { A = [0, 0], B = [4, 0], C = [2, 1] }
[body.plate.section]
profile = "IPE 80"
modulus = 2e11
line = ["A", "B"]
[body.hanger]
points = { C = [0, 0], D = [0, -1] }
[[pin]]
points = ["ground.A", "plate.A"]
[[pin_in_slot]]
points = ["ground.B", "plate.B"]
axis = [1, 0]
[[pin]]
name = "branch"
points = ["plate.C", "hanger.C"]
[[force]]
at = "hanger.D"
vector = [0, -100]
)");
  EXPECT_NE(found.links.at(0).why.find("pin branch is not on its line"), std::string::npos) << found.links.at(0).why;
}

TEST(DistributedLoad, IsItsResultantInTheMiddle) {
  const std::string base = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], A = [0.5, 0.1], B = [1.7, -0.2], M = [1.1, -0.05] }
mass = 2
center = [0.8, 0]
[body.fore]
points = { B = [0, 0], E = [0.9, 0] }
mass = 1
center = [0.4, 0]
[[pin]]
points = ["ground.O", "arm.O"]
[[pin]]
points = ["arm.B", "fore.B"]
[[torsion_spring]]
bodies = ["ground", "arm"]
stiffness = 60
)";
  const double length = std::hypot(1.2, 0.3);
  for (const std::string follows : {"", "follows = \"fore\"\n", "follows = \"arm\"\n"}) {
    const StaticModel spread(parse_scene(
        base + "[[distributed_load]]\nname = \"q\"\npoints = [\"arm.A\", \"arm.B\"]\nvector = [2, -7]\n" + follows,
        ""));
    const StaticModel single(parse_scene(base + "[[force]]\nname = \"q\"\nat = \"arm.M\"\nvector = [" +
                                             std::to_string(2 * length) + ", " + std::to_string(-7 * length) + "]\n" +
                                             follows,
                                         ""));
    Scene exact = single.scene();
    exact.forces[0].vector = length * Vec2{2, -7};
    const StaticModel same(exact);
    const Equilibrium a = solve(spread), b = solve(same);
    ASSERT_TRUE(a.found()) << a.why;
    ASSERT_TRUE(b.found()) << b.why;
    for (std::size_t k = 0; k < a.x.size(); ++k) EXPECT_NEAR(a.x[k], b.x[k], 1e-13) << follows;
    EXPECT_TRUE(a.check.is_equilibrium()) << a.check.objection;
  }
}

TEST(DistributedLoad, HasSensitivitiesToItsLineAndSize) {
  Scene scene = parse_scene(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], A = [0.5, 0.1], B = [1.7, -0.2] }
mass = 2
center = [0.8, 0]
[[pin]]
points = ["ground.O", "arm.O"]
[[torsion_spring]]
bodies = ["ground", "arm"]
stiffness = 60
[[distributed_load]]
name = "q"
points = ["arm.A", "arm.B"]
vector = [2, -7]
)",
                            "arm.toml");
  const StaticModel model(scene);
  const Sensitivities found = sensitivities(model, {find_quantity(scene, "angle.arm")}, {});
  ASSERT_TRUE(found.why.empty()) << found.why;
  const auto angle = [&](const std::string& path, double by) {
    Scene other = scene;
    set_value(other, path, get_value(scene, path) + by);
    const StaticModel changed(other);
    return changed.poses(solve(changed).x)[1].angle;
  };
  std::size_t compared = 0;
  for (const Sensitivity& effect : found.of.at(0).by) {
    const std::string& path = effect.number;
    if (path != "load.q" && !path.starts_with("point.arm.A") && !path.starts_with("point.arm.B")) continue;
    constexpr double step = 1e-5;
    EXPECT_NEAR(effect.derivative, (angle(path, step) - angle(path, -step)) / (2 * step), 1e-8) << path;
    ++compared;
  }
  EXPECT_EQ(compared, 5U);
}

}  // namespace
}  // namespace poise::link_loads_test

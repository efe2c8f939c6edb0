// Forces of teeth and rollers on bearings and guides, against closed forms.

#include "statics/bodies/contact_loads.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "motion/forces_along.hpp"
#include "motion/motion_model.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/equilibrium/link_loads.hpp"
#include "statics/friction/held.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/seed.hpp"

namespace poise::contact_loads_test {
namespace {

using std::numbers::pi;

constexpr double angle = 20 * pi / 180;

Equilibrium solved(const StaticModel& model) {
  Equilibrium found = solve(model, test::by(Method::virtual_work));
  EXPECT_EQ(found.status, Status::confirmed) << found.why;
  return found;
}

const Reaction& reaction(const Equilibrium& found, const std::string& name) {
  for (const Reaction& one : found.check.reactions) {
    if (one.name == name) return one;
  }
  throw std::runtime_error("no reaction " + name);
}

void expect_force(const Reaction& found, Vec2 expected, const std::string& what) {
  EXPECT_TRUE(found.determined) << what;
  EXPECT_NEAR(found.force.x, expected.x, 1e-9) << what;
  EXPECT_NEAR(found.force.y, expected.y, 1e-9) << what;
  // Proved forces are enclosed.
  EXPECT_LT(found.radius, 1e-9) << what;
}

// Two wheels on axes A and B, a torque on the first, a torsion spring that holds the second.
std::string pair(const std::string& gear, double torque) {
  return fmt::format(R"(
[ground]
points = {{ A = [0, 0], B = [0.3, 0.4] }}
[body.a]
points = {{ A = [0, 0] }}
[body.b]
points = {{ B = [0, 0] }}
[[pin]]
name = "A"
points = ["ground.A", "a.A"]
[[pin]]
name = "B"
points = ["b.B", "ground.B"]
[[gear]]
name = "teeth"
bodies = ["a", "b"]
{}
pressure_angle = {:.17g}
[[torque]]
name = "T"
on = "a"
value = {:.17g}
[[torsion_spring]]
bodies = ["ground", "b"]
stiffness = 20
)",
                     gear, angle, torque);
}

// The force on wheel a is T / r_a across the line of centres, against T, and presses it away from the teeth: outside
// meshing towards its own axis, of a ring away from it.
TEST(ContactLoads, TeethPressBothShaftsAlongTheLineOfAction) {
  const Vec2 along{0.6, 0.8}, across{-0.8, 0.6};
  struct Case {
    std::string gear;
    double pitch;  // the pitch point, along the line of centres from A
    double towards;
  };
  for (const Case& one : {Case{"ratio = 0.25", 0.1, 1.0}, Case{"ratio = 4", 0.4, 1.0},
                          Case{"ratio = 0.5\ninternal = true", -0.5, -1.0},   // b is a ring of radius 1
                          Case{"ratio = 3\ninternal = true", 0.75, -1.0}}) {  // a is one of 0.75
    for (const double torque : {10.0, -10.0}) {
      const StaticModel model(parse_scene(pair(one.gear, torque), "pair.toml"));
      const Equilibrium found = solved(model);
      const double force = torque / one.pitch;
      const Vec2 on_a = -force * across - (one.towards * std::abs(force) * std::tan(angle)) * along;
      expect_force(reaction(found, "A"), -on_a, one.gear);
      // The pin at B names the ground second: the force on the ground.
      expect_force(reaction(found, "B"), -on_a, one.gear);
      EXPECT_NEAR(norm(reaction(found, "A").force), std::abs(force) / std::cos(angle), 1e-9);
      // The moment on wheel b, as without the key.
      std::string plain = pair(one.gear, torque);
      plain.erase(plain.find("pressure_angle"), plain.find("[[torque]]") - plain.find("pressure_angle"));
      const Equilibrium without = solved(StaticModel(parse_scene(plain, "pair.toml")));
      EXPECT_NEAR(reaction(found, "teeth").moment, reaction(without, "teeth").moment, 1e-12);
      EXPECT_LT(norm(reaction(without, "A").force), 1e-30);
      EXPECT_EQ(without.x, found.x);
    }
  }
}

// Without a torque nothing pushes, and what is proved says so.
TEST(ContactLoads, IdleTeethPressNothing) {
  const Equilibrium found = solved(StaticModel(parse_scene(pair("ratio = 0.25", 0.0), "pair.toml")));
  expect_force(reaction(found, "A"), {}, "idle");
}

// Willis: the sun turns the planet by T / r, the ring holds it by as much, and the arm carries both, 2 T / r. The
// radial parts of both meshes cancel in the planet.
TEST(ContactLoads, APlanetPressesItsPinByTwiceTheToothForce) {
  for (const double alpha : {0.0, angle}) {
    const std::string text = R"(
[ground]
points = { O = [0, 0] }
[body.sun]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], Q = [0.05, 0] }
[body.planet]
points = { Q = [0, 0] }
[[pin]]
name = "sun shaft"
points = ["ground.O", "sun.O"]
[[pin]]
name = "arm shaft"
points = ["ground.O", "arm.O"]
[[pin]]
name = "planet pin"
points = ["arm.Q", "planet.Q"]
[[torque]]
on = "sun"
value = 2
[[torsion_spring]]
bodies = ["ground", "arm"]
stiffness = 20
)" + fmt::format(R"(
[[gear]]
bodies = ["sun", "planet"]
carrier = "arm"
ratio = 0.66666666666666663
pressure_angle = {0:.17g}
[[gear]]
bodies = ["planet", "ground"]
carrier = "arm"
ratio = 0.375
internal = true
pressure_angle = {0:.17g}
)",
                 alpha);
    const StaticModel model(parse_scene(text, "planets.toml"));
    const Equilibrium found = solved(model);
    const double tooth = 2 / 0.02;
    const Vec2 along = unit(0.5), across = quarter_turn(along);  // of the arm, which stands at 1/2
    expect_force(reaction(found, "planet pin"), -2 * tooth * across, "planet");
    // On the sun the reaction of the tooth, and the separating part that turns with the arm.
    expect_force(reaction(found, "sun shaft"), tooth * across + (tooth * std::tan(alpha)) * along, "sun");
    expect_force(reaction(found, "arm shaft"), -2 * tooth * across, "arm");
  }
}

// A pinion at C on a rack that slides below it (radius > 0) or above, a torsion spring on the pinion and a force on the
// rack; the slide may name the rack first.
std::string rack(double radius, bool rack_first, const std::string& more = "") {
  return fmt::format(R"(
[ground]
points = {{ C = [0.1, 0], S = [0, -0.5] }}
[body.pinion]
points = {{ C = [0, 0] }}
[body.rack]
points = {{ R = [0, 0] }}
[[pin]]
name = "C"
points = ["ground.C", "pinion.C"]
[[slide]]
name = "guide"
points = [{}]
axis = [1, 0]
{}
[[rack]]
name = "teeth"
slide = "guide"
pinion = "pinion"
carrier = "ground"
radius = {:.17g}
pressure_angle = {:.17g}
[[force]]
name = "P"
at = "rack.R"
vector = [-30, 0]
[[torsion_spring]]
bodies = ["ground", "pinion"]
stiffness = 50
)",
                     rack_first ? R"("rack.R", "ground.S")" : R"("ground.S", "rack.R")", more, radius, angle);
}

TEST(ContactLoads, ARackPressesItsGuideAndThePinionsShaft) {
  for (const double radius : {0.2, -0.2}) {
    for (const bool rack_first : {false, true}) {
      const StaticModel model(parse_scene(rack(rack_first ? -radius : radius, rack_first), "rack.toml"));
      const Equilibrium found = solved(model);
      const std::string what = fmt::format("{} {}", radius, rack_first);
      const Vec2 at = model.poses(found.x)[2].origin;
      // Teeth push the rack forwards against P, and away from the pinion.
      const Vec2 on_rack{30, (radius > 0 ? -30.0 : 30.0) * std::tan(angle)};
      expect_force(reaction(found, "C"), on_rack, what);
      const double sign = rack_first ? -1.0 : 1.0;  // on the second body of the slide
      expect_force(reaction(found, "guide"), {0, -sign * on_rack.y}, what);
      const Vec2 pitch{0.1, -radius};
      // About the slide's second point.
      const Vec2 about = rack_first ? Vec2{0, -0.5} : at;
      const double p = cross(at - about, Vec2{-30, 0});
      EXPECT_NEAR(reaction(found, "guide").moment, -sign * (cross(pitch - about, on_rack) + p), 1e-9) << what;
    }
  }
}

// The rack as a beam: the tooth force enters where teeth mesh, and its line is in balance.
TEST(ContactLoads, EnterBeamsWhereTheyAct) {
  std::string text = rack(0.2, false);
  const std::string body = "points = { R = [0, 0] }\n";
  text.replace(text.find(body), body.size(), R"(points = { R = [0, 0], E = [0, 0.3], F = [0.5, 0.3] }
[body.rack.section]
line = ["E", "F"]
area = 1e-3
second_moment = 1e-6
modulus = 2.1e11
height = 0.1
)");
  const StaticModel model(parse_scene(text, "beam.toml"));
  const Equilibrium found = solved(model);
  const std::vector<LinkLoads> links = link_loads(model.scene(), model.poses(found.x), found.check);
  ASSERT_EQ(links.size(), 1U);
  EXPECT_EQ(links[0].why, "");
  EXPECT_LT(links[0].imbalance, 1e-9);
  bool is_there = false;
  for (const LinkAction& action : links[0].actions) {
    if (action.name != "rack teeth") continue;
    is_there = true;
    EXPECT_NEAR(action.force.x, 30.0, 1e-9);
    EXPECT_NEAR(action.force.y, -30 * std::tan(angle), 1e-9);
    EXPECT_NEAR(action.s, 0.1 - model.poses(found.x)[2].origin.x, 1e-9);
  }
  EXPECT_TRUE(is_there);
}

HeldRange range_of(const std::string& text, const std::string& number) {
  const StaticModel model(parse_scene(text, "test"));
  return held_range(model, assemble(model), number);
}

void expect_proved_range(const HeldRange& range, double lower, double upper) {
  EXPECT_TRUE(range.contains_now);
  EXPECT_TRUE(range.now.proved);
  EXPECT_TRUE(range.lower.proved);
  EXPECT_TRUE(range.upper.proved);
  EXPECT_NEAR(range.lower.value, lower, 1e-9 * std::max(std::abs(lower), std::abs(upper)));
  EXPECT_NEAR(range.upper.value, upper, 1e-9 * std::max(std::abs(lower), std::abs(upper)));
}

// Friction circles of c_A and c_B: both shafts carry F / cos(angle).
std::string rubbing_pair(double load, double constant, double torque) {
  std::string text = pair("ratio = 0.25", torque);
  text.erase(text.find("[[torsion_spring]]"));
  const auto rub = [&](const std::string& points, double radius, double more) {
    text.insert(text.find(points) + points.size(),
                fmt::format("\nfriction = {{ radius = {}, coefficient = 0.2, torque = {} }}", radius, more));
  };
  rub(R"(points = ["ground.A", "a.A"])", 0.02, 0.0);
  rub(R"(points = ["b.B", "ground.B"])", 0.03, constant);
  return text + fmt::format("[[torque]]\nname = \"load\"\non = \"b\"\nvalue = {}\n", load);
}

TEST(ContactLoads, HoldKnowsTheFrictionCircleUnderTeeth) {
  const double c = 0.2 / std::sqrt(1.04) / std::cos(angle), a = 0.02 * c, b = 0.03 * c;
  // Pitch radii 0.1 and 0.4; both wheels are turned the same way by the loads.
  expect_proved_range(range_of(rubbing_pair(8.0, 0.0, 2.0), "load.T"), 8 * (0.1 - a) / (0.4 + b),
                      8 * (0.1 + a) / (0.4 - b));
  expect_proved_range(range_of(rubbing_pair(-8.0, 0.0, -2.0), "load.T"), -8 * (0.1 + a) / (0.4 - b),
                      -8 * (0.1 - a) / (0.4 + b));
  // A seal at B takes the torque of teeth on either flank.
  expect_proved_range(range_of(rubbing_pair(0.0, 3.0, 0.0), "load.T"), -3 * (0.1 + a) / (0.4 - b),
                      3 * (0.1 + a) / (0.4 - b));
  // How much of the friction is needed, of T = 8 (0.1 + k a) / (0.4 - k b); none where the loads balance.
  const StaticModel even(parse_scene(rubbing_pair(8.0, 0.0, 2.0), "even"));
  EXPECT_EQ(held_pose(even, assemble(even)).least_factor, 0.0);
  const StaticModel more(parse_scene(rubbing_pair(8.0, 0.0, 2.05), "more"));
  const HeldPose by = held_pose(more, assemble(more));
  const double least = (2.05 * 0.4 - 0.8) / (8 * a + 2.05 * b);
  EXPECT_NEAR(by.least_factor, least, 1e-9);
  EXPECT_LT(by.factor_lower, least);
  EXPECT_GT(by.factor_upper, least);
  const StaticModel model(parse_scene(rubbing_pair(8.0, 0.0, 3.0), "slips"));
  const HeldPose pose = held_pose(model, assemble(model));
  EXPECT_EQ(pose.verdict, Holding::slips);
  EXPECT_TRUE(pose.proved);
}

double hoist_torque(double sign) {
  const double t = std::tan(angle), c = sign * 0.12 / std::sqrt(1.0144), load = 2000;
  double tooth = load * 0.1 / 0.24;
  for (int k = 0; k < 200; ++k) tooth = (0.1 * load + 0.03 * c * std::hypot(tooth * t, load - tooth)) / 0.24;
  return 0.06 * tooth + 0.02 * c * tooth * std::sqrt(1 + t * t);
}

Forces driven(const Scene& from, const std::string& drive, double at, double rate) {
  Scene scene = from;
  scene.drives = {find_drive(scene, drive)};
  const MotionModel model(std::move(scene));
  SweepOptions options;
  options.rate = rate;
  const ForcesAlong found = forces_over(model, {{drive, at, at}}, options, true);
  EXPECT_EQ(found.poses.size(), 1U) << found.why;
  return found.poses.at(0);
}

void expect_balance(const Forces& forces) {
  EXPECT_EQ(forces.friction.state, SlidingFriction::State::solved);
  EXPECT_TRUE(forces.balanced);
  EXPECT_LT(forces.power.error, 1e-9);
  EXPECT_LT(forces.work_error, 1e-9);
}

TEST(ContactLoads, AHoistIsHeldAndDrivenByTheTorquesOfItsFrictionCircles) {
  Scene scene = read_scene(test::dataset("friction/hoist.toml"));
  const StaticModel model(scene);
  expect_proved_range(held_range(model, assemble(model), "load.M"), hoist_torque(-1), hoist_torque(1));
  set_value(scene, "load.M", 0.0);
  for (const double rate : {0.1, -0.1}) {
    const Forces forces = driven(scene, "pinion", 0.0, rate);
    expect_balance(forces);
    EXPECT_NEAR(forces.drives[0].value, hoist_torque(rate > 0 ? 1 : -1), 1e-9);
    EXPECT_NEAR(forces.friction.efforts_without[0], 50.0, 1e-9);
    const std::optional<double> efficiency =
        rate > 0 ? forces.friction.efficiency() : forces.friction.efficiency_back();
    ASSERT_TRUE(efficiency);
    EXPECT_NEAR(*efficiency, rate > 0 ? 50 / hoist_torque(1) : hoist_torque(-1) / 50, 1e-9);
  }
}

// A train of three wheels with random axes, teeth and loads. Its driving torques at the edge of slipping, from linear
// programs in balls, are those of motion either way, from Newton's method on bodies cut free.
TEST(ContactLoads, RandomTrainsAreHeldUpToTheTorquesThatDriveThem) {
  std::mt19937 random(
      static_cast<unsigned>(test::seed(1)));  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same trains in every run
  const auto uniform = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  for (int k = 0; k < 4; ++k) {
    std::string text = "[[torque]]\nname = \"M\"\non = \"a\"\nvalue = 0\n", axes;
    Vec2 at{};
    for (const char body : {'a', 'b', 'c'}) {
      axes += fmt::format("{} = [{:.17g}, {:.17g}]\n", body, at.x, at.y);
      const Vec2 direction = unit(uniform(0, 2 * pi));
      at += uniform(0.2, 0.5) * direction;
      const double Fy = uniform(-50, 50), Fx = uniform(-50, 50), coefficient = uniform(0.05, 0.25);
      const double radius = uniform(0.005, 0.02), y = uniform(-0.1, 0.1), x = uniform(-0.1, 0.1);
      text += fmt::format(R"(
[body.{0}]
points = {{ O = [0, 0], P = [{1:.17g}, {2:.17g}] }}
[[pin]]
points = ["ground.{0}", "{0}.O"]
friction = {{ radius = {3:.17g}, coefficient = {4:.17g} }}
[[force]]
at = "{0}.P"
vector = [{5:.17g}, {6:.17g}]
)",
                          body, x, y, radius, coefficient, Fx, Fy);
    }
    for (const std::string wheels : {R"(["a", "b"])", R"(["b", "c"])"}) {
      const bool internal = uniform(0, 1) < 0.3;
      text += fmt::format("[[gear]]\nbodies = {}\nratio = {}\ninternal = {}\npressure_angle = {:.17g}\nphase = 0\n",
                          wheels, internal ? 0.4 : 1.5, internal, uniform(0, 0.45));
    }
    const Scene scene = parse_scene(text + "[ground.points]\n" + axes, "train");
    const StaticModel model(scene);
    const HeldRange range = held_range(model, assemble(model), "load.M");
    EXPECT_TRUE(range.lower.proved && range.upper.proved) << k;
    for (const double rate : {1e-3, -1e-3}) {
      const Forces forces = driven(scene, "a", 0.0, rate);
      expect_balance(forces);
      const double edge = rate > 0 ? range.upper.value : range.lower.value;
      EXPECT_NEAR(forces.drives[0].value, edge, 1e-8 * std::max(1.0, std::abs(edge))) << k;
    }
  }
}

// F (1 + mu tan(angle)) = P where friction of the guide helps the teeth; its couple rubs not without a length.
TEST(ContactLoads, ARackRubsInItsGuide) {
  std::string text = rack(0.2, false, "friction = { coefficient = 0.3 }");
  text.erase(text.find("[[torsion_spring]]"));
  text += "[[torque]]\nname = \"M\"\non = \"pinion\"\nvalue = 6\n";
  const double share = 0.3 * std::tan(angle);
  expect_proved_range(range_of(text, "load.M"), 6 / (1 + share), 6 / (1 - share));
  const StaticModel even(parse_scene(text, "rack"));
  EXPECT_EQ(held_pose(even, assemble(even)).least_factor, 0.0);
  Scene scene = parse_scene(text, "rack");
  set_value(scene, "load.M", 0.0);
  const Forces up = driven(scene, "pinion", 0.0, 0.5);
  expect_balance(up);
  EXPECT_NEAR(up.drives[0].value, 6 / (1 - share), 1e-9);
  expect_balance(driven(scene, "pinion", 0.0, -0.5));
}

// A weight of 20 N on a cam of s = 0.06 - 0.01 cos(phi), on a guide at the offset e.
std::string cam(double offset, const std::string& friction) {
  return fmt::format(R"(
gravity = [0, -10]
[ground]
points = {{ O = [0, 0], S = [{}, 0] }}
[body.cam]
points = {{ O = [0, 0] }}
[body.follower]
points = {{ R = [0, 0] }}
mass = 2
[[pin]]
name = "shaft"
points = ["ground.O", "cam.O"]
[[slide]]
name = "guide"
points = ["ground.S", "follower.R"]
axis = [0, 1]
{}
[[cam]]
name = "lobe"
bodies = ["ground", "cam"]
follower = {{ slide = "guide" }}
roller = "follower.R"
guided = true
law = [{{ to = 3.141592653589793, lift = 1, law = "harmonic" }},
       {{ to = 6.283185307179586, lift = 0, law = "harmonic" }}]
lift = 0.02
base = 0.05
[[torque]]
name = "M"
on = "cam"
value = 0.16
[start]
guide = 0.06
cam = 1
)",
                     offset, friction);
}

TEST(ContactLoads, ACamThrustsItsGuideAsideAndSticks) {
  const double phi = 1.0, e = 0.004, slope = 0.01 * std::sin(phi), s = 0.06 - 0.01 * std::cos(phi);
  const double tangent = (slope - e) / s;
  const Forces ideal = driven(parse_scene(cam(e, ""), "cam"), "cam", phi, 1e-6);
  // On the follower the guide holds against the side thrust, which points to the left: along t turned by 90 degrees.
  EXPECT_NEAR(ideal.reactions[1].force.x, 20 * tangent, 1e-7);
  EXPECT_NEAR(ideal.reactions[0].force.x, -20 * tangent, 1e-7);
  EXPECT_NEAR(ideal.reactions[0].force.y, 20, 1e-7);
  const double share = 2.0 * tangent;  // a coefficient of 2
  Scene scene = parse_scene(cam(e, "friction = { coefficient = 2 }"), "cam");
  set_value(scene, "load.M", 0.0);
  for (const double rate : {1e-6, -1e-6}) {
    const Forces forces = driven(scene, "cam", phi, rate);
    expect_balance(forces);
    EXPECT_NEAR(forces.drives[0].value, 20 * slope / (rate > 0 ? 1 - share : 1 + share), 1e-7);
  }
  std::string text = cam(e, "friction = { coefficient = 2 }");
  const StaticModel model(parse_scene(text, "cam"));
  const std::vector<double> x = assemble(model);
  const double at = model.poses(x)[1].angle;
  const double slope_at = 0.01 * std::sin(at), share_at = 2 * (slope_at - e) / (0.06 - 0.01 * std::cos(at));
  expect_proved_range(held_range(model, x, "load.M"), 20 * slope_at / (1 + share_at), 20 * slope_at / (1 - share_at));
}

// A follower that is measured by its point has no roller.
TEST(ContactLoads, CamsWithoutARollerActOnTheirMeasures) {
  std::string text = cam(0.004, "");
  const std::string sliding = "{ slide = \"guide\" }\nroller = \"follower.R\"";
  text.replace(text.find(sliding), sliding.size(), "{ y = \"follower.R\" }");
  const Forces forces = driven(parse_scene(text, "cam"), "cam", 1.0, 1e-6);
  EXPECT_NEAR(forces.reactions[1].force.x, 0.0, 1e-12);
  EXPECT_NEAR(forces.drives[0].value + 0.16, 20 * 0.01 * std::sin(1.0), 1e-7);
}

TEST(ContactLoads, RefusesByName) {
  const auto message = [](std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    return test::message_of([&] { parse_scene(text, "scene.toml"); });
  };
  const std::string gear = pair("ratio = 0.5", 1.0);
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(message(gear, "[[pin]]\nname = \"A\"", "[[pin_in_slot]]\naxis = [1, 0]\nname = \"A\""), "turn about pins");
  has(message(gear, "B = [0.3, 0.4]", "B = [0, 0]"), "axes apart");
  has(message(gear, "ratio = 0.5", "ratio = 1\ninternal = true"), "of other sizes");
  has(message(gear, "pressure_angle = ", "pressure_angle = 1"), "less than 45 degrees");
  has(message(gear, "[[gear]]", "[[belt]]"), "pressure_angle");
  has(message(rack(0.2, false), "carrier = \"ground\"", "carrier = \"rack\""), "joins the carrier");
}

/// Derivatives of joint forces against differences of the forces at other numbers.
void expect_sensitivities(const std::string& text, const std::vector<std::string>& joints,
                          const std::vector<std::string>& numbers) {
  const Scene scene = parse_scene(text, "scene.toml");
  std::vector<SoughtQuantity> sought;
  for (const std::string& joint : joints) {
    for (const char* part : {".x", ".y"}) sought.push_back(find_quantity(scene, "reaction." + joint + part));
  }
  const Sensitivities found = sensitivities(StaticModel(scene), sought);
  ASSERT_EQ(found.why, "");
  const auto forces = [&](const std::string& number, double value) {
    Scene other = scene;
    set_value(other, number, value);
    const Equilibrium at = solved(StaticModel(other));
    std::vector<double> out;
    for (const std::string& joint : joints) {
      out.push_back(reaction(at, joint).force.x);
      out.push_back(reaction(at, joint).force.y);
    }
    return out;
  };
  for (std::size_t q = 0; q < sought.size(); ++q) {
    ASSERT_EQ(found.of[q].why, "");
    for (const std::string& number : numbers) {
      const auto row = std::find_if(found.of[q].by.begin(), found.of[q].by.end(),
                                    [&](const Sensitivity& one) { return one.number == number; });
      ASSERT_NE(row, found.of[q].by.end()) << number;
      ASSERT_EQ(row->why, "") << number;
      const double h = 1e-5 * std::max(0.1, std::abs(row->value));
      const double expected = (forces(number, row->value + h)[q] - forces(number, row->value - h)[q]) / (2 * h);
      EXPECT_NEAR(row->derivative, expected, 1e-6 * (1 + std::abs(expected))) << joints[q / 2] << " by " << number;
    }
  }
}

TEST(ContactLoads, SensitivitiesFollowTheForcesToWhereTheyAct) {
  for (const char* gear : {"ratio = 0.25", "ratio = 0.5\ninternal = true"}) {
    for (const double torque : {10.0, -10.0}) {
      expect_sensitivities(pair(gear, torque), {"A", "B"},
                           {"load.T", "gear.teeth.ratio", "gear.teeth.pressure_angle", "point.ground.B.x",
                            "point.ground.B.y", "torsion_spring.torsion spring 1.stiffness"});
    }
  }
  expect_sensitivities(rack(0.2, true), {"C", "guide"},
                       {"rack.teeth.radius", "rack.teeth.pressure_angle", "point.ground.C.x"});
  std::string sprung = cam(0.004, "");
  sprung += "[[torsion_spring]]\nbodies = [\"ground\", \"cam\"]\nstiffness = 3\nfree_angle = 1\n";
  expect_sensitivities(sprung, {"shaft", "guide"},
                       {"load.M", "cam.lobe.lift", "cam.lobe.base", "cam.lobe.phase", "point.ground.S.x", "gravity.y"});
}

// Under no force the teeth push their wheels apart by |Q|, which has no derivative.
TEST(ContactLoads, IdleTeethHaveNoSensitivities) {
  const Scene scene = parse_scene(pair("ratio = 0.25", 0.0), "scene.toml");
  const Sensitivities found =
      sensitivities(StaticModel(scene), {find_quantity(scene, "reaction.A.x"), find_quantity(scene, "angle.a")});
  EXPECT_NE(found.of[0].why.find("gear \"teeth\" transmits no force"), std::string::npos) << found.of[0].why;
  EXPECT_EQ(found.of[1].why, "");
}

}  // namespace
}  // namespace poise::contact_loads_test

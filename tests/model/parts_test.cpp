// Parts of scenes: a scene as a part of another one, placed, turned, mirrored and in other units, against the same
// scene alone; numbers that parts share; what is refused.

#include "model/parts.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/couplings.hpp"
#include "model/parameter_values.hpp"
#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "model/scene.hpp"
#include "model/text_file.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/modes.hpp"
#include "motion/motion_model.hpp"
#include "motion/simulate.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/vector_mechanics.hpp"

namespace poise::parts_test {
namespace {

using app_tests::TempFolder;
using test::message_of;
using test::Poses;

// --- a scene and the same scene as a part ----------------------------------------------------------------------------

struct Placement {
  Vec2 at;
  double angle = 0.0;
  bool mirrored = false;

  Vec2 turned(Vec2 v) const { return (mirrored ? Vec2{v.x, -v.y} : v) * unit(angle); }
  BodyPose<double> of(const BodyPose<double>& pose) const {
    return {at + turned(pose.origin), angle + (mirrored ? -pose.angle : pose.angle)};
  }
};

Placement random_placement(std::mt19937_64& random) {
  std::uniform_real_distribution<double> one(-1.0, 1.0);
  return {{3 * one(random), 3 * one(random)}, 3 * one(random), one(random) > 0.0};
}

// In mm and degrees, with the gravity that the part has in its own frame.
std::string assembly_of(const std::string& file, const Scene& part, const Placement& place) {
  const Vec2 g = place.turned(part.gravity);
  return fmt::format(
      "gravity = [{}, {}]\n[units]\nlength = \"mm\"\nangle = \"deg\"\nforce = \"kN\"\nmass = \"lb\"\n"
      "[[part]]\nname = \"P\"\nfile = \"{}\"\nat = [{}, {}]\nangle = {}\nmirror = {}\n",
      1000 * g.x, 1000 * g.y, file, 1000 * place.at.x, 1000 * place.at.y, place.angle * 180 / std::numbers::pi,
      place.mirrored);
}

template <class Item>
const Item* named(const std::vector<Item>& items, const std::string& name) {
  for (const Item& item : items) {
    if (item.name == name) return &item;
  }
  return nullptr;
}

int body_named(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].name == name) return static_cast<int>(b);
  }
  return -1;
}

// At some places ropes have no length: their pulleys are too near each other.
bool have_no_value(double a, double b) { return std::isnan(a) && std::isnan(b); }

void expect_near(double a, double b, const std::string& what) {
  if (a == b || have_no_value(a, b)) return;
  EXPECT_NEAR(a, b, 1e-9 * std::max({1.0, std::abs(a), std::abs(b)})) << what;
}

// At any places of the bodies, which need not close the joints: energies differ by a constant, and all else is as it
// was, seen from the part.
void expect_same_mechanics(const Scene& alone, const Scene& placed, const Placement& place, std::mt19937_64& random,
                           const std::string& what) {
  std::uniform_real_distribution<double> one(-1.0, 1.0);
  std::optional<double> constant;
  for (int sample = 0; sample < 3; ++sample) {
    Poses own(alone.bodies.size()), there(placed.bodies.size());
    for (std::size_t b = 1; b < own.size(); ++b) own[b] = {{2 * one(random), 2 * one(random)}, 3 * one(random)};
    if (const int frame = body_named(placed, "P.ground"); frame >= 0)
      there[static_cast<std::size_t>(frame)] = place.of({});
    for (std::size_t b = 1; b < own.size(); ++b) {
      const int body = body_named(placed, "P." + alone.bodies[b].name);
      ASSERT_GE(body, 0) << what << ": " << alone.bodies[b].name;
      there[static_cast<std::size_t>(body)] = place.of(own[b]);
    }
    const double difference = test::potential_energy(placed, there) - test::potential_energy(alone, own);
    if (!constant && !std::isnan(difference)) constant = difference;
    if (constant && !std::isnan(difference)) {
      const double size = std::abs(test::potential_energy(alone, own)) + std::abs(*constant) + 1.0;
      EXPECT_NEAR(difference, *constant, 1e-9 * size) << what << ": energy";
    }
    for (std::size_t j = 0; j < alone.joints.size(); ++j) {
      const Joint& joint = alone.joints[j];
      const Joint* const other = named(placed.joints, "P." + joint.name);
      ASSERT_NE(other, nullptr) << what << ": " << joint.name;
      if (joint.kind == Joint::Kind::bar) {
        expect_near(other->length, joint.length, what + ": " + joint.name);
        continue;
      }
      const Vec2 here = place.turned(test::gap(alone, static_cast<int>(j), 0.3, own));
      const Vec2 gap = test::gap(placed, static_cast<int>(other - placed.joints.data()), 0.3, there);
      expect_near(norm(gap - here), 0.0, what + ": " + joint.name);
      const double turn = own[joint.b.body].angle - own[joint.a.body].angle - joint.angle;
      const double turn_there = there[other->b.body].angle - there[other->a.body].angle - other->angle;
      if (joint.keeps_angle()) expect_near(std::abs(turn_there), std::abs(turn), what + ": angle of " + joint.name);
    }
    for (const Element& element : alone.elements) {
      for (const Element& other : placed.elements) {
        if (other.table != element.table || other.name != "P." + element.name) continue;
        expect_near(test::measured(placed, other.on, there), test::measured(alone, element.on, own),
                    what + ": " + element.name);
      }
    }
    for (const Drive& drive : alone.drives) {
      const Drive* const other = named(placed.drives, "P." + drive.name);
      ASSERT_NE(other, nullptr);
      expect_near(test::measured(placed, other->on, there), test::measured(alone, drive.on, own), what + drive.name);
    }
    for (const Stop& stop : alone.stops) {
      const Stop* const other = named(placed.stops, "P." + stop.name);
      ASSERT_NE(other, nullptr) << what << ": " << stop.name;
      const double g = test::measured(alone, stop.on, own), g_there = test::measured(placed, other->on, there);
      const double below = g - stop.min, above = stop.max - g;
      const double below_there = g_there - other->min, above_there = other->max - g_there;
      const auto near = [](double a, double b) {
        return a == b || have_no_value(a, b) || std::abs(a - b) <= 1e-9 * std::max({1.0, std::abs(a), std::abs(b)});
      };
      EXPECT_TRUE((near(below, below_there) && near(above, above_there)) ||
                  (near(below, above_there) && near(above, below_there)))
          << what << ": " << stop.table << " " << stop.name << ": " << below << ", " << above << " and " << below_there
          << ", " << above_there;
    }
    for (const Force& force : alone.forces) {
      const Force* const other = named(placed.forces, "P." + force.name);
      ASSERT_NE(other, nullptr);
      const auto in_world = [](const Force& of, const Poses& poses) {
        return of.follows < 0 ? of.vector : of.vector * unit(poses[static_cast<std::size_t>(of.follows)].angle);
      };
      expect_near(norm(in_world(*other, there) - place.turned(in_world(force, own))) / (1 + norm(force.vector)), 0.0,
                  what + ": " + force.name);
    }
  }
}

TEST(Parts, RandomMechanismsAreTheSameAtAnyPlace) {
  const TempFolder folder;
  const std::string file = folder.path("main.toml").string();
  std::mt19937_64 random(test::seed(7));
  for (int k = 0; k < test::cases(60, 3000); ++k) {
    const std::uint64_t seed = test::seed(100 + static_cast<std::uint64_t>(k));
    const test::Wish wish{.loops = k % 4, .followers = k % 3 == 0, .stops = k % 2 == 0, .couplings = k % 2 == 1};
    const Scene planted = test::plant_mechanism(seed, wish).scene;
    const std::string text = test::scene_text(planted);
    folder.write("one.toml", text);
    const Scene alone = parse_scene(text, file);
    const Placement place = random_placement(random);
    const Scene placed = parse_scene(assembly_of("one.toml", alone, place), file);
    expect_same_mechanics(alone, placed, place, random, fmt::format("seed {}", seed));
    if (HasFailure()) return;
  }
}

TEST(Parts, DatasetsAreTheSameAtAnyPlace) {
  std::mt19937_64 random(test::seed(11));
  for (const std::string& name : test::scene_names()) {
    if (name.find('/') != std::string::npos) continue;
    const Scene alone = read_scene(test::dataset(name));
    Placement place = random_placement(random);
    for (const Stop& stop : alone.stops) {
      if (is_rolling_profile(stop)) place.mirrored = false;
    }
    const Scene placed = parse_scene(assembly_of(name, alone, place), test::dataset("main.toml").string());
    expect_same_mechanics(alone, placed, place, random, name);
  }
}

TEST(Parts, EquilibriaForcesAndPlacesAreThoseOfTheSceneAlone) {
  std::mt19937_64 random(5);
  for (const std::string name :
       {"four_bar_torsion.toml", "toggle_clamp.toml", "planetary_gear.toml", "cam_follower.toml", "arc_slot.toml",
        "curved_slot.toml", "rolling_wheel.toml", "eccentric_chain.toml", "gas_lid.toml", "six_bar.toml"}) {
    const Scene alone = read_scene(test::dataset(name));
    Placement place = random_placement(random);
    place.mirrored = true;
    const Scene placed = parse_scene(assembly_of(name, alone, place), test::dataset("main.toml").string());
    const StaticModel own(alone), there(placed);
    const Equilibrium here = solve(own), found = solve(there);
    ASSERT_TRUE(here.found()) << name << ": " << here.why;
    ASSERT_TRUE(found.found()) << name << ": " << found.why;
    const auto poses = own.poses(here.x), placed_poses = there.poses(found.x);
    for (std::size_t b = 1; b < alone.bodies.size(); ++b) {
      const int body = body_named(placed, "P." + alone.bodies[b].name);
      const BodyPose<double> expected = place.of(poses[b]), pose = placed_poses[static_cast<std::size_t>(body)];
      EXPECT_NEAR(std::remainder(pose.angle - expected.angle, 2 * M_PI), 0.0, 1e-7) << name << alone.bodies[b].name;
      EXPECT_NEAR(norm(pose.origin - expected.origin), 0.0, 1e-7 * (1 + norm(expected.origin))) << name;
    }
    for (const Reaction& reaction : here.check.reactions) {
      const Reaction& other = test::reaction_of(found.check, "P." + reaction.name);
      EXPECT_NEAR(norm(other.force), norm(reaction.force), 1e-6 * (1 + norm(reaction.force))) << name << reaction.name;
    }
  }
}

std::vector<double> frequencies(const Scene& scene) {
  const StaticModel statics(scene);
  const MotionModel motion(scene);
  std::vector<double> out;
  for (const Vibration& one : modes_of(motion, motion_coordinates(motion, statics, solve(statics).x)).vibrations) {
    out.push_back(one.frequency);
  }
  return out;
}

TEST(Parts, FrequenciesAreThoseOfTheSceneAlone) {
  std::mt19937_64 random(3);
  for (const std::string name : {"planetary_gear.toml", "eccentric_chain.toml", "offset_cam.toml", "rolling_wheel.toml",
                                 "curved_slot.toml", "double_pendulum.toml", "lift.toml"}) {
    const Scene alone = read_scene(test::dataset(name));
    Placement place = random_placement(random);
    place.mirrored = true;
    const std::vector<double> own = frequencies(alone);
    const std::vector<double> there =
        frequencies(parse_scene(assembly_of(name, alone, place), test::dataset("main.toml").string()));
    ASSERT_FALSE(own.empty());
    ASSERT_EQ(there.size(), own.size()) << name;
    for (std::size_t k = 0; k < own.size(); ++k) EXPECT_NEAR(there[k], own[k], 1e-8 * own[k]) << name;
  }
}

// --- a lift of stages ------------------------------------------------------------------------------------------------

TEST(Parts, ALiftOfStagesIsTheOneWrittenByHand) {
  const StaticModel lift(read_scene(test::dataset("scissor_lift_of_parts.toml")));
  const StaticModel by_hand(read_scene(test::dataset("scissor_lift.toml")));
  const Equilibrium found = solve(lift), expected = solve(by_hand);
  ASSERT_TRUE(found.found() && expected.found());
  for (const int stage : {1, 2, 3}) {
    EXPECT_NEAR(test::angle_of(lift, found.x, fmt::format("stage_{}.rise", stage)), 0.5, 1e-11);
    EXPECT_NEAR(test::angle_of(lift, found.x, fmt::format("stage_{}.rise", stage)),
                test::angle_of(by_hand, expected.x, fmt::format("rise{}", stage)), 1e-11);
  }
  const Vec2 pin = test::reaction_of(found.check, "stage_2.middle").force;
  EXPECT_NEAR(norm(pin), norm(test::reaction_of(expected.check, "rise2.m-fall2.m").force), 1e-7);
}

// F = (n W + n^2 w) / tan theta of n stages, W on the platform and w in each arm.
TEST(Parts, TheNumberOfStagesIsOneKey) {
  const std::string file = test::dataset("scissor_lift_of_parts.toml").string();
  const std::string text = read_text_file(file);
  for (const int n : {1, 2, 5, 9}) {
    std::string more = text;
    const auto replace = [&](const std::string& a, const std::string& b) { more.replace(more.find(a), a.size(), b); };
    replace("repeat = 3", fmt::format("repeat = {}", n));
    while (more.find("stage_3.") != std::string::npos) replace("stage_3.", fmt::format("stage_{}.", n));
    const double force = (n * 1000.0 + n * n * 50.0) / std::tan(0.5);
    replace("stiffness = 60000", fmt::format("stiffness = {}", 10 * force));
    replace("free_length = 0.7723295178919067307583705", fmt::format("free_length = {}", std::cos(0.5) - 0.1));
    const StaticModel lift(parse_scene(more, file));
    const Equilibrium found = solve(lift, test::by(Method::virtual_work));
    ASSERT_TRUE(found.found()) << n << ": " << found.why;
    EXPECT_NEAR(test::angle_of(lift, found.x, fmt::format("stage_{}.rise", n)), 0.5, 1e-9) << n;
  }
}

// --- numbers ---------------------------------------------------------------------------------------------------------

const std::string strut = R"(
[numbers]
k = 200
half = "k/2"
[ground]
points = { A = [0, 0] }
[body.rod]
points = { A = [0, 0], B = [0, 1] }
mass = 2
[[pin]]
name = "foot"
points = ["ground.A", "rod.A"]
[[torsion_spring]]
name = "hinge"
bodies = ["ground", "rod"]
stiffness = "half"
free_angle = 0.25
)";

const std::string frame = R"(gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[[part]]
name = "left"
file = "strut.toml"
[[part]]
name = "right"
file = "strut.toml"
at = [2, 0]
mirror = true
)";

class PartsOfAFrame : public testing::Test {
 protected:
  PartsOfAFrame() { folder_.write("strut.toml", strut); }
  Scene read(const std::string& text) const { return parse_scene(text, file()); }
  std::string file() const { return folder_.path("frame.toml").string(); }
  std::string message(const std::string& text) const {
    std::string said = message_of([&] { read(text); });
    const std::string place = folder_.path("").string();
    for (std::size_t at = 0; (at = said.find(place)) != std::string::npos;) said.erase(at, place.size());
    return said;
  }

  TempFolder folder_;
};

TEST_F(PartsOfAFrame, NumbersOfAFileAreOneNumber) {
  Scene scene = read(frame);
  EXPECT_EQ(get_value(scene, "torsion_spring.left.hinge.stiffness"), 100);
  set_value(scene, "numbers.strut.k", 300);
  set_value(scene, "numbers.strut.body.rod.mass", 3);
  for (const std::string part : {"left", "right"}) {
    EXPECT_EQ(get_value(scene, "torsion_spring." + part + ".hinge.stiffness"), 150);
    EXPECT_EQ(get_value(scene, "body." + part + ".rod.mass"), 3);
  }
  EXPECT_EQ(get_value(scene, "point.right.rod.B.y"), -1);
  EXPECT_NE(message_of([&] { set_value(scene, "body.left.rod.mass", 4); }).find("change numbers.strut.body.rod.mass"),
            std::string::npos);
}

// Upright rods that lean by a: k (a - a0) = m g sin a / 2, both alike, so that the derivative of one angle by a shared
// number is that of the rod alone, and by mirroring the other has the opposite one.
TEST_F(PartsOfAFrame, OneNumberHasOneDerivative) {
  const StaticModel model(read(frame));
  const Sensitivities found = sensitivities(
      model, {find_quantity(model.scene(), "angle.left.rod"), find_quantity(model.scene(), "angle.right.rod")});
  ASSERT_EQ(found.why, "");
  const auto by = [&](std::size_t of) {
    for (const Sensitivity& one : found.of[of].by) {
      if (one.number == "numbers.strut.k") return one.derivative;
    }
    return std::nan("");
  };
  const double a = found.of[0].value;
  EXPECT_NEAR(by(0), -0.5 * (a - 0.25) / 100, 1e-9);  // the centre of mass is in the pin
  EXPECT_NEAR(by(1), -by(0), 1e-12);
}

TEST_F(PartsOfAFrame, APartMayHaveItsOwnNumbers) {
  std::string text = frame;
  text += "numbers = { k = \"2*K\", \"body.rod.mass\" = 5 }\n[numbers]\nK = 400\n";
  Scene scene = read(text);
  EXPECT_EQ(get_value(scene, "torsion_spring.left.hinge.stiffness"), 100);
  EXPECT_EQ(get_value(scene, "torsion_spring.right.hinge.stiffness"), 400);
  EXPECT_EQ(get_value(scene, "body.left.rod.mass"), 2);
  EXPECT_EQ(get_value(scene, "body.right.rod.mass"), 5);
  set_value(scene, "numbers.K", 100);
  set_value(scene, "numbers.right.body.rod.mass", 6);
  EXPECT_EQ(get_value(scene, "torsion_spring.right.hinge.stiffness"), 100);
  EXPECT_EQ(get_value(scene, "body.right.rod.mass"), 6);
  EXPECT_EQ(get_value(scene, "body.left.rod.mass"), 2);
}

TEST_F(PartsOfAFrame, ExpressionsNameNumbersOfParts) {
  const Scene scene = read(frame + "[[torque]]\non = \"left.rod\"\nvalue = \"strut.k/4\"\n");
  EXPECT_EQ(scene.torques[0].value, 50);
}

TEST_F(PartsOfAFrame, ChangedNumbersAreWrittenIntoTheScene) {
  Scene scene = read(frame);
  set_value(scene, "numbers.strut.k", 300);
  set_value(scene, "numbers.strut.body.rod.mass", 3);
  set_value(scene, "point.ground.right.x", 2.5);
  set_value(scene, "start.left.rod", 0.1);
  const std::string written = rewritten_scene(frame, file(), scene);
  const Scene back = read(written);
  for (const std::string path : {"numbers.strut.k", "torsion_spring.right.hinge.stiffness", "body.left.rod.mass",
                                 "point.ground.right.x", "start.left.rod"}) {
    EXPECT_EQ(get_value(back, path), get_value(scene, path)) << written;
  }
  EXPECT_NE(written.find("at = [2.5, 0]"), std::string::npos) << written;
  EXPECT_EQ(rewritten_scene(written, file(), back), written);
  // The file of the part leaves this one to its default.
  set_value(scene, "body.left.rod.inertia", 2);
  EXPECT_NE(message_of([&] { rewritten_scene(frame, file(), scene); }).find("into "), std::string::npos);
}

TEST_F(PartsOfAFrame, ChangedNumbersOfAPartAreWrittenIntoItsTable) {
  const std::string text = frame + "repeat = 2\nnumbers = { k = 80, \"body.rod.mass\" = 5 }\n[numbers]\nL = 3\n";
  Scene scene = read(text);
  set_value(scene, "numbers.right.k", 90);
  set_value(scene, "numbers.right.body.rod.mass", 6);
  set_value(scene, "numbers.strut.k", 70);
  set_value(scene, "numbers.L", 4);
  const std::string written = rewritten_scene(text, file(), scene);
  EXPECT_NE(written.find("numbers = { k = 90.0, \"body.rod.mass\" = 6.0 }"), std::string::npos) << written;
  const Scene back = read(written);
  EXPECT_EQ(get_value(back, "body.right_2.rod.mass"), 6);
  EXPECT_EQ(get_value(back, "torsion_spring.right_1.hinge.stiffness"), 45);
  EXPECT_EQ(get_value(back, "torsion_spring.left.hinge.stiffness"), 35);
  EXPECT_EQ(rewritten_scene(written, file(), back), written);
}

TEST_F(PartsOfAFrame, ScaleMultipliesLengthsAlone) {
  folder_.write("big.toml",
                "[units]\nlength = \"mm\"\n[ground]\npoints = { A = [1, 2] }\n[body.b]\npoints = { P = [3, 4] }\n"
                "inertia = 5\n[[spring]]\nname = \"s\"\npoints = [\"ground.A\", \"b.P\"]\nstiffness = 6\n"
                "free_length = 7\n");
  const Scene scene = read("[[part]]\nfile = \"big.toml\"\nscale = 2\n");
  EXPECT_DOUBLE_EQ(get_value(scene, "point.big.ground.A.y"), 0.004);
  EXPECT_DOUBLE_EQ(get_value(scene, "point.big.b.P.x"), 0.006);
  EXPECT_DOUBLE_EQ(get_value(scene, "spring.big.s.free_length"), 0.014);
  EXPECT_DOUBLE_EQ(get_value(scene, "spring.big.s.stiffness"), 6000);
  EXPECT_DOUBLE_EQ(get_value(scene, "body.big.b.inertia"), 5e-6);
}

TEST_F(PartsOfAFrame, PartsStandOnBodiesAndContainParts) {
  folder_.write("pair.toml",
                "[numbers]\nK = 50\n[ground]\npoints = { O = [0, 0] }\n[body.base]\n[[slide]]\nname = \"way\"\n"
                "points = [\"ground.O\", \"base.O\"]\naxis = [1, 0]\n[[part]]\nname = \"arm\"\n"
                "file = \"strut.toml\"\non = \"base\"\nat = [0.5, 0]\nrepeat = 2\nstep = [1, 0]\n"
                "numbers = { k = \"K\" }\n");
  const std::string pair = folder_.path("pair.toml").string();
  folder_.write("pair.toml", read_text_file(pair).replace(read_text_file(pair).find("[body.base]\n"), 12,
                                                          "[body.base]\npoints = { O = [0, 0] }\n"));
  Scene scene = read(
      "[[part]]\nname = \"a\"\nfile = \"pair.toml\"\n[[part]]\nname = \"b\"\nfile = \"pair.toml\"\nat = [0, 3]\n"
      "angle = 1\nnumbers = { K = 70 }\n");
  EXPECT_EQ(get_value(scene, "point.b.base.arm_2.x"), 1.5);
  EXPECT_EQ(get_value(scene, "torsion_spring.a.arm_1.hinge.stiffness"), 25);
  EXPECT_EQ(get_value(scene, "torsion_spring.b.arm_2.hinge.stiffness"), 35);
  set_value(scene, "numbers.pair.K", 80);
  EXPECT_EQ(get_value(scene, "torsion_spring.a.arm_2.hinge.stiffness"), 40);
  EXPECT_EQ(get_value(scene, "torsion_spring.b.arm_2.hinge.stiffness"), 35);
  EXPECT_EQ(get_value(scene, "start.b.arm_1.rod"), 1);
}

TEST_F(PartsOfAFrame, RepeatedPartsAreAStepAndATurnApart) {
  const Scene scene = read(
      "[units]\nangle = \"deg\"\n[[part]]\nname = \"r\"\nfile = \"strut.toml\"\nat = [1, 0]\n"
      "repeat = 4\nstep = [2, 0]\nturn = 90\n");
  EXPECT_NEAR(get_value(scene, "point.ground.r_4.x"), 1, 1e-12);
  EXPECT_NEAR(get_value(scene, "point.ground.r_4.y"), 2, 1e-12);
  EXPECT_NEAR(get_value(scene, "weld.r_4.angle"), 270, 1e-9);
}

// Placing makes and removes numbers, and what is made later must not take the sign of one removed.
TEST(Parts, MirroredPartsHaveTheSameNumbersEach) {
  TempFolder folder;
  std::string stage = read_text_file(test::dataset("parts/scissor_stage.toml"));
  const std::string right = "right = [0.9, 0]";
  folder.write("stage.toml",
               stage.replace(stage.find(right), right.size(), right + ", q = [1, 2], r = [2, 1], s = [3, 3]"));
  for (int count = 2; count <= 30; ++count) {
    const Scene scene = parse_scene(
        fmt::format("[ground]\npoints = {{ O = [0, 0] }}\n[[part]]\nname = \"p\"\nfile = \"stage.toml\"\n"
                    "mirror = true\nrepeat = {}\nstep = [5, 0.5]\njoin_next = {{ left = \"fall.b\" }}\n"
                    "join = {{ left = \"ground.O\", q = \"ground.O\", r = \"ground.O\", s = \"ground.O\" }}\n"
                    "numbers = {{ \"point.ground.right.x\" = 1.1, \"point.fall.a.x\" = 0.25 }}\n",
                    count),
        folder.path("row.toml").string());
    for (int k = 1; k <= count; ++k) {
      EXPECT_EQ(get_value(scene, fmt::format("point.p_{}.ground.right.x", k)), 1.1) << k << " of " << count;
      EXPECT_EQ(get_value(scene, fmt::format("point.p_{}.fall.a.x", k)), 0.25) << k << " of " << count;
    }
  }
}

// What couplings add to a scene begins where the part has it, too: lines between centres.
TEST(Parts, LinesOfCentresAreTurnedWithThePart) {
  TempFolder folder;
  folder.write("roll.toml", R"(
[ground]
points = { O = [0, 0] }
[body.wheel]
points = { C = [0, 0], P = [1, 0] }
mass = 1
inertia = 0.5
[[rolling_on_circle]]
name = "rl"
wheel = "wheel.C"
center = "ground.O"
radius = 1
circle_radius = 2
[start]
position = { wheel = [3, 0] }
)");
  for (const bool mirrored : {false, true}) {
    const Scene scene =
        parse_scene(fmt::format("[[part]]\nname = \"q\"\nfile = \"roll.toml\"\nangle = 3\nmirror = {}\n", mirrored),
                    folder.path("turned.toml").string());
    const MotionModel model(scene);
    const std::vector<double> q = start_motion(model, {}).q;
    const Vec2 at = model.poses(model.from_si(q))[static_cast<std::size_t>(body_named(scene, "q.wheel"))].origin;
    EXPECT_NEAR(at.x, 3 * std::cos(3.0), 1e-9) << mirrored;
    EXPECT_NEAR(at.y, 3 * std::sin(3.0), 1e-9) << mirrored;
  }
}

// A contact of curves names points and not numbers of the file, as does the word of a law.
TEST(Parts, NamesOfAPartAreNoExpressions) {
  TempFolder folder;
  folder.write("egg.toml", R"(
[ground]
points = { O = [0, 0] }
[body.ball]
points = { C = [0, 0] }
mass = 1
inertia = 0.1
[body.egg]
points = { C = [0, 0] }
mass = 1
inertia = 0.1
[[pin]]
points = ["ground.O", "egg.C"]
[[curve_contact]]
name = "cc"
at = "ball.C"
curve = [[0.8, 0], [0, 0.8], [-0.8, 0], [0, -0.8]]
against = "egg.C"
against_curve = [[1.4, 0], [0, 1.0], [-1.4, 0], [0, -1.0]]
[[friction]]
name = "rub"
bodies = ["ground", "egg"]
torque = 1
static = 2
stribeck_rate = 0.1
stribeck = "hyperbolic"
[start]
position = { ball = [0.1, 2] }
)");
  const Scene scene = parse_scene("[[part]]\nname = \"p\"\nfile = \"egg.toml\"\n", folder.path("scene.toml").string());
  EXPECT_EQ(scene.elements.size(), 1U);
  EXPECT_TRUE(std::any_of(scene.stops.begin(), scene.stops.end(),
                          [](const Stop& one) { return one.table.starts_with("curve_contact"); }));
}

// --- places that are expressions -------------------------------------------------------------------------------------

const std::string fan = R"(gravity = [0, -10]
[units]
angle = "deg"
[numbers]
s = 1.25
t = 20
d = 1.5
[ground]
points = { O = [0, 0] }
[[part]]
name = "p"
file = "strut.toml"
at = ["d", "-d/2"]
angle = "2*t"
scale = "s"
repeat = 3
step = ["d", "0.1*s"]
turn = "t"
)";

std::string with_numbers(std::string text, double s, double t, double d) {
  const auto replace = [&](const std::string& a, const std::string& b) { text.replace(text.find(a), a.size(), b); };
  replace("s = 1.25", fmt::format("s = {}", s));
  replace("t = 20", fmt::format("t = {}", t));
  replace("d = 1.5", fmt::format("d = {}", d));
  return text;
}

void expect_same_values(const Scene& a, const Scene& b, const std::string& what) {
  const std::vector<ParameterRow> rows = parameter_table(a);
  ASSERT_EQ(rows.size(), parameter_table(b).size()) << what;
  const std::vector<std::optional<double>> one = parameter_values(a), other = parameter_values(b);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(one[i].has_value(), other[i].has_value()) << what << rows[i].path.text();
    // A constant that the file leaves to the guess is that of the scene that was read.
    if (rows[i].path.text() == "chain.P.chain.length") continue;
    if (one[i] && rows[i].place.owner != Owner::start)
      expect_near(*one[i], *other[i], what + ": " + rows[i].path.text());
  }
}

TEST_F(PartsOfAFrame, AChangedNumberMovesTurnsAndScalesThem) {
  Scene scene = read(fan);
  set_value(scene, "numbers.s", 0.8);
  set_value(scene, "numbers.t", 35);
  set_value(scene, "numbers.d", 2);
  const Scene expected = read(with_numbers(fan, 0.8, 35, 2));
  expect_same_values(scene, expected, "fan");
  EXPECT_NEAR(get_value(scene, "weld.p_3.angle"), 140, 1e-12);
  EXPECT_NEAR(get_value(scene, "point.ground.p_3.x"),
              2 + 2 + 2 * std::cos(35 * M_PI / 180) - 0.08 * std::sin(35 * M_PI / 180), 1e-12);
  EXPECT_NEAR(get_value(scene, "point.p_2.rod.B.y"), 0.8, 1e-15);
  const std::string written = rewritten_scene(fan, file(), scene);
  expect_same_values(read(written), expected, "written");
  EXPECT_EQ(written.substr(written.find("[ground]")), fan.substr(fan.find("[ground]")));
}

TEST_F(PartsOfAFrame, AScaleStaysPositive) {
  Scene scene = read(fan);
  for (const double s : {0.0, -1.0}) {
    const std::string said = message_of([&] { set_value(scene, "numbers.s", s); });
    EXPECT_NE(said.find("part \"p\".scale = \"s\": expected a finite number > 0"), std::string::npos) << said;
  }
  EXPECT_EQ(get_value(scene, "numbers.s"), 1.25);
}

TEST_F(PartsOfAFrame, PlacesHaveExactDerivatives) {
  const auto value = [&](double s, double t, double d) {
    const StaticModel model(read(with_numbers(fan, s, t, d)));
    return sensitivities(model, {find_quantity(model.scene(), "y.p_3.rod.B")}).of[0].value;
  };
  const StaticModel model(read(fan));
  const Sensitivities found = sensitivities(model, {find_quantity(model.scene(), "y.p_3.rod.B")});
  ASSERT_EQ(found.why, "");
  const double h = 1e-5;
  const std::map<std::string, double> expected{
      {"numbers.s", (value(1.25 + h, 20, 1.5) - value(1.25 - h, 20, 1.5)) / (2 * h)},
      {"numbers.t", (value(1.25, 20 + h, 1.5) - value(1.25, 20 - h, 1.5)) / (2 * h)},
      {"numbers.d", (value(1.25, 20, 1.5 + h) - value(1.25, 20, 1.5 - h)) / (2 * h)}};
  std::size_t seen = 0;
  for (const Sensitivity& one : found.of[0].by) {
    const auto wanted = expected.find(one.number);
    if (wanted == expected.end()) continue;
    ++seen;
    EXPECT_NEAR(one.derivative, wanted->second, 1e-8) << one.number;
  }
  EXPECT_EQ(seen, 3U);
}

// A part within a part, both scaled by numbers of their files, on a body of another part.
TEST_F(PartsOfAFrame, ScalesOfPartsWithinPartsMultiply) {
  folder_.write("pair.toml",
                "[units]\nlength = \"mm\"\n[numbers]\nq = 2\n[ground]\npoints = { O = [1, 0] }\n[body.base]\n"
                "points = { P = [100, 0] }\n[[pin]]\npoints = [\"ground.O\", \"base.P\"]\n[[part]]\nname = \"arm\"\n"
                "file = \"strut.toml\"\nscale = \"q/2\"\nat = [\"30*q\", 1]\n");
  const std::string text =
      "[numbers]\ns = 3\n[[part]]\nname = \"a\"\nfile = \"pair.toml\"\nscale = \"s\"\nnumbers = { q = \"4*s\" }\n"
      "[[part]]\nname = \"b\"\nfile = \"strut.toml\"\non = \"a.base\"\nat = [0.6, 0]\n";
  Scene scene = read(text);
  EXPECT_NEAR(get_value(scene, "point.a.arm.rod.B.y"), 3 * 12 / 2.0, 1e-12);
  EXPECT_NEAR(get_value(scene, "point.a.ground.arm.x"), 3 * 30 * 12 * 1e-3, 1e-12);
  EXPECT_NEAR(get_value(scene, "point.a.base.b.x"), 0.6, 1e-12);
  set_value(scene, "numbers.s", 2);
  std::string other = text;
  other.replace(other.find("s = 3"), 5, "s = 2");
  expect_same_values(scene, read(other), "pair");
  EXPECT_NEAR(get_value(scene, "point.a.arm.rod.B.y"), 2 * 8 / 2.0, 1e-12);
  EXPECT_NEAR(get_value(scene, "point.a.base.b.x"), 0.6, 1e-12);
}

TEST(Parts, AllLengthsFollowAnExpressionOfTheScale) {
  const std::string file = test::dataset("main.toml").string();
  for (const std::string& name : test::scene_names()) {
    if (name.find('/') != std::string::npos) continue;
    const auto text = [&](const std::string& scale, double s) {
      return fmt::format("[numbers]\ns_of_test = {}\n[[part]]\nname = \"P\"\nfile = \"{}\"\nscale = {}\n", s, name,
                         scale);
    };
    Scene scene;
    try {
      scene = parse_scene(text("\"2*s_of_test\"", 0.6), file);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("key scale"), std::string::npos) << error.what();
      continue;
    }
    expect_same_values(scene, parse_scene(text("1.2", 0.6), file), name);
    set_value(scene, "numbers.s_of_test", 0.7);
    expect_same_values(scene, parse_scene(text("1.4", 0.7), file), name);
  }
}

// --- what is refused -------------------------------------------------------------------------------------------------

TEST_F(PartsOfAFrame, ErrorsOfAPartHaveItsFileAndLine) {
  const auto with = [&](const std::string& a, const std::string& b) {
    std::string text = strut;
    text.replace(text.find(a), a.size(), b);
    folder_.write("strut.toml", text);
    return message(frame);
  };
  EXPECT_EQ(with("mass = 2", "mass = -2"),
            "strut.toml:9: body.rod.mass: expected a finite number >= 0, found -2 (part \"left\" of frame.toml:4)");
  EXPECT_EQ(with("mass = 2", "mas = 2").substr(0, 26), "strut.toml:9: body.rod.mas");
  EXPECT_EQ(with("mass = 2", "mass = \"K\"").substr(0, 26), "strut.toml:9: body.rod.mas");
  EXPECT_EQ(with("\"rod.A\"]", "\"rod.C\"]"),
            "strut.toml:12: pin \"foot\".points: expected a point of \"rod\", found \"rod.C\"; did you mean \"rod.A\"? "
            "(part \"left\" of frame.toml:4)");
  EXPECT_EQ(with("mass = 2", "mass = = 2").substr(0, 26), "strut.toml:9: TOML syntax:");
  EXPECT_EQ(with("[numbers]", "[pins]\nx = 1\n[numbers]").substr(0, 20), "strut.toml:2: pins: ");
}

TEST_F(PartsOfAFrame, WhatCannotBeAPartIsRefused) {
  folder_.write("a.toml", "[body.q]\n[[part]]\nfile = \"b.toml\"\n");
  folder_.write("b.toml", "[body.q]\n[[part]]\nfile = \"a.toml\"\n");
  folder_.write("roll.toml", read_text_file(test::dataset("rocking_chair.toml")));
  const auto refused = [&](const std::string& part) { return message("[[part]]\n" + part); };
  EXPECT_EQ(refused("file = \"nothing.toml\"\n"),
            "frame.toml:2: part 1.file: nothing.toml: cannot be read: No such file or directory; check the path");
  EXPECT_NE(refused("file = \"../strut.toml\"\n").find("in the folder of the scene or below it"), std::string::npos);
  EXPECT_EQ(refused("file = \"strutt.toml\"\n"),
            "frame.toml:2: part 1.file: expected a file that is there, found \"strutt.toml\"; did you mean "
            "\"strut.toml\"?");
  EXPECT_NE(refused("file = \"/etc/passwd\"\n").find("in the folder of the scene or below it"), std::string::npos);
  EXPECT_NE(refused("file = \"a.toml\"\n").find("found frame.toml -> a.toml -> b.toml -> a.toml"), std::string::npos);
  folder_.write("frame.toml", frame);
  EXPECT_NE(refused("file = \"frame.toml\"\n").find("found frame.toml -> frame.toml"), std::string::npos);
  EXPECT_NE(refused("file = \"" + std::string(5000, 'x') + "\"\n").find("expected the name of a file"),
            std::string::npos);
  EXPECT_NE(refused("file = \"\"\n"), "");
  EXPECT_NE(refused("file = \"strut.toml\"\nangel = 3\n").find("did you mean \"angle\"?"), std::string::npos);
  EXPECT_NE(refused("file = \"strut.toml\"\nrepeat = 0\n").find("whole number from 1"), std::string::npos);
  EXPECT_NE(refused("file = \"strut.toml\"\nrepeat = 1001\n").find("from 1 to 1000, found 1001"), std::string::npos);
  EXPECT_NE(refused("file = \"strut.toml\"\nstep = [1, 0]\n").find("add repeat = 2"), std::string::npos);
  EXPECT_NE(refused("file = \"strut.toml\"\nscale = 0\n").find("scale"), std::string::npos);
  for (const std::string scale : {"-1", "nan", "inf", "1e308", "\"0/1\"", "\"-2\"", "\"1/0\"", "\"q\"", "[1]"}) {
    EXPECT_EQ(refused("file = \"strut.toml\"\nscale = " + scale + "\n").find("frame.toml:3: part 1.scale: expected "),
              0U)
        << scale;
  }
  EXPECT_EQ(refused("file = \"strut.toml\"\nrepeat = 2\nturn = \"q\"\n").find("frame.toml:4: "), 0U);
  EXPECT_EQ(refused("file = \"strut.toml\"\nat = [0, nan]\n").find("frame.toml:3: part 1.at: expected two finite"), 0U);
  EXPECT_NE(refused("file = \"strut.toml\"\nname = \"ground\"\n").find("give the part another"), std::string::npos);
  EXPECT_EQ(refused("file = \"strut.toml\"\njoin = { A = \"ground.Q\" }\n"),
            "frame.toml:3: part 1.join: expected a point \"BODY.POINT\" of the scene or of one of its parts, found "
            "\"ground.Q\"; known here: ground.strut, strut.ground.origin, strut.rod.A, strut.rod.B");
  EXPECT_NE(refused("file = \"strut.toml\"\nrepeat = 2\njoin_next = { A = \"rod.C\" }\n")
                .find("frame.toml:4: part 1.join_next: expected a point"),
            std::string::npos);
  EXPECT_NE(message("[numbers]\nt = 0.1\n[[part]]\nfile = \"strut.toml\"\nrepeat = 100\nstep = [1, 0]\nturn = \"t\"\n")
                .find("frame.toml:5: part 1.repeat: expected fewer parts"),
            std::string::npos);
  EXPECT_NE(refused("file = \"strut.toml\"\nname = \"1\"\n").find("letters, digits and underscores"),
            std::string::npos);
  EXPECT_NE(refused("file = \"strut.toml\"\non = \"rod\"\n").find("expected the name of a body"), std::string::npos);
  EXPECT_NE(refused("file = \"strut.toml\"\njoin = { B = \"x.y\" }\n").find("points of the ground of"),
            std::string::npos);
  EXPECT_NE(refused("file = \"strut.toml\"\nnumbers = { q = 1 }\n").find("expected a name of [numbers] of"),
            std::string::npos);
  EXPECT_NE(refused("file = \"strut.toml\"\n[[part]]\nfile = \"strut.toml\"\n").find("name of its own"),
            std::string::npos);
  EXPECT_NE(refused("file = \"roll.toml\"\nmirror = true\n").find("not mirrored"), std::string::npos);
  EXPECT_NE(message("[numbers]\n\"strut.q\" = 2\n" + frame.substr(frame.find("[[part]]"))).find("of a part"),
            std::string::npos);
}

}  // namespace
}  // namespace poise::parts_test

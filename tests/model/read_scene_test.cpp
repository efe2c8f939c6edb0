#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <ostream>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "tests/support/elements.hpp"

namespace poise::read_scene_test {
namespace {

std::string repeated(const std::string& part, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += part;
  return out;
}

constexpr double inch = 0.0254;
constexpr double pound_force = 4.4482216152605;
constexpr double pound = 0.45359237;
constexpr double degree = 3.14159265358979323846 / 180.0;

/// Every key of the grammar once, in the units of a workshop.
const char* const everything = R"(title = "Everything"
source = "made up"
gravity = [0, -386.09]

[units]
length = "in"
force = "lbf"
mass = "lb"
angle = "deg"

[ground]
points = { S = [10, 0.5], O = [0, 0] }

[body.crank]
points = { O = [0, 0], B = [4, 0] }
mass = 2
center = [2, 0.25]
inertia = 6

[body.block]
points.C = [0, 0]
points.D = [1, 1]

[body."arm.left"]
points = { E = [0, 1] }

[[slide]]
name = "ram"
points = ["ground.S", "block.C"]
axis = [3, 4]
angle = 90

[[pin]]
points = ["ground.O", "crank.O"]

[[pin_in_slot]]
points = ["crank.B", "block.D"]
axis = [0, -2]

[[weld]]
points = ["crank.B", "arm.left.E"]
angle = -45

[[bar]]
points = ["ground.S", "crank.B"]
length = 6

[[pin]]
points = ["ground.O", "crank.O"]

[[spring]]
points = ["ground.O", "block.D"]
stiffness = 3
free_length = 5
acts = "tension"

[[spring]]
name = "return"
points = ["ground.O", "block.D"]
stiffness = 3
free_length = 0
acts = "compression"

[[spring]]
points = ["ground.O", "block.D"]
stiffness = 1
free_length = 1
acts = "both"

[[torsion_spring]]
bodies = ["ground", "crank"]
stiffness = 7
free_angle = 450

[[force]]
at = "crank.B"
vector = [30, -40]

[[force]]
name = "thrust"
at = "block.D"
vector = [1, 0]
follows = "arm.left"

[[torque]]
on = "crank"
value = -8

[[stop]]
bodies = ["ground", "crank"]
min = -10
max = 200

[[stop]]
name = "tether"
points = ["ground.O", "block.D"]
max = 12

[[stop]]
slide = "ram"
min = -1

[[damper]]
points = ["ground.O", "block.D"]
coefficient = 0.5

[[damper]]
name = "oil"
points = ["crank.B", "block.D"]
coefficient = 0

[[torsion_damper]]
bodies = ["ground", "crank"]
coefficient = 0.25

[[friction]]
bodies = ["crank", "arm.left"]
torque = 3
width = 2

[[friction]]
name = "dry"
bodies = ["ground", "crank"]
torque = 0

[[drive]]
bodies = ["ground", "crank"]
start = 30
rate = -360
acceleration = 12
amplitude = 5
frequency = 2.5
phase = 90

[[drive]]
name = "feed"
slide = "ram"
rate = 1.5
acceleration = -2
amplitude = 0.125

[start]
crank = 30
ram = 2
"crank.B-block.D" = -1.5
position = { block = [10, 1] }
)";

TEST(ReadScene, ReadsHeaderAndUnits) {
  const Scene scene = parse_scene(everything, "all.toml");
  EXPECT_EQ(scene.file, "all.toml");
  EXPECT_EQ(scene.title, "Everything");
  EXPECT_EQ(scene.source, "made up");
  EXPECT_EQ(scene.units.length_name, "in");
  EXPECT_EQ(scene.units.force_name, "lbf");
  EXPECT_EQ(scene.units.mass_name, "lb");
  EXPECT_EQ(scene.units.angle_name, "deg");
  EXPECT_DOUBLE_EQ(scene.units.length, inch);
  EXPECT_DOUBLE_EQ(scene.units.force, pound_force);
  EXPECT_DOUBLE_EQ(scene.units.mass, pound);
  EXPECT_DOUBLE_EQ(scene.units.angle, degree);
  EXPECT_EQ(scene.gravity.x, 0.0);
  EXPECT_NEAR(scene.gravity.y, -9.80665, 1e-4);
}

TEST(ReadScene, ReadsBodiesAndPointsInTheOrderOfTheFile) {
  const Scene scene = parse_scene(everything, "all.toml");
  ASSERT_EQ(scene.bodies.size(), 4u);
  EXPECT_EQ(scene.bodies[0].name, "ground");
  EXPECT_EQ(scene.bodies[0].line, 11);
  EXPECT_EQ(scene.name_of({0, 0}), "ground.S");
  EXPECT_EQ(scene.name_of({0, 1}), "ground.O");
  EXPECT_EQ(scene.local({0, 0}), (Vec2{10 * inch, 0.5 * inch}));
  const Body& crank = scene.bodies[1];
  EXPECT_EQ(crank.name, "crank");
  EXPECT_EQ(crank.line, 14);
  EXPECT_DOUBLE_EQ(crank.mass, 2 * pound);
  EXPECT_EQ(crank.center, (Vec2{2 * inch, 0.25 * inch}));
  EXPECT_DOUBLE_EQ(crank.inertia, 6 * pound * inch * inch);
  const Body& block = scene.bodies[2];
  EXPECT_EQ(block.name, "block");
  EXPECT_EQ(block.mass, 0.0);
  EXPECT_EQ(block.center, Vec2{});
  EXPECT_EQ(block.inertia, 0.0);
  EXPECT_EQ(scene.name_of({2, 1}), "block.D");
  EXPECT_EQ(scene.bodies[3].name, "arm.left");
}

TEST(ReadScene, ReadsJointsOfAllKindsInTheOrderOfTheFile) {
  const Scene scene = parse_scene(everything, "all.toml");
  ASSERT_EQ(scene.joints.size(), 6u);
  const Joint& slide = scene.joints[0];
  EXPECT_EQ(slide.kind, Joint::Kind::slide);
  EXPECT_EQ(slide.name, "ram");
  EXPECT_EQ(slide.line, 27);
  EXPECT_EQ(scene.name_of(slide.a), "ground.S");
  EXPECT_EQ(scene.name_of(slide.b), "block.C");
  EXPECT_NEAR(slide.direction().x, 0.6, 1e-15);
  EXPECT_NEAR(slide.direction().y, 0.8, 1e-15);
  EXPECT_DOUBLE_EQ(slide.angle, 90 * degree);
  EXPECT_EQ(scene.joints[1].kind, Joint::Kind::pin);
  EXPECT_EQ(scene.joints[1].name, "ground.O-crank.O");
  EXPECT_EQ(scene.joints[2].kind, Joint::Kind::pin_in_slot);
  EXPECT_EQ(scene.joints[2].direction(), (Vec2{0.0, -1.0}));
  EXPECT_EQ(scene.joints[3].kind, Joint::Kind::weld);
  EXPECT_EQ(scene.name_of(scene.joints[3].b), "arm.left.E");
  EXPECT_DOUBLE_EQ(scene.joints[3].angle, -45 * degree);
  EXPECT_EQ(scene.joints[4].kind, Joint::Kind::bar);
  EXPECT_DOUBLE_EQ(scene.joints[4].length, 6 * inch);
  EXPECT_EQ(scene.joints[5].name, "ground.O-crank.O (2)");
}

TEST(ReadScene, ReadsSprings) {
  const Scene scene = parse_scene(everything, "all.toml");
  ASSERT_EQ(test::count_of(scene, "spring"), 3);
  EXPECT_EQ(test::element(scene, "spring", 0).name, "spring 1");
  EXPECT_EQ(test::element(scene, "spring", 1).name, "return");
  EXPECT_EQ(test::element(scene, "spring", 2).name, "spring 3");
  const auto spring = [&](int n) { return test::law<LinearSpring>(scene, "spring", n); };
  EXPECT_DOUBLE_EQ(spring(0).stiffness, 3 * pound_force / inch);
  EXPECT_NEAR(spring(0).stiffness, 525.380, 1e-3);
  EXPECT_DOUBLE_EQ(spring(0).free_length, 5 * inch);
  EXPECT_EQ(spring(0).acts, LinearSpring::Acts::tension);
  EXPECT_EQ(spring(1).acts, LinearSpring::Acts::compression);
  EXPECT_EQ(spring(2).acts, LinearSpring::Acts::both);
  const Measure& on = test::element(scene, "spring", 0).on;
  EXPECT_EQ(on.kind, Measure::Kind::distance);
  EXPECT_EQ(scene.name_of(on.a), "ground.O");
  EXPECT_EQ(scene.name_of(on.b), "block.D");
  ASSERT_EQ(test::count_of(scene, "torsion_spring"), 1);
  const Element& torsion = test::element(scene, "torsion_spring");
  EXPECT_EQ(torsion.name, "torsion spring 1");
  EXPECT_EQ(torsion.on.kind, Measure::Kind::angle);
  EXPECT_EQ(torsion.on.body_a, 0);
  EXPECT_EQ(torsion.on.body_b, 1);
  const auto& coil = std::get<LinearSpring>(torsion.law);
  EXPECT_DOUBLE_EQ(coil.stiffness, 7 * pound_force * inch / degree);
  EXPECT_DOUBLE_EQ(coil.free_length, 450 * degree);
  EXPECT_EQ(coil.acts, LinearSpring::Acts::both);
}

TEST(ReadScene, ReadsDampersAndFriction) {
  const Scene scene = parse_scene(everything, "all.toml");
  ASSERT_EQ(test::count_of(scene, "damper"), 2);
  const Element& damper = test::element(scene, "damper", 0);
  EXPECT_EQ(damper.name, "damper 1");
  EXPECT_EQ(damper.line, scene.stops[2].line + 4);
  EXPECT_EQ(damper.on.kind, Measure::Kind::distance);
  EXPECT_EQ(scene.name_of(damper.on.a), "ground.O");
  EXPECT_EQ(scene.name_of(damper.on.b), "block.D");
  EXPECT_DOUBLE_EQ(test::law<Damper>(scene, "damper", 0).coefficient, 0.5 * pound_force / inch);
  EXPECT_EQ(test::element(scene, "damper", 1).name, "oil");
  EXPECT_EQ(test::law<Damper>(scene, "damper", 1).coefficient, 0.0);
  ASSERT_EQ(test::count_of(scene, "torsion_damper"), 1);
  const Element& torsion = test::element(scene, "torsion_damper");
  EXPECT_EQ(torsion.name, "torsion damper 1");
  EXPECT_EQ(torsion.on.kind, Measure::Kind::angle);
  EXPECT_EQ(torsion.on.body_a, 0);
  EXPECT_EQ(torsion.on.body_b, 1);
  EXPECT_DOUBLE_EQ(test::law<Damper>(scene, "torsion_damper").coefficient, 0.25 * pound_force * inch / degree);
  ASSERT_EQ(test::count_of(scene, "friction"), 2);
  const Element& friction = test::element(scene, "friction", 0);
  EXPECT_EQ(friction.name, "friction 1");
  EXPECT_EQ(friction.on.kind, Measure::Kind::angle);
  EXPECT_EQ(friction.on.body_a, 1);
  EXPECT_EQ(friction.on.body_b, 3);
  EXPECT_DOUBLE_EQ(test::law<DryFriction>(scene, "friction", 0).force, 3 * pound_force * inch);
  EXPECT_DOUBLE_EQ(test::law<DryFriction>(scene, "friction", 0).width, 2 * degree);
  EXPECT_EQ(test::element(scene, "friction", 1).name, "dry");
  EXPECT_EQ(test::law<DryFriction>(scene, "friction", 1).force, 0.0);
  EXPECT_EQ(test::law<DryFriction>(scene, "friction", 1).width, 0.01) << "rad/s, whatever the unit of angles";
}

// Two bodies, a slide between the ground and one of them, and the elements.
Scene with_elements(const std::string& elements) {
  return parse_scene(
      "[units]\nlength = 'in'\nforce = 'lbf'\nangle = 'deg'\n"
      "[ground]\npoints = { O = [0, 0], S = [1, 0] }\n[body.crank]\npoints = { O = [0, 0], B = [1, 0] }\n"
      "[body.rod]\npoints = { B = [0, 0] }\n"
      "[[slide]]\nname = 'ram'\npoints = ['ground.S', 'rod.B']\naxis = [1, 0]\n" +
          elements,
      "s.toml");
}

TEST(ReadScene, ReadsElementsUponEveryMeasure) {
  const Scene scene = with_elements(R"toml(
    [[spring]]
    bodies = ["crank", "rod"]
    stiffness = 3
    acts = "compression"
    [[spring]]
    slide = "ram"
    stiffness = 3
    free_length = -2
    [[spring]]
    x = "crank.B"
    stiffness = 3
    free_length = 2
    [[spring]]
    y = "crank.B"
    stiffness = 3
    free_length = -2
    [[spring]]
    sum = [{ factor = 2, slide = "ram" }, { factor = -0.5, points = ["ground.O", "rod.B"] }]
    stiffness = 3
    free_length = 2
    [[spring]]
    sum = [{ factor = 2, bodies = ["ground", "crank"] }, { factor = 3, bodies = ["crank", "rod"] }]
    stiffness = 3
    free_angle = 2
    [[constant_force]]
    slide = "ram"
    force = -7
    [[constant_force]]
    name = "clockwork"
    bodies = ["ground", "crank"]
    torque = 7
    [[damper]]
    bodies = ["ground", "crank"]
    coefficient = 5
    [[friction]]
    slide = "ram"
    force = 4
    width = 2
    [[stop]]
    x = "crank.B"
    min = -2)toml");
  const auto spring = [&](int n) { return test::law<LinearSpring>(scene, "spring", n); };
  const auto on = [&](int n) { return test::element(scene, "spring", n).on; };
  ASSERT_EQ(test::count_of(scene, "spring"), 6);
  EXPECT_EQ(on(0).kind, Measure::Kind::angle);
  EXPECT_EQ(on(0).body_a, 1);
  EXPECT_EQ(on(0).body_b, 2);
  EXPECT_DOUBLE_EQ(spring(0).stiffness, 3 * pound_force * inch / degree);
  EXPECT_EQ(spring(0).free_length, 0.0);
  EXPECT_EQ(spring(0).acts, LinearSpring::Acts::compression);
  EXPECT_EQ(on(1).kind, Measure::Kind::travel);
  EXPECT_EQ(on(1).joint, 0);
  EXPECT_DOUBLE_EQ(spring(1).stiffness, 3 * pound_force / inch);
  EXPECT_DOUBLE_EQ(spring(1).free_length, -2 * inch);
  EXPECT_EQ(on(2).kind, Measure::Kind::x);
  EXPECT_EQ(scene.name_of(on(2).b), "crank.B");
  EXPECT_EQ(on(3).kind, Measure::Kind::y);
  EXPECT_EQ(scene.name_of(on(3).b), "crank.B");
  EXPECT_DOUBLE_EQ(spring(3).free_length, -2 * inch);
  EXPECT_EQ(on(4).kind, Measure::Kind::sum);
  EXPECT_FALSE(on(4).is_angle());
  ASSERT_EQ(on(4).terms.size(), 2u);
  EXPECT_EQ(on(4).terms[0].factor, 2.0);
  EXPECT_EQ(on(4).terms[0].measure.kind, Measure::Kind::travel);
  EXPECT_EQ(on(4).terms[1].factor, -0.5);
  EXPECT_EQ(on(4).terms[1].measure.kind, Measure::Kind::distance);
  EXPECT_EQ(scene.name_of(on(4).terms[1].measure.a), "ground.O");
  EXPECT_TRUE(on(5).is_angle());
  EXPECT_DOUBLE_EQ(spring(5).stiffness, 3 * pound_force * inch / degree);
  EXPECT_DOUBLE_EQ(spring(5).free_length, 2 * degree);
  ASSERT_EQ(test::count_of(scene, "constant_force"), 2);
  EXPECT_EQ(test::element(scene, "constant_force", 0).name, "constant force 1");
  EXPECT_DOUBLE_EQ(test::law<ConstantForce>(scene, "constant_force", 0).force, -7 * pound_force);
  EXPECT_EQ(test::element(scene, "constant_force", 1).name, "clockwork");
  EXPECT_DOUBLE_EQ(test::law<ConstantForce>(scene, "constant_force", 1).force, 7 * pound_force * inch);
  EXPECT_DOUBLE_EQ(test::law<Damper>(scene, "damper").coefficient, 5 * pound_force * inch / degree);
  EXPECT_DOUBLE_EQ(test::law<DryFriction>(scene, "friction").force, 4 * pound_force);
  EXPECT_DOUBLE_EQ(test::law<DryFriction>(scene, "friction").width, 2 * inch);
  EXPECT_EQ(scene.stops[0].on.kind, Measure::Kind::x);
  EXPECT_DOUBLE_EQ(scene.stops[0].min, -2 * inch);
}

TEST(ReadScene, ReadsDrives) {
  const Scene scene = parse_scene(everything, "all.toml");
  ASSERT_EQ(scene.drives.size(), 2u);
  const Drive& turning = scene.drives[0];
  EXPECT_EQ(turning.on.kind, Measure::Kind::angle);
  EXPECT_EQ(turning.name, "drive 1");
  EXPECT_EQ(turning.on.body_a, 0);
  EXPECT_EQ(turning.on.body_b, 1);
  EXPECT_DOUBLE_EQ(turning.start.value(), 30 * degree);
  EXPECT_DOUBLE_EQ(turning.rate, -360 * degree);
  EXPECT_DOUBLE_EQ(turning.acceleration, 12 * degree);
  EXPECT_DOUBLE_EQ(turning.amplitude, 5 * degree);
  EXPECT_EQ(turning.frequency, 2.5);
  EXPECT_DOUBLE_EQ(turning.phase, 90 * degree);
  const Drive& feed = scene.drives[1];
  EXPECT_EQ(feed.on.kind, Measure::Kind::travel);
  EXPECT_EQ(feed.name, "feed");
  EXPECT_EQ(feed.line, turning.line + 9);
  EXPECT_EQ(feed.on.joint, 0);
  EXPECT_FALSE(feed.start.has_value());
  EXPECT_DOUBLE_EQ(feed.rate, 1.5 * inch);
  EXPECT_DOUBLE_EQ(feed.acceleration, -2 * inch);
  EXPECT_DOUBLE_EQ(feed.amplitude, 0.125 * inch);
  EXPECT_EQ(feed.frequency, 0.0);
  EXPECT_EQ(feed.phase, 0.0);
}

TEST(ReadScene, ReadsLoads) {
  const Scene scene = parse_scene(everything, "all.toml");
  ASSERT_EQ(scene.forces.size(), 2u);
  EXPECT_EQ(scene.forces[0].name, "force 1");
  EXPECT_EQ(scene.name_of(scene.forces[0].at), "crank.B");
  EXPECT_EQ(scene.forces[0].vector, (Vec2{30 * pound_force, -40 * pound_force}));
  EXPECT_EQ(scene.forces[0].follows, -1);
  EXPECT_EQ(scene.forces[1].name, "thrust");
  EXPECT_EQ(scene.forces[1].follows, 3);
  ASSERT_EQ(scene.torques.size(), 1u);
  EXPECT_EQ(scene.torques[0].name, "torque 1");
  EXPECT_EQ(scene.torques[0].body, 1);
  EXPECT_DOUBLE_EQ(scene.torques[0].value, -8 * pound_force * inch);
}

TEST(ReadScene, ReadsStops) {
  const Scene scene = parse_scene(everything, "all.toml");
  ASSERT_EQ(scene.stops.size(), 3u);
  EXPECT_EQ(scene.stops[0].on.kind, Measure::Kind::angle);
  EXPECT_EQ(scene.stops[0].name, "stop 1");
  EXPECT_EQ(scene.stops[0].on.body_a, 0);
  EXPECT_EQ(scene.stops[0].on.body_b, 1);
  EXPECT_DOUBLE_EQ(scene.stops[0].min, -10 * degree);
  EXPECT_DOUBLE_EQ(scene.stops[0].max, 200 * degree);
  EXPECT_EQ(scene.stops[1].on.kind, Measure::Kind::distance);
  EXPECT_EQ(scene.stops[1].name, "tether");
  EXPECT_EQ(scene.name_of(scene.stops[1].on.b), "block.D");
  EXPECT_EQ(scene.stops[1].min, -std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(scene.stops[1].max, 12 * inch);
  EXPECT_EQ(scene.stops[2].on.kind, Measure::Kind::travel);
  EXPECT_EQ(scene.stops[2].on.joint, 0);
  EXPECT_DOUBLE_EQ(scene.stops[2].min, -1 * inch);
  EXPECT_EQ(scene.stops[2].max, std::numeric_limits<double>::infinity());
}

TEST(ReadScene, ReadsStart) {
  const Start start = parse_scene(everything, "all.toml").start;
  ASSERT_EQ(start.angle.size(), 4u);
  EXPECT_DOUBLE_EQ(start.angle[1].value(), 30 * degree);
  EXPECT_FALSE(start.angle[2].has_value());
  ASSERT_EQ(start.travel.size(), 6u);
  EXPECT_DOUBLE_EQ(start.travel[0].value(), 2 * inch);
  EXPECT_FALSE(start.travel[1].has_value());
  EXPECT_DOUBLE_EQ(start.travel[2].value(), -1.5 * inch);
  ASSERT_EQ(start.position.size(), 4u);
  EXPECT_EQ(start.position[2].value(), (Vec2{10 * inch, 1 * inch}));
  EXPECT_FALSE(start.position[1].has_value());
}

TEST(ReadScene, IsInSiWithoutUnits) {
  const Scene scene = parse_scene("[body.a]\nmass = 1\ninertia = 0.5\npoints = { P = [1, 2] }", "s.toml");
  EXPECT_EQ(scene.units.length_name, "m");
  EXPECT_EQ(scene.units.angle_name, "rad");
  EXPECT_EQ(scene.gravity, Vec2{});
  EXPECT_EQ(scene.bodies[1].mass, 1.0);
  EXPECT_EQ(scene.bodies[1].inertia, 0.5);
  EXPECT_EQ(scene.local({1, 0}), (Vec2{1.0, 2.0}));
}

TEST(ReadScene, ReadsEveryUnit) {
  const auto units_of = [](const std::string& units) {
    return parse_scene("[units]\n" + units + "\n[body.a]", "s.toml").units;
  };
  EXPECT_EQ(units_of("length = 'm'").length, 1.0);
  EXPECT_EQ(units_of("length = 'mm'").length, 1e-3);
  EXPECT_EQ(units_of("length = 'in'").length, 0.0254);
  EXPECT_EQ(units_of("length = 'ft'").length, 0.3048);
  EXPECT_EQ(units_of("force = 'N'").force, 1.0);
  EXPECT_EQ(units_of("force = 'kN'").force, 1e3);
  EXPECT_EQ(units_of("force = 'lbf'").force, pound * 9.80665);
  EXPECT_EQ(units_of("mass = 'kg'").mass, 1.0);
  EXPECT_EQ(units_of("mass = 'g'").mass, 1e-3);
  EXPECT_EQ(units_of("mass = 'lb'").mass, pound);
  EXPECT_EQ(units_of("angle = 'rad'").angle, 1.0);
  EXPECT_EQ(units_of("angle = 'deg'").angle, degree);
}

TEST(ReadScene, NumbersDefaultNamesAroundThoseThatAreTaken) {
  const Scene scene = parse_scene(R"toml(
    [ground]
    points = { O = [0, 0] }
    [body.a]
    points = { P = [0, 0] }
    [[pin]]
    points = ["ground.O", "a.P"]
    [[pin]]
    points = ["ground.O", "a.P"]
    name = "ground.O-a.P (2)"
    [[bar]]
    points = ["ground.O", "a.P"]
    length = 1
    [[bar]]
    points = ["ground.O", "a.P"]
    length = 1
    [[force]]
    at = "a.P"
    vector = [1, 0]
    [[torque]]
    name = "force 1"
    on = "a"
    value = 1)toml",
                                  "s.toml");
  EXPECT_EQ(scene.joints[0].name, "ground.O-a.P");
  EXPECT_EQ(scene.joints[1].name, "ground.O-a.P (2)");
  EXPECT_EQ(scene.joints[2].name, "ground.O-a.P (3)");
  EXPECT_EQ(scene.joints[3].name, "ground.O-a.P (4)");
  EXPECT_EQ(scene.forces[0].name, "force 1 (2)");
  EXPECT_EQ(scene.torques[0].name, "force 1");
}

TEST(ReadScene, TakesABodyCalledPosition) {
  const Scene scene = parse_scene("[body.position]\n[start]\nposition = 3", "s.toml");
  EXPECT_EQ(scene.start.angle[1].value(), 3.0);
}

TEST(ReadScene, ReadsFilesAndNamesThem) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "poise_read_scene_test.toml";
  std::ofstream(file) << "[body.crank]\nmas = 3\n";
  try {
    read_scene(file);
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), file.string() +
                                ":2: body.crank.mas: expected one of the keys points, mass, center, inertia, section; "
                                "did you mean \"mass\"?");
  }
  std::ofstream(file) << everything;
  EXPECT_EQ(read_scene(file).file, file.string());
  std::filesystem::remove(file);
}

TEST(ReadScene, ReadsTheExampleOfItsDocumentation) {
  std::ifstream page(std::filesystem::path(POISE_SOURCE_DIR) / "docs" / "scene-files.md");
  const std::string text{std::istreambuf_iterator<char>(page), std::istreambuf_iterator<char>()};
  const std::string fence = "```toml\n";
  const std::size_t begin = text.find(fence);
  ASSERT_NE(begin, std::string::npos);
  const std::size_t end = text.find("```", begin + fence.size());
  const Scene scene = parse_scene(text.substr(begin + fence.size(), end - begin - fence.size()), "scene-files.md");
  EXPECT_EQ(scene.bodies.size(), 4u);
  EXPECT_EQ(scene.joints.size(), 4u);
  EXPECT_DOUBLE_EQ(test::law<LinearSpring>(scene, "spring").stiffness, 2500.0);
  EXPECT_EQ(scene.start.travel[3].value(), 0.3);
}

TEST(ReadScene, TakesDotsAndBracketsThatAreNotNested) {
  const std::string dots = repeated(".", 100), brackets = repeated("[", 100);
  const Scene scene = parse_scene("title = '" + dots + brackets + "' # " + dots + brackets + "\nsource = \"\\\"" +
                                      dots + "\"\n[body.\"a" + dots + "\"]\npoints.P = [0.5, 1.5] # " + brackets +
                                      "\n" + "[[force]]\nname = \"\"\"" + brackets + "\"\"\"\nat = \"a" + dots +
                                      ".P\"\nvector = [0.25, 0.5]\n",
                                  "s.toml");
  EXPECT_EQ(scene.title, dots + brackets);
  EXPECT_EQ(scene.source, "\"" + dots);
  EXPECT_EQ(scene.forces[0].name, brackets);
}

TEST(ReadScene, NamesAFileThatIsNoText) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "poise_no_text_test.toml";
  const auto message = [&](const std::string& text) -> std::string {
    std::ofstream(file, std::ios::binary) << text;
    try {
      read_scene(file);
      return "no error";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(message(std::string("[body.a]\n# \0", 12)),
            file.string() + ":2: expected a text, found a NUL byte; save the file as UTF-8");
  EXPECT_EQ(message(std::string(65 << 20U, ' ')),
            file.string() + ": expected at most 64 MiB of text, found more; check the path");
  std::filesystem::remove(file);
}

TEST(ReadScene, AnswersAVeryLongNameAtOnce) {
  const std::string longest(100'000, 'a');
  std::string points;
  for (int i = 0; i < 20; ++i) points += "P" + std::to_string(i) + " = [0, 0]\n";
  const std::string text = "[body.a.points]\n" + points + "[[force]]\nat = \"a." + longest + "\"\nvector = [1, 0]\n";
  try {
    parse_scene(text, "s.toml");
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    const std::string line = error.what();
    EXPECT_LE(line.size(), 1000U);
    EXPECT_TRUE(line.starts_with("s.toml:23: force 1.at: expected a point of \"a\", found \"a.aaa")) << line;
    EXPECT_TRUE(
        line.ends_with("aaa\"; known here: a.P0, a.P1, a.P2, a.P3, a.P4, a.P5, a.P6, a.P7, a.P8, a.P9, a.P10, "
                       "a.P11 and 8 more"))
        << line;
  }
}

TEST(ReadScene, NamesAFileThatCannotBeRead) {
  const std::filesystem::path directory = testing::TempDir();
  const std::filesystem::path missing = directory / "poise_no_such_scene.toml";
  const auto message = [](const std::filesystem::path& file) -> std::string {
    try {
      read_scene(file);
      return "no error";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(message(missing), missing.string() + ": cannot be read: No such file or directory; check the path");
  EXPECT_EQ(message(directory), directory.string() + ": cannot be read: Is a directory; check the path");
}

struct BadScene {
  const char* name;
  std::string text;
  std::string message;  ///< after "s.toml:"
};

void PrintTo(const BadScene& scene, std::ostream* out) { *out << scene.name; }

/// Lines 1 to 6: a ground with point O and two bodies; what is wrong follows from line 7.
const std::string two_bodies =
    "[ground]\n"
    "points = { O = [0, 0], S = [1, 0] }\n"
    "[body.crank]\n"
    "points = { O = [0, 0], B = [1, 0] }\n"
    "[body.rod]\n"
    "points = { B = [0, 0] }\n";

const std::string every_measure =
    "bodies (relative angle), points (distance, or component along an axis), slide (travel), x (of a point), y (of a "
    "point), rope (length over points and pulleys), sum (of the others)";

const std::string slide_ram = two_bodies + "[[slide]]\nname = 'ram'\npoints = ['ground.S', 'rod.B']\naxis = [1, 0]\n";

BadScene after(const char* name, const std::string& text, const std::string& message) {
  return {name, two_bodies + text, message};
}

BadScene after_slide(const char* name, const std::string& text, const std::string& message) {
  return {name, slide_ram + text, message};
}

class ReadBadScene : public testing::TestWithParam<BadScene> {};

TEST_P(ReadBadScene, ReportsWhatWasExpectedAndWhere) {
  try {
    parse_scene(GetParam().text, "s.toml");
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), "s.toml:" + GetParam().message);
  }
}

std::string name_of_case(const testing::TestParamInfo<BadScene>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(
    Document, ReadBadScene,
    testing::Values(
        BadScene{"Syntax", "title = \"a\"\n[units\n",
                 "2: TOML syntax: Error while parsing table header: expected ']', saw '\\n'"},
        BadScene{"RepeatedKey", "title = 'a'\ntitle = 'b'\n",
                 "2: TOML syntax: Error while parsing key-value pair: cannot redefine existing string 'title'"},
        BadScene{"Empty", "", "1: body: expected at least one body; add [body.NAME]"},
        BadScene{"NoBody", "title = 'a'\n[body]\n", "1: body: expected at least one body; add [body.NAME]"},
        BadScene{
            "UnknownTable", "title = 'a'\n[bdoy.crank]\n",
            "2: bdoy: expected one of the keys title, source, gravity, units, numbers, part, ground, body, pin, slide, "
            "pin_in_slot, weld, bar, spring, torsion_spring, cubic_spring, constant_force, damper, torsion_damper, "
            "friction, bump_stop, motor, controller, gear, belt, rack, cam, geneva, coupling, rope, chain, "
            "circular_slot, "
            "curved_slot, "
            "rolling, rolling_on_circle, rolling_profile, rolling_profile_on_circle, curve_contact, "
            "loose_pin, loose_slot, contact, drive, force, distributed_load, "
            "torque, "
            "stop, blade, start, outputs, frame; "
            "did you mean \"body\"?"},
        BadScene{"KeyWithLineBreak", "\"bo\\ndy\" = 1\n",
                 "1: bo dy: expected one of the keys title, source, gravity, units, numbers, part, ground, body, pin, "
                 "slide, "
                 "pin_in_slot, weld, bar, spring, torsion_spring, cubic_spring, constant_force, damper, "
                 "torsion_damper, friction, bump_stop, motor, controller, gear, belt, rack, cam, geneva, coupling, "
                 "rope, chain, "
                 "circular_slot, "
                 "curved_slot, rolling, rolling_on_circle, rolling_profile, rolling_profile_on_circle, curve_contact, "
                 "loose_pin, loose_slot, contact, drive, force, "
                 "distributed_load, torque, stop, blade, start, outputs, frame; did you mean \"body\"?"},
        BadScene{"KeyOfManyParts", "title = 'a'\nx" + repeated(".a", 40'000) + " = 1\n",
                 "2: TOML syntax: expected a key of at most 16 parts; put a name that holds dots in quotes"},
        BadScene{"TableOfManyParts", "title = \"\"\"\n.\n\"\"\"\"\"\n[x" + repeated(" . 'a'", 40'000) + "]\n",
                 "4: TOML syntax: expected a key of at most 16 parts; put a name that holds dots in quotes"},
        BadScene{"ListsInLists", "x = " + repeated("[", 40'000) + repeated("]", 40'000) + "\n",
                 "1: TOML syntax: expected at most 16 brackets inside each other; close some"},
        BadScene{"TablesInTables", "x = " + repeated("{ a = ", 17) + "1" + repeated(" }", 17) + "\n",
                 "1: TOML syntax: expected at most 16 brackets inside each other; close some"},
        BadScene{"Experiment", "title = 'a'\nscene = 'lift.toml'\n[[run]]\n",
                 "2: scene: expected a scene, found a file that names one: an experiment or a design; give it to poise "
                 "identify or design, or give the scene that it names"},
        BadScene{"TitleNotText", "title = 3\n", "1: title: expected a string, found a number"},
        BadScene{"SourceNotText", "source = 2024-01-01\n", "1: source: expected a string, found a date or time"},
        BadScene{"GravityNotVector", "gravity = 9.81\n", "1: gravity: expected two numbers [X, Y], found a number"},
        BadScene{"GravityTooLong", "gravity = [0, 0, 9]\n",
                 "1: gravity: expected two numbers [X, Y], found a list of 3"},
        BadScene{"GravityNotFinite", "gravity = [0,\n -inf]\n", "2: gravity: expected a finite number, found -inf"},
        BadScene{"GravityNotNumber", "gravity = [0, true]\n", "1: gravity: expected a number, found a boolean"},
        BadScene{"UnitUnknown", "[units]\nlength = 'inch'\n",
                 "2: units.length: expected one of m, mm, in, ft, found \"inch\"; did you mean \"in\"?"},
        BadScene{"UnitKeyUnknown", "[units]\nlenght = 'in'\n",
                 "2: units.lenght: expected one of the keys length, force, mass, angle; did you mean \"length\"?"},
        BadScene{"UnitsNotTable", "units = 'SI'\n", "1: units: expected a table, found a string"}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    Bodies, ReadBadScene,
    testing::Values(
        BadScene{"GroundKey", "[ground]\nmass = 1\n[body.a]\n", "2: ground.mass: expected only the key points"},
        BadScene{"BodyCalledGround", "[body.a]\n[body.ground]\n",
                 "2: body.ground: expected another name, this is the fixed frame; give its points in [ground]"},
        BadScene{"BodyList", "[[body]]\nmass = 1\n", "1: body: expected a table, found a list"},
        BadScene{"BodyNotTable", "body.crank = 3\n", "1: body.crank: expected a table, found a number"},
        BadScene{"BodyKey", "[body.a]\ncentre = [0, 0]\n",
                 "2: body.a.centre: expected one of the keys points, mass, center, inertia, section; did you mean "
                 "\"center\"?"},
        BadScene{"BodyWithoutName", "[body.'']\n", "1: body.: expected a name that is not empty"},
        BadScene{"BodyWithControlCharacter", "[body.\"a\\tb\"]\n",
                 "1: body.a b: expected a name without control characters"},
        BadScene{"PointWithDot", "[body.a]\npoints = { 'P.1' = [0, 0] }\n",
                 "2: body.a.points.P.1: expected a name without dots"},
        BadScene{"PointWithoutName", "[body.a]\npoints = { '' = [0, 0] }\n",
                 "2: body.a.points.: expected a name that is not empty"},
        BadScene{"PointsNotTable", "[body.a]\npoints = [[0, 0]]\n", "2: body.a.points: expected a table, found a list"},
        BadScene{"PointNotVector", "[body.a]\npoints.P = 'here'\n",
                 "2: body.a.points.P: expected two numbers [X, Y], found a string"},
        BadScene{"PointNotFinite", "[body.a]\npoints.P = [nan, 0]\n",
                 "2: body.a.points.P: expected a finite number, found nan"},
        BadScene{"NegativeMass", "[body.a]\nmass = -0.5\n",
                 "2: body.a.mass: expected a finite number >= 0, found -0.5"},
        BadScene{"InfiniteMass", "[body.a]\nmass = inf\n", "2: body.a.mass: expected a finite number >= 0, found inf"},
        BadScene{
            "MassInWords", "[body.a]\nmass = 'heavy'\n",
            "2: body.a.mass: expected a name of [numbers], pi or a function, found \"heavy\" in \"heavy\"; known here: "
            "exp, tan, atan, abs, atan2, hypot, max, pi, sqrt, log, sin, cos and 3 more"},
        BadScene{"NegativeInertia", "[body.a]\n\ninertia = -1\n",
                 "3: body.a.inertia: expected a finite number >= 0, found -1"},
        BadScene{"OverflowByUnit",
                 "[units]\nforce = 'kN'\n[body.a]\npoints.P = [0, 0]\n[[force]]\nat = 'a.P'\n"
                 "vector = [1e306, 0]\n",
                 "7: force 1.vector: expected a finite number of at most 1e50 in SI units, found 1e+306"},
        BadScene{"TooLarge", "[body.a]\npoints.P = [0, -1.01e50]\n",
                 "2: body.a.points.P: expected a finite number of at most 1e50 in SI units, found -1.01e+50"},
        BadScene{"LongName", "[body.a]\npoints." + std::string(1001, 'P') + " = [0, 0]\n",
                 "2: body.a.points." + std::string(466, 'P') + " ... " + std::string(449, 'P') +
                     ": expected a name of at most 1000 bytes, found 1001"},
        BadScene{"TooSmall", "[body.a]\npoints.P = [0, -1e-320]\n",
                 "2: body.a.points.P: expected a finite number of at least 1e-50 in SI units, or 0, found -1e-320"},
        BadScene{"TooLargeMass", "[body.a]\nmass = 1e200\n",
                 "2: body.a.mass: expected a finite number >= 0 of at most 1e50 in SI units, found 1e+200"}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    Joints, ReadBadScene,
    testing::Values(
        after("SingleTable", "[pin]\npoints = ['ground.O', 'crank.O']\n",
              "7: pin: expected tables [[pin]], found a table"),
        BadScene{"ListOfNumbers", "pin = [1]\n[body.a]\n", "1: pin: expected tables [[pin]], found a number"},
        after("PointsMissing", "[[pin]]\nname = 'hinge'\n",
              "7: pin \"hinge\": expected the key points; add points = [\"...\", \"...\"]"),
        after("OnePoint", "[[pin]]\npoints = ['ground.O']\n",
              "8: pin 1.points: expected two names [\"...\", \"...\"], found a list of 1"),
        after("PointsNotList", "[[pin]]\npoints = 'ground.O'\n",
              "8: pin 1.points: expected two names [\"...\", \"...\"], found a string"),
        after("PointNotText", "[[pin]]\npoints = ['ground.O', 3]\n",
              "8: pin 1.points: expected a string, found a number"),
        after("PointOfUnknownBody", "[[pin]]\npoints = ['ground.O',\n 'carnk.O']\n",
              "9: pin 1.points: expected a point \"BODY.POINT\", found \"carnk.O\"; did you mean \"crank.O\"?"),
        after("PointWithoutBody", "[[pin]]\npoints = ['O', 'crank.O']\n",
              "8: pin 1.points: expected a point \"BODY.POINT\", found \"O\"; known here: crank.B, crank.O, ground.O, "
              "ground.S, rod.B"),
        after("UnknownPoint", "[[pin]]\npoints = ['ground.O', 'crank.A']\n",
              "8: pin 1.points: expected a point of \"crank\", found \"crank.A\"; did you mean \"crank.O\"?"),
        after("BodyWithoutPoints", "[body.bare]\n[[pin]]\npoints = ['ground.O', 'bare.P']\n",
              "9: pin 1.points: expected a point of \"bare\", which has none, found \"bare.P\"; "
              "add points = { NAME = [X, Y] } to it"),
        after("SameBody", "[[pin]]\npoints = ['crank.O', 'crank.B']\n",
              "8: pin 1.points: expected points of two different bodies, found two of \"crank\""),
        after("PinKey", "[[pin]]\npoints = ['ground.O', 'crank.O']\naxis = [1, 0]\n",
              "9: pin 1.axis: expected one of the keys name, points, friction"),
        after("SlotKey", "[[pin_in_slot]]\npoints = ['ground.O', 'crank.O']\naxis = [1, 0]\nangle = 3\n",
              "10: pin_in_slot 1.angle: expected one of the keys name, points, axis, friction"),
        after("WeldKey", "[[weld]]\npoints = ['ground.O', 'crank.O']\nangel = 3\n",
              "9: weld 1.angel: expected one of the keys name, points, angle; did you mean \"angle\"?"),
        after("SlideKey", "[[slide]]\npoints = ['ground.O', 'crank.O']\naxes = [1, 0]\n",
              "9: slide 1.axes: expected one of the keys name, points, axis, angle, friction; did you mean \"axis\"?"),
        after("AxisMissing", "[[slide]]\npoints = ['ground.O', 'crank.O']\n",
              "7: slide 1: expected the key axis; add axis = [X, Y]"),
        after("SlotAxisMissing", "[[pin_in_slot]]\npoints = ['ground.O', 'crank.O']\n",
              "7: pin_in_slot 1: expected the key axis; add axis = [X, Y]"),
        after("AxisZero", "[[slide]]\npoints = ['ground.O', 'crank.O']\naxis = [0, 0.0]\n",
              "9: slide 1.axis: expected a direction, found [0, 0]; give for example [1, 0]"),
        after("LengthMissing", "[[bar]]\npoints = ['ground.O', 'crank.O']\n",
              "7: bar 1: expected the key length; add length = NUMBER"),
        after("LengthZero", "[[bar]]\nlength = 0\npoints = ['ground.O', 'crank.O']\n",
              "8: bar 1.length: expected a finite number > 0, found 0"),
        after("BarKey", "[[bar]]\npoints = ['ground.O', 'crank.O']\nlen = 1\n",
              "9: bar 1.len: expected one of the keys name, points, length; did you mean \"length\"?"),
        after("RepeatedName",
              "[[pin]]\nname = 'hinge'\npoints = ['ground.O', 'crank.O']\n[[bar]]\nname = 'hinge'\nlength = 1\n"
              "points = ['ground.O', 'rod.B']\n",
              "11: bar \"hinge\".name: expected a name of its own; \"hinge\" is taken in line 8"),
        after("NameOfABody", "[[pin]]\nname = 'rod'\npoints = ['ground.O', 'crank.O']\n",
              "8: pin \"rod\".name: expected a name of its own; \"rod\" is taken in line 5"),
        BadScene{"NameOfTheGround",
                 "[body.a]\npoints.P = [0, 0]\n[body.b]\npoints.P = [0, 0]\n[[pin]]\nname = 'ground'\n"
                 "points = ['a.P', 'b.P']\n",
                 "6: pin \"ground\".name: expected a name of its own; \"ground\" is taken"},
        after("EmptyName", "[[pin]]\nname = ''\npoints = ['ground.O', 'crank.O']\n",
              "8: pin \"\".name: expected a name that is not empty"),
        after("NameNotText", "[[pin]]\nname = 3\npoints = ['ground.O', 'crank.O']\n",
              "8: pin 1.name: expected a string, found a number")),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    SpringsAndLoads, ReadBadScene,
    testing::Values(
        after("SpringKey", "[[spring]]\nstifness = 1\n",
              "8: spring 1.stifness: expected one of the keys name, bodies, points, slide, x, y, rope, sum, stiffness, "
              "free_length, time, acts; "
              "did you mean \"stiffness\"?"),
        after("SpringStiffnessMissing", "[[spring]]\npoints = ['ground.O', 'rod.B']\nfree_length = 1\n",
              "7: spring 1: expected the key stiffness; add stiffness = NUMBER"),
        after("SpringFreeLengthMissing", "[[spring]]\npoints = ['ground.O', 'rod.B']\nstiffness = 1\n",
              "7: spring 1: expected the key free_length; add free_length = NUMBER"),
        after("SpringStiffnessNegative",
              "[[spring]]\npoints = ['ground.O', 'rod.B']\nstiffness = -1\nfree_length = 1\n",
              "9: spring 1.stiffness: expected a finite number >= 0, found -1"),
        after("SpringFreeLengthNegative",
              "[[spring]]\npoints = ['ground.O', 'rod.B']\nstiffness = 1\nfree_length = -1\n",
              "10: spring 1.free_length: expected a finite number >= 0, found -1"),
        after("SpringActs",
              "[[spring]]\npoints = ['ground.O', 'rod.B']\nstiffness = 1\nfree_length = 1\nacts = 'pull'\n",
              "11: spring 1.acts: expected one of both, tension, compression, found \"pull\""),
        after("SpringInOneBody", "[[spring]]\npoints = ['ground.O', 'ground.S']\nstiffness = 1\nfree_length = 1\n",
              "8: spring 1.points: expected points of two different bodies, found two of \"ground\""),
        after("SpringNameRepeated",
              "[[spring]]\nname = 'k'\npoints = ['ground.O', 'rod.B']\nstiffness = 1\nfree_length = 1\n"
              "[[spring]]\nname = 'k'\n",
              "13: spring \"k\".name: expected a name of its own; \"k\" is taken in line 8"),
        after("TorsionKey", "[[torsion_spring]]\npoints = ['ground.O', 'rod.B']\n",
              "8: torsion_spring 1.points: expected one of the keys name, bodies, stiffness, free_angle, time, acts"),
        after("TorsionBody", "[[torsion_spring]]\nbodies = ['gruond', 'rod']\nstiffness = 1\n",
              "8: torsion_spring 1.bodies: expected the name of a body, found \"gruond\"; did you mean \"ground\"?"),
        after("TorsionOneBody", "[[torsion_spring]]\nbodies = ['rod', 'rod']\nstiffness = 1\n",
              "8: torsion_spring 1.bodies: expected two different bodies, found \"rod\" twice"),
        after("TorsionStiffnessNegative", "[[torsion_spring]]\nbodies = ['ground', 'rod']\nstiffness = -2\n",
              "9: torsion_spring 1.stiffness: expected a finite number >= 0, found -2"),
        after("TorsionStiffnessMissing", "[[torsion_spring]]\nbodies = ['ground', 'rod']\n",
              "7: torsion_spring 1: expected the key stiffness; add stiffness = NUMBER"),
        after("ForceKey", "[[force]]\non = 'rod.B'\n",
              "8: force 1.on: expected one of the keys name, at, vector, direction, size, follows, time"),
        after("ForceAtMissing", "[[force]]\nvector = [0, 1]\n", "7: force 1: expected the key at; add at = \"...\""),
        after("ForceVectorMissing", "[[force]]\nat = 'rod.B'\n",
              "7: force 1: expected the key vector; add vector = [X, Y]"),
        after("ForceAtUnknownPoint", "[[force]]\nat = 'rod.C'\nvector = [0, 1]\n",
              "8: force 1.at: expected a point of \"rod\", found \"rod.C\"; did you mean \"rod.B\"?"),
        after("ForceOnGround", "[[force]]\nat = 'ground.O'\nvector = [0, 1]\n",
              "8: force 1.at: expected a point of a body that can move, found one of the ground"),
        after("ForceFollowsUnknown", "[[force]]\nat = 'rod.B'\nvector = [0, 1]\nfollows = 'rd'\n",
              "10: force 1.follows: expected the name of a body other than ground, found \"rd\"; "
              "did you mean \"rod\"?"),
        after("TorqueKey", "[[torque]]\nwhere = 'rod'\n",
              "8: torque 1.where: expected one of the keys name, on, value, time"),
        after(
            "TorqueOnGround", "[[torque]]\non = 'ground'\nvalue = 1\n",
            "8: torque 1.on: expected the name of a body other than ground, found \"ground\"; known here: crank, rod"),
        after("TorqueValueMissing", "[[torque]]\non = 'rod'\n",
              "7: torque 1: expected the key value; add value = NUMBER"),
        after("LoadNameRepeated",
              "[[torque]]\nname = 'P'\non = 'rod'\nvalue = 1\n[[force]]\nname = 'P'\nat = 'rod.B'\nvector = [0, 1]\n",
              "8: torque \"P\".name: expected a name of its own; \"P\" is taken in line 12")),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    DampersAndDrives, ReadBadScene,
    testing::Values(
        after("DamperKey", "[[damper]]\nstiffness = 1\n",
              "8: damper 1.stiffness: expected one of the keys name, bodies, points, slide, x, y, rope, sum, "
              "coefficient, time, acts"),
        after("DamperCoefficientMissing", "[[damper]]\nname = 'oil'\npoints = ['ground.O', 'rod.B']\n",
              "7: damper \"oil\": expected the key coefficient; add coefficient = NUMBER"),
        after("DamperCoefficientNegative", "[[damper]]\npoints = ['ground.O', 'rod.B']\ncoefficient = -1\n",
              "9: damper 1.coefficient: expected a finite number >= 0, found -1"),
        after("DamperPointsMissing", "[[damper]]\ncoefficient = 1\n",
              "7: damper 1: expected one of the keys " + every_measure),
        after("DamperInOneBody", "[[damper]]\npoints = ['crank.O', 'crank.B']\ncoefficient = 1\n",
              "8: damper 1.points: expected points of two different bodies, found two of \"crank\""),
        after("DamperUnknownPoint", "[[damper]]\npoints = ['ground.O', 'rod.C']\ncoefficient = 1\n",
              "8: damper 1.points: expected a point of \"rod\", found \"rod.C\"; did you mean \"rod.B\"?"),
        after("DamperNameRepeated",
              "[[damper]]\nname = 'oil'\npoints = ['ground.O', 'rod.B']\ncoefficient = 1\n"
              "[[damper]]\nname = 'oil'\n",
              "12: damper \"oil\".name: expected a name of its own; \"oil\" is taken in line 8"),
        after("TorsionDamperKey", "[[torsion_damper]]\npoints = ['ground.O', 'rod.B']\n",
              "8: torsion_damper 1.points: expected one of the keys name, bodies, coefficient, time, acts"),
        after("TorsionDamperCoefficientMissing", "[[torsion_damper]]\nbodies = ['ground', 'rod']\n",
              "7: torsion_damper 1: expected the key coefficient; add coefficient = NUMBER"),
        after("TorsionDamperCoefficientNegative", "[[torsion_damper]]\nbodies = ['ground', 'rod']\ncoefficient = -1\n",
              "9: torsion_damper 1.coefficient: expected a finite number >= 0, found -1"),
        after("TorsionDamperOneBody", "[[torsion_damper]]\nbodies = ['rod', 'rod']\ncoefficient = 1\n",
              "8: torsion_damper 1.bodies: expected two different bodies, found \"rod\" twice"),
        after("TorsionDamperNameRepeated",
              "[[torsion_damper]]\nname = 'oil'\nbodies = ['ground', 'rod']\ncoefficient = 1\n"
              "[[torsion_damper]]\nname = 'oil'\n",
              "12: torsion_damper \"oil\".name: expected a name of its own; \"oil\" is taken in line 8"),
        after(
            "FrictionKey", "[[friction]]\nvalue = 1\n",
            "8: friction 1.value: expected one of the keys name, bodies, points, slide, x, y, rope, sum, force, width, "
            "static, stribeck_rate, stribeck_exponent, stribeck"),
        after("FrictionTorqueMissing", "[[friction]]\nbodies = ['ground', 'rod']\n",
              "7: friction 1: expected the key torque; add torque = NUMBER"),
        after("FrictionTorqueNegative", "[[friction]]\nbodies = ['ground', 'rod']\ntorque = -1\n",
              "9: friction 1.torque: expected a finite number >= 0, found -1"),
        after("FrictionWidthNegative", "[[friction]]\nbodies = ['ground', 'rod']\ntorque = 1\nwidth = -1\n",
              "10: friction 1.width: expected a finite number >= 0, found -1"),
        after("FrictionStaticBelow", "[[friction]]\nx = 'rod.B'\nforce = 2\nstatic = 1\nwidth = 0\n",
              "10: friction 1.static: expected a static force of at least that of sliding; exchange them, or leave "
              "static out where both are equal"),
        after(
            "FrictionDropsWithWidth", "[[friction]]\nx = 'rod.B'\nforce = 1\nstatic = 2\n",
            "10: friction 1.static: expected width = 0 beside it, or stribeck_rate: a static force that drops at once "
            "acts where friction sticks"),
        after("FrictionStaticMissing", "[[friction]]\nx = 'rod.B'\nforce = 1\nstribeck_rate = 2\n",
              "10: friction 1.stribeck_rate: expected the key static beside it, the force at rest; add it"),
        after("FrictionStribeckRateMissing",
              "[[friction]]\nx = 'rod.B'\nforce = 1\nstatic = 2\nstribeck = 'hyperbolic'\n",
              "11: friction 1.stribeck: expected the key stribeck_rate beside it, over which friction falls; add it"),
        after("FrictionStribeckRateZero", "[[friction]]\nx = 'rod.B'\nforce = 1\nstatic = 2\nstribeck_rate = 0\n",
              "11: friction 1.stribeck_rate: expected a finite number > 0, found 0"),
        after("FrictionExponentBelowOne",
              "[[friction]]\nx = 'rod.B'\nforce = 1\nstatic = 2\nstribeck_rate = 1\nstribeck_exponent = 0.5\n",
              "12: friction 1.stribeck_exponent: expected an exponent of at least 1; below, friction falls at once at "
              "rest"),
        after("FrictionExponentOfHyperbola",
              "[[friction]]\nx = 'rod.B'\nforce = 1\nstatic = 2\nstribeck_rate = 1\nstribeck_exponent = 2\n"
              "stribeck = 'hyperbolic'\n",
              "12: friction 1.stribeck_exponent: expected an exponent with stribeck = \"exponential\" alone; leave it "
              "out"),
        after("DragNegative", "[[damper]]\nx = 'rod.B'\ndrag = -1\n",
              "9: damper 1.drag: expected a finite number >= 0, found -1"),
        after("DragAndCurve", "[[damper]]\nx = 'rod.B'\ndrag = 1\nforce.curve = [[1, 1], [2, 2]]\n",
              "7: damper 1: expected one of the keys drag and force, found both; leave one out"),
        after("DamperActs", "[[damper]]\nx = 'rod.B'\ncoefficient = 1\nacts = 'out'\n",
              "10: damper 1.acts: expected one of both, tension, compression, found \"out\""),
        after(
            "DamperCurveWithZero", "[[damper]]\nx = 'rod.B'\nforce.curve = [[0, 0], [2, 2]]\n",
            "9: damper 1.force.curve: expected rates other than 0, where a damper has no force; leave that point out"),
        after("DamperCurveDrives", "[[damper]]\nx = 'rod.B'\nforce.curve = [[-1, 1], [2, 2]]\n",
              "9: damper 1.force.curve: expected a force with the sign of its rate, for a damper resists; change its "
              "sign"),
        after("DamperCurveFalls", "[[damper]]\nx = 'rod.B'\nforce.curve = [[1, 3], [2, 2]]\n",
              "9: damper 1.force.curve: expected a curve that does not fall at its ends, beyond which it goes on along "
              "its tangents; add a point"),
        after("YieldingStopWithoutLimit", "[[stop]]\nx = 'rod.B'\nstiffness = 1\n",
              "7: stop 1: expected the key min, max or both; add max = NUMBER"),
        after("YieldingStopSoft", "[[stop]]\nx = 'rod.B'\nmin = 1\nstiffness = -1\n",
              "10: stop 1.stiffness: expected a finite number >= 0, found -1"),
        after("YieldingStopDrives", "[[stop]]\nx = 'rod.B'\nmin = 1\nstiffness = 1\ndamping = -1\n",
              "11: stop 1.damping: expected a finite number >= 0, found -1"),
        after("YieldingStopExponent", "[[stop]]\nx = 'rod.B'\nmin = 1\nstiffness = 1\nexponent = 0.5\n",
              "11: stop 1.exponent: expected an exponent of at least 1; 1.5 is that of round bodies"),
        after("YieldingStopLimits", "[[stop]]\nx = 'rod.B'\nmin = 2\nmax = 1\nstiffness = 1\n",
              "10: stop 1.max: expected min <= max; set the other limit first"),
        after("RigidStopDamped", "[[stop]]\nx = 'rod.B'\nmin = 2\ndamping = 1\n",
              "10: stop 1.damping: expected the key stiffness beside it, of a stop that yields; add it"),
        after("StrutEndStroke",
              "[[spring]]\npoints = ['ground.O', 'rod.B']\ngas = { preload = 1, length = 2, stroke = 1, ratio = 1.2, "
              "end_damping = 1 }\n",
              "9: spring 1.gas.end_damping: expected the key end_stroke beside it; add it"),
        after("StrutEndStrokeLong",
              "[[spring]]\npoints = ['ground.O', 'rod.B']\ngas = { preload = 1, length = 2, stroke = 1, ratio = 1.2, "
              "end_damping = 1, end_stroke = 1.5 }\n",
              "9: spring 1.gas.end_stroke: expected at most the stroke, of which it is the last part; make it shorter"),
        after("StrutDrives",
              "[[spring]]\npoints = ['ground.O', 'rod.B']\ngas = { preload = 1, length = 2, stroke = 1, ratio = 1.2, "
              "damping = -1 }\n",
              "9: spring 1.gas.damping: expected a finite number >= 0, found -1"),
        after("FrictionUnknownBody", "[[friction]]\nbodies = ['gound', 'rod']\ntorque = 1\n",
              "8: friction 1.bodies: expected the name of a body, found \"gound\"; did you mean \"ground\"?"),
        after("FrictionNameRepeated",
              "[[friction]]\nname = 'dry'\nbodies = ['ground', 'rod']\ntorque = 1\n[[friction]]\nname = 'dry'\n",
              "12: friction \"dry\".name: expected a name of its own; \"dry\" is taken in line 8"),
        after("DriveKey", "[[drive]]\nspeed = 1\n",
              "8: drive 1.speed: expected one of the keys name, bodies, points, slide, x, y, rope, sum, start, rate, "
              "acceleration, amplitude, frequency, phase, time"),
        after("DriveOfNothing", "[[drive]]\nrate = 1\n", "7: drive 1: expected one of the keys " + every_measure),
        after_slide("DriveOfTwoThings", "[[drive]]\nbodies = ['ground', 'rod']\nslide = 'ram'\n",
                    "11: drive 1: expected one of the keys " + every_measure),
        after_slide("DriveSlideUnknown", "[[drive]]\nslide = 'rma'\n",
                    "12: drive 1.slide: expected the name of a slide or pin_in_slot, found \"rma\"; "
                    "did you mean \"ram\"?"),
        after("DriveOneBody", "[[drive]]\nbodies = ['rod', 'rod']\n",
              "8: drive 1.bodies: expected two different bodies, found \"rod\" twice"),
        after("DriveOfALengthBelowZero", "[[drive]]\npoints = ['ground.O', 'rod.B']\nstart = -1\n",
              "9: drive 1.start: expected a finite number >= 0, found -1"),
        after("DriveRateNotFinite", "[[drive]]\nbodies = ['ground', 'rod']\nrate = inf\n",
              "9: drive 1.rate: expected a finite number, found inf"),
        after("DriveFrequencyNegative", "[[drive]]\nbodies = ['ground', 'rod']\nfrequency = -1\n",
              "9: drive 1.frequency: expected a finite number >= 0, found -1"),
        after("DriveStartNotNumber", "[[drive]]\nbodies = ['ground', 'rod']\nstart = [1]\n",
              "9: drive 1.start: expected a number, found a list"),
        after("DriveNameRepeated",
              "[[drive]]\nname = 'motor'\nbodies = ['ground', 'rod']\n[[drive]]\nname = 'motor'\n"
              "bodies = ['crank', 'rod']\n",
              "11: drive \"motor\".name: expected a name of its own; \"motor\" is taken in line 8")),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    Measures, ReadBadScene,
    testing::Values(
        after("SpringOfNothing", "[[spring]]\nstiffness = 1\nfree_length = 1\n",
              "7: spring 1: expected one of the keys " + every_measure),
        after("SpringOfTwoThings", "[[spring]]\nbodies = ['ground', 'rod']\nx = 'rod.B'\nstiffness = 1\n",
              "7: spring 1: expected one of the keys " + every_measure),
        after("SpringOfAnAngleKey", "[[spring]]\nbodies = ['ground', 'rod']\nstiffness = 1\nfree_length = 1\n",
              "10: spring 1.free_length: expected one of the keys name, bodies, stiffness, free_angle, time, acts"),
        after_slide(
            "SpringOfASlideKey", "[[spring]]\nslide = 'ram'\nstiffness = 1\nfree_angle = 1\n",
            "14: spring 1.free_angle: expected one of the keys name, slide, stiffness, free_length, time, acts"),
        after_slide("SpringOfASlideFreeLengthMissing", "[[spring]]\nslide = 'ram'\nstiffness = 1\n",
                    "11: spring 1: expected the key free_length; add free_length = NUMBER"),
        after_slide("SpringSlideUnknown", "[[spring]]\nslide = 'rma'\nstiffness = 1\nfree_length = 1\n",
                    "12: spring 1.slide: expected the name of a slide or pin_in_slot, found \"rma\"; "
                    "did you mean \"ram\"?"),
        after("SpringXUnknown", "[[spring]]\nx = 'rod.C'\nstiffness = 1\nfree_length = 1\n",
              "8: spring 1.x: expected a point of \"rod\", found \"rod.C\"; did you mean \"rod.B\"?"),
        after_slide("FrictionOfASlideKey", "[[friction]]\nslide = 'ram'\ntorque = 1\n",
                    "13: friction 1.torque: expected one of the keys name, slide, force, width, static, "
                    "stribeck_rate, stribeck_exponent, stribeck"),
        after_slide("FrictionForceMissing", "[[friction]]\nslide = 'ram'\n",
                    "11: friction 1: expected the key force; add force = NUMBER"),
        after("ConstantForceMissing", "[[constant_force]]\nx = 'rod.B'\n",
              "7: constant_force 1: expected the key force; add force = NUMBER"),
        after("ConstantForceNotFinite", "[[constant_force]]\nbodies = ['ground', 'rod']\ntorque = inf\n",
              "9: constant_force 1.torque: expected a finite number, found inf"),
        after("SumEmpty", "[[spring]]\nsum = []\nstiffness = 1\nfree_length = 1\n",
              "8: spring 1.sum: expected one term or more, for example { factor = NUMBER, slide = \"...\" }"),
        after("SumOfAnglesAndLengths",
              "[[spring]]\nsum = [{ factor = 1, x = 'rod.B' },\n{ factor = 1, bodies = ['ground', 'rod'] }]\n"
              "stiffness = 1\nfree_length = 1\n",
              "9: spring 1.sum 2: expected terms that are all angles (bodies) or all lengths (points, slide, x, y, "
              "rope); a [[coupling]] may mix them"),
        after("SumFactorMissing", "[[spring]]\nsum = [{ x = 'rod.B' }]\nstiffness = 1\nfree_length = 1\n",
              "8: spring 1.sum 1: expected the key factor; add factor = NUMBER"),
        after("SumTermOfNothing", "[[spring]]\nsum = [{ factor = 1 }]\nstiffness = 1\nfree_length = 1\n",
              "8: spring 1.sum 1: expected one of the keys bodies (relative angle), points (distance, or component "
              "along an axis), slide (travel), "
              "x (of a point), y (of a point), rope (length over points and pulleys)"),
        after("DriveOfAPoint", "[[drive]]\nx = 'rod.C'\n",
              "8: drive 1.x: expected a point of \"rod\", found \"rod.C\"; did you mean \"rod.B\"?"),
        after("ForceInTwoWays", "[[force]]\nat = 'rod.B'\nvector = [0, 1]\ndirection = [0, 1]\nsize = 0\n",
              "9: force 1.vector: expected vector, or direction and size, found both; leave one out"),
        after("ForceWithoutDirection", "[[force]]\nat = 'rod.B'\ndirection = [0, 0]\nsize = 0\n",
              "9: force 1.direction: expected a direction, found [0, 0]; give for example [0, 1]"),
        after("ForceWithoutSize", "[[force]]\nat = 'rod.B'\ndirection = [0, 1]\n",
              "7: force 1: expected the key size; add size = NUMBER")),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    StopsAndStart, ReadBadScene,
    testing::Values(
        after("StopKey", "[[stop]]\nbody = ['ground', 'rod']\n",
              "8: stop 1.body: expected one of the keys name, bodies, points, slide, x, y, rope, sum, min, max, "
              "restitution, law, friction"),
        after("StopOfNothing", "[[stop]]\nmin = 1\n", "7: stop 1: expected one of the keys " + every_measure),
        after("StopOfTwoThings", "[[stop]]\nbodies = ['ground', 'rod']\npoints = ['ground.O', 'rod.B']\nmin = 1\n",
              "7: stop 1: expected one of the keys " + every_measure),
        after("StopWithoutLimit", "[[stop]]\nbodies = ['ground', 'rod']\n",
              "7: stop 1: expected the key min, max or both; add max = NUMBER"),
        after("StopLimitsExchanged", "[[stop]]\nbodies = ['ground', 'rod']\nmin = 2\nmax = 1\n",
              "10: stop 1.max: expected max >= min; exchange them"),
        after("StopLimitNotFinite", "[[stop]]\nbodies = ['ground', 'rod']\nmin = -inf\nmax = 1\n",
              "9: stop 1.min: expected a finite number, found -inf"),
        after("StopDistanceNegative", "[[stop]]\npoints = ['ground.O', 'rod.B']\nmax = -1\n",
              "9: stop 1.max: expected a finite number >= 0, found -1"),
        after("StopOneBody", "[[stop]]\nbodies = ['rod', 'rod']\nmin = 0\n",
              "8: stop 1.bodies: expected two different bodies, found \"rod\" twice"),
        after_slide("StopSlideUnknown", "[[stop]]\nslide = 'rma'\nmin = 0\n",
                    "12: stop 1.slide: expected the name of a slide or pin_in_slot, found \"rma\"; "
                    "did you mean \"ram\"?"),
        after_slide("StopOfAPin",
                    "[[pin]]\nname = 'hinge'\npoints = ['ground.O', 'crank.O']\n[[stop]]\nslide = 'hinge'\nmin = 0\n",
                    "15: stop 1.slide: expected the name of a slide or pin_in_slot, found \"hinge\"; known here: ram"),
        after("StopWithoutSlides", "[[stop]]\nslide = 'ram'\nmin = 0\n",
              "8: stop 1.slide: expected the name of a slide or pin_in_slot, found \"ram\"; there is none here"),
        after_slide("StartUnknown", "[start]\ncrnk = 1\n",
                    "12: start.crnk: expected the name of a body, slide or pin_in_slot, or a table \"position\"; "
                    "did you mean \"crank\"?"),
        after_slide("StartUnknownSlide", "[start]\nrm = 1\n",
                    "12: start.rm: expected the name of a body, slide or pin_in_slot, or a table \"position\"; "
                    "did you mean \"ram\"?"),
        after("StartGround", "[start]\nground = 1\n",
              "8: start.ground: expected the name of a body, slide or pin_in_slot, or a table \"position\"; known "
              "here: crank, rod, position"),
        after("StartOfAPin", "[[pin]]\nname = 'hinge'\npoints = ['ground.O', 'crank.O']\n[start]\nhinge = 1\n",
              "11: start.hinge: expected the name of a body, slide or pin_in_slot, or a table \"position\"; "
              "known here: crank, rod, position"),
        after("StartNotNumber", "[start]\nrod = [1]\n", "8: start.rod: expected a number, found a list"),
        after("StartWithoutQuotes", "[start]\nground.S-rod.B = 1\n",
              "8: start.ground: expected a number; put a name that holds dots in quotes"),
        after("StartPositionNotTable", "[start]\nposition = [1, 2]\n",
              "8: start.position: expected a table, found a list"),
        after("StartPositionUnknown", "[start.position]\nrood = [1, 2]\n",
              "8: start.position.rood: expected the name of a body other than ground, found \"rood\"; "
              "did you mean \"rod\"?"),
        after("StartPositionNotVector", "[start]\nposition = { rod = 1 }\n",
              "8: start.position.rod: expected two numbers [X, Y], found a number")),
    name_of_case);

}  // namespace
}  // namespace poise::read_scene_test

// Addresses and lists of joints of PMKS, against the places that they say.

#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/exchange/placed.hpp"

namespace poise::exchange_tests::pmks_test {
namespace {

// Grounded input A (0, 0), B (1, 2), C (4, 3), grounded D (5, 0), cm; three links of 1 kg.
const std::string four_bar =
    "0P.TY.K,0.101.MA,A,0,0,0.GB,B,Fe,VG,0.GC,C,_W,ku,0.KD,D,1E8,0,0..YRAB,AB,Fe,Fe,7q,Fe,c5cae9,A,B,,.YRBC,BC,Fe,Fe,"
    "d4,d4,c5cae9,B,C,,.YRCD,CD,Fe,Fe,16K,NS,c5cae9,C,D,,...JBj";

TEST(PmksAddress, IsReadByItsFormat) {
  const Scene scene = scene_of("pmks", "https://app.pmksplus.com/?" + four_bar + "\n");
  ASSERT_EQ(scene.bodies.size(), 4U);
  EXPECT_EQ(scene.bodies[1].name, "AB");
  EXPECT_EQ(scene.units.length_name, "mm");
  const Placed there = placed(scene);
  EXPECT_EQ(there.freedoms, 1);
  expect_places({{0, 0}, {0.01, 0.02}, {0.04, 0.03}, {0.05, 0}}, there);
  EXPECT_EQ(scene.bodies[1].mass, 1.0);
  EXPECT_NEAR(scene.bodies[1].center.x, 0.005, 1e-15);
  EXPECT_NEAR(scene.bodies[1].center.y, 0.01, 1e-15);
  EXPECT_NEAR(scene.bodies[1].inertia, 1e-4, 1e-15);  // 1 kg cm^2
  EXPECT_EQ(scene.bodies[2].center.x, 0.025);
  ASSERT_EQ(scene.drives.size(), 1U);
  EXPECT_NEAR(scene.drives[0].rate, -20 * 2 * std::numbers::pi / 60, 1e-12);  // 20 turns a minute, clockwise
}

TEST(PmksAddress, MayBeAShortcutOrEscaped) {
  const std::string plain = imported("pmks", four_bar).text;
  EXPECT_EQ(imported("pmks", "[InternetShortcut]\r\nURL=https://app.pmksplus.com/?" + four_bar + "\r\n").text, plain);
  std::string escaped = four_bar;
  for (std::size_t at = escaped.find(','); at != std::string::npos; at = escaped.find(','))
    escaped.replace(at, 1, "%2C");
  EXPECT_EQ(imported("pmks", "https://app.pmksplus.com/?" + escaped).text, plain);
}

TEST(PmksAddress, SaysWhatItCannotRead) {
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = four_bar.substr(0, four_bar.size() - 1);
    text.replace(text.find(from), from.size(), to);
    constexpr std::string_view check = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
    return text + check[text.size() % check.size()];
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "it.pmks:1: address: expected the address of a mechanism, found nothing"},
      {"https://app.pmksplus.com/", "as the last character"},
      {four_bar + "x", "as the last character, which counts the others"},
      {four_bar + "\nsecond line", "expected one line, the address of a mechanism"},
      {changed(".101.", ".301."), "units: expected 0, 1 or 2"},
      {changed("GB,B,Fe,", "GB,B,"), "expected a joint as id, name, x, y, angle"},
      {changed("GB,B,Fe,", "GB,B,F!,"), "joint \"B\": expected a number in the digits of PMKS+, found \"F!\""},
      {changed("GB,B,Fe,", "GB,B,FFFFFFFFFFFFFFFFFe,"), "expected a number in the digits"},
      {changed("GB,B,", "GA,B,"), "joint \"A\": expected one joint of this id, found two"},
      {changed("c5cae9,A,B", "c5cae9,A,X"), "link \"AB\": expected the id of a joint, found \"X\""},
      {changed("YRAB", "ZRAB"), "expected a link as YR or YP"},
      {changed("AB,Fe,Fe", "AB,0e,Fe"), "expected a mass and an inertia >= 0"}};
  for (const auto& [text, message] : cases) {
    try {
      imported("pmks", text);
      ADD_FAILURE() << "read: " << message;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }
}

constexpr const char* machine = R"(
gravity = [0, -9810]
[units]
length = "mm"
angle = "deg"
[ground]
points = { O = [0, 0], G = [0, -20] }
[body.crank]
points = { O = [0, 0], B = [30, 40] }
mass = 0.5
center = [15, 20]
inertia = 200
[body.rod]
points = { B = [30, 40], C = [150, -20] }
mass = 0.25
center = [90, 10]
inertia = 300
[body.ram]
points = { C = [150, -20] }
mass = 2
center = [150, -20]
[body.lever]
points = { P = [0, 100], Q = [30, 60] }
[body.plate]
points = { Q = [30, 60], S = [90, 60] }
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.B", "rod.B"]
[[pin]]
points = ["rod.C", "ram.C"]
[[slide]]
name = "guide"
points = ["ground.G", "ram.C"]
axis = [1, 0]
[[weld]]
points = ["lever.Q", "plate.Q"]
[[bar]]
name = "strut"
points = ["ground.O", "lever.P"]
length = 100
[[pin_in_slot]]
name = "slot"
points = ["plate.Q", "rod.B"]
axis = [0, 1]
[[drive]]
name = "motor"
bodies = ["ground", "crank"]
rate = -90
[[force]]
name = "push"
at = "rod.C"
vector = [-40, 0]
[[force]]
name = "jet"
at = "plate.S"
vector = [0, 3]
follows = "plate"
[start]
guide = 150
slot = -20
)";

TEST(PmksAddress, LinksComeBackWithAllTheirJoints) {
  const Scene scene = parse_scene(machine, "machine.toml");
  const Scene back = expect_round_trip("pmks", scene);
  EXPECT_EQ(back.gravity, (Vec2{0, -9.81}));
  ASSERT_EQ(back.drives.size(), 1U);
  EXPECT_NEAR(back.drives[0].rate, -std::numbers::pi / 2, 1e-12);
  ASSERT_EQ(back.forces.size(), 2U);
  EXPECT_NEAR(back.forces[0].vector.x, -40, 1e-9);
  EXPECT_LT(back.forces[0].follows, 0);
  EXPECT_NEAR(back.forces[1].vector.y, 3, 1e-9);
  EXPECT_EQ(back.bodies[back.forces[1].follows].name, "lever");
  double mass = 0.0, inertia = 0.0;
  for (const Body& body : back.bodies) {
    mass += body.mass;
    inertia += body.inertia;
  }
  EXPECT_NEAR(mass, 2.75, 1e-12);
  EXPECT_NEAR(inertia, 5e-4, 1e-12);
}

TEST(PmksAddress, NotesWhatIsRoundedOrLeftOut) {
  const Scene scene = parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], A = [0.12345678, 0] }
mass = 1
[[pin]]
points = ["ground.O", "arm.O"]
[[torsion_spring]]
bodies = ["ground", "arm"]
stiffness = 1
)",
                                  "arm.toml");
  const ScaledModel model(scene, Purpose::dynamics);
  const Exported out = exported("pmks", model, close_loops(model));
  EXPECT_TRUE(has_note(out.notes, "Places are rounded to 0.001"));
  EXPECT_TRUE(has_note(out.notes, "1 torsion spring is left out."));
  EXPECT_TRUE(has_note(out.notes, "No joint is an input"));
  EXPECT_FALSE(has_note(out.notes, "Masses"));
}

TEST(PmksText, JointsAreLines) {
  const Scene scene =
      scene_of("pmks-text",
               "ground, crank,R,0,0,---+\ncrank rod\tr,0,50\n\nrod,block,R,120,0\nblock,ground,P,120,0,0\n"
               "rod, r, 60, 25\n");
  ASSERT_EQ(scene.bodies.size(), 4U);
  EXPECT_EQ(scene.bodies[2].points.size(), 3U);  // with the point of its own
  EXPECT_EQ(placed(scene).freedoms, 1);
  expect_places({{0, 0}, {0, 0.05}, {0.12, 0}}, placed(scene));
}

// The slot belongs to the first link: the lever of a quick return, or the crank of one that runs the other way.
TEST(PmksText, ASlotBelongsToTheFirstLink) {
  const Scene lever = scene_of("pmks-text", "ground,input,R,0,0\ncoupler input,RP,2,0,0\ncoupler,ground,R,5,0\n");
  ASSERT_EQ(lever.joints[1].kind, Joint::Kind::pin_in_slot);
  EXPECT_EQ(lever.bodies[lever.joints[1].a.body].name, "coupler");
  EXPECT_EQ(placed(lever).freedoms, 1);
  EXPECT_TRUE(
      has_note(imported("pmks-text", "ground,r,R,0,0\nr,x,R,1,1\nr x,RP,2,0,0\n").notes, "belongs to the first"));
}

TEST(PmksText, SaysWhatItCannotRead) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "it.pmks-text:1: joint: expected a line for each joint, found none"},
      {"ground,crank,R,0,0\nmech=\n", "it.pmks-text:2: joint: expected names of links, R, P or RP, and x, y"},
      {"a,b,G,0,0\n", "expected R, P or RP, found G"},
      {"a,b,R,0\n", "expected names of links"},
      {"a,b,R,0,y\n", "it.pmks-text:1: y: expected a number, found \"y\""},
      {"a,b,P,0,0\n", "and the angle of the slide"},
      {"a,b,c,P,0,0,0\n", "expected two links in front of P, found 3"},
      {"a,a,R,0,0\n", "expected links that differ, found \"a\" twice"},
      {"ground,R,0,0\n", "expected a link besides the ground, found none"}};
  for (const auto& [text, message] : cases) {
    try {
      imported("pmks-text", text);
      ADD_FAILURE() << "read: " << message;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace poise::exchange_tests::pmks_test

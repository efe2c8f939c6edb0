// Drawings in DXF by hand, against the places that were drawn.

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/exchange/placed.hpp"

namespace poise::exchange_tests::dxf_test {
namespace {

std::string line(const std::string& layer, Vec2 a, Vec2 b) {
  return fmt::format("0\nLINE\n8\n{}\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", layer, a.x, a.y, b.x, b.y);
}

std::string point(const std::string& layer, Vec2 at) {
  return fmt::format("0\nPOINT\n8\n{}\n10\n{}\n20\n{}\n", layer, at.x, at.y);
}

std::string circle(const std::string& layer, Vec2 at, double radius) {
  return fmt::format("0\nCIRCLE\n8\n{}\n10\n{}\n20\n{}\n40\n{}\n", layer, at.x, at.y, radius);
}

std::string drawing(const std::string& entities, const std::string& header = "") {
  return "0\nSECTION\n2\nHEADER\n" + header + "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n";
}

const std::string four_bar = point("Ground", {0, 0}) + point("GROUND", {50, 0}) + line("crank", {0, 0}, {10, 20}) +
                             line("coupler", {10, 20}, {40, 30}) + line("rocker", {40, 30}, {50, 0});

TEST(Dxf, LayersAreLinksAndCoincidentPointsPins) {
  const Scene scene = scene_of("dxf", drawing(four_bar));
  ASSERT_EQ(scene.bodies.size(), 4U);
  EXPECT_EQ(scene.bodies[1].name, "crank");
  EXPECT_EQ(scene.joints.size(), 4U);
  EXPECT_EQ(scene.units.length_name, "mm");
  const Placed there = placed(scene);
  EXPECT_EQ(there.freedoms, 1);
  expect_places({{0, 0}, {0.010, 0.020}, {0.040, 0.030}, {0.050, 0}}, there);
}

TEST(Dxf, TellsItsUnitOrTakesTheOneThatIsGiven) {
  const auto unit_of = [](const std::string& header, const ImportOptions& options = {}) {
    const Scene scene = scene_of("dxf", drawing(four_bar, header), options);
    return scene.units.length_name + fmt::format(" {:g}", norm(scene.bodies[0].points[1].at));
  };
  EXPECT_EQ(unit_of(""), "mm 0.05");
  EXPECT_EQ(unit_of("", {.length = "in"}), "in 1.27");
  EXPECT_EQ(unit_of("9\n$INSUNITS\n70\n1\n"), "in 1.27");
  EXPECT_EQ(unit_of("9\n$INSUNITS\n70\n4\n", {.length = "in"}), "mm 0.05");
  EXPECT_EQ(unit_of("9\n$INSUNITS\n70\n5\n"), "mm 0.5");
  EXPECT_EQ(unit_of("9\n$INSUNITS\n70\n6\n"), "m 50");
  EXPECT_TRUE(has_note(imported("dxf", drawing(four_bar)).notes, "Lengths are taken for mm"));
}

// A plate with three holes, of which one is a pin on the ground, a link between circles, and an arc.
TEST(Dxf, HolesArcsAndPolylinesHavePoints) {
  const Scene scene = scene_of(
      "dxf",
      drawing(circle("ground", {0, 0}, 5) + circle("plate", {0, 0}, 3) +
              "0\nLWPOLYLINE\n8\nplate\n90\n4\n70\n1\n10\n0\n20\n0\n10\n30\n20\n0\n10\n30\n20\n40\n10\n0\n20\n40\n" +
              circle("plate", {30, 40}, 4) + circle("link", {30, 40}, 2) +
              "0\nARC\n8\nlink\n10\n30\n20\n50\n40\n10\n50\n-90\n51\n90\n" + circle("end", {30, 60}, 1)));
  ASSERT_EQ(scene.bodies.size(), 4U);
  EXPECT_EQ(scene.bodies[1].points.size(), 4U);
  EXPECT_EQ(scene.bodies[2].points.size(), 2U);
  EXPECT_EQ(scene.joints.size(), 3U);
  EXPECT_EQ(placed(scene).freedoms, 3);
}

TEST(Dxf, PointsWithinTheToleranceAreOne) {
  const std::string near = drawing(point("ground", {0, 0}) + line("arm", {0.01, 0}, {100, 0}));
  EXPECT_EQ(scene_of("dxf", near).joints.size(), 0U);
  EXPECT_TRUE(has_note(imported("dxf", near).notes, "0.01 apart, which is no pin"));
  EXPECT_TRUE(has_note(imported("dxf", near).notes, "arm meets no other layer"));
  EXPECT_EQ(scene_of("dxf", near, {.tolerance = 0.1}).joints.size(), 1U);
  EXPECT_EQ(scene_of("dxf", drawing(point("ground", {0, 0}) + line("arm", {1e-5, 0}, {100, 0}))).joints.size(), 1U);
}

TEST(Dxf, OldPolylinesTextsAndSheets) {
  const std::string old =
      "0\nPOLYLINE\n8\narm\n66\n1\n10\n0\n20\n0\n30\n0\n0\nVERTEX\n8\narm\n10\n0\n20\n0\n0\nVERTEX\n8\n"
      "arm\n10\n3\n20\n4\n0\nSEQEND\n8\narm\n";
  const std::string paper = "0\nLINE\n8\nframe\n67\n1\n10\n0\n20\n0\n11\n1\n21\n1\n";
  const Imported read = imported("dxf", drawing(point("GROUND", {0, 0}) + old + paper + "0\nTEXT\n8\n0\n1\ncrank\n"));
  EXPECT_TRUE(has_note(read.notes, "1 text, dimension or hatch is left out."));
  EXPECT_TRUE(has_note(read.notes, "1 entity of a sheet is left out."));
  EXPECT_EQ(placed(parse_scene(read.text, "it.toml")).freedoms, 1);
}

TEST(Dxf, SaysWhatItCannotTake) {
  const std::string a_line = line("arm", {0, 0}, {1, 0});
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "it.dxf:0"},
      {"solid cube\n facet\n", "it.dxf:1: group: expected a group code of DXF, found \"solid cube\""},
      {drawing(""), "ENTITIES: expected lines, circles or points, found none"},
      {drawing(a_line).substr(0, 80), "expected its value, found the end of the file"},
      {drawing(a_line + "0\nSPLINE\n8\narm\n"), "it.dxf:24: SPLINE: expected LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE"},
      {drawing(a_line + "0\nINSERT\n8\narm\n2\nwheel\n"), "INSERT: expected LINE"},
      {drawing(a_line + "0\n3DFACE\n8\narm\n"), "3DFACE: expected LINE"},
      {drawing("0\nLINE\n8\narm\n10\n0\n20\n0\n30\n5\n11\n1\n21\n0\n"),
       "expected a drawing in the plane z = 0, found z = 5"},
      {drawing("0\nPOINT\n8\narm\n10\n0\n20\n0\n230\n-1\n"), "expected a drawing seen along z"},
      {drawing("0\nLINE\n8\narm\n10\n0\n20\nx\n11\n1\n21\n0\n"), "LINE, group 20: expected a number, found \"x\""},
      {drawing("0\nLINE\n8\narm\n10\n0\n20\n0\n"), "LINE: expected group 11, found none"},
      {drawing("0\nLINE\n8\narm\n10\n0\n20\n1e400\n11\n1\n21\n0\n"), "group 20: expected"},
      {drawing("0\nCIRCLE\n8\narm\n10\n0\n20\n0\n40\n0\n"), "expected a radius > 0 in group 40, found 0"},
      {drawing("0\nPOLYLINE\n8\narm\n70\n8\n"), "expected a polyline in the plane"},
      {drawing("0\nPOLYLINE\n8\narm\n" + a_line), "expected VERTEX or SEQEND"},
      {drawing(a_line, "9\n$INSUNITS\n70\n13\n"),
       "$INSUNITS: expected 1 (in), 2 (ft), 4 (mm), 5 (cm) or 6 (m), found 13"},
      {drawing(point("GROUND", {0, 0})), "links: expected a link besides the ground, found none"}};
  for (const auto& [text, message] : cases) {
    try {
      imported("dxf", text);
      ADD_FAILURE() << "read: " << message;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message == "it.dxf:0" ? "it.dxf: " : message), std::string::npos)
          << error.what();
    }
  }
}

TEST(Dxf, LargeDrawingsAreRefusedSoon) {
  std::string entities;
  for (int i = 0; i < 6000; ++i) entities += line("arm", {1.0 * i, 0}, {1.0 * i, 1});
  EXPECT_THROW(imported("dxf", drawing(entities)), InputError);
  std::string layers;
  for (int i = 0; i < 1500; ++i) layers += line(fmt::format("link {}", i), {1.0 * i, 0}, {1.0 * i + 1, 0});
  EXPECT_THROW(imported("dxf", drawing(layers)), InputError);
}

TEST(Dxf, LinksComeBack) {
  const Scene scene = scene_of("dxf", drawing(four_bar));
  const Scene back = expect_round_trip("dxf", scene);
  EXPECT_EQ(back.bodies[1].name, "crank");
  expect_round_trip("dxf", parse_scene(R"(
[units]
length = "mm"
angle = "deg"
[ground]
points = { O = [0, 0], C = [120, 0] }
[body.arm]
points = { A = [0, 0], B = [50, 0] }
[body.plate]
points = { P = [0, 0], Q = [30, 10] }
[[pin]]
points = ["ground.O", "arm.A"]
[[weld]]
points = ["arm.B", "plate.P"]
angle = 25
[[bar]]
name = "strut 1"
points = ["ground.C", "plate.Q"]
length = 60
[start]
arm = 40
plate = 65
)",
                                       "welded.toml"));
}

TEST(Dxf, NotesWhatADrawingHasNot) {
  const Scene scene = parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body."slider 1"]
points = { A = [0, 0] }
[[slide]]
name = "guide"
points = ["ground.O", "slider 1.A"]
axis = [1, 0]
[[spring]]
slide = "guide"
stiffness = 1
free_length = 0
)",
                                  "slider.toml");
  const ScaledModel model(scene, Purpose::dynamics);
  const Exported out = exported("dxf", model, close_loops(model));
  EXPECT_TRUE(has_note(out.notes, "The slide guide is left out"));
  EXPECT_TRUE(has_note(out.notes, "1 spring is left out."));
  EXPECT_TRUE(has_note(out.notes, "ground and slider 1 coincide here without a pin"));
  EXPECT_TRUE(has_note(out.notes, "Layers are named by letters"));
}

}  // namespace
}  // namespace poise::exchange_tests::dxf_test

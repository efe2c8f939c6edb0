// Springs of every law in scene files: what is read, written back and set, and the messages about what cannot be read.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "model/scene.hpp"
#include "model/scene_builder.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/message_of.hpp"

namespace poise::read_springs_test {
namespace {

using test::message_of;

namespace fs = std::filesystem;

const std::string rail = R"(units = { length = "mm", force = "kN", angle = "deg" }
[ground]
points.O = [0, 0]
[body.block]
points.c = [0, 0]
[[slide]]
name = "guide"
points = ["ground.O", "block.c"]
axis = [1, 0]
)";  // the next line is the 10th

Scene with(const std::string& elements) { return parse_scene(rail + elements, "rail.toml"); }

std::string refusal(const std::string& elements) {
  return message_of([&] { with(elements); });
}

/// Files beside a scene, removed at the end.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("poise_springs_" + std::to_string(getpid()))) {
    fs::create_directory(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path(const std::string& name) const { return (path_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }

 private:
  fs::path path_;
};

const std::string curve =
    "[[spring]]\nname = \"s\"\nslide = \"guide\"\nforce = { curve = [[10, 0], [20, 1], [30, 3]] }\n";
const std::string strut =
    "[[spring]]\nname = \"s\"\nslide = \"guide\"\n"
    "gas = { preload = 0.5, length = 500, stroke = 200, ratio = 1.4, friction = 0.03 }\n";

TEST(ReadSprings, OfEachLaw) {
  EXPECT_TRUE(std::holds_alternative<LinearSpring>(
      with("[[spring]]\nslide = \"guide\"\nstiffness = 1\nfree_length = 1\n").elements[0].law));
  const Scene cubic = with("[[spring]]\nslide = \"guide\"\nstiffness = 2\nfree_length = 7\ncubic = 3e-3\n");
  EXPECT_DOUBLE_EQ(test::law<CubicSpring>(cubic, "spring").cubic, 3e9);
  EXPECT_DOUBLE_EQ(get_value(cubic, "spring.spring 1.cubic"), 3e-3);
  const Scene preloaded = with("[[spring]]\nslide = \"guide\"\nstiffness = 2\npreload = 5\nlength = 40\n");
  EXPECT_DOUBLE_EQ(test::law<PreloadedSpring>(preloaded, "spring").preload, 5000.0);
  EXPECT_DOUBLE_EQ(test::law<PreloadedSpring>(preloaded, "spring").length, 0.04);
  const Scene turned =
      with("[[torsion_spring]]\nbodies = [\"ground\", \"block\"]\nstiffness = 2\npreload = 5\nangle = 90\n");
  EXPECT_DOUBLE_EQ(test::law<PreloadedSpring>(turned, "torsion_spring").length, M_PI / 2);
  EXPECT_DOUBLE_EQ(get_value(turned, "torsion_spring.torsion spring 1.angle"), 90.0);
  const Scene bump =
      with("[[bump_stop]]\nslide = \"guide\"\nforce = 2\nfree_length = 30\ndepth = 4\nacts = \"tension\"\n");
  EXPECT_EQ(test::law<BumpStop>(bump, "bump_stop").acts, BumpStop::Acts::tension);
  EXPECT_EQ(test::law<BumpStop>(bump, "bump_stop").exponent, 2.0);
  EXPECT_DOUBLE_EQ(test::law<BumpStop>(bump, "bump_stop").depth, 0.004);
}

TEST(ReadSprings, CurvesInUnitsOfTheScene) {
  const Scene scene = with(curve + "scale = 1.5\nshift = 2\n");
  const auto& spring = test::law<CurveSpring>(scene, "spring");
  EXPECT_DOUBLE_EQ(spring.at_rest(0.022).value, 1500.0);
  EXPECT_DOUBLE_EQ(get_value(scene, "spring.s.force.3"), 3.0);
  const Scene angle = with(
      "[[torsion_spring]]\nbodies = [\"ground\", \"block\"]\ntorque = { curve = [[-90, -4], [90, 4]], interpolation = "
      "\"monotone\" }\n");
  EXPECT_DOUBLE_EQ(test::law<CurveSpring>(angle, "torsion_spring").at_rest(M_PI / 4).value, 2.0);
  EXPECT_DOUBLE_EQ(get_value(angle, "torsion_spring.torsion spring 1.torque.2"), 4.0);
}

TEST(ReadSprings, CurvesOfAFileBesideTheScene) {
  const Folder folder;
  folder.write("strut.csv", "x;F\n10;0\n20;1\n30;3\n\n");
  folder.write("scene.toml", rail + "[[spring]]\nslide = \"guide\"\nforce.file = \"strut.csv\"\n");
  const Scene scene = read_scene(folder.path("scene.toml"));
  const Scene same = with(curve);
  for (const double g : {0.0, 0.013, 0.027, 0.05}) {
    EXPECT_EQ(test::law<CurveSpring>(scene, "spring").at_rest(g).value,
              test::law<CurveSpring>(same, "spring").at_rest(g).value);
  }
  EXPECT_EQ(message_of([&] { get_value(scene, "spring.spring 1.force.1"); }).find("spring.spring 1.force.1: expected"),
            0U);
}

TEST(ReadSprings, FilesThatAreNoCurves) {
  const Folder folder;
  folder.write("scene.toml", rail + "[[spring]]\nslide = \"guide\"\nforce.file = \"c.csv\"\n");
  const auto read = [&](const char* text) {
    if (text != nullptr) folder.write("c.csv", text);
    const std::string message = message_of([&] { read_scene(folder.path("scene.toml")); });
    const std::size_t at = message.rfind("c.csv");
    return at == std::string::npos ? message : message.substr(at);
  };
  EXPECT_NE(read(nullptr).find("c.csv: cannot be read"), std::string::npos);
  EXPECT_EQ(read("x,F\n1,2\n"), "c.csv: expected two points [x, F] or more, found 1; add others");
  EXPECT_EQ(read("x,F\n1,2\n1,3\n"),
            "c.csv:3: x: expected an x after that of the point before; sort the points, and give one force for each x");
  EXPECT_EQ(read("x,F\n1,2\n2,nan\n"),
            "c.csv:3: F: expected a finite number, found \"nan\"; correct it or leave the row out");
  EXPECT_EQ(read("x,F\n1,2\n2,\n"), "c.csv:3: F: expected a value, found a gap; fill it or leave the row out");
  EXPECT_EQ(read("x,F,t\n1,2,3\n2,3,4\n"),
            "c.csv:1: header: expected two columns, x and force, found 3; leave the others out");
  EXPECT_EQ(read("x,F\n1,1e49\n2,3\n"),
            "c.csv:2: F: expected a finite number of at most 1e50 in SI units, found 1e+49");
}

TEST(ReadSprings, GasStrutsBringTheirStopAndTheirFriction) {
  const Scene scene = with(strut);
  ASSERT_EQ(scene.stops.size(), 1U);
  EXPECT_EQ(scene.stops[0].name, "s");
  EXPECT_DOUBLE_EQ(scene.stops[0].min, 0.3);
  EXPECT_DOUBLE_EQ(scene.stops[0].max, 0.5);
  EXPECT_DOUBLE_EQ(test::law<DryFriction>(scene, "friction").force, 30.0);
  EXPECT_EQ(test::law<DryFriction>(scene, "friction").width, 0.01);
  EXPECT_EQ(test::law<GasStrut>(scene, "spring").exponent, 1.0);
  EXPECT_DOUBLE_EQ(get_value(scene, "spring.s.gas.ratio"), 1.4);
  EXPECT_DOUBLE_EQ(get_value(scene, "friction.s.force"), 0.03);
  EXPECT_NE(message_of([&] { get_value(scene, "stop.s.max"); }), "") << "its limits are numbers of the strut";
}

TEST(ReadSprings, TheStopOfAGasStrutFollowsItsNumbers) {
  Scene scene = with(strut);
  set_value(scene, "spring.s.gas.length", 520);
  EXPECT_DOUBLE_EQ(scene.stops[0].max, 0.52);
  EXPECT_DOUBLE_EQ(scene.stops[0].min, 0.32);
  set_value(scene, "spring.s.gas.stroke", 100);
  EXPECT_DOUBLE_EQ(scene.stops[0].min, 0.42);
  const Scene larger = scaled(scene, {4.0, 0.5});
  EXPECT_DOUBLE_EQ(larger.stops[0].max, 0.13);
  EXPECT_NE(message_of([&] { set_value(scene, "spring.s.gas.ratio", 0.9); }).find("expected a ratio above 1"),
            std::string::npos);
}

TEST(ReadSprings, WriteTheirNumbersBack) {
  const std::string text = rail + curve + strut + R"(
[[bump_stop]]
slide = "guide"
force = 2
free_length = 30
depth = 4

[[torsion_spring]]
bodies = ["ground", "block"]
torque.curve = [
  [-90, -4], # wound back
  [90, 4],
]
)";
  const std::string unique = std::string(text).replace(text.rfind("name = \"s\""), 10, "name = \"t\"");
  Scene scene = parse_scene(unique, "rail.toml");
  int changed = 0;
  for (const ParameterRow& row : parameter_table(scene)) {
    if (row.place.owner != Owner::element) continue;
    set_value_at(scene, row.place, *value_at(scene, row.place) * 1.25 + (row.path.parts[3] == "shift" ? 0.001 : 0.0));
    ++changed;
  }
  EXPECT_EQ(changed, 5 + 5 + 2 + 4 + 4);
  const std::string out = rewritten_scene(unique, "rail.toml", scene);
  const Scene back = parse_scene(out, "rail.toml");
  for (const ParameterRow& row : parameter_table(scene)) {
    const double value = value_at(scene, row.place).value_or(0.0);
    EXPECT_NEAR(value_at(back, row.place).value_or(0.0), value, 1e-14 * std::abs(value)) << row.path.text();
  }
  EXPECT_DOUBLE_EQ(back.stops[0].max, 0.625);
  EXPECT_NE(out.find("# wound back"), std::string::npos);
}

TEST(ReadSprings, AreBuiltInCode) {
  SceneBuilder builder("rail", {.length = "mm", .force = "kN"});
  builder.ground_point("O", {0, 0}).body("block", {.points = {{"c", {0, 0}}}});
  builder.slide("ground.O", "block.c", {1, 0}, "guide");
  builder.element("spring", "s", measures::travel("guide"), {{"force.curve", {{10, 0}, {20, 1}, {30, 3}}}});
  builder.element("spring", "t", measures::travel("guide"),
                  {{"gas.preload", 0.5}, {"gas.length", 500}, {"gas.stroke", 200}, {"gas.ratio", 1.4}});
  const Scene scene = builder.build();
  EXPECT_EQ(test::law<CurveSpring>(scene, "spring").at_rest(0.017).value,
            test::law<CurveSpring>(with(curve), "spring").at_rest(0.017).value);
  EXPECT_EQ(test::law<GasStrut>(scene, "spring", 1).at_rest(0.4).value,
            test::law<GasStrut>(with(strut), "spring").at_rest(0.4).value);
  builder.element("spring", "u", measures::travel("guide"), {{"stiffness", 1}, {"free_length", 1}});
  EXPECT_EQ(message_of([] {
              SceneBuilder("r").element("spring", "u", measures::x("b.P"), {{"gas.ratio", 2}, {"gas.ratio", 3}});
            }),
            "r: spring \"u\": expected the key gas.ratio once, found it twice");
}

TEST(ReadSprings, RefuseWhatContradictsItself) {
  const std::string begin = "[[spring]]\nslide = \"guide\"\n";
  EXPECT_EQ(refusal(begin + "force = { curve = [[1, 2]] }\n"),
            "rail.toml:12: spring 1.force.curve: expected two points [x, F] or more, found 1; add others");
  EXPECT_EQ(
      refusal(begin + "force = { curve = [[1, 2],\n [1, 3]] }\n"),
      "rail.toml:13: spring 1.force.curve: expected an x after that of the point before; sort the points, and give "
      "one force for each x");
  EXPECT_EQ(refusal(begin + "force = { curve = [[1, 2], [2, nan]] }\n"),
            "rail.toml:12: spring 1.force.curve: expected a finite number, found nan");
  EXPECT_EQ(refusal(begin + "force = { curve = [[1, 2], 3] }\n"),
            "rail.toml:12: spring 1.force.curve: expected a list of pairs [[A, B], ...], found a number in it");
  EXPECT_EQ(refusal(begin + "force = { curve = [[1, 2], [2, 3]], interpolation = \"linear\" }\n"),
            "rail.toml:12: spring 1.force.interpolation: expected one of monotone, found \"linear\"");
  EXPECT_EQ(refusal(begin + "force = { curve = [[1, 2], [2, 3]], file = \"a.csv\" }\n"),
            "rail.toml:12: spring 1.force: expected either curve = [[x, F], ...] or file = \"NAME.csv\", found both; "
            "leave one out");
  EXPECT_EQ(refusal(begin + "force = {}\n"),
            "rail.toml:12: spring 1.force: expected either curve = [[x, F], ...] or file = \"NAME.csv\", found none");
  EXPECT_EQ(refusal(begin + "force = 3\n"), "rail.toml:12: spring 1.force: expected a table, found a number");
  EXPECT_EQ(refusal(begin + "stiffness = 3\nforce = { curve = [[1, 2], [2, 3]] }\n"),
            "rail.toml:12: spring 1.stiffness: expected one of the keys name, slide, scale, shift, force");
  EXPECT_EQ(refusal(begin + "stiffness = 3\npreload = 1\nlength = 3\ncubic = 2\n"),
            "rail.toml:10: spring 1: expected one of the keys cubic and preload, found both; leave one out");
  EXPECT_EQ(refusal(begin + "torque = { curve = [[1, 2], [2, 3]] }\n"),
            "rail.toml:12: spring 1.torque: expected the key force on a length; rename it");
  EXPECT_EQ(refusal("[[torsion_spring]]\nbodies = [\"ground\", \"block\"]\nforce = { curve = [[1, 2], [2, 3]] }\n"),
            "rail.toml:12: torsion_spring 1.force: expected the key torque on an angle; rename it");
  EXPECT_EQ(refusal(begin + "stiffness = 1\npreload = 2\nangle = 3\n"),
            "rail.toml:14: spring 1.angle: expected one of the keys name, slide, stiffness, preload, length, time");
  EXPECT_EQ(refusal(begin + "stiffness = 1\npreload = 2\n"),
            "rail.toml:10: spring 1: expected the key length; add length = NUMBER");
  EXPECT_EQ(refusal(begin + "stiffness = 1\npreload = 2\nlength = 3\nacts = \"tension\"\n"),
            "rail.toml:15: spring 1.acts: expected one of the keys name, slide, stiffness, preload, length, time");
}

TEST(ReadSprings, RefuseGasStrutsThatCannotBe) {
  const std::string begin = "[[spring]]\nname = \"s\"\nslide = \"guide\"\n";
  EXPECT_EQ(
      refusal(begin + "gas = { preload = 1, length = 5, stroke = 2, ratio = 0.9 }\n"),
      "rail.toml:13: spring \"s\".gas.ratio: expected a ratio above 1, the force with the rod in over that with the "
      "rod out; a force that stays the same is a constant_force");
  EXPECT_EQ(refusal(begin + "gas = { preload = 1, length = 5, stroke = -2, ratio = 1.5 }\n"),
            "rail.toml:13: spring \"s\".gas.stroke: expected a finite number > 0, found -2");
  EXPECT_EQ(refusal(begin + "gas = { preload = 1, length = 5, stroke = 2, ratio = 1.5, exponent = 0 }\n"),
            "rail.toml:13: spring \"s\".gas.exponent: expected a finite number > 0, found 0");
  EXPECT_EQ(refusal(begin + "gas = { preload = 1, length = 5, stroke = 2 }\n"),
            "rail.toml:13: spring \"s\".gas: expected the key ratio; add ratio = NUMBER");
  EXPECT_EQ(
      refusal(begin + "gas = { preload = 1, length = 5, stroke = 2, ratio = 1.5, volume = -1 }\n"),
      "rail.toml:13: spring \"s\".gas.volume: expected one of the keys friction, friction_width, preload, length, "
      "stroke, ratio, exponent, damping, end_damping, end_stroke");
  EXPECT_EQ(refusal(begin + "gas = { preload = 1, length = 5, stroke = 2, ratio = 1.5, friction_width = 1 }\n"),
            "rail.toml:13: spring \"s\".gas: expected the key friction beside friction_width; add it");
  EXPECT_EQ(refusal("[[spring]]\nbodies = [\"ground\", \"block\"]\ngas = { preload = 1 }\n"),
            "rail.toml:12: spring 1.gas: expected a measure that is a length, for example points; a gas strut pushes "
            "along it");
  EXPECT_EQ(refusal(strut + "[[stop]]\nname = \"s\"\nslide = \"guide\"\nmin = 0\n"),
            "rail.toml:13: spring \"s\".gas: expected a name of its own; \"s\" is taken in line 14");
}

TEST(ReadSprings, RefuseBumpStopsWithAKink) {
  EXPECT_EQ(
      refusal("[[bump_stop]]\nslide = \"guide\"\nforce = 1\nfree_length = 1\ndepth = 1\nexponent = 1\n"),
      "rail.toml:15: bump_stop 1.exponent: expected an exponent above 1; a stop of constant stiffness is a spring "
      "with acts = \"...\"");
  EXPECT_EQ(refusal("[[bump_stop]]\nslide = \"guide\"\nforce = 1\nfree_length = 1\ndepth = 0\n"),
            "rail.toml:14: bump_stop 1.depth: expected a finite number > 0, found 0");
}

}  // namespace
}  // namespace poise::read_springs_test

#include "model/scene_builder.hpp"

#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "model/parameters.hpp"

namespace poise {
namespace {

// A scene file with every kind of item, and the same scene in code.
constexpr const char* press_file = R"(
title = "press"
source = "made up"
gravity = [0, -9810]
[units]
length = "mm"
force = "kN"
mass = "g"
angle = "deg"
[ground]
points = { O = [0, 0], S = [0, -120], A = [-200, 10] }
[body.crank]
points = { O = [0, 0], B = [120, 0] }
mass = 400
center = [60, 1]
inertia = 480000
[body.rod]
points = { B = [0, 0], C = [250, 0] }
[body.ram]
points = { C = [0, 0], D = [30, 40] }
mass = 2500
[body."a.cap"]
points = { D = [0, 0] }
[[pin]]
points = ["ground.O", "crank.O"]
[[slide]]
name = "guide"
points = ["ground.S", "ram.C"]
axis = [3, 4]
angle = 10
[[pin]]
points = ["crank.B", "rod.B"]
[[pin_in_slot]]
points = ["rod.C", "ram.C"]
axis = [0, 2]
name = "slot"
[[weld]]
points = ["ram.D", "a.cap.D"]
angle = -5
[[bar]]
points = ["ground.A", "crank.B"]
length = 330
name = "link"
[[spring]]
name = "return"
points = ["ground.S", "ram.C"]
stiffness = 2.5
free_length = 150
acts = "compression"
[[spring]]
sum = [{ factor = 2, slide = "guide" }, { factor = -1, x = "rod.C" }, { factor = 1, y = "rod.C" }]
stiffness = 1
free_length = 3
[[torsion_spring]]
bodies = ["ground", "crank"]
stiffness = 20
free_angle = 90
[[friction]]
name = "guide"
slide = "guide"
force = 30
[[drive]]
name = "motor"
bodies = ["ground", "crank"]
rate = 360
[[force]]
name = "P"
at = "ram.C"
vector = [-40, 0]
[[force]]
at = "rod.C"
vector = [1, 2]
follows = "rod"
[[torque]]
name = "M"
on = "crank"
value = 7
[[stop]]
slide = "guide"
min = 20
[start]
crank = 40
guide = 300
position = { rod = [120, 5] }
)";

SceneBuilder press_builder() {
  SceneBuilder builder("press", {.length = "mm", .force = "kN", .mass = "g", .angle = "deg"});
  builder.source("made up")
      .gravity({0, -9810})
      .ground_point("O", {0, 0})
      .ground_point("S", {0, -120})
      .ground_point("A", {-200, 10})
      .body("crank", {.points = {{"O", {0, 0}}, {"B", {120, 0}}}, .mass = 400, .center = {60, 1}, .inertia = 480000})
      .body("rod", {.points = {{"B", {0, 0}}, {"C", {250, 0}}}})
      .body("ram", {.points = {{"C", {0, 0}}, {"D", {30, 40}}}, .mass = 2500})
      .body("a.cap", {.points = {{"D", {0, 0}}}})
      .pin("ground.O", "crank.O")
      .slide("ground.S", "ram.C", {3, 4}, "guide", 10)
      .pin("crank.B", "rod.B")
      .pin_in_slot("rod.C", "ram.C", {0, 2}, "slot")
      .weld("ram.D", "a.cap.D", -5)
      .bar("ground.A", "crank.B", 330, "link")
      .element("spring", "return", measures::distance("ground.S", "ram.C"),
               {{"stiffness", 2.5}, {"free_length", 150}, {"acts", "compression"}})
      .element("spring", "",
               measures::sum({{2, measures::travel("guide")}, {-1, measures::x("rod.C")}, {1, measures::y("rod.C")}}),
               {{"stiffness", 1}, {"free_length", 3}})
      .element("torsion_spring", "", measures::angle("ground", "crank"), {{"stiffness", 20}, {"free_angle", 90}})
      .element("friction", "guide", measures::travel("guide"), {{"force", 30}})
      .drive("motor", measures::angle("ground", "crank"), {{"rate", 360}})
      .force("P", "ram.C", {-40, 0})
      .force("", "rod.C", {1, 2}, "rod")
      .torque("M", "crank", 7)
      .stop("", measures::travel("guide"), {{"min", 20}})
      .start("crank", 40)
      .start("guide", 300)
      .start_position("rod", {120, 5});
  return builder;
}

TEST(SceneBuilder, BuildsWhatTheFileReaderReads) {
  const Scene built = press_builder().build();
  const Scene read = parse_scene(press_file, "press.toml");
  EXPECT_EQ(built.title, read.title);
  EXPECT_EQ(built.source, read.source);
  EXPECT_EQ(built.units.length_name, "mm");
  EXPECT_EQ(built.units.force_name, "kN");
  EXPECT_EQ(built.units.mass_name, "g");
  EXPECT_EQ(built.units.angle_name, "deg");
  ASSERT_EQ(built.joints.size(), read.joints.size());
  for (std::size_t i = 0; i < read.joints.size(); ++i) {
    EXPECT_EQ(built.joints[i].kind, read.joints[i].kind);
    EXPECT_EQ(built.joints[i].name, read.joints[i].name);
    EXPECT_EQ(built.joints[i].a, read.joints[i].a);
    EXPECT_EQ(built.joints[i].b, read.joints[i].b);
    EXPECT_EQ(built.joints[i].axis, read.joints[i].axis);
  }
  ASSERT_EQ(built.elements.size(), read.elements.size());
  for (std::size_t i = 0; i < read.elements.size(); ++i) {
    EXPECT_EQ(built.elements[i].on.kind, read.elements[i].on.kind);
    EXPECT_EQ(built.elements[i].on.terms.size(), read.elements[i].on.terms.size());
    EXPECT_EQ(built.elements[i].law.index(), read.elements[i].law.index());
  }
  EXPECT_EQ(std::get<LinearSpring>(built.elements[0].law).acts, LinearSpring::Acts::compression);
  EXPECT_EQ(built.forces.at(1).follows, 2);

  // Names, kinds and numbers of all items, in their order.
  const std::vector<ParameterRow> rows = parameter_table(read);
  const std::vector<ParameterRow> same = parameter_table(built);
  ASSERT_EQ(same.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(same[i].path.text(), rows[i].path.text());
    EXPECT_EQ(value_at(built, same[i].place), value_at(read, rows[i].place)) << rows[i].path.text();
  }
}

TEST(SceneBuilder, IsInSiWithoutUnits) {
  const Scene scene = SceneBuilder("link").body("arm", {.points = {{"B", {2, 3}}}, .mass = 4}).build();
  EXPECT_EQ(scene.bodies.at(1).mass, 4.0);
  EXPECT_EQ(scene.bodies.at(1).points.at(0).at, (Vec2{2, 3}));
  EXPECT_EQ(scene.units.length_name, "m");
}

std::string error_of(const std::function<void(SceneBuilder&)>& change) {
  try {
    SceneBuilder builder = press_builder();
    change(builder);
    builder.build();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SceneBuilder, SaysWhatIsWrongInTheWordsOfTheReader) {
  EXPECT_EQ(error_of([](SceneBuilder& b) { b.pin("crank.C", "ram.C"); }),
            "press: pin 3.points: expected a point of \"crank\", found \"crank.C\"; did you mean \"crank.O\"?");
  EXPECT_EQ(error_of([](SceneBuilder& b) { b.torque("T", "krank", 1); }),
            "press: torque \"T\".on: expected the name of a body other than ground, found \"krank\"; did you mean "
            "\"crank\"?");
  EXPECT_EQ(error_of([](SceneBuilder& b) { b.body("late", {.mass = -1}); }),
            "press: body.late.mass: expected a finite number >= 0, found -1");
  EXPECT_EQ(error_of([](SceneBuilder& b) {
              b.gravity({0, NAN});
            }),
            "press: gravity: expected a finite number, found nan");
  EXPECT_EQ(error_of([](SceneBuilder& b) {
              b.slide("ground.O", "rod.C", {0, 0}, "rail");
            }),
            "press: slide \"rail\".axis: expected a direction, found [0, 0]; give for example [1, 0]");
  EXPECT_EQ(error_of([](SceneBuilder& b) { b.bar("ground.O", "rod.C", 0, "rod"); }),
            "press: bar \"rod\".length: expected a finite number > 0, found 0");
  EXPECT_EQ(error_of([](SceneBuilder& b) {
              b.element("spring", "s", measures::distance("ground.O", "rod.C"), {{"stifness", 1}, {"free_length", 1}});
            }),
            "press: spring \"s\".stifness: expected one of the keys name, points, axis, stiffness, free_length, acts; "
            "did you "
            "mean \"stiffness\"?");
  EXPECT_EQ(error_of([](SceneBuilder& b) { b.stop("end", measures::travel("guide"), {}); }),
            "press: stop \"end\": expected the key min, max or both; add max = NUMBER");
  EXPECT_EQ(error_of([](SceneBuilder& b) { b.start("crnk", 1); }),
            "press: start.crnk: expected the name of a body, slide or pin_in_slot, or a table \"position\"; did you "
            "mean \"crank\"?");
}

TEST(SceneBuilder, RefusesNamesThatAreTaken) {
  EXPECT_EQ(error_of([](SceneBuilder& b) { b.body("crank", {}); }),
            "press: body.crank: expected a name of its own; \"crank\" is taken");
  EXPECT_EQ(error_of([](SceneBuilder& b) {
              b.body("late", {.points = {{"A", {0, 0}}, {"A", {1, 0}}}});
            }),
            "press: body.late.points.A: expected a name of its own; \"A\" is taken");
  EXPECT_EQ(error_of([](SceneBuilder& b) {
              b.ground_point("O", {1, 1});
            }),
            "press: ground.points.O: expected a name of its own; \"O\" is taken");
  EXPECT_EQ(error_of([](SceneBuilder& b) { b.pin("crank.B", "rod.B", "guide"); }),
            "press: pin \"guide\".name: expected a name of its own; \"guide\" is taken");
  EXPECT_EQ(error_of([](SceneBuilder& b) { b.start("crank", 2); }),
            "press: start.crank: expected a name of its own; \"crank\" is taken");
  EXPECT_EQ(error_of([](SceneBuilder& b) {
              b.stop("end", measures::x("rod.C"), {{"min", 1}, {"min", 2}});
            }),
            "press: stop \"end\": expected the key min once, found it twice");
}

TEST(SceneBuilder, NamesTheUnitsAndElementsThereAre) {
  const auto message = [](const auto& act) -> std::string {
    try {
      act();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([] { SceneBuilder("s", {.length = "cm"}).body("b", {}).build(); }),
            "s: units.length: expected one of m, mm, in, ft, found \"cm\"");
  EXPECT_EQ(message([] { units_of({.angle = "grad"}); }),
            "units.angle: expected one of rad, deg, found \"grad\"; did you mean \"rad\"?");
  EXPECT_EQ(message([] { SceneBuilder("s").element("dampr", "d", measures::x("b.P"), {}); }),
            "s: element \"d\": expected one of spring, torsion_spring, cubic_spring, constant_force, damper, "
            "torsion_damper, friction, bump_stop, found \"dampr\"; did you mean \"damper\"?");
}

}  // namespace
}  // namespace poise

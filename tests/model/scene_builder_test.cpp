#include "model/scene_builder.hpp"

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::scene_builder_test {
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

/// Names, kinds and numbers of all items, in their order.
void expect_same_numbers(const Scene& built, const Scene& read) {
  const std::vector<ParameterRow> rows = parameter_table(read);
  const std::vector<ParameterRow> same = parameter_table(built);
  ASSERT_EQ(same.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(same[i].path.text(), rows[i].path.text());
    EXPECT_EQ(value_at(built, same[i].place), value_at(read, rows[i].place)) << rows[i].path.text();
  }
}

void expect_same_items(const Scene& built, const Scene& read) {
  EXPECT_EQ(built.title, read.title);
  EXPECT_EQ(built.source, read.source);
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
  expect_same_numbers(built, read);
}

TEST(SceneBuilder, BuildsWhatTheFileReaderReads) {
  const Scene built = press_builder().build();
  EXPECT_EQ(built.units.length_name, "mm");
  EXPECT_EQ(built.units.force_name, "kN");
  EXPECT_EQ(built.units.mass_name, "g");
  EXPECT_EQ(built.units.angle_name, "deg");
  expect_same_items(built, parse_scene(press_file, "press.toml"));
}

// Every kind of coupling, in a file and in code; ground and a few bodies that are free where they need not be held.
constexpr const char* couplings_file = R"(
title = "couplings"
[units]
length = "mm"
angle = "deg"
[ground]
points = { O = [0, 0], A = [100, 0], R = [0, -30], S = [0, 200], T = [0, 40] }
[body.a]
points = { O = [0, 0], O2 = [0, 9], O3 = [9, 0] }
[body.b]
points = { A = [0, 0] }
[body.arm]
points = { O = [0, 0], P = [20, 0], L = [30, 5] }
[body.rack]
points = { R = [0, 0], Q = [10, 10] }
[body.bead]
points = { P = [0, 0] }
[body.wheel]
points = { C = [0, 0] }
[[pin]]
points = ["ground.O", "a.O"]
[[pin]]
points = ["ground.A", "b.A"]
[[pin]]
points = ["ground.O", "arm.O"]
[[slide]]
name = "guide"
points = ["ground.R", "rack.R"]
axis = [1, 0]
angle = 0
[[gear]]
name = "mesh"
bodies = ["a", "b"]
ratio = 0.5
internal = true
pressure_angle = 20
[[gear]]
bodies = ["a", "b"]
carrier = "arm"
ratio = 2
phase = 5
[[belt]]
bodies = ["a", "b"]
ratio = 3
crossed = true
phase = 1
[[rack]]
name = "teeth"
slide = "guide"
pinion = "a"
radius = 30
pressure_angle = 15
[[geneva]]
name = "index"
bodies = ["a", "b"]
slots = 5
phase = 10
[[coupling]]
name = "sum"
sum = [{ factor = 2, slide = "guide" }, { factor = -1, bodies = ["ground", "a"] }]
value = 3
[[cam]]
name = "lobe"
bodies = ["ground", "a"]
follower = { slide = "guide" }
law = [{ to = 120, law = "harmonic", lift = 1 }, { to = 180, law = "dwell" }, { to = 360, law = "cycloidal", lift = 0 }]
lift = 10
base = 40
guided = true
roller = "rack.Q"
[[cam]]
bodies = ["ground", "b"]
follower = { slide = "guide" }
curve = [[0, 0], [90, 1], [180, 0.5], [360, 0]]
lift = 4
base = 20
[[rope]]
name = "hoist"
over = ["ground.S", { pulley = "arm.L", radius = 5, turn = "clockwise" }, "bead.P"]
length = 400
[[rope]]
over = ["ground.T", "bead.P"]
stiffness = 2
free_length = 90
[[chain]]
name = "strand"
a = "arm.O"
b = "ground.T"
radius_a = 5
radius_b = 8
turn = "clockwise"
slack = true
[[circular_slot]]
pin = "bead.P"
center = "ground.O"
radius = 20
[[circular_slot]]
name = "arc"
pin = "bead.P"
center = "arm.O"
radius = 20
from = -30
to = 60
[[curved_slot]]
name = "groove"
pin = "bead.P"
at = "arm.P"
curve = [[0, 0], [10, 4], [20, 0]]
closed = true
[[rolling]]
name = "floor"
wheel = "wheel.C"
line = "ground.T"
axis = [1, 2]
radius = 15
[[rolling_on_circle]]
name = "drum"
wheel = "wheel.C"
center = "a.O"
radius = 6
circle_radius = 30
inside = true
offset = 2
[[rolling_profile]]
name = "runner"
at = "wheel.C"
curve = [[-10, 4], [0, 0], [10, 4]]
line = "ground.T"
axis = [1, 2]
from = 2
[[rolling_profile_on_circle]]
at = "wheel.C"
curve = [[10, 0], [0, 8], [-10, 0], [0, -8]]
center = "a.O"
circle_radius = 30
closed = true
[[curve_contact]]
name = "touch"
at = "wheel.C"
curve = [[10, 0], [0, 8], [-10, 0], [0, -8]]
against = "bead.P"
against_curve = [[6, 0], [0, 9], [-6, 0], [0, -9]]
radius = 0.5
[[loose_pin]]
points = ["arm.L", "bead.P"]
clearance = 0.5
[[loose_slot]]
name = "play"
points = ["rack.Q", "wheel.C"]
axis = [1, 2]
clearance = 0.1
[[contact]]
point = "bead.P"
radius = 3
segment = ["arm.O", "arm.P"]
[[contact]]
name = "cup"
point = "bead.P"
outline = ["arm.O", "arm.L", "arm.P"]
closed = true
[[contact]]
name = "pawl"
outline = ["rack.R", "rack.Q"]
against = ["arm.O", "arm.L", "arm.P"]
against_closed = true
restitution = 0.3
[[contact]]
name = "dish"
point = "bead.P"
arc = { center = "a.O", from = "a.O2", to = "a.O3", hollow = true }
[[blade]]
name = "edge"
at = "wheel.C"
angle = 30
on = "arm"
[start]
arc = 20
a = 7
)";

SceneBuilder couplings_builder() {
  SceneBuilder builder("couplings", {.length = "mm", .angle = "deg"});
  builder.ground_point("O", {0, 0})
      .ground_point("A", {100, 0})
      .ground_point("R", {0, -30})
      .ground_point("S", {0, 200})
      .ground_point("T", {0, 40})
      .body("a", {.points = {{"O", {0, 0}}, {"O2", {0, 9}}, {"O3", {9, 0}}}})
      .body("b", {.points = {{"A", {0, 0}}}})
      .body("arm", {.points = {{"O", {0, 0}}, {"P", {20, 0}}, {"L", {30, 5}}}})
      .body("rack", {.points = {{"R", {0, 0}}, {"Q", {10, 10}}}})
      .body("bead", {.points = {{"P", {0, 0}}}})
      .body("wheel", {.points = {{"C", {0, 0}}}})
      .pin("ground.O", "a.O")
      .pin("ground.A", "b.A")
      .pin("ground.O", "arm.O")
      .slide("ground.R", "rack.R", {1, 0}, "guide")
      .gear("a", "b", {{"ratio", 0.5}, {"internal", true}, {"pressure_angle", 20}}, "mesh")
      .gear("a", "b", {{"carrier", "arm"}, {"ratio", 2}, {"phase", 5}})
      .belt("a", "b", {{"ratio", 3}, {"crossed", true}, {"phase", 1}})
      .rack("guide", "a", {{"radius", 30}, {"pressure_angle", 15}}, "teeth")
      .geneva("a", "b", {{"slots", 5}, {"phase", 10}}, "index")
      .coupling(measures::sum({{2, measures::travel("guide")}, {-1, measures::angle("ground", "a")}}), {{"value", 3}},
                "sum")
      .cam("ground", "a", measures::travel("guide"),
           {{.to = 120, .law = "harmonic", .lift = 1}, {.to = 180, .law = "dwell"}, {360, "cycloidal", 0}},
           {{"lift", 10}, {"base", 40}, {"guided", true}, {"roller", "rack.Q"}}, "lobe")
      .cam("ground", "b", measures::travel("guide"), {},
           {{"curve", {{0, 0}, {90, 1}, {180, 0.5}, {360, 0}}}, {"lift", 4}, {"base", 20}})
      .rope({"ground.S", {"arm.L", 5, "clockwise"}, "bead.P"}, {{"length", 400}}, "hoist")
      .rope({"ground.T", "bead.P"}, {{"stiffness", 2}, {"free_length", 90}})
      .chain("arm.O", "ground.T", {{"radius_a", 5}, {"radius_b", 8}, {"turn", "clockwise"}, {"slack", true}}, "strand")
      .circular_slot("bead.P", "ground.O", {{"radius", 20}})
      .circular_slot("bead.P", "arm.O", {{"radius", 20}, {"from", -30}, {"to", 60}}, "arc")
      .curved_slot("bead.P", "arm.P", {{0, 0}, {10, 4}, {20, 0}}, {{"closed", true}}, "groove")
      .rolling("wheel.C", "ground.T", {1, 2}, {{"radius", 15}}, "floor")
      .rolling_on_circle("wheel.C", "a.O", {{"radius", 6}, {"circle_radius", 30}, {"inside", true}, {"offset", 2}},
                         "drum")
      .rolling_profile("wheel.C", {{-10, 4}, {0, 0}, {10, 4}}, "ground.T", {1, 2}, {{"from", 2}}, "runner")
      .rolling_profile_on_circle("wheel.C", {{10, 0}, {0, 8}, {-10, 0}, {0, -8}}, "a.O",
                                 {{"circle_radius", 30}, {"closed", true}})
      .curve_contact("wheel.C", {{10, 0}, {0, 8}, {-10, 0}, {0, -8}}, "bead.P", {{6, 0}, {0, 9}, {-6, 0}, {0, -9}},
                     {{"radius", 0.5}}, "touch")
      .loose_pin("arm.L", "bead.P", {{"clearance", 0.5}})
      .loose_slot("rack.Q", "wheel.C", {1, 2}, {{"clearance", 0.1}}, "play")
      .contact("bead.P", {"arm.O", "arm.P"}, {{"radius", 3}})
      .contact("bead.P", {"arm.O", "arm.L", "arm.P"}, {{"closed", true}}, "cup")
      .contact_of_outlines({"rack.R", "rack.Q"}, {"arm.O", "arm.L", "arm.P"},
                           {{"against_closed", true}, {"restitution", 0.3}}, "pawl")
      .contact_with_arc("bead.P", "a.O", "a.O2", "a.O3", true, {}, "dish")
      .blade("wheel.C", {{"angle", 30}, {"on", "arm"}}, "edge")
      .start("arc", 20)
      .start("a", 7);
  return builder;
}

void expect_same_measure(const Measure& built, const Measure& read) {
  EXPECT_EQ(built.kind, read.kind);
  EXPECT_EQ(built.body_a, read.body_a);
  EXPECT_EQ(built.body_b, read.body_b);
  EXPECT_EQ(built.a, read.a);
  EXPECT_EQ(built.b, read.b);
  EXPECT_EQ(built.joint, read.joint);
  EXPECT_EQ(built.axis, read.axis);
  EXPECT_EQ(built.outline, read.outline);
  ASSERT_EQ(built.contacts.size(), read.contacts.size());
  for (std::size_t k = 0; k < read.contacts.size(); ++k) {
    EXPECT_EQ(built.contacts[k].at, read.contacts[k].at);
    EXPECT_EQ(built.contacts[k].radius, read.contacts[k].radius);
    EXPECT_EQ(built.contacts[k].turn, read.contacts[k].turn);
  }
  ASSERT_EQ(built.terms.size(), read.terms.size());
  for (std::size_t k = 0; k < read.terms.size(); ++k) {
    expect_same_measure(built.terms[k].measure, read.terms[k].measure);
    EXPECT_EQ(built.terms[k].factor, read.terms[k].factor);
    EXPECT_EQ(built.terms[k].shift, read.terms[k].shift);
    EXPECT_EQ(built.terms[k].span, read.terms[k].span);
    ASSERT_EQ(built.terms[k].profile != nullptr, read.terms[k].profile != nullptr);
    if (!read.terms[k].profile) continue;
    for (const double u : {0.1, 0.4, 0.7, 0.95}) {
      EXPECT_EQ(built.terms[k].profile->at(u).value, read.terms[k].profile->at(u).value);
    }
  }
}

void expect_same_couplings(const Scene& built, const Scene& read) {
  ASSERT_EQ(built.stops.size(), read.stops.size());
  for (std::size_t s = 0; s < read.stops.size(); ++s) {
    EXPECT_EQ(built.stops[s].table, read.stops[s].table);
    EXPECT_EQ(built.stops[s].name, read.stops[s].name);
    EXPECT_EQ(built.stops[s].min, read.stops[s].min) << read.stops[s].name;
    EXPECT_EQ(built.stops[s].max, read.stops[s].max) << read.stops[s].name;
    EXPECT_EQ(built.stops[s].sense, read.stops[s].sense);
    expect_same_measure(built.stops[s].on, read.stops[s].on);
  }
  ASSERT_EQ(built.elements.size(), read.elements.size());
  for (std::size_t e = 0; e < read.elements.size(); ++e) {
    EXPECT_EQ(built.elements[e].table, read.elements[e].table);
    expect_same_measure(built.elements[e].on, read.elements[e].on);
  }
  ASSERT_EQ(built.blades.size(), read.blades.size());
  for (std::size_t b = 0; b < read.blades.size(); ++b) {
    EXPECT_EQ(built.blades[b].name, read.blades[b].name);
    EXPECT_EQ(built.blades[b].at, read.blades[b].at);
    EXPECT_EQ(built.blades[b].on, read.blades[b].on);
  }
  expect_same_numbers(built, read);
}

TEST(SceneBuilder, BuildsTheCouplingsThatTheFileReaderReads) {
  expect_same_couplings(couplings_builder().build(), parse_scene(couplings_file, "couplings.toml"));
  EXPECT_THROW(SceneBuilder("twice").gear("a", "b", {{"ratio", 1}, {"ratio", 2}}), InputError);
}

/// Functions of time of a load, a drive, a spring and the frame, in code.
SceneBuilder shaken_builder() {
  using Tables = SceneBuilder::Key::Tables;
  SceneBuilder builder("shaken");
  builder.number("w", 3.0)
      .frame("y", {{"as", "acceleration"}, {"sine.amplitude", 2.0}, {"sine.frequency", 5.0}})
      .ground_point("O", {0, 0})
      .body("block", {.points = {{"c", {0, 0}}}, .mass = 2})
      .slide("ground.O", "block.c", {1, 0}, "x")
      .element("spring", "s", measures::travel("x"),
               {{"stiffness", 5.0}, {"free_length", 1.0}, {"time.stiffness.function", "1 + 0.1*sin(w*t)"}})
      .drive("d", measures::travel("x"),
             {{"time.sum", Tables{{{"function", "t"}}, {{"ramp.to", 1.0}, {"ramp.end", 2.0}}}}});
  return builder;
}

TEST(SceneBuilder, BuildsFunctionsOfTime) {
  const Scene read = parse_scene(R"toml(
title = "shaken"
numbers = { w = 3 }
frame = { y = { as = "acceleration", sine = { amplitude = 2, frequency = 5 } } }
ground = { points = { O = [0, 0] } }
[body.block]
points = { c = [0, 0] }
mass = 2
[[slide]]
name = "x"
points = ["ground.O", "block.c"]
axis = [1, 0]
[[spring]]
name = "s"
slide = "x"
stiffness = 5
free_length = 1
time = { stiffness = { function = "1 + 0.1*sin(w*t)" } }
[[drive]]
name = "d"
slide = "x"
time = { sum = [{ function = "t" }, { ramp = { to = 1, end = 2 } }] }
)toml",
                                 "shaken.toml");
  for (const Scene& built : {shaken_builder().build(), parse_scene(shaken_builder().text(), "again.toml")}) {
    expect_same_numbers(built, read);
    ASSERT_EQ(built.time_functions.size(), read.time_functions.size());
    for (std::size_t f = 0; f < read.time_functions.size(); ++f) {
      EXPECT_EQ(built.time_functions[f].of, read.time_functions[f].of);
      EXPECT_EQ(built.time_functions[f].part, read.time_functions[f].part);
      EXPECT_EQ(built.time_functions[f].order, read.time_functions[f].order);
      for (const double t : {0.0, 0.3, 1.7}) {
        for (const int d : {0, 1, 2}) EXPECT_EQ(built.time_functions[f].at(t, d), read.time_functions[f].at(t, d));
      }
    }
  }
}

TEST(SceneBuilder, BuildsChainsOfControllers) {
  const Scene read = parse_scene(R"toml(
title = "axis"
ground = { points = { O = [0, 0] } }
[body.block]
points = { c = [0, 0] }
mass = 2
[[slide]]
name = "x"
points = ["ground.O", "block.c"]
axis = [1, 0]
[[controller]]
name = "place"
reads = { slide = "x" }
table = { curve = [[-1, -3], [0, 0], [1, 5]] }
period = 0.1
[[controller]]
name = "rate"
slide = "x"
follows = "place"
reads = { points = ["ground.O", "block.c"], axis = [1, 0] }
reads_rate = true
transfer = { numerator = [2], denominator = [1, 0.5, 0.25] }
)toml",
                                 "axis.toml");
  SceneBuilder builder("axis");
  builder.ground_point("O", {0, 0})
      .body("block", {.points = {{"c", {0, 0}}}, .mass = 2})
      .slide("ground.O", "block.c", {1, 0}, "x")
      .element("controller", "place", measures::nothing(),
               {{"reads.slide", "x"}, {"table.curve", {{-1, -3}, {0, 0}, {1, 5}}}, {"period", 0.1}})
      .element("controller", "rate", measures::travel("x"),
               {{"follows", "place"},
                {"reads.points", std::vector<std::string>{"ground.O", "block.c"}},
                {"reads.axis", Vec2{1, 0}},
                {"reads_rate", true},
                {"transfer.numerator", std::vector<double>{2}},
                {"transfer.denominator", std::vector<double>{1, 0.5, 0.25}}});
  for (const Scene& built : {builder.build(), parse_scene(builder.text(), "again.toml")}) {
    expect_same_numbers(built, read);
    ASSERT_EQ(built.elements.size(), 2U);
    for (std::size_t e = 0; e < 2; ++e) {
      EXPECT_EQ(built.elements[e].feedback->acts, e == 1);
      EXPECT_EQ(built.elements[e].feedback->follows, e == 1 ? 0 : -1);
      EXPECT_EQ(built.elements[e].feedback->reads.kind, read.elements[e].feedback->reads.kind);
      EXPECT_EQ(built.elements[e].feedback->states().size(), read.elements[e].feedback->states().size());
      EXPECT_EQ(built.elements[e].feedback->output, read.elements[e].feedback->output);
    }
  }
}

TEST(SceneBuilder, WritesTheFileOfWhatItBuilds) {
  expect_same_items(press_builder().build(), parse_scene(press_builder().text(), "press.toml"));
  expect_same_couplings(couplings_builder().build(), parse_scene(couplings_builder().text(), "couplings.toml"));
}

TEST(SceneBuilder, WritesNamesAndNumbersExactly) {
  SceneBuilder builder("\"two\"\nlines, caf\u00e9 \\ ");
  builder.number("third", 1.0 / 3.0)
      .number("least", 1.2345678901234567e-49)
      .number("many", 123456789012345680.0)
      .number("twice", "2*third")
      .body("z first", {.points = {{"B", {0.1 + 0.2, -0.0}}, {"A", {1.2345678901234567e-49, -1e15}}}, .mass = 1})
      .body("a later", {.points = {{"A", {0, 0}}}, .inertia = 7})
      .section("z first", {{"area", 0.01}, {"modulus", 2e11}, {"second_moment", 1e-6}, {"height", 0.1}}, {"A", "B"})
      .ground_point("O", {0, 0})
      .pin("ground.O", "a later.A")
      .friction({{"coefficient", 0.1}, {"radius", 0.02}})
      .element("spring", "strut", measures::distance("ground.O", "z first.A"),
               {{"gas.preload", 300}, {"gas.length", 3}, {"gas.stroke", "2*third"}, {"gas.ratio", 1.35}})
      .output("height", "y.z first.B");
  const Scene read = parse_scene(builder.text(), "read.toml");
  EXPECT_EQ(read.title, "\"two\"\nlines, caf\u00e9 \\ ");
  EXPECT_EQ(read.bodies.at(1).name, "z first");
  EXPECT_EQ(read.bodies.at(1).points.at(0).at, (Vec2{0.1 + 0.2, 0.0}));
  EXPECT_TRUE(std::signbit(read.bodies.at(1).points.at(0).at.y));
  EXPECT_EQ(read.bodies.at(1).points.at(1).at, (Vec2{1.2345678901234567e-49, -1e15}));
  expect_same_numbers(builder.build(), read);
}

// The file counts from the current folder, as that of a scene in it does.
TEST(SceneBuilder, BringsPartsAsAFileDoes) {
  // Files count from the current folder.
  const std::filesystem::path before = std::filesystem::current_path();
  const std::string stage = "scissor_stage.toml";
  std::filesystem::current_path(std::filesystem::path(test::dataset("parts/" + stage)).parent_path());
  SceneBuilder builder("two stages", {.length = "mm", .angle = "deg"});
  builder.number("turn", 5)
      .ground_point("O", {0, 0})
      .body("slider", {.points = {{"S", {0, 0}}}, .mass = 1})
      .slide("ground.O", "slider.S", {1, 0}, "base")
      .part(stage,
            {{"at", Vec2{3, 4}},
             {"mirror", true},
             {"scale", 1.5},
             {"angle", "2*turn"},
             {"repeat", 2},
             {"step", std::vector<std::string>{"100*turn", "0"}},
             {"join.left", "ground.O"},
             {"join_next.left", "fall.b"},
             {"numbers.m", 7},
             {"numbers.point.ground.right.x", 1.1}},
            "stage")
      .start("base", 900);
  const Scene scene = builder.build();
  EXPECT_EQ(get_value(scene, "body.stage_2.fall.mass"), 7);
  EXPECT_EQ(get_value(scene, "point.stage_1.rise.b.x"), 1500);
  EXPECT_EQ(get_value(scene, "numbers.stage.point.ground.right.x"), 1.1);
  EXPECT_EQ(get_value(scene, "point.ground.stage_2.x"), 503);
  EXPECT_NE(builder.text().find("[[part]]\nname = \"stage\"\nfile = \""), std::string::npos);
  expect_same_numbers(scene, parse_scene(builder.text(), "stages.toml"));
  builder.part(stage, {{"angel", 3}});
  try {
    builder.build();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("two stages: part 2.angel: expected one of the keys"), std::string::npos)
        << error.what();
  }
  std::filesystem::current_path(before);
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
  EXPECT_EQ(
      error_of([](SceneBuilder& b) {
        b.element("spring", "s", measures::distance("ground.O", "rod.C"), {{"stifness", 1}, {"free_length", 1}});
      }),
      "press: spring \"s\".stifness: expected one of the keys name, points, axis, stiffness, free_length, time, acts; "
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
            "torsion_damper, friction, bump_stop, motor, controller, found \"dampr\"; did you mean \"damper\"?");
}

}  // namespace
}  // namespace poise::scene_builder_test

// URDF and MJCF: what their files mean, and scenes that come back from them.

#include <cmath>
#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "exchange/mjcf.hpp"
#include "exchange/urdf.hpp"
#include "model/scene_builder.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/modes.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/static_model.hpp"
#include "tests/exchange/robots.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/seed.hpp"

namespace poise::robot_files_test {
namespace {

using test::message_of;
using test::random_robot;
using test::RobotWish;

Scene from_mjcf(const std::string& text) { return parse_scene(import_mjcf(text, "m.xml", {}).text, "m"); }
Scene from_urdf(const std::string& text) { return parse_scene(import_urdf(text, "r.urdf", {}).text, "r"); }

std::string body(const std::string& inside) {
  return "<mujoco><compiler angle=\"radian\"/><worldbody><body name=\"a\">" + inside + "</body></worldbody></mujoco>";
}
const std::string mass = "<inertial pos=\"0.5 0 0\" mass=\"2\" diaginertia=\"0.1 0.2 0.3\"/>";
const std::string hinge = "<joint name=\"h\" axis=\"0 1 0\"/>";

// Hz, of the equilibrium next to the start; none where there is none.
std::vector<double> frequencies(const Scene& scene) {
  const StaticModel statics(scene);
  const MotionModel motion(scene);
  const Equilibrium equilibrium = solve(statics);
  std::vector<double> out;
  if (!equilibrium.found()) return out;
  for (const Vibration& one : modes_of(motion, motion_coordinates(motion, statics, equilibrium.x)).vibrations) {
    out.push_back(one.frequency);
  }
  return out;
}

int freedoms(const Scene& scene) { return analyse_mobility(StaticModel(scene)).freedoms; }

double inertia_of(const Scene& scene, const std::string& name) {
  for (const Body& one : scene.bodies) {
    if (one.name == name) return one.inertia;
  }
  return NAN;
}

// ---- what files mean

TEST(Urdf, APendulumSwingsAtItsRate) {
  const Scene scene = from_urdf(R"(<robot name="one"><link name="base"/>
 <link name="arm"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
  <inertia ixx="0.1" iyy="0.1" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
 <joint name="pin" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint></robot>)");
  const std::vector<double> found = frequencies(scene);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(2 * M_PI * found[0], std::sqrt(2 * 9.81 * 0.5 / 0.6), 1e-9);
}

TEST(Urdf, AnyPlaneIsTheSameMechanism) {
  // Two links, with gravity in the plane in which they move, seen from eight sides.
  const auto text = [](const std::string& turn) {
    return fmt::format(R"(<robot name="r"><link name="base"/><link name="tilted"/>
 <joint name="t" type="fixed"><parent link="base"/><child link="tilted"/><origin rpy="{}"/></joint>
 <link name="one"><inertial><origin xyz="0.1 0 -0.4"/><mass value="1"/><inertia ixx="1" iyy="0.2" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link>
 <joint name="j1" type="continuous"><parent link="tilted"/><child link="one"/><axis xyz="0 1 0"/><origin xyz="0 0.3 0"/></joint>
 <link name="two"><inertial><origin xyz="0.2 0 -0.3"/><mass value="2"/><inertia ixx="1" iyy="0.1" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link>
 <joint name="j2" type="continuous"><parent link="one"/><child link="two"/><axis xyz="0 -1 0"/><origin xyz="0.3 0.1 -0.8"/></joint></robot>)",
                       turn);
  };
  const std::vector<double> expected = frequencies(from_urdf(text("0 0 0")));
  ASSERT_EQ(expected.size(), 2u);
  for (const char* const turn :
       {"0 0 1", "0 0 2.5", "0 0 3.14159265358979312", "0 0 -1.2", "0 0 1.57079632679489656"}) {
    const std::vector<double> found = frequencies(from_urdf(text(turn)));
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-9 * expected[k]) << turn;
  }
}

TEST(Urdf, LimitsDampingFrictionAndSprings) {
  const Imported imported = import_urdf(R"(<robot name="r"><link name="base"/><link name="a"/><link name="b"/>
 <joint name="lift" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
  <limit lower="-0.1" upper="0.4" effort="9" velocity="1"/><dynamics damping="3" friction="0.5"/></joint>
 <joint name="turn" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/><limit lower="-1" upper="1"/>
  <dynamics damping="0.25"/><mimic joint="lift" multiplier="2" offset="0.1"/></joint>
 <gazebo reference="lift"><springStiffness>80</springStiffness><springReference>0.2</springReference></gazebo></robot>)",
                                        "r.urdf", {});
  const Scene scene = parse_scene(imported.text, "r");
  EXPECT_EQ(get_value(scene, "stop.lift.min"), -0.1);
  EXPECT_EQ(get_value(scene, "stop.lift.max"), 0.4);
  EXPECT_EQ(get_value(scene, "damper.lift.coefficient"), 3.0);
  EXPECT_EQ(get_value(scene, "slide.lift.friction.force"), 0.5);
  EXPECT_EQ(get_value(scene, "spring.lift.stiffness"), 80.0);
  EXPECT_EQ(get_value(scene, "spring.lift.free_length"), 0.2);
  EXPECT_EQ(get_value(scene, "damper.turn.coefficient"), 0.25);
  EXPECT_EQ(get_value(scene, "coupling.turn mimic.value"), 0.1);
  EXPECT_EQ(freedoms(scene), 1);
  EXPECT_NE(fmt::format("{}", fmt::join(imported.notes, " ")).find("limits of efforts"), std::string::npos);
}

TEST(Mjcf, AParallelogramHasOneFreedom) {
  const Scene scene = from_mjcf(R"(<mujoco><option gravity="0 0 -9.81"/><worldbody>
 <body name="a" pos="0 0 0"><joint type="hinge" axis="0 1 0"/><geom type="capsule" size=".01" fromto="0 0 0 0 0 1" mass="1"/>
  <body name="b" pos="0 0 1"><joint type="hinge" axis="0 1 0"/><geom type="capsule" size=".01" fromto="0 0 0 2 0 0" mass="2"/></body></body>
 <body name="c" pos="2 0 0"><joint type="hinge" axis="0 1 0"/><geom type="capsule" size=".01" fromto="0 0 0 0 0 1" mass="1"/></body></worldbody>
 <equality><connect body1="b" body2="c" anchor="2 0 0"/></equality></mujoco>)");
  const Mobility mobility = analyse_mobility(StaticModel(scene));
  EXPECT_EQ(mobility.freedoms, 1);
  EXPECT_TRUE(mobility.assembled);
  EXPECT_EQ(scene.bodies[2].mass, 2.0);
  EXPECT_NEAR(scene.bodies[2].center.x, 1.0, 1e-15);
}

TEST(Mjcf, InertiaOfSolids) {
  // About y, the normal: of unit density 1000, or of a mass.
  const auto about_y = [](const std::string& geom) { return inertia_of(from_mjcf(body(hinge + geom)), "a"); };
  EXPECT_NEAR(about_y("<geom size=\"0.1\" mass=\"5\"/>"), 0.4 * 5 * 0.01, 1e-15);
  EXPECT_NEAR(about_y("<geom size=\"0.1\"/>"), 0.4 * 1000 * 4.0 / 3 * M_PI * 1e-3 * 0.01, 1e-13);
  EXPECT_NEAR(about_y("<geom type=\"box\" size=\"0.1 0.2 0.3\" mass=\"3\"/>"), 3 * (0.01 + 0.09) / 3, 1e-15);
  EXPECT_NEAR(about_y("<geom type=\"ellipsoid\" size=\"0.1 0.2 0.3\" mass=\"5\"/>"), 0.01 + 0.09, 1e-15);
  EXPECT_NEAR(about_y("<geom type=\"cylinder\" size=\"0.1 0.3\" mass=\"12\"/>"), 3 * 0.01 + 4 * 0.09, 1e-14);
  EXPECT_NEAR(about_y("<geom type=\"cylinder\" size=\"0.1\" fromto=\"0 -0.3 0 0 0.3 0\" mass=\"2\"/>"), 0.01, 1e-15);
  // The ends of a capsule alone are a sphere; far apart they are two points.
  EXPECT_NEAR(about_y("<geom type=\"capsule\" size=\"0.1 0\" mass=\"5\"/>"), 0.4 * 5 * 0.01, 1e-15);
  const double thin = about_y("<geom type=\"capsule\" size=\"1e-6 0.5\" mass=\"12\"/>");
  EXPECT_NEAR(thin, 1.0, 1e-5);
  // Two spheres of 1 kg, 2 m apart.
  EXPECT_NEAR(about_y("<geom size=\"1e-9\" pos=\"1 0 0\" mass=\"1\"/><geom size=\"1e-9\" pos=\"-1 0 0\" mass=\"1\"/>"),
              2.0, 1e-12);
}

TEST(Mjcf, OrientationsThatAreTheSame) {
  // The tensor turned by 30 degrees about z, then the body about x so that the hinge is along y.
  const auto inertia = [](const std::string& turn) {
    return inertia_of(from_mjcf("<mujoco><worldbody><body name=\"a\"><joint axis=\"0 1 0\"/><inertial pos=\"0 0 0\" " +
                                turn + " mass=\"1\" diaginertia=\"1 2 3\"/></body></worldbody></mujoco>"),
                      "a");
  };
  const double c = std::cos(M_PI / 6), s = std::sin(M_PI / 6);
  const double expected = 1 * s * s + 2 * c * c;
  EXPECT_NEAR(inertia("euler=\"0 0 30\""), expected, 1e-12);
  EXPECT_NEAR(inertia("axisangle=\"0 0 2 30\""), expected, 1e-12);
  EXPECT_NEAR(inertia(fmt::format("quat=\"{} 0 0 {}\"", std::cos(M_PI / 12), std::sin(M_PI / 12))), expected, 1e-12);
  EXPECT_NEAR(inertia(fmt::format("xyaxes=\"{} {} 0 {} {} 0\"", 2 * c, 2 * s, -s, c)), expected, 1e-12);
  EXPECT_NEAR(inertia("zaxis=\"0 1 0\""), 3.0, 1e-12);
  // Axes that turn with the frame, and axes that stay.
  const auto ordered = [](const std::string& order, const std::string& angles) {
    return inertia_of(from_mjcf("<mujoco><compiler eulerseq=\"" + order + "\"/><worldbody><body name=\"a\">" +
                                "<joint axis=\"0 1 0\"/><inertial pos=\"0 0 0\" euler=\"" + angles +
                                "\" mass=\"1\" diaginertia=\"1 2 3\"/></body></worldbody></mujoco>"),
                      "a");
  };
  EXPECT_NEAR(ordered("xyz", "20 30 40"), ordered("ZYX", "40 30 20"), 1e-12);
  EXPECT_GT(std::abs(ordered("xyz", "20 30 40") - ordered("XYZ", "20 30 40")), 1e-3);
}

TEST(Mjcf, DefaultsAreOfClasses) {
  const Scene scene = from_mjcf(R"(<mujoco><compiler angle="radian"/>
 <default><joint axis="0 1 0" damping="1"/><default class="stiff"><joint stiffness="7" range="-1 2"/>
  <default class="stiffer"><joint stiffness="9"/></default></default></default>
 <worldbody><body name="a"><joint name="h"/><geom size="0.1"/>
  <body name="b" childclass="stiff" pos="1 0 0"><joint name="i"/><geom size="0.1"/>
   <body name="c" pos="1 0 0"><joint name="k" class="stiffer" damping="3"/><geom size="0.1"/></body></body></body></worldbody></mujoco>)");
  EXPECT_EQ(get_value(scene, "damper.h.coefficient"), 1.0);
  EXPECT_EQ(get_value(scene, "damper.i.coefficient"), 1.0);
  EXPECT_EQ(get_value(scene, "spring.i.stiffness"), 7.0);
  EXPECT_EQ(get_value(scene, "stop.i.max"), 2.0);
  EXPECT_EQ(get_value(scene, "damper.k.coefficient"), 3.0);
  EXPECT_EQ(get_value(scene, "spring.k.stiffness"), 9.0);
  EXPECT_EQ(get_value(scene, "stop.k.min"), -1.0);
  EXPECT_EQ(scene.elements.size(), 5u);
}

TEST(Mjcf, AnglesAreInDegreesUnlessSaid) {
  const std::string inside =
      "<joint name=\"h\" axis=\"0 1 0\" range=\"-90 45\" stiffness=\"2\" springref=\"30\"/>" + mass;
  const Scene scene = from_mjcf("<mujoco><worldbody><body name=\"a\">" + inside + "</body></worldbody></mujoco>");
  EXPECT_NEAR(get_value(scene, "stop.h.min"), -M_PI / 2, 1e-15);
  EXPECT_NEAR(get_value(scene, "spring.h.free_angle"), M_PI / 6, 1e-15);
  EXPECT_EQ(get_value(from_mjcf(body(inside)), "stop.h.min"), -90.0);
}

// An armature adds its inertia to that of the joint's rate, whatever the joint hangs on: I w'' = torque on a hinge.
TEST(Mjcf, AnArmatureIsInertiaOfTheJoint) {
  const auto rate = [](double armature) {
    return frequencies(
               from_mjcf(body(fmt::format("<joint axis=\"0 1 0\" armature=\"{}\" stiffness=\"50\"/>", armature) +
                              "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 2 3\"/>")))
        .at(0);
  };
  EXPECT_NEAR(2 * M_PI * rate(0), std::sqrt(50.0 / 2), 1e-9);
  EXPECT_NEAR(2 * M_PI * rate(0.5), std::sqrt(50.0 / 2.5), 1e-9);
  // The armature of a slide is a mass without weight.
  const Scene slide =
      from_mjcf(body("<joint type=\"slide\" axis=\"0 0 1\" armature=\"3\" stiffness=\"50\"/>"
                     "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 2 3\"/>"));
  EXPECT_NEAR(2 * M_PI * frequencies(slide).at(0), std::sqrt(50.0 / 4), 1e-9);
}

TEST(Mjcf, GravityGivesTheAxes) {
  // It is along -y wherever it lies in the plane; across the plane it is left out.
  const auto gravity = [](const std::string& given) {
    return from_mjcf("<mujoco><option gravity=\"" + given + "\"/><worldbody><body name=\"a\">" + hinge + mass +
                     "</body></worldbody></mujoco>")
        .gravity;
  };
  EXPECT_EQ(gravity("0 0 -9.81"), (Vec2{0.0, -9.81}));
  EXPECT_EQ(gravity("3 0 0"), (Vec2{0.0, -3.0}));
  EXPECT_NEAR(gravity("3 7 -4").y, -5.0, 1e-14);
  EXPECT_EQ(gravity("0 -9.81 0"), (Vec2{0.0, 0.0}));
}

// ---- what is refused

TEST(RobotFiles, WhatLeavesThePlaneIsNamed) {
  const auto mjcf = [](const std::string& text) { return message_of([&] { import_mjcf(text, "m.xml", {}); }); };
  EXPECT_EQ(mjcf(body(hinge + mass + "\n<body name=\"b\"><joint name=\"k\" axis=\"1 1 0\"/>" + mass + "</body>")),
            "m.xml:2: joint \"k\": expected an axis parallel to that of joint \"h\", found one at 45 degrees to it; "
            "Poise models planar mechanisms");
  EXPECT_EQ(
      mjcf(body(hinge + mass + "\n<body name=\"b\"><joint name=\"k\" type=\"slide\" axis=\"0 1 0\"/>" + mass +
                "</body>")),
      "m.xml:2: joint \"k\": expected a slide in the plane across the axis of joint \"h\", found one at 90 degrees "
      "to that plane; Poise models planar mechanisms");
  EXPECT_EQ(mjcf(body("<joint type=\"ball\"/>" + mass)),
            "m.xml:1: joint.type: expected hinge, slide or free, found \"ball\"; Poise models planar mechanisms");
}

TEST(RobotFiles, AnglesAreNotAddedToLengths) {
  EXPECT_EQ(
      message_of([] {
        import_mjcf("<mujoco><worldbody><body><joint name=\"h\" axis=\"0 1 0\"/>" + mass +
                        "<body><joint name=\"s\" type=\"slide\"/>" + mass +
                        "</body></body></worldbody>\n<tendon><fixed name=\"t\" stiffness=\"1\"><joint joint=\"h\" "
                        "coef=\"1\"/><joint joint=\"s\" coef=\"2\"/></fixed></tendon></mujoco>",
                    "m.xml", {});
      }),
      "m.xml:2: tendon \"t\": expected joints that all turn or all slide, found both; Poise adds them only where an "
      "equality holds the sum");
}

TEST(RobotFiles, BadInputIsOneLine) {
  const auto mjcf = [](const std::string& text) { return message_of([&] { import_mjcf(text, "m.xml", {}); }); };
  const auto urdf = [](const std::string& text) { return message_of([&] { import_urdf(text, "r.urdf", {}); }); };
  EXPECT_EQ(mjcf(body("<joint axis=\"0 x 0\"/>" + mass)), "m.xml:1: joint.axis: expected a number, found \"x\"");
  EXPECT_EQ(mjcf(body("<joint axis=\"0 1\"/>" + mass)), "m.xml:1: joint.axis: expected 3 numbers, found \"0 1\"");
  EXPECT_EQ(mjcf(body("<joint axis=\"0 0 0\"/>" + mass)), "m.xml:1: joint.axis: expected a direction, found 0 0 0");
  EXPECT_EQ(mjcf(body(hinge + hinge + mass)), "m.xml:1: joint \"h\": expected a name of its own, it is there twice");
  EXPECT_EQ(
      mjcf(body(hinge + "<geom type=\"mesh\" mesh=\"m\"/>")),
      "m.xml:1: geom.type: expected sphere, capsule, cylinder, box or ellipsoid, found \"mesh\", whose mass is not "
      "known here; give its body an inertial");
  EXPECT_EQ(mjcf("<mujoco><worldbody><body><joint class=\"arms\"/></body></worldbody></mujoco>"),
            "m.xml:1: joint.class: expected a class of <default>, found \"arms\"; there is none here");
  EXPECT_EQ(mjcf("<mujoco><include file=\"x.xml\"/></mujoco>"),
            "m.xml:1: include: expected one file, found another that it includes; put both into one");
  EXPECT_EQ(mjcf("<robot/>"), "m.xml:1: expected the element <mujoco>, found <robot>");
  EXPECT_EQ(urdf("<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>\n<joint name=\"j\" type=\"floating\">"
                 "<parent link=\"a\"/><child link=\"b\"/></joint></robot>"),
            "r.urdf:2: joint \"j\": expected a joint that stays in the plane, found a floating one; make it planar");
  EXPECT_EQ(urdf("<robot name=\"r\"><link name=\"arm\"/><link name=\"b\"/>\n<joint name=\"j\" type=\"fixed\">"
                 "<parent link=\"amr\"/><child link=\"b\"/></joint></robot>"),
            "r.urdf:2: joint \"j\".parent: expected the name of a link, found \"amr\"; did you mean \"arm\"?");
  EXPECT_EQ(
      urdf("<robot name=\"r\"><link name=\"a\"/>\n<link name=\"b\"/></robot>"),
      "r.urdf:2: link \"b\": expected one link without a parent, found two, \"a\" and this one; join it by a joint");
  EXPECT_EQ(urdf("<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>\n<joint name=\"j\" type=\"revolute\">"
                 "<parent link=\"a\"/><child link=\"b\"/></joint></robot>"),
            "r.urdf:2: joint \"j\": expected a <limit> of a revolute joint, found none");
  // A matrix that is filled by halves would end the program, where assertions are on.
  EXPECT_EQ(
      urdf("<robot name=\"r\"><link name=\"a\"/><link name=\"b\"><inertial><mass value=\"1\"/>\n<inertia ixx=\"1\" "
           "iyy=\"z\"/></inertial></link><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/>"
           "<child link=\"b\"/></joint></robot>"),
      "r.urdf:2: link \"b\".inertial.inertia.iyy: expected a number, found \"z\"");
  EXPECT_EQ(message_of([] { import_urdf("<robot/>", "r.urdf", {.length = "mm"}); }),
            "--units: expected no unit of URDF, which is in metres");
}

TEST(RobotFiles, WhatAFormatDoesNotHaveIsNamed) {
  SceneBuilder builder("arm");
  builder.ground_point("O", {0, 0})
      .body("arm", {.points = {{"O", {0, 0}}, {"B", {1, 0}}}, .mass = 1})
      .pin("ground.O", "arm.O");
  SceneBuilder loop("loop");
  loop.ground_point("O", {0, 0}).ground_point("Q", {1, 0});
  loop.body("a", {.points = {{"O", {0, 0}}, {"B", {0, 1}}}, .mass = 1})
      .body("b", {.points = {{"Q", {0, 0}}, {"B", {-1, 1}}}});
  loop.pin("ground.O", "a.O").pin("ground.Q", "b.Q").pin("a.B", "b.B", "knee");
  const auto message = [](auto write, const SceneBuilder& made) {
    const Scene scene = made.build();
    return message_of([&] { write(scene, test::poses_at_start(scene)); });
  };
  EXPECT_EQ(message(export_urdf, loop),
            "loop: pin \"knee\": URDF has trees of links only, and this closes a loop; write MJCF (--mjcf FILE)");
  EXPECT_EQ(message(export_mjcf, loop), "");
  builder.force("P", "arm.B", {0, 1});
  EXPECT_EQ(message(export_mjcf, builder), "arm: force \"P\": MJCF has no loads; leave it out of the scene");
}

// ---- there and back

// Bodies keep their names: what each does when the mechanism is released, and how the whole swings about its
// equilibrium, is the same.
void expect_same(const Scene& before, const Scene& after, const std::string& text) {
  ASSERT_EQ(freedoms(before), freedoms(after)) << text;
  const std::vector<BodyMotion> expected = test::released(before), found = test::released(after);
  std::map<std::string, const BodyMotion*> by_name;
  for (std::size_t k = 1; k < after.bodies.size(); ++k) by_name[after.bodies[k].name] = &found[k];
  double size = 1.0;
  for (const BodyMotion& one : expected) size = std::max(size, std::abs(one.angular_acceleration));
  for (std::size_t k = 1; k < before.bodies.size(); ++k) {
    ASSERT_TRUE(by_name.contains(before.bodies[k].name)) << before.bodies[k].name << text;
    EXPECT_NEAR(by_name[before.bodies[k].name]->angular_acceleration, expected[k].angular_acceleration, 1e-9 * size)
        << before.title << ' ' << before.bodies[k].name << '\n'
        << text;
  }
}

Scene back_by_mjcf(const Scene& scene, std::string& text) {
  text = export_mjcf(scene, test::poses_at_start(scene)).text;
  return from_mjcf(text);
}

TEST(RobotFiles, ScenesComeBackFromMjcf) {
  for (int k = 0; k < test::cases(60, 600); ++k) {
    const Scene scene = random_robot(test::seed(100 + static_cast<std::uint64_t>(k)),
                                     {.loops = k % 3, .lines = k % 2 == 0, .free_body = k % 7 == 0});
    std::string text;
    const Scene back = back_by_mjcf(scene, text);
    expect_same(scene, back, text);
    if (HasFailure()) return;
  }
}

TEST(RobotFiles, ScenesComeBackFromUrdf) {
  for (int k = 0; k < test::cases(40, 400); ++k) {
    const Scene scene =
        random_robot(test::seed(300 + static_cast<std::uint64_t>(k)), {.free_body = k % 7 == 0, .at_zero = true});
    const std::string text = export_urdf(scene, test::poses_at_start(scene)).text;
    expect_same(scene, from_urdf(text), text);
    if (HasFailure()) return;
  }
}

TEST(RobotFiles, FrequenciesStay) {
  int swinging = 0;
  for (int k = 0; k < test::cases(20, 200); ++k) {
    const Scene scene = random_robot(test::seed(500 + static_cast<std::uint64_t>(k)),
                                     {.loops = k % 2, .lines = true, .friction = false});
    std::string text;
    const Scene back = back_by_mjcf(scene, text);
    const std::vector<double> expected = frequencies(scene), found = frequencies(back);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i], expected[i], 1e-9 * std::max(1.0, expected[i])) << text;
      swinging += expected[i] > 0.0 ? 1 : 0;
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(swinging, 20);
}

}  // namespace
}  // namespace poise::robot_files_test

// Sections of bodies and loads along them, as scene files have them.

#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "model/scene.hpp"
#include "model/scene_builder.hpp"
#include "tests/support/message_of.hpp"

namespace poise::read_section_test {
namespace {

std::string with_section(const std::string& section) {
  return "[units]\nlength = \"mm\"\nforce = \"kN\"\n[ground]\npoints = { O = [0, 0] }\n[body.arm]\n"
         "points = { A = [0, 0], B = [500, 0], C = [500, 200] }\n[body.arm.section]\n" +
         section;
}

std::string message(const std::string& text) {
  return test::message_of([&] { parse_scene(text, "arm.toml"); });
}

TEST(ReadSection, InTheUnitsOfTheScene) {
  const Scene scene = parse_scene(
      with_section("area = 764\nsecond_moment = 801e3\nmodulus = 210\nheight = 80\nleft = 30\nline = [\"C\", \"B\"]\n"),
      "");
  const CrossSection& section = scene.bodies[1].section.value();
  EXPECT_NEAR(section.area, 764e-6, 1e-18);
  EXPECT_NEAR(section.second_moment, 801e-9, 1e-20);
  EXPECT_NEAR(section.modulus, 210e9, 1e-3);
  EXPECT_NEAR(section.to_left(), 0.03, 1e-15);
  EXPECT_NEAR(section.to_right(), 0.05, 1e-15);
  EXPECT_EQ(section.line, (std::vector{2, 1}));
  EXPECT_NEAR(get_value(scene, "body.arm.section.second_moment"), 801e3, 1e-9);
  Scene other = scene;
  set_value(other, "body.arm.section.modulus", 70);
  EXPECT_NEAR(other.bodies[1].section->modulus, 70e9, 1e-3);
  EXPECT_EQ(parameter(scene, "body.arm.section.second_moment").dimension.unit_name(scene.units), "mm⁴");
}

TEST(ReadSection, ScalingIsUndone) {
  const Scene scene =
      parse_scene(with_section("profile = \"IPE 80\"\nmodulus = 210\nline = [\"A\", \"B\", \"C\"]\n"), "");
  const Scene scaled_scene = scaled(scene, {.length = 0.25, .force = 512.0});
  const CrossSection& before = *scene.bodies[1].section;
  const CrossSection& after = *scaled_scene.bodies[1].section;
  EXPECT_EQ(after.second_moment, before.second_moment * 256);
  EXPECT_EQ(after.modulus, before.modulus / 512 / 16);
}

TEST(ReadSection, RolledSectionsAgreeWithTheTables) {
  // Areas in cm^2 and second moments in cm^4 as tables of EN 10365 print them.
  const struct {
    const char* name;
    double area, second_moment, height;
  } printed[] = {{"IPE 80", 7.64, 80.1, 80},    {"IPE 100", 10.3, 171, 100},    {"IPE 140", 16.4, 541, 140},
                 {"IPE 200", 28.5, 1943, 200},  {"IPE 240", 39.1, 3892, 240},   {"IPE 300", 53.8, 8356, 300},
                 {"IPE 400", 84.5, 23130, 400}, {"IPE 600", 156.0, 92080, 600}, {"HEA 100", 21.2, 349.2, 96},
                 {"HEA 160", 38.8, 1673, 152},  {"HEA 200", 53.8, 3692, 190},   {"HEB 100", 26.0, 449.5, 100},
                 {"HEB 160", 54.3, 2492, 160},  {"HEB 200", 78.1, 5696, 200}};
  for (const auto& row : printed) {
    const Scene scene = parse_scene(
        with_section("profile = \"" + std::string(row.name) + "\"\nmodulus = 210\nline = [\"A\", \"B\"]\n"), "");
    const CrossSection& section = *scene.bodies[1].section;
    EXPECT_NEAR(section.area * 1e4, row.area, 0.006 * row.area) << row.name;
    EXPECT_NEAR(section.second_moment * 1e8, row.second_moment, 0.0007 * row.second_moment) << row.name;
    EXPECT_NEAR(section.height * 1e3, row.height, 1e-9) << row.name;
  }
}

TEST(ReadSection, Shapes) {
  const auto section = [](const std::string& profile) {
    return *parse_scene(with_section("profile = \"" + profile + "\"\nmodulus = 210\nline = [\"A\", \"B\"]\n"), "")
                .bodies[1]
                .section;
  };
  EXPECT_NEAR(section("rectangle 10x20").area, 200e-6, 1e-18);
  EXPECT_NEAR(section("rectangle 10x20").second_moment, 10 * 8000 / 12.0 * 1e-12, 1e-22);
  EXPECT_NEAR(section("round 20").second_moment, M_PI * 160000 / 64 * 1e-12, 1e-22);
  EXPECT_NEAR(section("tube 20x2").area, M_PI / 4 * (400 - 256) * 1e-6, 1e-18);
  EXPECT_NEAR(section("box 40x60x3").second_moment, (40 * 216000 - 34 * 157464) / 12.0 * 1e-12, 1e-20);
  EXPECT_NEAR(section("box 40x60x3").height, 0.06, 1e-15);
}

TEST(ReadSection, SaysWhatIsWrong) {
  const std::string rest = "modulus = 210\nline = [\"A\", \"B\"]\n";
  EXPECT_EQ(message(with_section("profile = \"IPE 81\"\n" + rest)).substr(0, 54),
            "arm.toml:9: body.arm.section.profile: expected a profi");
  EXPECT_NE(message(with_section("profile = \"IPE 81\"\n" + rest)).find("did you mean \"IPE 80\""), std::string::npos);
  EXPECT_NE(message(with_section("profile = \"tube 20\"\n" + rest)).find("expected \"tube DxT\" with positive numbers"),
            std::string::npos);
  EXPECT_NE(message(with_section("profile = \"tube 20x10\"\n" + rest)).find("thinner than half"), std::string::npos);
  EXPECT_NE(message(with_section("area = 3\n" + rest)).find("expected the key second_moment"), std::string::npos);
  EXPECT_NE(
      message(with_section("profile = \"IPE 80\"\nmodulus = 2\n")).find("expected the key line, because \"arm\" has 3"),
      std::string::npos);
  EXPECT_NE(message(with_section("profile = \"IPE 80\"\nmodulus = 2\nline = [\"A\", \"D\"]\n"))
                .find("expected a point of \"arm\""),
            std::string::npos);
  EXPECT_NE(
      message(with_section("profile = \"IPE 80\"\nmodulus = 2\nline = [\"A\", \"A\"]\n")).find("every point once"),
      std::string::npos);
  EXPECT_NE(message(with_section("profile = \"IPE 80\"\nmodulus = 2\nline = [\"A\"]\n")).find("two points or more"),
            std::string::npos);
  EXPECT_NE(
      message(with_section("profile = \"IPE 80\"\nleft = 90\n" + rest)).find("section.left: expected left <= height"),
      std::string::npos);
  EXPECT_NE(message(with_section("profile = \"IPE 80\"\nelements = 9\n" + rest)).find("expected one of the keys"),
            std::string::npos);
}

TEST(ReadSection, IsRewritten) {
  const std::string text = with_section("profile = \"IPE 80\"\nmodulus = 210\nline = [\"A\", \"B\"]\n");
  Scene scene = parse_scene(text, "arm.toml");
  set_value(scene, "body.arm.section.modulus", 70);
  set_value(scene, "body.arm.section.height", 90);
  const std::string written = rewritten_scene(text, "arm.toml", scene);
  const Scene read = parse_scene(written, "arm.toml");
  EXPECT_EQ(read.bodies[1].section->modulus, scene.bodies[1].section->modulus);
  EXPECT_EQ(read.bodies[1].section->height, scene.bodies[1].section->height);
}

const std::string with_loads = with_section("profile = \"IPE 80\"\nmodulus = 210\nline = [\"A\", \"B\"]\n") + R"(
[[pin]]
points = ["ground.O", "arm.A"]
[[distributed_load]]
name = "q"
points = ["arm.A", "arm.B"]
vector = [3, -4]
[[force]]
name = "P"
at = "arm.B"
vector = [1, 0]
)";

TEST(ReadDistributedLoad, IsAForcePerLength) {
  Scene scene = parse_scene(with_loads, "");
  ASSERT_EQ(scene.forces.size(), 2U);
  EXPECT_NEAR(get_value(scene, "load.q"), 5, 1e-12);
  EXPECT_EQ(parameter(scene, "load.q").dimension.unit_name(scene.units), "kN/mm");
  EXPECT_NEAR(scene.size_of(scene.forces[1]), 5e6 * 0.5, 1e-6);
  EXPECT_NEAR(scene.size_of(scene.forces[0]), 1000, 1e-9);
  set_value(scene, "load.q", 2.5);
  const Scene read = parse_scene(rewritten_scene(with_loads, "arm.toml", scene), "arm.toml");
  EXPECT_EQ(read.forces[1].vector, scene.forces[1].vector);
  EXPECT_EQ(read.forces[0].vector, scene.forces[0].vector);
}

TEST(ReadDistributedLoad, SaysWhatIsWrong) {
  const auto changed = [](std::string from, const std::string& to) {
    std::string text = with_loads;
    text.replace(text.find(from), from.size(), to);
    return message(text);
  };
  EXPECT_NE(changed("\"arm.A\", \"arm.B\"]\nvector", "\"arm.A\", \"ground.O\"]\nvector").find("two points of one body"),
            std::string::npos);
  EXPECT_NE(changed("\"arm.A\", \"arm.B\"]\nvector", "\"arm.A\", \"arm.A\"]\nvector").find("two points that are apart"),
            std::string::npos);
  EXPECT_NE(changed("name = \"P\"", "name = \"q\"").find("taken"), std::string::npos);
}

TEST(SceneBuilderSection, IsReadAsFromAFile) {
  const Scene scene = SceneBuilder("arm")
                          .ground_point("O", {0, 0})
                          .body("arm", {.points = {{"A", {0, 0}}, {"B", {2, 0}}, {"C", {2, 1}}}})
                          .section("arm", {{"profile", "IPE 80"}, {"modulus", 2.1e11}}, {"A", "B", "C"})
                          .pin("ground.O", "arm.A")
                          .distributed_load("q", "arm.A", "arm.B", {0, -3})
                          .build();
  EXPECT_EQ(scene.bodies[1].section->line.size(), 3U);
  EXPECT_NEAR(scene.size_of(scene.forces.at(0)), 6.0, 1e-14);
  EXPECT_THROW(SceneBuilder("arm").section("arm", {}), InputError);
}

}  // namespace
}  // namespace poise::read_section_test

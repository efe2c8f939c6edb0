// Scenes written back into their files.

#include "model/rewritten_scene.hpp"

#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "model/dependent_number.hpp"
#include "model/parameters.hpp"
#include "model/text_file.hpp"
#include "tests/support/message_of.hpp"

namespace poise::rewritten_scene_test {
namespace {

/// Reading the text gives the numbers of `wanted`, to the rounding of units.
void expect_reads_back(const std::string& text, const Scene& wanted) {
  const Scene back = parse_scene(text, wanted.file);
  for (const ParameterRow& row : parameter_table(wanted)) {
    const std::optional<double> expected = value_at(wanted, row.place), found = value_at(back, row.place);
    ASSERT_EQ(expected.has_value(), found.has_value()) << row.path.text();
    if (!expected || *expected == *found) continue;
    EXPECT_NEAR(*found, *expected, 1e-15 * std::abs(*expected)) << row.path.text();
  }
}

std::string changed(const std::string& text, const std::vector<std::pair<std::string, double>>& numbers) {
  Scene scene = parse_scene(text, "scene.toml");
  for (const auto& [path, value] : numbers) set_value(scene, path, value);
  const std::string out = rewritten_scene(text, "scene.toml", scene);
  expect_reads_back(out, scene);
  return out;
}

constexpr const char* arm = R"(# An arm. é
gravity = [0, -9.81]  # m/s2
ground.points = { O = [0, 0] }

[body."long arm"]
points = { O = [0, 0], "é" = [1.0, +2e-1] }   # tip
mass = 0x10 # hexadecimal
center = [
  0.5,  # half way
  0,
]

[[pin]]
points = ["ground.O", "long arm.O"]

[[torsion_spring]]
bodies = ["ground", "long arm"]
stiffness = 1_000.5
)";

TEST(RewrittenScene, ChangesNumbersInPlace) {
  std::string expected = arm;
  const auto replace = [&](const std::string& from, const std::string& to) {
    expected.replace(expected.find(from), from.size(), to);
  };
  replace("-9.81", "-9.7");
  replace("+2e-1", "0.3");
  replace("0x10", "2.5");
  replace("0.5,  #", "0.1,  #");
  replace("1_000.5", "1e+20");
  EXPECT_EQ(changed(arm, {{"gravity.y", -9.7},
                          {"point.long arm.é.y", 0.3},
                          {"body.long arm.mass", 2.5},
                          {"body.long arm.center.x", 0.1},
                          {"torsion_spring.torsion spring 1.stiffness", 1e20}}),
            expected);
  EXPECT_EQ(changed(arm, {}), arm);
}

TEST(RewrittenScene, AddsNumbersThatWereLeftToTheirDefaults) {
  const std::string out = changed(
      arm,
      {{"body.long arm.inertia", 0.1}, {"torsion_spring.torsion spring 1.free_angle", 0.2}, {"start.long arm", 0.3}});
  EXPECT_NE(out.find("  0,\n]\ninertia = 0.1\n\n[[pin]]"), std::string::npos) << out;
  EXPECT_NE(out.find("stiffness = 1_000.5\nfree_angle = 0.2\n"), std::string::npos) << out;
  EXPECT_NE(out.find("\n[start]\n\"long arm\" = 0.3\n"), std::string::npos) << out;
}

TEST(RewrittenScene, AddsThemHoweverATableIsWritten) {
  const std::string rest = R"(
pin = [{ points = ["ground.O", "arm.O"] }]
)";
  const std::vector<std::pair<std::string, double>> numbers = {
      {"body.arm.mass", 2.0}, {"body.arm.center.y", 0.5}, {"gravity.x", 1.5}};
  for (const std::string body : {
           "ground.points.O = [0, 0]\nbody.arm.points = { O = [0, 0] }",
           "ground.points.O = [0, 0]\n  body . 'arm' . points.O = [0, 0] # here",
           "ground.points.O = [0, 0]\nbody = { \"arm\".points = { O = [0, 0] } }",
           "ground.points.O = [0, 0]\nbody = { arm = { points = { O = [0, 0] } } }",
           "ground = { points = { O = [0, 0] } }\nbody.arm = { inertia = 1, points.O = [\n0, 0] }",
       }) {
    SCOPED_TRACE(body);
    changed(body + rest, numbers);
  }
  const std::string headers = R"([ground.points]
O = [0, 0]
[body.arm.points]
O = [0, 0]
[[pin]]
points = ["ground.O", "arm.O"]
[body.idle] # without a key
[[torsion_spring]]
bodies = ["ground", "arm"]
stiffness = 1)";
  const std::string out = changed(
      headers, {{"body.arm.mass", 2.0}, {"body.idle.mass", 3.0}, {"torsion_spring.torsion spring 1.free_angle", 1.0}});
  EXPECT_NE(out.find("without a key\nmass = 3.0\n"), std::string::npos) << out;
  std::string windows = arm;
  for (std::size_t at = 0; (at = windows.find('\n', at)) != std::string::npos; at += 2) windows.insert(at, 1, '\r');
  EXPECT_NE(changed("\xEF\xBB\xBF" + windows, {{"body.long arm.inertia", 1.0}}).find("]\r\ninertia = 1.0\r\n"),
            std::string::npos);
}

TEST(RewrittenScene, KeepsTheUnitsOfTheFile) {
  const std::string out = changed(std::string("units = { length = \"mm\", angle = \"deg\", force = \"lbf\" }\n") + arm,
                                  {{"torsion_spring.torsion spring 1.free_angle", 12.3},
                                   {"torsion_spring.torsion spring 1.stiffness", 45.6},
                                   {"point.long arm.é.x", 7.89}});
  EXPECT_NE(out.find("7.89, +2e-1"), std::string::npos) << out;
}

TEST(RewrittenScene, RefusesATextThatIsNoLongerThatOfTheScene) {
  const Scene scene = parse_scene(arm, "scene.toml");
  std::string other = arm;
  other.insert(other.find("[[pin]]"), "[body.more]\n");
  EXPECT_THROW(rewritten_scene(other, "scene.toml", scene), InputError);
}

/// Of every scene: numbers that `changes` chooses, changed at random.
void expect_all_scenes_read_back(const std::function<bool(const Scene&, const ParameterRow&)>& changes) {
  int scenes = 0;
  for (const char* folder : {"datasets", "datasets/hard", "datasets/structures"}) {
    for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(POISE_SOURCE_DIR) / folder)) {
      if (file.path().extension() != ".toml") continue;
      const std::string text = read_text_file(file.path());
      Scene scene;
      try {
        scene = parse_scene(text, file.path().string());
      } catch (const InputError&) {
        continue;  // an experiment or a design
      }
      SCOPED_TRACE(file.path());
      std::mt19937_64 random(7);
      std::uniform_real_distribution<double> factor(1.1, 1.2);
      for (const ParameterRow& row : parameter_table(scene)) {
        const std::optional<double> value = value_at(scene, row.place);
        // What follows from an expression changes with named numbers.
        if (!value || dependent_number(scene, row.place) != nullptr || !changes(scene, row)) continue;
        set_value_at(scene, row.place, *value != 0.0 ? *value * factor(random) : 0.1 * factor(random));
      }
      expect_reads_back(rewritten_scene(text, file.path().string(), scene), scene);
      ++scenes;
    }
  }
  EXPECT_GT(scenes, 30);
}

TEST(RewrittenScene, ReadsBackWithAllNumbersOfAllScenesChanged) {
  expect_all_scenes_read_back([](const Scene& scene, const ParameterRow& row) {
    // Limits of stops keep their order; numbers of parts of flexible links are not in the text.
    return scene.flexible_links.empty() && row.place.owner != Owner::stop &&
           (row.place.owner != Owner::force || value_at(scene, row.place) != 0.0);
  });
}

TEST(RewrittenScene, RefusesNumbersOfPartsOfFlexibleLinks) {
  const std::string file = std::string(POISE_SOURCE_DIR) + "/datasets/structures/elastica.toml";
  const std::string text = read_text_file(file);
  const Scene scene = parse_scene(text, file);
  int parts = 0;
  for (const ParameterRow& row : parameter_table(scene)) {
    const std::optional<double> value = value_at(scene, row.place);
    if (row.place.owner == Owner::start || row.place.owner == Owner::section || !value) continue;
    const std::string path = row.path.text();
    if (path.find("beam") == std::string::npos) continue;
    Scene wanted = scene;
    set_value_at(wanted, row.place, *value + 0.125);
    const std::string message = test::message_of([&] { rewritten_scene(text, file, wanted); });
    EXPECT_EQ(message.find(file + ": " + path + ": expected a number that can be written into this file"), 0U)
        << path << ": " << message;
    ++parts;
  }
  EXPECT_GT(parts, 16);
}

/// Constants of couplings that follow from the guesses stay as they are.
TEST(RewrittenScene, ReadsBackWithAllGuessesOfAllScenesChanged) {
  expect_all_scenes_read_back([](const Scene&, const ParameterRow& row) { return row.place.owner == Owner::start; });
}

}  // namespace
}  // namespace poise::rewritten_scene_test

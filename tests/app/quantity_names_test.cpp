// All names of quantities of the scenes, asked of the commands that take them.

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "statics/quantities/quantity.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/seed.hpp"

namespace poise::app_tests::quantity_names_test {
namespace {

using nlohmann::json;

/// Names of a scene, without those that hold what separates names; loads at folds only where they are wanted.
std::vector<std::string> names_of(const Scene& scene, bool folds) {
  std::vector<std::string> out;
  for (const std::string& name : quantity_names(scene)) {
    if (name.find(',') != std::string::npos || (!folds && name.starts_with("fold."))) continue;
    out.push_back(name);
  }
  return out;
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ",") + name;
  return out;
}

/// A few of them.
std::vector<std::string> some_of(std::vector<std::string> names, std::size_t most, std::mt19937& random) {
  std::shuffle(names.begin(), names.end(), random);
  names.resize(std::min(most, names.size()));
  return names;
}

/// Runs a command on a scene with names; its data, none where the scene is none for the command.
json run_on(const std::string& scene, std::vector<std::string> words, const std::string& option,
            const std::vector<std::string>& names) {
  const TempFolder folder;
  const std::string file = folder.path("out.json").string();
  words.insert(words.begin() + 1, scene);
  words.insert(words.end(), {option, listed(names), "--json", file});
  SCOPED_TRACE(testing::PrintToString(words));
  const ProgramRun run = run_poise(words);
  EXPECT_GE(run.exit_code, 0) << run.err;
  // A scene may be none for a command; a name is one for all.
  EXPECT_EQ(run.err.find(option), std::string::npos) << run.err;
  for (const char* none : {" nan", "-nan", " inf", "-inf"}) {
    EXPECT_EQ(run.out.find(none), std::string::npos) << none << " in " << run.out;
  }
  if (run.exit_code >= 2 || run.exit_code < 0) return json::object();
  const std::string written = contents(file);
  // A mechanism that cannot be assembled where it is driven has no result.
  EXPECT_TRUE(!written.empty() || run.err.find("mechanism: ") != std::string::npos) << run.out << run.err;
  return written.empty() ? json::object() : json::parse(written);
}

/// Every name once, with a value or why there is none.
void expect_values(const json& quantities, const std::vector<std::string>& names) {
  ASSERT_EQ(quantities.size(), names.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    const json& one = quantities[k];
    EXPECT_EQ(one["name"], names[k]);
    EXPECT_NE(one["value"].is_null(), one["why"].is_null()) << one;
  }
}

void expect_all_commands_answer(const std::string& name, std::mt19937& random) {
  const std::string file = test::dataset(name).string();
  const Scene scene = read_scene(file);
  const std::vector<std::string> names = names_of(scene, false);
  const json solved = run_on(file, {"solve"}, "--show", names);
  if (solved.contains("quantities")) expect_values(solved["quantities"], names);
  const std::vector<std::string> few = some_of(names, 12, random);
  const json all = run_on(file, {"equilibria", "--starts", "5", "--seconds", "0"}, "--show", few);
  for (const json& one : all.value("equilibria", json::array())) expect_values(one["quantities"], few);
  const json sensitive = run_on(file, {"sensitivity"}, "--of", few);
  for (const json& one : sensitive.value("quantities", json::array())) {
    EXPECT_TRUE(one["why"].is_null() || !one["why"].get<std::string>().empty());
    EXPECT_EQ(one["numbers"].empty(), !one["why"].is_null()) << one["name"];
  }
  const TempFolder folder;
  run_on(file,
         {"tolerance", "--samples", "20", "--tolerances",
          folder.write("t.toml", "[tolerances]\n\"point.*\" = { percent = 0.01 }\n")},
         "--of", few);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const std::string drive = "angle." + scene.bodies[i].name;
    const auto start = scene.start.angle[i];
    if (!start || drive.find('=') != std::string::npos) continue;
    const double from = *start / scene.units.angle, to = from + 0.05 / scene.units.angle;
    const json path =
        run_on(file, {"path", "--vary", drive + "=" + std::to_string(from) + ".." + std::to_string(to)}, "--show", few);
    for (const json& point : path.value("points", json::array())) EXPECT_EQ(point["measures"].size(), few.size());
    break;
  }
}

TEST(QuantityNames, AreAnsweredByAllCommands) {
  std::mt19937 random(static_cast<unsigned>(test::seed(1)));
  std::vector<std::string> scenes;
  for (const std::string& name : test::scene_names()) {
    const Scene scene = read_scene(test::dataset(name));
    if (scene.bodies.size() <= 8) scenes.push_back(name);
  }
  for (const std::string& name : some_of(scenes, static_cast<std::size_t>(test::cases(8, 40)), random)) {
    SCOPED_TRACE(name);
    expect_all_commands_answer(name, random);
  }
}

}  // namespace
}  // namespace poise::app_tests::quantity_names_test

// Items that become a part in a file of its own, and a part whose items become the scene's own: the mechanism is the
// same.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/view/view_session.hpp"
#include "model/input_error.hpp"
#include "model/parameter_values.hpp"
#include "model/parameters.hpp"
#include "model/scene_text.hpp"
#include "statics/equilibrium/named_equilibrium.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/page/hand.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/seed.hpp"

namespace poise::app::grouped_items_test {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::error_of;
using app_tests::Hand;
using app_tests::TempFolder;
using nlohmann::json;
using test::message_of;

std::map<std::string, double> numbers_of(const Scene& scene) {
  std::map<std::string, double> out;
  const std::vector<ParameterRow> rows = parameter_table(scene);
  const std::vector<std::optional<double>> values = parameter_values(scene);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (values[i]) out.emplace(rows[i].path.text(), *values[i]);
  }
  return out;
}

/// Bodies by their names without that of the part.
std::map<std::string, double> angles_of(const Scene& scene, const NamedEquilibrium& rest) {
  std::map<std::string, double> out;
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    const std::string& name = scene.bodies[b].name;
    if (name != "group.ground") out[name.starts_with("group.") ? name.substr(6) : name] = rest.angle(name);
  }
  return out;
}

TEST(GroupedItems, RestWhereTheyDidAndComeBackWithAllNumbers) {
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(POISE_SOURCE_DIR) + "/datasets")) {
    if (entry.path().extension() != ".toml") continue;
    const std::string name = entry.path().stem().string(), text = contents(entry.path());
    if (text.find("[[part]]") != std::string::npos || text.find("[body.") == std::string::npos) continue;
    SCOPED_TRACE(name);
    const TempFolder folder;
    const std::string file = folder.write(name + ".toml", text);
    if (!message_of([&] { parse_scene(text, file); }).empty()) continue;
    SolveOptions any;
    any.seek = Seek::any;
    const SceneText before(text, file);
    std::vector<std::string> bodies;
    for (const SceneItem& item : before.items()) {
      if (item.owner == Owner::body && item.index > 0) bodies.push_back(item.name);
    }
    std::mt19937 random(test::seed(std::hash<std::string>()(name) + 5U));
    std::shuffle(bodies.begin(), bodies.end(), random);
    bodies.resize(std::uniform_int_distribution<std::size_t>(1, bodies.size())(random));
    const GroupedText grouped = before.grouped(bodies, "group", "group.toml");
    folder.write("group.toml", grouped.part);
    ASSERT_EQ(message_of([&] { parse_scene(grouped.part, folder.path("group.toml").string()); }), "") << grouped.part;
    ASSERT_EQ(message_of([&] { parse_scene(grouped.scene, file); }), "") << grouped.scene << "\n\n" << grouped.part;
    const SceneText parted(grouped.scene, file);
    EXPECT_EQ(parted.parts(), std::vector<std::string>{"group"});
    const SceneText back(parted.ungrouped("group"), file);
    EXPECT_EQ(numbers_of(back.scene()), numbers_of(before.scene())) << back.text();
    NamedEquilibrium rest = solve(before.scene(), any), rest_parted = solve(parted.scene(), any);
    if (!rest.found()) continue;
    ASSERT_TRUE(rest_parted.found()) << rest_parted.result().why << "\n" << grouped.scene << "\n\n" << grouped.part;
    const std::map<std::string, double> expected = angles_of(before.scene(), rest),
                                        found = angles_of(parted.scene(), rest_parted);
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [body, angle] : expected)
      EXPECT_NEAR(std::remainder(found.at(body) - angle, 2 * M_PI), 0.0, 1e-6) << body << "\n" << grouped.scene;
    ++compared;
  }
  std::printf("%d scenes compared\n", compared);
  EXPECT_GT(compared, 30);
}

constexpr const char* two_links = R"(gravity = [0, -9.81]

[units]
angle = "deg"

[numbers]
L = 2
half = "L/2"

[ground]
points = { A = [0, 0], C = ["L", 1] }  # held here

# Turns about A.
[body.crank]
points = { A = [0, 0], B = ["half", 0] }  # of the drawing
mass = 2

[body.rod]
points = { B = [0, 0], E = [1, 0] }
mass = 1

[[pin]]
name = "A"
points = ["ground.A", "crank.A"]

[[pin]]
points = ["crank.B", "rod.B"]

# Holds it up.
[[spring]]
name = "holder"
points = ["ground.C", "crank.B"]
stiffness = 100
free_length = "L/4"

[[spring]]
name = "between"
points = ["ground.C", "rod.E"]
stiffness = 50
free_length = 1

[outputs]
pull = "force.holder + force.between"
height = "y.crank.B"

[start]
crank = 30  # a guess
rod = -40
)";

TEST(GroupedItems, LinesOfAPart) {
  const SceneText text(two_links, "two_links.toml");
  const GroupedText made = text.grouped({"crank"}, "arm", "arm.toml");
  EXPECT_EQ(made.part, R"(gravity = [0, -9.81]

[units]
angle = "deg"

[numbers]
L = 2
half = "L/2"

[ground]
points = { A = [0, 0], C = ["L", 1] }

# Turns about A.
[body.crank]
points = { A = [0, 0], B = ["half", 0] }  # of the drawing
mass = 2

[[pin]]
name = "A"
points = ["ground.A", "crank.A"]

# Holds it up.
[[spring]]
name = "holder"
points = ["ground.C", "crank.B"]
stiffness = 100
free_length = "L/4"

[start]
crank = 30
)");
  EXPECT_EQ(made.scene, R"(gravity = [0, -9.81]

[units]
angle = "deg"

[numbers]
L = 2
half = "L/2"

[[part]]
name = "arm"
file = "arm.toml"
join = { A = "ground.A", C = "ground.C" }
numbers = { L = "L", half = "half" }

[ground]
points = { A = [0, 0], C = ["L", 1] }  # held here

[body.rod]
points = { B = [0, 0], E = [1, 0] }
mass = 1

[[pin]]
points = ["arm.crank.B", "rod.B"]

[[spring]]
name = "between"
points = ["ground.C", "rod.E"]
stiffness = 50
free_length = 1

[outputs]
pull = "force.arm.holder + force.between"
height = "y.arm.crank.B"

[start]
"arm.crank" = 30  # a guess
rod = -40
)");
  // A part that the scene has changed comes back as it is there.
  const TempFolder folder;
  folder.write("arm.toml", made.part);
  const SceneText parted(made.scene + "\n", folder.path("scene.toml").string());
  const SceneText back(parted.ungrouped("arm"), folder.path("scene.toml").string());
  for (const char* const line :
       {"# Turns about A.\n[body.crank]\npoints = { A = [0, 0], B = [\"half\", 0] }  # of the drawing\nmass = 2\n",
        "# Holds it up.\n[[spring]]\nname = \"holder\"\npoints = [\"ground.C\", \"crank.B\"]\n",
        "pull = \"force.holder + force.between\"\nheight = \"y.crank.B\"\n", "crank = 30  # a guess\n",
        "points = [\"crank.B\", \"rod.B\"]\n"})
    EXPECT_NE(back.text().find(line), std::string::npos) << line << "\n" << back.text();
  EXPECT_EQ(back.text().find("part"), std::string::npos) << back.text();
}

TEST(GroupedItems, OneStepOfUndoAndRedo) {
  const TempFolder folder;
  Hand hand(folder.write("two_links.toml", two_links));
  const std::string before = hand.text();
  const json angles = hand.look()["position"];
  ASSERT_EQ(error_of(hand.ask({{"do", "group"}, {"items", {"crank"}}})), "");
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"part_1.toml", "two_links.toml", "two_links.toml.draft"}));
  const std::string parted = hand.text(), part = contents(folder.path("part_1.toml"));
  EXPECT_NE(parted.find("file = \"part_1.toml\""), std::string::npos) << parted;
  const json state = hand.look();
  EXPECT_NEAR(state["position"]["part_1.crank"].get<double>(), angles["crank"].get<double>(), 1e-9);
  EXPECT_NEAR(state["position"]["rod"].get<double>(), angles["rod"].get<double>(), 1e-9);
  const json& last = state["items"].back();
  EXPECT_EQ(last["item"], "part part_1");
  // A changed number of the part is the scene's.
  ASSERT_EQ(error_of(hand.ask({{"do", "set"}, {"path", "numbers.part_1.body.crank.mass"}, {"value", 3}})), "");
  ASSERT_EQ(error_of(hand.ask({{"do", "ungroup"}, {"part", "part_1"}})), "");
  EXPECT_NE(hand.text().find("mass = 3"), std::string::npos) << hand.text();
  EXPECT_EQ(hand.text().find("part_1"), std::string::npos) << hand.text();
  for (int k = 0; k < 2; ++k) ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
  EXPECT_EQ(hand.text(), parted);
  ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
  EXPECT_EQ(hand.text(), before);
  EXPECT_EQ(contents(folder.path("part_1.toml")), part);
  ASSERT_EQ(error_of(hand.ask({{"do", "redo"}})), "");
  EXPECT_EQ(hand.text(), parted);
  ASSERT_EQ(error_of(hand.ask({{"do", "save"}})), "");
  EXPECT_EQ(contents(folder.path("two_links.toml")), parted);
}

// The number of a point of a part is the scene's; a mass that a tool has spread stands in the part's file, and stays.
TEST(GroupedItems, PointsOfAPartMoveByTheirNumbers) {
  const TempFolder folder;
  Hand hand(folder.write("two_links.toml", two_links));
  std::vector<double> end, begin;
  const json state = hand.look();
  for (const json& one : state["sheet"]["points"]) {
    if (one["name"] == "rod.E") end = one["at"].get<std::vector<double>>();
    if (one["name"] == "rod.B") begin = one["at"].get<std::vector<double>>();
  }
  ASSERT_EQ(error_of(hand.ask({{"do", "draw"},
                               {"tool", "mass"},
                               {"at", {{0.5 * (end[0] + begin[0]), 0.5 * (end[1] + begin[1])}}},
                               {"within", 0.05},
                               {"grain", 1e-4}})),
            "");
  ASSERT_EQ(error_of(hand.ask({{"do", "group"}, {"items", {"rod"}}})), "");
  const std::string part = contents(folder.path("part_1.toml"));
  ASSERT_EQ(error_of(hand.ask({{"do", "set"}, {"path", "numbers.part_1.point.rod.E.x"}, {"value", 1.2}})), "");
  EXPECT_NE(hand.text().find("\"part_1.point.rod.E.x\" = 1.2"), std::string::npos) << hand.text();
  EXPECT_EQ(contents(folder.path("part_1.toml")), part);
}

TEST(GroupedItems, WhatCannotBeAPart) {
  const TempFolder folder;
  folder.write("taken.toml", "title = \"mine\"\n");
  folder.write("part_1.toml", "title = \"mine\"\n");
  Hand hand(folder.write("two_links.toml", two_links));
  const std::string before = hand.text();
  const std::vector<std::string> files = folder.names();
  const auto refusal = [&](json request) {
    request["do"] = "group";
    const std::string why = error_of(hand.ask(request));
    EXPECT_EQ(hand.text(), before);
    EXPECT_EQ(folder.names(), files);
    return why;
  };
  EXPECT_EQ(refusal({{"items", {"crank"}}, {"name", "taken"}}),
            "name: expected another one; taken.toml is there already");
  EXPECT_NE(refusal({{"items", {"crank"}}, {"name", "../arm"}}).find("name: expected letters"), std::string::npos);
  EXPECT_NE(refusal({{"items", {"crank"}}, {"name", "rod"}}).find("expected a name of its own"), std::string::npos);
  EXPECT_EQ(refusal({{"items", {"spring between"}}}),
            "spring between: expected its links among the items too; choose them as well");
  EXPECT_EQ(refusal({{"items", {"ground.C"}}}), "items: expected a link among what becomes a part; choose one too");
  ASSERT_EQ(error_of(hand.ask({{"do", "group"}, {"items", {"crank"}}})), "");
  EXPECT_TRUE(std::filesystem::exists(folder.path("part_2.toml")));
  ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
  ASSERT_EQ(error_of(hand.ask({{"do", "switch"}, {"item", "spring.holder"}, {"on", false}})), "");
  EXPECT_EQ(error_of(hand.ask({{"do", "group"}, {"items", {"crank"}}})),
            "spring.holder: expected what is switched on in a part; switch it on first");
  EXPECT_FALSE(std::filesystem::exists(folder.path("part_3.toml")));
  // A part that stands elsewhere than its file says.
  Hand lift(folder.write("leaning.toml", "[[part]]\nname = \"left\"\nfile = \"strut.toml\"\nat = [1, 0]\n" +
                                             (folder.write("strut.toml", two_links), std::string())));
  EXPECT_EQ(error_of(lift.ask({{"do", "ungroup"}, {"part", "left"}})),
            "part left: expected one that is where its file says; \"at\" places it elsewhere");
  EXPECT_NE(error_of(lift.ask({{"do", "ungroup"}, {"part", "lift"}})).find("did you mean \"left\"?"),
            std::string::npos);
  ViewSession no_file(new_scene());
  const json answer = json::parse(no_file.act({{"do", "group"}, {"items", {"crank"}}, {"revision", 1}}));
  EXPECT_EQ(error_of(answer), "the scene is no file; save its text as one");
}

}  // namespace
}  // namespace poise::app::grouped_items_test

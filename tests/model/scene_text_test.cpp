// Scene files whose items are added, taken away and renamed in their text.

#include "model/scene_text.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/text_file.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"

namespace poise::scene_text_test {
namespace {

using test::message_of;

constexpr const char* arm = R"(# An arm. é
title = "Arm"

# The ground
[ground]
points = { O = [0, 0], S = [0, 1] }

# the arm itself
[body.arm]  # é
points = { O = [0, 0], tip = [1, 0] }
mass = 2

[body.rod.points]
A = [0, 0]   # begins here
B = [2, 0]

[[pin]]
points = ["ground.O", "arm.O"]

# where they meet
[[pin]]
name = "knee"
points = ["arm.tip", "rod.A"]

[[spring]]
name = "holder" # holds
points = ["ground.S", "arm.tip"]
stiffness = 10
free_length = 1

[[force]]
name = "P"
at = "rod.B"
vector = [0, -1]

[start]
arm = 0.5
rod = 1

[outputs]
height = "y.arm.tip + angle.rod"
)";

std::string replaced(std::string text, const std::vector<std::pair<std::string, std::string>>& changes) {
  for (const auto& [from, to] : changes) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  return text;
}

template <class Change>
std::string changed(const std::string& text, Change change) {
  SceneText out(text, "arm.toml");
  change(out);
  return out.text();
}

TEST(SceneText, AddsItemsBehindTheirLike) {
  EXPECT_EQ(changed(arm, [](SceneText& text) { text.add_point("ground", "T", "[3, 0]"); }),
            replaced(arm, {{"S = [0, 1] }", "S = [0, 1], T = [3, 0] }"}}));
  EXPECT_EQ(changed(arm, [](SceneText& text) { text.add_point("rod", "C", "[1, 1]"); }),
            replaced(arm, {{"B = [2, 0]\n", "B = [2, 0]\nC = [1, 1]\n"}}));
  EXPECT_EQ(changed(arm,
                    [](SceneText& text) {
                      text.add_body("link", {{"points", "{ A = [0, 0] }"}});
                    }),
            replaced(arm, {{"[[pin]]\n", "[body.link]\npoints = { A = [0, 0] }\n\n[[pin]]\n"}}));
  EXPECT_EQ(
      changed(arm,
              [](SceneText& text) {
                text.add_item("damper", {{"points", R"(["ground.S", "rod.B"])"}, {"coefficient", "3"}});
              }),
      replaced(arm, {{"[[force]]", "[[damper]]\npoints = [\"ground.S\", \"rod.B\"]\ncoefficient = 3\n\n[[force]]"}}));
  EXPECT_EQ(changed(arm,
                    [](SceneText& text) {
                      text.set("rod", {{"mass", "4"}});
                    }),
            std::string(arm) + "\n[body.rod]\nmass = 4\n");
}

TEST(SceneText, BeginsWithAnEmptySheet) {
  SceneText text("", "new.toml");
  text.add_point("ground", "A", "[0, 0]");
  text.add_body("link", {{"points", "{ A = [0, 0], B = [1, 0] }"}});
  text.add_item("pin", {{"points", R"(["ground.A", "link.A"])"}});
  text.set_start("link", "0.5");
  text.set_start_position("link", "[0, 0]");
  text.add_item("force", {{"at", "\"link.B\""}, {"vector", "[0, -1]"}});
  EXPECT_EQ(text.text(), R"([ground]
points = { A = [0, 0] }

[body.link]
points = { A = [0, 0], B = [1, 0] }

[[pin]]
points = ["ground.A", "link.A"]

[[force]]
at = "link.B"
vector = [0, -1]

[start]
link = 0.5
position = { link = [0, 0] }
)");
}

TEST(SceneText, TakesAwayWhatRefersToWhatGoes) {
  std::string without_rod = replaced(arm, {{"[body.rod.points]\nA = [0, 0]   # begins here\nB = [2, 0]\n\n", ""},
                                           {R"(# where they meet
[[pin]]
name = "knee"
points = ["arm.tip", "rod.A"]

)",
                                            ""},
                                           {R"([[force]]
name = "P"
at = "rod.B"
vector = [0, -1]

)",
                                            ""},
                                           {"rod = 1\n", ""},
                                           {"height = \"y.arm.tip + angle.rod\"\n", ""}});
  EXPECT_EQ(changed(arm, [](SceneText& text) { text.remove({"rod"}); }), without_rod);
  EXPECT_EQ(changed(arm, [](SceneText& text) { text.remove({"ground.S"}); }), replaced(arm, {{", S = [0, 1]", ""},
                                                                                             {R"([[spring]]
name = "holder" # holds
points = ["ground.S", "arm.tip"]
stiffness = 10
free_length = 1

)",
                                                                                              ""}}));
  EXPECT_EQ(changed(arm,
                    [](SceneText& text) {
                      text.remove({"load P", "spring holder"});
                    }),
            replaced(arm, {{R"([[spring]]
name = "holder" # holds
points = ["ground.S", "arm.tip"]
stiffness = 10
free_length = 1

[[force]]
name = "P"
at = "rod.B"
vector = [0, -1]

)",
                            ""}}));
  const std::string lists =
      "ground.points = { O = [0, 0], P = [0, 1], Q = [1, 1] }\nbody.a.points = { A = [0, 0] }\n"
      "pin = [{ name = \"p\", points = [\"ground.O\", \"a.A\"] }]\n"
      "force = [{ name = \"f\", at = \"a.A\", vector = [1, 0] }, { name = \"g\", at = \"a.A\", "
      "vector = [2, 0] }, { name = \"h\", at = \"a.A\", vector = [3, 0] }]\n";
  EXPECT_EQ(changed(lists,
                    [](SceneText& text) {
                      text.remove({"load f", "load g", "ground.P", "pin p"});
                    }),
            "ground.points = { O = [0, 0], Q = [1, 1] }\nbody.a.points = { A = [0, 0] }\n"
            "force = [{ name = \"h\", at = \"a.A\", vector = [3, 0] }]\n");
  EXPECT_EQ(changed(lists,
                    [](SceneText& text) {
                      text.remove({"load g", "load h", "ground.P", "ground.Q"});
                    }),
            "ground.points = { O = [0, 0] }\nbody.a.points = { A = [0, 0] }\n"
            "pin = [{ name = \"p\", points = [\"ground.O\", \"a.A\"] }]\n"
            "force = [{ name = \"f\", at = \"a.A\", vector = [1, 0] }]\n");
}

TEST(SceneText, RenamesWhereverANameStands) {
  EXPECT_EQ(changed(arm, [](SceneText& text) { text.rename("arm", "long arm"); }),
            replaced(arm, {{"[body.arm]", "[body.\"long arm\"]"},
                           {"\"arm.O\"", "\"long arm.O\""},
                           {"\"arm.tip\", \"rod", "\"long arm.tip\", \"rod"},
                           {"\"ground.S\", \"arm.tip\"", "\"ground.S\", \"long arm.tip\""},
                           {"\narm = 0.5", "\n\"long arm\" = 0.5"},
                           {"y.arm.tip +", "y.long arm.tip +"}}));
  EXPECT_EQ(changed(arm, [](SceneText& text) { text.rename("rod", "link"); }),
            replaced(arm, {{"[body.rod.points]", "[body.link.points]"},
                           {"\"rod.A\"", "\"link.A\""},
                           {"\"rod.B\"", "\"link.B\""},
                           {"\nrod = 1", "\nlink = 1"},
                           {"angle.rod", "angle.link"}}));
  EXPECT_EQ(changed(arm, [](SceneText& text) { text.rename("rod.A", "K"); }),
            replaced(arm, {{"A = [0, 0]   #", "K = [0, 0]   #"}, {"rod.A", "rod.K"}}));
  EXPECT_EQ(changed(arm, [](SceneText& text) { text.rename("spring holder", "S"); }),
            replaced(arm, {{"\"holder\" # holds", "\"S\" # holds"}}));
}

TEST(SceneText, LeavesTheTextWhereAChangeMakesNoScene) {
  SceneText text(arm, "arm.toml");
  EXPECT_EQ(message_of([&] { text.rename("arm", "rod"); }), "name: expected another one; rod has it");
  EXPECT_EQ(message_of([&] { text.rename("amr", "lever"); }), "expected an item of the scene; did you mean \"arm\"?");
  EXPECT_NE(
      message_of([&] {
        text.add_item("spring", {{"points", R"(["ground.S", "arm.tpi"])"}, {"stiffness", "1"}, {"free_length", "1"}});
      }).find("did you mean \"arm.tip\"?"),
      std::string::npos);
  EXPECT_NE(message_of([&] { text.set("rod", {{"mass", "-1"}}); }), "");
  EXPECT_EQ(text.text(), arm);
}

/// Names of all items.
std::set<std::string> contents(const SceneText& text, const std::set<std::string>& but) {
  std::set<std::string> out;
  for (const SceneItem& item : text.items()) {
    if (!but.contains(item.name)) out.insert(item.name);
  }
  return out;
}

std::vector<std::filesystem::path> all_scenes() {
  std::vector<std::filesystem::path> out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::dataset("."))) {
    if (entry.path().extension() != ".toml") continue;
    if (message_of([&] { read_scene(entry.path()); }).empty()) out.push_back(entry.path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// A number of every kind and name is where it was, so that numbers are compared without the names.
std::vector<double> numbers_of(const Scene& scene) {
  std::vector<double> out;
  for (const ParameterRow& row : parameter_table(scene)) out.push_back(value_at(scene, row.place).value_or(-1.0));
  return out;
}

// Every item of every scene is renamed and back, which gives the first byte again, and taken away, which leaves all
// that does not refer to it.
TEST(SceneText, RenamesAndTakesAwayAllItemsOfAllScenes) {
  int renamed = 0, removed = 0, refused = 0;
  for (const std::filesystem::path& file : all_scenes()) {
    const std::string text = read_text_file(file);
    const SceneText before(text, file.string());
    const std::vector<SceneItem>& items = before.items();
    const std::size_t step = std::max<std::size_t>(1, items.size() / 12);
    for (std::size_t i = 0; i < items.size(); i += step) {
      const SceneItem& item = items[i];
      SCOPED_TRACE(file.string() + ": " + item.name);
      if (item.name == "ground") continue;
      SceneText after = before;
      const std::string why = message_of([&] { after.rename(item.name, "renamed_now"); });
      if (why.empty()) {
        ++renamed;
        EXPECT_EQ(numbers_of(after.scene()), numbers_of(before.scene()));
        const std::vector<SceneItem> now = after.items();
        ASSERT_EQ(now.size(), items.size());
        EXPECT_EQ(now[i].own_name, "renamed_now");
        after.rename(now[i].name, item.own_name);
        const bool had_name = text.size() == after.text().size();
        if (item.owner == Owner::body || item.owner == Owner::point || had_name) {
          EXPECT_EQ(after.text(), text);
        }
      } else {
        ++refused;
        EXPECT_EQ(after.text(), text);
      }
      after = before;
      const std::string why_not = message_of([&] { after.remove({item.name}); });
      if (!why_not.empty()) {
        EXPECT_EQ(after.text(), text);
        ++refused;
        continue;
      }
      ++removed;
      const std::set<std::string> now = contents(after, {}), then = contents(before, {item.name});
      EXPECT_FALSE(now.contains(item.name));
      // Items without names of their own are counted anew.
      if (now.size() == then.size()) continue;
      EXPECT_LT(now.size(), then.size());
    }
  }
  std::printf("%d renamed, %d taken away, %d refused\n", renamed, removed, refused);
  EXPECT_GT(renamed, 20 * refused);
}

}  // namespace
}  // namespace poise::scene_text_test

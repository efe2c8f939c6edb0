// Items that are copied: the copy of a whole mechanism, moved and mirrored, rests where the original does, moved and
// mirrored.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/view/requested_motion.hpp"
#include "app/view/view_session.hpp"
#include "model/input_error.hpp"
#include "model/scene_text.hpp"
#include "statics/equilibrium/named_equilibrium.hpp"
#include "statics/tracking/tracked_equilibrium.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/seed.hpp"

namespace poise::app::copied_items_test {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::TempFolder;
using nlohmann::json;
using test::message_of;

/// A motion in SI.
struct Motion {
  bool mirrored;
  double angle;
  Vec2 at;

  Vec2 turned(Vec2 v) const { return (mirrored ? Vec2{v.x, -v.y} : v) * unit(angle); }
  double angle_of(double before) const { return angle + (mirrored ? -before : before); }
};

/// Names of all that can be copied, and of the bodies among it.
std::vector<std::string> all_items(const SceneText& text) {
  std::vector<std::string> out;
  for (const SceneItem& item : text.items()) {
    if (item.index > 0 || (item.owner != Owner::body && item.owner != Owner::point)) out.push_back(item.name);
  }
  return out;
}

/// Scenes of the datasets that are written in one file.
std::vector<std::string> scene_files() {
  std::vector<std::string> out;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(dataset("zeeman")).parent_path())) {
    if (entry.path().extension() != ".toml") continue;
    const std::string text = contents(entry.path().string());
    if (text.find("[[part]]") != std::string::npos || text.find("[body.") == std::string::npos) continue;
    if (message_of([&] { parse_scene(text, entry.path().string()); }).empty()) out.push_back(entry.path().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

// Gravity is moved as the mechanism is. From there the search has to stay where it is.
TEST(CopiedItems, RestsWhereTheOriginalDoesMovedAndMirrored) {
  int compared = 0, refused = 0;
  std::set<std::string> never;
  for (const std::string& file : scene_files()) {
    // At places of any decimals its bars are equal to rounding only, so that it is not redundant but locked.
    if (std::filesystem::path(file).stem() == "redundant_parallelogram") continue;
    SCOPED_TRACE(file);
    const std::string text = contents(file);
    Scene original = parse_scene(text, file);
    SolveOptions any;
    any.seek = Seek::any;
    NamedEquilibrium rest = solve(original, any);
    if (!rest.found()) continue;
    // A position that is exact to rounding, with all travels and places.
    const TrackedEquilibrium tracked(original);
    if (!tracked.equilibrium().found()) continue;
    const BodyPoses poses = tracked.poses();
    for (int sample = 0; sample < test::cases(1, 20); ++sample) {
      std::mt19937 random(test::seed(std::hash<std::string>()(std::filesystem::path(file).stem()) + 17U * sample));
      std::uniform_real_distribution<double> one(-1.0, 1.0);
      const auto kind = std::uniform_int_distribution<int>(0, 3)(random);
      const Units& units = original.units;
      Motion motion{kind % 2 == 1, kind < 2 ? 3 * one(random) : 0.0, {3 * one(random), 3 * one(random)}};
      if (kind == 3) motion.angle = M_PI;  // about a vertical line
      SceneText copied(text, file);
      const std::vector<std::string> all = all_items(copied);
      const std::string refusal = message_of([&] {
        copied.copy(all, {motion.mirrored, motion.angle / units.angle, (1.0 / units.length) * motion.at}, 1);
      });
      if (!refusal.empty()) {
        EXPECT_TRUE(motion.mirrored && refusal.find("not mirrored") != std::string::npos) << refusal;
        ++refused;
        continue;
      }
      std::vector<std::string> bodies;
      const SceneText before(text, file);
      for (const SceneItem& item : before.items()) {
        if (item.owner == Owner::body && item.index > 0) bodies.push_back(item.name);
      }
      copied.remove(bodies);
      Scene moved = copied.scene();
      moved.gravity = motion.turned(original.gravity);
      // The body that stands for the ground, where there is one, and its weld come first.
      const std::size_t more = moved.bodies.size() - original.bodies.size();
      ASSERT_LE(more, 1U) << copied.text();
      ASSERT_EQ(moved.joints.size(), original.joints.size() + more) << copied.text();
      const auto is_of_frame_in = [&](const Scene& scene, const Joint& joint) {
        return more == 1 && scene.bodies[static_cast<std::size_t>(joint.b.body)].name.starts_with("frame");
      };
      const auto is_of_frame = [&](const Joint& joint) { return is_of_frame_in(moved, joint); };
      const Start& start = tracked.scene().start;
      std::size_t own = 1;
      std::vector<std::size_t> body_of;
      for (std::size_t b = 1; b < moved.bodies.size(); ++b) {
        if (more == 1 && moved.bodies[b].name.starts_with("frame")) continue;
        body_of.push_back(b);
        if (moved.start.angle[b] && original.start.angle[own]) {
          EXPECT_NEAR(std::remainder(*moved.start.angle[b] - motion.angle_of(*original.start.angle[own]), 2 * M_PI),
                      0.0, 1e-9)
              << moved.bodies[b].name;
        }
        moved.start.angle[b] = motion.angle_of(poses[own].angle);
        if (start.position[own]) moved.start.position[b] = motion.at + motion.turned(*start.position[own]);
        ++own;
      }
      own = 0;
      for (std::size_t j = 0; j < moved.joints.size(); ++j) {
        if (!is_of_frame(moved.joints[j])) {
          const bool is_turned_round = moved.joints[j].name.find("rolling") != std::string::npos && motion.mirrored;
          if (start.travel[own] && !is_turned_round) moved.start.travel[j] = start.travel[own];
          ++own;
        }
      }
      NamedEquilibrium found = solve(moved, any);
      ASSERT_TRUE(found.found()) << found.result().why << "\n" << copied.text();
      for (std::size_t k = 0; k < body_of.size(); ++k) {
        const std::string& name = moved.bodies[body_of[k]].name;
        EXPECT_NEAR(std::remainder(found.angle(name) - motion.angle_of(poses[k + 1].angle), 2 * M_PI), 0.0, 1e-6)
            << name << "\n"
            << copied.text();
      }
      // The originals themselves, moved in place, are the same mechanism under their own names.
      SceneText in_place(text, file);
      in_place.move(all, {motion.mirrored, motion.angle / units.angle, (1.0 / units.length) * motion.at});
      Scene there = in_place.scene();
      there.gravity = moved.gravity;
      ASSERT_EQ(there.bodies.size(), moved.bodies.size()) << in_place.text();
      ASSERT_EQ(there.joints.size(), moved.joints.size()) << in_place.text();
      own = 0;
      for (std::size_t b = 1; b < there.bodies.size(); ++b) {
        if (more == 1 && there.bodies[b].name.starts_with("frame")) continue;
        there.start.angle[b] = moved.start.angle[body_of[own]];
        there.start.position[b] = moved.start.position[body_of[own++]];
      }
      own = 0;
      for (std::size_t j = 0; j < there.joints.size(); ++j) {
        if (is_of_frame_in(there, there.joints[j])) continue;
        while (is_of_frame(moved.joints[own])) ++own;
        there.start.travel[j] = moved.start.travel[own++];
      }
      found = solve(there, any);
      ASSERT_TRUE(found.found()) << found.result().why << "\n" << in_place.text();
      own = 1;
      for (std::size_t b = 1; b < there.bodies.size(); ++b) {
        if (more == 1 && there.bodies[b].name.starts_with("frame")) continue;
        EXPECT_EQ(there.bodies[b].name, original.bodies[own].name);
        EXPECT_NEAR(std::remainder(found.angle(there.bodies[b].name) - motion.angle_of(poses[own].angle), 2 * M_PI),
                    0.0, 1e-6)
            << there.bodies[b].name << "\n"
            << in_place.text();
        ++own;
      }
      ++compared;
    }
  }
  std::printf("%d copies compared, %d not mirrored\n", compared, refused);
  EXPECT_GT(compared, 30);
}

// A hand that copies, in the page's requests.
class CopyingHand {
 public:
  explicit CopyingHand(const std::string& file) : session(file) {}
  json ask(json request) {
    request["revision"] = session.poll(0)["revision"];
    return json::parse(session.act(request));
  }
  std::string text() { return ask({{"do", "look"}})["text"]; }
  std::vector<std::string> items() {
    std::vector<std::string> out;
    const json state = ask({{"do", "look"}});
    for (const json& item : state["items"]) out.push_back(item["item"]);
    return out;
  }
  ViewSession session;
};

std::string error_of(const json& answer) { return answer.contains("error") ? answer["error"]["text"] : ""; }

TEST(CopiedItems, UndoLeadsBackToTheFirstByte) {
  const TempFolder folder;
  for (const std::string name : {"toggle_clamp", "four_bar_torsion", "planetary_gear", "block_and_tackle"}) {
    SCOPED_TRACE(name);
    CopyingHand hand(folder.write(name + ".toml", contents(dataset(name))));
    const std::string before = hand.text();
    const auto ask = [&](const std::string& what, json request) {
      request["do"] = what;
      request["items"] = hand.items();
      ASSERT_EQ(error_of(hand.ask(request)), "");
      EXPECT_NE(hand.text(), before);
      EXPECT_EQ(message_of([&] { parse_scene(hand.text(), "copied.toml"); }), "");
      ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
      EXPECT_EQ(hand.text(), before);
    };
    ask("copy", {{"move", {1000, 0}}});
    ask("copy", {{"move", {1000, 0}}, {"times", 3}});
    ask("copy", {{"mirror", {{0, 0}, {0, 1}}}});
    ask("copy", {{"turn", 0.3}, {"about", {10, 10}}, {"move", {5, 6}}});
    ask("move", {{"move", {1000, 0}}});
    ask("move", {{"turn", 0.3}, {"mirror", {{0, 0}, {0, 1}}}});
  }
}

constexpr const char* crank = R"(gravity = [0, -9.81]

[units]
angle = "deg"

[numbers]
L = 2

[ground]
points = { A = [0, 0], C = ["L", 1] }  # held here

[body.crank]  # turns
points = { A = [0, 0], B = ["L/2", 0] }
mass = 2

[[pin]]
name = "A"
points = ["ground.A", "crank.A"]

[[spring]]
name = "holder"
points = ["ground.C", "crank.B"]
stiffness = 100  # N/m
free_length = "L/4"

[[torsion_spring]]
bodies = ["ground", "crank"]
stiffness = 1
free_angle = 10

[[force]]
name = "P"
at = "crank.B"
vector = [0, -5]

[[stop]]
bodies = ["ground", "crank"]
min = -80
max = 80

[start]
crank = 30
)";

// What a person would have written.
TEST(CopiedItems, LinesOfACopy) {
  SceneText text(crank, "crank.toml");
  text.copy({"crank"}, {false, 0.0, {10, 0}}, 2);
  const std::string made = text.text();
  for (const char* const line :
       {"points = { A = [0, 0], C = [\"L\", 1], D = [10, 0], E = [\"10 + L\", 1], F = [20, 0], G = [\"20 + L\", 1] }  "
        "# held here",
        "[body.crank_2]\npoints = { A = [0, 0], B = [\"L/2\", 0] }\nmass = 2\n\n[body.crank_3]",
        "[[pin]]\nname = \"D\"\npoints = [\"ground.D\", \"crank_2.A\"]\n",
        "[[spring]]\nname = \"holder_2\"\npoints = [\"ground.E\", \"crank_2.B\"]\nstiffness = 100\nfree_length = "
        "\"L/4\"\n",
        "[[force]]\nname = \"P_3\"\nat = \"crank_3.B\"\nvector = [0, -5]\n",
        "crank = 30\ncrank_2 = 30\ncrank_3 = 30\n"})
    EXPECT_NE(made.find(line), std::string::npos) << line << "\n" << made;
  // A point that a mirror leaves where it is holds the copy too.
  SceneText mirrored(crank, "crank.toml");
  mirrored.copy({"crank"}, {true, 180.0, {}}, 1);
  for (const char* const line : {"C = [\"L\", 1], D = [\"-L\", 1] }", "points = [\"ground.A\", \"crank_2.A\"]",
                                 "bodies = [\"crank_2\", \"ground\"]\nstiffness = 1\nfree_angle = -170\n",
                                 "min = -260\nmax = -100\n", "crank_2 = 150\n", "vector = [0, -5]"})
    EXPECT_NE(mirrored.text().find(line), std::string::npos) << line << "\n" << mirrored.text();
}

// What is off is no item of the mechanism, and stands in the file as a comment; so do its copies.
TEST(CopiedItems, CopiesOfWhatIsOffAreOff) {
  const TempFolder folder;
  CopyingHand hand(folder.write("crank.toml", crank));
  const json before = hand.ask({{"do", "look"}});
  for (const json& one : before["switches"]) {
    if (one["group"] == "springs" && one["name"] != "holder") continue;
    ASSERT_EQ(error_of(hand.ask({{"do", "switch"}, {"item", one["item"]}, {"on", false}})), "") << one;
  }
  ASSERT_EQ(error_of(hand.ask({{"do", "copy"}, {"items", {"crank"}}, {"move", {10, 0}}, {"times", 2}})), "");
  std::map<std::string, bool> switches;
  const json state = hand.ask({{"do", "look"}});
  for (const json& one : state["switches"]) switches[one["item"]] = one["on"];
  EXPECT_EQ(switches.size(), 12U);
  for (const auto& [item, on] : switches) EXPECT_EQ(on, item.find("torsion") != std::string::npos) << item;
  const Scene saved = parse_scene(hand.text(), "saved.toml");
  EXPECT_EQ(saved.elements.size(), 3U) << hand.text();
  EXPECT_TRUE(saved.stops.empty() && saved.forces.empty()) << hand.text();
  ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
  ASSERT_EQ(error_of(hand.ask({{"do", "switch"}, {"item", "spring.holder"}, {"on", true}})), "");
  ASSERT_EQ(error_of(hand.ask({{"do", "copy"}, {"items", {"crank"}}, {"move", {10, 0}}})), "");
  EXPECT_EQ(parse_scene(hand.text(), "saved.toml").elements.size(), 4U) << hand.text();
}

TEST(CopiedItems, WhatCannotBeCopied) {
  const auto refusal = [](const std::vector<std::string>& items, const PlaneMotion& motion, int times) {
    SceneText text(crank, "crank.toml");
    const std::string why = message_of([&] { text.copy(items, motion, times); });
    EXPECT_EQ(text.text(), crank);
    return why;
  };
  EXPECT_EQ(refusal({}, {}, 1), "items: expected one at least");
  EXPECT_EQ(refusal({"crank"}, {}, 0), "times: expected a whole number from 1 to 1000, found 0");
  EXPECT_EQ(refusal({"spring holder"}, {}, 1),
            "spring holder: expected its links among the items too; choose them as well");
  EXPECT_EQ(refusal({"crank.B"}, {}, 1), "crank.B: expected its links among the items too; choose them as well");
  EXPECT_NE(refusal({"crnk"}, {}, 1).find("did you mean \"crank\"?"), std::string::npos);
  EXPECT_EQ(message_of([] {
              requested_motion({{"mirror", {{1, 1}, {1, 1}}}}, 1.0);
            }),
            "mirror: expected two different points of a line");
}

// The reflection about a line, and a turn about a point, leave them where they are.
TEST(CopiedItems, RequestedMotions) {
  const double degree = M_PI / 180;
  const auto moved = [&](const PlaneMotion& motion, Vec2 place) {
    return motion.after({false, 0.0, place}, degree).at;
  };
  const PlaneMotion mirror = requested_motion({{"mirror", {{1, 2}, {4, 6}}}}, degree);
  EXPECT_NEAR(norm(moved(mirror, {4, 6}) - Vec2{4, 6}), 0.0, 1e-12);
  EXPECT_NEAR(norm(moved(mirror, {-3, 5}) - Vec2{5, -1}), 0.0, 1e-12);  // (4, -3) from (1, 2), across (3, 4)
  const PlaneMotion turn = requested_motion({{"turn", 90}, {"about", {1, 1}}, {"move", {10, 0}}}, degree);
  EXPECT_NEAR(norm(moved(turn, {2, 1}) - Vec2{11, 2}), 0.0, 1e-12);
}

}  // namespace
}  // namespace poise::app::copied_items_test

// Mechanisms that are not complete yet, as `poise view` shows them: joints alone decide how they move.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "statics/equilibrium/named_equilibrium.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/page/hand.hpp"

namespace poise::app::sketch_test {
namespace {

using app_tests::error_of;
using app_tests::Hand;
using app_tests::TempFolder;
using nlohmann::json;

Vec2 place_of(const json& state, const std::string& point) {
  for (const json& one : state["sheet"]["points"]) {
    if (one["name"] == point) return {one["at"][0], one["at"][1]};
  }
  ADD_FAILURE() << "no point " << point;
  return {};
}

json handle_of(const json& state, const std::string& name) {
  for (const json& handle : state["handles"]) {
    if (handle["name"] == name) return handle;
  }
  return nullptr;
}

std::string verdict_of(const json& state) { return state["verdict"]["text"]; }

/// Two links of these lengths, mm, on the ground at both sides, pinned to each other in C.
std::string two_links_across(double span, double left, double right) {
  return "[units]\nlength = \"mm\"\nangle = \"deg\"\n[ground]\npoints = { A = [0, 0], D = [" + std::to_string(span) +
         ", 0] }\n[body.left]\npoints = { A = [0, 0], C = [" + std::to_string(left) +
         ", 0] }\n[body.right]\npoints = { D = [0, 0], C = [" + std::to_string(right) +
         ", 0] }\n[[pin]]\nname = \"A\"\npoints = [\"ground.A\", \"left.A\"]\n[[pin]]\nname = \"D\"\n"
         "points = [\"ground.D\", \"right.D\"]\n[[pin]]\nname = \"C\"\npoints = [\"left.C\", \"right.C\"]\n"
         "[start]\nleft = 40\nright = 150\n";
}

TEST(Sketch, FollowsTheHandByItsJoints) {
  const TempFolder folder;
  Hand hand(folder.path("arm.toml"));
  ASSERT_EQ(error_of(hand.draw("ground_point", {{0, 0}})), "");
  ASSERT_EQ(error_of(hand.draw("link", {{0, 0}, {100, 0}}, {{"name", "upper"}})), "");
  ASSERT_EQ(error_of(hand.draw("link", {{100, 0}, {160, 60}}, {{"name", "lower"}})), "");
  const json before = hand.look();
  ASSERT_EQ(verdict_of(before).substr(0, 9), "A sketch:");
  const std::string tip = before["sheet"]["points"].back()["name"];
  const json px = handle_of(before, tip)["px"];
  ASSERT_TRUE(px.is_array()) << tip;
  const double x = px[0].get<double>() - 40.0, y = px[1].get<double>() - 25.0;
  const json moved = hand.ask({{"do", "drag"}, {"point", tip}, {"px", {x, y}}});
  ASSERT_EQ(error_of(moved), "");
  const json there = handle_of(moved, tip)["px"];
  EXPECT_LT(std::hypot(there[0].get<double>() - x, there[1].get<double>() - y), 0.05);
  ASSERT_EQ(error_of(hand.ask({{"do", "release"}})), "");
  const json after = hand.look();
  EXPECT_EQ(verdict_of(after), verdict_of(before));
  EXPECT_EQ(after["undo"], before["undo"]) << "it changes no number";
  EXPECT_LT(norm(place_of(after, "upper.B") - place_of(after, "lower.B")), 1e-9);
  EXPECT_NEAR(norm(place_of(after, "upper.B")), 100.0, 1e-9);
  EXPECT_GT(norm(place_of(after, tip) - place_of(before, tip)), 1.0);
  // Farther than the links reach it is stretched out.
  ASSERT_EQ(error_of(hand.ask({{"do", "drag"}, {"point", tip}, {"px", {x + 5000.0, y}}})), "");
  EXPECT_NEAR(norm(place_of(hand.look(), tip)), 100.0 + std::hypot(60.0, 60.0), 0.1);
  // So it goes round with a hand that is out of reach, and comes back with it.
  const json sheet = after["sheet"];
  const Vec2 origin{sheet["origin"][0], sheet["origin"][1]};
  for (const double turn : {0.5, 1.5, 2.0, 4.0}) {
    const Vec2 far = origin + 2000.0 * Vec2{std::cos(turn), -std::sin(turn)};
    ASSERT_EQ(error_of(hand.ask({{"do", "drag"}, {"point", tip}, {"px", {far.x, far.y}}})), "");
    const Vec2 at = place_of(hand.look(), tip);
    EXPECT_NEAR(std::remainder(std::atan2(at.y, at.x) - turn, 2 * M_PI), 0.0, 1e-3);
  }
  const json back = hand.ask({{"do", "drag"}, {"point", tip}, {"px", {x, y}}});
  const json again = handle_of(back, tip)["px"];
  EXPECT_LT(std::hypot(again[0].get<double>() - x, again[1].get<double>() - y), 0.05);
}

// A joint that takes the last freedom leaves a structure, which rests nowhere, as `poise solve` says of its text.
TEST(Sketch, IsWhatLosesItsLastFreedom) {
  const TempFolder folder;
  Hand hand(folder.write("swing.toml",
                         "gravity = [0, -9810]\n[units]\nlength = \"mm\"\nangle = \"deg\"\n[ground]\n"
                         "points = { A = [0, 100], D = [0, 0] }\n[body.link]\npoints = { A = [0, 0], C = [100, 0] }\n"
                         "[[pin]]\npoints = [\"ground.A\", \"link.A\"]\n[[force]]\nat = \"link.C\"\n"
                         "vector = [0, -100]\n[start]\nlink = -90\n"));
  ASSERT_EQ(hand.look()["missing"], "");
  ASSERT_EQ(error_of(hand.draw("pin_in_slot", {{0, 0}, {100, 3}})), "");
  EXPECT_NE(verdict_of(hand.look()).find("no degree of freedom left"), std::string::npos) << verdict_of(hand.look());
  ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
  EXPECT_EQ(hand.look()["missing"], "");
}

TEST(Sketch, IsShownWithItsLoopsClosed) {
  const TempFolder folder;
  Hand hand(folder.write("rigid.toml", two_links_across(300, 200, 220)));
  const json state = hand.look();
  EXPECT_NE(verdict_of(state).find("no degree of freedom left"), std::string::npos) << verdict_of(state);
  const Vec2 c = place_of(state, "left.C");
  EXPECT_LT(norm(c - place_of(state, "right.C")), 1e-9);
  // Where circles round A and D meet.
  EXPECT_NEAR(c.x, (300.0 * 300 + 200.0 * 200 - 220.0 * 220) / 600.0, 1e-9);
  EXPECT_GT(c.y, 0.0);
  EXPECT_NE(error_of(hand.ask({{"do", "drag"}, {"point", "left.C"}, {"px", {100, 100}}})).find("cannot move"),
            std::string::npos);
}

TEST(Sketch, SaysWhichLoopIsOpenAndRefusesNothing) {
  const TempFolder folder;
  Hand hand(folder.write("open.toml", two_links_across(300, 100, 100)));
  const json state = hand.look();
  const double gap = norm(place_of(state, "left.C") - place_of(state, "right.C"));
  EXPECT_GT(gap, 100.0);
  char words[80];
  std::snprintf(words, sizeof words, "A sketch: the loops do not close: pin C is %.3g mm open.", gap);
  EXPECT_EQ(verdict_of(state), words);
  EXPECT_EQ(error_of(hand.draw("link", {{-50, 100}, {0, 150}})), "");
  EXPECT_EQ(verdict_of(hand.look()).substr(0, 9), "A sketch:");
}

TEST(Sketch, IsReleasedWhereItWasDrawn) {
  const TempFolder folder;
  Hand hand(folder.path("swing.toml"));
  ASSERT_EQ(error_of(hand.draw("ground_point", {{0, 0}})), "");
  ASSERT_EQ(error_of(hand.draw("link", {{0, 0}, {100, 50}}, {{"name", "swing"}})), "");
  const json drawn = hand.look();
  const json loaded = hand.draw("mass", {{50, 25}});
  ASSERT_EQ(error_of(loaded), "");
  EXPECT_EQ(loaded["transition"]["kind"], "settled");
  EXPECT_GT(loaded["drawing"]["frames"].size(), 3U) << "the way is shown";
  EXPECT_EQ(verdict_of(loaded), "In equilibrium, proved: stable.");
  EXPECT_LT(norm(place_of(loaded, "swing.B") - Vec2{0.0, -std::hypot(100, 50)}), 1e-3);
  ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
  EXPECT_EQ(hand.look()["sheet"], drawn["sheet"]);
  EXPECT_EQ(hand.text(), drawn["text"]);
}

TEST(Sketch, AFreeBodyIsMissingSomethingThatHoldsIt) {
  const TempFolder folder;
  const std::string free = "A sketch: body \"ship\" is free: nothing holds it.";
  for (const char* const more : {"", "mass = 1\n"}) {
    for (const char* const gravity : {"", "gravity = [0, -9810]\n"}) {
      const std::string text = std::string(gravity) +
                               "[units]\nlength = \"mm\"\nangle = \"deg\"\n[ground]\npoints = { A = [0, 0], S = [0, "
                               "-80] }\n[body.ship]\npoints = { P = [0, 0], Q = [50, 0] }\n" +
                               more +
                               "[body.swing]\npoints = { A = [0, 0], B = [100, 0] }\nmass = 2\ncenter = [100, 0]\n"
                               "[[pin]]\npoints = [\"ground.A\", \"swing.A\"]\n[[spring]]\nname = \"s\"\npoints = "
                               "[\"ground.S\", \"swing.B\"]\nstiffness = 1\nfree_length = 10\n[start]\nswing = -80\n";
      Hand hand(folder.write("ship.toml", text));
      EXPECT_EQ(verdict_of(hand.look()), free) << text;
      // Held by a spring it is no sketch any more.
      const json held = hand.draw("spring", {{0, -80}, {50, 0}});
      ASSERT_EQ(error_of(held), "");
      EXPECT_EQ(held["missing"], "");
      ASSERT_EQ(error_of(hand.ask({{"do", "undo"}})), "");
      EXPECT_EQ(verdict_of(hand.look()), free);
    }
  }
}

/// What a tool is told that draws the same twice: which item is there.
TEST(Sketch, RefusesWhatIsThereAlready) {
  const TempFolder folder;
  Hand hand(folder.write("twice.toml", two_links_across(300, 200, 220)));
  ASSERT_EQ(error_of(hand.draw("ground_point", {{0, -100}}, {{"name", "S"}})), "");
  const Vec2 c = place_of(hand.look(), "left.C");
  const std::vector<std::vector<double>> ends{{0, -100}, {c.x, c.y}};
  ASSERT_EQ(error_of(hand.draw("spring", ends, {{"name", "holder"}})), "");
  const std::string before = hand.text();
  EXPECT_EQ(error_of(hand.draw("spring", ends)), "spring holder is there already, between the same two");
  EXPECT_EQ(error_of(hand.draw("spring", {ends[1], ends[0]})), "spring holder is there already, between the same two");
  EXPECT_EQ(error_of(hand.draw("pin", {{c.x, c.y}})), "the bodies there are joined already; see pin C");
  EXPECT_EQ(error_of(hand.draw("pin", {{0, 0}})), "the bodies there are joined already; see pin A");
  EXPECT_EQ(hand.text(), before);
  // Another kind of spring may lie beside it.
  EXPECT_EQ(error_of(hand.draw("gas_strut", ends)), "");
  EXPECT_EQ(error_of(hand.draw("damper", ends)), "");
  ASSERT_EQ(error_of(hand.draw("bar", ends, {{"name", "rod"}})), "");
  EXPECT_EQ(error_of(hand.draw("bar", {ends[1], ends[0]})), "bar rod is there already, between the same two");
}

TEST(Sketch, RefusesTwoEndsAtOnePlace) {
  const TempFolder folder;
  Hand hand(folder.write("one.toml", two_links_across(300, 200, 220)));
  const Vec2 c = place_of(hand.look(), "left.C");
  const std::string before = hand.text();
  for (const char* const tool : {"spring", "bar", "gas_strut", "rope", "damper", "constant_force"}) {
    EXPECT_EQ(error_of(hand.draw(tool, {{c.x, c.y}, {c.x, c.y}})),
              "place 2: expected another one; both ends are at left.C")
        << tool;
    EXPECT_EQ(hand.text(), before);
  }
}

}  // namespace
}  // namespace poise::app::sketch_test

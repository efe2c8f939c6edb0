// A chain of 20 links is pulled farther than one answer of `poise view` follows it.
#include <cmath>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/view/background_view.hpp"
#include "model/scene_text.hpp"
#include "tests/support/browser.hpp"
#include "tests/support/hanging_chain.hpp"

namespace poise::app::long_drags_test {
namespace {

using nlohmann::json;
using test::Browser;

// Eight links of 100 mm lead to it from the point L of the ground.
const std::string point = "link7.b";

SceneInMemory chain() {
  const std::string text = test::hanging_chain(20), name = "chain.toml";
  return {parse_sketch(text, name), text, name};
}

json asked(ViewSession& session, json request) {
  request["revision"] = session.poll(0)["revision"];
  return json::parse(session.act(request));
}

Vec2 px_of(const json& state, const std::string& name) {
  for (const json& handle : state["handles"]) {
    if (handle["name"] == name) return {handle["px"][0], handle["px"][1]};
  }
  return {NAN, NAN};
}

// As far as the links reach, from L towards the pointer at 30 degrees downwards.
TEST(LongDrags, GoOnInSeveralAnswersThatAreAllProved) {
  ViewSession session(chain());
  json state = asked(session, {{"do", "look"}});
  const Vec2 left = px_of(state, "L"), right = px_of(state, "R");
  const double reach = norm(right - left) / 2;
  const Vec2 downwards = unit(M_PI / 6), far = left + 3.0 * reach * downwards;
  int answers = 0;
  do {
    state = asked(session, {{"do", "drag"}, {"point", point}, {"px", {far.x, far.y}}});
    ASSERT_FALSE(state.contains("error")) << state["error"];
    EXPECT_EQ(state["verdict"]["text"], "In equilibrium, proved: stable.");
    EXPECT_TRUE(session.tracked().equilibrium().found());
    ++answers;
  } while (state["transition"]["unfinished"] && answers < 100);
  EXPECT_GT(answers, 1);
  EXPECT_LT(answers, 100);
  EXPECT_LT(norm(px_of(state, point) - (left + reach * downwards)), 2.0);
}

// The pointer comes in one move and rests: the page asks on by itself.
TEST(LongDrags, ThePageFollowsAPointerThatRests) {
  if (const std::string why = Browser::missing(); !why.empty()) GTEST_SKIP() << why;
  BackgroundView view(chain());
  Browser& browser = Browser::shared();
  browser.emulate({});
  browser.open(view.address());
  ASSERT_TRUE(browser.wait_for("document.body.dataset.revision !== undefined"));
  const std::string place =
      "(name => { const box = document.querySelector(`[data-name=\"${name}\"]`)"
      ".getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2] })";
  const auto place_of = [&](const std::string& name) {
    const json at = browser.run("return " + place + "('" + name + "')");
    return Vec2{at[0], at[1]};
  };
  const Vec2 left = place_of("L"), right = place_of("R"), from = place_of(point);
  const Vec2 end = left + 0.5 * norm(right - left) * unit(M_PI / 6), far = left + 1.5 * (end - left);
  browser.press(from.x, from.y);
  browser.move(far.x, far.y);
  const bool has_come = browser.wait_for("Math.hypot(" + place + "('" + point + "')[0] - " + std::to_string(end.x) +
                                         ", " + place + "('" + point + "')[1] - " + std::to_string(end.y) + ") < 4");
  EXPECT_TRUE(has_come);
  browser.let_go();
  browser.open("about:blank");
}

}  // namespace
}  // namespace poise::app::long_drags_test

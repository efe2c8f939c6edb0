// What `poise view` leaves on disk: that it is what was shown, and is taken for nothing else by another program.
#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "statics/equilibrium/named_equilibrium.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/page/hand.hpp"

namespace poise::app::kept_view_test {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::error_of;
using app_tests::Hand;
using app_tests::TempFolder;
using nlohmann::json;

// Its angle in equilibrium is no round number.
constexpr const char* pendulum = R"(gravity = [0, -9810]
[units]
length = "mm"
angle = "deg"
[ground]
points = { A = [0, 0] }
[body.swing]
points = { A = [0, 0], B = [100, 0] }
mass = 1
center = [70, 37]
[[pin]]
points = ["ground.A", "swing.A"]
)";

json others_of(Hand& hand) {
  for (int tries = 0; tries < 600; ++tries) {
    const json poll = hand.session.poll(0);
    if (!poll["others"].is_null()) return poll["others"];
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return nullptr;
}

TEST(KeptView, SaysHowAnUnstableEquilibriumIsFoundAgain) {
  const TempFolder folder;
  const std::string file = folder.write("pendulum.toml", pendulum);
  Hand hand(file);
  const json stable = hand.ask({{"do", "save"}, {"anyway", true}});
  EXPECT_EQ(stable["transition"]["why"], "");
  EXPECT_EQ(hand.session.report().find("--seek any"), std::string::npos);
  const json others = others_of(hand);
  ASSERT_EQ(others["equilibria"].size(), 2U);
  const int number = others["equilibria"][0]["stable"] ? 1 : 0;
  ASSERT_EQ(error_of(hand.ask({{"do", "go"}, {"number", number}})), "");
  const double shown = hand.session.tracked().poses()[1].angle;
  const json saved = hand.ask({{"do", "save"}});
  ASSERT_EQ(error_of(saved), "");
  EXPECT_EQ(saved["transition"]["why"],
            "poise solve of this text finds another equilibrium; poise solve --seek any finds the one shown");
  EXPECT_EQ(hand.session.tracked().poses()[1].angle, shown) << "it stays where it is";
  EXPECT_TRUE(hand.look()["saved"]);
  EXPECT_NE(hand.session.report().find("--seek any"), std::string::npos);
  const Scene scene = parse_scene(contents(file), file);
  EXPECT_GT(std::abs(std::remainder(solve(scene).angle("swing") - shown, 2 * M_PI)), 1.0);
  SolveOptions any;
  any.seek = Seek::any;
  EXPECT_NEAR(std::remainder(solve(scene, any).angle("swing") - shown, 2 * M_PI), 0.0, 1e-9);
}

}  // namespace
}  // namespace poise::app::kept_view_test

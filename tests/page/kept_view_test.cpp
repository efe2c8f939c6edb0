// What `poise view` leaves on disk: that it is what was shown, and is taken for nothing else by another program.
#include <chrono>
#include <cmath>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "statics/equilibrium/named_equilibrium.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/page/hand.hpp"
#include "tests/support/page_document.hpp"

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

std::string line_of_report(Hand& hand) { return json::parse(page_tests::document_in(hand.session.report()))["line"]; }

TEST(KeptView, SaysHowAnUnstableEquilibriumIsFoundAgain) {
  const TempFolder folder;
  const std::string file = folder.write("pendulum.toml", pendulum);
  Hand hand(file);
  const json stable = hand.ask({{"do", "save"}, {"anyway", true}});
  EXPECT_EQ(stable["transition"]["why"], "");
  EXPECT_EQ(line_of_report(hand), "poise solve " + file);
  const json others = others_of(hand);
  ASSERT_EQ(others["equilibria"].size(), 2U);
  const std::size_t number = others["equilibria"][0]["stable"] ? 1 : 0;
  ASSERT_EQ(error_of(hand.ask({{"do", "go"}, {"number", number}})), "");
  const double shown = hand.session.tracked().poses()[1].angle;
  const json saved = hand.ask({{"do", "save"}});
  ASSERT_EQ(error_of(saved), "");
  EXPECT_EQ(
      saved["transition"]["why"],
      "what is shown would not stay there: poise solve lets the mechanism of this text move to another equilibrium");
  EXPECT_EQ(hand.session.tracked().poses()[1].angle, shown) << "it stays where it is";
  EXPECT_TRUE(hand.look()["saved"]);
  EXPECT_EQ(line_of_report(hand), "poise solve " + file + " --seek any");
  const Scene scene = parse_scene(contents(file), file);
  EXPECT_GT(std::abs(std::remainder(solve(scene).angle("swing") - shown, 2 * M_PI)), 1.0);
  SolveOptions any;
  any.seek = Seek::any;
  EXPECT_NEAR(std::remainder(solve(scene, any).angle("swing") - shown, 2 * M_PI), 0.0, 1e-9);
}

/// Another program that shows a file and draws in it, until it is killed.
class OtherProgram {
 public:
  explicit OtherProgram(const std::string& file) {
    int ready[2];
    EXPECT_EQ(pipe(ready), 0);
    process_ = fork();
    if (process_ == 0) {
      Hand hand(file);
      const bool drew = error_of(hand.draw("ground_point", {{10, 200}})).empty();
      if (write(ready[1], drew ? "y" : "n", 1) != 1) _exit(1);
      for (;;) pause();
    }
    char answer = '?';
    EXPECT_EQ(read(ready[0], &answer, 1), 1);
    EXPECT_EQ(answer, 'y');
    close(ready[0]);
    close(ready[1]);
  }
  ~OtherProgram() { end(); }
  void end() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = 0;
  }

 private:
  pid_t process_ = 0;
};

TEST(KeptView, LeavesTheDraftOfAProgramThatRuns) {
  const TempFolder folder;
  const std::string file = folder.write("clamp.toml", contents(dataset("toggle_clamp")));
  OtherProgram other(file);
  const std::string drawn = contents(folder.path("clamp.toml.draft"));
  {
    Hand hand(file);
    EXPECT_FALSE(hand.look()["draft"]) << "it is the other's";
    EXPECT_TRUE(hand.session.poll(0)["company"]);
    ASSERT_EQ(error_of(hand.draw("ground_point", {{30, 200}})), "");
    EXPECT_EQ(contents(folder.path("clamp.toml.draft")), drawn);
    EXPECT_EQ(contents(folder.path("clamp.toml.draft2")), hand.text());
    other.end();
    EXPECT_FALSE(hand.session.poll(0)["company"]);
    ASSERT_EQ(error_of(hand.ask({{"do", "save"}, {"anyway", true}})), "");
    EXPECT_FALSE(hand.session.poll(0)["company"]) << "its own file does not count";
  }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"clamp.toml", "clamp.toml.draft"}));
  Hand next(file);
  EXPECT_TRUE(next.look()["draft"]) << "what the killed program left";
  EXPECT_EQ(next.text(), drawn);
}

TEST(KeptView, TwoSessionsKnowOfEachOther) {
  const TempFolder folder;
  const std::string file = folder.write("clamp.toml", contents(dataset("toggle_clamp")));
  Hand first(file);
  EXPECT_FALSE(first.session.poll(0)["company"]);
  {
    Hand second(file);
    EXPECT_TRUE(first.session.poll(0)["company"]);
    EXPECT_TRUE(second.session.poll(0)["company"]);
    // Saving puts another file in the place of the one that both hold.
    ASSERT_EQ(error_of(second.draw("ground_point", {{10, 200}})), "");
    ASSERT_EQ(error_of(second.ask({{"do", "save"}})), "");
    EXPECT_EQ(first.session.poll(0)["file"], "changed");
    second.session.poll(0);
    EXPECT_TRUE(first.session.poll(0)["company"]);
    EXPECT_TRUE(second.session.poll(0)["company"]);
  }
  EXPECT_FALSE(first.session.poll(0)["company"]);
  // On an empty sheet there is a draft at most.
  Hand sheet(folder.path("new.toml"));
  ASSERT_EQ(error_of(sheet.draw("ground_point", {{10, 200}})), "");
  Hand also(folder.path("new.toml"));
  EXPECT_FALSE(also.look()["draft"]);
  EXPECT_TRUE(also.session.poll(0)["company"]);
  EXPECT_FALSE(sheet.session.poll(0)["company"]) << "the other has nothing yet";
}

}  // namespace
}  // namespace poise::app::kept_view_test

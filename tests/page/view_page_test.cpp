// `poise view` in a real browser: the program runs, the page is dragged, and what it shows is compared with the command
// line.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/app/run_poise.hpp"
#include "tests/support/browser.hpp"

extern char** environ;  // NOLINT(readability-identifier-naming): of POSIX

namespace poise::page_tests {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::Outcome;
using app_tests::run_poise;
using app_tests::TempFolder;
using nlohmann::json;
using test::Browser;

Browser& browser() { return Browser::shared(); }

/// `poise view` of a copy of a dataset, and its page in the browser.
class ViewPage : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = Browser::missing(); !why.empty()) GTEST_SKIP() << why;
  }

  void TearDown() override { end(); }

  void show(const std::string& name) {
    file_ = folder_.write(name + ".toml", contents(dataset(name)));
    int ends[2];
    ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::vector<std::string> words = {POISE_EXECUTABLE, "view", file_, "--no-browser"};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ASSERT_EQ(::posix_spawn(&process_, POISE_EXECUTABLE, &actions, nullptr, arguments.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    std::string printed;
    char piece[256];
    while (printed.find("ends it") == std::string::npos) {
      const ssize_t got = ::read(ends[0], piece, sizeof piece);
      ASSERT_GT(got, 0) << printed;
      printed.append(piece, static_cast<std::size_t>(got));
    }
    ::close(ends[0]);
    const std::size_t at = printed.find("http://");
    address_ = printed.substr(at, printed.find('\n', at) - at);
    browser().open(address_);
    ASSERT_TRUE(browser().wait_for("document.body.dataset.revision !== undefined"));
    browser().console();
  }

  void end() {
    if (process_ == 0) return;
    ::kill(process_, SIGINT);
    int status = 0;
    ::waitpid(process_, &status, 0);
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    process_ = 0;
  }

  json ask(const json& request) {
    return json::parse(browser()
                           .run("const request = new XMLHttpRequest(); request.open('POST', 'do', false);"
                                "request.send(arguments[0]); return request.responseText",
                                {request.dump()})
                           .get<std::string>());
  }

  /// Where a handle is in the window, px.
  std::pair<double, double> place_of(const std::string& kind, const std::string& name) {
    const json place = browser().run(
        "const one = document.querySelector(`[data-handle=\"${arguments[0]}\"][data-name=\"${arguments[1]}\"]`);"
        "const box = one.getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]",
        {kind, name});
    return {place[0].get<double>(), place[1].get<double>()};
  }

  long revision() { return std::stol(browser().run("return document.body.dataset.revision").get<std::string>()); }

  void expect_silence() {
    for (const std::string& line : browser().console()) ADD_FAILURE() << line;
  }

  /// Angles of an equilibrium as the command line finds it in a text.
  json angles_by_command_line(const std::string& text, const std::vector<std::string>& options) {
    std::vector<std::string> command = {"solve", folder_.write("shown.toml", text), "--json",
                                        folder_.path("shown.json").string()};
    command.insert(command.end(), options.begin(), options.end());
    const Outcome ran = run_poise(command);
    EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
    return json::parse(contents(folder_.path("shown.json")))["angles"];
  }

  TempFolder folder_;
  std::string file_, address_;
  pid_t process_ = 0;
  int exit_code_ = -1;
};

/// The start that a text gives to each body.
std::map<std::string, double> start_of(const std::string& text) {
  std::map<std::string, double> out;
  std::istringstream lines(text.substr(text.find("[start]")));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find(" = ");
    if (equals != std::string::npos) out[line.substr(0, equals)] = std::stod(line.substr(equals + 3));
  }
  return out;
}

TEST_F(ViewPage, JointDraggedAlongACircleIsWhereTheCommandLineFindsIt) {
  show("four_bar_gravity");
  const auto [x, y] = place_of("point", "crank.B");
  const auto [ax, ay] = place_of("ground", "A");
  browser().press(x, y);
  for (int k = 1; k <= 25; ++k) {
    const double turn = 0.03 * k;
    const long before = revision();
    browser().move(ax + (x - ax) * std::cos(turn) - (y - ay) * std::sin(turn),
                   ay + (x - ax) * std::sin(turn) + (y - ay) * std::cos(turn));
    ASSERT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(before)));
    EXPECT_EQ(browser().run("return document.body.dataset.confirmed"), "true");
    const json whole = ask({{"do", "look"}});
    const std::string text = whole["text"];
    const json found = angles_by_command_line(text + whole["hand"]["stops"].get<std::string>(), {"--seek", "any"});
    for (const auto& [body, angle] : start_of(text)) {
      EXPECT_NEAR(found[body].get<double>(), angle, 1e-9) << body;
    }
  }
  const long held = revision();
  browser().let_go();
  ASSERT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(held)));
  EXPECT_EQ(browser().run("return document.body.dataset.kind"), "settled");
  const std::string text = ask({{"do", "look"}})["text"];
  const json found = angles_by_command_line(text, {});
  for (const auto& [body, angle] : start_of(text)) EXPECT_NEAR(found[body].get<double>(), angle, 1e-9) << body;
  expect_silence();
  const json times = browser().run("return window.poiseTimes");
  std::vector<double> total, server;
  for (const json& time : times) {
    total.push_back(time["total"]);
    server.push_back(time["server"]);
  }
  std::sort(total.begin(), total.end());
  std::sort(server.begin(), server.end());
  ASSERT_FALSE(total.empty());
  std::printf("drag event to picture: median %.1f ms, program %.2f ms\n", total[total.size() / 2],
              server[server.size() / 2]);
}

TEST_F(ViewPage, SnapAtAFoldIsPlayed) {
  show("toggle_clamp");
  // Pictures that are shown on the way carry their caption.
  browser().run(
      "window.captions = []; new MutationObserver(() => window.captions.push(document.body.innerText.match(/moving: "
      ".*/)?.[0]))"
      ".observe(document.body, {subtree: true, childList: true, characterData: true});");
  browser().run(
      "const field = document.querySelector('[data-number=\"load.P\"] input[type=number]');"
      "field.value = 40; field.dispatchEvent(new Event('input', {bubbles: true}));"
      "field.dispatchEvent(new Event('change', {bubbles: true}));");
  ASSERT_TRUE(browser().wait_for("document.body.dataset.kind === 'snapped'"));
  ASSERT_TRUE(browser().wait_for("document.body.dataset.confirmed === 'true'"));
  EXPECT_TRUE(browser().run("return window.captions.some(text => text !== undefined)").get<bool>());
  expect_silence();
}

TEST_F(ViewPage, BadTextShowsItsError) {
  show("toggle_clamp");
  const std::string bad = contents(dataset("toggle_clamp")) + "\n[[sprin]]\nname = \"x\"\n";
  browser().run(
      "const area = document.querySelector('textarea'); area.value = arguments[0];"
      "area.dispatchEvent(new Event('input', {bubbles: true}));",
      {bad});
  const auto line = std::count(bad.begin(), bad.begin() + static_cast<std::ptrdiff_t>(bad.find("[[sprin]]")), '\n') + 1;
  EXPECT_TRUE(browser().wait_for("document.body.innerText.includes('toggle_clamp.toml:" + std::to_string(line) + "')"));
  expect_silence();
}

TEST_F(ViewPage, EditsOnDiskAreShown) {
  show("four_bar_gravity");
  std::string text = contents(file_);
  const long before = revision();
  text.replace(text.find("gravity = [0, -"), 15, "gravity = [0, -2");
  std::ofstream(file_) << text;
  EXPECT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(before)));
  expect_silence();
}

/// The picture of README.md, with POISE_PICTURE=FILE; without it the page is looked at for what it shows.
TEST_F(ViewPage, Picture) {
  show("toggle_clamp");
  ASSERT_TRUE(browser().wait_for("document.body.textContent.includes('3 equilibria, complete, proved')"));
  const auto [x, y] = place_of("point", "handle.grip");
  browser().press(x, y);
  const long before = revision();
  for (int k = 1; k <= 10; ++k) browser().move(x + 6.0 * k, y - 8.0 * k);
  ASSERT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(before)));
  EXPECT_TRUE(browser().wait_for("document.body.innerText.includes('held at handle.grip with')"));
  if (const char* file = std::getenv("POISE_PICTURE")) browser().picture(file);
  browser().let_go();
  expect_silence();
}

TEST_F(ViewPage, SaysThatTheProgramHasEnded) {
  show("four_bar_gravity");
  end();
  EXPECT_EQ(exit_code_, 0);
  EXPECT_TRUE(browser().wait_for("/program has ended/i.test(document.body.innerText)"));
}

}  // namespace
}  // namespace poise::page_tests

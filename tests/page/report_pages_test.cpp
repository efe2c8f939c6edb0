// The pages that --html writes, in a real browser.
#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/page/recordings.hpp"
#include "tests/support/browser.hpp"

namespace poise::page_tests::report_pages_test {
namespace {

using app_tests::dataset;
using app_tests::ProgramRun;
using app_tests::run_poise;
using app_tests::TempFolder;
using nlohmann::json;
using test::Browser;

Browser& browser() { return Browser::shared(); }

struct Report {
  const char* name;
  std::vector<std::string> command;
  int exit_code = 0;
};

std::vector<Report> reports() {
  const std::string clamp = dataset("toggle_clamp"), lift = dataset("lift");
  return {
      {"check", {"check", dataset("six_bar")}},
      {"solve", {"solve", clamp}},
      {"solve_not_found", {"solve", clamp, "--seek", "stable", "--set", "start.handle=92.2"}, -1},
      {"equilibria", {"equilibria", clamp}},
      {"path", {"path", clamp, "--vary", "load.P=0..60"}},
      {"fold_curve",
       {"path", dataset("von_mises_toggle"), "--vary", "load.P=0..60", "--vary", "spring.left.stiffness=900..1100",
        "--curve", "fold"},
       -1},
      {"sensitivity", {"sensitivity", clamp, "--of", "force.rubber"}},
      {"tolerance",
       {"tolerance", clamp, "--tolerances", dataset("toggle_clamp_tolerances"), "--of", "force.rubber", "--samples",
        "2000"}},
      {"compare", {"compare", clamp}},
      {"work_precision", {"compare", dataset("four_bar_gravity"), "--tolerances", "1e-2..1e-6"}},
      {"kinematics", {"kinematics", lift, "--drive", "stroke=0.5..0.79", "--point", "platform.Q"}},
      {"motion", {"motion", lift, "--duration", "1", "--release", "obd=0.005"}},
      {"motion_of_quantities",
       {"motion", dataset("double_pendulum"), "--duration", "1", "--show",
        "reaction.shoulder,d(angle.arm1)/dt,max(shaking.size)"}},
      {"modes", {"modes", lift}},
      {"equations", {"equations", lift}},
      {"forces", {"forces", lift, "--drive", "stroke=0.5..0.79"}},
      {"forces_in_a_pose", {"forces", dataset("four_bar_gravity"), "--drive", "crank=60"}},
      {"design", {"design", dataset("lift_design"), "--starts", "1"}, -1},
      {"design_for_goals", {"design", dataset("tailgate_design")}},
      {"identify", {"identify", dataset("lift_experiment")}},
      {"identifiability", {"identifiability", dataset("lift_experiment_empty")}},
      {"montecarlo", {"montecarlo", dataset("lift_experiment"), "--trials", "4"}, -1},
      {"stress", {"stress", "zeeman-cusp", "--starts", "2"}, -1},
  };
}

void PrintTo(const Report& report, std::ostream* out) { *out << report.name; }

class ReportPages : public testing::TestWithParam<Report> {
 protected:
  void SetUp() override {
    if (const std::string why = Browser::missing(); !why.empty()) GTEST_SKIP() << why;
    browser().emulate({});
    file_ = folder_.path("report.html").string();
    std::vector<std::string> command = GetParam().command;
    command.insert(command.end(), {"--html", file_, "--quiet"});
    const ProgramRun ran = run_poise(command);
    if (GetParam().exit_code >= 0) {
      ASSERT_EQ(ran.exit_code, GetParam().exit_code) << ran.out << ran.err;
    }
    ASSERT_TRUE(std::filesystem::exists(file_)) << ran.out << ran.err;
  }

  void open() const {
    browser().open("file://" + file_);
    ASSERT_TRUE(browser().wait_for("document.querySelector('h1') && document.readyState === 'complete'"));
  }

  TempFolder folder_;
  std::string file_;
};

/// Opens from disk, says what was found, and writes nothing to the console.
TEST_P(ReportPages, OpenWithoutAWordOnTheConsole) {
  open();
  const json seen = browser().run(
      "return {text: document.body.innerText, wide: document.documentElement.scrollWidth - innerWidth,"
      " figures: document.querySelectorAll('figure, svg').length,"
      " fetched: performance.getEntriesByType('resource').filter(e => !e.name.startsWith('data:')).length,"
      " seconds: performance.timing.domInteractive - performance.timing.navigationStart}");
  EXPECT_LE(seen["wide"], 0) << "the page is wider than the window";
  EXPECT_EQ(seen["fetched"], 0);
  EXPECT_GT(seen["text"].get<std::string>().size(), 100U);
  for (const std::string& line : browser().console()) ADD_FAILURE() << line;
  std::printf("%-18s %7.0f kB, interactive after %4.0f ms\n", GetParam().name,
              static_cast<double>(std::filesystem::file_size(file_)) / 1000.0, seen["seconds"].get<double>());
}

/// On a telephone, in the dark, by keys alone.
TEST_P(ReportPages, FitATelephoneAndTheKeyboard) {
  browser().emulate({.width = 400, .height = 800, .dark = true});
  open();
  EXPECT_EQ(browser().run("return document.documentElement.dataset.theme"), "dark");
  EXPECT_LE(browser().run("return document.documentElement.scrollWidth - innerWidth"), 0) << "wider than the window";
  EXPECT_EQ(browser().missed_by_tab(), std::vector<std::string>());
  for (const std::string& line : browser().console()) ADD_FAILURE() << line;
}

// The first click shows the curves of a name alone, the second one all of them; so does a click on the item itself.
TEST(PlotThis, WhatIsClickedIsShownAlone) {
  if (const std::string why = Browser::missing(); !why.empty()) GTEST_SKIP() << why;
  browser().emulate({});
  const TempFolder folder;
  const std::string file = folder.path("motion.html").string();
  ASSERT_EQ(
      run_poise({"motion", dataset("lift"), "--duration", "1", "--release", "obd=0.005", "--html", file}).exit_code, 0);
  browser().open("file://" + file);
  ASSERT_TRUE(browser().wait_for("document.querySelectorAll('.plot-this').length > 5"));
  const auto shown = [] {
    return browser().run(
        "return [...document.querySelectorAll('.legend .entry[aria-pressed=\"true\"]')].map(e => e.textContent)");
  };
  const json all = shown();
  ASSERT_GT(all.size(), 6U);
  const std::string click =
      "[...document.querySelectorAll('.plot-this')].find(b => b.textContent === 'fa').click();"
      "return document.querySelectorAll('.chart.asked-for').length";
  EXPECT_EQ(browser().run(click), 1);
  json alone = shown();
  EXPECT_EQ(std::count(alone.begin(), alone.end(), json("fa")), 1);
  EXPECT_EQ(std::count(alone.begin(), alone.end(), json("obd")), 0);
  EXPECT_EQ(std::count(alone.begin(), alone.end(), json("stroke")), 1) << "other charts stay as they are";
  EXPECT_EQ(browser().run(click), 0);
  EXPECT_EQ(shown(), all);
  const json at = browser().run(
      "const stage = document.querySelector('.stage').getBoundingClientRect();"
      "const tip = document.querySelector('.stage .tip');"
      "for (let y = 20; y < stage.height; y += 6) for (let x = 20; x < stage.width; x += 6) {"
      "  const place = {clientX: stage.left + x, clientY: stage.top + y, bubbles: true};"
      "  document.querySelector('.stage').dispatchEvent(new PointerEvent('pointermove', place));"
      "  if (tip.textContent.includes('click for its curves')) return [place.clientX, place.clientY];"
      "} return null");
  ASSERT_FALSE(at.is_null()) << "some item of the drawing has curves";
  browser().press(at[0], at[1]);
  browser().let_go();
  EXPECT_TRUE(browser().wait_for("document.querySelectorAll('.chart.asked-for').length > 0", 5.0));
  EXPECT_LT(shown().size(), all.size());
  for (const std::string& line : browser().console()) ADD_FAILURE() << line;
}

// What the buttons of a figure make are files: a picture, and a film while the positions of a path are played.
TEST(Recording, PicturesAndFilmsOfAReport) {
  if (const std::string why = Browser::missing(); !why.empty()) GTEST_SKIP() << why;
  browser().emulate({});
  const TempFolder folder;
  const std::string file = folder.path("path.html").string();
  ASSERT_EQ(run_poise({"path", dataset("toggle_clamp"), "--vary", "load.P=0..60", "--html", file}).exit_code, 0);
  browser().open("file://" + file);
  ASSERT_TRUE(browser().wait_for("document.querySelector('[data-recording=\"webm\"]') !== null"));
  browser().console();
  keep_files(browser());
  const auto press = [](const std::string& what) {
    browser().run("document.querySelector(`[data-recording=\"${arguments[0]}\"]`).click()", {what});
  };
  press("png");
  wait_for_file(browser(), 1);
  expect_png(browser(), "svg.picture");
  press("webm");
  ASSERT_TRUE(browser().wait_for("document.querySelector('.recording') !== null"));
  browser().run("document.querySelector('[aria-label=\"Play\"]').click()");
  ASSERT_TRUE(browser().wait_for("document.querySelector('.track input').value !== '0'"));
  press("webm");
  wait_for_file(browser(), 2);
  expect_film(browser());
  for (const std::string& line : browser().console()) ADD_FAILURE() << line;
}

// A ball that bounces: each event is a mark on the time axis, which shows its frame where it is clicked, with the sign
// of the impact and then the arrow of the force, whose layers can be hidden.
TEST(ContactsInMotion, EventsAreMarksAndForcesAreArrows) {
  if (const std::string why = Browser::missing(); !why.empty()) GTEST_SKIP() << why;
  browser().emulate({});
  const TempFolder folder;
  const std::string scene = folder.write("ball.toml", R"(gravity = [0, -9810]
[units]
length = "mm"
[ground]
points = { A = [-200, 0], B = [200, 0] }
[body.ball]
points = { C = [0, 0] }
mass = 1
inertia = 1
[[contact]]
name = "floor"
point = "ball.C"
radius = 20
segment = ["ground.A", "ground.B"]
restitution = 0.3
[start]
position = { ball = [0, 120] }
)");
  const std::string file = folder.path("ball.html").string();
  const ProgramRun ran = run_poise({"motion", scene, "--from", "start", "--duration", "1", "--html", file, "--quiet"});
  ASSERT_EQ(ran.exit_code, 0) << ran.out << ran.err;
  browser().open("file://" + file);
  ASSERT_TRUE(browser().wait_for("document.querySelectorAll('.track .mark').length > 2"));
  EXPECT_EQ(browser().run("return document.querySelector('.track .mark').title"),
            "t = 0.1428 s, impact of floor (min), 1.821 N s");
  EXPECT_EQ(browser().run("return document.querySelectorAll('.track .mark').length"),
            browser().run("return document.querySelectorAll('.events .event').length"));
  // What is said at any place of the picture.
  const auto said = [&] {
    return browser()
        .run(
            "const stage = document.querySelector('.stage').getBoundingClientRect();"
            "const tip = document.querySelector('.stage .tip'); const said = new Set();"
            "for (let y = 4; y < stage.height; y += 9) for (let x = 4; x < stage.width; x += 9) {"
            "  document.querySelector('.stage').dispatchEvent(new PointerEvent('pointermove',"
            "    {clientX: stage.left + x, clientY: stage.top + y, bubbles: true}));"
            "  if (!tip.hidden) said.add(tip.textContent);"
            "} return [...said].join('\\n')")
        .get<std::string>();
  };
  const std::string impact = "impact at contact floor", force = "force of contact floor";
  browser().run("document.querySelector('.track .mark').click()");
  EXPECT_NE(browser().run("return document.querySelector('.track input').value"), "0");
  EXPECT_NE(said().find(impact), std::string::npos);
  browser().run(
      "const all = document.querySelector('.track input'); all.value = all.max; all.dispatchEvent(new Event('input'))");
  const std::string at_rest = said();
  EXPECT_NE(at_rest.find(force), std::string::npos) << at_rest;
  EXPECT_EQ(at_rest.find(impact), std::string::npos) << at_rest;
  const auto texts = [&] {
    return browser().run("return document.querySelector('.stage').textContent").get<std::string>();
  };
  EXPECT_NE(texts().find("9.81 N"), std::string::npos) << texts();
  browser().run(
      "[...document.querySelectorAll('.menu label')].find(one => one.textContent.includes('contact forces'))"
      ".querySelector('input').click()");
  EXPECT_EQ(said().find(force), std::string::npos);
  for (const std::string& line : browser().console()) ADD_FAILURE() << line;
}

INSTANTIATE_TEST_SUITE_P(AllCommands, ReportPages, testing::ValuesIn(reports()),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace poise::page_tests::report_pages_test

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/present/signs.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"
#include "tests/support/page_document.hpp"

namespace poise::app_tests::html_test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// The text between the two, which must be there.
std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin);
  const std::size_t to = text.find(end, from);
  if (to == std::string::npos) throw std::runtime_error("the page has no " + begin + " ... " + end);
  return text.substr(from + begin.size(), to - from - begin.size());
}

json document_of(const std::string& page) { return json::parse(page_tests::document_in(page)); }

/// Runs poise with --html and returns the page.
std::string page_of(const TempFolder& folder, Words words, int exit_code = 0,
                    const std::vector<std::string>& environment = {}) {
  const std::string file = folder.path("page.html").string();
  words.insert(words.end(), {"--html", file});
  const ProgramRun run = run_poise(words, environment);
  EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
  EXPECT_NE(run.out.find("wrote " + file), std::string::npos) << run.out;
  return contents(file);
}

std::size_t times(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// A line for every command, with what it takes some seconds for left out.
std::vector<Words> every_command(const TempFolder& folder) {
  const std::string lift = dataset("lift"), clamp = dataset("toggle_clamp"), fit = folder.path("fit.json").string();
  const std::string experiment = dataset("lift_experiment_four_runs");
  EXPECT_EQ(run_poise({"identify", experiment, "--json", fit}).exit_code, 0);
  std::string again = contents(experiment);
  again.replace(again.find("\"lift.toml\""), 11, '"' + lift + '"');
  std::string plan = contents(dataset("lift_plan"));
  plan.replace(plan.find("\"lift.toml\""), 11, '"' + lift + '"');
  plan.replace(plan.find("runs = 6"), 8, "runs = 2\ntime = 4\ncandidates = 8");
  return {{"check", dataset("six_bar")},
          {"solve", clamp, "--set", "load.P=30"},
          {"equilibria", dataset("von_mises_toggle"), "--starts", "20"},
          {"path", dataset("von_mises_toggle"), "--vary", "load.P=0..60"},
          {"path", dataset("von_mises_toggle"), "--vary", "load.P=0..60", "--vary", "spring.left.stiffness=900..1100",
           "--curve", "fold"},
          {"find", clamp, "--vary", "spring.rubber.stiffness=360..420", "--for", "force.rubber = -700"},
          {"sensitivity", clamp, "--of", "force.rubber"},
          {"tolerance", clamp, "--tolerances", dataset("toggle_clamp_tolerances"), "--of", "force.rubber", "--samples",
           "300"},
          {"compare", clamp},
          {"compare", clamp, "--tolerances", "1e-2,1e-8", "--repeat", "1"},
          {"kinematics", lift, "--drive", "stroke=0.5..0.79", "--steps", "6"},
          {"motion", lift, "--duration", "0.2", "--release", "obd=0.005"},
          {"modes", lift},
          {"equations", lift},
          {"response", lift, "--excite", "spring.oil.free_length", "--of", "angle.fa"},
          {"response", dataset("duffing"), "--excite", "load.F", "--of", "x.mass.C", "--amplitude", "0.2"},
          {"forces", lift, "--drive", "stroke=0.5..0.79", "--steps", "6"},
          {"forces", clamp, "--drive", "handle=60"},
          {"design", dataset("lift_design")},
          {"design", dataset("wall_bed_design")},
          {"identify", experiment},
          {"identify", experiment, folder.write("again.toml", again)},
          {"validate", experiment, "--with", fit},
          {"identifiability", experiment},
          {"plan", folder.write("plan.toml", plan)},
          {"montecarlo", experiment, "--trials", "3"},
          {"import", std::string(POISE_SOURCE_DIR) + "/datasets/exchange/four_bar.txt", "--scene",
           folder.path("four_bar.toml")},
          {"export", clamp, "--dxf", folder.path("clamp.dxf")},
          {"stress", "toggle-1e-6", "--starts", "2"}};
}

TEST(Html, EveryCommandWritesAPageWithoutGnuplot) {
  const TempFolder folder, empty;
  for (const Words& words : every_command(folder)) {
    SCOPED_TRACE(testing::PrintToString(words));
    const std::string file = folder.path("page.html").string(), data = folder.path("data.json").string();
    Words all = words;
    all.insert(all.end(), {"--html", file, "--json", data});
    const ProgramRun run = run_poise(all, {"PATH=" + empty.path("").string()});
    ASSERT_LT(run.exit_code, 2) << run.err;
    const json page = document_of(contents(file));
    EXPECT_EQ(page["command"], words.front());
    EXPECT_TRUE(page["line"].get<std::string>().starts_with("poise " + words.front() + " ")) << page["line"];
    EXPECT_TRUE(page_tests::are_data_of(page["result"], json::parse(contents(data))));
    EXPECT_EQ(page["verdict"]["text"], app::with_true_signs(page["result"]["verdict"]));
    EXPECT_FALSE(page["report"].empty());
    fs::remove(file);
  }
}

TEST(Html, ChartsHaveTheCurvesOfTheResult) {
  const TempFolder folder;
  const json page = document_of(page_of(folder, {"path", dataset("von_mises_toggle"), "--vary", "load.P=0..60"}));
  ASSERT_FALSE(page["figures"].empty());
  const json& panel = page["figures"].back()["charts"]["panels"][0];
  EXPECT_EQ(panel["y_label"], "load.P (N)");
  EXPECT_EQ(panel["curves"][0]["name"], "stable");
  for (const json& curve : panel["curves"]) {
    ASSERT_EQ(curve["x"].size(), curve["y"].size());
    EXPECT_TRUE(page["palette"].contains(curve["colour"])) << curve["colour"];
  }
}

TEST(Html, TablesHaveAllRowsAsTextAndAsNumbers) {
  const TempFolder folder;
  const json page =
      document_of(page_of(folder, {"kinematics", dataset("lift"), "--drive", "stroke=0.5..0.79", "--steps", "60"}));
  bool found = false;
  for (const json& item : page["report"]) {
    if (item["kind"] != "table") continue;
    for (const json& column : item["columns"]) {
      EXPECT_EQ(column["cells"].size(), item["columns"][0]["cells"].size());
      if (column.contains("values")) {
        EXPECT_EQ(column["values"].size(), column["cells"].size());
      }
      found = found || column["cells"].size() == 61;
    }
  }
  EXPECT_TRUE(found);
}

// What text shows with --verbose is in the report, marked as such.
TEST(Html, WhatFrictionHoldsIsPlayedBeyondItsRange) {
  const TempFolder folder;
  // A coefficient may not be negative; a rope over a drum has no load path.
  for (const Words& words :
       {Words{dataset("friction/drawer"), "--vary", "load.P"}, Words{dataset("friction/capstan"), "--vary", "load.P"},
        Words{dataset("friction/wedge"), "--vary", "slide.floor.friction.coefficient"},
        Words{dataset("friction/wedge"), "--vary", "loads"}}) {
    Words line = {"hold"};
    line.insert(line.end(), words.begin(), words.end());
    const json page = document_of(page_of(folder, line));
    const json& figure = page["figures"][0];
    const json& range = page["result"]["range"];
    const json& captions = figure["drawing"]["captions"];
    const auto bound = [&](const char* end, double otherwise) {
      return range[end]["without_end"].get<bool>() ? otherwise : range[end]["value"].get<double>();
    };
    const double low = bound("lower", -INFINITY), high = bound("upper", INFINITY);
    std::size_t held = 0;
    for (std::size_t k = 0; k < captions.size(); ++k) {
      const double value = figure["play"]["values"][k];
      // Values are written to six digits: an end itself is one of both.
      if (std::min(std::abs(value - low), std::abs(value - high)) < 1e-5 * std::abs(value)) continue;
      const bool is_held = value >= low && value <= high;
      held += is_held ? 1 : 0;
      EXPECT_EQ(captions[k].get<std::string>().ends_with(": held"), is_held) << captions[k] << words[0];
    }
    // The page opens at the scene's own value.
    const double shown = figure["play"]["values"][figure["play"]["rest"].get<std::size_t>()], own = range["present"];
    EXPECT_NEAR(shown, own, 1e-5 * std::abs(own)) << words[0];
    EXPECT_GT(held, 0U) << words[0];
    const bool ends = !(range["lower"]["without_end"].get<bool>() && range["upper"]["without_end"].get<bool>());
    EXPECT_EQ(held < captions.size(), ends) << words[0] << words[2];
  }
  const json still = document_of(page_of(folder, {"hold", dataset("friction/drawer")}));
  EXPECT_EQ(still["figures"][0]["kind"], "drawing");
  EXPECT_TRUE(still["figures"][0]["play"].is_null());
}

TEST(Html, LoadsOverARangeArePlayedInOneScale) {
  const TempFolder folder;
  const json page = document_of(
      page_of(folder, {"loads", dataset("structures/three_hinged_portal"), "--vary", "loads=0..1", "--steps", "4"}));
  const json& figure = page["figures"][0];
  EXPECT_EQ(figure["title"], "Bending moment, on the stretched side over loads");
  EXPECT_EQ(figure["play"]["values"], json({0.0, 0.25, 0.5, 0.75, 1.0}));
  EXPECT_EQ(figure["charts"]["panels"].size(), 2U);
  // The largest ordinate of a frame, px, grows with the loads.
  const json& drawing = figure["drawing"];
  std::vector<int> shown = drawing["frames"][0];
  std::vector<double> largest;
  for (std::size_t k = 0; k < drawing["frames"].size(); ++k) {
    const json& changes = drawing["frames"][k];
    for (std::size_t i = 0; k > 0 && i < changes.size(); i += 2) shown[changes[i]] = changes[i + 1];
    largest.push_back(0.0);
    for (std::size_t s = 0; s < shown.size(); ++s) {
      if (drawing["slots"][s][0] != "diagrams" || shown[s] < 0) continue;
      const json& shape = drawing["shapes"][static_cast<std::size_t>(shown[s])];
      if (shape[0] != "line") continue;
      largest.back() = std::max(largest.back(), std::hypot(shape[4].get<double>() - shape[2].get<double>(),
                                                           shape[5].get<double>() - shape[3].get<double>()));
    }
  }
  EXPECT_EQ(largest[0], 0.0);
  for (std::size_t k = 1; k < 5; ++k) EXPECT_NEAR(largest[k] / largest[4], 0.25 * static_cast<double>(k), 0.02) << k;
}

TEST(Html, WheelsShowThatTheyTurn) {
  const TempFolder folder;
  const json page = document_of(page_of(folder, {"kinematics", dataset("hard/nearly_locked_gears"), "--set",
                                                 "gear.train.ratio=0.5", "--drive", "wheel=0..6", "--steps", "4"}));
  const json& frames = page["figures"][0]["drawing"]["frames"];
  for (std::size_t k = 1; k < frames.size(); ++k) EXPECT_GE(frames[k].size(), 4U) << "both radii move";
}

TEST(Html, DetailsAreMarked) {
  const TempFolder folder;
  const json page = document_of(page_of(folder, {"modes", dataset("lift")}));
  const auto is_verbose = [](const json& item) { return item["level"] == "verbose"; };
  EXPECT_TRUE(std::any_of(page["report"].begin(), page["report"].end(), is_verbose));
  EXPECT_FALSE(std::all_of(page["report"].begin(), page["report"].end(), is_verbose));
}

constexpr const char* hostile_scene = R"TOML(title = "</script><script>alert(1)</script><!-- {{title}} \u0007\u2028'\""
source = "</SCRIPT ><!--<script>"
[ground]
points = { O = [0, 0] }
[body."</script>"]
points = { O = [0, 0], "<!--" = [2, 0] }
mass = 0.5
center = [2, 0]
[[pin]]
name = "</title><img src=//evil>"
points = ["ground.O", "</script>.O"]
[[torsion_spring]]
name = "{{document}}"
bodies = ["ground", "</script>"]
stiffness = 3
[[force]]
name = "<!--"
at = "</script>.<!--"
vector = [0, -1]
)TOML";

TEST(Html, TextsOfUsersStayWithinTheDocument) {
  const TempFolder folder;
  const std::string harmless = page_of(folder, {"solve", folder.write("plain.toml", pendulum)});
  // Names of files can be any bytes.
  fs::create_directory(folder.path("a\xff<"));
  const std::string scene = folder.write("a\xff</script><!--.toml", hostile_scene);
  const std::string page = page_of(folder, {"solve", scene, "--set", "load.<!--=1"});
  const json document = document_of(page);
  EXPECT_EQ(document["title"], "</script><script>alert(1)</script><!-- {{title}}  \u2028'\"");
  EXPECT_EQ(document["source"], "</SCRIPT ><!--<script>");
  EXPECT_EQ(document["result"]["scene"]["set"][0], "load.<!--=1");
  EXPECT_NE(document["line"].get<std::string>().find("/a\uFFFD</script><!--.toml' --set 'load.<!--=1'"),
            std::string::npos)
      << document["line"];
  for (const char* tag : {"<script", "</script", "<!--", "</title", "<title"}) {
    EXPECT_EQ(times(page, tag), times(harmless, tag)) << tag;
  }
  EXPECT_EQ(times(page, "</SCRIPT"), 0U);
  EXPECT_EQ(times(page, "<!--"), 0U);
  EXPECT_EQ(between(page, "<title>", "</title>"),
            "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&lt;!-- {{title}}  \u2028'&quot;");
  for (const char c : page) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20U || c == '\n' || c == '\t');
}

TEST(Html, TextsOfFiguresMayBeNoUtf8) {
  const TempFolder folder;
  std::string untitled = pendulum;
  untitled.erase(0, untitled.find('\n'));
  // The file's name is the title of the chart.
  fs::create_directory(folder.path("a\xff<"));
  const std::string scene = folder.write("a\xff</script>.toml", untitled);
  const json page = document_of(page_of(folder, {"compare", scene, "--tolerances", "1e-6", "--repeat", "1"}));
  const std::string title = page["figures"].back()["charts"]["panels"][0]["title"];
  EXPECT_NE(title.find("</script>.toml"), std::string::npos) << title;
}

TEST(Html, LineIsReadByAShellAsItWasTyped) {
  const TempFolder folder;
  const std::string scene = folder.write("it's a scene.toml", pendulum);
  const json page = document_of(page_of(folder, {"solve", scene, "--set", "load.P=2"}));
  EXPECT_EQ(page["line"], "poise solve '" + folder.path("it'\\''s a scene.toml").string() + "' --set load.P=2 --html " +
                              folder.path("page.html").string());
}

TEST(Html, PageLoadsNothing) {
  const TempFolder folder;
  const std::string page = page_of(folder, {"path", dataset("von_mises_toggle"), "--vary", "load.P=0..60"});
  static const std::regex fetch(
      R"((src|href|action|poster)\s*=\s*["']?\s*(https?:)?//|url\(\s*["']?\s*(https?:)?//|@import)", std::regex::icase);
  std::smatch found;
  EXPECT_FALSE(std::regex_search(page, found, fetch)) << found.str();
  EXPECT_EQ(page.find("{{"), std::string::npos) << page.substr(page.find("{{"), 40);
}

TEST(Html, UnwritablePathIsFoundBeforeTheWork) {
  const TempFolder folder;
  const std::string scene = folder.write("a.toml", pendulum), data = folder.path("a.json").string();
  const Words before = folder.names();
  for (const std::string& path : {folder.path("no/such/folder/a.html").string(), folder.path("").string(), scene}) {
    const ProgramRun run = run_poise({"solve", scene, "--json", data, "--html", path});
    EXPECT_EQ(run.exit_code, 2) << path;
    EXPECT_EQ(run.out, "");
    EXPECT_NE(run.err.find("--html"), std::string::npos) << run.err;
    EXPECT_EQ(times(run.err, "\n"), 1U) << run.err;
    EXPECT_EQ(folder.names(), before);
  }
  const ProgramRun same = run_poise({"solve", scene, "--json", data, "--html", data});
  EXPECT_EQ(same.exit_code, 2);
  EXPECT_NE(same.err.find("--html"), std::string::npos) << same.err;
  EXPECT_EQ(folder.names(), before);
}

TEST(Html, PagesOfManyPointsAreSmall) {
  const TempFolder folder;
  for (const Words& words :
       {Words{"kinematics", dataset("four_bar_gravity"), "--drive", "crank=0..300", "--steps", "1200"},
        Words{"loads", dataset("toggle_press"), "--vary", "angle.crank=110..150", "--steps", "1000"},
        Words{"path", dataset("garage_door"), "--vary", "angle.arm=-60..85"}}) {
    const std::string page = page_of(folder, words);
    std::cout << "page of poise " << words[0] << ": " << page.size() / 1000 << " kB\n";
    EXPECT_LT(page.size(), 700'000U) << words[0];
    EXPECT_GT(document_of(page)["report"].size(), 0U);
  }
}

TEST(Html, PageOfAFitIsSmallEnoughToSend) {
  const TempFolder folder;
  const std::string page = page_of(folder, {"identify", dataset("lift_experiment")});
  std::cout << "page of poise identify datasets/lift_experiment.toml: " << page.size() / 1000 << " kB\n";
  EXPECT_LT(page.size(), 1'000'000U);
  const json document = document_of(page);
  const json& first = document["figures"][0];
  EXPECT_EQ(first["title"], "Run \"high, empty\"");
  EXPECT_EQ(first["charts"]["panels"].size(), 2U) << "its readings and residuals";
  EXPECT_NE(first["drawing"].dump().find("sensor angle"), std::string::npos) << "beside the mechanism";
  EXPECT_EQ(document["figures"][1]["title"], "Estimates");
  EXPECT_GE(document["figures"].size(), 9U) << "estimates, six runs, autocorrelation, sensitivities";
}

}  // namespace
}  // namespace poise::app_tests::html_test

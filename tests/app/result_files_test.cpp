#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"

namespace poise::app_tests::result_files_test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// Runs poise and reads the JSON it wrote; the exit code must be as expected.
json result_of(const TempFolder& folder, std::vector<std::string> words, int exit_code) {
  const std::string file = folder.path("result.json").string();
  words.insert(words.end(), {"--json", file});
  const ProgramRun run = run_poise(words);
  EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
  EXPECT_NE(run.out.find("wrote " + file), std::string::npos) << run.out;
  return json::parse(contents(file));
}

TEST(ResultFiles, JsonHoldsTheWholeResultInUnitsOfTheScene) {
  const TempFolder folder;
  const json r = result_of(folder, {"solve", folder.write("a.toml", workshop_pendulum)}, 0);
  EXPECT_EQ(r["method"], "virtual-work");
  EXPECT_EQ(r["seek"], "settle");
  EXPECT_EQ(r["settled"]["end"], "settled");
  EXPECT_EQ(r["status"], "confirmed");
  EXPECT_EQ(r["stability"], "stable");
  EXPECT_GT(r["iterations"], 0);
  EXPECT_GT(r["evaluations"], 0);
  EXPECT_GT(r["microseconds"], 0.0);
  EXPECT_EQ(r["scene"]["title"], "Rod & \"pin\" <test>");
  EXPECT_EQ(r["units"]["length"], "mm");
  EXPECT_EQ(r["units"]["angle"], "deg");
  EXPECT_EQ(r["units"]["energy"], "kN mm");
  EXPECT_NEAR(r["angles"]["a<b"], 0.0, 1e-12);
  EXPECT_NEAR(r["points"]["a<b.tip"][0], 200.0, 1e-10);
  EXPECT_NEAR(r["points"]["a<b.tip"][1], 0.0, 1e-10);
  EXPECT_EQ(r["points"]["ground.O"][0], 0.0);
  EXPECT_NEAR(r["energy"], -600.0, 1e-9) << "a pull of 3 kN over 200 mm";
  EXPECT_TRUE(r["slides"].empty());
  ASSERT_EQ(r["reactions"].size(), 1U);
  EXPECT_EQ(r["reactions"][0]["name"], "\"hinge\"");
  EXPECT_EQ(r["reactions"][0]["kind"], "pin");
  EXPECT_NEAR(r["reactions"][0]["force"][0], -3.0, 1e-12);
  EXPECT_EQ(r["reactions"][0]["determined"], true);
  EXPECT_LT(r["residuals"]["closure_error"], 1e-10);
  EXPECT_LT(r["residuals"]["imbalance"], 1e-12);
  EXPECT_LT(r["error"], 1e-14);
  EXPECT_EQ(r["reference"]["refined"], true);
  EXPECT_EQ(r["reference"]["coordinates"][0]["unit"], "rad");
}

TEST(ResultFiles, SettledPosesOfFreeBodiesAreInTheWorld) {
  // Two springs push a point over their line up; under the load it snaps through.
  const TempFolder folder;
  const std::string scene = folder.write("free.toml", R"(
ground.points = { L = [-0.3, 0], R = [0.3, 0] }
body.k.points = { K = [0, 0] }
spring = [{ name = "l", points = ["ground.L", "k.K"], stiffness = 1000, free_length = 1.044030650891055 },
          { name = "r", points = ["ground.R", "k.K"], stiffness = 1000, free_length = 1.044030650891055 }]
force = [{ name = "P", at = "k.K", vector = [0, -300] }]
start.position.k = [0, 1]
)");
  const json r = result_of(folder, {"solve", scene}, 0);
  ASSERT_EQ(r["settled"]["sides"].size(), 2U);
  for (const json& pose : {r["settled"]["pose"], r["settled"]["sides"][0]["pose"], r["settled"]["sides"][1]["pose"]}) {
    EXPECT_NEAR(pose["k.x"], 0.0, 1e-12);
    EXPECT_NEAR(pose["k.y"], r["points"]["k.K"][1], 1e-9);
  }
}

TEST(ResultFiles, JsonHoldsSlidesSpringsAndStops) {
  const TempFolder folder;
  const json r = result_of(folder, {"solve", folder.write("a.toml", against_the_stop), "--set", "load.push=5"}, 0);
  EXPECT_NEAR(r["slides"]["rail"], 0.25, 1e-12);
  EXPECT_EQ(r["stops"]["end"]["active"], "max");
  EXPECT_TRUE(r["stops"]["end"]["min"].is_null()) << "no limit is no number";
  EXPECT_EQ(r["scene"]["set"], json({"load.push=5"}));

  const json toggle = result_of(folder, {"solve", dataset("von_mises_toggle")}, 0);
  EXPECT_NEAR(toggle["slides"]["guide"], 0.436788903652506562874, 1e-12);
  const double length = std::hypot(1.0, 0.436788903652506562874);
  EXPECT_NEAR(toggle["springs"]["left"]["length"], length, 1e-12);
  EXPECT_NEAR(toggle["springs"]["left"]["force"], 1000 * (length - 1.118033988749894848204587), 1e-9);
}

TEST(ResultFiles, JsonHoldsThePositionsOfFreeBodies) {
  const TempFolder folder;
  const json r = result_of(folder, {"solve", folder.write("tray.toml", hung_tray)}, 0);
  ASSERT_EQ(r["positions"].size(), 1U);
  EXPECT_NEAR(r["positions"]["tray"][0], 500.0, 1e-9);
  EXPECT_NEAR(r["positions"]["tray"][1], -450.0, 1e-9);
  EXPECT_TRUE(r["slides"].empty());
  EXPECT_EQ(r["energy_note"], "springs in full, loads without the part that no motion changes");
  EXPECT_TRUE(result_of(folder, {"solve", dataset("toggle_press")}, 0)["positions"].empty());
}

TEST(ResultFiles, JsonNamesWhatStaticsLeftOut) {
  const TempFolder folder;
  const std::string lever = folder.write("lever.toml", rusty_lever);
  const json solved = result_of(folder, {"solve", lever}, 0);
  ASSERT_EQ(solved["left_out"].size(), 4U) << solved["left_out"];
  const std::string all = solved["left_out"].dump();
  for (const char* name : {"rust", "grease", "nothing", "moment of inertia of 1 body"}) {
    EXPECT_NE(all.find(name), std::string::npos) << name;
  }
  EXPECT_NE(all.find("friction may also hold the mechanism in other positions"), std::string::npos) << all;
  EXPECT_EQ(result_of(folder, {"compare", lever}, 0)["left_out"], solved["left_out"]);
  EXPECT_EQ(result_of(folder, {"compare", lever, "--tolerances", "1e-6", "--repeat", "1"}, 0)["left_out"],
            solved["left_out"]);
}

TEST(ResultFiles, JsonOfCompareListsAllMethods) {
  const TempFolder folder;
  const json r = result_of(folder, {"compare", dataset("toggle_press")}, 0);
  ASSERT_EQ(r["methods"].size(), 2U);
  EXPECT_EQ(r["methods"][0]["method"], "virtual-work");
  EXPECT_EQ(r["methods"][1]["method"], "energy");
  for (const json& method : r["methods"]) {
    EXPECT_EQ(method["status"], "confirmed");
    EXPECT_TRUE(method["error"].is_number());
    EXPECT_EQ(method["reactions"].size(), 7U);
  }
  EXPECT_TRUE(r["agreement"]["same"].is_boolean());
}

TEST(ResultFiles, WhatIsNoNumberIsNull) {
  const TempFolder folder;
  const std::string scene = folder.write("follower.toml", follower);
  const json found = result_of(folder, {"solve", scene}, 0);
  EXPECT_TRUE(found["energy"].is_null()) << "a follower load has no energy";
  const json energy = result_of(folder, {"solve", scene, "--method", "energy"}, 1);
  EXPECT_EQ(energy["status"], "not applicable");
  EXPECT_TRUE(energy["points"].is_null());
  EXPECT_TRUE(energy["error"].is_null());
  const json both = result_of(folder, {"compare", scene}, 0);
  EXPECT_EQ(both["methods"][1]["status"], "not applicable");
  EXPECT_TRUE(both["agreement"].is_null());
  for (const char* method : {"virtual-work", "energy"}) {
    const json nowhere = result_of(folder, {"solve", folder.write("runaway.toml", runaway), "--method", method}, 1);
    EXPECT_NE(nowhere["status"], "confirmed");
    EXPECT_TRUE(nowhere["error"].is_null());
    EXPECT_EQ(nowhere["stability"], "unknown");
  }
}

TEST(ResultFiles, SvgIsWellFormedAndNamesWhatItShows) {
  const TempFolder folder;
  const std::string file = folder.path("a.svg").string();
  EXPECT_EQ(run_poise({"solve", folder.write("a.toml", workshop_pendulum), "--svg", file}).exit_code, 0);
  const std::string svg = contents(file);
  EXPECT_EQ(objection_to_xml(svg), "");
  for (const char* part : {"Rod &amp; &quot;pin&quot; &lt;test&gt;", "Source: ours", "&lt;P&gt; = 3 kN",
                           "&quot;hinge&quot;", "In equilibrium, proved: stable", "starting position", "mm</text>"}) {
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(ResultFiles, SvgMarksWhatIsNotConfirmed) {
  const TempFolder folder;
  const std::string file = folder.path("a.svg").string();
  const std::string scene = folder.write("runaway.toml", runaway);
  EXPECT_EQ(run_poise({"solve", scene, "--svg", file}).exit_code, 1);
  const std::string svg = contents(file);
  EXPECT_EQ(objection_to_xml(svg), "");
  EXPECT_NE(svg.find("No equilibrium proved"), std::string::npos);
}

TEST(ResultFiles, MethodThatDoesNotApplyDrawsNothing) {
  const TempFolder folder;
  const std::string scene = folder.write("follower.toml", follower);
  EXPECT_EQ(run_poise({"solve", scene, "--method", "energy", "--svg", folder.path("a.svg").string()}).exit_code, 1);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"follower.toml"});
}

TEST(ResultFiles, SvgOfAThousandLinksStaysSmall) {
  const TempFolder folder;
  const std::string file = folder.path("a.svg").string();
  EXPECT_EQ(run_poise({"solve", folder.write("links.toml", hanging_links(1000)), "--svg", file}).exit_code, 0);
  EXPECT_EQ(objection_to_xml(contents(file)), "");
  EXPECT_LT(fs::file_size(file), 100000U);
}

TEST(ResultFiles, UnwritablePathIsFoundBeforeSolving) {
  const TempFolder folder;
  const std::string scene = folder.write("a.toml", pendulum);
  fs::create_directory(folder.path("folder"));
  const std::vector<std::pair<std::string, std::string>> cases = {
      {folder.path("no/such/folder/a.json").string(), "No such file or directory"},
      {folder.path("folder").string(), "it is a folder"},
      {scene, "is the scene too"},
      {folder.path("folder/../a.toml").string(), "is the scene too"}};
  const std::vector<std::string> before = folder.names();
  for (const auto& [path, says] : cases) {
    for (const char* option : {"--json", "--svg"}) {
      const ProgramRun run = run_poise({"solve", scene, option, path});
      EXPECT_EQ(run.exit_code, 2) << path;
      EXPECT_EQ(run.out, "");
      EXPECT_NE(run.err.find(option), std::string::npos) << run.err;
      EXPECT_NE(run.err.find(says), std::string::npos) << run.err;
    }
  }
  const std::string same = folder.path("same").string();
  EXPECT_EQ(run_poise({"solve", scene, "--json", same, "--svg", same}).exit_code, 2);
  EXPECT_EQ(folder.names(), before);
  EXPECT_EQ(contents(scene), pendulum);
}

TEST(ResultFiles, ReplaceWhatWasThereWholeAndLeaveNothingElse) {
  const TempFolder folder;
  const std::string scene = folder.write("a.toml", pendulum);
  const std::string file = folder.write("a.json", "old");
  EXPECT_EQ(run_poise({"solve", scene, "--json", file}).exit_code, 0);
  EXPECT_EQ(json::parse(contents(file))["status"], "confirmed");
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"a.json", "a.toml"}));
  // A run that fails leaves the old files unchanged.
  const std::string kept = contents(file);
  EXPECT_EQ(run_poise({"solve", scene, "--json", file, "--set", "load.P=x"}).exit_code, 2);
  EXPECT_EQ(contents(file), kept);
}

TEST(ResultFiles, LinkStaysALinkAndItsTargetIsReplaced) {
  const TempFolder folder;
  const std::string scene = folder.write("a.toml", pendulum);
  folder.write("target.json", "old");
  fs::create_symlink("target.json", folder.path("link.json"));
  EXPECT_EQ(run_poise({"solve", scene, "--json", folder.path("link.json").string()}).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(folder.path("link.json")));
  EXPECT_EQ(json::parse(contents(folder.path("target.json")))["status"], "confirmed");
}

TEST(ResultFiles, LinkToNothingLeadsToANewFile) {
  const TempFolder folder;
  const std::string scene = folder.write("a.toml", pendulum);
  fs::create_symlink("second.json", folder.path("first.json"));
  fs::create_symlink("target.json", folder.path("second.json"));
  EXPECT_EQ(run_poise({"solve", scene, "--json", folder.path("first.json").string()}).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(folder.path("first.json")));
  EXPECT_EQ(json::parse(contents(folder.path("target.json")))["status"], "confirmed");
  fs::create_symlink("round.svg", folder.path("round.svg"));
  const ProgramRun round = run_poise({"solve", scene, "--svg", folder.path("round.svg").string()});
  EXPECT_EQ(round.exit_code, 2);
  EXPECT_NE(round.err.find("links lead in a circle"), std::string::npos) << round.err;
  fs::create_symlink("none/out.csv", folder.path("far.csv"));
  EXPECT_EQ(run_poise({"loads", scene, "--csv", folder.path("far.csv").string()}).exit_code, 2);
}

TEST(ResultFiles, DeviceIsWrittenToAndNotReplaced) {
  const TempFolder folder;
  const ProgramRun run = run_poise({"solve", folder.write("a.toml", pendulum), "--json", "/dev/null"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(ResultFiles, FullDiskIsAnError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  const TempFolder folder;
  const ProgramRun run = run_poise({"solve", folder.write("a.toml", pendulum), "--json", "/dev/full"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("No space left"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace poise::app_tests::result_files_test

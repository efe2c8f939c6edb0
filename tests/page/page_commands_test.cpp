// Commands that a person runs in the page of `poise view`, and the mechanisms to begin with, without a browser.
#include "app/view/page_commands.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/commands/commands.hpp"
#include "app/view/templates.hpp"
#include "app/view/view_session.hpp"
#include "model/scene.hpp"
#include "statics/equilibrium/named_equilibrium.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app::page_commands_test {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::run_poise;
using app_tests::TempFolder;
using nlohmann::json;

class PageCommandsOf : public testing::Test {
 protected:
  std::string copy(const std::string& name) { return folder_.write(name + ".toml", contents(dataset(name))); }

  static json asked(ViewSession& session, json request) {
    request["revision"] = session.poll(0)["revision"];
    return json::parse(session.act(request));
  }

  static std::string error_of(const json& answer) { return answer.contains("error") ? answer["error"]["text"] : ""; }

  /// The answer once the command has ended.
  static json ended(ViewSession& session) {
    for (;;) {
      json answer = asked(session, {{"do", "result"}});
      if (answer["run"]["state"] != "running") return answer["run"];
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  static json ran(ViewSession& session, const std::string& command, const json& options) {
    const json answer = asked(session, {{"do", "run"}, {"command", command}, {"options", options}});
    EXPECT_EQ(error_of(answer), "");
    return ended(session);
  }

  static json options_of(const json& commands, const std::string& name) {
    const auto found =
        std::find_if(commands.begin(), commands.end(), [&](const json& one) { return one["name"] == name; });
    return found != commands.end() ? (*found)["options"] : json(nullptr);
  }

  TempFolder folder_;
};

/// All numbers of a document by their places, but for times, which differ from run to run.
void gather(const json& document, const std::string& place, std::map<std::string, double>& out) {
  if (document.is_number()) out[place] = document.get<double>();
  if (!document.is_structured()) return;
  for (const auto& [key, value] : document.items()) {
    if (key.find("seconds") == std::string::npos && key.find("time") == std::string::npos)
      gather(value, fmt::format("{}/{}", place, key), out);
  }
}

void expect_same_numbers(const json& page, const json& file) {
  std::map<std::string, double> in_page, in_file;
  gather(page, "", in_page);
  gather(file, "", in_file);
  ASSERT_EQ(in_page.size(), in_file.size());
  EXPECT_GT(in_page.size(), 20U);
  for (const auto& [place, value] : in_file) {
    ASSERT_TRUE(in_page.contains(place)) << place;
    // A page has nine digits; below 1e-12 there is rounding alone.
    EXPECT_NEAR(in_page[place], value, 1e-8 * std::abs(value) + 1e-12) << place;
  }
}

TEST(PageCommands, HaveADecisionOnEveryCommand) {
  for (const CommandEntry& entry : all_commands()) {
    EXPECT_NE(entry.in_page, InPage::undecided)
        << entry.command.name << ": say in commands.cpp whether a page can run it";
  }
}

TEST(PageCommands, HaveADecisionOnEveryFile) {
  for (const CommandEntry& entry : all_commands()) {
    for (const Option& option : entry.command.options) {
      EXPECT_TRUE(option.ending.empty() || option.use != Use::question)
          << entry.command.name << " " << option.name << ": say with reads() or writes() what becomes of the file";
    }
  }
}

TEST_F(PageCommandsOf, AClampGiveTheNumbersOfTheCommandLine) {
  ViewSession session(copy("toggle_clamp"));
  // What is computed is what is shown, not the file.
  ASSERT_EQ(error_of(asked(session, {{"do", "set"}, {"path", "load.P"}, {"value", 25}})), "");
  const std::map<std::string, json> given = {{"path", json::array({{"--vary", "load.P=0..60"}})},
                                             {"equilibria", json::array()},
                                             {"sensitivity", json::array({{"--of", "force.rubber"}})}};
  for (const auto& [command, options] : given) {
    SCOPED_TRACE(command);
    const json run = ran(session, command, options);
    EXPECT_EQ(run["state"], "done") << run["error"];
    const std::string scene = folder_.write("shown.toml", run["text"].get<std::string>());
    std::vector<std::string> words = {command, scene, "--json", folder_.path("result.json").string()};
    for (const json& option : options) words.insert(words.end(), option.begin(), option.end());
    run_poise(words);
    expect_same_numbers(run["page"]["result"], json::parse(contents(folder_.path("result.json"))));
    EXPECT_EQ(run["line"].get<std::string>().rfind("poise " + command + " ", 0), 0U);
    EXPECT_EQ(run["page"]["line"], run["line"]);
  }
  EXPECT_NE(asked(session, {{"do", "result"}, {"html", true}})["html"].get<std::string>().find("<!DOCTYPE html>"),
            std::string::npos);
}

TEST_F(PageCommandsOf, AMechanismThatIsNoFileAreRunWithinTheProgram) {
  const std::string text = contents(dataset("toggle_clamp"));
  ViewSession session(SceneInMemory{parse_scene(text, "clamp.toml"), text, "clamp.toml"});
  const json run = ran(session, "solve", json::array());
  EXPECT_EQ(run["state"], "done") << run["error"];
  EXPECT_EQ(run["line"], "poise solve clamp.toml");
  EXPECT_EQ(run["page"]["verdict"]["text"], "In equilibrium, proved: stable.");
  EXPECT_FALSE(run["saved"]);
}

TEST_F(PageCommandsOf, WorkLeaveTheMechanismFreeAndCanBeStopped) {
  ViewSession session(copy("excavator"));
  const json begun = asked(session, {{"do", "run"},
                                     {"command", "equilibria"},
                                     {"options", json::array({{"--seconds", "600"}, {"--starts", "1000000"}})}});
  ASSERT_EQ(error_of(begun), "");
  EXPECT_EQ(begun["run"]["state"], "running");
  const json moved = asked(session, {{"do", "set"}, {"path", "body.bucket.mass"}, {"value", 1500}});
  EXPECT_EQ(error_of(moved), "");
  EXPECT_EQ(asked(session, {{"do", "result"}})["run"]["state"], "running");
  const json again = asked(session, {{"do", "run"}, {"command", "solve"}});
  EXPECT_EQ(error_of(again), "poise equilibria is still running; stop it first, or wait");
  asked(session, {{"do", "stop"}});
  const json run = ended(session);
  EXPECT_TRUE(run["stopped"]);
  EXPECT_EQ(run["state"], "done") << run["error"];
  EXPECT_NE(run["of"], moved["revision"]) << "it is of the mechanism before";
  EXPECT_NE(run["text"], moved["text"]);
  EXPECT_NE(run["page"].dump().find("nterrupted"), std::string::npos) << "says that it was stopped";
}

TEST_F(PageCommandsOf, ASceneWriteNothingAndReadOnlyItsFolder) {
  ViewSession session(copy("toggle_clamp"));
  const auto refused = [&](const std::string& command, const json& options) {
    return error_of(asked(session, {{"do", "run"}, {"command", command}, {"options", options}}));
  };
  const std::string out = folder_.path("out.json").string();
  EXPECT_EQ(refused("solve", json::array({{"--json", out}})),
            "poise: --json: expected an option that the page offers; use it on the command line");
  EXPECT_EQ(refused("solve", json::array({{"SCENE", dataset("zeeman")}})),
            "poise: SCENE: expected an option that the page offers; use it on the command line");
  EXPECT_EQ(refused("stress", json::array()),
            "poise: stress: expected a command that the page offers; use the command line");
  EXPECT_NE(refused("tolerance", json::array({{"--tolerances", "/etc/passwd"}, {"--of", "energy"}}))
                .find("expected a file .toml in the folder of the scene, found \"/etc/passwd\""),
            std::string::npos);
  EXPECT_NE(refused("solve", json::array({{"--metod", "energy"}})).find("did you mean \"--method\"?"),
            std::string::npos);
  EXPECT_EQ(folder_.names(), std::vector<std::string>({"toggle_clamp.toml"}));
  // What is wrong with a word is said in the one line of the command line.
  const json run = ran(session, "path", json::array({{"--vary", "load.Q=0..60"}}));
  EXPECT_EQ(run["state"], "failed");
  EXPECT_EQ(run["error"].get<std::string>() + "\n",
            run_poise({"path", folder_.path("toggle_clamp.toml").string(), "--vary", "load.Q=0..60"}).err);
}

TEST_F(PageCommandsOf, AnExperimentAreThoseOfTheScenesFolder) {
  ViewSession session(copy("lift"));
  EXPECT_EQ(options_of(asked(session, {{"do", "commands"}})["commands"], "identifiability"), nullptr);
  const std::string experiment = copy("lift_experiment_empty");
  const json commands = asked(session, {{"do", "commands"}})["commands"];
  const json options = options_of(commands, "identifiability");
  ASSERT_TRUE(options.is_array());
  EXPECT_EQ(options[0]["name"], "EXPERIMENT");
  EXPECT_EQ(options[0]["choices"], json::array({experiment}));
  EXPECT_EQ(options_of(commands, "tolerance")[1]["choices"], json::array({experiment}));
  const json run = ran(session, "identifiability", json::array({{"EXPERIMENT", experiment}}));
  EXPECT_EQ(run["state"], "done") << run["error"];
  EXPECT_EQ(run["line"], "poise identifiability " + experiment);
  ASSERT_EQ(error_of(asked(session, {{"do", "set"}, {"path", "body.payload.mass"}, {"value", 100}})), "");
  // What is computed is what the page shows, not what the file has: as if it were saved.
  const json shown = ran(session, "identifiability", json::array({{"EXPERIMENT", experiment}}));
  EXPECT_EQ(shown["state"], "done") << shown["error"];
  EXPECT_EQ(shown["saved"], false);
  ASSERT_EQ(error_of(asked(session, {{"do", "save"}})), "");
  const json saved = ran(session, "identifiability", json::array({{"EXPERIMENT", experiment}}));
  EXPECT_EQ(shown["page"]["result"], saved["page"]["result"]);
  EXPECT_NE(shown["page"]["result"], run["page"]["result"]);
}

TEST_F(PageCommandsOf, ASketchSayWhatIsMissing) {
  ViewSession session(new_scene());
  const json run = ran(session, "solve", json::array());
  EXPECT_EQ(run["state"], "failed");
  EXPECT_NE(run["error"].get<std::string>().find("expected"), std::string::npos) << run["error"];
}

TEST_F(PageCommandsOf, TemplatesAreTheDatasetsAtRest) {
  ViewSession session(new_scene());
  const json list = asked(session, {{"do", "templates"}})["templates"];
  EXPECT_EQ(list.size(), scene_templates().size());
  EXPECT_GE(list.size(), 14U);
  std::set<std::string> names;
  for (const SceneTemplate& one : scene_templates()) {
    SCOPED_TRACE(one.name);
    names.emplace(one.name);
    const std::string file(one.file);
    EXPECT_EQ(one.text, contents(dataset(file.substr(0, file.find(".toml")))));
    const json answer = asked(session, {{"do", "templates"}, {"name", one.name}});
    EXPECT_GT(answer["drawing"]["shapes"].size(), 5U);
    const json state = asked(session, {{"do", "text"}, {"text", answer["text"]}, {"fit", true}});
    ASSERT_EQ(error_of(state), "");
    const NamedEquilibrium found = solve(parse_scene(one.text, file));
    ASSERT_TRUE(found.found()) << found.result().why;
    const Scene& scene = session.tracked().scene();
    EXPECT_EQ(state["title"], scene.title);
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
      EXPECT_NEAR(std::remainder(found.angle(scene.bodies[i].name) - session.tracked().poses()[i].angle, 2 * M_PI), 0.0,
                  1e-9)
          << scene.bodies[i].name;
    }
    const json undone = asked(session, {{"do", "undo"}});
    EXPECT_NE(undone["text"], state["text"]);
  }
  EXPECT_EQ(names.size(), scene_templates().size()) << "names are unique";
  EXPECT_NE(error_of(asked(session, {{"do", "templates"}, {"name", "lampe"}})).find("did you mean \"lamp\"?"),
            std::string::npos);
}

}  // namespace
}  // namespace poise::app::page_commands_test

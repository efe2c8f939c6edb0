// What `poise view` answers to requests, without a browser.
#include "app/view/view_session.hpp"

#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "statics/equilibrium/named_equilibrium.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/support/seed.hpp"

namespace poise::app::view_session_test {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::TempFolder;
using nlohmann::json;

/// Asks as a page does that has seen the present state.
json asked(ViewSession& session, json request) {
  request["revision"] = session.poll(0)["revision"];
  return json::parse(session.act(request));
}

json look(ViewSession& session) { return asked(session, {{"do", "look"}}); }

std::string error_of(const json& answer) { return answer.contains("error") ? answer["error"]["text"] : ""; }

/// Greatest difference of the angles shown from those that the scene's text gives to `solve`.
double apart_from_solve(ViewSession& session, const std::string& text) {
  const NamedEquilibrium found = solve(parse_scene(text, session.tracked().scene().file));
  if (!found.found()) return INFINITY;
  const TrackedEquilibrium& tracked = session.tracked();
  double most = 0.0;
  for (std::size_t i = 1; i < tracked.scene().bodies.size(); ++i) {
    most = std::max(most, std::abs(found.angle(tracked.scene().bodies[i].name) - tracked.poses()[i].angle));
  }
  return most;
}

/// A copy of a dataset that can be written to.
struct OwnScene {
  explicit OwnScene(const std::string& name)
      : file(folder.write(std::filesystem::path(name).filename().string() + ".toml", contents(dataset(name)))) {}
  TempFolder folder;
  std::string file;
};

json handle_of(const json& state, const std::string& kind, const std::string& name) {
  for (const json& handle : state["handles"]) {
    if (handle["kind"] == kind && handle["name"] == name) return handle;
  }
  return nullptr;
}

TEST(ViewSession, BeginsWhereSolveSettles) {
  const OwnScene own("toggle_clamp");
  ViewSession session(own.file);
  const json state = look(session);
  EXPECT_EQ(state["verdict"]["text"], "In equilibrium, proved: stable.");
  EXPECT_NEAR(session.tracked().poses()[1].angle, 1.6337822873154150442, 1e-14);
  EXPECT_LT(apart_from_solve(session, state["text"]), 1e-12);
  EXPECT_TRUE(session.page()["view"]["drawing"]["frames"].is_array());
}

TEST(ViewSession, DraggedPointComesToThePointer) {
  const OwnScene own("four_bar_gravity");
  ViewSession session(own.file);
  const json before = look(session);
  const std::string point = "crank.B";
  const json px = handle_of(before, "point", point)["px"];
  json state;
  for (int k = 1; k <= 40; ++k) {
    // Along the circle round the fixed pivot A.
    const json a = handle_of(before, "ground", "A")["px"];
    const double x = px[0].get<double>() - a[0].get<double>(), y = px[1].get<double>() - a[1].get<double>();
    const double turn = 0.02 * k;
    const json to = {a[0].get<double>() + x * std::cos(turn) - y * std::sin(turn),
                     a[1].get<double>() + x * std::sin(turn) + y * std::cos(turn)};
    state = asked(session, {{"do", "drag"}, {"point", point}, {"px", to}});
    ASSERT_EQ(error_of(state), "");
    ASSERT_TRUE(session.tracked().equilibrium().found());
    const json now = handle_of(state, "point", point)["px"];
    EXPECT_LT(std::hypot(now[0].get<double>() - to[0].get<double>(), now[1].get<double>() - to[1].get<double>()), 0.05);
    // What is held is an equilibrium of the scene with the stops of the hand.
    const json whole = look(session);
    SolveOptions any;
    any.seek = Seek::any;
    const std::string held = whole["text"].get<std::string>() + whole["hand"]["stops"].get<std::string>();
    const NamedEquilibrium again = solve(parse_scene(held, "held.toml"), any);
    ASSERT_TRUE(again.found()) << again.result().why;
    EXPECT_NEAR(again.angle("crank"), session.tracked().poses()[1].angle, 1e-9);
  }
  state = asked(session, {{"do", "release"}});
  EXPECT_EQ(state["transition"]["kind"], "settled");
  EXPECT_GT(state["drawing"]["frames"].size(), 2U);
  EXPECT_LT(apart_from_solve(session, state["text"]), 1e-9);
}

TEST(ViewSession, LoadBeyondTheFoldSnapsAndSaysSo) {
  const OwnScene own("toggle_clamp");
  ViewSession session(own.file);
  json state = asked(session, {{"do", "set"}, {"path", "load.P"}, {"value", 37}});
  EXPECT_EQ(state["transition"]["kind"], "none") << "the stop holds it where it was";
  state = asked(session, {{"do", "set"}, {"path", "load.P"}, {"value", 37.2}});
  EXPECT_EQ(state["transition"]["kind"], "snapped");
  // The force of the stop vanishes at P = 37.093431951696662419 N (datasets/toggle_clamp.toml).
  EXPECT_EQ(state["transition"]["why"], "it snaps at load.P = 37.0934 N, where the stable equilibrium ends");
  EXPECT_GT(state["drawing"]["frames"].size(), 3U);
  EXPECT_NEAR(session.tracked().poses()[1].angle * 180 / M_PI, 23.413452, 1e-3);
  state = asked(session, {{"do", "undo"}});
  EXPECT_NEAR(session.tracked().poses()[1].angle, 1.63378, 1e-3);
}

TEST(ViewSession, GestureIsOneStepForUndo) {
  const OwnScene own("toggle_clamp");
  ViewSession session(own.file);
  EXPECT_EQ(look(session)["saved"], true);
  for (const double load : {26.0, 28.0, 30.0}) {
    const json moving = asked(session, {{"do", "set"}, {"path", "load.P"}, {"value", load}, {"goes_on", true}});
    EXPECT_EQ(moving["undo"], 1);
    EXPECT_FALSE(moving.contains("text"));
  }
  json state = asked(session, {{"do", "set"}, {"path", "load.P"}, {"value", 31}});
  EXPECT_EQ(state["undo"], 1);
  EXPECT_EQ(state["saved"], false);
  state = asked(session, {{"do", "undo"}});
  EXPECT_DOUBLE_EQ(norm(session.tracked().scene().forces[0].vector), 25.0);
  EXPECT_EQ(state["saved"], true);
}

TEST(ViewSession, FieldsFollowAPointThatIsDragged) {
  const OwnScene own("toggle_clamp");
  ViewSession session(own.file);
  json px = handle_of(look(session), "ground", "W")["px"];
  px[0] = px[0].get<double>() + 3.0;
  const json moving = asked(session, {{"do", "ground"}, {"point", "W"}, {"px", px}, {"goes_on", true}});
  ASSERT_EQ(error_of(moving), "");
  std::map<std::string, double> changed;
  for (const json& one : moving["changed"]) changed[one["path"]] = one["value"];
  const Vec2 now = session.tracked().scene().bodies[0].points[2].at;
  ASSERT_TRUE(changed.contains("point.ground.W.x"));
  EXPECT_NEAR(changed["point.ground.W.x"], now.x / 1e-3, 1e-9);
  EXPECT_GT(now.x, 0.0861) << "it was at 86 mm";
  EXPECT_FALSE(changed.contains("point.ground.A.x"));
  EXPECT_FALSE(look(session).contains("changed"));
}

TEST(ViewSession, BadTextNamesItsLineAndChangesNothing) {
  const OwnScene own("toggle_clamp");
  ViewSession session(own.file);
  const std::string text = look(session)["text"];
  std::string bad = text;
  bad.replace(bad.find("mass = 0.28"), 11, "mass = -1.0");
  const json answer = asked(session, {{"do", "text"}, {"text", bad}});
  ASSERT_TRUE(answer.contains("error"));
  const auto line =
      1 + std::count(bad.begin(), bad.begin() + static_cast<std::ptrdiff_t>(bad.find("mass = -1.0")), '\n');
  EXPECT_EQ(answer["error"]["line"], line) << answer["error"]["text"];
  EXPECT_EQ(look(session)["text"], text);
}

TEST(ViewSession, RequestsWithoutMeaningAreAnswered) {
  const OwnScene own("four_bar_gravity");
  ViewSession session(own.file);
  const std::string text = look(session)["text"];
  const std::vector<json> requests = {json::object(),
                                      {{"do", 7}},
                                      {{"do", "dance"}},
                                      {{"do", "drag"}},
                                      {{"do", "drag"}, {"point", "crank.Z"}, {"px", {1, 2}}},
                                      {{"do", "drag"}, {"point", "ground.A"}, {"px", {1, 2}}},
                                      {{"do", "drag"}, {"point", "crank.B"}, {"px", {1}}},
                                      {{"do", "drag"}, {"point", "crank.B"}, {"px", {"a", "b"}}},
                                      {{"do", "set"}, {"path", "load.Q"}, {"value", 1}},
                                      {{"do", "set"}, {"path", "body.crank.mass"}, {"value", -1}},
                                      {{"do", "set"}, {"path", "body.crank.mass"}, {"value", nullptr}},
                                      {{"do", "set"}, {"path", "point.rocker.C.x"}, {"value", 1e9}},
                                      {{"do", "switch"}, {"item", "spring.none"}, {"on", false}},
                                      {{"do", "load"}, {"name", "none"}, {"px", {1, 2}}},
                                      {{"do", "ground"}, {"point", "A"}, {"px", {1e60, 1e60}}},
                                      {{"do", "go"}, {"number", 99}},
                                      {{"do", "go"}, {"number", 1e30}},
                                      {{"do", "go"}, {"number", -1}},
                                      {{"do", "go"}, {"number", 0.5}},
                                      {{"do", "undo"}},
                                      {{"do", "redo"}},
                                      {{"do", "text"}, {"text", "\xff\xfe"}},
                                      {{"do", "text"}, {"text", std::string(1000, '[')}}};
  for (const json& request : requests) {
    const json answer = asked(session, request);
    EXPECT_NE(error_of(answer), "") << request.dump(-1, ' ', false, json::error_handler_t::replace);
    EXPECT_EQ(error_of(answer).find('\n'), std::string::npos);
  }
  EXPECT_EQ(look(session)["text"], text);
}

/// What the page is answered, but for the time that it took.
json timeless(json answer) {
  answer.erase("server_ms");
  return answer;
}

// A point that was moved beyond what a file may hold was refused when it was in the scene already.
TEST(ViewSession, ARefusedChangeChangesNothing) {
  const OwnScene own("toggle_clamp");
  ViewSession session(own.file);
  asked(session, {{"do", "set"}, {"path", "load.P"}, {"value", 26}});
  const json before = timeless(look(session));
  for (const json& request : std::vector<json>{{{"do", "ground"}, {"point", "A"}, {"px", {1e60, 0}}},
                                               {{"do", "ground"}, {"point", "A"}, {"px", {0, -1e60}}},
                                               {{"do", "load"}, {"name", "P"}, {"px", {1e300, 1e300}}},
                                               {{"do", "text"}, {"text", "[ground]\npoints = { A = [0, 0] }\n"}},
                                               {{"do", "drag"}, {"point", "arm.B"}, {"px", {1e300, 0}}}}) {
    const json answer = asked(session, request);
    if (error_of(answer).empty()) {
      asked(session, {{"do", "release"}});
      asked(session, {{"do", "undo"}});
      continue;
    }
    EXPECT_EQ(timeless(look(session)), before) << request << " " << error_of(answer);
  }
}

TEST(ViewSession, PulledLoadKeepsItsDirectionAndSizeApart) {
  const TempFolder folder;
  std::string text = contents(dataset("toggle_clamp"));
  const std::string vector = "vector = [0, 25]";
  ASSERT_NE(text.find(vector), std::string::npos);
  text.replace(text.find(vector), vector.size(), "direction = [0, 1]\nsize = 25");
  ViewSession session(folder.write("clamp.toml", text));
  const json before = look(session);
  const json px = handle_of(before, "load", "P")["px"];
  const json to = {px[0].get<double>() + 30.0, px[1].get<double>() + 10.0};
  const json state = asked(session, {{"do", "load"}, {"name", "P"}, {"px", to}});
  ASSERT_EQ(error_of(state), "");
  const std::string written = look(session)["text"];
  const Scene scene = parse_scene(written, "clamp.toml"), &shown = session.tracked().scene();
  EXPECT_NE(written.find("direction = ["), std::string::npos);
  EXPECT_EQ(written.find("direction = [0, 1]"), std::string::npos);
  EXPECT_NEAR(scene.forces[0].vector.x, shown.forces[0].vector.x, 1e-12 * norm(shown.forces[0].vector));
  EXPECT_NEAR(scene.forces[0].vector.y, shown.forces[0].vector.y, 1e-12 * norm(shown.forces[0].vector));
  EXPECT_GT(std::abs(shown.forces[0].vector.x), 0.1);
  EXPECT_EQ(error_of(asked(session, {{"do", "set"}, {"path", "load.P"}, {"value", 0}})), "");
  EXPECT_EQ(error_of(asked(session, {{"do", "set"}, {"path", "load.P"}, {"value", -3}})), "");
  EXPECT_LT(apart_from_solve(session, look(session)["text"]), 1e-9);
}

TEST(ViewSession, RefusesWhatIsForAnotherState) {
  const OwnScene own("toggle_clamp");
  ViewSession session(own.file);
  const json seen = look(session);
  const json request = {{"do", "set"}, {"path", "load.P"}, {"value", 26}, {"revision", seen["revision"]}};
  EXPECT_EQ(error_of(json::parse(session.act(request))), "");
  // Another window has seen only what was before.
  for (const json& late : std::vector<json>{request,
                                            {{"do", "text"}, {"text", seen["text"]}, {"revision", seen["revision"]}},
                                            {{"do", "save"}, {"revision", seen["revision"]}},
                                            {{"do", "undo"}, {"revision", 1e30}},
                                            {{"do", "undo"}, {"revision", "2"}}}) {
    const json answer = json::parse(session.act(late));
    EXPECT_NE(error_of(answer).find("changed elsewhere"), std::string::npos) << error_of(answer);
    EXPECT_EQ(answer["revision"], 2);
  }
  EXPECT_NE(error_of(json::parse(session.act({{"do", "undo"}}))).find("revision: expected"), std::string::npos);
  EXPECT_EQ(look(session)["revision"], 2);
}

// Pages may have the program read the files of the scene's folder, and those that whoever wrote the scene named.
TEST(ViewSession, ReadsFilesOfItsFolderAlone) {
  const TempFolder folder;
  const std::string points = "x,F\n0,0\n1,10\n2,30\n";
  folder.write("inside.csv", points);
  const TempFolder elsewhere;
  const std::string outside = elsewhere.write("outside.csv", points), named = elsewhere.write("named.csv", points);
  std::filesystem::create_symlink(outside, folder.path("link.csv"));
  const auto scene = [](const std::string& file) {
    return "[ground]\npoints = { A = [0, 0], B = [3, 0] }\n[body.arm]\npoints = { A = [0, 0], C = [1, 0] }\n"
           "[[pin]]\npoints = [\"ground.A\", \"arm.A\"]\n[[spring]]\nname = \"s\"\n"
           "points = [\"ground.B\", \"arm.C\"]\nforce = { file = \"" +
           file + "\" }\n[start]\narm = 1\n";
  };
  ViewSession session(folder.write("scene.toml", scene(named)));
  EXPECT_EQ(error_of(asked(session, {{"do", "text"}, {"text", scene("inside.csv")}})), "");
  EXPECT_EQ(error_of(asked(session, {{"do", "text"}, {"text", scene(named)}})), "");
  const std::string present = look(session)["text"];
  for (const std::string& file :
       {outside, "../" + std::filesystem::path(outside).parent_path().filename().string() + "/outside.csv",
        std::string("link.csv"), std::string("/etc/passwd"), std::string("/dev/zero")}) {
    const json answer = asked(session, {{"do", "text"}, {"text", scene(file)}});
    EXPECT_NE(error_of(answer).find("expected a file in the folder of the scene"), std::string::npos)
        << error_of(answer);
    EXPECT_TRUE(answer["error"]["line"].is_number()) << file;
  }
  EXPECT_EQ(look(session)["text"], present);
}

// A pipe would wait for a writer.
TEST(ViewSession, OpensNoPipe) {
  const OwnScene own("four_bar_gravity");
  const std::string pipe = own.folder.path("pipe.toml");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(ViewSession{pipe}, InputError);
  ViewSession session(own.file);
  std::filesystem::rename(pipe, own.file);
  EXPECT_EQ(session.poll(0)["file"], "gone");
  for (const json& request :
       std::vector<json>{{{"do", "save"}}, {{"do", "save"}, {"anyway", true}}, {{"do", "reload"}}}) {
    EXPECT_NE(error_of(asked(session, request)).find("a device or a pipe"), std::string::npos) << request;
  }
  const std::string curve =
      "[[spring]]\nname = \"s\"\npoints = [\"ground.A\", \"rocker.C\"]\nforce = { file = \"curve.csv\" }\n";
  ASSERT_EQ(::mkfifo(own.folder.path("curve.csv").c_str(), 0600), 0);
  const json answer = asked(session, {{"do", "text"}, {"text", look(session)["text"].get<std::string>() + curve}});
  EXPECT_NE(error_of(answer).find("a device or a pipe"), std::string::npos) << error_of(answer);
}

// The picture names the same body as the tables, of action and reaction that on the joint's second body, and beside the
// pointer both.
TEST(ViewSession, PictureAndTableHaveTheForceOnTheSameBody) {
  for (const char* const name : {"toggle_clamp", "four_bar_gravity", "excavator"}) {
    const OwnScene own(name);
    ViewSession session(own.file);
    const json drawing = session.page()["view"]["drawing"];
    std::string texts, slots;
    for (const json& shape : drawing["shapes"]) {
      if (shape[0] == "text") texts += shape[4].get<std::string>() + "\n";
    }
    for (const json& slot : drawing["slots"]) slots += slot[1].get<std::string>() + "\n";
    const Scene& scene = session.tracked().scene();
    int named = 0;
    for (const Reaction& reaction : session.tracked().equilibrium().check.reactions) {
      if (reaction.kind != "pin") continue;
      const std::string on = scene.bodies[static_cast<std::size_t>(reaction.body_b)].name;
      const std::string by = scene.bodies[static_cast<std::size_t>(reaction.body_a)].name;
      const std::size_t slot = slots.find("force of pin " + reaction.name + ": ");
      if (slot == std::string::npos) continue;  // too small to be seen
      ++named;
      const std::string said = slots.substr(slot, slots.find('\n', slot) - slot);
      EXPECT_NE(said.find(" on " + on + " by " + by + ", as much back on " + by), std::string::npos) << said;
      const std::string value = said.substr(said.find(": ") + 2, said.find(" by ") - said.find(": ") - 2);
      EXPECT_NE(texts.find(value), std::string::npos) << name << ": " << value << " in\n" << texts;
    }
    EXPECT_GT(named, 1) << name;
  }
}

TEST(ViewSession, SwitchesSpringsOffAndOn) {
  const OwnScene own("toggle_clamp");
  ViewSession session(own.file);
  const double before = session.tracked().poses()[3].angle;
  json state = asked(session, {{"do", "switch"}, {"item", "spring.rubber"}, {"on", false}});
  ASSERT_EQ(error_of(state), "");
  EXPECT_TRUE(session.tracked().scene().elements.empty());
  EXPECT_TRUE(parse_scene(state["text"].get<std::string>(), "off.toml").elements.empty());
  state = asked(session, {{"do", "undo"}});
  EXPECT_EQ(session.tracked().scene().elements.size(), 1U);
  EXPECT_NEAR(session.tracked().poses()[3].angle, before, 1e-12);
  state = asked(session, {{"do", "redo"}});
  state = asked(session, {{"do", "switch"}, {"item", "spring.rubber"}, {"on", true}});
  EXPECT_EQ(parse_scene(state["text"].get<std::string>(), "on.toml").elements.size(), 1U);
}

TEST(ViewSession, SavesFewDigitsAndNoGuessThatABodyHasAnyway) {
  const OwnScene own("friction/wedge");
  ViewSession session(own.file);
  const json state = look(session);
  json handle;
  for (const json& one : state["handles"]) {
    if (one["kind"] == "point") handle = one;
  }
  const json px = {handle["px"][0].get<double>() + 12.0, handle["px"][1].get<double>() + 9.0};
  ASSERT_EQ(error_of(asked(session, {{"do", "drag"}, {"point", handle["name"]}, {"px", px}})), "");
  ASSERT_EQ(error_of(asked(session, {{"do", "release"}})), "");
  ASSERT_EQ(error_of(asked(session, {{"do", "save"}})), "");
  const std::string text = look(session)["text"];
  const std::string start = text.substr(text.find("[start]"));
  EXPECT_NE(start.find("floor = 1.73913\n"), std::string::npos) << start;
  EXPECT_EQ(start.find("wedge"), std::string::npos) << start;
  EXPECT_EQ(start.find("block"), std::string::npos) << start;
}

TEST(ViewSession, SavesOnlyOverWhatItHasRead) {
  const OwnScene own("four_bar_gravity");
  ViewSession session(own.file);
  asked(session, {{"do", "set"}, {"path", "gravity.y"}, {"value", -5}});
  EXPECT_EQ(session.poll(0)["file"], "same");
  json state = asked(session, {{"do", "save"}});
  EXPECT_EQ(error_of(state), "");
  EXPECT_EQ(state["saved"], true);
  EXPECT_NEAR(read_scene(own.file).gravity.y, -5.0 * read_scene(own.file).units.length, 1e-12);
  own.folder.write("four_bar_gravity.toml", contents(dataset("four_bar_gravity")));
  EXPECT_EQ(session.poll(0)["file"], "changed");
  EXPECT_NE(error_of(asked(session, {{"do", "save"}})).find("changed on disk"), std::string::npos);
  state = asked(session, {{"do", "reload"}});
  EXPECT_EQ(session.poll(0)["file"], "same");
  std::filesystem::remove(own.file);
  EXPECT_EQ(session.poll(0)["file"], "gone");
}

std::vector<std::string> scenes() {
  std::vector<std::string> out;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(dataset("zeeman")).parent_path())) {
    if (entry.path().extension() != ".toml") continue;
    try {
      read_scene(entry.path());
      out.push_back(entry.path().string());
    } catch (const InputError&) {
      continue;  // an experiment, a design
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// Random steps with the pointer on every scene of datasets/: what is shown as an equilibrium is one.
TEST(ViewSession, RandomDragsShowEquilibria) {
  for (const std::string& file : scenes()) {
    SCOPED_TRACE(file);
    ViewSession session(file);
    std::mt19937 random(static_cast<unsigned>(test::seed(7)));
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    json state = look(session);
    ASSERT_EQ(error_of(state), "");
    for (int k = 0; k < test::cases(60, 200); ++k) {
      const json& handles = state["handles"];
      const json handle = handles[random() % handles.size()];
      if (handle["kind"] != "point") continue;
      json to = handle["px"];
      for (int step = 0; step < 5; ++step, ++k) {
        for (json& x : to) x = x.get<double>() + 12.0 * uniform(random);
        const json answer = asked(session, {{"do", "drag"}, {"point", handle["name"]}, {"px", to}});
        if (answer.contains("error")) break;
        const Equilibrium& shown = session.tracked().equilibrium();
        if (!shown.found()) {
          EXPECT_EQ(answer["drawing"]["confirmed"].back(), false);
          continue;
        }
        EXPECT_TRUE(check(session.tracked().model(), shown.x).is_equilibrium()) << handle["name"];
      }
      state = asked(session, {{"do", "release"}});
      ASSERT_EQ(error_of(state), "");
    }
    EXPECT_LT(apart_from_solve(session, look(session)["text"]), 1e-9);
  }
}

TEST(ViewSession, ImportsAndExportsFilesOfOtherPrograms) {
  const OwnScene own("toggle_clamp");
  ViewSession session(own.file);
  const json before = look(session);
  const std::string drawing =
      contents(std::filesystem::path(dataset("toggle_clamp")).parent_path() / "exchange/four_bar.dxf");
  const json state = asked(session, {{"do", "import"}, {"name", "../four_bar.dxf"}, {"text", drawing}});
  ASSERT_EQ(error_of(state), "");
  EXPECT_TRUE(state["text"].get<std::string>().starts_with("# 1 text, dimension or hatch is left out.\n"));
  EXPECT_EQ(asked(session, {{"do", "undo"}})["text"], before["text"]);
  const json text = look(session)["text"];
  const auto refused = [&](const json& request) {
    const std::string error = error_of(asked(session, request));
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    EXPECT_EQ(look(session)["text"], text);
    return error;
  };
  EXPECT_TRUE(refused({{"do", "import"}, {"name", "a.stl"}, {"text", "solid"}})
                  .starts_with("a.stl: expected a file that ends"));
  EXPECT_TRUE(refused({{"do", "import"}, {"name", "a.dxf"}, {"text", "0\n"}}).starts_with("a.dxf:"));
  EXPECT_TRUE(refused({{"do", "import"}, {"name", "a.dxf"}, {"text", std::string("0\0", 2)}}).find("NUL") !=
              std::string::npos);
  EXPECT_NE(refused({{"do", "import"}, {"name", "a.dxf"}}), "");
  EXPECT_NE(refused({{"do", "export"}, {"format", "dfx"}}).find("did you mean \"dxf\"?"), std::string::npos);
  const json exported = asked(session, {{"do", "export"}, {"format", "dxf"}});
  EXPECT_NE(exported["exported"]["text"].get<std::string>().find("CIRCLE"), std::string::npos);
  EXPECT_FALSE(exported["exported"]["notes"].empty());
  EXPECT_EQ(exported["revision"], session.poll(0)["revision"]);
}

// A number of a part's file is saved as one of the scene's own, which all parts of that file have; the file of the
// part stays.
TEST(ViewSession, SavesNumbersOfPartsIntoTheScene) {
  const TempFolder folder;
  const std::filesystem::path datasets = std::filesystem::path(dataset("toggle_clamp")).parent_path();
  std::filesystem::copy(datasets / "parts", folder.path("parts"));
  const std::string file = folder.write("lift.toml", contents(datasets / "scissor_lift_of_parts.toml"));
  ViewSession session(file);
  ASSERT_EQ(error_of(asked(session, {{"do", "set"}, {"path", "numbers.scissor_stage.m"}, {"value", 8}})), "");
  EXPECT_NE(error_of(asked(session, {{"do", "set"}, {"path", "body.stage_1.rise.mass"}, {"value", 8}})), "");
  const json state = asked(session, {{"do", "save"}});
  ASSERT_EQ(error_of(state), "");
  EXPECT_TRUE(state["saved"]);
  const Scene saved = read_scene(file);
  EXPECT_EQ(get_value(saved, "body.stage_3.fall.mass"), 8);
  EXPECT_NE(contents(file).find("\"scissor_stage.m\" = 8"), std::string::npos);
  EXPECT_EQ(contents(folder.path("parts/scissor_stage.toml")), contents(datasets / "parts/scissor_stage.toml"));
  EXPECT_LT(apart_from_solve(session, contents(file)), 1e-9);
  // Each is a text of the page that names a file elsewhere.
  for (const char* const other : {"/etc/passwd", "../x.toml"}) {
    EXPECT_NE(error_of(asked(session, {{"do", "text"}, {"text", "[[part]]\nfile = \"" + std::string(other) + "\"\n"}})),
              "");
  }
}

}  // namespace
}  // namespace poise::app::view_session_test

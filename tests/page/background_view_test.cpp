// The live page beside what else a program does: several at once, scenes of files and of memory, and its end.
#include "app/view/background_view.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app::background_view_test {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::TempFolder;
using nlohmann::json;

/// What a page asks a view for.
class Page {
 public:
  explicit Page(const std::string& address)
      : client_(address.substr(0, address.find('/', 7))), base_(address.substr(address.find('/', 7))) {
    client_.set_read_timeout(120);
  }

  /// Null where nobody answers.
  json ask(json request) {
    request["revision"] = revision_;
    const httplib::Result result = client_.Post((base_ + "do").c_str(), request.dump(), "application/json");
    if (!result || result->status != 200) return nullptr;
    json answer = json::parse(result->body);
    if (!answer.contains("error")) revision_ = answer["revision"];
    return answer;
  }
  std::string error_of(const json& request) { return ask(request).at("error").at("text"); }
  json look() { return ask({{"do", "look"}}); }
  json poll() { return json::parse(client_.Get((base_ + "poll?revision=0").c_str())->body); }
  int status() {
    const httplib::Result page = client_.Get(base_.c_str());
    return page ? page->status : 0;
  }

 private:
  httplib::Client client_;
  std::string base_;
  long revision_ = 1;
};

SceneInMemory in_memory(const std::string& name) {
  const std::string file = dataset(name);
  return {.scene = read_scene(file), .text = contents(file), .name = name + ".toml"};
}

json value_of(const json& state, const std::string& path) {
  for (const json& number : state["numbers"]) {
    if (number["path"] == path) return number["value"];
  }
  return nullptr;
}

TEST(BackgroundView, SeveralAnswerAtOnceAndEndApart) {
  const TempFolder folder;
  const std::string file = folder.write("toggle_clamp.toml", contents(dataset("toggle_clamp")));
  BackgroundView first{std::filesystem::path(file)};
  auto second = std::make_unique<BackgroundView>(in_memory("four_bar_gravity"));
  const BackgroundView third{std::filesystem::path(file)};
  Page page(first.address()), of_second(second->address()), of_third(third.address());
  EXPECT_EQ(page.look()["file"], "toggle_clamp.toml");
  EXPECT_EQ(of_second.look()["file"], "four_bar_gravity.toml");
  EXPECT_EQ(page.ask({{"do", "set"}, {"path", "load.P"}, {"value", 30.0}})["verdict"]["tone"], "good");
  EXPECT_EQ(value_of(page.look(), "load.P"), 30.0);
  EXPECT_EQ(value_of(of_third.look(), "load.P"), 25.0);
  // Neither answers under the other's token.
  const std::string token = third.address().substr(third.address().find('/', 7));
  EXPECT_EQ(Page(first.address().substr(0, first.address().find('/', 7)) + token).status(), 404);
  second.reset();
  EXPECT_EQ(of_second.status(), 0);
  EXPECT_TRUE(first.runs());
  EXPECT_EQ(page.status(), 200);
  first.stop();
  first.stop();
  EXPECT_FALSE(first.runs());
  EXPECT_EQ(page.status(), 0);
  EXPECT_EQ(of_third.status(), 200);
}

TEST(BackgroundView, ShowsASceneOfMemoryWithItsNumbers) {
  SceneInMemory clamp = in_memory("toggle_clamp");
  set_value(clamp.scene, "load.P", 31.0);
  const BackgroundView view(std::move(clamp));
  Page page(view.address());
  const json state = page.look();
  EXPECT_EQ(value_of(state, "load.P"), 31.0);
  EXPECT_EQ(state["verdict"]["text"], "In equilibrium, proved: stable.");
  EXPECT_EQ(state["has_file"], false);
  const Scene shown = parse_scene(state["text"].get<std::string>(), "shown.toml");
  EXPECT_DOUBLE_EQ(norm(shown.forces.at(0).vector), 31.0) << state["text"];
  EXPECT_EQ(page.ask({{"do", "set"}, {"path", "load.P"}, {"value", 20.0}})["verdict"]["tone"], "good");
  EXPECT_EQ(page.poll()["file"], "same");
  for (const char* request : {"save", "reload"}) {
    EXPECT_EQ(page.error_of({{"do", request}}), "the scene is no file; save its text as one");
  }
  EXPECT_EQ(page.error_of({{"do", "save"}, {"anyway", true}}), "the scene is no file; save its text as one");
  EXPECT_FALSE(std::filesystem::exists("toggle_clamp.toml"));
}

// A page may show what the scene named when it was opened, and nothing else of the disk.
TEST(BackgroundView, ReadsNoFileForATextOfThePage) {
  const TempFolder folder;
  SceneInMemory clamp = in_memory("toggle_clamp");
  clamp.name = folder.path("toggle_clamp.toml").string();
  folder.write("curve.csv", "x,y\n0,0\n1,1\n2,0\n");
  const std::string text = clamp.text + "\n[[profile_spring]]\nname = \"x\"\nfile = \"curve.csv\"\n";
  const BackgroundView view(std::move(clamp));
  const std::string error = Page(view.address()).error_of({{"do", "text"}, {"text", text}});
  EXPECT_NE(error.find("file: expected a file that the scene named when it was opened"), std::string::npos) << error;
}

TEST(BackgroundView, RefusesATextOfAnotherScene) {
  SceneInMemory wrong = in_memory("toggle_clamp");
  wrong.text = contents(dataset("four_bar_gravity"));
  EXPECT_THROW(BackgroundView{std::move(wrong)}, InputError);
}

TEST(BackgroundView, NamesBadInput) {
  const auto message = [](const ViewedScene& scene, const Listening& listening) -> std::string {
    try {
      const BackgroundView view(scene, listening);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::filesystem::path clamp = dataset("toggle_clamp");
  const BackgroundView taken(clamp);
  const int port = std::stoi(taken.address().substr(taken.address().rfind(':') + 1));
  EXPECT_TRUE(message(clamp, {.port = port}).starts_with("--port: cannot listen"));
  EXPECT_TRUE(message(clamp, {.port = 70000}).starts_with("--port: expected a number from 0 to 65535, found 70000"));
  EXPECT_TRUE(message(clamp, {.frame_origin = "*"}).starts_with("--frame-origin: expected"));
  EXPECT_NE(message(std::filesystem::path("no_such_folder/none.toml"), {}).find("none.toml"), std::string::npos);
}

/// A chain of so many links between two pivots, which hangs through under its weight.
std::string hanging_chain(int links) {
  std::string out = fmt::format(
      "gravity = [0, -9.81]\n[units]\nlength = \"m\"\nangle = \"deg\"\n"
      "[ground]\npoints = {{ A = [0, 0], B = [{}, 0] }}\n",
      0.8 * links);
  for (int k = 0; k < links; ++k) {
    out += fmt::format("[body.b{}]\nmass = 1\ncenter = [0.5, 0]\npoints = {{ P = [0, 0], Q = [1, 0] }}\n", k);
  }
  for (int k = 0; k <= links; ++k) {
    const std::string from = k == 0 ? "ground.A" : fmt::format("b{}.Q", k - 1);
    const std::string to = k == links ? "ground.B" : fmt::format("b{}.P", k);
    out += fmt::format("[[pin]]\nname = \"j{}\"\npoints = [\"{}\", \"{}\"]\n", k, from, to);
  }
  out += "[start]\n";
  for (int k = 0; k < links; ++k) out += fmt::format("b{} = {}\n", k, k % 2 == 0 ? 37 : -37);
  return out;
}

// Dragging a point of so long a chain takes a dozen seconds.
TEST(BackgroundView, EndsWhileARequestIsComputed) {
  const TempFolder folder;
  BackgroundView view{std::filesystem::path(folder.write("chain.toml", hanging_chain(200)))};
  Page page(view.address());
  const json state = page.look();
  const auto point = std::find_if(state["handles"].begin(), state["handles"].end(),
                                  [](const json& handle) { return handle["name"] == "b40.Q"; });
  ASSERT_NE(point, state["handles"].end());
  const json request = {{"do", "drag"}, {"point", "b40.Q"}, {"px", {(*point)["px"][0].get<double>() + 100.0, 100.0}}};
  std::future<json> answer = std::async(std::launch::async, [&] { return page.ask(request); });
  ASSERT_EQ(answer.wait_for(std::chrono::milliseconds(500)), std::future_status::timeout);
  const auto begin = std::chrono::steady_clock::now();
  view.stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  EXPECT_EQ(answer.get(), nullptr);
  EXPECT_FALSE(view.runs());
}

TEST(BackgroundView, LeavesSignalsAsTheyAre) {
  const std::vector<int> signals = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};
  const auto handlers = [&] {
    std::vector<void (*)(int)> out;
    for (const int signal : signals) {
      struct sigaction now {};
      ::sigaction(signal, nullptr, &now);
      out.push_back(now.sa_handler);
    }
    return out;
  };
  const std::vector<void (*)(int)> before = handlers();
  const TempFolder folder;
  const std::string file = folder.write("toggle_clamp.toml", contents(dataset("toggle_clamp")));
  BackgroundView view{std::filesystem::path(file)};
  Page page(view.address());
  page.ask({{"do", "set"}, {"path", "load.P"}, {"value", 30.0}});
  EXPECT_EQ(page.ask({{"do", "save"}})["saved"], true);
  EXPECT_NE(contents(file), contents(dataset("toggle_clamp")));
  EXPECT_EQ(handlers(), before);
  view.stop();
  EXPECT_EQ(handlers(), before);
}

}  // namespace
}  // namespace poise::app::background_view_test

// poise equations: numbers in a position, and the files of code.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::equations_command_test {
namespace {

using nlohmann::json;

// A crank of 1 kg m^2 that drives a block of 2 kg by a rod without mass; mm and degrees.
constexpr const char* crank_slider = R"(
gravity = [0, -9810]
[units]
length = "mm"
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], B = [100, 0] }
mass = 3
center = [50, 0]
inertia = 1e6
[body.rod]
points = { B = [0, 0], C = [300, 0] }
[body.block]
points = { C = [0, 0] }
mass = 2
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "B"
points = ["crank.B", "rod.B"]
[[pin]]
name = "C"
points = ["rod.C", "block.C"]
[[slide]]
name = "guide"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[force]]
name = "P"
at = "block.C"
vector = [-50, 0]
[start]
crank = 20
guide = 390
)";

json equation_json(const TempFolder& folder, std::vector<std::string> words, int exit_code) {
  const std::string file = folder.path("result.json").string();
  words.insert(words.end(), {"--json", file});
  const ProgramRun run = run_poise(words);
  EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
  return json::parse(contents(file));
}

// At 90 degrees the block has -r w and the acceleration -r alpha + r w^2 tan(rod), and the rod leans by asin(1/3).
TEST(EquationsCommand, TellsTheEquationInTheUnitsOfSi) {
  const TempFolder folder;
  const std::string scene = folder.write("crank.toml", crank_slider);
  const json r = equation_json(
      folder,
      {"equations", scene, "--from", "start", "--at", "crank=90", "--rate", "crank=360", "--coordinates", "crank"}, 0);
  EXPECT_EQ(r["status"], "ok");
  ASSERT_EQ(r["equation"].size(), 1U);
  const json& row = r["equation"][0];
  EXPECT_EQ(row["coordinate"], "crank");
  EXPECT_EQ(row["unit"], "rad");
  const double w = 2 * M_PI, lean = std::asin(1.0 / 3.0);
  EXPECT_NEAR(row["z"], M_PI / 2, 1e-12);
  EXPECT_NEAR(row["w"], w, 1e-12);
  EXPECT_NEAR(row["D"][0], 1.0 + 3 * 0.05 * 0.05 + 2 * 0.1 * 0.1, 1e-12);
  EXPECT_NEAR(row["h"], -2 * 0.1 * (0.1 * w * w * std::tan(lean)), 1e-10);
  EXPECT_NEAR(row["c"], 0.0, 1e-12);
  EXPECT_NEAR(row["Q"], 50 * 0.1, 1e-12);
  const double sum = row["D"][0].get<double>() * row["alpha"].get<double>() + row["h"].get<double>();
  EXPECT_NEAR(sum, row["Q"].get<double>(), 1e-11);
  ASSERT_EQ(r["coordinates"].size(), r["constraints"][0]["J"].size());
  for (const json& coordinate : r["coordinates"]) {
    if (coordinate["name"] == "crank") {
      EXPECT_EQ(coordinate["independent"], true);
      EXPECT_EQ(coordinate["B"][0], 1.0);
    }
  }
}

TEST(EquationsCommand, WritesCodeAndATable) {
  const TempFolder folder;
  const std::string scene = folder.write("my crank.toml", crank_slider);
  const std::string c = folder.path("crank.c"), python = folder.path("crank.py"), csv = folder.path("crank.csv");
  const ProgramRun run = run_poise(
      {"equations", scene, "--from", "start", "--coordinates", "crank", "--code", c, "--python", python, "--csv", csv});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_NE(contents(c).find("int my_crank_accelerations(double t"), std::string::npos);
  EXPECT_NE(contents(python).find("def accelerations(t, z, w, q=START):"), std::string::npos);
  EXPECT_EQ(contents(csv).substr(0, 41), "coordinate,unit,z,w,D.crank,h,c,Q,alpha\nc");
}

TEST(EquationsCommand, SaysThatADriveMovesTheMechanismInTime) {
  const TempFolder folder;
  const std::string scene = folder.write("driven.toml", std::string(R"(
[ground]
points = { O = [0, 0] }
[body.cart]
points = { C = [0, 0] }
mass = 1
[body.rod]
points = { C = [0, 0] }
mass = 2
center = [0, -0.5]
inertia = 0.1
[[slide]]
name = "rail"
points = ["ground.O", "cart.C"]
axis = [1, 0]
[[pin]]
name = "C"
points = ["cart.C", "rod.C"]
[[drive]]
name = "push"
slide = "rail"
start = 0
rate = 0.5
acceleration = 3
)"));
  const json r = equation_json(folder, {"equations", scene, "--time", "2"}, 0);
  EXPECT_EQ(r["time"], 2.0);
  ASSERT_EQ(r["equation"].size(), 1U);
  const json& row = r["equation"][0];
  EXPECT_NEAR(row["D"][0], 0.1 + 2 * 0.25, 1e-14);
  // m c x'' along the way that the centre of mass moves where the rod turns: (0, -0.5) turns to +x.
  EXPECT_NEAR(row["h"], 2 * 0.5 * 3, 1e-13);
  for (const json& coordinate : r["coordinates"]) {
    if (coordinate["name"] != "rail") continue;
    EXPECT_NEAR(coordinate["q"], 0.5 * 2 + 3.0 * 4 / 2, 1e-13);
    EXPECT_NEAR(coordinate["v"], 0.5 + 3.0 * 2, 1e-13);
    EXPECT_NEAR(coordinate["a"], 3.0, 1e-13);
  }
}

TEST(EquationsCommand, SaysThatAMotionHasNoInertia) {
  const TempFolder folder;
  std::string text = crank_slider;
  for (const std::string line : {"mass = 3\n", "center = [50, 0]\n", "inertia = 1e6\n", "mass = 2\n"}) {
    text.erase(text.find(line), line.size());
  }
  const json r = equation_json(folder, {"equations", folder.write("light.toml", text), "--from", "start"}, 1);
  EXPECT_EQ(r["status"], "no_inertia");
  EXPECT_EQ(r["equation"][0]["alpha"], nullptr);
}

TEST(EquationsCommand, RefusesWhatCannotBe) {
  const TempFolder folder;
  const std::string scene = folder.write("crank.toml", crank_slider);
  const std::string c = folder.path("crank.c");
  struct Refused {
    std::vector<std::string> words;
    std::string says;
  };
  for (const Refused& one :
       std::vector<Refused>{{{"--at", "crnk=90"}, "did you mean \"crank\""},
                            {{"--at", "crank"}, "expected NAME=NUMBER"},
                            {{"--rate", "crank=x"}, "expected"},
                            {{"--time", "-1"}, "--time: expected seconds >= 0"},
                            {{"--coordinates", "crank,guide"},
                             "--coordinates crank,guide: expected coordinates that move independently"},
                            {{"--coordinates", "cranc"}, "did you mean \"crank\""},
                            {{"--from", "here"}, "--from"},
                            {{"--at", "crank=10", "--at", "guide=100"}, "expected places"},
                            {{"--code", scene}, "is the scene too"}}) {
    std::vector<std::string> words = {"equations", scene, "--from", "start", "--python", folder.path("crank.py")};
    if (one.words.front() != "--code") words.insert(words.end(), {"--code", c});
    words.insert(words.end(), one.words.begin(), one.words.end());
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2) << one.says;
    EXPECT_NE(run.err.find(one.says), std::string::npos) << run.err;
    EXPECT_EQ(folder.names(), std::vector<std::string>{"crank.toml"}) << one.says;
  }
}

}  // namespace
}  // namespace poise::app_tests::equations_command_test

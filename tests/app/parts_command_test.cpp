// Commands on scenes with parts: numbers of parts are named, varied and given tolerances as others are, and what a
// command writes reads back as the same scene, beside parts' files that stay as they were.

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app_tests::parts_command_test {
namespace {

using Words = std::vector<std::string>;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Two rods that lean on each other by a spring; the stiffness of their hinges is one number.
class CommandsOnParts : public testing::Test {
 protected:
  CommandsOnParts() {
    rod_ = folder_.write("rod.toml",
                         "[numbers]\nk = 40\n[ground]\npoints = { A = [0, 0] }\n[body.rod]\n"
                         "points = { A = [0, 0], B = [0, 1] }\nmass = 2\ninertia = 0.1\ncenter = [0, 0.5]\n"
                         "[[pin]]\nname = \"foot\"\npoints = [\"ground.A\", \"rod.A\"]\n[[torsion_spring]]\n"
                         "name = \"hinge\"\nbodies = [\"ground\", \"rod\"]\nstiffness = \"k\"\nfree_angle = -0.3\n");
    scene_ =
        folder_.write("rods.toml",
                      "gravity = [0, -9.81]\n[numbers]\nwidth = 1.5\n[[part]]\nname = \"left\"\nfile = \"rod.toml\"\n"
                      "[[part]]\nname = \"right\"\nfile = \"rod.toml\"\nat = [\"width\", 0]\nmirror = true\n"
                      "numbers = { \"body.rod.mass\" = 3 }\n[[spring]]\nname = \"tie\"\n"
                      "points = [\"left.rod.B\", \"right.rod.B\"]\nstiffness = 20\nfree_length = 1.2\n"
                      "[outputs]\nlean = \"angle.left.rod - angle.right.rod\"\n");
  }

  std::string experiment(const std::string& unknown) {
    return folder_.write(
        "experiment.toml",
        "scene = \"rods.toml\"\n[[sensor]]\nname = \"a\"\nangle = \"left.rod\"\nnoise = 1e-5\n"
        "[[sensor]]\nname = \"b\"\nangle = \"right.rod\"\nnoise = 1e-5\n[[unknown]]\npath = \"" +
            unknown +
            "\"\nstart = 45\n[[unknown]]\npath = \"numbers.right.body.rod.mass\"\nstart = 2.5\n[[run]]\n"
            "name = \"one\"\nrelease = { \"left.rod\" = 0.1 }\nduration = 1\nrate = 50\nseed = 1\n");
  }

  std::string refused(const Words& words) {
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2) << run.out;
    EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
    return run.err;
  }

  TempFolder folder_;
  std::string rod_, scene_;
};

TEST_F(CommandsOnParts, EstimatesAreWrittenIntoTheScene) {
  const std::string before = contents(rod_), fitted = folder_.path("fitted.toml");
  const std::string file = experiment("numbers.rod.k");
  const ProgramRun run = run_poise({"identify", file, "--scene", fitted});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  const Scene scene = read_scene(fitted);
  EXPECT_NEAR(get_value(scene, "torsion_spring.left.hinge.stiffness"), 40, 0.1);
  EXPECT_EQ(get_value(scene, "torsion_spring.right.hinge.stiffness"), get_value(scene, "numbers.rod.k"));
  EXPECT_NEAR(get_value(scene, "body.right.rod.mass"), 3, 0.05);
  EXPECT_NE(get_value(scene, "body.right.rod.mass"), 3);
  EXPECT_EQ(get_value(scene, "body.left.rod.mass"), 2);
  EXPECT_EQ(contents(rod_), before);
  EXPECT_TRUE(contains(refused({"identify", file, "--scene", rod_}), "rod.toml"));
  std::filesystem::create_directory(folder_.path("elsewhere"));
  EXPECT_TRUE(contains(refused({"identify", file, "--scene", folder_.path("elsewhere/fitted.toml")}),
                       "beside which it reads rod.toml"));
  EXPECT_TRUE(contains(refused({"identify", experiment("torsion_spring.left.hinge.stiffness")}), "numbers.rod.k"));
  EXPECT_EQ(contents(rod_), before);
}

// Whatever an option writes, it is no file that the scene reads: a part, what a part reads, a curve.
TEST_F(CommandsOnParts, FilesThatTheSceneReadsStay) {
  const std::string part =
      folder_.write("half.toml", "[[part]]\nname = \"half\"\nfile = \"rod.toml\"\n" + contents(rod_));
  const std::string curve = folder_.write("force.csv", "x;F\n0.5;0\n1;10\n2;30\n");
  const std::string scene = folder_.write(
      "whole.toml",
      "gravity = [0, -9.81]\n[ground]\npoints = { O = [3, 0] }\n[[part]]\nname = \"a\"\nfile = \"half.toml\"\n"
      "[[spring]]\nname = \"tie\"\npoints = [\"a.rod.B\", \"ground.O\"]\nforce = { file = \"force.csv\" }\n");
  const std::vector<std::string> before = folder_.names();
  const std::string other = folder_.path("other.json").string();
  for (const std::string& read : {rod_, part, curve}) {
    for (const char* const option : {"--json", "--html", "--markdown"}) {
      const std::string text = contents(read), why = refused({"check", scene, option, read});
      EXPECT_TRUE(contains(why, std::string(option) + ": \"" + read + "\" is a file that is read too")) << why;
      EXPECT_EQ(contents(read), text);
    }
  }
  EXPECT_TRUE(contains(refused({"solve", scene_, "--json", other, "--svg", rod_}), "is a file that is read too"));
  EXPECT_EQ(folder_.names(), before);
}

TEST_F(CommandsOnParts, WhatADesignFindsIsWrittenIntoTheScene) {
  const std::string before = contents(rod_), found = folder_.path("found.toml");
  const std::string design = folder_.write(
      "design.toml",
      "scene = \"rods.toml\"\n[variables]\n\"numbers.width\" = [1, 2]\n\"numbers.rod.k\" = [20, 90]\n"
      "\"numbers.right.body.rod.mass\" = [0.5, 8]\n[[goal]]\nof = \"angle.left.rod\"\nequals = -0.8\nwithin = 1e-6\n"
      "[[goal]]\nof = \"angle.right.rod\"\nequals = 0.15\nwithin = 1e-6\n");
  const ProgramRun run = run_poise({"design", design, "--scene", found});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  const ProgramRun solved = run_poise({"solve", found, "--show", "lean", "--json", folder_.path("o.json")});
  EXPECT_EQ(solved.exit_code, 0) << solved.err;
  const nlohmann::json result = nlohmann::json::parse(contents(folder_.path("o.json")));
  EXPECT_NEAR(result["angles"]["left.rod"].get<double>(), -0.8, 2e-6);
  EXPECT_NEAR(result["angles"]["right.rod"].get<double>(), 0.15, 2e-6);
  EXPECT_EQ(contents(rod_), before);
  EXPECT_TRUE(contains(refused({"design", design, "--scene", rod_}), "rod.toml"));
}

TEST_F(CommandsOnParts, NumbersOfPartsVaryAndHaveTolerances) {
  const std::string tolerances = folder_.write(
      "tolerances.toml", "[tolerances]\n\"numbers.rod.k\" = { percent = 5 }\n\"numbers.right.body.rod.mass\" = 0.1\n");
  const ProgramRun run = run_poise({"tolerance", scene_, "--tolerances", tolerances, "--of", "lean,angle.left.rod"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "numbers.rod.k")) << run.out;
  const ProgramRun path = run_poise({"path", scene_, "--vary", "numbers.width=1.5..1.6", "--show", "lean"});
  EXPECT_EQ(path.exit_code, 0) << path.err;
  EXPECT_TRUE(contains(refused({"path", scene_, "--vary", "body.left.rod.mass=1..2"}), "numbers.rod.body.rod.mass"));
  EXPECT_TRUE(contains(refused({"solve", scene_, "--set", "point.ground.right.x=2"}), "numbers.width"));
  EXPECT_TRUE(contains(refused({"solve", scene_, "--show", "angle.left.rodd"}), "did you mean"));
}

}  // namespace
}  // namespace poise::app_tests::parts_command_test

// `poise path --curve fold` through the command line.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::fold_curve_command_test {
namespace {

using nlohmann::json;

std::vector<std::string> pendulum(const std::vector<std::string>& further) {
  std::vector<std::string> words = {
      "path",   dataset("hard/imperfect_pendulum"),         "--curve", "fold",
      "--vary", "torsion_spring.spring.stiffness=0.9..1.1", "--vary",  "torsion_spring.spring.free_angle=1.55..1.59"};
  words.insert(words.end(), further.begin(), further.end());
  return words;
}

TEST(FoldCurveCommand, WritesTheSameCurveEverywhere) {
  const TempFolder folder;
  const std::string table = folder.path("f.csv"), result = folder.path("f.json"), chart = folder.path("f.svg");
  const ProgramRun outcome = run_poise(pendulum({"--csv", table, "--json", result, "--svg", chart}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("1 curve of folds with 1 cusp"), std::string::npos) << outcome.out;
  const json answer = json::parse(contents(result));
  EXPECT_EQ(answer["status"], "traced");
  ASSERT_EQ(answer["cusps"].size(), 1U);
  EXPECT_NEAR(answer["cusps"][0]["first"].get<double>(), 1.0, 1e-14);
  EXPECT_NEAR(answer["cusps"][0]["second"].get<double>(), M_PI / 2, 1e-14);
  for (const json& point : answer["points"]) {
    const double t = point["angles"]["rod"].get<double>() - M_PI / 2;
    EXPECT_NEAR(point["first"].get<double>(), std::cos(t), 1e-13);
  }
  const std::string lines = contents(table);
  EXPECT_EQ(static_cast<std::size_t>(std::count(lines.begin(), lines.end(), '\n')), answer["points"].size() + 1);
  EXPECT_EQ(objection_to_xml(contents(chart)), "");
}

TEST(FoldCurveCommand, SaysWhereThereIsNoFold) {
  const ProgramRun outcome = run_poise({"path", dataset("von_mises_toggle"), "--vary", "load.P=0..10", "--vary",
                                        "spring.left.stiffness=900..1100", "--curve", "fold"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.out.find("No curve of folds in load.P and spring.left.stiffness: no smooth fold"),
            std::string::npos)
      << outcome.out;
}

}  // namespace
}  // namespace poise::app_tests::fold_curve_command_test

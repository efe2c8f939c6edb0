#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/commands/options.hpp"
#include "app/draw/chart/gnuplot.hpp"
#include "app/present/text.hpp"
#include "app/results/statics/work_precision.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"

namespace poise::app::work_precision_command_test {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::ProgramRun;
using app_tests::run_poise;
using app_tests::TempFolder;
using comparison::Ending;
using nlohmann::json;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(Tolerances, RangesGoByDecadesAndListsFall) {
  EXPECT_EQ(read_tolerances("1e-2..1e-5"), (std::vector<double>{1e-2, 1e-3, 1e-4, 1e-5}));
  EXPECT_EQ(read_tolerances("1e-2..1e-14").size(), 13U);
  EXPECT_EQ(read_tolerances("1e-2..1e-14").back(), 1e-14);
  EXPECT_EQ(read_tolerances("1e-3..5e-5"), (std::vector<double>{1e-3, 1e-4})) << "not beyond the second";
  EXPECT_EQ(read_tolerances("2e-3..2e-3"), std::vector<double>{2e-3});
  EXPECT_EQ(read_tolerances("1e-6,1e-3,1e-6"), (std::vector<double>{1e-3, 1e-6}));
  EXPECT_EQ(read_tolerances("0.5"), std::vector<double>{0.5});
}

TEST(Tolerances, InvalidRangesAreErrors) {
  for (const char* text : {"", "..", "1e-2..", "..1e-3", "1e-2..x", "1e-14..1e-2", "0", "1e-2..0", "-1e-3", "1", "nan",
                           "inf", "1e-3,", ",1e-3", "1e-2...1e-3", "1e-2..1e-3..1e-4", "1e-30"}) {
    EXPECT_THROW(read_tolerances(text), InputError) << text;
  }
}

TEST(Methods, ListsAreReadInTheirOrder) {
  EXPECT_EQ(read_methods("--methods", "energy,virtual-work,energy"),
            (std::vector<Method>{Method::energy, Method::virtual_work}));
  EXPECT_EQ(read_methods("--methods", "all").size(), all_methods().size());
  for (const char* names : {"", "energy,", ",energy", "enegry", "energy virtual-work", "ALL"}) {
    EXPECT_THROW(read_methods("--methods", names), InputError) << names;
  }
}

TEST(WorkPrecisionCommand, PrintsTimesErrorsAndStatuses) {
  const ProgramRun run = run_poise({"compare", dataset("thesis_four_bar"), "--methods", "virtual-work,energy",
                                    "--tolerances", "1e-2..1e-14", "--repeat", "1", "--verbose"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_EQ(run.err, "");
  for (const char* part : {"stable, found by virtual-work and energy", "Least time to an error below", "13 of 13",
                           "iterations  evaluations  status", "too coarse", "confirmed",
                           "virtual-work: Newton-Raphson on the equations of virtual work"}) {
    EXPECT_TRUE(contains(run.out, part)) << part << "\n" << run.out;
  }
  EXPECT_LT(lines_of(run.out).size(), 40U) << "tolerances that change nothing share a line";
}

TEST(WorkPrecisionCommand, WritesOneCsvRowForEachMethodAndTolerance) {
  const TempFolder folder;
  const std::string csv = folder.path("a.csv").string();
  const ProgramRun run =
      run_poise({"compare", folder.write("a.toml", app_tests::pendulum), "--methods", "virtual-work,energy",
                 "--tolerances", "1e-6,1e-12", "--repeat", "2", "--csv", csv});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "wrote " + csv));
  const std::vector<std::string> lines = lines_of(contents(csv));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0],
            "method,status,tolerance,microseconds,error,iterations,evaluations,claimed,confirmed,repeats,equilibrium");
  EXPECT_TRUE(lines[1].starts_with("virtual-work,confirmed,1e-06,")) << lines[1];
  EXPECT_TRUE(lines[4].starts_with("energy,confirmed,1e-12,")) << lines[4];
  for (const std::string& line : lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 10) << line;
}

TEST(WorkPrecisionCommand, WritesJsonAndPicture) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const TempFolder folder;
  const std::string file = folder.path("a.json").string(), svg = folder.path("a.svg").string();
  const ProgramRun run = run_poise({"compare", dataset("six_bar"), "--methods", "virtual-work,energy", "--tolerances",
                                    "1e-2..1e-12", "--repeat", "1", "--json", file, "--svg", svg});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json r = json::parse(contents(file));
  ASSERT_EQ(r["methods"].size(), 2U);
  EXPECT_EQ(r["methods"][0]["method"], "virtual-work");
  ASSERT_EQ(r["methods"][1]["runs"].size(), 11U);
  EXPECT_EQ(r["methods"][1]["runs"][0]["tolerance"], 1e-2);
  EXPECT_LT(r["methods"][0]["runs"][10]["error"], 1e-13);
  EXPECT_EQ(r["equilibria"][0]["found_by"], json({"virtual-work", "energy"}));
  EXPECT_EQ(r["equilibria"][0]["stability"], "stable");
  EXPECT_GE(r["equilibria"][0]["digits"], 40);
  const std::string picture = contents(svg);
  EXPECT_EQ(app_tests::objection_to_xml(picture), "");
  EXPECT_LT(picture.size(), 300000U);
  EXPECT_TRUE(contains(picture, "median time (µs)"));
  EXPECT_TRUE(contains(picture, ">virtual-work<"));
}

TEST(WorkPrecisionCommand, WithoutAnyEquilibriumExitsOne) {
  const TempFolder folder;
  const ProgramRun run = run_poise({"compare", folder.write("a.toml", app_tests::runaway), "--methods",
                                    "virtual-work,energy", "--tolerances", "1e-3", "--repeat", "1"});
  EXPECT_EQ(run.exit_code, 1) << run.out;
  EXPECT_TRUE(contains(run.out, "none is known in 50 digits")) << run.out;
  EXPECT_TRUE(contains(run.out, "0 of 1")) << run.out;
}

TEST(WorkPrecisionCommand, MethodsThatDoNotApplyAreReported) {
  const TempFolder folder;
  const ProgramRun run = run_poise({"compare", folder.write("a.toml", app_tests::follower), "--methods",
                                    "virtual-work,energy", "--tolerances", "1e-9", "--repeat", "1"});
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_TRUE(contains(run.out, "energy does not apply: force \"jet\" follows a body")) << run.out;
}

comparison::WorkPrecisionRow run_with(Ending ending, bool confirmed, std::optional<double> error) {
  comparison::WorkPrecisionRow run;
  run.method = Method::cobyla;
  run.tolerance = 1e-3;
  run.ending = ending;
  run.claimed = ending != Ending::not_converged;
  run.confirmed = confirmed;
  run.error = error;
  run.microseconds = 5.0;
  return run;
}

TEST(WorkPrecisionResult, TheChartShowsOnlyRunsThatConverged) {
  const StaticModel model(parse_scene(app_tests::pendulum, "scene"));
  comparison::WorkPrecision result;
  result.rows = {run_with(Ending::converged, true, 1e-4), run_with(Ending::not_converged, false, 1e-5),
                 run_with(Ending::converged, true, 0.0)};
  comparison::WorkPrecisionRow lost = run_with(Ending::elsewhere, false, std::nullopt);
  lost.method = Method::slsqp;
  result.rows.push_back(lost);
  const std::vector<Panel> panels = work_precision_panels(model, result);
  ASSERT_EQ(panels.size(), 1U);
  EXPECT_TRUE(panels[0].log_x && panels[0].log_y && panels[0].x_falls);
  EXPECT_EQ(panels[0].title, "Pendulum: slsqp did not converge");
  ASSERT_EQ(panels[0].curves.size(), 1U);
  const Curve& curve = panels[0].curves[0];
  EXPECT_EQ(curve.name, "cobyla");
  ASSERT_EQ(curve.x.size(), 3U);
  EXPECT_EQ(curve.x[0], 1e-4);
  EXPECT_EQ(curve.y[0], 5.0);
  EXPECT_TRUE(std::isnan(curve.x[1])) << "a gap where it did not converge";
  EXPECT_EQ(curve.x[2], 1e-17) << "an error of nothing has to stand somewhere on a logarithmic axis";
}

TEST(WorkPrecisionResult, AnInterruptedStudyPrintsWhatItHas) {
  const StaticModel model(parse_scene(app_tests::pendulum, "scene"));
  comparison::WorkPrecision result;
  result.interrupted = true;
  result.rows = {run_with(Ending::not_converged, true, 1e-9)};
  result.rows[0].why = "out of patience";
  const std::string text = plain_text(work_precision_result(model, result, 7, {}), Palette(), Verbosity::verbose);
  EXPECT_TRUE(contains(text, "Interrupted: 1 row was finished.")) << text;
  EXPECT_TRUE(contains(text, "not converged, confirmed")) << text;
  EXPECT_TRUE(contains(text, "at 1e-3: out of patience")) << text;
}

TEST(CompareMethods, ManyMethodsShareTheColumnsOfTheirEquilibria) {
  const TempFolder folder;
  const std::string file = folder.path("a.json").string();
  const ProgramRun run = run_poise({"compare", dataset("heaton_timme"), "--methods", "all", "--json", file});
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_EQ(json::parse(contents(file))["methods"].size(), all_methods().size());
  EXPECT_TRUE(contains(run.out, "  body     equilibrium\n")) << run.out;
  for (const MethodTraits& method : all_methods()) EXPECT_TRUE(contains(run.out, method.name)) << run.out;
  for (const std::string& line : lines_of(run.out)) {
    const std::size_t found = line.find("2.353554680");
    if (found == std::string::npos) continue;
    EXPECT_EQ(line.find("2.353554680", found + 1), std::string::npos) << "one column for one equilibrium: " << line;
  }
}

TEST(CompareMethods, OneConfirmedAnswerIsEnoughForAListButNotForTheDefault) {
  const TempFolder folder;
  const std::string up = folder.write("up.toml", app_tests::pendulum);
  EXPECT_EQ(run_poise({"compare", up, "--methods", "energy"}).exit_code, 0);
  EXPECT_EQ(run_poise({"compare", folder.write("r.toml", app_tests::runaway), "--methods", "energy"}).exit_code, 1);
  const std::string follower = folder.write("f.toml", app_tests::follower);
  EXPECT_EQ(run_poise({"compare", follower, "--methods", "energy"}).exit_code, 1)
      << "a method that does not apply is not confirmed";
}

TEST(SolveMethod, TakesEveryName) {
  const std::string help = run_poise({"solve", "--help"}).out;
  for (const MethodTraits& method : all_methods()) {
    EXPECT_TRUE(contains(help, std::string(method.name) + ":")) << help;
    const ProgramRun run = run_poise({"solve", dataset("heaton_timme"), "--method", method.name, "--verbose"});
    EXPECT_NE(run.exit_code, 2) << run.err;
    EXPECT_TRUE(contains(run.out, method.name)) << run.out;
  }
}

}  // namespace
}  // namespace poise::app::work_precision_command_test

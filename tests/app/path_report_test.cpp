// What `poise path` shows of a path, which is made by hand here.

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/draw/chart/gnuplot.hpp"
#include "app/draw/chart/path_chart.hpp"
#include "app/draw/path_picture.hpp"
#include "app/present/csv.hpp"
#include "app/present/json.hpp"
#include "app/present/text.hpp"
#include "app/results/statics/path.hpp"
#include "tests/app/fabricated_path.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app::path_report_test {
namespace {

using app_tests::toggle_path;
using app_tests::varied_toggle;
using nlohmann::json;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

PathView with_guide(const VariedScene& varied) { return {.measures = {find_quantity(varied.scene(), "guide")}}; }

std::string text_of(const VariedScene& varied, const Path& path, const PathView& view) {
  return plain_text(path_result(varied, path, view, {}), {}, Verbosity::normal);
}

TEST(PathReport, SaysHowFarAndWhatIsProved) {
  const VariedScene varied = varied_toggle();
  const Path path = toggle_path(varied);
  const std::string text = text_of(varied, path, with_guide(varied));
  EXPECT_TRUE(contains(text, "followed     load.P from 0 N to ")) << text;
  EXPECT_TRUE(contains(text, ", as low as -4")) << text;
  EXPECT_TRUE(contains(text, ": 2 folds and 1 snap\n")) << text;
  EXPECT_TRUE(contains(text, "all 112 points are proved; other curves of equilibria may exist\n")) << text;
}

TEST(PathReport, SaysWhereTheMechanismSnapsAndFromWhereToWhere) {
  const VariedScene varied = varied_toggle();
  const Path path = toggle_path(varied);
  const std::string text = path_result(varied, path, with_guide(varied), {}).verdict.text;
  EXPECT_TRUE(text.starts_with("Snaps at P = 42.91 N: guide 0.2")) << text;
  EXPECT_TRUE(text.ends_with(" to -0.6 m.")) << text;
}

TEST(PathReport, SaysThatNothingSnaps) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  path.events.clear();
  path.branches.front().points.resize(11);
  path.branches.front().events.clear();
  const std::string text = path_result(varied, path, with_guide(varied), {}).verdict.text;
  EXPECT_TRUE(text.starts_with("Follows P from 0 N to ")) << text;
  EXPECT_TRUE(text.ends_with(" N without a snap: guide 0.5 to 0.4 m.")) << text;
}

TEST(PathReport, NamesTheStopsBetweenWhichItSnaps) {
  const VariedScene varied(read_scene(app_tests::dataset("toggle_clamp")), "load.P", 0.0, 60.0);
  PathEvent stop;
  stop.kind = PathEvent::Kind::stop;
  stop.at.parameter = 37.0;
  stop.at.x = varied.model_at(varied.generic())->start();
  stop.item = 0;
  PathEvent snap = stop;
  snap.kind = PathEvent::Kind::snap;
  snap.item = -1;
  snap.landing = stop.at;
  snap.landing->active_stops = {1};
  Path path;
  path.branches.emplace_back().points = {stop.at};
  path.events = {stop, snap};
  const std::string text = path_result(varied, path, {}, {}).verdict.text;
  EXPECT_TRUE(text.starts_with("Snaps at P = 37 N, leaving stop over_centre, onto stop open")) << text;
}

TEST(PathReport, GivesATextToEveryToneOfATable) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  path.branches.front().points[23].proof = PointProof::critical;
  int tones = 0;
  const Result result = path_result(varied, path, with_guide(varied), {});
  for (const Item& item : result.content.items()) {
    const auto* table = std::get_if<Table>(&item.content);
    if (table == nullptr) continue;
    for (const Column& column : table->columns) {
      for (std::size_t row = 0; column.is_words() && row < column.tones.size(); ++row) {
        EXPECT_TRUE(column.tones[row] == Tone::plain || !column.words[row].empty()) << item.title << ", row " << row;
        tones += column.tones[row] == Tone::doubtful ? 1 : 0;
      }
    }
  }
  EXPECT_GT(tones, 0) << "the critical point";
}

TEST(PathReport, WritesAFoldWithTheDigitsThatAreKnown) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  EXPECT_TRUE(contains(text_of(varied, path, with_guide(varied)), "42.914325731225 ")) << text_of(varied, path, {});
  path.events.front().error = 2e-6;
  const std::string coarse = text_of(varied, path, with_guide(varied));
  EXPECT_TRUE(contains(coarse, "1  fold   42.914 ")) << coarse;
}

TEST(PathReport, NamesBothSidesOfAFoldAndWhereItSnapsTo) {
  const VariedScene varied = varied_toggle();
  const std::string text = text_of(varied, toggle_path(varied), with_guide(varied));
  EXPECT_TRUE(contains(text, "stable    unstable")) << text;
  EXPECT_TRUE(contains(text, "to -0.6 m, releases ")) << text;
}

TEST(PathReport, SaysWhyASnapHasNoLanding) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  path.events.back().landing.reset();
  EXPECT_TRUE(contains(text_of(varied, path, with_guide(varied)), "  comes to rest nowhere\n"));
  path.events.back().why = "it runs away";
  const std::string text = text_of(varied, path, with_guide(varied));
  EXPECT_TRUE(contains(text, "  it runs away\n")) << text;
}

TEST(PathReport, NamesStopsAndOneWaySprings) {
  const VariedScene varied(read_scene(app_tests::dataset("toggle_clamp")), "load.P", 0.0, 60.0);
  PathEvent stop;
  stop.kind = PathEvent::Kind::stop;
  stop.at.x = varied.model_at(varied.generic())->start();
  stop.at.active_stops = {0};
  stop.item = 0;
  PathEvent spring = stop;
  spring.kind = PathEvent::Kind::slack;
  spring.on = true;
  Path path;
  path.branches.emplace_back().points = {stop.at, spring.at};
  path.events = {stop, spring};
  const Result result = path_result(varied, path, {}, {});
  const std::string text = plain_text(result, {}, Verbosity::normal);
  EXPECT_TRUE(contains(text, "\"over_centre\" comes off")) << text;
  EXPECT_TRUE(contains(text, "\"rubber\" acts from here")) << text;
  const json events = json::parse(json_text(result))["events"];
  EXPECT_EQ(events[0]["item"], "over_centre");
  EXPECT_EQ(events[0]["active_stops"], json({"over_centre"}));
  EXPECT_EQ(events[1]["item"], "rubber");
  EXPECT_TRUE(events[1]["on"].get<bool>());
  EXPECT_EQ(path_marks(varied, path).front().label, "start, 1, 2, end");
}

TEST(PathReport, CountsWhatIsNotProvedAndNamesTheFirst) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  for (const std::size_t i : {5, 9}) {
    path.branches.front().points[i].proof = PointProof::failed;
    path.branches.front().points[i].statement = "no proof for a test";
  }
  const Result result = path_result(varied, path, with_guide(varied), {});
  EXPECT_TRUE(contains(result.verdict.text, "2 of 112 points not proved")) << result.verdict.text;
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_TRUE(contains(result.warnings.front().text, "2 points are not proved, the first at load.P = "));
  EXPECT_TRUE(contains(result.warnings.front().text, "travel.guide = 0.45 m: no proof for a test"));
  const json points = json::parse(json_text(result))["points"];
  EXPECT_EQ(points[5]["proof"], "failed");
  EXPECT_TRUE(points[5]["radius"].is_null());
  EXPECT_EQ(points[6]["proof"], "proved");
}

TEST(PathReport, CountsCriticalPointsApart) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  path.branches.front().points[23].proof = PointProof::critical;
  const Result result = path_result(varied, path, with_guide(varied), {});
  EXPECT_TRUE(
      contains(plain_text(result, {}, Verbosity::normal), "111 of 112 points are proved, the other is critical;"));
  EXPECT_EQ(result.verdict.tone, Tone::good);
  EXPECT_TRUE(result.warnings.empty());
}

TEST(PathReport, WarnsOfABranchThatEndsEarly) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  path.status = Path::Status::incomplete;
  path.branches.front().end = PathBranch::End::stuck;
  path.branches.front().why = "the corrector does not converge";
  const Result result = path_result(varied, path, with_guide(varied), {});
  EXPECT_TRUE(contains(result.verdict.text, "Not followed to the end.")) << result.verdict.text;
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_TRUE(contains(result.warnings.front().text, "where no step succeeds: the corrector does not converge."))
      << result.warnings.front().text;
}

TEST(PathReport, SaysWhereThereIsNoStart) {
  const VariedScene varied = varied_toggle();
  Path path;
  path.status = Path::Status::no_start;
  path.why = "nothing holds the apex";
  EXPECT_TRUE(contains(text_of(varied, path, {}), "Nothing holds the apex."));
  path.why.clear();
  EXPECT_TRUE(contains(text_of(varied, path, {}), "No equilibrium found at load.P = 0 N."));
}

TEST(PathReport, KeepsWhatWasFollowedUntilItWasInterrupted) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  path.status = Path::Status::interrupted;
  path.branches.front().points.back().proof = PointProof::not_tried;
  const Result result = path_result(varied, path, with_guide(varied), {});
  EXPECT_TRUE(result.verdict.text.starts_with("Interrupted. Snaps at P = ")) << result.verdict.text;
  EXPECT_TRUE(contains(result.verdict.text, "; 1 of 112 points not checked.")) << result.verdict.text;
  const json answer = json::parse(json_text(result));
  EXPECT_EQ(answer["status"], "interrupted");
  EXPECT_EQ(answer["points"].size(), 112u);
}

TEST(PathReport, TellsLoadingFromUnloading) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  PathBranch back = path.branches.front();
  std::reverse(back.points.begin(), back.points.end());
  path.branches.push_back(back);
  PathView view = with_guide(varied);
  view.follow = PathOptions::Follow::jump;
  const std::string text = text_of(varied, path, view);
  EXPECT_TRUE(contains(text, "load.P from 0 N to 55.547 N, and back to 0 N: 2 folds")) << text;
  EXPECT_TRUE(contains(text, "where 1 ends")) << text;
}

TEST(PathReport, ShowsTheEquilibriaAtTheValuesAskedFor) {
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  PathView view = with_guide(varied);
  view.at = {20.0, 55.0};
  path.wanted = {{path.branches.front().points[7], path.branches.front().points[60]}, {}};
  const Result result = path_result(varied, path, view, {});
  const std::string text = plain_text(result, {}, Verbosity::normal);
  EXPECT_TRUE(contains(text, "Equilibria at the values asked for")) << text;
  EXPECT_TRUE(contains(text, "The curve has no equilibrium at load.P = 55 N.")) << text;
  const json at = json::parse(json_text(result))["at"];
  ASSERT_EQ(at.size(), 2u);
  EXPECT_EQ(at[0]["equilibria"].size(), 2u);
  EXPECT_NEAR(at[0]["equilibria"][0]["slides"]["guide"].get<double>(), 0.43, 1e-12);
  EXPECT_TRUE(at[1]["equilibria"].empty());
}

TEST(PathReport, HasOneLineInCsvForEachPoint) {
  const VariedScene varied = varied_toggle();
  const Path path = toggle_path(varied);
  PathView view = with_guide(varied);
  view.measures.push_back(find_quantity(varied.scene(), "apex.C.y"));
  const Result result = path_result(varied, path, view, {});
  ASSERT_NE(result.csv(), nullptr);
  const std::string lines = csv_text(*result.csv());
  EXPECT_TRUE(lines.starts_with(
      "branch,parameter,stability,proof,unstable_directions,energy,radius,guide,travel.guide,y.apex.C\n"))
      << lines.substr(0, 200);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 113);
}

TEST(PathReport, HasEventsAndBranchesInJson) {
  const VariedScene varied = varied_toggle();
  const json answer = json::parse(json_text(path_result(varied, toggle_path(varied), with_guide(varied), {})));
  EXPECT_EQ(answer["parameter"],
            json({{"name", "load.P"}, {"from", 0.0}, {"to", 60.0}, {"unit", "N"}, {"driven", nullptr}}));
  ASSERT_EQ(answer["events"].size(), 3u);
  EXPECT_EQ(answer["events"][0]["kind"], "fold");
  EXPECT_EQ(answer["events"][0]["digits"], 14);
  EXPECT_EQ(answer["events"][0]["before"], "stable");
  EXPECT_EQ(answer["events"][0]["after"], "unstable");
  EXPECT_TRUE(answer["events"][0]["landing"].is_null());
  EXPECT_NEAR(answer["events"][2]["landing"]["measures"]["travel.guide"].get<double>(), -0.6, 1e-12);
  EXPECT_GT(answer["events"][2]["energy_released"].get<double>(), 0.0);
  ASSERT_EQ(answer["branches"].size(), 1u);
  EXPECT_EQ(answer["branches"][0]["end"], "range");
  EXPECT_EQ(answer["branches"][0]["events"], json({1, 2}));
  EXPECT_TRUE(answer["branches"][0]["from_event"].is_null());
}

TEST(PathPicture, MarksWhatIsInTheTableAndDrawsTheMechanismThere) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const VariedScene varied = varied_toggle();
  Path path = toggle_path(varied);
  const std::string svg = path_picture(varied, path, {}, "the verdict", true);
  EXPECT_EQ(app_tests::objection_to_xml(svg), "");
  for (const char* part : {"the verdict", "load.P (N)", "travel.guide (m), which changes most", "stable", "unstable",
                           "multiple5", "1, 3: fold, snap", "3′: landing"}) {
    EXPECT_TRUE(contains(svg, part)) << part;
  }
  EXPECT_FALSE(contains(svg, "not proved"));
  path.branches.front().points[3].proof = PointProof::failed;
  EXPECT_TRUE(contains(path_picture(varied, path, {}, "", false), "not proved"));
}

TEST(PathChart, PutsTheLoadUpwardsAndBreaksTheLineAtFolds) {
  const VariedScene varied = varied_toggle();
  const Path path = toggle_path(varied);
  const std::vector<SoughtQuantity> measures = {find_quantity(varied.scene(), "guide")};
  const std::vector<PathMark> marks = path_marks(varied, path);
  ASSERT_EQ(marks.size(), 5u) << "start, fold with snap, landing, fold, end";
  const std::vector<Panel> panels = path_panels(varied, path, measures, marks, "");
  ASSERT_EQ(panels.size(), 1u);
  const Panel& panel = panels.front();
  EXPECT_EQ(panel.y_label, "load.P (N)");
  EXPECT_EQ(panel.x_label, "travel.guide (m)");
  ASSERT_EQ(panel.curves.size(), 2u);
  EXPECT_EQ(panel.curves[0].style, Curve::Style::line);
  EXPECT_EQ(panel.curves[1].style, Curve::Style::dashed);
  EXPECT_EQ(std::count_if(panel.curves[0].x.begin(), panel.curves[0].x.end(), [](double x) { return std::isnan(x); }),
            1)
      << "stable before the first fold and after the second";
  ASSERT_EQ(panel.arrows.size(), 1u);
  EXPECT_NEAR(panel.arrows[0].to_x, -0.6, 1e-12);
}

}  // namespace
}  // namespace poise::app::path_report_test

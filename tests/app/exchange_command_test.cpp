// `poise import` and `poise export`.

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app_tests::exchange_command_test {
namespace {

using Words = std::vector<std::string>;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const std::string four_bar = std::string(POISE_SOURCE_DIR) + "/datasets/exchange/four_bar.txt";

TEST(ImportCommand, PrintsTheSceneWithItsNotes) {
  const ProgramRun run = run_poise({"import", four_bar});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_TRUE(run.out.starts_with("# Lengths are taken for mm: the file names no unit.\n")) << run.out;
  const Scene scene = parse_scene(run.out, "printed.toml");
  EXPECT_EQ(scene.bodies.size(), 4U);
  EXPECT_EQ(scene.bodies[1].points[1].at, (Vec2{0.010, 0.020}));
}

TEST(ImportCommand, WritesTheSceneAndTheSameNotesEverywhere) {
  const TempFolder folder;
  const std::string scene = folder.path("four_bar.toml"), data = folder.path("o.json");
  const ProgramRun run = run_poise({"import", four_bar, "--units", "in", "--scene", scene, "--json", data});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "Read: 3 moving bodies, 4 joints, 1 degree of freedom.")) << run.out;
  EXPECT_EQ(read_scene(scene).units.length_name, "in");
  EXPECT_EQ(run_poise({"import", four_bar, "--units", "in"}).out, contents(scene));
  const nlohmann::json result = nlohmann::json::parse(contents(data));
  EXPECT_EQ(result["format"], "pmks-text");
  EXPECT_EQ(result["degrees_of_freedom"], 1);
  EXPECT_FALSE(result["notes"].empty());
  for (const nlohmann::json& note : result["notes"]) {
    EXPECT_TRUE(contains(contents(scene), "# " + note.get<std::string>() + "\n")) << note;
    EXPECT_TRUE(contains(run.out, note.get<std::string>().substr(0, 40))) << run.out;
  }
}

TEST(ImportCommand, RefusesInOneLineAndWritesNothing) {
  const TempFolder folder;
  const std::string no_scene = folder.path("o.toml");
  const auto expect_line = [&](const std::string& file, const Words& options, const std::string& message) {
    Words words = {"import", file, "--scene", no_scene};
    words.insert(words.end(), options.begin(), options.end());
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2) << message;
    EXPECT_EQ(run.out, "");
    EXPECT_TRUE(contains(run.err, message)) << run.err;
    EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(no_scene));
  };
  const std::string broken =
      folder.write("broken.dxf", "0\nSECTION\n2\nENTITIES\n0\nSPLINE\n8\narm\n0\nENDSEC\n0\nEOF\n");
  expect_line(broken, {}, "broken.dxf:6: SPLINE: expected LINE");
  expect_line(folder.write("cube.stl", "solid cube\n"), {}, "expected a file that ends with .dxf, .url, .txt");
  expect_line(four_bar, {"--format", "pmks_text"}, "--format: expected one of dxf, pmks, pmks-text");
  expect_line(four_bar, {"--units", "cm"}, "--units: expected m, mm, in or ft, found \"cm\"");
  expect_line(four_bar, {"--tolerance", "0"}, "--tolerance: expected a number > 0, found 0");
  expect_line(folder.path("none.dxf"), {}, "none.dxf: cannot be read");
  expect_line(folder.write("zero.dxf", std::string("0\nSEC\0", 6)), {}, "zero.dxf");
}

TEST(ExportCommand, WritesWhatImportReads) {
  const TempFolder folder;
  const std::string scene = folder.path("in.toml"), dxf = folder.path("o.dxf"), pmks = folder.path("o.url");
  ASSERT_EQ(run_poise({"import", four_bar, "--scene", scene}).exit_code, 0);
  const ProgramRun run = run_poise({"export", scene, "--dxf", dxf, "--pmks", pmks, "--svg", folder.path("o.svg")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "pmks: No joint is an input")) << run.out;
  EXPECT_EQ(objection_to_xml(contents(folder.path("o.svg"))), "");
  for (const std::string& file : {dxf, pmks}) {
    const ProgramRun back = run_poise({"import", file, "--scene", folder.path("back.toml")});
    EXPECT_TRUE(contains(back.out, "Read: 3 moving bodies, 4 joints, 1 degree of freedom.")) << back.out << back.err;
  }
}

TEST(ExportCommand, WritesTheEquilibrium) {
  const TempFolder folder;
  const std::string scene = folder.write("pendulum.toml",
                                         "gravity = [0, -10]\n[ground]\npoints = { O = [0, 0] }\n"
                                         "[body.arm]\npoints = { O = [0, 0], A = [2, 0] }\nmass = 1\n"
                                         "center = [1, 0]\n[[pin]]\npoints = [\"ground.O\", \"arm.O\"]\n");
  const std::string dxf = folder.path("o.dxf");
  EXPECT_EQ(run_poise({"export", scene, "--dxf", dxf}).exit_code, 0);
  EXPECT_TRUE(contains(contents(dxf), "LINE\n  8\narm\n 10\n0\n 20\n0\n 11\n2\n 21\n0\n")) << contents(dxf);
  EXPECT_EQ(run_poise({"export", scene, "--pose", "equilibrium", "--dxf", dxf}).exit_code, 0);
  EXPECT_TRUE(contains(contents(dxf), "LINE\n  8\narm\n 10\n0\n 20\n0\n 11\n0\n 21\n-2\n")) << contents(dxf);
}

// A four-bar whose coupler is longer at every position of the path: each is drawn with the length that it has there.
TEST(ExportCommand, DrawsThePositionsOfAPath) {
  const TempFolder folder;
  const std::string path = folder.path("path.json"), dxf = folder.path("o.dxf"), scene = dataset("toggle_clamp");
  ASSERT_EQ(
      run_poise({"path", scene, "--vary", "point.link.B.x=36..37", "--at", "36,36.5,37", "--json", path}).exit_code, 0);
  const ProgramRun run = run_poise({"export", scene, "--pose", "equilibrium," + path, "--dxf", dxf});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "The mechanism in 4 positions.")) << run.out;
  const std::string drawing = contents(dxf);
  for (const char* const layer : {"EQUILIBRIUM", "POSE_1", "POSE_3"}) {
    EXPECT_TRUE(contains(drawing, std::string("LINE\n  8\n") + layer + "\n")) << layer;
  }
  // The equilibrium is the first position of the path, and the link of the third is a millimetre longer.
  const auto lines_of = [&](const std::string& layer) {
    std::vector<double> out;
    const std::string begin = "LINE\n  8\n" + layer + "\n";
    for (std::size_t at = 0; (at = drawing.find(begin, at)) != std::string::npos; at += begin.size()) {
      std::istringstream words(drawing.substr(at + begin.size(), 400));
      double place[4] = {};
      std::string code;
      for (double& one : place) words >> code >> one;
      out.push_back(std::hypot(place[2] - place[0], place[3] - place[1]));
    }
    return out;
  };
  const std::vector<double> first = lines_of("POSE_1"), last = lines_of("POSE_3"), rest = lines_of("EQUILIBRIUM");
  ASSERT_EQ(first.size(), last.size());
  ASSERT_EQ(first.size(), rest.size());
  double longer = 0.0;
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_NEAR(first[k], rest[k], 1e-6);
    longer += last[k] - first[k];
  }
  EXPECT_NEAR(longer, 1.0, 1e-6);
  const auto refused = [&](const Words& options) {
    Words words = {"export", scene};
    words.insert(words.end(), options.begin(), options.end());
    const ProgramRun one = run_poise(words);
    EXPECT_EQ(one.exit_code, 2);
    EXPECT_EQ(one.err.find('\n'), one.err.size() - 1) << one.err;
    return one.err;
  };
  EXPECT_TRUE(
      contains(refused({"--pose", path, "--mjcf", folder.path("o.xml")}), "--mjcf: expected one position, found 3"));
  EXPECT_TRUE(contains(refused({"--pose", path + "," + path, "--dxf", dxf}), "expected each position once"));
  const std::string other = folder.write("other.json", "{\"status\": 1}");
  EXPECT_TRUE(contains(refused({"--pose", other, "--dxf", dxf}), "expected the result of poise path with --json"));
  ASSERT_EQ(run_poise({"path", dataset("four_bar_gravity"), "--vary", "gravity.y=-9..-10", "--json", path}).exit_code,
            0);
  EXPECT_TRUE(contains(refused({"--pose", path, "--dxf", dxf}), "expected a result of poise path on "));
}

TEST(ExportCommand, SaysWhatIsMissing) {
  const TempFolder folder;
  const std::string scene = dataset("toggle_clamp");
  const ProgramRun none = run_poise({"export", scene});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_TRUE(contains(none.err, "poise: expected a file to write, --dxf FILE")) << none.err;
  const std::string one = folder.path("o.dxf");
  const ProgramRun twice = run_poise({"export", scene, "--dxf", one, "--pmks", one});
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_TRUE(contains(twice.err, "is the --dxf file too")) << twice.err;
  EXPECT_TRUE(contains(run_poise({"export", scene, "--dxf", scene}).err, "is the scene too"));
  EXPECT_TRUE(contains(run_poise({"export", scene, "--pose", "end", "--dxf", one}).err, "--pose: expected start"));
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace poise::app_tests::exchange_command_test

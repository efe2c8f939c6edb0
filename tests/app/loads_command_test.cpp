#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::loads_command_test {
namespace {

using nlohmann::json;

json loads_of(const std::string& scene, int exit_code, std::vector<std::string> more = {}) {
  const TempFolder folder;
  const std::string file = folder.path("loads.json").string();
  std::vector<std::string> words{"loads", scene, "--json", file};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramRun outcome = run_poise(words);
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.out << outcome.err;
  return json::parse(contents(file));
}

TEST(LoadsCommand, PortalInItsUnits) {
  const json found = loads_of(dataset("structures/three_hinged_portal"), 0);
  EXPECT_EQ(found["stress_unit"], "kN/m²");
  ASSERT_EQ(found["links"].size(), 3U);
  EXPECT_EQ(found["links"][0]["name"], "post");
  EXPECT_NEAR(found["links"][0]["moment"].get<double>(), -36, 1e-9);
  EXPECT_NEAR(std::abs(found["links"][2]["moment"].get<double>()), 72, 1e-9);
  EXPECT_NEAR(found["links"][2]["moment_at"].get<double>(), 3, 1e-12);
  // The same in numbers twice as large.
  const json doubled = loads_of(dataset("structures/three_hinged_portal"), 0,
                                {"--set", "load.wind=18", "--set", "load.snow left=24", "--set", "load.snow right=24"});
  EXPECT_NEAR(doubled["links"][0]["moment"].get<double>(), -72, 1e-9);
}

TEST(LoadsCommand, FlexibleLinkHasTheLoadsOfItsBentShape) {
  const json found = loads_of(dataset("structures/elastica"), 0);
  ASSERT_EQ(found["links"].size(), 1U);
  EXPECT_TRUE(found["links"][0]["flexible"].get<bool>());
  // At the clamp the load times its distance, by elliptic integrals.
  EXPECT_NEAR(found["links"][0]["moment"].get<double>(), -400 * 0.6710587577531538, 1e-3);
  EXPECT_EQ(found["links"][0]["moment_at"].get<double>(), 0.0);
  EXPECT_TRUE(found["links"][0]["deflection"].is_null());
}

// All forces of the portal are linear in the wind: the largest are at an end of its range, and those between on a line.
TEST(LoadsCommand, OverARangeHasTheLoadsOfItsEquilibria) {
  const std::string portal = dataset("structures/three_hinged_portal");
  const json found = loads_of(portal, 0, {"--vary", "load.wind=0..20", "--steps", "4"});
  ASSERT_EQ(found["equilibria"]["parameter"].size(), 5U);
  const json calm = loads_of(portal, 0, {"--set", "load.wind=0"}),
             storm = loads_of(portal, 0, {"--set", "load.wind=20"});
  for (const json& link : found["links"]) {
    if (link["load"] != "moment") continue;
    const auto of = [&](const json& all) {
      for (const json& one : all["links"]) {
        if (one["name"] == link["name"]) return one["moment"].get<double>();
      }
      return 0.0;
    };
    const double value = link["value"], at = link["at"];
    EXPECT_NEAR(std::abs(value), std::max(std::abs(of(calm)), std::abs(of(storm))), 1e-9) << link["name"];
    EXPECT_NEAR(value, at == 0.0 ? of(calm) : of(storm), 1e-9) << link["name"];
  }
}

TEST(LoadsCommand, OverARangeSaysWhereItSnaps) {
  const ProgramRun outcome = run_poise({"loads", dataset("toggle_clamp"), "--vary", "load.P=0..60"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("At load.P = 37.09"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("the mechanism snaps"), std::string::npos) << outcome.out;
}

TEST(LoadsCommand, OverARangeNeedsNoLinks) {
  const json found = loads_of(dataset("toggle_press"), 0, {"--vary", "angle.crank=110..130", "--steps", "4"});
  EXPECT_EQ(found["parameter"]["driven"], "angle of crank in the world");
  EXPECT_TRUE(found["links"].empty());
  for (const json& joint : found["joints"]) {
    EXPECT_LE(joint["least"].get<double>(), joint["largest"].get<double>());
    const std::string key = "reaction." + joint["name"].get<std::string>() + ".size";
    const std::vector<double> all = found["equilibria"][key];
    const double largest = joint["largest"];
    EXPECT_GE(largest * (1 + 1e-12), *std::max_element(all.begin(), all.end()));
  }
  EXPECT_EQ(found["joints"].size(), 7U);
}

TEST(LoadsCommand, ExtremesAreThoseOfTheWholeRange) {
  const std::vector<std::string> range{"--vary", "angle.crank=110..150", "--steps"};
  const auto in_steps = [&](const std::string& steps) {
    std::vector<std::string> words = range;
    words.push_back(steps);
    return loads_of(dataset("toggle_press"), 0, words);
  };
  const json few = in_steps("3"), many = in_steps("400");
  double between = 0.0;
  for (std::size_t j = 0; j < few["joints"].size(); ++j) {
    const json &one = few["joints"][j], &fine = many["joints"][j];
    const std::vector<double> all = many["equilibria"]["reaction." + one["name"].get<std::string>() + ".size"];
    // A step of 0.1 deg is this near to an extreme, beside which forces fall to nothing and rise again.
    const double least = *std::min_element(all.begin(), all.end()), largest = *std::max_element(all.begin(), all.end());
    EXPECT_NEAR(one["least"], least, 1e-2 * largest) << one["name"];
    EXPECT_NEAR(one["largest"], largest, 1e-4 * largest) << one["name"];
    EXPECT_LE(one["least"].get<double>(), least * (1 + 1e-12));
    for (const char* key : {"least", "largest"}) {
      EXPECT_NEAR(one[key], fine[key], 2e-9 * largest) << one["name"];
      EXPECT_NEAR(one[std::string(key) + "_at"], fine[std::string(key) + "_at"], 1e-3) << one["name"];
    }
    const double at = one["least_at"];
    between = std::max(between, std::abs(std::remainder(at - 110, 40.0 / 3)));
  }
  EXPECT_GT(between, 1.0) << "deg: some extreme is between the three steps";
}

// A cantilever's bracket: a load of 3 N down and one of P up. Bar and pin carry nothing at P = 3 N, which is no step.
TEST(LoadsCommand, OfAStructureNothingIsWrittenAsZero) {
  const TempFolder folder;
  const std::string scene = folder.write("bracket.toml", R"(
[ground]
points = { A = [0, 0], B = [0, 0.7] }
[body.arm]
points = { A = [0, 0], C = [1.2, 0.2] }
[[pin]]
name = "hinge"
points = ["ground.A", "arm.A"]
[[bar]]
name = "stay"
points = ["ground.B", "arm.C"]
length = 1.3
[[force]]
name = "W"
at = "arm.C"
vector = [0, -3]
[[force]]
name = "P"
at = "arm.C"
vector = [0, 1]
)");
  const json found = loads_of(scene, 0, {"--vary", "load.P=0..8", "--steps", "4"});
  const json &hinge = found["joints"][0], &stay = found["joints"][1];
  ASSERT_EQ(hinge["name"], "hinge");
  EXPECT_EQ(hinge["least"], 0.0);
  EXPECT_NEAR(hinge["least_at"], 3, 1e-6);
  EXPECT_EQ(hinge["largest_at"], 8.0);
  // Its tension gives -5 N and 3 N times what the three directions give.
  EXPECT_EQ(stay["least_at"], 8.0);
  EXPECT_EQ(stay["largest_at"], 0.0);
  EXPECT_NEAR(stay["largest"].get<double>() / stay["least"].get<double>(), -3.0 / 5, 1e-12);
  const ProgramRun run = run_poise({"loads", scene, "--vary", "load.P=3..8", "--steps", "4"});
  EXPECT_EQ(run.out.find("e-"), std::string::npos) << run.out;
}

TEST(LoadsCommand, RefusesByNameWithoutDiagrams) {
  const TempFolder folder;
  const std::string scene = folder.write("clamped.toml", R"(
[ground]
points = { A = [0, 0], B = [1, 0] }
[body.beam]
points = { A = [0, 0], B = [1, 0] }
[body.beam.section]
profile = "IPE 80"
modulus = 2.1e11
[[weld]]
name = "left"
points = ["ground.A", "beam.A"]
[[weld]]
points = ["ground.B", "beam.B"]
[[force]]
at = "beam.B"
vector = [5, 0]
)");
  const json found = loads_of(scene, 1);
  EXPECT_TRUE(found["links"].empty());
  EXPECT_TRUE(found["diagrams"].empty());
  ASSERT_EQ(found["without"].size(), 1U);
  EXPECT_NE(found["without"][0]["why"].get<std::string>().find("weld left"), std::string::npos);
}

// A bar that falls about its foot: |M| is largest at a third of its length, m g l cos(a)/27 there.
TEST(LoadsCommand, InMotionCarriesInertia) {
  const json found = loads_of(dataset("structures/falling_chimney"), 0, {"--time", "0"});
  EXPECT_EQ(found["time"].get<double>(), 0.0);
  const json& link = found["links"][0];
  EXPECT_NEAR(std::abs(link["moment"].get<double>()), 90000 * 9.81 * 30 * std::cos(80 * M_PI / 180) / 27, 1e-6);
  EXPECT_NEAR(link["moment_at"].get<double>(), 10, 1e-9);
  const json later = loads_of(dataset("structures/falling_chimney"), 0, {"--time", "2.5"});
  EXPECT_NEAR(later["links"][0]["moment_at"].get<double>(), 10, 1e-9);
  EXPECT_LT(later["links"][0]["imbalance"].get<double>(), 1e-10);
}

TEST(LoadsCommand, InMotionRefusesWhatBelongsToStatics) {
  const auto complaint = [](std::vector<std::string> words) {
    const ProgramRun outcome = run_poise(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    return outcome.err;
  };
  const std::string chimney = dataset("structures/falling_chimney");
  EXPECT_NE(complaint({"loads", chimney, "--time", "-1"}).find("--time"), std::string::npos);
  EXPECT_NE(complaint({"loads", chimney, "--time", "1", "--seek", "any"}).find("no equilibrium is sought"),
            std::string::npos);
}

TEST(LoadsCommand, LinksThatBendHaveLoadsInMotion) {
  const json rod = loads_of(dataset("machines/elastic_slider_crank"), 0, {"--time", "0.05"})["links"][0];
  EXPECT_TRUE(rod["flexible"].get<bool>());
  EXPECT_TRUE(rod["deflection"].is_null());
  EXPECT_GT(std::abs(rod["moment"].get<double>()), 1.0);
  // Stresses in the extreme fibres of a square of side a: N / a^2 -+ 6 M / a^3, largest where M nearly is.
  const double a = 0.008, bending = 6 * std::abs(rod["moment"].get<double>()) / (a * a * a);
  EXPECT_NEAR(rod["tension"].get<double>(), bending, 0.02 * bending);
  EXPECT_NEAR(rod["compression"].get<double>(), -bending, 0.02 * bending);
  // Without mass nothing determines how a link moves.
  const ProgramRun massless = run_poise({"loads", dataset("structures/elastica"), "--time", "1"});
  EXPECT_EQ(massless.exit_code, 1);
  EXPECT_NE(massless.out.find("no inertia"), std::string::npos) << massless.out;
}

TEST(LoadsCommand, NeedsASection) {
  const ProgramRun outcome = run_poise({"loads", dataset("toggle_clamp")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("expected a body with a section"), std::string::npos) << outcome.err;
}

TEST(LoadsCommand, DrawsItsDiagrams) {
  const TempFolder folder;
  const std::string svg = folder.path("loads.svg").string();
  const ProgramRun outcome = run_poise({"loads", dataset("structures/three_hinged_portal"), "--svg", svg});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string drawn = contents(svg);
  EXPECT_NE(drawn.find("Bending moment, on the stretched side"), std::string::npos);
  EXPECT_NE(drawn.find("id=\"diagrams\""), std::string::npos);
  EXPECT_NE(drawn.find("internal load along the link"), std::string::npos);
}

}  // namespace
}  // namespace poise::app_tests::loads_command_test

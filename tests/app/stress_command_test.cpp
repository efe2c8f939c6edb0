// `poise stress` through its command line.

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/comparison/toy_catalogue.hpp"

namespace poise::app_tests::stress_command_test {
namespace {

using nlohmann::json;
using test::both_equilibria;
using test::toy_case;
using test::toy_equilibrium;
using test::ToyCatalogue;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string sound_cases() {
  return toy_case("hanging", "pendulum", "complete = true\nseek = \"stable\"\nstarts = 20\n" + both_equilibria()) +
         toy_case("jet", "follower",
                  "complete = true\nreach = 0.5\nstarts = 20\n" + toy_equilibrium("rod", "1.0", "stable")) +
         toy_case("away", "runaway", "expect = \"none\"\nstarts = 20\nwhy = \"nothing holds the block\"\n");
}

// A list with wrong equilibria.
std::string unsound_cases() {
  return toy_case("bent", "pendulum", "complete = true\nstarts = 20\n" + toy_equilibrium("rod", "0.5", "stable"));
}

ProgramRun run_stress(const ToyCatalogue& catalogue, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"stress", "--catalogue", catalogue.path().string()});
  return run_poise(arguments);
}

TEST(StressCommand, ShowsAllCasesOnOneSheet) {
  const ProgramRun run = run_stress(ToyCatalogue(sound_cases()), {"--methods", "virtual-work,energy"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "No false claims.\n")) << run.out;
  EXPECT_TRUE(has(run.out, "  Toys\n")) << run.out;
  EXPECT_TRUE(has(run.out, "    hanging  stable     100  100\n")) << run.out;
  EXPECT_TRUE(has(run.out, "    jet      nearest    100    -\n")) << run.out;
  EXPECT_TRUE(has(run.out, "    away     none       100  100\n")) << run.out;
  EXPECT_TRUE(has(run.out, "  1  virtual-work  2 of 2             0       0")) << run.out;
  EXPECT_TRUE(has(run.out, "  2  energy        1 of 1             0       0")) << run.out;
  EXPECT_TRUE(has(run.out, "  away: nothing holds the block\n")) << run.out;
  EXPECT_EQ(run.err, "");
}

TEST(StressCommand, ShowsOneCaseInDetail) {
  const ProgramRun run = run_stress(ToyCatalogue(sound_cases()), {"jet", "--methods", "virtual-work,energy"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "jet: Toy\n  source       ours\n")) << run.out;
  EXPECT_TRUE(has(run.out, "1 stable; a complete list")) << run.out;
  EXPECT_TRUE(has(run.out, "virtual-work      20")) << run.out;
  EXPECT_TRUE(has(run.out, "  energy       force \"jet\" follows a body")) << run.out;
  EXPECT_FALSE(has(run.out, "hanging")) << run.out;
}

TEST(StressCommand, AWrongClaimIsMarkedAndFails) {
  const ToyCatalogue catalogue(sound_cases() + unsound_cases());
  const ProgramRun run = run_stress(catalogue, {"--methods", "virtual-work"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_TRUE(has(run.out, "20 false claims: confirmed answers that are no equilibrium, or of another stability.\n"))
      << run.out;
  EXPECT_TRUE(has(run.out, "virtual-work converges from less than 99.9 % of the starts of bent.\n")) << run.out;
  EXPECT_TRUE(has(run.out, "    bent     nearest     0!\n")) << run.out;
  const ProgramRun one = run_stress(catalogue, {"bent", "--methods", "virtual-work"});
  EXPECT_EQ(one.exit_code, 1);
  EXPECT_TRUE(has(one.out, "from the nearest known equilibrium; it is at rod ")) << one.out;
  EXPECT_EQ(run_stress(catalogue, {"hanging", "--methods", "virtual-work"}).exit_code, 0);
}

TEST(StressCommand, WhatVirtualWorkMissesFailsAndWhatOthersMissDoesNot) {
  // The stable equilibrium is listed; the unstable one, at the start, is not sought.
  const ToyCatalogue catalogue(toy_case("away", "runaway", "starts = 5\n"));
  EXPECT_EQ(run_stress(catalogue, {"--methods", "virtual-work"}).exit_code, 1);
  EXPECT_EQ(run_stress(catalogue, {"--methods", "energy"}).exit_code, 0);
}

TEST(StressCommand, ListsCases) {
  const ProgramRun run = run_stress(ToyCatalogue(sound_cases()), {"--list"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "  hanging  stable         20  Toy\n")) << run.out;
  EXPECT_TRUE(has(run.out, "  away     none           20  Toy\n")) << run.out;
}

TEST(StressCommand, FindsTheCatalogueOfPoise) {
  const ProgramRun run = run_poise({"stress", "--list"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "what is hard")) << run.out;
}

TEST(StressCommand, WritesWhatItFound) {
  const ToyCatalogue catalogue(sound_cases() + unsound_cases());
  const TempFolder out;
  const ProgramRun run =
      run_stress(catalogue, {"--methods", "virtual-work,energy", "--json", out.path("a.json").string(), "--csv",
                             out.path("a.csv").string(), "--markdown", out.path("a.md").string()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_TRUE(has(run.out, "wrote " + out.path("a.md").string())) << run.out;
  const json r = json::parse(contents(out.path("a.json")));
  EXPECT_EQ(r["interrupted"], false);
  ASSERT_EQ(r["cases"].size(), 4U);
  EXPECT_EQ(r["cases"][0]["seek"], "stable");
  const json& cell = r["cases"][0]["methods"][0];
  EXPECT_EQ(cell["method"], "virtual-work");
  EXPECT_EQ(cell["converged"], 20);
  EXPECT_LT(cell["error"].get<double>(), 1e-12);
  EXPECT_EQ(r["cases"][1]["methods"][1]["applies"], false);
  EXPECT_TRUE(r["cases"][1]["methods"][1]["error"].is_null());
  EXPECT_EQ(r["cases"][2]["expect"], "none");
  EXPECT_EQ(r["cases"][3]["methods"][0]["false_claims"], 20);

  const std::string csv = contents(out.path("a.csv"));
  EXPECT_TRUE(
      csv.starts_with("case,kind,expect,method,why,applies,starts,converged,false_claims,denied_by_check,"
                      "iterations,microseconds,error,allowed\nhanging,Toys,equilibrium,virtual-work,\"\",1,20,20,0,0,"))
      << csv;
  EXPECT_TRUE(has(csv, ",0,0,0,0,0,,,,\n")) << csv;

  const std::string page = contents(out.path("a.md"));
  EXPECT_TRUE(has(page, "Source: poise stress --catalogue ")) << page;
  EXPECT_TRUE(has(page,
                  "| case | asked for | 1 | 2 |\n| --- | --- | ---: | ---: |\n| **Toys** |  |  |  |\n"
                  "| hanging | stable | 100 | 100 |\n| jet | nearest | 100 | - |\n"))
      << page;
  EXPECT_TRUE(has(page, "| bent | nearest | 0! | ")) << page;
  EXPECT_TRUE(has(page, "- away: nothing holds the block\n")) << page;
}

TEST(StressCommand, ShowsTheEffectOfSafeguards) {
  const ToyCatalogue catalogue(sound_cases());
  const ProgramRun run = run_stress(catalogue, {"--safeguards"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_TRUE(has(run.out, "1  all on")) << run.out;
  EXPECT_TRUE(has(run.out, "3  without inertia correction")) << run.out;
  // Only where something differs.
  EXPECT_TRUE(has(run.out, "    hanging  stable")) << run.out;
  EXPECT_FALSE(has(run.out, "    away")) << run.out;
}

TEST(StressCommand, NamesTheError) {
  const ToyCatalogue catalogue(sound_cases());
  const auto error_of = [&](const std::vector<std::string>& arguments) {
    const ProgramRun run = run_stress(catalogue, arguments);
    EXPECT_EQ(run.exit_code, 2) << run.out;
    EXPECT_EQ(run.out, "");
    return run.err;
  };
  EXPECT_EQ(error_of({"hangin"}),
            "CASE: the catalogue has none that is called \"hangin\"; did you mean \"hanging\"?; poise stress --list "
            "shows all\n");
  EXPECT_EQ(error_of({"--starts", "0"}), "--starts: expected a number from 1 to 1000000, found 0\n");
  EXPECT_EQ(error_of({"--seconds", "0"}), "--seconds: expected a finite number > 0, found 0\n");
  EXPECT_EQ(error_of({"--work", "0"}), "--work: expected a finite number > 0, found 0\n");
  EXPECT_EQ(error_of({"--safeguards", "--methods", "energy"}),
            "--methods: expected none with --safeguards, which are those of virtual-work; leave one out\n");
  EXPECT_TRUE(has(error_of({"--methods", "newton"}), "--methods: expected ")) << error_of({"--methods", "newton"});
  const ProgramRun nowhere = run_poise({"stress", "--catalogue", "/nowhere"});
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_TRUE(has(nowhere.err, "/nowhere/catalogue.toml: cannot be read")) << nowhere.err;
}

}  // namespace
}  // namespace poise::app_tests::stress_command_test

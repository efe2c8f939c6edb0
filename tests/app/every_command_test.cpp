#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/app/run_poise.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/seed.hpp"

namespace poise::app_tests::every_command_test {
namespace {

/// The commands on a scene, with options that work on any.
std::vector<std::vector<std::string>> commands_on(const std::string& scene, const TempFolder& folder) {
  const std::string json = folder.path("o.json"), csv = folder.path("o.csv"), svg = folder.path("o.svg"),
                    html = folder.path("o.html");
  return {{"check", scene, "--json", json},
          {"solve", scene, "--json", json, "--html", html},
          {"equilibria", scene, "--seconds", "0", "--starts", "20", "--svg", svg},
          {"hold", scene, "--vary", "loads", "--json", json},
          {"path", scene, "--vary", "loads=0..2", "--csv", csv, "--svg", svg},
          {"find", scene, "--vary", "loads=0.5..1.5", "--for", "energy = 0.1", "--csv", csv, "--svg", svg},
          {"sensitivity", scene, "--of", "energy", "--json", json},
          {"path", scene, "--vary", "loads=0.5..1", "--variant", "A: gravity.y=-1", "--at", "0.75", "--html", html},
          {"loads", scene, "--csv", csv},
          {"loads", scene, "--vary", "loads=0.5..1", "--steps", "2", "--csv", csv, "--html", html},
          {"compare", scene, "--markdown", folder.path("o.md")},
          {"modes", scene, "--json", json, "--svg", svg},
          {"response", scene, "--excite", "load.P", "--of", "length.spring", "--json", json, "--csv", csv},
          {"motion", scene, "--duration", "0.1", "--csv", csv, "--json", json},
          {"equations", scene, "--from", "start", "--code", folder.path("o.c"), "--python", folder.path("o.py"),
           "--json", json},
          {"forces", scene, "--verbose", "--json", json, "--svg", svg},
          {"export", scene, "--dxf", folder.path("o.dxf"), "--pmks", folder.path("o.url"), "--svg", svg},
          {"export", scene, "--urdf", folder.path("o.urdf")},
          {"export", scene, "--mjcf", folder.path("o.xml")}};
}

// What sanitizers would say is looked for, and so is any end but the three that a command may have.
TEST(EveryCommand, RandomScenesEndInOneOfThreeWays) {
  const TempFolder folder;
  const int scenes = test::cases(3, 30);
  for (int k = 0; k < scenes; ++k) {
    const std::uint64_t seed = test::seed(70000) + static_cast<std::uint64_t>(k);
    const test::PlantedMechanism planted =
        test::plant_mechanism(seed, {.loops = k % 3, .followers = k % 5 == 0, .stops = k % 2 == 0, .couplings = true});
    const std::string scene = folder.write("scene.toml", test::scene_text(planted.scene));
    for (const std::vector<std::string>& words : commands_on(scene, folder)) {
      SCOPED_TRACE(fmt::format("{} of {}", words.front(), seed));
      const ProgramRun outcome = run_poise(words);
      EXPECT_TRUE(outcome.exit_code >= 0 && outcome.exit_code <= 2) << outcome.exit_code;
      for (const char* fault : {"Sanitizer", "runtime error", "poise: failed", "Assertion"}) {
        EXPECT_EQ(outcome.err.find(fault), std::string::npos) << outcome.err;
      }
    }
  }
}

}  // namespace
}  // namespace poise::app_tests::every_command_test

// Stops, ropes and cams in `poise motion` and `poise path --snap dynamic`.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::contact_command_test {
namespace {

using nlohmann::json;

constexpr double g = 9.81;

/// A ball of 1 kg that falls by 1000 mm on a floor, with further keys of the stop.
std::string ball(const std::string& keys) {
  return fmt::format(R"(gravity = [0, -9810]
[units]
length = "mm"
[ground]
points = {{ O = [0, 0] }}
[body.ball]
points = {{ C = [0, 0] }}
mass = 1
[[slide]]
name = "y"
points = ["ground.O", "ball.C"]
axis = [0, 1]
[[stop]]
name = "floor"
y = "ball.C"
min = 0
{}
[start]
y = 1000
)",
                     keys);
}

std::vector<std::string> motion_of(const std::string& scene, const std::vector<std::string>& further = {}) {
  std::vector<std::string> all{"motion", scene, "--from", "start", "--duration", "5"};
  all.insert(all.end(), further.begin(), further.end());
  return all;
}

TEST(ContactCommand, ShowsTheEventsOfABouncingBall) {
  const TempFolder folder;
  const std::string scene = folder.write("ball.toml", ball("restitution = 0.8"));
  const json r = run_json(folder, motion_of(scene), 0);
  const double t1 = std::sqrt(2 / g), v = std::sqrt(2 * g);
  const json& first = r["events"][0];
  EXPECT_EQ(first["what"], "impact");
  EXPECT_EQ(first["name"], "floor");
  EXPECT_EQ(first["side"], "min");
  EXPECT_NEAR(first["t"].get<double>(), t1, 1e-12);
  EXPECT_NEAR(first["rate_before"].get<double>(), -1000 * v, 1e-8);
  EXPECT_NEAR(first["rate_after"].get<double>(), 800 * v, 1e-8);
  EXPECT_NEAR(first["impulse"].get<double>(), 1.8 * v, 1e-11);
  EXPECT_NEAR(first["energy_lost"].get<double>(), 1000 * 0.36 * g, 1e-7);
  EXPECT_TRUE(first["unique"].get<bool>());
  const json& last = r["events"].back();
  EXPECT_EQ(last["what"], "rest");
  EXPECT_NEAR(last["t"].get<double>(), 9 * t1, 1e-9);
  const ProgramRun run = run_poise(motion_of(scene));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("floor (min)"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("-4429.45 mm/s"), std::string::npos) << run.out;
}

// One line for each event, with the numbers of the JSON.
TEST(ContactCommand, WritesEventsAsCsv) {
  const TempFolder folder;
  const std::string scene = folder.write("ball.toml", ball("restitution = 0.8"));
  const std::string file = folder.path("events.csv").string();
  const json r = run_json(folder, motion_of(scene, {"--events", file}), 0);
  const std::string text = contents(file);
  EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')), 1 + r["events"].size());
  const json& first = r["events"][0];
  const std::string row = fmt::format("\n{},impact,floor,min,{},{},{},{},yes\n", first["t"].get<double>(),
                                      first["rate_before"].get<double>(), first["rate_after"].get<double>(),
                                      first["impulse"].get<double>(), first["energy_lost"].get<double>());
  EXPECT_TRUE(text.starts_with("t,what,name,side,rate_before,rate_after,impulse,energy_lost,unique" + row)) << text;
  // The keys are there where nothing happens, too.
  ASSERT_EQ(run_poise({"motion", scene, "--from", "start", "--duration", "0.1", "--events", file}).exit_code, 0);
  EXPECT_EQ(contents(file), "t,what,name,side,rate_before,rate_after,impulse,energy_lost,unique\n");
}

// Of a ball that lies, the floor carries the weight in every position, and the bodies balance.
TEST(ContactCommand, ForcesOfWhatIsTouchedBalance) {
  const TempFolder folder;
  const std::string scene = folder.write("ball.toml", ball("restitution = 0"));
  const json r = run_json(folder, motion_of(scene, {"--rate", "20", "--forces"}), 0);
  EXPECT_TRUE(r["forces"]["balanced"].get<bool>());
  EXPECT_LT(r["forces"]["energy_error"].get<double>(), 1e-9) << "but for what the impact takes";
  const json& largest = r["forces"]["largest"];
  const auto floor =
      std::find_if(largest.begin(), largest.end(), [](const json& one) { return one["name"] == "stop.floor"; });
  ASSERT_NE(floor, largest.end()) << largest;
  EXPECT_NEAR((*floor)["value"].get<double>(), -g, 1e-9);
}

TEST(ContactCommand, ADriveAgainstAStopExitsWithOne) {
  const TempFolder folder;
  const std::string scene =
      folder.write("ball.toml", ball("") + "[[drive]]\nname = \"ram\"\nslide = \"y\"\nrate = -500\n");
  const ProgramRun run = run_poise(motion_of(scene));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("drives push against stop \"floor\""), std::string::npos) << run.out;
}

TEST(ContactCommand, BadInputIsOneLine) {
  const TempFolder folder;
  const auto message = [&](const std::string& keys) {
    const ProgramRun run = run_poise(motion_of(folder.write("ball.toml", ball(keys))));
    EXPECT_EQ(run.exit_code, 2) << keys;
    return run.err;
  };
  EXPECT_NE(message("restitution = 1.5").find("expected a coefficient of restitution from 0 to 1"), std::string::npos);
  EXPECT_NE(message("restitution = -0.1").find("expected a finite number >= 0"), std::string::npos);
  EXPECT_NE(message("friction = -0.1").find("expected a finite number >= 0"), std::string::npos);
  EXPECT_NE(message("law = \"newtons\"").find("newton"), std::string::npos);
  EXPECT_NE(message("max = 0\nrestitution = 0.5").find("expected no restitution"), std::string::npos);
  EXPECT_NE(
      message("[[stop]]\nname = \"side\"\nslide = \"y\"\nmax = 2000\nfriction = 0.3").find("expected a stop on x"),
      std::string::npos);
  EXPECT_NE(message("law = \"newton\"\n[[stop]]\nname = \"roof\"\nslide = \"y\"\nmax = 2000\nlaw = \"poisson\"")
                .find("expected the law of stop \"floor\""),
            std::string::npos);
  const ProgramRun below = run_poise(motion_of(folder.write("ball.toml", ball("")), {"--release", "y=-1100"}));
  EXPECT_EQ(below.exit_code, 2);
  EXPECT_NE(below.err.find("the motion would begin"), std::string::npos) << below.err;
}

// The clamp springs open and hits its stop: what it has at the impact is what the fall of its potential gave it.
TEST(ContactCommand, ASnapIsPlayedWithItsMotion) {
  const TempFolder folder;
  std::string clamp = contents(dataset("toggle_clamp"));
  const std::string limit = "max = 32\n";
  ASSERT_NE(clamp.find(limit), std::string::npos);
  clamp.replace(clamp.find(limit), limit.size(), limit + "restitution = 0.2\n");
  const json r = run_json(
      folder,
      {"path", folder.write("clamp.toml", clamp), "--vary", "load.P=0..45", "--follow", "jump", "--snap", "dynamic"},
      0);
  ASSERT_EQ(r["snaps"].size(), 1U);
  const json& snap = r["snaps"][0];
  EXPECT_TRUE(snap["why"].is_null()) << snap;
  EXPECT_EQ(snap["hit"]["name"], "open");
  EXPECT_GT(snap["hit"]["rate"].get<double>(), 0.0);
  EXPECT_TRUE(snap["rests"].get<bool>());
  EXPECT_EQ(snap["against"][0], "open");
  // All that the snap releases is lost in impacts; the first, of restitution 0.2, takes 1 - 0.04 of it.
  const json& event = r["events"][snap["event"].get<std::size_t>()];
  EXPECT_NEAR(snap["hit"]["energy_lost"].get<double>() / event["energy_released"].get<double>(), 0.96, 1e-3);
}

}  // namespace
}  // namespace poise::app_tests::contact_command_test

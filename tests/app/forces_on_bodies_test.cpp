#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/seed.hpp"

namespace poise::app_tests::forces_on_bodies_test {
namespace {

using nlohmann::json;

struct Sum {
  double x = 0.0, y = 0.0, moment = 0.0;
};

/// The largest force, or moment over the extent of the places, that a body keeps in a list forces_on_bodies, over the
/// largest force in it. It knows nothing but the list.
double imbalance(const json& list) {
  std::map<std::pair<int, std::string>, Sum> sums;
  double largest = 0.0, extent = 0.0;
  Sum centre;
  for (const json& row : list) {
    centre.x += row["at"][0].get<double>() / static_cast<double>(list.size());
    centre.y += row["at"][1].get<double>() / static_cast<double>(list.size());
  }
  for (const json& row : list) {
    const double x = row["at"][0].get<double>() - centre.x, y = row["at"][1].get<double>() - centre.y;
    extent = std::max({extent, std::abs(x), std::abs(y)});
  }
  for (const json& row : list) {
    const double x = row["at"][0].get<double>() - centre.x, y = row["at"][1].get<double>() - centre.y;
    const double fx = row["force"][0], fy = row["force"][1], moment = row["moment"];
    largest = std::max({largest, std::hypot(fx, fy), extent > 0 ? std::abs(moment) / extent : 0.0});
    if (row["body"] == "ground") continue;
    Sum& sum = sums[{row.value("position", 0), row["body"]}];
    sum.x += fx;
    sum.y += fy;
    sum.moment += moment + x * fy - y * fx;
  }
  double worst = 0.0;
  for (const auto& [body, sum] : sums) {
    worst = std::max({worst, std::hypot(sum.x, sum.y), extent > 0 ? std::abs(sum.moment) / extent : 0.0});
  }
  return largest > 0 ? worst / largest : 0.0;
}

json result_of(const TempFolder& folder, std::vector<std::string> words) {
  const std::string file = folder.path("result.json").string();
  std::filesystem::remove(file);
  words.insert(words.end(), {"--json", file});
  run_poise(words);
  return std::filesystem::exists(file) ? json::parse(contents(file)) : json();
}

/// Expects balance where the result has the list; whether it has.
bool expect_balance(const json& result) {
  if (!result.contains("forces_on_bodies") || result["forces_on_bodies"].is_null()) return false;
  if (result.contains("balanced") && !result["balanced"].get<bool>()) return false;
  if (result.contains("status") && result["status"] != "confirmed" && result["status"] != "checked, not proved") {
    return false;
  }
  if (result["forces_on_bodies"].empty()) return false;
  EXPECT_LT(imbalance(result["forces_on_bodies"]), 1e-7);
  return true;
}

std::vector<json> rows_of(const json& list, const std::string& name) {
  std::vector<json> out;
  std::copy_if(list.begin(), list.end(), std::back_inserter(out), [&](const json& row) { return row["name"] == name; });
  return out;
}

constexpr const char* weight_on_a_rope = R"(
gravity = [0, -10]
[ground]
points = { A = [-1, 1], P = [0, 1] }
[body.a]
points = { C = [0, 0] }
mass = 1
[[slide]]
name = "guide"
points = ["ground.P", "a.C"]
axis = [0, 1]
[[rope]]
name = "rope"
over = ["ground.A", "ground.P", "a.C"]
length = 2
)";

// It pulls the weight up, and each of the ground's points towards the next.
TEST(ForcesOnBodies, RopePullsTheWeightUp) {
  const TempFolder folder;
  const json found = result_of(folder, {"solve", folder.write("scene.toml", weight_on_a_rope)});
  const std::vector<json> rows = rows_of(found["reactions"], "rope");
  ASSERT_EQ(rows.size(), 3U);
  for (const json& row : rows) {
    const bool is_end = row["at"][0] == -1.0;
    if (row["on"] == "a") {
      EXPECT_NEAR(row["force"][0].get<double>(), 0.0, 1e-9);
      EXPECT_NEAR(row["force"][1].get<double>(), 10.0, 1e-9);
    } else {
      EXPECT_NEAR(row["force"][0].get<double>(), is_end ? 10.0 : -10.0, 1e-9);
      EXPECT_NEAR(row["force"][1].get<double>(), is_end ? 0.0 : -10.0, 1e-9);
    }
    EXPECT_NEAR(row["axial"].get<double>(), 10.0, 1e-9);
    EXPECT_LT(row["radius"].get<double>(), 1e-9);
  }
  EXPECT_TRUE(expect_balance(found));
}

TEST(ForcesOnBodies, EveryDatasetBalances) {
  const TempFolder folder;
  int lists = 0;
  for (const auto& file :
       std::filesystem::recursive_directory_iterator(std::filesystem::path(POISE_SOURCE_DIR) / "datasets")) {
    if (file.path().extension() != ".toml") continue;
    SCOPED_TRACE(file.path().string());
    for (const char* command : {"solve", "forces", "loads", "hold"}) {
      lists += expect_balance(result_of(folder, {command, file.path()}));
    }
  }
  EXPECT_GT(lists, 60);
}

// With ropes, gears, racks, couplings and cams, and what rests on stops.
TEST(ForcesOnBodies, RandomScenesBalance) {
  const TempFolder folder;
  int lists = 0;
  const int count = test::cases(60, 300);
  for (int k = 0; k < count; ++k) {
    const std::uint64_t seed = test::seed(40000) + static_cast<std::uint64_t>(k);
    SCOPED_TRACE(seed);
    const test::PlantedMechanism planted =
        test::plant_mechanism(seed, {.loops = k % 3, .followers = k % 5 == 0, .stops = k % 2 == 0, .couplings = true});
    const std::string scene = folder.write("scene.toml", test::scene_text(planted.scene));
    lists += expect_balance(result_of(folder, {"solve", scene, "--seek", "any"}));
  }
  EXPECT_GT(lists, count * 9 / 10);
}

}  // namespace
}  // namespace poise::app_tests::forces_on_bodies_test

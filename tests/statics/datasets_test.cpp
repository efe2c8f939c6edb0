// Every scene of datasets/ against datasets/answers.json, whose numbers were computed apart from Poise.

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::datasets_test {
namespace {

using nlohmann::json;
using test::dataset;
using test::number;
using test::scene_names;

constexpr double virtual_work_tolerance = 1e-12;
constexpr double energy_tolerance = 1e-9;

const json& answers() {
  static const json all = test::read_json(dataset("answers.json"));
  return all;
}

std::map<std::string, double> numbers(const json& object) {
  std::map<std::string, double> out;
  for (const auto& [name, value] : object.items()) out[name] = number(value);
  return out;
}

std::map<std::string, double> coordinates(const json& equilibrium) {
  std::map<std::string, double> out = numbers(equilibrium.at("angles"));
  out.merge(numbers(equilibrium.at("travels")));
  return out;
}

std::set<std::string> pressing_stops(const Check& check) {
  std::set<std::string> names;
  for (const Reaction& reaction : check.reactions) {
    const double moment = std::abs(reaction.moment);
    if (reaction.of_stop() && norm(reaction.force) + moment > 0.0) names.insert(reaction.name);
  }
  return names;
}

void expect_agrees(const StaticModel& model, const Equilibrium& found, const json& known, double tolerance) {
  ASSERT_EQ(found.status, Status::confirmed) << found.why;
  const double allowed = std::max(tolerance, found.certificate.rounding_effect);
  ASSERT_LE(test::error_of(model, found.x, coordinates(known)), allowed) << to_string(found.certificate.stability);
  for (const auto& [name, at] : known.at("points").items()) {
    const Vec2 place = test::place_of(model, found.x, name);
    EXPECT_LE(norm(place - Vec2{number(at[0]), number(at[1])}), 4 * allowed * model.scales().length) << name;
  }
  EXPECT_EQ(found.certificate.stability, known.at("stable").get<bool>() ? Stability::stable : Stability::unstable);
  EXPECT_EQ(found.certificate.unstable_directions, known.at("unstable_directions").get<int>());
  const auto stops = known.value("active_stops", std::set<std::string>{});
  EXPECT_EQ(pressing_stops(found.check), stops);
}

class Datasets : public testing::TestWithParam<std::string> {
 protected:
  Scene scene() const { return read_scene(dataset(GetParam())); }
  const json& known() const { return answers().at(GetParam()); }
};

// Experiments and designs are no scenes; scenes of motion need not have an equilibrium.
TEST(Answers, HoldOneEntryForEachSceneOfStatics) {
  const std::set<std::string> of_motion = {"andrews.toml", "duffing.toml", "nfb2.toml", "pendulum_a01.toml",
                                           "three_motor_robot.toml"};
  std::vector<std::string> scenes;
  for (const auto& entry : std::filesystem::directory_iterator(dataset(""))) {
    const std::string name = entry.path().filename().string();
    const bool is_scene = name.ends_with(".toml") && name.find("_experiment") == std::string::npos &&
                          !name.ends_with("_design.toml") && !name.ends_with("_plan.toml") &&
                          !name.ends_with("_tolerances.toml");
    if (is_scene && of_motion.count(name) == 0) scenes.push_back(name);
  }
  std::sort(scenes.begin(), scenes.end());
  EXPECT_EQ(scene_names(), scenes);
}

TEST_P(Datasets, SaysWhereItComesFrom) {
  EXPECT_FALSE(scene().title.empty());
  EXPECT_FALSE(scene().source.empty());
}

// The first equilibrium of each list is the one that the scene's own [start] is near, or in which it settles from
// there.
TEST_P(Datasets, RestsByVirtualWorkFromItsOwnStart) {
  const StaticModel model(scene());
  const Seek seek = known().value("settles", false) ? Seek::settle : Seek::any;
  expect_agrees(model, solve(model, test::by(Method::virtual_work, seek)), known().at("equilibria").at(0),
                virtual_work_tolerance);
}

TEST_P(Datasets, RestsByEnergyFromItsOwnStart) {
  const StaticModel model(scene());
  const Seek seek = known().value("settles", false) ? Seek::settle : Seek::any;
  const Equilibrium found = solve(model, test::by(Method::energy, seek));
  if (model.mechanism().has_follower_loads()) {
    EXPECT_EQ(found.status, Status::not_applicable);
    return;
  }
  const json& nearest = known().at("equilibria").at(0);
  if (nearest.at("stable").get<bool>()) {
    expect_agrees(model, found, nearest, energy_tolerance);
  } else if (found.found()) {
    // It may find an equilibrium that is not in the list, but one reported stable is stable.
    EXPECT_EQ(found.certificate.unstable_directions, found.certificate.stability == Stability::stable ? 0 : 1);
  } else {
    EXPECT_NE(found.status, Status::not_confirmed) << found.why;
  }
}

void expect_all_met(const Scene& scene, const json& equilibria) {
  for (const json& known : equilibria) {
    SCOPED_TRACE(known.at("angles").dump() + known.at("travels").dump());
    const StaticModel model(test::started_at(scene, numbers(known.at("start"))));
    expect_agrees(model, solve(model, test::by(Method::virtual_work)), known, virtual_work_tolerance);
    if (known.at("stable").get<bool>() && !model.mechanism().has_follower_loads()) {
      SCOPED_TRACE("by energy");
      expect_agrees(model, solve(model, test::by(Method::energy)), known, energy_tolerance);
    }
  }
}

TEST_P(Datasets, HasEveryEquilibriumThatIsKnown) { expect_all_met(scene(), known().at("equilibria")); }

TEST_P(Datasets, HasEveryEquilibriumThatIsKnownOfItsVariants) {
  for (const json& variant : known().value("variants", json::array())) {
    SCOPED_TRACE(variant.at("set").dump());
    Scene changed = scene();
    for (const auto& [path, value] : variant.at("set").items()) set_value(changed, path, number(value));
    expect_all_met(changed, variant.at("equilibria"));
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Datasets, testing::ValuesIn(scene_names()),
                         [](const auto& scene) { return scene.param.substr(0, scene.param.find('.')); });

}  // namespace
}  // namespace poise::datasets_test

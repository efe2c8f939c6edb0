// Equilibria followed through random drags and changes: a small part of what poise_drags runs.

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "tests/judge/drag_campaign.hpp"
#include "tests/judge/small_steps.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/seed.hpp"

namespace poise::judge::random_drags_test {
namespace {

void expect_true(const std::string& name, const JudgedDrags& run) {
  for (const JudgedDrags::Contradiction& c : run.contradictions) {
    ADD_FAILURE() << name << ": " << to_string(c.fault) << ": " << c.words;
  }
  EXPECT_GT(run.confirmed, 0) << name;
}

// Times of a test machine say nothing.
constexpr DragTrial trial{.steps = 25, .slow = 100.0};

// The fold of the toggle is at 42.914325731224687 N.
TEST(SmallSteps, ArriveBeforeAFoldAndAreLostAtIt) {
  const Scene toggle = read_scene(test::dataset("von_mises_toggle.toml"));
  const TrackedEquilibrium rests(toggle);
  const double begin = -toggle.forces[0].vector.y;
  const auto up_to = [&](double load, bool with_care) {
    Scene loaded = toggle;
    loaded.forces[0].vector.y = -load;
    return follow_numbers(VariedScene(toggle, loaded), rests.poses(), with_care);
  };
  for (const bool with_care : {false, true}) {
    EXPECT_EQ(up_to(42.0, with_care).end, SmallSteps::End::arrived);
    const SmallSteps beyond = up_to(43.0, with_care);
    EXPECT_EQ(beyond.end, SmallSteps::End::lost) << beyond.why;
    EXPECT_NEAR(begin + beyond.part * (43.0 - begin), 42.914325731224687, 1e-8);
  }
}

TEST(RandomDrags, OfRandomMechanismsAreFollowed) {
  for (std::uint64_t k = 1; k <= 40; ++k) {
    const std::uint64_t seed = test::seed(k);
    std::string kind;
    const Scene scene = scene_to_drag(seed, kind);
    expect_true(kind + " " + std::to_string(seed), judge_drags(scene, seed, trial));
  }
}

TEST(RandomDrags, OfScenesAreFollowed) {
  for (const char* name : {"toggle_clamp.toml", "von_mises_toggle.toml", "zeeman.toml", "hanging_chain_10.toml",
                           "double_pendulum.toml", "six_bar.toml", "car_hood.toml"}) {
    for (std::uint64_t k = 1; k <= 2; ++k) {
      const std::uint64_t seed = test::seed(k);
      expect_true(std::string(name) + " " + std::to_string(seed),
                  judge_drags(read_scene(test::dataset(name)), seed, trial));
    }
  }
}

}  // namespace
}  // namespace poise::judge::random_drags_test

// Equilibria followed through random drags and changes: a small part of what poise_drags runs.

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "tests/judge/drag_campaign.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::judge {
namespace {

void expect_true(const std::string& name, const JudgedDrags& run) {
  for (const JudgedDrags::Contradiction& c : run.contradictions) {
    ADD_FAILURE() << name << ": " << to_string(c.fault) << ": " << c.words;
  }
  EXPECT_GT(run.confirmed, 0) << name;
}

// Times of a test machine say nothing.
constexpr DragTrial trial{.steps = 25, .slow = 100.0};

TEST(RandomDrags, OfRandomMechanismsAreFollowed) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::string kind;
    const Scene scene = scene_to_drag(seed, kind);
    expect_true(kind + " " + std::to_string(seed), judge_drags(scene, seed, trial));
  }
}

TEST(RandomDrags, OfScenesAreFollowed) {
  for (const char* name : {"toggle_clamp.toml", "von_mises_toggle.toml", "zeeman.toml", "hanging_chain_10.toml",
                           "double_pendulum.toml", "six_bar.toml", "car_hood.toml"}) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      expect_true(std::string(name) + " " + std::to_string(seed),
                  judge_drags(read_scene(test::dataset(name)), seed, trial));
    }
  }
}

}  // namespace
}  // namespace poise::judge

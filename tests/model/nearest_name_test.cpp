#include "model/nearest_name.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "model/joint.hpp"
#include "model/laws/drive.hpp"
#include "model/laws/laws.hpp"
#include "model/laws/stop.hpp"

namespace poise::nearest_name_test {
namespace {

TEST(NearestName, CountsEachKindOfEditOnce) {
  EXPECT_EQ(edit_distance("", ""), 0);
  EXPECT_EQ(edit_distance("crank", "crank"), 0);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("abc", ""), 3);
  EXPECT_EQ(edit_distance("crnk", "crank"), 1);
  EXPECT_EQ(edit_distance("craank", "crank"), 1);
  EXPECT_EQ(edit_distance("crunk", "crank"), 1);
  EXPECT_EQ(edit_distance("carnk", "crank"), 1);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("ca", "abc"), 3);
}

TEST(NearestName, IsSymmetric) {
  EXPECT_EQ(edit_distance("stiffness", "sitfnes"), edit_distance("sitfnes", "stiffness"));
}

TEST(NearestName, SuggestsTheFirstOfTheNearest) {
  EXPECT_EQ(did_you_mean("mas", {"inertia", "mass", "mast"}), "; did you mean \"mass\"?");
  EXPECT_EQ(did_you_mean("mas", {}), "");
}

/// The keys of a scene file, and the last parts of its paths, of three letters and more.
std::vector<std::string> known_keys() {
  std::vector<std::string> keys = {"body", "ground",  "points", "mass",   "center", "inertia", "axis",     "angle",
                                   "name", "follows", "value",  "bodies", "acts",   "start",   "position", "units"};
  for (const JointTraits& kind : Joint::kinds) keys.emplace_back(kind.key);
  const auto add = [&keys](const auto& numbers) {
    for (const Number& number : numbers) keys.emplace_back(number.key);
  };
  add(LinearSpring::numbers);
  add(CubicSpring::numbers);
  add(Damper::numbers);
  add(DryFriction::numbers);
  add(Drive::numbers);
  add(Stop::limits);
  std::erase_if(keys, [](const std::string& key) { return key.size() < 3; });
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

/// Every word one edit from `word`: letters left out, doubled, swapped with their neighbour, or hit beside.
std::vector<std::string> typos_of(const std::string& word) {
  std::vector<std::string> typos;
  for (std::size_t i = 0; i < word.size(); ++i) {
    typos.push_back(word.substr(0, i) + word.substr(i + 1));
    typos.push_back(word.substr(0, i) + word[i] + word.substr(i));
    for (const char letter : {'a', 'q', 'x', '_', '.'}) {
      typos.push_back(word.substr(0, i) + letter + word.substr(i + 1));
      typos.push_back(word.substr(0, i) + letter + word.substr(i));
    }
    if (i == 0) continue;
    typos.push_back(word);
    std::swap(typos.back()[i - 1], typos.back()[i]);
  }
  return typos;
}

TEST(NearestName, EverySingleEditOfAKeyIsNearIt) {
  const std::vector<std::string> keys = known_keys();
  ASSERT_GT(keys.size(), 25U);
  for (const std::string& key : keys) {
    for (const std::string& typo : typos_of(key)) {
      EXPECT_TRUE(is_near(typo, key)) << typo << " for " << key;
      if (std::find(keys.begin(), keys.end(), typo) != keys.end()) continue;
      const std::string suggestion = did_you_mean(typo, keys);
      ASSERT_FALSE(suggestion.empty()) << typo << " for " << key;
      // Another key may be as near, never nearer.
      const std::string named = suggestion.substr(16, suggestion.size() - 18);
      EXPECT_LE(edit_distance(typo, named), 1) << typo << " for " << key << suggestion;
    }
  }
}

TEST(NearestName, UnrelatedWordsAreNotSuggested) {
  const std::vector<std::string> keys = known_keys();
  for (const char* word :
       {"gear",     "belt", "rope",     "colour",     "torque_limit", "velocity", "density",  "weight",   "diameter",
        "material", "q",    "zz",       "",           "cam",          "wheel",    "camshaft", "pressure", "temperature",
        "hinge",    "x1",   "rotation", "gravity_on", "thickness",    "clearance"}) {
    EXPECT_EQ(did_you_mean(word, keys), "") << word;
  }
}

TEST(NearestName, WhatBeginsTheSameIsNearFromHalfOfTheLetters) {
  EXPECT_TRUE(is_near("len", "length"));
  EXPECT_TRUE(is_near("inch", "in"));
  EXPECT_TRUE(is_near("stiff", "stiffness"));
  EXPECT_FALSE(is_near("st", "stiffness"));
  EXPECT_FALSE(is_near("a", "at"));
  EXPECT_FALSE(is_near("", ""));
}

TEST(NearestName, ListsWhatThereIsWhenNothingIsNear) {
  EXPECT_EQ(did_you_mean_or_list("crnk", {"rod", "crank"}), "; did you mean \"crank\"?");
  EXPECT_EQ(did_you_mean_or_list("piston", {"rod", "crank"}), "; known here: rod, crank");
  EXPECT_EQ(did_you_mean_or_list("piston", {}), "; there is none here");
  std::vector<std::string> many;
  for (char letter = 'a'; letter <= 'z'; ++letter) many.push_back(std::string(8, letter));
  EXPECT_EQ(did_you_mean_or_list("yyyzz", many),
            "; known here: yyyyyyyy, zzzzzzzz, aaaaaaaa, bbbbbbbb, cccccccc, dddddddd, eeeeeeee, ffffffff, gggggggg, "
            "hhhhhhhh, iiiiiiii, jjjjjjjj and 14 more");
}

TEST(NearestName, OfVeryLongNamesNoneIsNear) {
  const std::string longest(100'000, 'a');
  EXPECT_FALSE(is_near(longest, longest + "b"));
  EXPECT_EQ(did_you_mean(longest, {longest + "b", "a"}), "");
  std::vector<std::string> many;
  for (char letter = 'z'; letter >= 'a'; --letter) many.emplace_back(1, letter);
  EXPECT_EQ(did_you_mean_or_list(longest, many), "; known here: z, y, x, w, v, u, t, s, r, q, p, o and 14 more");
}

}  // namespace
}  // namespace poise::nearest_name_test

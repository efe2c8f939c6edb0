#include "model/nearest_name.hpp"

#include <gtest/gtest.h>

namespace poise {
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

}  // namespace
}  // namespace poise

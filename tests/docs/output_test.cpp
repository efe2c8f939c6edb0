// The comparison that the test of the documentation uses.
#include "tests/docs/output.hpp"

#include <gtest/gtest.h>

namespace poise::docs_tests::output_test {
namespace {

using Lines = std::vector<std::string>;

TEST(DocsOutput, NumbersMayDifferByRounding) {
  EXPECT_EQ(difference("link   93.6088297 deg", "link 93.6088299 deg"), "");
  EXPECT_NE(difference("link   93.6088297 deg", "link 93.6098297 deg"), "");
  EXPECT_NE(difference("link   93.61 deg", "link 93.71 deg"), "");
  EXPECT_EQ(difference("error 1.9e-16", "error <1e-16"), "");
  EXPECT_NE(difference("error 1.9e-16", "error 1.9e-06"), "");
  EXPECT_EQ(difference("k 2000222 N/m", "k 2000223 N/m"), "");
}

TEST(DocsOutput, WordsCountsAndSignsMayNot) {
  EXPECT_NE(difference("stable", "unstable"), "");
  EXPECT_NE(difference("4 iterations", "5 iterations"), "");
  EXPECT_NE(difference("push4 1.0", "push5 1.0"), "");
  EXPECT_NE(difference("A 12.5", "A -12.5"), "");
  EXPECT_NE(difference("12.5 N", "12.5 kN"), "");
}

TEST(DocsOutput, DurationsAreNotCompared) {
  EXPECT_EQ(difference("4 evaluations, 4.31 µs", "4 evaluations, 1.02 ms"), "");
  EXPECT_EQ(difference("  effort  129 s; 14.7 evaluations", "  effort  99 s; 14.7 evaluations"), "");
  EXPECT_EQ(difference("(50 random starts, 6.78 s)", "(50 random starts, 2 s)"), "");
  EXPECT_NE(difference("Moved for 2 s", "Moved for 3 s"), "");
  EXPECT_NE(difference("c 3988.2 N s/m", "c 3888.2 N s/m"), "");
}

TEST(DocsOutput, CutsStandForAnyLines) {
  const Lines printed = {"a 1", "b 2", "c 3", "d 4"};
  EXPECT_EQ(difference(Lines{"a 1", "...", "d 4"}, printed), "");
  EXPECT_EQ(difference(Lines{"...", "b 2", "..."}, printed), "");
  EXPECT_EQ(difference(Lines{"a 1", "b 2", "..."}, printed), "");
  EXPECT_NE(difference(Lines{"a 1", "b 2"}, printed), "");
  EXPECT_NE(difference(Lines{"...", "x", "..."}, printed), "");
  EXPECT_NE(difference(Lines{"a 1", "...", "c 3"}, printed), "");
  EXPECT_NE(difference(Lines{"a 1", "b 2", "c 3", "d 4", "e 5"}, printed), "");
  EXPECT_NE(difference(Lines{"a 1"}, Lines{}), "");
}

TEST(DocsOutput, UpdatesKeepTheCuts) {
  const Lines printed = {"Verdict: stable", "  method  newton", "", "Angles (deg)", "  link  2.5", "", "Notes",
                         "  none"};
  EXPECT_EQ(cut_like(Lines{"At rest: stable", "...", "Angles (deg)", "  link  1.5", "..."}, printed),
            (Lines{"Verdict: stable", "...", "Angles (deg)", "  link  2.5", "..."}));
  EXPECT_EQ(cut_like(Lines{"Old"}, printed), printed);
}

}  // namespace
}  // namespace poise::docs_tests::output_test

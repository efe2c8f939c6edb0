#include "model/one_line.hpp"

#include <string>

#include <gtest/gtest.h>

#include "model/input_error.hpp"

namespace poise::one_line_test {
namespace {

TEST(OneLine, ControlCharactersDoNotReachTheTerminal) {
  EXPECT_EQ(one_line("a\nb\x1b[31mc"), "a b [31mc");
  EXPECT_EQ(one_line("a\x7f\xC2\x9B"
                     "31m"),
            "a  31m")
      << "U+009B begins an escape sequence too";
}

TEST(OneLine, KeepsLettersOfUtf8AndNoOtherBytes) {
  EXPECT_EQ(one_line("\u00B5m \u2264 \U0001F600"), "\u00B5m \u2264 \U0001F600");
  EXPECT_EQ(one_line("\xFF"
                     "a\xC3"),
            "?a?");
  EXPECT_EQ(one_line("\xE2\x82"
                     "a"),
            "??a")
      << "a letter cut short";
  EXPECT_EQ(one_line("\xC0\x80\xE0\x80\x80"), "?????") << "written with more bytes than needed";
  EXPECT_EQ(one_line("\xED\xA0\x80\xF4\x90\x80\x80"), "???????") << "a surrogate, and beyond the last letter";
}

TEST(InputError, IsOneLineAndKeepsItsEnds) {
  EXPECT_STREQ(InputError("s.toml:3: a\nb: expected c").what(), "s.toml:3: a b: expected c");
  std::string name;
  for (int i = 0; i < 1000; ++i) name += "\u2264";
  const std::string line = InputError("s.toml:3: " + name + ": expected c; d").what();
  EXPECT_LE(line.size(), 1000U);
  EXPECT_EQ(line, one_line(line)) << "no letter is cut";
  EXPECT_TRUE(line.starts_with("s.toml:3: \u2264")) << line;
  EXPECT_TRUE(line.ends_with("\u2264: expected c; d")) << line;
}

}  // namespace
}  // namespace poise::one_line_test

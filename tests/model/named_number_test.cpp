#include "model/named_number.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "model/input_error.hpp"

namespace poise::named_number_test {
namespace {

TEST(NamedNumber, ANumberIsTheWholeText) {
  EXPECT_EQ(read_number("40"), 40.0);
  EXPECT_EQ(read_number("+4.5e-3"), 4.5e-3);
  EXPECT_EQ(read_number("-0.5"), -0.5);
  EXPECT_TRUE(std::isinf(read_number("inf").value()));
  for (const char* text : {"", "+", "4x", " 4", "4 ", "+-4", "++4", "0x10", "1,5", "1e999"}) {
    EXPECT_FALSE(read_number(text).has_value()) << text;
  }
}

TEST(NamedNumber, NamesMayHoldAnEqualsSign) {
  const NamedNumber given = read_named_number("--release", "a=b=-2.5", "NAME=NUMBER");
  EXPECT_EQ(given.name, "a=b");
  EXPECT_EQ(given.value, -2.5);
  EXPECT_EQ(read_named_text("--drive", "crank=0..360", "NAME=FROM..TO").text, "0..360");
}

TEST(NamedNumber, SaysWhatIsExpected) {
  const auto refusal = [](const std::string& given) {
    try {
      read_named_number("--release", given, "NAME=NUMBER, say boom=0.5");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal("boom"), "--release boom: there is no \"=\"; expected NAME=NUMBER, say boom=0.5");
  EXPECT_EQ(refusal("boom=fast"), "--release boom=fast: \"fast\" is not a number; expected NAME=NUMBER, say boom=0.5");
  EXPECT_EQ(refusal("boom="), "--release boom=: \"\" is not a number; expected NAME=NUMBER, say boom=0.5");
}

}  // namespace
}  // namespace poise::named_number_test

#include "app/result/numbers.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace poise::app::numbers_test {
namespace {

TEST(Numbers, SignificantDigitsWithoutZerosAtTheEnd) {
  EXPECT_EQ(significant(0.0, 4), "0");
  EXPECT_EQ(significant(-0.0, 4), "0");
  EXPECT_EQ(significant(1234.56, 4), "1235");
  EXPECT_EQ(significant(12.3000, 4), "12.3");
  EXPECT_EQ(significant(-0.012345, 3), "-0.0123");
  EXPECT_EQ(significant(123456.0, 3), "123456") << "whole numbers are not rounded away";
  EXPECT_EQ(significant(1.5e-7, 3), "1.50e-07");
  EXPECT_EQ(significant(1e9, 3), "1.00e+09");
  EXPECT_EQ(significant(std::nan(""), 3), "-");
  EXPECT_EQ(significant(-std::numeric_limits<double>::infinity(), 3), "-inf");
}

TEST(Numbers, SmallNumbersWithoutNoise) {
  EXPECT_EQ(small_number(0.0), "0");
  EXPECT_EQ(small_number(1.2345678901e-17), "<1e-16");
  EXPECT_EQ(small_number(2.22e-16), "2.2e-16");
  EXPECT_EQ(small_number(std::nan("")), "-");
}

TEST(Numbers, ColumnsShareTheirDecimals) {
  const std::vector<std::string> column = aligned({123.456, -1.0, 1e-9, 0.0, std::nan("")}, 5);
  EXPECT_EQ(column, (std::vector<std::string>{"123.46", "-1.00", "0   ", "0   ", "-   "}));
  EXPECT_EQ(aligned({0.0, 0.0}, 6), (std::vector<std::string>{"0", "0"}));
  EXPECT_EQ(aligned({1.5e-9}, 3), (std::vector<std::string>{"1.50e-09"}));
  EXPECT_EQ(aligned({12345.0, 1.0}, 4, 3.0), (std::vector<std::string>{"12345.000", "1.000"})) << "decimals by scale";
}

TEST(Numbers, HugeAndTinyOnesHaveAPrefixBeforeTheirUnit) {
  const auto written = [](double value, const std::string& unit) {
    const ReadableUnit readable = readable_unit(std::abs(value), unit);
    return significant(value * readable.factor, 4) + " " + readable.unit;
  };
  EXPECT_EQ(written(22.08e6, "N"), "22.08 MN");
  EXPECT_EQ(written(-4.4e10, "N mm"), "-44 MN m");
  EXPECT_EQ(written(3.2e-5, "m"), "32 µm");
  EXPECT_EQ(written(1e8, "kN"), "100 GN");
  EXPECT_EQ(written(2.5e9, "N/mm"), "2.5 TN/m");
  EXPECT_EQ(written(12345.0, "N"), "12345 N") << "what is read easily stays";
  EXPECT_EQ(written(0.0, "N"), "0 N");
  EXPECT_EQ(written(2e-7, "rad"), "2.000e-07 rad") << "a unit that takes no prefix";
  EXPECT_EQ(written(2e9, "lbf"), "2.000e+09 lbf");
  for (double order = -11.9; order < 14; order += 0.1) {
    const double size = std::pow(10.0, order);
    const ReadableUnit readable = readable_unit(size, "N");
    const bool plain = size >= 1e-4 && size < 1e7;
    EXPECT_TRUE(plain ? readable.factor == 1.0 : size * readable.factor >= 0.999 && size * readable.factor < 1000.001)
        << size;
  }
}

TEST(Numbers, DurationsInTheUnitThatSuits) {
  EXPECT_EQ(duration(0.84), "0.84 µs");
  EXPECT_EQ(duration(12345.0), "12.3 ms");
  EXPECT_EQ(duration(4.56e6), "4.56 s");
}

TEST(Numbers, KnownDigitsEndWhereTheRadiusBegins) {
  EXPECT_EQ(known_digits(6, 123.4, 0.0), 6);
  EXPECT_EQ(known_digits(6, 123.4, 1e-9), 6);
  // 123.4 +- 0.04 is right to 0.1, but no longer where the radius and rounding to 0.1 make more than 0.1 together.
  EXPECT_EQ(known_digits(6, 123.4, 0.04), 4);
  EXPECT_EQ(known_digits(6, 123.4, 0.06), 3);
  EXPECT_EQ(known_digits(6, 123.4, 4.0), 2);
  EXPECT_EQ(known_digits(6, 123.4, 100.0), 1);
  EXPECT_EQ(known_digits(6, 123.4, 1e6), 0);
  EXPECT_EQ(known_digits(6, 0.0, 1e-3), 6);
  EXPECT_EQ(known_digits(6, 123.4, std::numeric_limits<double>::infinity()), 6) << "nothing is proved";
}

TEST(Numbers, AreWrittenAsFarAsTheyAreKnown) {
  EXPECT_EQ(significant(123.456, 6, 0.04), "123.5");
  EXPECT_EQ(significant(12344.0, 6, 400.0), "12000") << "digits before the point too";
  EXPECT_EQ(significant(-15.0, 6, 4.0), "-20");
  EXPECT_EQ(significant(14e-9, 6, 1.1e-6), "0");
  EXPECT_EQ(significant(2.345e8, 6, 4e6), "2.3e+08");
  EXPECT_EQ(aligned({12344.0, -700.0, 0.3}, 6, 12344.0, 400.0), (std::vector<std::string>{"12000", "-1000", "0"}));
  EXPECT_EQ(aligned({14e-9, -3e-9}, 6, 14e-9, 1.1e-6), (std::vector<std::string>{"0", "0"}));
  EXPECT_EQ(aligned({9.0, 0.25}, 6, 9.0, 5e-4), (std::vector<std::string>{"9.000", "0.250"}));
}

}  // namespace
}  // namespace poise::app::numbers_test

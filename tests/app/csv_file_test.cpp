#include "app/csv_file.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace poise::app {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(CsvFile, HasAHeaderAndOneLineForEachRow) {
  EXPECT_EQ(csv_text({"time (s)", "boom (rad)"}, {{0, 0.001, 1e-7}, {-0.5, 1.0 / 3, 1e22}}),
            "time (s),boom (rad)\n"
            "0,-0.5\n"
            "0.001,0.3333333333333333\n"
            "1e-07,1e+22\n");
}

TEST(CsvFile, QuotesNamesThatWouldNotReadBack) {
  EXPECT_EQ(csv_text({"a,b", "say \"a\"", "two\nlines", "", " blank", "µ<b>"}, {{}, {}, {}, {}, {}, {}}),
            "\"a,b\",\"say \"\"a\"\"\",\"two\nlines\",\"\",\" blank\",µ<b>\n");
}

TEST(CsvFile, LeavesTheCellOfWhatIsNoNumberEmpty) {
  EXPECT_EQ(csv_text({"a", "b", "c"}, {{1, NAN}, {-infinity, 2}, {3, infinity}}), "a,b,c\n1,,3\n,2,\n");
}

TEST(CsvFile, PutsWordsFirst) {
  const std::vector<std::string> runs = {"low", "low, empty"};
  const std::vector<std::string> ends = {"well", "badly"};
  EXPECT_EQ(csv_text({"run", "time"}, {{0, 1}}, {runs}), "run,time\nlow,0\n\"low, empty\",1\n");
  EXPECT_EQ(csv_text({"run", "end", "time"}, {{0, 1}}, {runs, ends}),
            "run,end,time\nlow,well,0\n\"low, empty\",badly,1\n");
}

TEST(CsvFile, WithoutColumnsIsEmpty) { EXPECT_EQ(csv_text({}, {}), ""); }

TEST(CsvFile, EveryNumberReadsBackAsTheSameDouble) {
  std::mt19937_64 random(7);
  std::vector<double> written = {5e-324, -2.2250738585072014e-308, 1.7976931348623157e308, 0.1, -0.0};
  while (written.size() < 50000) {
    const auto value = std::bit_cast<double>(random());
    if (std::isfinite(value)) written.push_back(value);
  }
  std::istringstream lines(csv_text({"x"}, {written}));
  std::string line;
  std::getline(lines, line);
  for (double expected : written) {
    ASSERT_TRUE(std::getline(lines, line));
    double read = 0.0;
    std::from_chars(line.data(), line.data() + line.size(), read);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(read), std::bit_cast<std::uint64_t>(expected)) << line;
  }
  EXPECT_FALSE(std::getline(lines, line));
}

}  // namespace
}  // namespace poise::app

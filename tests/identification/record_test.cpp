#include "identification/experiment/record.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::record_test {
namespace {

using app_tests::TempFolder;
using Numbers = std::vector<double>;

/// Message of read_csv about a file of this text, without the folder; empty where it reads it.
std::string error_of(const std::string& text, const std::vector<std::string>& columns,
                     const std::vector<std::string>& words = {}) {
  const TempFolder folder;
  const std::string file = folder.write("data.csv", text);
  try {
    read_csv(file, columns, words);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message.substr(message.find("data.csv"));
  }
  return "";
}

CsvTable table_of(const std::string& text, const std::vector<std::string>& columns,
                  const std::vector<std::string>& words = {}) {
  const TempFolder folder;
  return read_csv(folder.write("data.csv", text), columns, words);
}

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    const std::string message = error.what();
    return message.substr(message.find("data.csv"));
  }
  return "";
}

TEST(ReadCsv, ReadsTheColumnsAskedForInTheirOrder) {
  const CsvTable table = table_of("t,note,x\n0,\"any, word\",1.5\n0.25,,-2e-3\n", {"x", "t", "x"});
  EXPECT_EQ(table.columns, (std::vector<std::string>{"x", "t"}));
  EXPECT_EQ(table.column("x"), (Numbers{1.5, -2e-3}));
  EXPECT_EQ(table.column("t"), (Numbers{0, 0.25}));
  EXPECT_EQ(table.line, (std::vector<int>{2, 3}));
  EXPECT_THROW(table.column("note"), std::out_of_range);
}

TEST(ReadCsv, TakesAnySeparatorAndLineEnd) {
  for (const std::string separator : {",", ";", "\t"}) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
      for (const bool ends : {true, false}) {
        const std::string text =
            "t" + separator + "\"a b\"" + end + "0" + separator + "1" + end + "1" + separator + "2";
        const CsvTable table = table_of(ends ? text + end : text, {"t", "a b"});
        EXPECT_EQ(table.column("t"), (Numbers{0, 1}));
        EXPECT_EQ(table.column("a b"), (Numbers{1, 2}));
        EXPECT_EQ(table.line, (std::vector<int>{2, 3}));
      }
    }
  }
}

TEST(ReadCsv, OverlooksByteOrderMarkBlanksAndEmptyLinesAtTheEnd) {
  const CsvTable table = table_of("\xEF\xBB\xBF t , x \n 1 ,\t+2 \r\n  \n\n", {"t", "x"});
  EXPECT_EQ(table.column("t"), Numbers{1});
  EXPECT_EQ(table.column("x"), Numbers{2});
}

TEST(ReadCsv, ReadsQuotedCells) {
  const CsvTable table =
      table_of("\"t\",\"say \"\"x\"\", please\",w\n\"1\", \"2\" ,\"two\nlines, \"\"quoted\"\"\"\n3,4,plain\n",
               {"t", "say \"x\", please"}, {"w"});
  EXPECT_EQ(table.column("t"), (Numbers{1, 3}));
  EXPECT_EQ(table.values[1], (Numbers{2, 4}));
  ASSERT_EQ(table.words.size(), 1u);
  EXPECT_EQ(table.words[0].value, (std::vector<std::string>{"two\nlines, \"quoted\"", "plain"}));
  EXPECT_EQ(table.line, (std::vector<int>{2, 4}));
}

TEST(ReadCsv, ReadsNumbersToTheLastBit) {
  const CsvTable table = table_of("x\n0.1\n1e-300\n-123456789.123456789\n4.9e-324\n", {"x"});
  EXPECT_EQ(table.column("x"), (Numbers{0.1, 1e-300, -123456789.123456789, 4.9e-324}));
}

TEST(ReadCsv, NamesTheLineOfAnError) {
  const std::vector<std::string> tx = {"t", "x"};
  EXPECT_EQ(error_of("", tx), "data.csv:1: header: expected the names of the columns, found an empty file");
  EXPECT_EQ(error_of("\n \n", tx), "data.csv:1: header: expected the names of the columns, found an empty file");
  EXPECT_EQ(error_of("time,xx\n", {"x"}),
            "data.csv:1: x: expected a column of this name in the header; known here: time, xx");
  EXPECT_EQ(error_of("t,x,x\n", tx),
            "data.csv:1: x: expected one column of this name, found several; rename the others");
  EXPECT_EQ(error_of("t,x\n0,1\n1,\n", tx),
            "data.csv:3: x: expected a value, found a gap; fill it or leave the row out");
  EXPECT_EQ(error_of("t,x\n0,1\n1\n", tx),
            "data.csv:3: row: expected 2 cells as in the header, found 1; fill the gaps or leave the row out");
  EXPECT_EQ(error_of("t,x\n0,1\n\n1,2\n", tx),
            "data.csv:3: row: expected 2 cells as in the header, found 1; fill the gaps or leave the row out");
  EXPECT_EQ(error_of("t,x\n0,1,5\n", tx),
            "data.csv:2: row: expected 2 cells as in the header, found 3; write decimal points, and quotes round cells "
            "with separators");
  EXPECT_EQ(error_of("t,x\n0,1\n1,abc\n", tx),
            "data.csv:3: x: expected a number, found \"abc\"; correct it or leave the row out");
  EXPECT_EQ(error_of("t,x\n0,\xFF\x1b[31m\n", tx),
            "data.csv:2: x: expected a number, found \"? [31m\"; correct it or leave the row out");
  EXPECT_EQ(error_of("t,x\n0,-1e51\n", tx),
            "data.csv:2: x: expected a number of at most 1e50, found \"-1e51\"; correct it or leave the row out");
  EXPECT_EQ(error_of("t,\xB0\n0,1\n", tx),
            "data.csv:1: x: expected a column of this name in the header; known here: t, ?");
  EXPECT_EQ(error_of("t;x\n0;1,5\n", tx), "data.csv:2: x: expected a number, found \"1,5\"; write a decimal point");
  EXPECT_EQ(error_of("t,x\n0,1.5m\n", tx),
            "data.csv:2: x: expected a number, found \"1.5m\"; correct it or leave the row out");
  for (const std::string word : {"nan", "NaN", "-inf", "Infinity", "1e999"}) {
    EXPECT_EQ(error_of("t,x\n0," + word + "\n", tx),
              "data.csv:2: x: expected a finite number, found \"" + word + "\"; correct it or leave the row out");
  }
  EXPECT_EQ(error_of("t,x\n0,+-1\n", tx),
            "data.csv:2: x: expected a number, found \"+-1\"; correct it or leave the row out");
  EXPECT_EQ(error_of("t,x\n0,1\n1,\"2\n3,4\n", tx), "data.csv:3: cell 2: expected a closing quote");
  EXPECT_EQ(error_of("t,x\n0,\"1\"2\n", tx),
            "data.csv:2: cell 2: expected a separator after the closing quote; double the quotes inside a cell");
  EXPECT_EQ(error_of("t,w\n0,\n", {"t"}, {"w"}),
            "data.csv:2: w: expected a value, found a gap; fill it or leave the row out");
  EXPECT_EQ(
      error_of("t,x\n0," + std::string(100, 'a') + "\n", tx),
      "data.csv:2: x: expected a number, found \"" + std::string(40, 'a') + "...\"; correct it or leave the row out");
}

TEST(ReadCsv, ReadsGapsWhereTheyAreAllowed) {
  const TempFolder folder;
  const std::string file = folder.write("data.csv", "t,x,y\n0,,1\n1, nan ,2\n2,5,\n");
  const CsvTable table = read_csv(file, {"t", "x"}, {}, {"x"});
  EXPECT_TRUE(std::isnan(table.column("x")[0]));
  EXPECT_TRUE(std::isnan(table.column("x")[1]));
  EXPECT_EQ(table.column("x")[2], 5.0);
  EXPECT_EQ(message_of([&] {
              read_csv(file, {"x", "y"}, {}, {"x"});
            }),
            "data.csv:4: y: expected a value, found a gap; fill it or leave the row out");
}

TEST(ReadCsv, CountsLinesBehindQuotedOnes) {
  EXPECT_EQ(error_of("t,w\n0,\"a\nb\"\n?,c\n", {"t"}, {"w"}),
            "data.csv:4: t: expected a number, found \"?\"; correct it or leave the row out");
}

TEST(ReadCsv, NeedsAFile) {
  const TempFolder folder;
  EXPECT_EQ(message_of([&] { read_csv(folder.path("data.csv"), {"t"}); }),
            "data.csv: cannot be read: No such file or directory; check the path");
  std::filesystem::create_directory(folder.path("data.csv"));
  EXPECT_EQ(message_of([&] { read_csv(folder.path("data.csv"), {"t"}); }),
            "data.csv: expected a file, found a folder; check the path");
}

TEST(CsvParts, FollowTheSplitColumn) {
  const std::vector<CsvPart> parts = parts_of(table_of("s,t\nb,0\nb,1\n10,0\n1,5\n", {"t"}, {"s"}), "s");
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(parts[0].value, "b");
  EXPECT_EQ(parts[0].first, 0u);
  EXPECT_EQ(parts[0].last, 2u);
  EXPECT_EQ(parts[1].value, "10");
  EXPECT_EQ(parts[2].value, "1");
  EXPECT_EQ(parts[2].first, 3u);
  EXPECT_EQ(parts[2].last, 4u);
  EXPECT_TRUE(parts_of(table_of("s,t\n", {"t"}, {"s"}), "s").empty());
}

TEST(CsvParts, StandTogether) {
  const CsvTable table = table_of("s,t\na,0\na,1\nb,0\na,2\n", {"t"}, {"s"});
  EXPECT_EQ(message_of([&] { parts_of(table, "s"); }),
            "data.csv:5: s: expected the rows of \"a\" to stand together, found more after line 3; sort the rows");
  EXPECT_THROW(parts_of(table, "t"), std::out_of_range);
}

TEST(CsvTimes, Ascend) {
  const CsvTable table = table_of("t\n0\n1\n2\n2\n3\n1\n5\n6\n", {"t"});
  const std::string expected =
      "expected a time after that of the row before; sort the rows, or split the file by the column that names its "
      "segments";
  EXPECT_EQ(message_of([&] { check_times(table, "t", 0, 8); }), "data.csv:5: t: " + expected);
  EXPECT_EQ(message_of([&] { check_times(table, "t", 3, 8); }), "data.csv:7: t: " + expected);
  EXPECT_EQ(message_of([&] { check_times(table, "t", 0, 3); }), "");
  EXPECT_EQ(message_of([&] { check_times(table, "t", 5, 8); }), "");
}

TEST(CsvTimes, AreThreeAtLeast) {
  const CsvTable table = table_of("t\n0\n1\n2\n3\n4\n", {"t"});
  EXPECT_EQ(message_of([&] { check_times(table, "t", 1, 3); }),
            "data.csv:3: t: expected at least 3 rows, found 2; give a longer record");
  EXPECT_EQ(message_of([&] { check_times(table, "t", 0, 0); }),
            "data.csv:1: t: expected at least 3 rows, found 0; give a longer record");
  EXPECT_EQ(message_of([&] { check_times(table, "t", 0, 5, 2); }), "");
  EXPECT_EQ(message_of([&] { check_times(table, "t", 0, 5, 3); }),
            "data.csv:2: t: expected at least 3 rows, found 2 after thinning; take more of them");
}

// A swing that dies out and is read in steps of 0.01 keeps one reading of those within a step of the last.
TEST(Record, ReadingsAtRestCountOnce) {
  Series series;
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.01 * i, noise = i % 3 == 0 ? 0.004 : 0.0;
    series.time.push_back(t);
    series.value.push_back(0.01 * std::round(100 * (0.3 + std::exp(-t) * std::cos(5 * t) + noise)));
  }
  const Series once = at_rest_once(series);
  ASSERT_GT(once.value.size(), 350U);
  ASSERT_LT(once.value.size(), 700U);
  EXPECT_EQ(once.time.back(), series.time.back());
  EXPECT_EQ(once.value.back(), series.value.back());
  const std::size_t last = once.value.size() - 2;
  for (std::size_t i = 0; i <= last; ++i) EXPECT_EQ(once.value[i], series.value[i]);
  double least = 1.0, greatest = 0.0;
  for (std::size_t i = last + 1; i < series.value.size(); ++i) {
    least = std::min(least, series.value[i]);
    greatest = std::max(greatest, series.value[i]);
  }
  EXPECT_LT(greatest - least, 0.0101);
  EXPECT_GT(std::max(greatest, series.value[last]) - std::min(least, series.value[last]), 0.0101);
  EXPECT_EQ(at_rest_once(once).value.size(), once.value.size());
  // What is not read in steps, and what does not move, stays.
  Series smooth = series, constant = series;
  for (std::size_t i = 0; i < smooth.value.size(); ++i) {
    smooth.value[i] = std::exp(-smooth.time[i]) * std::cos(5 * smooth.time[i]);
    constant.value[i] = i % 2 == 0 ? 0.3 : 0.31;
  }
  EXPECT_EQ(at_rest_once(smooth).value, smooth.value);
  EXPECT_EQ(at_rest_once(constant).value, constant.value);
}

TEST(ReadCsv, ReadsTheMeasuredDoublePendulum) {
  const std::filesystem::path file =
      std::filesystem::path(POISE_SOURCE_DIR) / "../shared/data/multi_arm_pendulum/double.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const CsvTable table = read_csv(file, {"time", "phi1", "phi2", "dphi1", "dphi2"}, {"segment"});
  const std::vector<CsvPart> parts = parts_of(table, "segment");
  ASSERT_EQ(parts.size(), 26u);
  const Numbers& phi1 = table.column("phi1");
  const Numbers& rate = table.column("dphi1");
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto [value, first, last] = parts[i];
    EXPECT_EQ(value, std::to_string(i));
    EXPECT_EQ(last - first, 2667u);
    check_times(table, "time", first, last);
    EXPECT_EQ(table.column("time")[first], 0.0);
    EXPECT_EQ(table.column("time")[last - 1], 2.666);
    EXPECT_EQ(table.line[first], static_cast<int>(first) + 2);
    // The rates belong to the angles: their integral is the angle's change.
    double change = 0.0;
    for (std::size_t row = first; row + 1 < last; ++row) change += 0.0005 * (rate[row] + rate[row + 1]);
    EXPECT_NEAR(change, phi1[last - 1] - phi1[first], 0.02) << "segment " << value;
  }
}

}  // namespace
}  // namespace poise::record_test

// One result as text, JSON, CSV and Markdown.

#include <algorithm>
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
#include <nlohmann/json.hpp>

#include "app/present/csv.hpp"
#include "app/present/json.hpp"
#include "app/present/markdown.hpp"
#include "app/present/text.hpp"
#include "app/result/cells.hpp"

namespace poise::app::presenters_test {
namespace {

using nlohmann::json;
constexpr double infinity = std::numeric_limits<double>::infinity();

Result lever() {
  Result out{.title = "Lever\nof the tests", .source = "ours"};
  out.verdict = {.text = "In equilibrium.", .tone = Tone::good};
  out.warnings = {{.text = "Take care.", .tone = Tone::bad}};
  Group& content = out.content;
  content.data("count", 3);
  content.fact("method", "by hand");
  content.entry("energy", "energy", -2.5e7, "N m", {.style = Format::Style::significant, .digits = 4}, "(in full)");
  content.entry("time", "time", 1500.0, "", {.style = Format::Style::duration}, "", Verbosity::verbose);
  Table& joints = content.table("joints", "Joints", Rows::list);
  joints.words("name", "joint", {"A", "B | C"});
  joints.numbers("force[]", "Fx", "N", {3.25, -1.0});
  joints.numbers("force[]", "Fy", "N", {NAN, 2e-14}, {.zero_below = 1e-12});
  joints.counts("turns", "turns", {2, NAN});
  joints.flags("held", {1, 0});
  joints.remarks({"", "free"}, Tone::faint);
  joints.footnotes = {"Fx: to the right"};
  Table& angles = content.table("angles", "", Rows::values, Verbosity::data);
  angles.words("name", "", {"arm"});
  angles.data("value", {0.5});
  content.list("left_out", "Left out", {"a damper"});
  content.list("nothing", "Never seen", {});
  Group& part = content.group("residuals", "", Verbosity::data);
  part.data("closure", infinity);
  Branch& runs = content.array("runs");
  runs.parts.emplace_back().data("name", "first");
  runs.parts.emplace_back().data("name", "second");
  content.group("", "Numerics").fact("residuals", "small");
  return out;
}

TEST(Presenters, TextHasTheVerdictFirstThenTheContentInOrder) {
  EXPECT_EQ(plain_text(lever(), {}),
            "Lever of the tests\n"
            "source: ours\n"
            "\n"
            "In equilibrium.\n"
            "Take care.\n"
            "  method       by hand\n"
            "  energy       -25 MN m (in full)\n"
            "\n"
            "Joints\n"
            "  joint    Fx (N)  Fy (N)  turns\n"
            "  A       3.25000       -      2\n"
            "  B | C  -1.00000       0      -  free\n"
            "  Fx: to the right\n"
            "\n"
            "Left out\n"
            "  a damper\n"
            "\n"
            "Numerics\n"
            "  residuals    small\n");
}

// Commands keep a column to show it or not once others stand beside it.
TEST(Presenters, AColumnKeepsItsPlaceWhileOthersAreAdded) {
  Result out;
  Table& table = out.content.table("rows", "Rows", Rows::list);
  const Column& first = table.words("first", "first", {"a"});
  for (int k = 0; k < 1000; ++k) table.data("column", {1.0});
  EXPECT_EQ(&first, &table.columns.front());
  EXPECT_EQ(first.key, "first");
}

TEST(Presenters, QuietTextIsVerdictAndWarningsVerboseTextIsAll) {
  EXPECT_EQ(plain_text(lever(), {}, Verbosity::quiet), "In equilibrium.\nTake care.\n");
  EXPECT_NE(plain_text(lever(), {}, Verbosity::verbose).find("  time         1.5 ms\n"), std::string::npos);
}

TEST(Presenters, JsonHasEveryValueUnderItsKey) {
  const json r = json::parse(json_text(lever()));
  EXPECT_EQ(r["verdict"], "In equilibrium.");
  EXPECT_EQ(r["warnings"], json({"Take care."}));
  EXPECT_EQ(r["count"], 3);
  EXPECT_EQ(r["energy"], -2.5e7);
  EXPECT_EQ(r["time"], 1500.0);
  ASSERT_EQ(r["joints"].size(), 2U);
  EXPECT_EQ(r["joints"][0], json({{"name", "A"}, {"force", {3.25, nullptr}}, {"turns", 2}, {"held", true}}));
  EXPECT_EQ(r["joints"][1]["force"][1], 2e-14) << "rounding is hidden from readers only";
  EXPECT_TRUE(r["joints"][1]["turns"].is_null());
  EXPECT_EQ(r["angles"], json({{"arm", 0.5}}));
  EXPECT_EQ(r["left_out"], json({"a damper"}));
  EXPECT_EQ(r["nothing"], json::array());
  EXPECT_TRUE(r["residuals"]["closure"].is_null());
  EXPECT_EQ(r["runs"], json({{{"name", "first"}}, {{"name", "second"}}}));
  EXPECT_FALSE(r.contains("Numerics"));
}

TEST(Presenters, JsonTablesTakeEveryShape) {
  Result result;
  const auto add = [&](const std::string& key, Rows rows) {
    Table& table = result.content.table(key, "", rows);
    table.words("name", "", {"a", "b"});
    table.data("x", {1, 2});
    Column& word = table.words("note", "", {"", "n"});
    word.kind = Column::Kind::word_or_null;
  };
  add("list", Rows::list);
  add("by_name", Rows::by_name);
  add("columns", Rows::columns);
  Table& pairs = result.content.table("pairs", "", Rows::values);
  pairs.words("name", "", {"P"});
  pairs.data("[]", {1});
  pairs.data("[]", {2});
  const json r = json::parse(json_text(result));
  EXPECT_EQ(r["list"][0], json({{"name", "a"}, {"x", 1.0}, {"note", nullptr}}));
  EXPECT_EQ(r["by_name"]["b"], json({{"x", 2.0}, {"note", "n"}}));
  EXPECT_EQ(r["columns"]["x"], json({1.0, 2.0}));
  EXPECT_EQ(r["columns"]["name"], json({"a", "b"}));
  EXPECT_EQ(r["pairs"]["P"], json({1.0, 2.0}));
}

TEST(Presenters, JsonNumbersKeepEveryDigitAndTextItsLetters) {
  Result result;
  result.content.data("a", 0.1);
  result.content.data("b", std::nextafter(1.0, 2.0));
  result.content.data("c", std::numeric_limits<std::uint64_t>::max());
  result.content.data("d", std::numeric_limits<std::int64_t>::min());
  result.content.data("e", "a\"\n\xff");
  result.content.data("f", std::vector<double>{NAN, 1.0});
  result.compact = true;
  const std::string text = json_text(result);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << "one line";
  for (const char* part : {R"("a":0.1,)", R"("b":1.0000000000000002,)", R"("c":18446744073709551615,)",
                           R"("d":-9223372036854775808,)", "\"e\":\"a\\\"\\n\xEF\xBF\xBD\"", R"("f":[null,1.0])"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

TEST(Presenters, MarkdownHasTablesInFull) {
  Result result = lever();
  const std::string page = markdown_text(result);
  for (const char* part :
       {"# Lever of the tests\n", "\nIn equilibrium.\n", "\n- method: by hand\n- energy: -25 MN m",
        "\n## Joints\n\n| joint | Fx (N) | Fy (N) | turns |  |\n| --- | ---: | ---: | ---: | --- |\n",
        "| B \\| C | -1.00000 | 0 | - | free |\n\nFx: to the right\n", "\n## Left out\n\n- a damper\n"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part << "\n" << page;
  }
}

Table long_table(std::size_t rows) {
  Table table;
  table.columns.push_back({.title = "name", .kind = Column::Kind::word, .words = std::vector<std::string>(rows, "x")});
  return table;
}

TEST(Presenters, LongTablesShowHowManyRowsAreLeftOut) {
  Result result;
  result.content.table("", "", Rows::list) = long_table(1000);
  const std::string text = plain_text(result, {});
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2 + static_cast<long>(most_rows));
  EXPECT_TRUE(text.ends_with("  ... and 976 more\n")) << text;
  const std::string page = markdown_text(result);
  EXPECT_EQ(std::count(page.begin(), page.end(), '\n'), 1002);
}

TEST(Presenters, RowsOfLongTablesAreChosenAsAskedFor) {
  Table table = long_table(most_rows + 1);
  EXPECT_EQ(shown_rows(table).size(), most_rows + 1) << "one row too many is shown";
  table = long_table(1000);
  table.shown = Table::Shown::all;
  EXPECT_EQ(shown_rows(table).size(), 1000U);
  table.shown = Table::Shown::spread;
  for (const std::size_t rows : {1U, 24U, 25U, 73U, 1000U, 1001U}) {
    Table spread = long_table(rows);
    spread.shown = Table::Shown::spread;
    const std::vector<std::size_t> shown = shown_rows(spread);
    EXPECT_LE(shown.size(), most_rows + 1) << rows;
    EXPECT_EQ(shown.front(), 0U);
    EXPECT_EQ(shown.back(), rows - 1);
  }
}

TEST(Presenters, WideTablesGoOnBelowTheirFirstColumn) {
  Result result;
  Table& table = result.content.table("", "", Rows::list);
  for (int c = 0; c < 12; ++c) table.words("", c == 0 ? "name" : "column", {"a cell of 20 letters", "another cell"});
  table.remarks({"", "a remark"});
  const std::string text = plain_text(result, {});
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 120U) << line;
  std::size_t titles = 0;
  for (std::size_t at = text.find("name"); at != std::string::npos; at = text.find("name", at + 1)) ++titles;
  EXPECT_EQ(titles, 3U) << text;
}

TEST(Presenters, TerminalsInUtf8HaveTheSignsOfPrint) {
  Result result;
  result.verdict.text = "moves it by +-2 N, from -3 N to -1e-05 N in arm-2";
  result.content.table("", "", Rows::list).numbers("x", "x", "N", {-1.5, 2.5}, {.digits = 2});
  const std::string ascii = plain_text(result, {}), print = plain_text(result, Palette::with_signs());
  EXPECT_NE(ascii.find("+-2 N, from -3 N"), std::string::npos);
  EXPECT_NE(print.find("±2 N, from −3 N to −1e-05 N in arm-2"), std::string::npos) << print;
  EXPECT_NE(print.find("−1.5"), std::string::npos) << print;
  EXPECT_NE(json_text(result).find("+-2 N"), std::string::npos) << "data are plain";
}

TEST(Presenters, EmptyTablesAndSectionsAreLeftOut) {
  Result result;
  result.content.table("a", "Title", Rows::list);
  result.content.group("b", "Other title").data("c", 1);
  EXPECT_EQ(plain_text(result, {}), "");
  EXPECT_EQ(json::parse(json_text(result))["a"], json::array());
}

// ------------------------------------------------------------------------------------------------------------ CSV

Table numbers_of(const std::vector<std::string>& names, const std::vector<std::vector<double>>& columns) {
  Table table;
  for (std::size_t c = 0; c < names.size(); ++c) {
    table.columns.push_back({.key = names[c], .numbers = columns[c]});
  }
  return table;
}

TEST(Csv, HasAHeaderAndOneLineForEachRow) {
  EXPECT_EQ(csv_text(numbers_of({"time (s)", "boom (rad)"}, {{0, 0.001, 1e-7}, {-0.5, 1.0 / 3, 1e22}})),
            "time (s),boom (rad)\n"
            "0,-0.5\n"
            "0.001,0.3333333333333333\n"
            "1e-07,1e+22\n");
}

TEST(Csv, QuotesNamesThatWouldNotReadBack) {
  EXPECT_EQ(csv_text(numbers_of({"a,b", "say \"a\"", "two\nlines", " blank", "µ<b>"}, {{}, {}, {}, {}, {}})),
            "\"a,b\",\"say \"\"a\"\"\",\"two\nlines\",\" blank\",µ<b>\n");
}

TEST(Csv, LeavesTheCellOfWhatIsNotANumberEmpty) {
  EXPECT_EQ(csv_text(numbers_of({"a", "b", "c"}, {{1, NAN}, {-infinity, 2}, {3, infinity}})), "a,b,c\n1,,3\n,2,\n");
}

TEST(Csv, HasWordsAndLeavesOutColumnsWithoutAKey) {
  Table table;
  table.words("run", "run", {"low", "low, empty"});
  table.remarks({"seen", "by readers"});
  table.numbers("time", "time", "s", {0, 1});
  table.flags("white", {1, 0});
  EXPECT_EQ(csv_text(table), "run,time,white\nlow,0,1\n\"low, empty\",1,0\n");
  EXPECT_EQ(csv_text(Table{}), "");
}

TEST(Csv, EveryNumberReadsBackAsTheSameDouble) {
  std::mt19937_64 random(7);
  std::vector<double> written = {5e-324, -2.2250738585072014e-308, 1.7976931348623157e308, 0.1, -0.0};
  while (written.size() < 50000) {
    const auto value = std::bit_cast<double>(random());
    if (std::isfinite(value)) written.push_back(value);
  }
  std::istringstream lines(csv_text(numbers_of({"x"}, {written})));
  std::string line;
  std::getline(lines, line);
  for (const double expected : written) {
    ASSERT_TRUE(std::getline(lines, line));
    double read = 0.0;
    std::from_chars(line.data(), line.data() + line.size(), read);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(read), std::bit_cast<std::uint64_t>(expected)) << line;
  }
  EXPECT_FALSE(std::getline(lines, line));
}

}  // namespace
}  // namespace poise::app::presenters_test

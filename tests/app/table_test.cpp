#include "app/table.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace poise::app {
namespace {

TEST(Table, AlignsTextsLeftAndNumbersRight) {
  Table table;
  table.add_text_column("name", std::vector<std::string>{"a", "longer"});
  table.add_number_column("time", {"1.5 µs", "12 µs"});
  table.add_text_column("", std::vector<std::string>{"", "note"});
  EXPECT_EQ(table.print({}),
            "  name      time\n"
            "  a       1.5 µs\n"
            "  longer   12 µs  note\n");
}

TEST(Table, EmptyTablePrintsNothing) {
  Table table;
  EXPECT_EQ(table.print({}), "");
  table.add_text_column("name", std::vector<std::string>{});
  EXPECT_EQ(table.print({}), "");
}

TEST(Table, LongTableSaysHowMuchIsLeftOut) {
  Table table;
  table.add_text_column("name", std::vector<std::string>(1000, "x"));
  const std::string text = table.print({});
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2 + static_cast<long>(Table::shown_rows));
  EXPECT_TRUE(text.ends_with("  ... and 976 more\n")) << text;
}

TEST(Table, ShowsAllRowsWhereThatIsAskedFor) {
  Table table;
  table.show_all();
  table.add_number_cells("number", std::vector<Cell>(1000, Cell{"1", Tone::bad}));
  const std::string text = table.print({});
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1001);
  EXPECT_TRUE(text.ends_with("\n       1\n")) << text;
}

TEST(Table, OneRowTooManyIsShown) {
  Table table;
  table.add_text_column("name", std::vector<std::string>(Table::shown_rows + 1, "x"));
  EXPECT_EQ(table.print({}).find("more"), std::string::npos);
}

}  // namespace
}  // namespace poise::app

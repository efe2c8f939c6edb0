// What the commands say of every scene of datasets/: tables fit a terminal, a tone has a text, units and digits
// are known, and what was found comes before its details.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "app/commands/call.hpp"
#include "app/present/text.hpp"
#include "app/result/cells.hpp"
#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app::every_report_test {
namespace {

constexpr std::size_t widest = 120, most_lines = 24;

std::vector<std::string> scenes() {
  const std::filesystem::path folder = std::filesystem::path(app_tests::dataset("zeeman")).parent_path();
  std::vector<std::string> out;
  for (const char* part : {"", "structures", "friction"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder / part)) {
      const std::string name = entry.path().filename().string();
      const bool is_other = name.find("_design") != std::string::npos ||
                            name.find("_experiment") != std::string::npos || name.find("_plan") != std::string::npos ||
                            name.find("_tolerances") != std::string::npos;
      if (entry.path().extension() == ".toml" && !is_other) out.push_back(entry.path().string());
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

using Words = std::pair<std::string, std::vector<GivenOption>>;

/// The commands that go with any scene.
std::vector<Words> commands() {
  return {{"check", {}},
          {"solve", {}},
          {"compare", {}},
          {"sensitivity", {{"--of", "energy"}}},
          {"motion", {{"--duration", "0.01"}}},
          {"equilibria", {{"--seconds", "0"}, {"--starts", "10"}}},
          {"hold", {}},
          {"path", {{"--vary", "loads=0..1"}}},
          {"loads", {}},
          {"modes", {}},
          {"forces", {}}};
}

/// A table alone, as text has it.
std::string text_of(const Table& table) {
  Result alone;
  alone.content.table("t", "t", table.rows) = table;
  return plain_text(alone, {}, Verbosity::normal);
}

/// Whether a unit is made of those that scenes and results have: "N mm", "kN/m", "m/s²", "%".
bool is_unit(const std::string& unit) {
  static const std::set<std::string> stems = {"m", "mm", "in", "ft",  "N",  "lbf", "kg", "g", "lb",  "rad", "deg", "s",
                                              "J", "W",  "Pa", "psi", "Hz", "%",   "1",  "h", "min", "µs",  "ms"};
  std::string token;
  const auto is_known = [&] {
    const std::string all = std::exchange(token, "");
    if (all.empty() || stems.contains(all)) return true;
    const std::size_t prefix = all.starts_with("µ") ? std::string("µ").size() : 1;
    return std::string("µnmcdkMGT").find(all.substr(0, prefix)) != std::string::npos &&
           stems.contains(all.substr(prefix));
  };
  for (std::size_t i = 0; i < unit.size();) {
    const std::string_view rest = std::string_view(unit).substr(i);
    std::size_t skipped = 0;
    for (const std::string_view mark : {" ", "/", "(", ")", "²", "³", "⁴", "⁵", "⁻", "¹", "^", "·"}) {
      if (rest.starts_with(mark)) skipped = mark.size();
    }
    if (skipped == 0) {
      token += unit[i++];
      continue;
    }
    if (!is_known()) return false;
    i += skipped;
  }
  return is_known();
}

/// A number as printed.
struct Printed {
  int digits = 0;           ///< significant ones
  double last_place = 0.0;  ///< what one of its last digit is worth
};

/// The number with which a text begins; nothing where it begins with none.
std::optional<Printed> printed_number(const std::string& text) {
  static const std::regex number(R"(^\s*[-+]?(\d+)(?:\.(\d+))?(?:[eE]([-+]?\d+))?(?=$|\s|[,;)]))");
  std::smatch match;
  if (!std::regex_search(text, match, number)) return std::nullopt;
  const std::string all = match.str(1) + match.str(2);
  const std::size_t first = all.find_first_not_of('0');
  const int exponent = match.str(3).empty() ? 0 : std::stoi(match.str(3));
  return Printed{first == std::string::npos ? 0 : static_cast<int>(all.size() - first),
                 std::pow(10.0, exponent - static_cast<int>(match.str(2).size()))};
}

/// No double has more than 15 digits that count, and none beyond the radius beside it.
void expect_known_digits(const std::vector<TextColumn>& columns, const std::string& title) {
  constexpr int most_digits = 15;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool has_radius = c + 1 < columns.size() && columns[c + 1].title.starts_with("+-");
    for (std::size_t row = 0; row < columns[c].cells.size(); ++row) {
      const std::optional<Printed> one = printed_number(columns[c].cells[row]);
      if (!one) continue;
      EXPECT_LE(one->digits, most_digits) << title << ": " << columns[c].cells[row];
      if (!has_radius) continue;
      const std::string& radius = columns[c + 1].cells[row];
      if (!printed_number(radius) || std::stod(radius) == 0.0) continue;
      EXPECT_GE(one->last_place, std::stod(radius) / 100.0)
          << title << ": " << columns[c].cells[row] << " +- " << radius;
    }
  }
}

void expect_readable(const Table& table, const std::string& title) {
  const std::string text = text_of(table);
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string line = text.substr(from, end - from);
    const bool is_note = std::any_of(table.footnotes.begin(), table.footnotes.end(),
                                     [&](const std::string& note) { return line == "  " + note; });
    EXPECT_TRUE(is_note || static_cast<std::size_t>(std::count_if(
                               line.begin(), line.end(),
                               [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; })) <= widest)
        << title << ": " << line;
    from = end + 1;
  }
  const std::vector<TextColumn> columns = text_columns(table);
  expect_known_digits(columns, title);
  for (const TextColumn& column : columns) {
    EXPECT_TRUE(is_unit(column.unit)) << title << ": " << column.title << " in " << column.unit;
    const std::vector<Tone>& tones = column.column->tones;
    for (std::size_t row = 0; row < tones.size(); ++row) {
      EXPECT_TRUE(tones[row] == Tone::plain || !column.cells[row].empty()) << title << ", row " << row;
    }
  }
}

/// All tables that text shows; `lines` counts what stands before the first of them.
void expect_readable(const Group& group, std::size_t& lines, bool& is_in_details) {
  for (const Item& item : group.items()) {
    if (!is_shown(item, Verbosity::normal)) continue;
    is_in_details = is_in_details || !item.title.empty();
    if (const auto* table = std::get_if<Table>(&item.content)) {
      is_in_details = true;
      expect_readable(*table, item.title);
    } else if (const auto* branch = std::get_if<Branch>(&item.content)) {
      for (const Group& part : branch->parts) expect_readable(part, lines, is_in_details);
    } else if (!is_in_details) {
      ++lines;
    }
  }
}

TEST(EveryReport, FitsATerminalAndSaysFirstWhatWasFound) {
  int reports = 0;
  for (const std::string& scene : scenes()) {
    for (const auto& [command, options] : commands()) {
      SCOPED_TRACE(command + " " + scene);
      std::vector<GivenOption> given = {{"SCENE", scene}};
      given.insert(given.end(), options.begin(), options.end());
      Caller caller;
      try {
        call(command, given, caller);
      } catch (const InputError&) {
        continue;  // a command that does not go with this scene
      }
      ++reports;
      const Result& result = caller.outcome.result;
      EXPECT_FALSE(result.verdict.text.empty());
      std::size_t lines = 1 + result.warnings.size();
      bool is_in_details = false;
      expect_readable(result.content, lines, is_in_details);
      EXPECT_LE(lines, most_lines);
    }
  }
  EXPECT_GT(reports, 300);
}

}  // namespace
}  // namespace poise::app::every_report_test

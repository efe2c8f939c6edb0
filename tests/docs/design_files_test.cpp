// docs/design-files.md against what the reader of design files takes.
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "design/goals/goal_problem.hpp"
#include "model/scene.hpp"
#include "motion/design.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/docs/page.hpp"

namespace poise::docs_tests::design_files_test {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const fs::path source = POISE_SOURCE_DIR;

/// The keys that a table of a file of datasets/ may have, from the objection to one that it may not have.
template <class Read>
Names keys_read(const app_tests::TempFolder& folder, const std::string& file, Read read, const std::string& before,
                const std::string& after) {
  std::string text = app_tests::contents(source / "datasets" / file);
  const std::size_t found = text.find(before);
  EXPECT_NE(found, std::string::npos) << before;
  text.insert(found + before.size(), after);
  try {
    read(folder.write("design.toml", text));
  } catch (const InputError& error) {
    const std::string objection = error.what();
    static const std::regex list("expected one of the keys ([a-z, ]+)");
    std::smatch match;
    if (!std::regex_search(objection, match, list)) ADD_FAILURE() << objection;
    std::istringstream words(match[1].str());
    Names out;
    for (std::string word; std::getline(words >> std::ws, word, ',');) out.insert(word);
    return out;
  }
  ADD_FAILURE() << "the key was read";
  return {};
}

/// First cells of the table whose head begins with `head`, without the marks of code and tables.
Names keys_documented(const Page& page, const std::string& head) {
  Names out;
  auto line = std::find_if(page.lines.begin(), page.lines.end(), [&](const auto& l) { return l.starts_with(head); });
  EXPECT_NE(line, page.lines.end()) << head;
  for (; line != page.lines.end() && line->starts_with('|'); ++line) {
    static const std::regex first_cell(R"(^\| `\[*([a-z]+)\]*` \|.*)");
    std::smatch match;
    if (std::regex_match(*line, match, first_cell)) out.insert(match[1].str());
  }
  return out;
}

constexpr const char* wrong = "\nwrong = 1\n";

TEST(DesignFiles, KeysOfAStraightLineAreInTheDocs) {
  const app_tests::TempFolder folder;
  fs::copy_file(source / "datasets" / "lift.toml", folder.path("lift.toml"));
  const Page page = read_page(source / "docs" / "design-files.md");
  const auto read = [&](const std::string& before) {
    return keys_read(
        folder, "lift_design.toml", [](const fs::path& file) { read_design(file); }, before, wrong);
  };
  EXPECT_EQ(keys_documented(page, "| key | value"), read(""));
  EXPECT_EQ(keys_documented(page, "| key of `[drive]`"), read("\n[drive]"));
  EXPECT_EQ(keys_documented(page, "| key of `[goal]`"), read("\n[goal]"));
  EXPECT_EQ(keys_documented(page, "| key of `[[actuator]]`"), read("\n[[actuator]]"));
}

TEST(DesignFiles, KeysOfGoalsAreInTheDocs) {
  const app_tests::TempFolder folder;
  for (const char* file : {"tailgate.toml", "struts.csv"}) fs::copy_file(source / "datasets" / file, folder.path(file));
  const Page page = read_page(source / "docs" / "design-files.md");
  const auto read = [&](const std::string& before, const std::string& after) {
    return keys_read(
        folder, "tailgate_design.toml", [](const fs::path& file) { read_goals(file); }, before, after);
  };
  EXPECT_EQ(keys_documented(page, "| key of a file with goals |"), read("", wrong));
  EXPECT_EQ(keys_documented(page, "| key of `[[goal]]`"), read("\n[[goal]]", wrong));
  EXPECT_EQ(keys_documented(page, "| key of `[[catalogue]]`"), read("\n[[catalogue]]", wrong));
  EXPECT_EQ(keys_documented(page, "| key of a whole number |"),
            read("\n[variables]", "\n\"spring.left.gas.preload\" = { range = [100, 900], whole = true, wrong = 1 }\n"));
}

}  // namespace
}  // namespace poise::docs_tests::design_files_test

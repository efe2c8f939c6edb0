// docs/design-files.md against what the reader of design files takes.
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "motion/design.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/docs/page.hpp"

namespace poise::docs_tests::design_files_test {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const fs::path source = POISE_SOURCE_DIR;

/// The keys that a table may have, from the objection to one that it may not have.
Names keys_read(const app_tests::TempFolder& folder, const std::string& before, const std::string& after) {
  std::string text = app_tests::contents(source / "datasets" / "lift_design.toml");
  const std::size_t at = before.empty() ? 0 : text.find(before) + before.size();
  EXPECT_NE(at, std::string::npos);
  text.insert(at, after);
  try {
    read_design(folder.write("design.toml", text));
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

TEST(DesignFiles, KeysAreInTheDocs) {
  const app_tests::TempFolder folder;
  fs::copy_file(source / "datasets" / "lift.toml", folder.path("lift.toml"));
  const Page page = read_page(source / "docs" / "design-files.md");
  const std::string wrong = "\nwrong = 1\n";
  EXPECT_EQ(keys_documented(page, "| key | value"), keys_read(folder, "", wrong));
  EXPECT_EQ(keys_documented(page, "| key of `[drive]`"), keys_read(folder, "\n[drive]", wrong));
  EXPECT_EQ(keys_documented(page, "| key of `[goal]`"), keys_read(folder, "\n[goal]", wrong));
  EXPECT_EQ(keys_documented(page, "| key of `[[actuator]]`"), keys_read(folder, "\n[[actuator]]", wrong));
}

}  // namespace
}  // namespace poise::docs_tests::design_files_test

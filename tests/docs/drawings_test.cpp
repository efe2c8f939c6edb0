// Drawings of docs/figures: every key of the parts that bind measures is in a drawing beside its table.
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "tests/app/run_poise.hpp"
#include "tests/docs/page.hpp"

namespace poise::docs_tests::drawings_test {
namespace {

namespace fs = std::filesystem;
using app_tests::contents;

const fs::path docs = fs::path(POISE_SOURCE_DIR) / "docs";

std::vector<std::string> all_matches(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> out;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern); it != std::sregex_iterator(); ++it) {
    out.push_back((*it)[1].str());
  }
  return out;
}

/// From one heading of the second level to the next.
struct Section {
  std::string heading;
  std::set<std::string> keys;   ///< of the tables whose heads begin with "key of"
  std::set<std::string> drawn;  ///< what its drawings say in monospace
};

std::vector<Section> sections_of(const Page& page) {
  static const std::regex picture(R"(\]\((figures/[a-z_]+\.svg)\))"), code("`([a-z_]+)`"),
      monospace(R"(class="k">([a-z_]+)<)");
  std::vector<Section> out(1);
  bool in_table = false;
  for (const std::string& line : page.lines) {
    if (line.starts_with("## ")) out.push_back({line.substr(3), {}, {}});
    in_table = line.starts_with("| key of ") || (in_table && line.starts_with('|'));
    if (in_table && !line.starts_with("| key of ")) {
      for (const std::string& key : all_matches(line.substr(0, line.find('|', 1)), code)) out.back().keys.insert(key);
    }
    for (const std::string& file : all_matches(line, picture)) {
      for (const std::string& word : all_matches(contents(docs / file), monospace)) out.back().drawn.insert(word);
    }
  }
  return out;
}

class DrawnPages : public testing::TestWithParam<const char*> {};

TEST_P(DrawnPages, HaveEveryKeyInADrawing) {
  std::size_t keys = 0;
  for (const Section& section : sections_of(read_page(docs / GetParam()))) {
    for (const std::string& key : section.keys) {
      if (key == "name") continue;
      ++keys;
      EXPECT_TRUE(section.drawn.contains(key)) << section.heading << ": no drawing says " << key;
    }
  }
  EXPECT_GE(keys, 10u);
}

INSTANTIATE_TEST_SUITE_P(Pages, DrawnPages,
                         testing::Values("gears-cams-ropes.md", "curved-slots.md", "rolling-profiles.md"));

TEST(Drawings, AreSmall) {
  std::size_t drawings = 0;
  for (const auto& entry : fs::directory_iterator(docs / "figures")) {
    if (entry.path().extension() != ".svg") continue;
    ++drawings;
    EXPECT_LT(fs::file_size(entry), 10'000u) << entry.path();
  }
  EXPECT_GE(drawings, 25u);
}

}  // namespace
}  // namespace poise::docs_tests::drawings_test

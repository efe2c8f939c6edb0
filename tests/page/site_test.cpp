// The site in the folder POISE_SITE, in a real browser. tests/site/ builds its quick form, `make site` the whole.
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/support/browser.hpp"

namespace poise::page_tests::site_test {
namespace {

using nlohmann::json;
using test::Browser;

Browser& browser() { return Browser::shared(); }

class Site : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = Browser::missing(); !why.empty()) GTEST_SKIP() << why;
    const char* const folder = std::getenv("POISE_SITE");
    folder_ = std::filesystem::absolute(folder != nullptr ? folder : "none");
    if (!std::filesystem::exists(folder_ / "index.html")) GTEST_SKIP() << "POISE_SITE names no site";
    browser().emulate({});
  }

  std::string from_disk(const std::string& page) const { return "file://" + (folder_ / page).string(); }

  /// Its pages, without reports of Poise and copies of files.
  std::vector<std::string> pages() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      const std::filesystem::path& file = entry.path();
      if (file.extension() != ".html" || file.string().find("/files/") != std::string::npos) continue;
      if (app_tests::contents(file).find("md-content") != std::string::npos) found.push_back(file.string());
    }
    return found;
  }

  std::filesystem::path folder_;
};

/// Pages that the search names for words, the best first.
std::vector<std::string> found_for(const std::string& words) {
  browser().run(
      "document.getElementById('__search').checked = true;"
      "const input = document.querySelector('[data-md-component=search-query]');"
      "input.focus(); input.value = arguments[0]; input.dispatchEvent(new Event('keyup'));",
      json::array({words}));
  const std::string wait = words.empty() ? "=== null" : "!== null";
  EXPECT_TRUE(browser().wait_for("document.querySelector('.md-search-result__item') " + wait)) << words;
  return browser().run(
      "return [...document.querySelectorAll('.md-search-result__item > a')]"
      ".map(a => new URL(a.href).pathname.replace(/.*[/](?=[^/]*$)/, ''))");
}

void expect_that_search_finds(const std::string& address) {
  struct Expected {
    std::string words;
    std::string first;
    std::set<std::string> second;  ///< any of these
  };
  const std::vector<Expected> expected = {
      {"snap", "load-paths.html", {"python-bistable.html", "recipes.html", "path.html"}},
      {"friction", "friction.html", {"motion.html", "scene-files.html", "recipes.html", "hold.html"}},
      {"gas strut", "scene-files.html", {"recipes.html", "design-recipes.html"}},
      {"gravity", "scene-files.html", {"four_bar_gravity.html", "python.html", "library.html"}},
      {"spring", "scene-files.html", {"balance.html", "recipes.html"}},
      {"gear", "gears-cams-ropes.html", {"friction.html", "scene-files.html"}},
      {"stress", "loads.html", {"stress.html", "json.html", "quantities.html", "scene-files.html"}},
      {"install", "install.html", {"python.html", "tour.html"}},
  };
  browser().open(address);
  for (const auto& [words, first, second] : expected) {
    const std::vector<std::string> found = found_for(words);
    ASSERT_GE(found.size(), 2U) << words;
    EXPECT_EQ(found[0], first) << words;
    EXPECT_TRUE(second.contains(found[1])) << words << ": the second is " << found[1];
    found_for("");
  }
  EXPECT_EQ(browser().console(), std::vector<std::string>());
}

TEST_F(Site, SearchFindsFromDisk) { expect_that_search_finds(from_disk("index.html")); }

TEST_F(Site, SearchFindsWhereItIsServed) {
  // Serves until the program ends: connections that the browser keeps open hold up its stop(), and those that it closes
  // while the browser is about to use them are errors there.
  static httplib::Server& server = *new httplib::Server;
  server.set_keep_alive_timeout(600);
  server.set_file_extension_and_mimetype_mapping("json", "application/octet-stream");  // it would be compressed, slowly
  server.set_mount_point("/", folder_.string());
  const int port = server.bind_to_any_port("127.0.0.1");
  std::thread([] { server.listen_after_bind(); }).detach();
  expect_that_search_finds("http://127.0.0.1:" + std::to_string(port) + "/index.html");
}

/// No page scrolls sideways on a telephone; none asks for what is not in the folder; formulas are rendered.
TEST_F(Site, PagesFitAndAskNobody) {
  const std::vector<std::string> all = pages();
  EXPECT_GT(all.size(), 30U);
  browser().emulate({.width = 400, .height = 800});
  for (const std::string& page : all) {
    browser().open("file://" + page);
    const json seen = browser().run(
        "return {wide: document.documentElement.scrollWidth - innerWidth,"
        " asked: performance.getEntriesByType('resource').map(e => e.name).filter(n => !/^(file|data|blob):/.test(n)),"
        " raw: [...document.querySelectorAll('.arithmatex')].filter(e => !e.querySelector('.katex')).length}");
    EXPECT_LE(seen["wide"], 0) << page << " is wider than the window";
    EXPECT_EQ(seen["asked"], json::array()) << page;
    EXPECT_EQ(seen["raw"], 0) << page << " has formulas that are not rendered";
  }
  EXPECT_EQ(browser().console(), std::vector<std::string>());
}

/// The report on the landing page plays, and shows its drawing only.
TEST_F(Site, LandingPageMoves) {
  browser().open(from_disk("index.html"));
  ASSERT_TRUE(browser().wait_for("document.querySelector('iframe') && document.readyState === 'complete'"));
  browser().enter_frame("iframe");
  ASSERT_TRUE(browser().wait_for("document.querySelector('.player .value')"));
  const json first = browser().run("return document.querySelector('.player .value').textContent");
  EXPECT_TRUE(browser().wait_for("document.querySelector('.player .value').textContent !== '" +
                                 first.get<std::string>() + "'"));
  EXPECT_EQ(browser().run("return document.querySelector('.report').offsetHeight"), 0);
  browser().leave_frames();
}

}  // namespace
}  // namespace poise::page_tests::site_test

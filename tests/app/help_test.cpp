#include <filesystem>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::help_test {
namespace {

/// What the first group of the pattern matches.
std::set<std::string> matches(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator m(text.begin(), text.end(), regex), end; m != end; ++m) found.insert((*m)[1]);
  return found;
}

std::set<std::string> commands_in(const std::string& help) {
  const std::size_t begin = help.find("Subcommands:");
  return matches(help.substr(begin, help.find("Examples:") - begin), "\n  ([a-z]+)");
}

TEST(Help, NamesFilesThatAreOnThisMachine) {
  const std::set<std::string> paths = matches(run_poise({"--help"}).out, " (/[^\\s]+)");
  EXPECT_GE(paths.size(), 5u);
  for (const std::string& path : paths) EXPECT_TRUE(std::filesystem::exists(path)) << path;
}

TEST(ManPage, HasEveryCommandAndOption) {
  std::string page = contents(std::filesystem::path(POISE_EXECUTABLE).parent_path() / "poise.1");
  std::erase(page, '\\');
  const std::string help = run_poise({"--help"}).out;
  const std::set<std::string> commands = commands_in(help);
  EXPECT_GE(commands.size(), 12u);
  EXPECT_TRUE(page.find("--version") != std::string::npos);
  for (const std::string& command : commands) {
    const std::size_t begin = page.find(".SS poise " + command + "\n");
    ASSERT_NE(begin, std::string::npos) << command;
    const std::string section = page.substr(begin, page.find("\n.S", begin) - begin);
    const std::set<std::string> options = matches(run_poise({command, "--help"}).out, "(--[a-z]+(?:-[a-z]+)*)");
    EXPECT_GE(options.size(), 1u) << command;
    for (const std::string& option : options) {
      EXPECT_NE(section.find(option), std::string::npos) << command << " " << option;
    }
  }
}

}  // namespace
}  // namespace poise::app_tests::help_test

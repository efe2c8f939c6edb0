#include "app/commands/completion.hpp"

#include <cstdio>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::completion_test {
namespace {

/// The file of a shell in the build folder.
std::string file_for(const std::string& shell) {
  const std::string name = shell == "bash" ? "poise" : shell == "zsh" ? "_poise" : "poise.fish";
  return std::filesystem::path(POISE_EXECUTABLE).parent_path() / "completions" / name;
}

struct ShellRun {
  int exit_code = -1;
  std::string out;  ///< with what it says on standard error
};

ShellRun run_shell(const std::string& line) {
  ShellRun run;
  FILE* const pipe = popen((line + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return run;
  char part[256];
  while (std::fgets(part, sizeof part, pipe) != nullptr) run.out += part;
  const int status = pclose(pipe);
  if (WIFEXITED(status)) run.exit_code = WEXITSTATUS(status);
  return run;
}

bool has_shell(const std::string& shell) { return run_shell("command -v " + shell).exit_code == 0; }

std::set<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::set<std::string> out;
  for (std::string line; std::getline(stream, line);) out.insert(line.substr(0, line.find('\t')));
  return out;
}

/// What a script says of a command: a branch of bash and zsh, the lines of fish.
std::string part_about(const std::string& command, const std::string& shell, const std::string& script) {
  if (shell != "fish") {
    const std::size_t begin = script.find(" " + command + ")\n");
    return begin == std::string::npos ? "" : script.substr(begin, script.find(shell == "zsh" ? ";;" : "esac", begin));
  }
  std::istringstream stream(script);
  std::string out;
  for (std::string line; std::getline(stream, line);) {
    if (line.find("'__poise_does " + command + "'") != std::string::npos) out += line + "\n";
  }
  return out;
}

class CompletionOf : public testing::TestWithParam<std::string> {};

TEST_P(CompletionOf, HasEveryCommandAndOption) {
  const std::string& shell = GetParam();
  const std::string script = contents(file_for(shell));
  EXPECT_EQ(script, run_poise({"--completion", shell}).out);
  const std::vector<app::CommandEntry> commands = app::all_commands();
  EXPECT_GE(commands.size(), 22u);
  for (const app::CommandEntry& entry : commands) {
    const std::string part = part_about(entry.command.name, shell, script);
    for (const app::Option& option : entry.command.options) {
      if (!option.name.starts_with('-')) continue;
      // Between what is no part of a name: --seed is not --seconds.
      const std::string name = shell == "fish" ? " -l " + option.name.substr(2) + " " : option.name;
      const std::size_t at = part.find(name);
      EXPECT_NE(at, std::string::npos) << entry.command.name << " " << name;
      for (const std::string& choice : option.choices) {
        EXPECT_NE(part.find(choice, at), std::string::npos) << entry.command.name << " " << name << " " << choice;
      }
    }
  }
}

TEST_P(CompletionOf, IsReadByTheShell) {
  const std::string& shell = GetParam();
  if (!has_shell(shell)) GTEST_SKIP() << shell << " is not installed";
  const ShellRun run = run_shell(fmt::format("{} -n {}", shell, file_for(shell)));
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_EQ(run.out, "");
}

INSTANTIATE_TEST_SUITE_P(Shells, CompletionOf, testing::ValuesIn(app::completed_shells()),
                         [](const auto& one) { return one.param; });

TEST(Completion, OfAFileHasItsEnding) {
  const std::set<std::string> files = {"FILE", "DIR", "OTHER"}, words = {"SCENE", "DESIGN", "EXPERIMENT", "FILE"};
  for (const app::CommandEntry& entry : app::all_commands()) {
    for (const app::Option& option : entry.command.options) {
      const bool is_file = files.contains(option.value) || words.contains(option.name);
      EXPECT_EQ(!option.ending.empty(), is_file) << entry.command.name << " " << option.name;
    }
  }
}

TEST(Completion, OfAnotherShellIsRefused) {
  const ProgramRun run = run_poise({"--completion", "fishy"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err, "--completion: expected bash, zsh or fish, found \"fishy\"; did you mean \"fish\"?\n");
}

TEST(Completion, BehindTheShellNothingIsRead) {
  using Words = std::vector<std::string>;
  for (const Words& words : {Words{"--completion", "bash", "zsh"}, Words{"--completion=bash", "zsh"}}) {
    const ProgramRun more = run_poise(words);
    EXPECT_EQ(more.exit_code, 2);
    EXPECT_EQ(more.out, "");
    EXPECT_TRUE(more.err.ends_with("found \"zsh\"; see poise --help\n")) << more.err;
  }
}

TEST(Completion, WithoutAShellNamesTheHelp) {
  const ProgramRun run = run_poise({"--completion"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err, "poise: --completion: expected a word behind it, found none; see poise --help\n");
}

/// A folder with files of several kinds and one in a folder below.
class CompletionInFolder : public testing::Test {
 protected:
  CompletionInFolder() {
    for (const char* name : {"arm.toml", "arm two.toml", "record.csv", "arm.svg", "arm.dxf", "arm.urdf"})
      folder_.write(name, "");
    std::filesystem::create_directory(folder_.path("studies"));
  }

  /// What bash offers for the last of these words.
  std::set<std::string> bash_offers(const std::string& words) const {
    return answers(
        fmt::format("bash -c 'cd {} && . {} && COMP_WORDS=({}) && COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)) && _poise && "
                    "printf \"%s\\n\" \"${{COMPREPLY[@]}}\"'",
                    folder_.path("").string(), file_for("bash"), words));
  }
  /// What fish offers for the end of a line.
  std::set<std::string> fish_offers(const std::string& line) const {
    return answers(fmt::format("cd {} && fish --no-config -c 'source {}; complete -C \"{}\"'",
                               folder_.path("").string(), file_for("fish"), line));
  }

 private:
  static std::set<std::string> answers(const std::string& line) {
    std::set<std::string> offers = lines_of(run_shell(line).out);
    offers.erase("");
    return offers;
  }

  TempFolder folder_;
};

using Words = std::set<std::string>;

TEST_F(CompletionInFolder, OffersWhatFitsInBash) {
  EXPECT_EQ(bash_offers("poise iden"), (Words{"identify", "identifiability"}));
  EXPECT_EQ(bash_offers("poise --ver"), Words{"--version"});
  EXPECT_EQ(bash_offers("poise --completion \"\""), (Words{"bash", "zsh", "fish"}));
  EXPECT_EQ(bash_offers("poise solve --me"), Words{"--method"});
  EXPECT_EQ(bash_offers("poise solve --method e"), Words{"energy"});
  EXPECT_EQ(bash_offers("poise solve --seek \"\""), (Words{"settle", "any", "stable"}));
  EXPECT_EQ(bash_offers("poise solve --seek ="), (Words{"settle", "any", "stable"}));
  EXPECT_EQ(bash_offers("poise solve --seek = st"), Words{"stable"});
  EXPECT_EQ(bash_offers("poise compare --methods energy,virt"), Words{"energy,virtual-work"});
  EXPECT_EQ(bash_offers("poise solve a"), (Words{"arm.toml", "arm two.toml"}));
  EXPECT_EQ(bash_offers("poise solve \"arm\\\\ t\""), Words{"arm two.toml"});
  EXPECT_EQ(bash_offers("poise solve \"\""), (Words{"arm.toml", "arm two.toml", "studies"}));
  EXPECT_EQ(bash_offers("poise identify --data r"), Words{"record.csv"});
  EXPECT_EQ(bash_offers("poise import \"\""), (Words{"arm.dxf", "arm.urdf", "studies"}));
  EXPECT_EQ(bash_offers("poise montecarlo --output \"\""), Words{"studies"});
  EXPECT_EQ(bash_offers("poise solve --time \"\""), Words{});
  EXPECT_EQ(bash_offers("poise nothing \"\""), Words{});
}

TEST_F(CompletionInFolder, OffersWhatFitsInFish) {
  if (!has_shell("fish")) GTEST_SKIP() << "fish is not installed";
  EXPECT_EQ(fish_offers("poise iden"), (Words{"identify", "identifiability"}));
  EXPECT_EQ(fish_offers("poise solve --me"), Words{"--method"});
  EXPECT_EQ(fish_offers("poise solve --method en"), Words{"energy"});
  EXPECT_EQ(fish_offers("poise solve --seek="), (Words{"--seek=settle", "--seek=any", "--seek=stable"}));
  // Fish puts files with the ending first, and others behind them.
  const Words files = fish_offers("poise solve ar");
  EXPECT_TRUE(files.contains("arm.toml") && files.contains("arm two.toml"));
  EXPECT_EQ(fish_offers("poise identify --data r"), Words{"record.csv"});
  EXPECT_EQ(fish_offers("poise montecarlo --output s"), Words{"studies/"});
  EXPECT_EQ(fish_offers("poise solve --time "), Words{});
}

}  // namespace
}  // namespace poise::app_tests::completion_test

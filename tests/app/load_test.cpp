// Answers do not depend on how busy the machine is.

#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/app/run_poise.hpp"
#include "tests/support/busy_machine.hpp"

namespace poise::app_tests::load_test {
namespace {

/// What a command prints, without its times, which are alone allowed to differ.
std::string without_times(const std::string& text) {
  static const std::regex time("[0-9.]+(e[-+][0-9]+)? (µs|ms|s)\\b *");
  static const std::regex blanks(" +");
  return std::regex_replace(std::regex_replace(text, time, "TIME "), blanks, " ");
}

TEST(Load, CommandsPrintTheSameOnABusyMachine) {
  const std::vector<std::vector<std::string>> commands = {
      {"solve", dataset("thesis_four_bar")},
      {"compare", dataset("toggle_clamp"), "--methods", "all"},
      {"path", dataset("toggle_clamp"), "--vary", "load.P=0..60"},
      {"equilibria", dataset("six_bar"), "--jobs", "2"},
      {"stress", "von-mises-1e-10", "zeeman-1e-2", "hanging-chain-1000", "--starts", "20", "--work", "5000"},
      {"tolerance", dataset("toggle_clamp"), "--tolerances", dataset("toggle_clamp_tolerances"), "--of", "force.rubber",
       "--samples", "3000", "--jobs", "2"},
      {"identify", dataset("lift_experiment")}};
  std::vector<ProgramRun> quiet;
  for (const std::vector<std::string>& words : commands) quiet.push_back(run_poise(words));
  const test::BusyMachine busy;
  for (std::size_t k = 0; k < commands.size(); ++k) {
    const ProgramRun again = run_poise(commands[k]);
    EXPECT_EQ(again.exit_code, quiet[k].exit_code) << commands[k].front();
    EXPECT_EQ(without_times(again.out), without_times(quiet[k].out));
    EXPECT_EQ(again.err, quiet[k].err);
  }
}

}  // namespace
}  // namespace poise::app_tests::load_test

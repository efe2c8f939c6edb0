#include "app/command_line.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/commands/check.hpp"
#include "app/commands/commands.hpp"
#include "app/commands/compare.hpp"
#include "app/commands/design.hpp"
#include "app/commands/forces.hpp"
#include "app/commands/identifiability.hpp"
#include "app/commands/identify.hpp"
#include "app/commands/kinematics.hpp"
#include "app/commands/modes.hpp"
#include "app/commands/montecarlo.hpp"
#include "app/commands/motion.hpp"
#include "app/commands/solve.hpp"
#include "app/commands/stress.hpp"
#include "app/quantity.hpp"
#include "model/nearest_name.hpp"

namespace poise::app {
namespace {

/// A command with what its help ends with: a line to try, from the folder of Poise.
struct Entry {
  Command command;
  std::string example;
  std::string name() const { return command.app->get_name(); }
};

std::vector<Entry> add_commands(CLI::App& app) {
  return {
      {add_check(app), "datasets/six_bar.toml"},
      {add_solve(app), "datasets/toggle_clamp.toml --set load.P=30 --svg clamp.svg --json clamp.json"},
      {add_compare(app), "datasets/car_hood.toml --svg hood.svg"},
      {add_kinematics(app), "datasets/lift.toml --drive stroke=0.5..0.79 --point platform.Q --svg lift.svg"},
      {add_motion(app), "datasets/lift.toml --duration 2 --release obd=0.005 --csv swing.csv"},
      {add_modes(app), "datasets/lift.toml"},
      {add_forces(app), "datasets/lift.toml --drive stroke=0.5..0.79 --svg forces.svg"},
      {add_design(app), "datasets/lift_design.toml --scene found.toml"},
      {add_identify(app), "datasets/lift_experiment.toml --svg fit.svg"},
      {add_identifiability(app), "datasets/lift_experiment_empty.toml"},
      {add_montecarlo(app), "datasets/lift_experiment.toml --trials 300"},
      {add_stress(app), "--methods virtual-work,energy --starts 100"},
  };
}

void add_examples(CLI::App& app, const std::vector<Entry>& commands) {
  std::string text = "Examples:\n";
  for (const Entry& entry : commands) {
    const std::string line = fmt::format("  poise {} {}\n", entry.name(), entry.example);
    text += line;
    entry.command.app->footer("Example:\n" + line);
  }
  app.footer(text +
             "\nExit code: 0 solved and confirmed, 1 not found or not confirmed, 2 bad input.\n"
             "Numbers are read and shown in the units of the scene. Files: docs/scene-files.md,\n"
             "docs/experiment-files.md.");
}

std::string first_line(std::string_view text) { return one_line(text.substr(0, text.find('\n'))); }

int complain(const std::string& line) {
  fmt::print(stderr, "{}\n", one_line(line));
  return bad_input;
}

/// What CLI11 would only call "required": no command, or one that is misspelt.
void expect_command(const std::vector<Entry>& commands, int argc, const char* const* argv) {
  std::vector<std::string> names;
  for (const Entry& entry : commands) names.push_back(entry.name());
  const std::string expected =
      fmt::format("expected a command: {} or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
  if (argc < 2) throw InputError("poise: " + expected + "; poise --help tells more");
  const std::string word = argv[1];
  if (word.starts_with('-') || std::find(names.begin(), names.end(), word) != names.end()) return;
  throw InputError(fmt::format("poise: {}, found \"{}\"{}", expected, word, did_you_mean(word, names)));
}

/// Names the first word of the command line that the command has no use for.
std::string unexpected(const CLI::App& command, int argc, const char* const* argv) {
  const std::vector<std::string> extra = command.remaining();
  const auto* word = std::find_if(argv + 1, argv + argc, [&](const std::string& w) {
    return std::find(extra.begin(), extra.end(), w) != extra.end();
  });
  const std::string name = word != argv + argc ? *word : extra.front();
  std::string file;  // what the command reads: "scene"
  std::vector<std::string> options;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) file = option->get_name(true);
    if (!option->get_lnames().empty()) options.push_back("--" + option->get_lnames().front());
  }
  for (char& letter : file) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  if (!name.starts_with('-')) return fmt::format("poise: expected one {}, found \"{}\" too", file, name);
  return fmt::format("poise: {} has no option \"{}\"{}", command.get_name(), name, did_you_mean(name, options));
}

int parse_and_run(int argc, const char* const* argv) {
  CLI::App app("Where planar mechanisms rest, how they move, and what their swing tells of them", "poise");
  app.set_version_flag("--version", "poise " POISE_VERSION, "Print the version and leave");
  app.get_formatter()->column_width(34);
  app.require_subcommand(1);
  const std::vector<Entry> commands = add_commands(app);
  add_examples(app, commands);

  expect_command(commands, argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::ExtrasError&) {
    throw InputError(unexpected(*app.get_subcommands().front(), argc, argv));
  } catch (const CLI::ParseError& error) {
    throw InputError(fmt::format("poise: {}; poise {} --help tells more", first_line(error.what()), argv[1]));
  }
  const auto asked =
      std::find_if(commands.begin(), commands.end(), [](const Entry& entry) { return entry.command.app->parsed(); });
  return asked->command.run(Palette::for_stream(stdout));
}

}  // namespace

int run(int argc, const char* const* argv) {
  try {
    return parse_and_run(argc, argv);
  } catch (const InputError& error) {
    return complain(error.what());
  } catch (const std::exception& error) {
    complain(std::string("poise: failed: ") + error.what());
    return not_solved;
  }
}

}  // namespace poise::app

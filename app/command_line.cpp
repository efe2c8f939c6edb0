#include "app/command_line.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/commands/command.hpp"
#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/result/numbers.hpp"
#include "app/terminal/poise_folder.hpp"
#include "app/terminal/standard_streams.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"
#include "statics/model/mobility.hpp"

namespace poise::app {
namespace {

/// A command with what its help ends with: a line to try, from the folder of Poise.
struct CommandEntry {
  Command command;
  std::string example;

  std::string line() const { return fmt::format("  poise {} {}\n", command.name, example); }
};

std::vector<CommandEntry> all_commands() {
  return {
      {check_command(), "datasets/six_bar.toml"},
      {solve_command(), "datasets/toggle_clamp.toml --set load.P=30 --svg clamp.svg --json clamp.json"},
      {equilibria_command(), "datasets/four_bar_gravity.toml --svg equilibria.svg"},
      {hold_command(), "datasets/friction/wedge.toml --vary load.P"},
      {view_command(), "datasets/toggle_clamp.toml"},
      {path_command(), "datasets/von_mises_toggle.toml --vary load.P=0..60 --svg toggle.svg"},
      {find_command(),
       "datasets/toggle_clamp.toml --vary spring.rubber.stiffness=200..800 --for \"force.rubber = -700\""},
      {sensitivity_command(), "datasets/toggle_clamp.toml --of force.rubber,fold.load.P"},
      {tolerance_command(),
       "datasets/toggle_clamp.toml --tolerances datasets/toggle_clamp_tolerances.toml --of force.rubber"},
      {loads_command(), "datasets/structures/three_hinged_portal.toml --svg loads.svg"},
      {compare_command(), "datasets/car_hood.toml --svg hood.svg"},
      {kinematics_command(), "datasets/lift.toml --drive stroke=0.5..0.79 --point platform.Q --svg lift.svg"},
      {motion_command(), "datasets/lift.toml --duration 2 --release obd=0.005 --csv swing.csv"},
      {modes_command(), "datasets/lift.toml"},
      {forces_command(), "datasets/lift.toml --drive stroke=0.5..0.79 --svg forces.svg"},
      {design_command(), "datasets/wall_bed_design.toml --scene found.toml --html design.html"},
      {identify_command(), "datasets/lift_experiment.toml --svg fit.svg"},
      {validate_command(), "datasets/lift_experiment.toml --with fit.json"},
      {identifiability_command(), "datasets/lift_experiment_empty.toml"},
      {plan_command(), "datasets/lift_plan.toml --experiment planned.toml"},
      {montecarlo_command(), "datasets/lift_experiment.toml --trials 300"},
      {stress_command(), "--methods virtual-work,energy --starts 100"},
  };
}

/// Adds an option to CLI11, which only splits the command line into words: they are read here, by the rules and with
/// the messages of all other input.
struct Declaration {
  CLI::App& app;
  const Option& option;

  void operator()(bool* flag) const { app.add_flag(option.name, *flag, option.help); }
  void operator()(std::vector<std::string>* list) const {
    add<std::vector<std::string>>([name = option.name, list](const std::vector<std::string>& words) {
      for (const std::string& word : words) read_word(name, word, list->emplace_back());
    }).allow_extra_args(!option.name.starts_with('-'));
  }
  template <class Value>
  void operator()(std::optional<Value>* value) const {
    add<std::string>([name = option.name, value](const std::string& word) { read_word(name, word, value->emplace()); });
  }
  void operator()(auto* value) const {
    add<std::string>([name = option.name, value](const std::string& word) { read_word(name, word, *value); });
  }

 private:
  template <class Words>
  CLI::Option& add(const std::function<void(const Words&)>& read) const {
    return *app.add_option_function<Words>(option.name, read, option.help)
                ->type_name(option.value)
                ->required(option.presence == Presence::required);
  }
};

/// Where docs and examples are on this machine; empty where they are not installed.
std::string folders_on_this_machine() {
  const std::optional<std::filesystem::path> folder = poise_folder();
  if (!folder) return "";
  return fmt::format(
      "\n\nOn this machine:\n"
      "  documentation      {0}/docs\n"
      "  input files        {0}/docs/scene-files.md\n"
      "                     {0}/docs/experiment-files.md\n"
      "  example scenes     {0}/datasets\n"
      "  C++ examples       {0}/docs/examples\n",
      folder->string());
}

void declare(CLI::App& app, const std::vector<CommandEntry>& commands) {
  std::string examples = "Examples:\n";
  for (const CommandEntry& entry : commands) {
    CLI::App& command = *app.add_subcommand(entry.command.name, entry.command.help);
    for (const Option& option : entry.command.options) std::visit(Declaration{command, option}, option.target);
    command.footer("Example:\n" + entry.line());
    examples += entry.line();
  }
  app.footer(examples +
             "\nExit code: 0 solved and confirmed (checked, where a proof takes too long),\n1 not found or not "
             "confirmed, 2 bad input.\n"
             "Numbers are read and shown in the units of the scene." +
             folders_on_this_machine());
}

/// The words in quotes where a shell needs them.
std::string line_of(int argc, const char* const* argv) {
  constexpr std::string_view plain = "-_./=,:+@%";
  const auto is_plain = [&](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || plain.find(c) != std::string_view::npos;
  };
  std::string line = "poise";
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool is_bare = !word.empty() && std::all_of(word.begin(), word.end(), is_plain);
    line += is_bare ? " " : " '";
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    if (!is_bare) line += '\'';
  }
  return line;
}

std::string first_line(std::string_view text) { return one_line(text.substr(0, text.find('\n'))); }

int complain(const std::string& line) {
  say(one_line(line) + "\n");
  return bad_input;
}

/// Throws InputError where there is no command or an unknown one: CLI11 would only call it "required".
void expect_command(const std::vector<CommandEntry>& commands, int argc, const char* const* argv) {
  std::vector<std::string> names;
  for (const CommandEntry& entry : commands) names.push_back(entry.command.name);
  const std::string expected =
      fmt::format("expected a command: {} or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
  if (argc < 2) throw InputError("poise: " + expected + "; see poise --help");
  const std::string word = argv[1];
  if (word.starts_with('-') || std::find(names.begin(), names.end(), word) != names.end()) return;
  throw InputError(fmt::format("poise: {}, found \"{}\"{}", expected, word, did_you_mean(word, names)));
}

/// Throws InputError naming the first word of the command line that the command does not take.
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
  return fmt::format("poise: {} has no option \"{}\"{}", command.get_name(), name, did_you_mean_or_list(name, options));
}

int parse_and_run(int argc, const char* const* argv) {
  CLI::App app("Equilibria, motion and parameter identification of planar mechanisms", "poise");
  app.set_version_flag("--version", "poise " POISE_VERSION, "Print the version and exit");
  app.get_formatter()->column_width(34);
  app.require_subcommand(1);
  const std::vector<CommandEntry> commands = all_commands();
  declare(app, commands);

  expect_command(commands, argc, argv);
  // CLI11 would take the next word in its place.
  for (int i = 2; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with("--") || !word.ends_with('=')) continue;
    throw InputError(fmt::format("poise: {}: expected a word behind it, found none; see poise {} --help",
                                 word.substr(0, word.size() - 1), argv[1]));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    const int code = app.exit(asked);
    if (!std::cout.flush()) throw InputError("cannot write to standard output; expected a place that takes the text");
    return code;
  } catch (const CLI::ExtrasError&) {
    throw InputError(unexpected(*app.get_subcommands().front(), argc, argv));
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string_view what = error.what();
    const bool missing = what.find("missing") != std::string_view::npos;
    throw InputError(fmt::format("poise: {}: expected {}; see poise {} --help", what.substr(0, what.find(':')),
                                 missing ? "a word behind it, found none" : "once, found several times", argv[1]));
  } catch (const CLI::ParseError& error) {
    throw InputError(fmt::format("poise: {}; see poise {} --help", first_line(error.what()), argv[1]));
  }
  const auto asked = std::find_if(commands.begin(), commands.end(),
                                  [&](const CommandEntry& entry) { return app.got_subcommand(entry.command.name); });
  if (asked->command.line != nullptr) *asked->command.line = line_of(argc, argv);
  return asked->command.run(Palette::for_stream(stdout));
}

}  // namespace

int run(int argc, const char* const* argv) {
  hold_standard_streams();
  try {
    return parse_and_run(argc, argv);
  } catch (const AssemblyError& error) {
    complain(error.what());
    return not_solved;
  } catch (const InputError& error) {
    return complain(error.what());
  } catch (const std::exception& error) {
    complain(std::string("poise: failed: ") + error.what());
    return not_solved;
  }
}

}  // namespace poise::app

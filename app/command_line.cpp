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
#include "app/commands/completion.hpp"
#include "app/commands/options.hpp"
#include "app/result/numbers.hpp"
#include "app/terminal/poise_folder.hpp"
#include "app/terminal/standard_streams.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"
#include "statics/model/mobility.hpp"

namespace poise::app {
namespace {

/// Adds an option to CLI11, which only splits the command line into words: they are read here, by the rules and with
/// the messages of all other input.
struct Declaration {
  CLI::App& app;
  const Option& option;

  void operator()(bool* flag) const { app.add_flag(option.name, *flag, option.help); }
  void operator()(std::vector<std::string>* /*list*/) const {
    add<std::vector<std::string>>([&option = option](const std::vector<std::string>& words) {
      for (const std::string& word : words) read_option(option, word);
    }).allow_extra_args(!option.name.starts_with('-'));
  }
  void operator()(auto* /*value*/) const {
    add<std::string>([&option = option](const std::string& word) { read_option(option, word); });
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
    const std::string line = fmt::format("  poise {} {}\n", entry.command.name, entry.example);
    command.footer("Example:\n" + line);
    examples += line;
  }
  app.footer(examples +
             "\nExit code: 0 solved and confirmed (checked, where a proof takes too long),\n1 not found or not "
             "confirmed, 2 bad input.\n"
             "Numbers are read and shown in the units of the scene." +
             folders_on_this_machine());
}

std::string first_line(std::string_view text) { return one_line(text.substr(0, text.find('\n'))); }

int complain(const std::string& line) {
  say(one_line(line) + "\n");
  return bad_input;
}

/// Throws InputError where there is no command or an unknown one: CLI11 would only call it "required".
void expect_command(const std::vector<CommandEntry>& commands, int argc, const char* const* argv) {
  if (argc < 2) throw InputError("poise: " + expected_commands(commands) + "; see poise --help");
  if (std::string_view(argv[1]).starts_with('-')) return;
  command_named(commands, argv[1]);
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
  return no_such_option(command.get_name(), name, options);
}

int parse_and_run(int argc, const char* const* argv) {
  CLI::App app("Equilibria, motion and parameter identification of planar mechanisms", "poise");
  app.set_version_flag("--version", "poise " POISE_VERSION, "Print the version and exit");
  app.get_formatter()->column_width(34);
  app.require_subcommand(1);
  const std::vector<CommandEntry> commands = all_commands();
  declare(app, commands);
  const auto complete = [&](const std::string& shell) {
    throw CLI::CallForVersion(completion_script(shell, commands), 0);  // prints this text and ends, as --version does
  };
  app.add_option_function<std::string>(
         "--completion", complete, "Print a script that completes the words of poise in a shell:\nbash, zsh or fish")
      ->type_name("SHELL");

  expect_command(commands, argc, argv);
  const std::string_view first = argv[1];
  // CLI11 would print the script at the first of its words, and overlook the others.
  if (const int last = first == "--completion" ? 2 : 1; first.starts_with("--completion") && argc > last + 1) {
    throw InputError(fmt::format("poise: --completion: expected nothing behind {}, found \"{}\"; see poise --help",
                                 argv[last], argv[last + 1]));
  }
  const std::string help = first.starts_with('-') ? "poise --help" : fmt::format("poise {} --help", first);
  // CLI11 would take the next word in its place.
  for (int i = 2; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with("--") || !word.ends_with('=')) continue;
    throw InputError(
        fmt::format("poise: {}: expected a word behind it, found none; see {}", word.substr(0, word.size() - 1), help));
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
    throw InputError(fmt::format("poise: {}: expected {}; see {}", what.substr(0, what.find(':')),
                                 missing ? "a word behind it, found none" : "once, found several times", help));
  } catch (const CLI::ParseError& error) {
    throw InputError(fmt::format("poise: {}; see {}", first_line(error.what()), help));
  }
  const auto asked = std::find_if(commands.begin(), commands.end(),
                                  [&](const CommandEntry& entry) { return app.got_subcommand(entry.command.name); });
  if (Request* const request = asked->command.request; request != nullptr) {
    request->line = line_of({argv + 1, argv + argc});
  }
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

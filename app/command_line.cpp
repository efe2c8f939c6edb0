#include "app/command_line.hpp"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/quantity.hpp"
#include "model/nearest_name.hpp"

namespace poise::app {
namespace {

constexpr const char* examples =
    "Examples:\n"
    "  poise check datasets/six_bar.toml\n"
    "  poise solve datasets/thesis_four_bar.toml --seek stable\n"
    "  poise solve datasets/toggle_clamp.toml --set load.P=30 --svg clamp.svg --json clamp.json\n"
    "  poise compare datasets/car_hood.toml --svg hood.svg\n"
    "\n"
    "Exit code: 0 solved and confirmed, 1 not found or not confirmed, 2 bad input.\n"
    "Numbers are read and shown in the units of the scene. A scene file: docs/scene-files.md.";

struct Words {
  std::string method = "virtual-work";
  std::string seek = "nearest";
};

/// The index of a word among those that an option knows.
std::size_t choose(const std::string& option, const std::string& word, const std::vector<std::string>& words) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  throw InputError(fmt::format("{}: expected {}, found \"{}\"{}", option, fmt::join(words, " or "), word,
                               did_you_mean(word, words)));
}

void add_scene(CLI::App& command, Request& request) {
  command.add_option("SCENE", request.scene, "Scene file (TOML)")->required()->type_name("");
  command
      .add_option("--set", request.settings,
                  "Change a number of the scene, in its own units: load.P=40,\n"
                  "body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;\n"
                  "can be given several times")
      ->type_name("PATH=NUMBER")
      ->allow_extra_args(false);
}

void add_outputs(CLI::App& command, Request& request, Words& words) {
  command
      .add_option("--seek", words.seek, "nearest: any equilibrium near the start (the default);\nstable: minima only")
      ->type_name("WHAT");
  command.add_option("--json", request.json, "Write the result to FILE as JSON")->type_name("FILE");
  command.add_option("--svg", request.svg, "Draw it at rest, with loads and reactions, into FILE")->type_name("FILE");
}

std::string first_line(std::string_view text) { return one_line(text.substr(0, text.find('\n'))); }

int complain(const std::string& line) {
  fmt::print(stderr, "{}\n", one_line(line));
  return bad_input;
}

/// What CLI11 would only call "required": no command, or one that is misspelt.
void expect_command(int argc, const char* const* argv) {
  const std::vector<std::string> commands = {"check", "solve", "compare"};
  const std::string expected = "expected a command: check, solve or compare";
  if (argc < 2) throw InputError("poise: " + expected + "; poise --help tells more");
  const std::string word = argv[1];
  if (word.starts_with('-') || std::find(commands.begin(), commands.end(), word) != commands.end()) return;
  throw InputError(fmt::format("poise: {}, found \"{}\"{}", expected, word, did_you_mean(word, commands)));
}

/// Names the first word of the command line that the command has no use for.
std::string unexpected(const CLI::App& command, int argc, const char* const* argv) {
  const std::vector<std::string> extra = command.remaining();
  const auto* word = std::find_if(argv + 1, argv + argc, [&](const std::string& w) {
    return std::find(extra.begin(), extra.end(), w) != extra.end();
  });
  const std::string name = word != argv + argc ? *word : extra.front();
  if (!name.starts_with('-')) return fmt::format("poise: expected one scene, found \"{}\" too", name);
  std::vector<std::string> options;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_lnames().empty()) options.push_back("--" + option->get_lnames().front());
  }
  return fmt::format("poise: {} has no option \"{}\"{}", command.get_name(), name, did_you_mean(name, options));
}

int parse_and_run(int argc, const char* const* argv) {
  Request request;
  Words words;
  CLI::App app("Where planar mechanisms rest, by two independent methods and checked by a third", "poise");
  app.set_version_flag("--version", "poise " POISE_VERSION, "Print the version and leave");
  app.get_formatter()->column_width(34);
  app.footer(examples);
  app.require_subcommand(1);

  CLI::App& check =
      *app.add_subcommand("check", "Tell what a scene is: bodies, joints, mobility, what the model keeps");
  add_scene(check, request);
  CLI::App& solve = *app.add_subcommand("solve", "Find where it rests, by one method");
  add_scene(solve, request);
  solve
      .add_option("--method", words.method,
                  "virtual-work: Newton-Raphson on the equations of virtual\nwork (the default); energy: least energy, "
                  "by Ipopt")
      ->type_name("METHOD");
  add_outputs(solve, request, words);
  CLI::App& compare = *app.add_subcommand("compare", "Find where it rests, by all methods side by side");
  add_scene(compare, request);
  add_outputs(compare, request, words);

  expect_command(argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::ExtrasError&) {
    throw InputError(unexpected(*app.get_subcommands().front(), argc, argv));
  } catch (const CLI::ParseError& error) {
    throw InputError(fmt::format("poise: {}; poise {} --help tells more", first_line(error.what()), argv[1]));
  }
  request.method =
      choose("--method", words.method, {"virtual-work", "energy"}) == 0 ? Method::virtual_work : Method::energy;
  request.seek = choose("--seek", words.seek, {"nearest", "stable"}) == 0 ? Seek::nearest : Seek::stable;

  const Palette palette = Palette::for_stream(stdout);
  if (check.parsed()) return run_check(request, palette);
  if (solve.parsed()) return run_solve(request, palette);
  return run_compare(request, palette);
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

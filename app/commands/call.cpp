#include "app/commands/call.hpp"

#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "model/input_error.hpp"

namespace poise::app {
namespace {

bool is_list(const Option& option) { return std::holds_alternative<std::vector<std::string>*>(option.target); }

void read_options(const Command& command, const std::vector<GivenOption>& options, bool has_scene) {
  for (auto given = options.begin(); given != options.end(); ++given) {
    const Option& option = option_named(command, given->first);
    const bool again = std::any_of(options.begin(), given, [&](const auto& one) { return one.first == given->first; });
    if (again && !is_list(option)) {
      throw InputError(fmt::format("poise: {}: expected once, found several times", option.name));
    }
    read_option(option, given->second);
  }
  for (const Option& option : command.options) {
    const bool is_given =
        std::any_of(options.begin(), options.end(), [&](const auto& one) { return one.first == option.name; });
    if (option.presence != Presence::required || is_given || (has_scene && option.name == "SCENE")) continue;
    throw InputError(fmt::format("poise: {} is required; see poise {} --help", option.name, command.name));
  }
}

}  // namespace

std::string line_of(const std::string& command, const std::vector<GivenOption>& options) {
  std::vector<std::string> words = {command};
  for (const auto& [name, word] : options) {
    if (name.starts_with('-')) words.push_back(name);
    if (!word.empty()) words.push_back(word);
  }
  return line_of(words);
}

void call(const std::string& command, const std::vector<GivenOption>& options, Caller& caller) {
  const std::vector<CommandEntry> commands = all_commands();
  const Command& called = command_named(commands, command);
  if (called.request == nullptr) {
    throw InputError(fmt::format("poise: {} has no result that a program could take", command));
  }
  read_options(called, options, caller.scene != nullptr);
  called.request->line = line_of(command, options);
  called.request->caller = &caller;
  caller.outcome = {};
  caller.outcome.origin = {called.request->command, called.request->line};
  try {
    caller.outcome.code = called.run(Palette{});
  } catch (const AssemblyError& error) {
    caller.outcome.code = not_solved;
    // Where the command has shown what it knows, that stands.
    Line& verdict = caller.outcome.result.verdict;
    if (verdict.text.empty()) verdict = bad(error.what());
  }
}

}  // namespace poise::app

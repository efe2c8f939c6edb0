#include "app/commands/completion.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "app/commands/options.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

bool has_dashes(const Option& option) { return option.name.starts_with('-'); }
bool is_flag(const Option& option) { return std::holds_alternative<bool*>(option.target); }
bool is_repeated(const Option& option) { return std::holds_alternative<std::vector<std::string>*>(option.target); }
/// Whether its word is a list of choices with commas between.
bool is_list_of_choices(const Option& option) { return option.value == "NAMES" && !option.choices.empty(); }

std::vector<std::string> endings_of(const Option& option) {
  std::istringstream words(option.ending);
  return {std::istream_iterator<std::string>(words), {}};
}

std::string choices_of(const Option& option) { return fmt::format("{}", fmt::join(option.choices, " ")); }

/// What an option does, or one of its choices ("settle: ..."), as one line of a list: its part of the help up to a
/// semicolon or to the next choice. Empty where the help says nothing of the choice.
std::string brief(const Option& option, const std::string& choice = "") {
  constexpr std::size_t most = 120;
  const std::string help = " " + one_line(option.help);
  const std::string start = choice.empty() ? " " : " " + choice + ": ";
  if (help.find(start) == std::string::npos) return "";
  const std::size_t begin = help.find(start) + start.size();
  std::size_t end = help.find(';', begin);
  for (const std::string& other : option.choices) end = std::min(end, help.find(" " + other + ": ", begin));
  const std::string text = help.substr(begin, end - begin);
  return text.size() > most ? text.substr(0, text.rfind(' ', most)) + " ..." : text;
}

/// A text with a backslash before these characters.
std::string with_backslashes(std::string_view text, std::string_view characters) {
  std::string out;
  for (const char c : text) {
    if (characters.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

constexpr std::string_view bash_head = R"(# Completion of poise in bash, as poise --completion bash prints it.

_poise_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$cur"); }

# Completes the last of several names with commas between.
_poise_list()
{
    local before=
    [[ $cur == *,* ]] && before=${cur%,*},
    compopt -o nospace 2> /dev/null
    mapfile -t COMPREPLY < <(compgen -P "$before" -W "$1" -- "${cur##*,}")
}

# Offers folders, and files with these endings.
_poise_files()
{
    local ending name=${cur#[\"\']}
    name=${name//\\/}
    compopt -o filenames 2> /dev/null
    mapfile -t COMPREPLY < <(
        compgen -d -- "$name"
        for ending; do [[ $ending == / ]] || compgen -f -X "!*.$ending" -- "$name"; done
    )
}

# Offers options where the word begins with a dash, else the files that the command reads.
_poise_rest()
{
    if [[ $cur == -* ]]; then
        _poise_words "$2"
    elif [[ $1 ]]; then
        _poise_files $1
    fi
}

_poise()
{
    local cur=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD - 1]}
    # Bash splits --option=word into three words.
    if [[ $cur == = ]]; then
        cur=
    elif [[ $option == = ]]; then
        option=${COMP_WORDS[COMP_CWORD - 2]}
    fi
    COMPREPLY=()
    if ((COMP_CWORD == 1)); then
        _poise_words "$_poise_commands --help --version --completion"
        return
    fi
    case ${COMP_WORDS[1]} in
)";

/// What bash does for the word behind an option.
std::string bash_action(const Option& option) {
  if (is_list_of_choices(option)) return fmt::format(" _poise_list \"{}\"", choices_of(option));
  if (!option.choices.empty()) return fmt::format(" _poise_words \"{}\"", choices_of(option));
  return option.ending.empty() ? "" : " _poise_files " + option.ending;
}

std::string bash_script(const std::vector<CommandEntry>& commands) {
  std::string names, cases;
  for (const CommandEntry& entry : commands) {
    std::string words, options = "--help", read;
    for (const Option& option : entry.command.options) {
      if (!has_dashes(option)) {
        if (!option.ending.empty()) read = option.ending;
        continue;
      }
      options += " " + option.name;
      if (!is_flag(option)) words += fmt::format("                {}){} ;;\n", option.name, bash_action(option));
    }
    names += (names.empty() ? "" : " ") + entry.command.name;
    cases += fmt::format(
        "        {})\n            case $option in\n{}                *) _poise_rest \"{}\" \"{}\" ;;\n            esac "
        ";;\n",
        entry.command.name, words, read, options);
  }
  return fmt::format("{}        --completion) _poise_words \"{}\" ;;\n{}    esac\n}}\n\n_poise_commands=\"{}\"\n",
                     bash_head, fmt::join(completed_shells(), " "), cases, names) +
         "complete -F _poise poise\n";
}

/// A text within single quotes.
std::string zsh_quoted(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out;
}

/// A text within a specification of _arguments.
std::string zsh_text(const std::string& text) { return zsh_quoted(with_backslashes(text, "\\[]:")); }

/// The choices of an option, each with what it does: (settle\:"..." any\:"...").
std::string zsh_choices(const Option& option) {
  std::string out;
  for (const std::string& choice : option.choices) {
    const std::string what = zsh_quoted(with_backslashes(brief(option, choice), "\\:\"$`"));
    out += fmt::format("{}{}\\:\"{}\"", out.empty() ? "" : " ", choice, what);
  }
  return "(" + out + ")";
}

/// What zsh does for the word of an option: "message:action".
std::string zsh_action(const Option& option) {
  std::string action = " ";
  if (is_list_of_choices(option)) {
    action = fmt::format("_sequence compadd - {}", choices_of(option));
  } else if (!option.choices.empty()) {
    action = fmt::format("({})", zsh_choices(option));
  } else if (option.ending == "/") {
    action = "_files -/";
  } else if (!option.ending.empty()) {
    const std::vector<std::string> endings = endings_of(option);
    action = endings.size() == 1 ? fmt::format("_files -g \"*.{}\"", option.ending)
                                 : fmt::format("_files -g \"*.({})\"", fmt::join(endings, "|"));
  }
  return fmt::format("{}:{}", zsh_text(option.value.empty() ? option.name : option.value), action);
}

std::string zsh_script(const std::vector<CommandEntry>& commands) {
  std::string names, cases;
  for (const CommandEntry& entry : commands) {
    names += fmt::format("        '{}:{}'\n", entry.command.name, zsh_text(entry.command.help));
    cases += fmt::format("                {})\n                    _arguments \\\n", entry.command.name);
    for (const Option& option : entry.command.options) {
      const std::string_view each_time = is_repeated(option) ? "*" : "";
      std::string specification;
      if (!has_dashes(option)) {
        specification = fmt::format("{}:{}", is_repeated(option) ? "*" : "1", zsh_action(option));
      } else if (is_flag(option)) {
        specification = fmt::format("{}[{}]", option.name, zsh_text(brief(option)));
      } else {
        specification =
            fmt::format("{}{}=[{}]:{}", each_time, option.name, zsh_text(brief(option)), zsh_action(option));
      }
      cases += fmt::format("                        '{}' \\\n", specification);
    }
    cases += "                        '--help[Print the help of this command]' ;;\n";
  }
  return fmt::format(R"(#compdef poise
# Completion of poise in zsh, as poise --completion zsh prints it.

_poise() {{
    local -a subcommands=(
{}    )
    local curcontext=$curcontext state line
    local -A opt_args
    _arguments -C \
        '(- *)--help[Print the help]' \
        '(- *)--version[Print the version]' \
        '(- *)--completion=[Print the completion of a shell]:SHELL:({})' \
        '1:command:->command' \
        '*::word:->words'
    case $state in
        command) _describe command subcommands ;;
        words)
            case $words[1] in
{}            esac ;;
    esac
}}

# compinit calls this file as a function; otherwise it is read with source.
if [[ $funcstack[1] == _poise ]]; then
    _poise "$@"
else
    compdef _poise poise
fi
)",
                     names, fmt::join(completed_shells(), " "), cases);
}

std::string fish_text(const std::string& text) { return "'" + with_backslashes(text, "\\'") + "'"; }

/// The choices of an option, each with a tab and what it does.
std::string fish_choices(const Option& option) {
  std::string out;
  for (const std::string& choice : option.choices) {
    out += fmt::format("{}{}\\t{}", out.empty() ? "" : " ", choice, fish_text(brief(option, choice)));
  }
  return out;
}

std::string fish_files(const Option& option) {
  std::string out;
  for (const std::string& ending : endings_of(option)) {
    out += fmt::format("{}__fish_complete_suffix .{}", out.empty() ? "" : "; ", ending);
  }
  return " -k -a '(" + out + ")'";
}

/// What fish does for the word of an option.
std::string fish_action(const Option& option) {
  if (is_list_of_choices(option)) return fmt::format(" -x -a '(__fish_append , {})'", choices_of(option));
  if (!option.choices.empty()) return " -x -a " + fish_text(fish_choices(option));
  if (option.ending == "/") return " -x -a '(__fish_complete_directories)'";
  if (!option.ending.empty()) return " -x" + fish_files(option);
  return " -x";
}

std::string fish_script(const std::vector<CommandEntry>& commands) {
  std::string out = fmt::format(R"(# Completion of poise in fish, as poise --completion fish prints it.

function __poise_begins
    test (count (commandline -opc)) -eq 1
end

function __poise_does
    set -l words (commandline -opc)
    test (count $words) -gt 1; and test $words[2] = $argv[1]
end

complete -c poise -f
complete -c poise -l help -d 'Print the help'
complete -c poise -n __poise_begins -l version -d 'Print the version'
complete -c poise -n __poise_begins -l completion -x -a '{}' -d 'Print the completion of a shell'
)",
                                fmt::join(completed_shells(), " "));
  for (const CommandEntry& entry : commands) {
    out += fmt::format("complete -c poise -n __poise_begins -a {} -d {}\n", entry.command.name,
                       fish_text(entry.command.help));
  }
  for (const CommandEntry& entry : commands) {
    for (const Option& option : entry.command.options) {
      const std::string condition = fmt::format("complete -c poise -n '__poise_does {}'", entry.command.name);
      if (has_dashes(option)) {
        out += fmt::format("{} -l {}{} -d {}\n", condition, option.name.substr(2),
                           is_flag(option) ? "" : fish_action(option), fish_text(brief(option)));
      } else if (!option.ending.empty()) {
        out += fmt::format("{}{}\n", condition, fish_files(option));
      }
    }
  }
  return out;
}

}  // namespace

std::vector<std::string> completed_shells() { return {"bash", "zsh", "fish"}; }

std::string completion_script(const std::string& shell, const std::vector<CommandEntry>& commands) {
  constexpr std::string (*scripts[])(const std::vector<CommandEntry>&) = {bash_script, zsh_script, fish_script};
  return scripts[chosen("--completion", shell, completed_shells())](commands);
}

}  // namespace poise::app

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/terminal/palette.hpp"

namespace poise::app {

struct Request;

/// Where the value of an option goes: a flag sets the bool, a list takes one value each time the option is given, an
/// optional stays empty where the option is not given, all others keep what they held.
using OptionTarget = std::variant<bool*, int*, std::uint64_t*, double*, std::string*, std::vector<std::string>*,
                                  std::optional<int>*, std::optional<double>*, std::optional<std::string>*>;

enum class Presence { optional, required };

/// What an option is to a program that runs the command in place of a person at a terminal: a part of the question, a
/// file that is read, or where the result goes and how it is printed.
enum class Use { question, file_read, output };

/// An option of a command, or, where its name has no dashes, a word without a name: the file it reads, say. A list
/// without dashes takes all such words.
struct Option {
  std::string name;  ///< "--seed", "SCENE"
  OptionTarget target;
  std::string value;  ///< what the help calls the value: "N"; empty for a flag and a word without a name
  std::string help;   ///< its lines as the help shows them
  Presence presence = Presence::optional;
  std::vector<std::string> choices = {};  ///< the words that it knows; empty: any
  std::string ending = {};                ///< how a file ends that it reads or writes: "csv"; "/" for a folder
  Use use = Use::question;

  void reads(std::string end_of_name) { is_file(std::move(end_of_name), Use::file_read); }
  void writes(std::string end_of_name) { is_file(std::move(end_of_name), Use::output); }

 private:
  void is_file(std::string end_of_name, Use file_use) {
    ending = std::move(end_of_name);
    use = file_use;
  }
};

/// A command of `poise`: its part of the command line, and what to do once that has been read. run() prints its report
/// on standard output in the palette, writes the files asked for and returns the exit code; bad input is thrown as
/// InputError. It owns what the options write to.
struct Command {
  std::string name, help;
  std::vector<Option> options = {};  ///< in the order of the help
  std::function<int(const Palette&)> run = {};
  Request* request = nullptr;  ///< where the command line and the caller go before run(); null: nowhere

  Option& add(Option option) { return options.emplace_back(std::move(option)); }
};

/// "flag", "text", "list", "number" or "whole number".
const char* kind_of(const Option& option);

/// Reads the word given to an option into its target; a flag, which takes none, is set. Throws InputError naming it.
void read_option(const Option& option, const std::string& word);

}  // namespace poise::app

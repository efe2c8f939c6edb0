#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/commands/command.hpp"
#include "app/commands/commands.hpp"
#include "statics/equilibrium.hpp"

namespace poise::app {

/// What every command that reads a scene takes: SCENE and --set. `request` must outlive the command.
void add_scene_options(Command& command, Request& request);
/// --set alone, for commands that read a scene through another file.
void add_settings(Command& command, Request& request);

/// What every command that has a result takes: --json, --csv and --svg where a text says what they hold, --markdown,
/// --quiet and --verbose.
struct FileHelp {
  std::string svg{}, csv{};  ///< empty: the command has none
};
void add_output_options(Command& command, Request& request, const FileHelp& help);

/// --seek; its word goes to `seek`, which must outlive the command.
void add_seek_option(Command& command, std::string& seek);
/// nearest or stable. Throws InputError.
Seek read_seek(const std::string& word);

/// The place of a word among those that an option knows. Throws InputError naming them, with the nearest.
std::size_t chosen(const std::string& option, const std::string& word, const std::vector<std::string>& words);

}  // namespace poise::app

#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "app/commands/commands.hpp"

namespace poise::app {

/// What every command that reads a scene takes: SCENE and --set. `request` must outlive the command.
void add_scene_options(CLI::App& command, Request& request);

/// A number given to a name: "boom=0.5".
struct NamedNumber {
  std::string name;
  double value = 0.0;
};

/// Reads the "NAME=NUMBER" of an option. Throws InputError naming the option and the example.
NamedNumber read_named_number(const std::string& option, const std::string& text, const std::string& example);

}  // namespace poise::app

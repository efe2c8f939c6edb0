#pragma once

// Items of a scene's text on their way into the file of a part. Private to model/.

#include <set>
#include <string>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "model/toml_edits.hpp"

namespace poise {

/// What a part's file gets of a scene's document.
struct GroupedItems {
  std::vector<std::pair<std::string, const toml::table*>> tables;  ///< with their headers, "[body.crank]", "[[pin]]"
  std::set<std::string> ground_points;                             ///< at which it is held
  std::set<std::string> guessed;                                   ///< bodies and travels, as [start] calls them
  std::set<const toml::node*> names;                               ///< strings that are no expressions
};

/// The text of the part's file: tables and comments as they stand in the scene's text. In front are gravity, units, the
/// numbers that expressions need and the points of the ground, so that it is a scene for itself; `numbers` becomes
/// these numbers as a table [[part]] gives them.
std::string text_of_part(const GroupedItems& items, const toml::table& document, const std::string& ground,
                         const TomlEdits& text, TomlKeys& numbers);

/// A table as it stands in a text, under its header, with its comment. Throws InputError where dotted keys make it.
std::string written_table(const toml::table& table, const std::string& header, const TomlEdits& text);

}  // namespace poise

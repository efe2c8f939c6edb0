#pragma once

#include <string>

#include "app/result/result.hpp"

namespace poise::app {

/// A result as a page in Markdown: title, source, verdict, warnings, sections, tables, at the level of detail that text
/// has; tables in full.
std::string markdown_text(const Result& result, Verbosity level = Verbosity::normal);

}  // namespace poise::app

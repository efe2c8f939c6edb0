#pragma once

#include <string>

#include "app/result/result.hpp"
#include "app/terminal/palette.hpp"

namespace poise::app {

/// A result as text: title and source, the verdict, warnings, then the content as far as the level goes; quiet:
/// verdict and warnings alone. Lines end with "\n"; tables are indented by two blanks, their columns aligned, words to
/// the left, numbers to the right.
std::string plain_text(const Result& result, const Palette& palette, Verbosity level = Verbosity::normal);

}  // namespace poise::app

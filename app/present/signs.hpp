#pragma once

#include <string>

namespace poise::app {

/// A text as print has it: "±" for "+-", and a minus sign for the hyphen before a number. Names keep their hyphens.
std::string with_true_signs(const std::string& text);

}  // namespace poise::app

#pragma once

#include <string_view>

namespace poise::app {

/// What a word means to the reader; a terminal shows it by a colour.
enum class Tone { plain, strong, good, bad, doubtful, faint };

/// "plain", "strong", ...: its name in documents.
std::string_view name_of(Tone tone);

}  // namespace poise::app

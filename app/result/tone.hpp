#pragma once

namespace poise::app {

/// What a word means to the reader; a terminal shows it by a colour.
enum class Tone { plain, strong, good, bad, doubtful, faint };

}  // namespace poise::app

#pragma once

#include <cstdio>
#include <string>

#include "app/result/tone.hpp"

namespace poise::app {

/// Colours the output of a terminal, and leaves what goes anywhere else alone.
class Palette {
 public:
  /// Without colours.
  Palette() = default;
  /// With colours when the stream is a terminal, NO_COLOR is unset or empty, and TERM is not "dumb".
  static Palette for_stream(std::FILE* stream);

  std::string paint(Tone tone, const std::string& text) const;

 private:
  bool coloured_ = false;
};

}  // namespace poise::app

#pragma once

#include <cstdio>
#include <string>

#include "app/result/tone.hpp"

namespace poise::app {

/// Colours for the output on a terminal; no colours anywhere else.
class Palette {
 public:
  /// Without colours.
  Palette() = default;
  /// With colours when the stream is a terminal, NO_COLOR is unset or empty, and TERM is not "dumb". Not under mpirun,
  /// which gives ranks terminals of its own and may write what they print into a file.
  static Palette for_stream(std::FILE* stream);

  std::string paint(Tone tone, const std::string& text) const;

 private:
  bool coloured_ = false;
};

}  // namespace poise::app

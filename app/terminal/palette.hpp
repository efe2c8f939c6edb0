#pragma once

#include <cstdio>
#include <string>

#include "app/result/tone.hpp"

namespace poise::app {

/// Colours and signs for the output on a terminal; plain ASCII signs and no colours anywhere else.
class Palette {
 public:
  /// Without colours.
  Palette() = default;
  /// With colours when the stream is a terminal, NO_COLOR is unset or empty, and TERM is not "dumb". Not under mpirun,
  /// which gives ranks terminals of its own and may write what they print into a file.
  static Palette for_stream(std::FILE* stream);

  /// With the signs of print and without colours: what a terminal shows whose locale is UTF-8.
  static Palette with_signs();

  std::string paint(Tone tone, const std::string& text) const;
  /// Whether "±" and a minus sign can be shown: on a terminal whose locale is UTF-8.
  bool has_true_signs() const { return true_signs_; }

 private:
  bool coloured_ = false, true_signs_ = false;
};

}  // namespace poise::app

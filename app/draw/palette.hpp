#pragma once

// Every colour that drawings and charts use, each with one meaning, for light and dark pages.

#include <cstddef>
#include <string>
#include <string_view>

namespace poise::app {

/// A colour by its meaning.
enum class Colour : unsigned char {
  none,     ///< not drawn
  paper,    ///< what everything is drawn on, and what is hollow
  text,     ///< of plain labels
  dark,     ///< outlines, ground, text
  ground,   ///< hatching, remarks of charts
  ghost,    ///< other positions
  shadow,   ///< fills of other positions
  support,  ///< fills of supports and of what is fixed to the ground
  load,
  reaction,
  drive,
  spring,
  slack,
  damper,
  stop,  ///< an active one
  free_stop,
  faint,  ///< remarks
  good,
  bad,
  doubtful,
  grid,  ///< of charts
  zero,  ///< axes of charts
  band,  ///< shaded strips of charts
  body_1,
  body_2,
  body_3,
  body_4,
  body_5,
  body_6,
  body_7,
  body_8,
  body_9,
  curve_1,
  curve_2,
  curve_3,
  curve_4,
  curve_5,
  curve_6,
  curve_7,
  count
};

namespace ink {
using enum Colour;
}

/// Its name in documents: "free-stop".
std::string_view name_of(Colour colour);
/// As CSS and SVG write it, on light pages and in SVG files.
std::string_view light_value(Colour colour);
/// The same on dark pages.
std::string_view dark_value(Colour colour);

/// Fill of the i-th body. They repeat.
Colour body_colour(int i);

/// How many colours of curves there are.
inline constexpr std::size_t curve_colours = 7;
/// Colour of the i-th curve, after Okabe and Ito in an order in which neighbours differ most, for the colour-blind too:
/// by at least 55 in CIE L*a*b*, and by at least 45 as seen with protanopia or deuteranopia. They repeat.
Colour curve_colour(std::size_t i);

/// The whole palette as JSON text: {"load": ["#c8202b", "#ff7a80"], ...}, light and dark.
std::string palette_json();

}  // namespace poise::app

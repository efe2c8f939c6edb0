#pragma once

// Sizes of a picture for print and screen, px.

namespace poise::app::sheet {

inline constexpr double width = 900.0;
inline constexpr double margin = 28.0;
inline constexpr double text_size = 11.0;

}  // namespace poise::app::sheet

#include "app/draw/palette.hpp"

#include <array>

#include <fmt/format.h>

namespace poise::app {
namespace {

struct PaletteEntry {
  Colour colour;
  std::string_view name, light, dark;
};

constexpr std::array<PaletteEntry, static_cast<std::size_t>(Colour::count)> palette_table = {{
    {ink::none, "none", "none", "none"},
    {ink::paper, "paper", "white", "#14181d"},
    {ink::text, "text", "#222b33", "#e3e8ec"},
    {ink::dark, "dark", "#2b343c", "#d5dbe0"},
    {ink::ground, "ground", "#59636c", "#9aa5ae"},
    {ink::ghost, "ghost", "#d3d8dd", "#3a434b"},
    {ink::shadow, "shadow", "#f1f3f5", "#1f252b"},
    {ink::support, "support", "#eef1f3", "#262d34"},
    {ink::load, "load", "#c8202b", "#ff7a80"},
    {ink::reaction, "reaction", "#1f5fb4", "#74aefc"},
    {ink::drive, "drive", "#a3247f", "#f08ad0"},
    {ink::spring, "spring", "#2f7d4f", "#62c68b"},
    {ink::slack, "slack", "#8fa99a", "#6c8577"},
    {ink::damper, "damper", "#7a4fa3", "#bf9af0"},
    {ink::stop, "stop", "#b65a00", "#f39a3d"},
    {ink::free_stop, "free-stop", "#a9b0b7", "#5e6870"},
    {ink::faint, "faint", "#68717a", "#8f9aa4"},
    {ink::good, "good", "#24744a", "#62c68b"},
    {ink::bad, "bad", "#c8202b", "#ff7a80"},
    {ink::doubtful, "doubtful", "#8f5400", "#e8b04a"},
    {ink::grid, "grid", "#e6eaee", "#2a3138"},
    {ink::zero, "zero", "#b9c0c7", "#525c65"},
    {ink::band, "band", "#eef3f8", "#1c2733"},
    {ink::body_1, "body-1", "#9fb1c4", "#5f7891"},
    {ink::body_2, "body-2", "#d3b27c", "#94763c"},
    {ink::body_3, "body-3", "#93b795", "#57805b"},
    {ink::body_4, "body-4", "#bf9fc0", "#86628a"},
    {ink::body_5, "body-5", "#b7b48a", "#7d7a4c"},
    {ink::body_6, "body-6", "#dba58f", "#a2664d"},
    {ink::body_7, "body-7", "#8fbcc0", "#4f8388"},
    {ink::body_8, "body-8", "#c7b8a3", "#8b7a60"},
    {ink::body_9, "body-9", "#a9a7cf", "#6e6b9c"},
    {ink::curve_1, "curve-1", "#0072b2", "#4a8ff0"},
    {ink::curve_2, "curve-2", "#e69f00", "#f0b429"},
    {ink::curve_3, "curve-3", "#cc79a7", "#e08fd0"},
    {ink::curve_4, "curve-4", "#d55e00", "#f0602a"},
    {ink::curve_5, "curve-5", "#2b343c", "#f6f7f8"},
    {ink::curve_6, "curve-6", "#56b4e9", "#45acff"},
    {ink::curve_7, "curve-7", "#009e73", "#1fb97f"},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < palette_table.size(); ++i) {
    if (static_cast<std::size_t>(palette_table[i].colour) != i) return false;
  }
  return true;
}
static_assert(in_order());

const PaletteEntry& entry(Colour colour) { return palette_table[static_cast<std::size_t>(colour)]; }

Colour nth_from(Colour first, std::size_t i) { return static_cast<Colour>(static_cast<std::size_t>(first) + i); }

}  // namespace

std::string_view name_of(Colour colour) { return entry(colour).name; }

std::string_view light_value(Colour colour) { return entry(colour).light; }

std::string_view dark_value(Colour colour) { return entry(colour).dark; }

Colour body_colour(int i) {
  constexpr int body_colours = 9;
  return nth_from(ink::body_1, static_cast<std::size_t>(i % body_colours));
}

Colour curve_colour(std::size_t i) { return nth_from(ink::curve_1, i % curve_colours); }

std::string palette_json() {
  std::string text;
  for (const PaletteEntry& e : palette_table) {
    if (e.colour == ink::none) continue;
    // Pages take colours by their numbers, SVG files have the word.
    const std::string_view light = e.light == "white" ? "#ffffff" : e.light;
    text += fmt::format("{}\"{}\":[\"{}\",\"{}\"]", text.empty() ? "" : ",", e.name, light, e.dark);
  }
  return "{" + text + "}";
}

}  // namespace poise::app

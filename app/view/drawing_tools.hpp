#pragma once

// The tools by which a mechanism is drawn: what each picks, and what it writes into the scene's text.

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/mechanism.hpp"
#include "model/planar.hpp"
#include "model/scene_text.hpp"

namespace poise::app {

/// What a tool asks for at a place of the plane.
enum class Pick {
  place,      ///< the place itself
  point,      ///< a point there: one that is, or a new one of the body there, or of the ground
  moving,     ///< the same of a moving body
  body,       ///< a body there, or the ground
  link,       ///< a moving body there
  slide,      ///< a slide, or pin in a slot, there
  direction,  ///< the direction from the place before
};

/// A tool of the page.
struct DrawingTool {
  std::string_view name;   ///< "spring"
  std::string_view title;  ///< "Spring"
  std::string_view group;  ///< of the toolbar: "Bodies", "Joints", ...
  std::string_view table;  ///< of the scene file that it writes; empty of what is none of a list
  std::vector<Pick> picks;
  bool more = false;      ///< of the last pick there may be any number
  std::string_view keys;  ///< lines of that table; names in braces stand for what was picked and for first numbers
  std::string_view hint;  ///< one sentence: what to click
};

/// All of them, in the order of the toolbar. Every table of a scene file by which items are made has one.
std::span<const DrawingTool> drawing_tools();

/// What was drawn with a tool.
struct Drawn {
  std::string tool;
  std::vector<Vec2> places;                     ///< m, in the world: where something new comes, on a grid perhaps
  std::vector<Vec2> pressed;                    ///< m: where the hand was, by which points and bodies are meant
  std::vector<bool> is_typed;                   ///< exactly there: points and bodies near a place are not meant
  double within = 0.0;                          ///< m: as far from a place a point or a body is meant
  double grain = 0.0;                           ///< m: numbers are rounded to multiples of it
  std::map<std::string, std::string> values{};  ///< by key, as TOML, in place of first numbers; "name" of the new item
};

/// Writes what was drawn into the text of a scene that stands in these poses. Returns the name of the new item, as in
/// SceneText::items(). Throws InputError, with the text as it was, where nothing can be drawn so.
std::string draw(SceneText& text, const std::vector<BodyPose<double>>& poses, const Drawn& drawn);

}  // namespace poise::app

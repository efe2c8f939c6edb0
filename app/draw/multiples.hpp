#pragma once

#include <string>
#include <vector>

#include "app/draw/mechanism.hpp"

namespace poise::app {

/// One of several small pictures of a mechanism.
struct Multiple {
  std::string caption;
  const Scene* scene = nullptr;  ///< those of all pictures have the same bodies
  Poses poses;
  Colour colour = Colour::none;  ///< of the caption; none: that of all text
};

/// Pictures of a mechanism in several positions side by side, without labels and loads, in the same scale and frame,
/// as an SVG document 900 px wide. There is one picture at least.
std::string draw_multiples(const std::vector<Multiple>& multiples);

}  // namespace poise::app

#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"

namespace poise::app {

/// The panels of one of several scenes.
struct LabelledPanels {
  std::string label;
  std::vector<Panel> panels;
};

/// The same panels of several scenes in one chart each: all curves of a scene in its own colour, under its label, what
/// is drawn otherwise than its first curve ("unstable") named behind it. Without marks and arrows.
std::vector<Panel> panels_beside(const std::vector<LabelledPanels>& scenes);

}  // namespace poise::app

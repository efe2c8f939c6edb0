#pragma once

#include <string>
#include <vector>

namespace poise::app {

/// A mark of a chart at its place on the page, px, y downwards.
struct PlacedMark {
  double x = 0.0, y = 0.0;
  std::string label{};
};

/// A rectangle on the page, px.
struct PageBox {
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;
};

/// The text beside a mark, and the rectangle that it takes.
struct MarkLabel {
  std::string text;
  PageBox box{};
};

/// Texts for the marks of a chart, none over another or over a mark where there is room: marks in the same place have
/// one text, each other text stands on that side of its mark which is free, within the graph.
std::vector<MarkLabel> mark_labels(const std::vector<PlacedMark>& marks, const PageBox& graph, double text_size);

}  // namespace poise::app

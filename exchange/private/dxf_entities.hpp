#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/planar.hpp"

namespace poise {

/// What a drawing has: the points of each layer, in their order.
struct DxfDrawing {
  struct Point {
    std::string layer;
    Vec2 at{};
    int line = 0;
  };
  std::vector<Point> points;
  std::optional<int> units;  ///< $INSUNITS, where it is not 0
  int labels = 0;            ///< texts, dimensions, hatches
  int on_paper = 0;          ///< what is not in the model but on its sheets
};

/// Reads group codes and values, a line each, of a DXF in text. Throws InputError for what is no such file, and for
/// entities that lie not in the plane or are curves other than arcs and circles.
DxfDrawing read_dxf(std::string_view text, const std::string& file);

}  // namespace poise

#include "app/draw/chart/mark_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/draw/canvas.hpp"

namespace poise::app {
namespace {

constexpr double same_mark = 4.0;    // px, between marks that share a text
constexpr double mark_radius = 3.0;  // px
constexpr double beside_mark = 5.0;  // px, from the mark to its text

double shared(double from, double to, double other_from, double other_to) {
  return std::max(0.0, std::min(to, other_to) - std::max(from, other_from));
}

double overlap(const PageBox& a, const PageBox& b) {
  return shared(a.left, a.right, b.left, b.right) * shared(a.top, a.bottom, b.top, b.bottom);
}

double area_outside(const PageBox& box, const PageBox& graph) {
  return (box.right - box.left) * (box.bottom - box.top) - overlap(box, graph);
}

std::vector<PlacedMark> joined(const std::vector<PlacedMark>& marks) {
  std::vector<PlacedMark> out;
  for (const PlacedMark& mark : marks) {
    const auto there = std::find_if(out.begin(), out.end(), [&](const PlacedMark& other) {
      return std::hypot(mark.x - other.x, mark.y - other.y) < same_mark;
    });
    if (there == out.end())
      out.push_back(mark);
    else
      there->label += ", " + mark.label;
  }
  return out;
}

/// Where the text of a mark may stand, the best first: up, then down, at both sides; above and below; farther away.
std::vector<PageBox> places_beside(const PlacedMark& mark, double width, double height) {
  std::vector<PageBox> out;
  for (const double away : {beside_mark, beside_mark + height, beside_mark + 2 * height}) {
    const std::array<std::array<double, 2>, 8> middles = {{{away + width / 2, -height / 2},
                                                           {-away - width / 2, -height / 2},
                                                           {away + width / 2, height / 2},
                                                           {-away - width / 2, height / 2},
                                                           {0.0, -away - height / 2},
                                                           {0.0, away + height / 2},
                                                           {away + width / 2, -away - height / 2},
                                                           {-away - width / 2, away + height / 2}}};
    for (const auto& [dx, dy] : middles) {
      out.push_back(
          {mark.x + dx - width / 2, mark.x + dx + width / 2, mark.y + dy - height / 2, mark.y + dy + height / 2});
    }
  }
  return out;
}

}  // namespace

std::vector<MarkLabel> mark_labels(const std::vector<PlacedMark>& marks, const PageBox& graph, double text_size) {
  const std::vector<PlacedMark> own = joined(marks);
  std::vector<PageBox> taken;
  for (const PlacedMark& mark : own) {
    taken.push_back({mark.x - mark_radius, mark.x + mark_radius, mark.y - mark_radius, mark.y + mark_radius});
  }
  std::vector<MarkLabel> out;
  for (const PlacedMark& mark : own) {
    const auto cost = [&](const PageBox& box) {
      double sum = area_outside(box, graph);
      for (const PageBox& other : taken) sum += overlap(box, other);
      return sum;
    };
    const std::vector<PageBox> places = places_beside(mark, text_width(mark.label, text_size), text_size);
    const auto best = std::min_element(places.begin(), places.end(),
                                       [&](const PageBox& a, const PageBox& b) { return cost(a) + 1e-9 < cost(b); });
    out.push_back({mark.label, *best});
    taken.push_back(*best);
  }
  return out;
}

}  // namespace poise::app

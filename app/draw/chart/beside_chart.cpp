#include "app/draw/chart/beside_chart.hpp"

#include <cstddef>
#include <utility>

namespace poise::app {

std::vector<Panel> panels_beside(const std::vector<LabelledPanels>& scenes) {
  std::vector<Panel> out;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    for (std::size_t p = 0; p < scenes[s].panels.size(); ++p) {
      const Panel& own = scenes[s].panels[p];
      if (p == out.size()) {
        out.push_back({.title = own.title, .x_label = own.x_label, .y_label = own.y_label, .tall = own.tall});
      }
      bool is_first = true;
      for (Curve curve : own.curves) {
        const bool is_warning = curve.style == Curve::Style::crosses;
        curve.name = scenes[s].label + (is_first && !is_warning ? "" : ", " + curve.name);
        if (!is_warning) curve.colour = static_cast<int>(s);
        is_first = is_first && is_warning;
        out[p].curves.push_back(std::move(curve));
      }
    }
  }
  return out;
}

}  // namespace poise::app

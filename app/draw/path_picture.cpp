#include "app/draw/path_picture.hpp"

#include <algorithm>
#include <cstddef>
#include <list>
#include <utility>

#include <fmt/format.h>

#include "app/draw/chart/path_chart.hpp"
#include "app/draw/multiples.hpp"

namespace poise::app {
namespace {

/// The marks that are drawn, in their order: where there are too many, first those at which the mechanism snaps.
std::vector<PathMark> chosen_marks(const std::vector<PathMark>& marks) {
  constexpr std::size_t most = 8;
  std::vector<std::size_t> places;
  for (const bool turns : {true, false}) {
    for (std::size_t i = 0; i < marks.size() && places.size() < most; ++i) {
      if (marks[i].turns == turns) places.push_back(i);
    }
  }
  std::sort(places.begin(), places.end());
  std::vector<PathMark> out;
  for (const std::size_t place : places) out.push_back(marks[place]);
  return out;
}

std::string multiples_of(const VariedScene& varied, const std::vector<PathMark>& marks) {
  PathReader reader(varied);
  std::list<Scene> scenes;  // dimensions may differ
  std::vector<Multiple> multiples;
  for (const PathMark& mark : marks) {
    const StaticModel& model = reader.model(*mark.point);
    Poses poses = model.poses(mark.point->x);
    scenes.push_back(model.scene());
    // A driven measure is no part of the mechanism.
    if (varied.is_driven()) scenes.back().stops.pop_back();
    const bool is_named = mark.label != "start" && mark.label != "end";
    multiples.push_back({(is_named ? mark.label + ": " : "") + mark.caption, &scenes.back(), std::move(poses)});
  }
  return draw_multiples(multiples);
}

}  // namespace

std::string path_picture(const VariedScene& varied, const Path& path, const std::vector<SoughtQuantity>& measures,
                         const std::string& heading, bool confirmed) {
  const PathCharts charts = charts_of(varied, path, measures);
  const std::string chart = draw_plot(charts.panels);
  return stacked(stacked(heading_page(varied.scene(), heading, confirmed, "path of equilibria"), chart),
                 multiples_of(varied, chosen_marks(charts.marks)));
}

}  // namespace poise::app

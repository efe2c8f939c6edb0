#include "app/draw/goals_figures.hpp"

#include <algorithm>
#include <cmath>
#include <list>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/draw/chart/goals_chart.hpp"
#include "app/draw/followed.hpp"
#include "app/draw/frames.hpp"
#include "app/result/numbers.hpp"
#include "model/input_error.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/path_measures.hpp"

namespace poise::app {
namespace {

/// The mechanism in positions that it takes one after the other; a single one at rest.
struct SweptPositions {
  std::list<Scene> scenes{};
  std::vector<Position> positions{};
  std::vector<double> values{};  ///< of what is varied, in its unit; empty at rest
};

SweptPositions swept_positions(const GoalProblem& problem, const Sweep& sweep, const Scene& scene, bool confirmed) {
  SweptPositions out;
  try {
    if (sweep.along.empty()) {
      const StaticModel model(scene);
      const Equilibrium rest = solve(model);
      if (rest.x.empty()) return out;
      out.scenes.push_back(scene);
      out.positions.push_back({.scene = &out.scenes.back(),
                               .picture = {.poses = model.poses(rest.x), .confirmed = confirmed && rest.found()}});
      return out;
    }
    const bool is_one = sweep.first == sweep.last;
    const double beside = 0.01 * std::max(sweep.natural, std::abs(sweep.first)) / sweep.unit;
    const VariedScene varied(scene, sweep.along, sweep.first_shown(),
                             is_one ? sweep.first_shown() + beside : sweep.last_shown());
    PathOptions options;
    options.certify = false;  // the check of the goals has proved what is shown
    const Path found = path(varied, options);
    if (found.branches.empty() || found.branches.front().points.empty()) return out;
    const std::vector<PathPoint>& points = found.branches.front().points;
    PathReader reader(varied);
    for (const std::size_t k : evenly(is_one ? 1 : points.size(), most_frames(problem.scene, false))) {
      const PathPoint& point = points[k];
      out.scenes.push_back(varied.is_driven() ? scene : varied.scene_at(point.parameter));
      const double value = point.parameter / sweep.unit;
      const std::string caption = fmt::format("{} = {}{}{}", sweep.along, significant(value, 4),
                                              sweep.unit_name.empty() ? "" : " ", sweep.unit_name);
      out.positions.push_back(
          {.scene = &out.scenes.back(),
           .picture = {.poses = reader.model(point).poses(point.x), .heading = caption, .confirmed = confirmed}});
      out.values.push_back(value);
    }
  } catch (const InputError&) {
    return {};  // it cannot be assembled, which the check of the goals has said
  }
  return out;
}

/// Both at the first of their positions.
std::optional<Figure> before_beside_after(const SweptPositions& before, const SweptPositions& after) {
  std::vector<Position> both;
  const auto add = [&](const SweptPositions& moves, const std::string& word) {
    if (moves.positions.empty()) return;
    Position position = moves.positions.front();
    const std::string where = position.picture.heading;
    position.picture.heading = word + (where.empty() ? "" : ": " + where);
    both.push_back(std::move(position));
  };
  add(before, "before");
  add(after, "after");
  if (both.size() < 2) return {};
  return Figure{
      .title = "Before and after",
      .drawing = draw_frames(std::move(both), "The mechanism with the numbers given and with those found", false)};
}

bool proves_all(const GoalCheck& check) { return check.points > 0 && check.proved == check.points; }

}  // namespace

std::vector<Figure> goals_figures(const GoalProblem& problem, const GoalDesign& found) {
  std::vector<Figure> out;
  if (!found.scene || problem.sweeps.empty()) return out;
  const Sweep& sweep = problem.sweeps.front();
  const SweptPositions before = swept_positions(problem, sweep, problem.scene, proves_all(found.before));
  SweptPositions after = swept_positions(problem, sweep, *found.scene, proves_all(found.check));
  if (std::optional<Figure> both = before_beside_after(before, after)) out.push_back(std::move(*both));
  std::vector<GoalPanel> panels = goals_panels(problem, found);
  if (after.positions.size() > 1) {
    Figure moving{.title = "As found, over " + sweep.along};
    for (const GoalPanel& one : panels) {
      if (one.sweep != 0) continue;
      moving.charts.panels.push_back(one.panel);
      moving.charts.cursors.push_back({.x = after.values});
    }
    panels.erase(std::remove_if(panels.begin(), panels.end(), [](const GoalPanel& one) { return one.sweep == 0; }),
                 panels.end());
    Play play{.label = sweep.along, .unit = sweep.unit_name, .values = after.values};
    animate(moving, std::move(after.positions), std::move(play), "The mechanism with the numbers found, as it moves",
            {});
    out.push_back(std::move(moving));
  }
  for (GoalPanel& one : panels) {
    const std::string title = one.sweep < 0 ? one.panel.title : "Before and after";
    if (one.sweep < 0) one.panel.title.clear();
    out.push_back({.title = title, .charts = {.panels = {std::move(one.panel)}}});
  }
  return out;
}

}  // namespace poise::app

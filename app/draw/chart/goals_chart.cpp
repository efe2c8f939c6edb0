#include "app/draw/chart/goals_chart.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace poise::app {
namespace {

constexpr int limit_colour = 2;  // of the palette; those before are of the curves before and after

bool is_charted(const GoalProblem& problem, const DesignGoal& goal) {
  const Sweep& sweep = problem.sweeps[static_cast<std::size_t>(goal.sweep)];
  return !sweep.along.empty() && sweep.first != sweep.last && !goal.of.is_over_path() &&
         goal.kind != DesignGoal::Kind::passes;
}

std::string axis_label(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : fmt::format("{} ({})", name, unit);
}

/// A limit over the range of its goal; the first of a panel is in its legend.
void add_limit(Panel& panel, std::vector<double> x, std::vector<double> y) {
  const bool is_named = std::any_of(panel.curves.begin(), panel.curves.end(),
                                    [](const Curve& curve) { return curve.colour == limit_colour; });
  panel.curves.push_back({.name = is_named ? "" : "limits",
                          .x = std::move(x),
                          .y = std::move(y),
                          .style = Curve::Style::dotted,
                          .colour = limit_colour});
}

void add_limits(Panel& panel, const Sweep& sweep, const DesignGoal& goal, double unit) {
  const std::vector<double> ends{goal.first / sweep.unit, goal.last / sweep.unit};
  if (goal.kind == DesignGoal::Kind::none) return;
  if (goal.kind != DesignGoal::Kind::quantity) {
    const char* word = goal.kind == DesignGoal::Kind::stable ? "stable" : "unstable";
    panel.marks.push_back({goal.at.front() / sweep.unit, 0.0, word});
    return;
  }
  if (!goal.curve.empty()) {
    std::vector<double> x, wanted, below, above;
    for (const auto& [at, value] : goal.curve) {
      x.push_back(at / sweep.unit);
      wanted.push_back(value / unit);
      below.push_back((value - goal.within) / unit);
      above.push_back((value + goal.within) / unit);
    }
    if (goal.within > 0.0) {
      add_limit(panel, x, below);
      add_limit(panel, x, above);
    } else {
      panel.curves.push_back({.name = "wanted", .x = x, .y = wanted, .style = Curve::Style::dotted});
    }
    return;
  }
  const auto add = [&](const std::optional<double>& limit, const char* sign) {
    if (!limit) return;
    if (goal.is_range) {
      add_limit(panel, ends, {*limit / unit, *limit / unit});
      return;
    }
    for (const double at : goal.at) panel.marks.push_back({at / sweep.unit, *limit / unit, sign});
  };
  add(goal.least, goal.is_equation ? "=" : "\u2265");
  if (!goal.is_equation) add(goal.most, "\u2264");
}

bool are_alike(const GoalProblem& problem, const DesignGoal& a, const DesignGoal& b) {
  return is_charted(problem, a) && is_charted(problem, b) && a.sweep == b.sweep && a.of.name == b.of.name;
}

/// The goal over the ranges of all goals of one quantity and sweep together; over the whole sweep where these are about
/// a single value.
DesignGoal over_all_alike(const GoalProblem& problem, const DesignGoal& goal) {
  const Sweep& sweep = problem.sweeps[static_cast<std::size_t>(goal.sweep)];
  std::vector<double> ends;
  for (const DesignGoal& other : problem.goals) {
    if (!are_alike(problem, goal, other)) continue;
    ends.insert(ends.end(), other.at.begin(), other.at.end());
    if (other.is_range) ends.insert(ends.end(), {other.first, other.last});
  }
  DesignGoal out = goal;
  out.is_range = true;
  const auto [least, most] = std::minmax_element(ends.begin(), ends.end());
  out.first = *least < *most ? *least : sweep.first;
  out.last = *least < *most ? *most : sweep.last;
  return out;
}

}  // namespace

std::optional<TradedAims> traded_aims(const GoalProblem& problem, const GoalDesign& found) {
  if (found.trade_off.points.empty()) return {};
  TradedAims out;
  for (std::size_t k = 0; k < out.names.size(); ++k) {
    const DesignGoal& goal = problem.goals[static_cast<std::size_t>(found.trade_off.goals[k])];
    constexpr const char* words[] = {"", "greatest ", "least ", "span of ", "distance from the curve of "};
    out.names[k] = words[static_cast<int>(goal.aim)] + goal.of.name;
    out.units[k] = goal.of.dimension.unit_name(problem.scene.units);
    for (const double value : k == 0 ? found.trade_off.first : found.trade_off.second) {
      out.values[k].push_back(value / goal.of.dimension.unit(problem.scene.units));
    }
  }
  return out;
}

std::vector<GoalPanel> goals_panels(const GoalProblem& problem, const GoalDesign& found) {
  std::vector<GoalPanel> out;
  if (!found.scene) return out;
  const Units& units = problem.scene.units;
  for (std::size_t k = 0; k < problem.goals.size(); ++k) {
    const DesignGoal& goal = problem.goals[k];
    if (!is_charted(problem, goal)) continue;
    const auto is_alike = [&](const DesignGoal& other) { return are_alike(problem, goal, other); };
    const auto from = problem.goals.begin(), here = from + static_cast<std::ptrdiff_t>(k);
    if (std::any_of(from, here, is_alike)) continue;  // in the panel of the first of them
    const Sweep& sweep = problem.sweeps[static_cast<std::size_t>(goal.sweep)];
    const double unit = goal.of.dimension.unit(units);
    Panel panel{.title = goal.of.name + " over " + sweep.along,
                .x_label = axis_label(sweep.along, sweep.unit_name),
                .y_label = axis_label(goal.of.name, goal.of.dimension.unit_name(units))};
    const DesignGoal all_over = over_all_alike(problem, goal);
    const auto add = [&](const Scene& scene, const std::string& name, Curve::Style style, int colour) {
      const GoalCourse course = course_of(problem, all_over, scene);
      if (course.at.empty()) return;
      Curve curve{.name = name, .style = style, .colour = colour};
      for (const double at : course.at) curve.x.push_back(at / sweep.unit);
      for (const double value : course.value) curve.y.push_back(value / unit);
      panel.curves.push_back(std::move(curve));
    };
    add(*found.scene, "after", Curve::Style::line, 0);
    add(problem.scene, "before", Curve::Style::dashed, 1);
    if (panel.curves.empty()) continue;
    for (const DesignGoal& other : problem.goals) {
      if (is_alike(other)) add_limits(panel, sweep, other, unit);
    }
    out.push_back({goal.sweep, std::move(panel)});
  }
  const std::optional<TradedAims> traded = traded_aims(problem, found);
  if (!traded) return out;
  Panel panel{.title = "Trade-off",
              .x_label = axis_label(traded->names[0], traded->units[0]),
              .y_label = axis_label(traded->names[1], traded->units[1])};
  panel.curves.push_back({.name = "", .x = traded->values[0], .y = traded->values[1], .style = Curve::Style::marked});
  out.push_back({-1, std::move(panel)});
  return out;
}

}  // namespace poise::app

// poise_design_cost: what an evaluation of a design costs for each position, with the derivatives by all variables,
// beside an equilibrium of the same mechanism: searched and certified by solve(). Exit code 1 where derivatives differ
// from differences of values; times do not affect it.

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "benchmarks/ratio_table.hpp"
#include "benchmarks/timing.hpp"
#include "design/goals/goal_evaluation.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/varied_scene.hpp"

namespace poise::benchmarks {
namespace {

constexpr double limit = 5.0;  // solves
constexpr int times = 200;

/// Whether derivatives agree with differences along all variables together.
bool is_right(GoalEvaluation& evaluation, const DesignPoint& point) {
  constexpr double step = 1e-6, largest_error = 1e-5;
  GoalValues at, before, after;
  DesignPoint low = point, high = point;
  low.parts.array() -= step;
  high.parts.array() += step;
  if (!evaluation.evaluate(point, true, at) || !evaluation.evaluate(low, false, before) ||
      !evaluation.evaluate(high, false, after)) {
    return false;
  }
  for (std::size_t k = 0; k < at.limits.size(); ++k) {
    const double slope = (after.limits[k].c - before.limits[k].c) / (2.0 * step);
    if (std::abs(slope - at.limits[k].by.sum()) > largest_error * std::max(1.0, std::abs(slope))) return false;
  }
  return true;
}

void measure(RatioTable& table, const std::string& name) {
  const GoalProblem problem = read_goals(fmt::format("{}/datasets/{}_design.toml", POISE_SOURCE_DIR, name));
  GoalEvaluation evaluation(problem);
  DesignPoint point = own_point(problem);
  point.parts = point.parts.cwiseMax(0.01).cwiseMin(0.99);
  const Sweep& sweep = problem.sweeps.front();
  const auto positions = static_cast<double>(sweep.at.size());
  const bool right = is_right(evaluation, point);
  GoalValues values;
  double sign = 1e-4;
  const double ours = seconds_of(
                          [&] {
                            sign = -sign;
                            point.parts.array() += sign;
                            evaluation.evaluate(point, true, values);
                          },
                          times) /
                      positions;
  const VariedScene varied(problem.scene, sweep.along, sweep.first_shown(), sweep.last_shown());
  const auto model = varied.model_at(sweep.at[sweep.at.size() / 2]);
  SolveOptions options;
  options.seek = Seek::any;
  const double solves = seconds_of([&] { solve(*model, options); }, times);
  table.ratio(name + ", a position", ours, solves, limit, right, fmt::format("{} variables", problem.variables.size()));
}

}  // namespace
}  // namespace poise::benchmarks

int main() {
  poise::benchmarks::RatioTable table;
  table.head();
  for (const char* name : {"wall_bed", "garage_door", "torque_profile", "bike_suspension", "knee_press"}) {
    poise::benchmarks::measure(table, name);
  }
  return table.all_right() ? 0 : 1;
}

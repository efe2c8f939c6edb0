#include "design/synthesis/path_scene.hpp"

#include <cmath>

#include "design/synthesis/four_bar_scene.hpp"
#include "model/input_error.hpp"
#include "model/scene_builder.hpp"

namespace poise {
namespace {

Scene slider_crank_scene(const PathProblem& problem, const PathSolution& solution, const std::string& title) {
  const PathVector& x = solution.x;
  const PathVisit& visit = solution.visits.front();
  const Units& units = problem.units;
  const double crank = std::exp(x[at_crank]), coupler = std::exp(x[at_coupler]);
  const auto place = [&](const Vec2& si) { return (1 / units.length) * si; };
  const Vec2 pivot{x[at_a], x[at_a + 1]}, arm{x[at_point], x[at_point + 1]}, line = unit(x[at_b]);
  const Vec2 foot = pivot + x[at_b + 1] * quarter_turn(line);
  const Vec2 pin = pivot + crank * unit(visit.angle);
  const Vec2 at = coupler_place(problem.linkage, x, visit.angle, visit.closure).point;
  const Vec2 turned = (at - pin) * conj(arm);
  const double across = std::copysign(
      std::sqrt(std::max(0.0, coupler * coupler - std::pow(dot(foot - pin, quarter_turn(line)), 2))), -visit.closure);
  const Vec2 end = dot(foot - pin, quarter_turn(line)) * quarter_turn(line) + across * line;
  const double angle = norm(arm) > 0.0 ? std::atan2(turned.y, turned.x) : std::atan2(end.y, end.x);
  SceneBuilder builder(title, {.length = units.length_name, .angle = units.angle_name});
  builder.ground_point("A", place(pivot))
      .ground_point("S", place(foot))
      .body("input", {.points = {{"A", {}}, {"C", place({crank, 0.0})}}})
      .body("coupler", {.points = {{"C", {}}, {"D", place({coupler, 0.0})}, {"P", place(arm)}}})
      .pin("ground.A", "input.A")
      .pin("input.C", "coupler.C")
      .pin_in_slot("ground.S", "coupler.D", line, "slide")
      .start("input", visit.angle / units.angle)
      .start("coupler", angle / units.angle);
  return builder.build();
}

}  // namespace

Scene path_scene(const PathProblem& problem, const PathSolution& solution) {
  const std::string title = problem.title.empty() ? problem.file : problem.title;
  if (problem.linkage == PathLinkage::slider_crank) return slider_crank_scene(problem, solution, title);
  const FourBar linkage = four_bar_of(solution.x);
  const auto pose = pose_of(linkage, solution.visits.front().angle, solution.visits.front().closure);
  if (!pose) throw InputError(title + ": expected links that reach each other at the first point");
  return four_bar_scene(linkage, *pose, title, problem.units);
}

}  // namespace poise

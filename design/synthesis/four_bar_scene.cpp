#include "design/synthesis/four_bar_scene.hpp"

#include "model/scene_builder.hpp"

namespace poise {

Scene four_bar_scene(const FourBar& linkage, const FourBarPose& start, const std::string& title, const Units& units) {
  const auto length = [&](double si) { return si / units.length; };
  const auto place = [&](const Vec2& si) { return (1 / units.length) * si; };
  const auto angle = [&](double si) { return si / units.angle; };
  SceneBuilder builder(
      title,
      {.length = units.length_name, .force = units.force_name, .mass = units.mass_name, .angle = units.angle_name});
  builder.ground_point("A", place(linkage.a))
      .ground_point("B", place(linkage.b))
      .body("input", {.points = {{"A", {}}, {"C", {length(linkage.input), 0.0}}}})
      .body("coupler", {.points = {{"C", {}}, {"D", {length(linkage.coupler), 0.0}}, {"P", place(linkage.point)}}})
      .body("output", {.points = {{"B", {}}, {"D", {length(linkage.output), 0.0}}}})
      .pin("ground.A", "input.A")
      .pin("input.C", "coupler.C")
      .pin("coupler.D", "output.D")
      .pin("ground.B", "output.B")
      .start("input", angle(start.input_angle))
      .start("coupler", angle(start.coupler_angle))
      .start("output", angle(start.output_angle));
  return builder.build();
}

}  // namespace poise

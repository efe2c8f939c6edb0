#include "tests/design/lever_designs.hpp"

#include <fmt/format.h>

namespace poise::test {

std::string SprungLever::text() const {
  return fmt::format(R"(title = "lever"
source = "ours"
gravity = [0, {:.17g}]
[ground]
points = {{ O = [0, 0] }}
[body.lever]
points = {{ O = [0, 0], B = [1, 0] }}
mass = {:.17g}
center = [{:.17g}, 0]
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "lever"]
stiffness = {:.17g}
free_angle = {:.17g}
)",
                     -gravity, mass, center, stiffness, free_angle);
}

GoalProblem read_design_text(const app_tests::TempFolder& folder, const std::string& scene, const std::string& design) {
  folder.write("scene.toml", scene);
  return read_goals(folder.write("design.toml", "scene = \"scene.toml\"\n" + design));
}

GoalDesign design_of(const app_tests::TempFolder& folder, const std::string& scene, const std::string& design,
                     GoalSearchOptions options) {
  options.jobs = 1;
  return design_for_goals(read_design_text(folder, scene, design), options);
}

}  // namespace poise::test

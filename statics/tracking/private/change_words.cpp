#include "statics/tracking/private/change_words.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace poise {

std::string place_in_words(const VariedScene& varied, double part) {
  constexpr std::size_t most_named = 2;
  std::vector<ParameterPlace> places;
  for (const VariedScene::Course& course : varied.courses()) places.push_back(course.place);
  for (const VariedScene::VectorCourse& course : varied.vector_courses())
    places.push_back({Owner::force, course.force});
  if (places.size() > most_named) return fmt::format("{:.4g} % of the change", 100.0 * part);
  const Scene scene = varied.scene_at(part);
  std::string out;
  for (const ParameterRow& row : parameter_table(scene)) {
    if (std::find(places.begin(), places.end(), row.place) == places.end()) continue;
    const std::string unit = row.dimension.unit_name(scene.units);
    out += fmt::format("{}{} = {:.6g}{}{}", out.empty() ? "" : " and ", row.path.text(),
                       value_at(scene, row.place).value_or(0.0) / row.dimension.unit(scene.units),
                       unit.empty() ? "" : " ", unit);
  }
  return out;
}

}  // namespace poise

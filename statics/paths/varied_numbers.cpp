#include "statics/paths/varied_numbers.hpp"

#include <algorithm>
#include <utility>

#include "model/dependent_number.hpp"

namespace poise {
namespace {

/// The scene gets its one-way springs in the states that are given.
Scene with_springs(Scene scene, const std::vector<int>& one_way, const std::vector<char>& acts) {
  for (std::size_t k = 0; k < one_way.size(); ++k) {
    Element& element = scene.elements[static_cast<std::size_t>(one_way[k])];
    auto& spring = std::get<LinearSpring>(element.law);
    scene.stops.push_back({.name = element.name, .on = element.on, .min = spring.free_length});
    spring.acts = LinearSpring::Acts::both;
    if (!acts[k]) spring.stiffness = 0.0;
  }
  return scene;
}

/// The rows that vary, and the stops of springs whose free length does.
VaryingNumbers varying_in(const VariedScene& varied, const Scene& scene, const std::vector<int>& one_way) {
  std::vector<ParameterPlace> rows = varied.varying_rows();
  const VaryingNumbers without_stops(scene, rows);
  const std::size_t first_stop = scene.stops.size() - one_way.size();
  for (std::size_t k = 0; k < one_way.size(); ++k) {
    if (without_stops.has({Owner::element, one_way[k], 0, 1})) {
      rows.push_back({Owner::stop, static_cast<int>(first_stop + k)});
    }
  }
  return {scene, rows};
}

/// Forces that vary with their direction: those of the change, and those that follow from named numbers, where it is
/// not their magnitude that varies.
std::vector<int> vectors_in(const VariedScene& varied, const Scene& scene, const VaryingNumbers& varying) {
  std::vector<int> out;
  for (const VariedScene::VectorCourse& course : varied.vector_courses()) out.push_back(course.force);
  const std::vector<VariedScene::Course>& courses = varied.courses();
  const auto has_course = [&](int force) {
    return std::any_of(courses.begin(), courses.end(), [&](const VariedScene::Course& course) {
      return course.place == ParameterPlace{Owner::force, force};
    });
  };
  if (scene.dependents) {
    for (const DependentNumber& one : *scene.dependents) {
      const int force = one.at.place.item;
      const bool follows = one.at.of == DependentPlace::Of::force && varying.has_any(Owner::force, force);
      if (follows && !has_course(force)) out.push_back(force);
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

VariedNumbers::VariedNumbers(const VariedScene& varied, const std::vector<int>& one_way, const std::vector<char>& acts)
    : VariedNumbers(varied, with_springs(varied.reference_scene(), one_way, acts), one_way, acts) {}

VariedNumbers::VariedNumbers(const VariedScene& varied, Scene scene, const std::vector<int>& one_way,
                             const std::vector<char>& acts)
    : scene_(std::move(scene)),
      varying_(varying_in(varied, scene_, one_way)),
      list_(scaled(scene_, varied.scales()), vectors_in(varied, scene_, varying_)) {
  const std::vector<ParameterRow>& table = list_.rows();
  for (const VariedScene::Course& course : varied.courses()) {
    const int row = list_.row(course.place);
    const double unit = table[static_cast<std::size_t>(row)].dimension.per_scale(varied.scales());
    const bool is_named = course.place.owner == Owner::number;
    (is_named ? named_ : rows_)
        .push_back({row, unit * course.from, unit * course.to, is_named ? course.place.item : -1});
  }
  for (const VariedScene::VectorCourse& course : varied.vector_courses()) {
    const NumberList::Components at = list_.vector_of(course.force);
    const double unit = table[static_cast<std::size_t>(list_.force(course.force))].dimension.per_scale(varied.scales());
    rows_.push_back({at.x, unit * course.from.x, unit * course.to.x});
    rows_.push_back({at.y, unit * course.from.y, unit * course.to.y});
  }
  const int first_stop = static_cast<int>(scene_.stops.size() - one_way.size());
  for (std::size_t k = 0; k < one_way.size(); ++k) {
    const int spring = list_.element(one_way[k]);
    springs_.push_back({spring, spring + 1, list_.stop(first_stop + static_cast<int>(k)), acts[k] != 0});
  }
}

}  // namespace poise

#include "model/number_list.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <variant>

#include "model/curved_slots.hpp"
#include "model/dependent_number.hpp"
#include "model/gas_struts.hpp"
#include "model/numbers.hpp"

namespace poise {
namespace {

/// The named numbers come first in p, and have no unit.
std::vector<double> named_in(const Scene& scene, const std::vector<double>& p) {
  return {p.begin(), p.begin() + static_cast<std::ptrdiff_t>(scene.named_values.size())};
}

Measure& measure_of(Scene& scene, const DependentPlace& factor) {
  const auto item = static_cast<std::size_t>(factor.place.item);
  return factor.place.owner == Owner::element ? scene.elements[item].on
         : factor.place.owner == Owner::drive ? scene.drives[item].on
                                              : scene.stops[item].on;
}

/// A factor as a scene has it in its scales, over the same in SI.
double unit_of_factor(const Measure& sum, const Measure::Term& term, const Scales& scales) {
  return sum.dimension().per_scale(scales) / term.dimension().per_scale(scales);
}

}  // namespace

NumberList::NumberList(const Scene& scene, const std::vector<int>& vectors)
    : scene_(scene), rows_(parameter_table(scene_)) {
  for (const Body& body : scene_.bodies) point_.emplace_back(body.points.size());
  body_.resize(scene_.bodies.size());
  element_.resize(scene_.elements.size());
  force_.resize(scene_.forces.size());
  torque_.resize(scene_.torques.size());
  joint_.resize(scene_.joints.size());
  blade_.resize(scene_.blades.size());
  for (const Stop& stop : scene_.stops) {
    stop_.push_back({0, strut_of(scene_, stop), coupling_kind(stop), curve_numbers_of(stop)});
  }
  for (const Force& force : scene_.forces) {
    const bool has_direction = norm(force.vector) > 0.0 && !force.has_direction_of_its_own();
    along_force_.push_back(has_direction ? direction<double>(force.vector) : force.along);
  }
  for (const Joint& joint : scene_.joints) along_axis_.push_back(joint.direction());
  values_.resize(rows_.size());
  place_rows();
  place_tracks();
  read_values();
  place_vectors(vectors);
  place_dependents();
}

int NumberList::row(const ParameterPlace& place) const {
  const auto found =
      std::find_if(rows_.begin(), rows_.end(), [&](const ParameterRow& row) { return row.place == place; });
  return static_cast<int>(found - rows_.begin());
}

void NumberList::place_rows() {
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const ParameterPlace& place = rows_[k].place;
    const int row = static_cast<int>(k);
    if (place.owner == Owner::number || moves_springs(place)) leaders_.push_back(row);
    if (place.number != 0) continue;
    const std::size_t item = at(place.item);
    switch (place.owner) {
      case Owner::scene:
        gravity_ = row;
        break;
      case Owner::force:
        force_[item] = row;
        break;
      case Owner::torque:
        torque_[item] = row;
        break;
      case Owner::body:
        body_[item] = row;
        break;
      case Owner::point:
        point_[item][at(place.part)] = row;
        break;
      case Owner::element:
        element_[item] = row;
        break;
      case Owner::joint:
        joint_[item] = row;
        break;
      case Owner::stop:
      case Owner::coupling:
        stop_[item].first = row;
        break;
      case Owner::blade:
        blade_[item] = row;
        break;
      case Owner::section:
        if (place.part == 1) section_.push_back(row);
        break;
      case Owner::number:
      case Owner::drive:
      case Owner::time:
      case Owner::start:
        break;
    }
  }
  for (std::size_t s = 0; s < stop_.size(); ++s) {
    stop_[s].first = stop_[at(first_row(static_cast<int>(s)))].first;
  }
}

void NumberList::place_tracks() {
  const auto add = [&](std::span<const Number> numbers) {
    const int first = static_cast<int>(values_.size());
    values_.resize(values_.size() + numbers.size());
    return first;
  };
  const std::vector<int> bodies = bodies_of_tracks(scene_);
  for (const int body : bodies) {
    for (int& point : point_[at(body)]) point = add(NamedPoint::numbers);
    body_[at(body)] = add(Body::numbers);
  }
  for (std::size_t j = 0; j < joint_.size(); ++j) {
    const Joint& joint = scene_.joints[j];
    if (std::find(bodies.begin(), bodies.end(), joint.b.body) != bodies.end()) joint_[j] = add(joint.numbers());
  }
}

void NumberList::read_values() {
  const auto read = [&](int first, const auto& item, std::span<const Number> numbers) {
    for (const Number& number : numbers) values_[at(first++)] = number.get(&item).value_or(0.0);
  };
  for (std::size_t i = 0; i < scene_.named_values.size(); ++i) values_[i] = scene_.named_values[i].value;
  read(gravity_, scene_, Scene::numbers);
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const Body& body = scene_.bodies[i];
    for (std::size_t k = 0; k < body.points.size(); ++k) read(point_[i][k], body.points[k], NamedPoint::numbers);
    if (i > 0) read(body_[i], body, Body::numbers);
  }
  for (std::size_t f = 0; f < force_.size(); ++f) read(force_[f], scene_.forces[f], scene_.forces[f].numbers());
  for (std::size_t t = 0; t < torque_.size(); ++t) read(torque_[t], scene_.torques[t], Torque::numbers);
  for (std::size_t e = 0; e < element_.size(); ++e) {
    std::visit([&](const auto& law) { read(element_[e], law, numbers_of_law(law)); }, scene_.elements[e].law);
  }
  for (std::size_t l = 0; l < section_.size(); ++l) {
    read(section_[l], scene_.flexible_links[l].section, CrossSection::numbers);
  }
  for (std::size_t j = 0; j < joint_.size(); ++j) read(joint_[j], scene_.joints[j], scene_.joints[j].numbers());
  for (std::size_t b = 0; b < blade_.size(); ++b) read(blade_[b], scene_.blades[b], Blade::numbers);
  for (std::size_t s = 0; s < stop_.size(); ++s) {
    const bool has_own = stop_[s].strut < 0 && first_row(static_cast<int>(s)) == static_cast<int>(s);
    if (has_own) read(stop_[s].first, scene_.stops[s], scene_.stops[s].numbers());
  }
}

void NumberList::place_vectors(const std::vector<int>& vectors) {
  if (!vectors.empty()) vector_.resize(scene_.forces.size());
  for (const int force : vectors) {
    const Vec2& vector = scene_.forces[at(force)].vector;
    vector_[at(force)] = {static_cast<int>(values_.size()), static_cast<int>(values_.size()) + 1, true};
    values_.insert(values_.end(), {vector.x, vector.y});
  }
}

int NumberList::place_of_component(const DependentPlace& of, std::size_t item) {
  if (of.of == DependentPlace::Of::factor) {
    Measure::Term& term = measure_of(scene_, of).terms[at(of.component)];
    term.number = static_cast<int>(values_.size());
    values_.push_back(term.factor);
    return term.number;
  }
  const bool is_force = of.of == DependentPlace::Of::force;
  std::vector<Components>& all = is_force ? vector_ : axis_;
  all.resize(is_force ? scene_.forces.size() : scene_.joints.size());
  int& place = of.component == 0 ? all[item].x : all[item].y;
  if (place >= 0) return place;
  const Vec2& vector = is_force ? scene_.forces[item].vector : scene_.joints[item].axis;
  place = static_cast<int>(values_.size());
  values_.push_back(of.component == 0 ? vector.x : vector.y);
  return place;
}

void NumberList::place_dependents() {
  if (!scene_.dependents) return;
  const std::vector<double> followed = dependent_values(scene_, named_values(scene_), false);
  std::size_t row = 0;
  for (std::size_t k = 0; k < followed.size(); ++k) {
    const DependentPlace& of = (*scene_.dependents)[k].at;
    const std::size_t item = at(of.place.item);
    int place = -1;
    double unit = 1.0;
    if (of.of == DependentPlace::Of::row && of.place.owner != Owner::number) {
      while (!(rows_[row].place == of.place)) ++row;
      place = static_cast<int>(row);
    } else if (of.of != DependentPlace::Of::row && of.of != DependentPlace::Of::left_out) {
      place = place_of_component(of, item);
      if (of.of == DependentPlace::Of::factor) {
        const Measure& sum = measure_of(scene_, of);
        unit = unit_of_factor(sum, sum.terms[at(of.component)], scene_.measured_in);
      }
    }
    dependent_.push_back(place);
    units_.push_back(unit);
    followed_.push_back(unit * followed[k]);
  }
}

void NumberList::follow(std::vector<double>& p) const {
  follow_names(p);
  for (std::size_t l = 0; l < section_.size(); ++l) {
    const double* const now = &p[at(section_[l])];
    const double* const before = &values_[at(section_[l])];
    const double ratio = now[second_moment] * now[modulus] / (before[second_moment] * before[modulus]);
    for (const int spring : scene_.flexible_links[l].springs) p[at(element(spring))] *= ratio;
  }
}

void NumberList::follow_names(std::vector<double>& p) const {
  if (dependent_.empty()) return;
  const std::vector<double> values = dependent_values(scene_, named_in(scene_, p), false);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (dependent_[k] >= 0) p[at(dependent_[k])] += units_[k] * values[k] - followed_[k];
  }
  for (std::size_t f = 0; f < vector_.size(); ++f) {
    if (!vector_[f].vary() || vector_[f].are_whole) continue;
    const Vec2& before = scene_.forces[f].vector;
    p[at(force_[f])] += norm(with_components(before, vector_[f], p.data())) - norm(before);
  }
}

void NumberList::add_springs_of(int row, double slope, const std::vector<double>& p,
                                std::vector<std::pair<int, double>>& out) const {
  const ParameterPlace& place = rows_[at(row)].place;
  const int section = section_[at(place.item)];
  const int other = section + (place.number == modulus ? second_moment : modulus);
  const double by = slope * p[at(other)] / (values_[at(section + second_moment)] * values_[at(section + modulus)]);
  for (const int spring : scene_.flexible_links[at(place.item)].springs) {
    out.emplace_back(element(spring), by * values_[at(element(spring))]);
  }
}

std::vector<std::pair<int, double>> NumberList::followers(int row, const std::vector<double>& p) const {
  std::vector<std::pair<int, double>> out;
  const ParameterPlace& leader = rows_[at(row)].place;
  if (moves_springs(leader)) add_springs_of(row, 1.0, p, out);
  if (dependent_.empty() || leader.owner != Owner::number) return out;
  const std::vector<double> slopes = dependents_by(scene_, leader.item, named_in(scene_, p));
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    const int place = dependent_[k];
    if (place < 0 || slopes[k] == 0.0 || !std::isfinite(slopes[k])) continue;
    out.emplace_back(place, units_[k] * slopes[k]);
    if (at(place) < rows_.size() && moves_springs(rows_[at(place)].place)) add_springs_of(place, slopes[k], p, out);
    const DependentPlace& of = (*scene_.dependents)[k].at;
    if (of.of != DependentPlace::Of::force) continue;
    // The magnitude follows from the components.
    const std::size_t force = at(of.place.item);
    const Vec2 along = unit_or_zero(with_components(scene_.forces[force].vector, vector_[force], p.data()));
    out.emplace_back(force_[force], slopes[k] * (of.component == 0 ? along.x : along.y));
  }
  return out;
}

std::string NumberList::why_not_followed(int row) const {
  const ParameterPlace& leader = rows_[at(row)].place;
  if (dependent_.empty() || leader.owner != Owner::number) return "";
  const std::vector<double> slopes = dependents_by(scene_, leader.item, named_values(scene_));
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    const DependentNumber& one = (*scene_.dependents)[k];
    if (one.at.of == DependentPlace::Of::left_out) continue;
    const std::string written = one.item + " = \"" + one.text() + "\"";
    if (!std::isfinite(slopes[k])) return written + " has no derivative by it";
    if (slopes[k] != 0.0 && one.at.of == DependentPlace::Of::force && !vector_[at(one.at.place.item)].are_whole &&
        scene_.forces[at(one.at.place.item)].vector == Vec2{}) {
      return written + " is a force of zero, which has no direction";
    }
  }
  return "";
}

}  // namespace poise

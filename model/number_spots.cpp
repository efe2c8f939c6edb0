#include "model/number_spots.hpp"

#include <algorithm>
#include <map>
#include <variant>

#include "model/couplings.hpp"
#include "model/curved_slots.hpp"
#include "model/gas_struts.hpp"
#include "model/input_error.hpp"
#include "model/toml_text.hpp"

namespace poise {
namespace {

const toml::table* below(const toml::table* in, std::string_view key) {
  return in != nullptr && in->contains(key) ? in->get(key)->as_table() : nullptr;
}

}  // namespace

namespace {

const toml::node* item_of(const toml::node* list, int at) {
  const toml::array* const all = list != nullptr ? list->as_array() : nullptr;
  return all != nullptr ? all->get(static_cast<std::size_t>(at)) : nullptr;
}

/// Finds where a number of a function of time is written in the table `time`.
NumberSpot spot_in(const toml::table* time, const TimeLaw& law, int number, const std::string& key) {
  if (const auto* const composed = std::get_if<ComposedInTime>(&law)) {
    const bool is_integral = composed->how == ComposedInTime::How::integral;
    const auto [k, place] = composed->place_of(static_cast<std::size_t>(number));
    if (k < 0 && is_integral) return {time, "", key};
    const auto at = static_cast<std::size_t>(std::max(k, 0));
    const toml::node* const list = time != nullptr && !is_integral ? time->get(composed->kind()) : nullptr;
    const toml::node* const item = item_of(list, static_cast<int>(k < 0 ? place : at));
    const toml::table* const below_it = is_integral ? time : item != nullptr ? item->as_table() : nullptr;
    if (k < 0) return {below_it, "", "until"};
    const TimeLaw& part = composed->parts[at];
    return spot_in(below_it, part, static_cast<int>(place), std::string(part.numbers()[place].key));
  }
  if (std::holds_alternative<FormulaInTime>(law)) return {};
  if (std::holds_alternative<TableInTime>(law)) {
    return {time, "", std::string(TableInTime::key), number % 2 == 0 ? 1 : 0, number / 2};
  }
  return {below(time, law.kind()), "", key};
}

}  // namespace

std::string_view name_in_formula(const ParameterRow& row) {
  if (row.place.owner != Owner::time) return {};
  const std::string before = std::string(FormulaInTime::key) + ".";
  const std::string_view key = row.path.parts[3];
  if (key.starts_with(before)) return key.substr(before.size());
  const std::size_t found = key.find("." + before);
  return found == std::string_view::npos ? std::string_view() : key.substr(found + before.size() + 1);
}

const toml::node* NumberSpot::node() const {
  const toml::node* const value = table != nullptr ? table->get(key) : nullptr;
  if (point >= 0) return item_of(item_of(value, point), component);
  return component < 0 ? value : item_of(value, component);
}

const toml::node* NumberSpot::twin_node() const {
  return twin < 0 ? nullptr : NumberSpot{table, header, key, component, twin}.node();
}

NumberSpots::NumberSpots(const toml::table& document, const Scene& scene) : document_(document), scene_(scene) {
  std::map<std::string_view, std::size_t> count;
  for (const Element& element : scene.elements) elements_.push_back(count[element.table]++);
  // Ropes that stretch and stops that yield are elements, others stops: they take turns in one list.
  constexpr std::array<std::string_view, 2> shared{"rope", "stop"};
  for (const std::string_view key : shared) count.erase(key);
  for (const Stop& stop : scene.stops) stops_.push_back(count[stop.table]++);
  for (const std::string_view key : shared) {
    std::vector<std::size_t> elastic, rigid;
    const toml::array* const list = document.get_as<toml::array>(key);
    for (std::size_t k = 0; list != nullptr && k < list->size(); ++k) {
      const toml::table* const one = list->get_as<toml::table>(k);
      if (one != nullptr) (one->contains("stiffness") ? elastic : rigid).push_back(k);
    }
    const auto place_in = [&](const std::vector<std::size_t>& places, std::size_t nth) {
      return nth < places.size() ? places[nth] : list != nullptr ? list->size() : 0;
    };
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      if (scene.elements[e].table == key) elements_[e] = place_in(elastic, elements_[e]);
    }
    for (std::size_t s = 0; s < stops_.size(); ++s) {
      if (scene.stops[s].table == key) stops_[s] = place_in(rigid, stops_[s]);
    }
  }
  for (const Force& force : scene.forces) forces_.push_back(count[force.to ? "distributed_load" : "force"]++);
  for (const Joint& joint : scene.joints) joints_.push_back(count[joint.traits().key]++);
}

// Parts of flexible links, stops of gas struts, and what comes with curved slots and rolling wheels.
bool NumberSpots::is_written(Owner owner, std::size_t at) const {
  const auto is_in = [](const std::vector<int>& list, int one) {
    return std::find(list.begin(), list.end(), one) != list.end();
  };
  const auto is_part = [&](const FlexibleLink& link) {
    if (owner == Owner::element) return is_in(link.springs, static_cast<int>(at));
    if (owner == Owner::body || owner == Owner::point) return is_in(link.bodies, static_cast<int>(at));
    return owner == Owner::joint && is_in(link.bodies, scene_.joints[at].a.body) &&
           is_in(link.bodies, scene_.joints[at].b.body);
  };
  if (owner == Owner::joint && is_of_track(scene_, scene_.joints[at])) return false;
  const auto is_row = [&] {
    const CouplingKind* const kind = coupling_kind(scene_.stops[at]);
    return strut_of(scene_, scene_.stops[at]) >= 0 || (kind != nullptr && kind->row > 0);
  };
  return ((owner != Owner::stop && owner != Owner::coupling) || !is_row()) &&
         std::none_of(scene_.flexible_links.begin(), scene_.flexible_links.end(), is_part);
}

const toml::table* NumberSpots::in_list(std::string_view key, std::size_t index) const {
  const toml::array* const list = document_.contains(key) ? document_.get(key)->as_array() : nullptr;
  if (list == nullptr || index >= list->size()) {
    throw InputError(scene_.file + ": expected the scene that was read before; leave it unchanged until the end");
  }
  return list->get(index)->as_table();
}

const toml::table* NumberSpots::item(Owner owner, int index) const {
  const auto at = static_cast<std::size_t>(index);
  if (!is_written(owner, at)) return nullptr;
  switch (owner) {
    case Owner::element:
      return table_of(at);
    case Owner::joint:
      return in_list(scene_.joints[at].traits().key, joints_[at]);
    case Owner::force:
      return in_list(scene_.forces[at].to ? "distributed_load" : "force", forces_[at]);
    case Owner::torque:
      return in_list("torque", at);
    case Owner::drive:
      return in_list("drive", at);
    case Owner::blade:
      return in_list("blade", at);
    case Owner::stop:
    case Owner::coupling:
      return in_list(scene_.stops[at].table, stops_[at]);
    default:
      return nullptr;
  }
}

// Of friction that a gas strut has, which comes behind all tables [[friction]], that strut's table `gas`.
const toml::table* NumberSpots::table_of(std::size_t element) const {
  const Element& of = scene_.elements[element];
  const toml::array* const list = document_.contains(of.table) ? document_.get(of.table)->as_array() : nullptr;
  if (of.table != "friction" || (list != nullptr && elements_[element] < list->size())) {
    return in_list(of.table, elements_[element]);
  }
  const auto strut = std::find_if(scene_.elements.begin(), scene_.elements.end(), [&](const Element& other) {
    return std::holds_alternative<GasStrut>(other.law) && other.name == of.name;
  });
  if (strut == scene_.elements.end()) return in_list(of.table, elements_[element]);
  return below(table_of(static_cast<std::size_t>(strut - scene_.elements.begin())), "gas");
}

// A key with a dot is in a table of the element's table: "gas.preload", "force.3" of a curve.
NumberSpot NumberSpots::of_element(std::size_t element, const std::string& key, int number) const {
  const toml::table* const written = item(Owner::element, static_cast<int>(element));
  if (scene_.elements[element].table == "friction" && written != nullptr && written->contains("friction")) {
    return {written, "", number == 0 ? "friction" : "friction_width"};
  }
  const std::size_t dot = key.find('.');
  if (dot == std::string::npos) return {written, "", key};
  const toml::table* const part = below(written, key.substr(0, dot));
  const std::string last = key.substr(dot + 1);
  const Law& law = scene_.elements[element].law;
  const bool is_coefficient = controller_of(law) != nullptr && !key.starts_with("table.");
  if (is_coefficient) return {below(written, "transfer"), "", key.substr(0, dot), std::stoi(last)};
  const bool has_points = std::holds_alternative<CurveSpring>(law) || std::holds_alternative<CurveDamper>(law) ||
                          controller_of(law) != nullptr;
  if (!has_points) return {part, "", last};
  return {part, "", "curve", 1, std::stoi(last) - 1};
}

// "friction.K" is the key friction of the K-th pulley that has one.
NumberSpot NumberSpots::of_rim(const Stop& rope, const toml::table* written, const std::string& key) {
  const auto rim = static_cast<std::size_t>(std::stoi(key.substr(key.find('.') + 1)) - 1);
  const toml::array* const over =
      written != nullptr && written->contains("over") ? written->get("over")->as_array() : nullptr;
  const std::vector<int> rims = rubbing_rims(rope.on);
  const toml::node* const pulley = over != nullptr ? over->get(static_cast<std::size_t>(rims[rim])) : nullptr;
  return {pulley != nullptr ? pulley->as_table() : nullptr, "", "friction"};
}

// "curve.K" of a cam is the share of the K-th point, whose first is its last, "curve.K.x" a component of that of a
// slot.
NumberSpot NumberSpots::of_curve(const Stop& stop, const toml::table* written, const std::string& key, int number) {
  const CurveNumbers curve = curve_numbers_of(stop);
  const int point = (number - curve.first) / curve.components;
  const bool is_cam = curve.components == 1;
  return {written,
          "",
          key.substr(0, key.find('.')),
          is_cam ? 1 : (number - curve.first) % curve.components,
          point,
          is_cam && point == 0 ? curve.points : -1};
}

const toml::table* NumberSpots::table_of(const TimeFunction& function) const {
  if (function.of == TimeFunction::Of::frame) {
    return below(below(&document_, "frame"), function.part == 0 ? "x" : "y");
  }
  if (function.of == TimeFunction::Of::element) {
    const Element& element = scene_.elements[static_cast<std::size_t>(function.item)];
    const Number& number = numbers_of(element.law)[static_cast<std::size_t>(function.part)];
    return below(below(item(Owner::element, function.item), "time"), number.key_on(&element.on));
  }
  return below(item(owner_of(function.of), function.item), "time");
}

NumberSpot NumberSpots::of(const ParameterRow& row) const {
  const auto at = static_cast<std::size_t>(row.place.item);
  std::string key(row.path.parts[3]);
  if (!is_written(row.place.owner, at)) return {};
  switch (row.place.owner) {
    case Owner::scene:
      return {&document_, "", "gravity", row.place.number};
    case Owner::number:
      return {below(&document_, "numbers"), "numbers", scene_.named_values[at].name};
    case Owner::force:
      if (scene_.forces[at].has_direction_of_its_own()) return {item(Owner::force, row.place.item), "", "size"};
      return {item(Owner::force, row.place.item), "", "vector", 0};
    case Owner::torque:
      return {item(Owner::torque, row.place.item), "", "value"};
    case Owner::body: {
      const std::string& name = scene_.bodies[at].name;
      const toml::table* const body = below(below(&document_, "body"), name);
      const std::string header = "body." + toml_key(name);
      return row.place.number < 2 ? NumberSpot{body, header, key}
                                  : NumberSpot{body, header, "center", row.place.number - 2};
    }
    case Owner::section: {
      const std::string& name = row.place.part == 0 ? scene_.bodies[at].name : scene_.flexible_links[at].name;
      return {below(below(below(&document_, "body"), name), "section"), "body." + toml_key(name) + ".section", key};
    }
    case Owner::point: {
      const Body& body = scene_.bodies[at];
      const toml::table* const owner =
          at == 0 ? below(&document_, "ground") : below(below(&document_, "body"), body.name);
      return {below(owner, "points"), "", body.points[static_cast<std::size_t>(row.place.part)].name, row.place.number};
    }
    case Owner::element:
      return of_element(at, key, row.place.number);
    case Owner::joint: {
      const std::size_t dot = key.find('.');
      const toml::table* const joint = item(Owner::joint, row.place.item);
      if (dot == std::string::npos) return {joint, "", key};
      return {below(joint, key.substr(0, dot)), "", key.substr(dot + 1)};
    }
    case Owner::coupling:
      if (curve_numbers_of(scene_.stops[at]).has(row.place.number)) {
        return of_curve(scene_.stops[at], item(Owner::coupling, row.place.item), key, row.place.number);
      }
      if (key.starts_with("friction.")) return of_rim(scene_.stops[at], item(Owner::coupling, row.place.item), key);
      [[fallthrough]];
    case Owner::drive:
    case Owner::stop:
    case Owner::blade:
      return {item(row.place.owner, row.place.item), "", key};
    case Owner::time: {
      const TimeFunction& function = scene_.time_functions[at];
      return spot_in(table_of(function), function.law, row.place.number, key);
    }
    case Owner::start:
      break;
  }
  const toml::table* const start = below(&document_, "start");
  const std::string name(row.path.parts[1]);
  if (row.place.part < 2) return {start, "start", name};
  return {below(start, "position"), "start.position", name, row.place.number};
}

}  // namespace poise

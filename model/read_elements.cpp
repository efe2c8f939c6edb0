#include "model/read_elements.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "model/read_measure.hpp"

namespace poise {
namespace {

/// "torsion_spring" -> "torsion spring".
std::string spaced(std::string_view key) {
  std::string text(key);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

class ElementReader {
 public:
  ElementReader(const TomlTable& root, const SceneNames& names, Scene& scene)
      : root_(root), names_(names), measures_(names, scene.units), scene_(scene), units_(scene.units) {}

  void read() {
    read_laws(std::type_identity<Law>{});
    read_family("drive", scene_.drives, &ElementReader::read_drive);
    read_loads();
    read_family("stop", scene_.stops, &ElementReader::read_stop);
  }

 private:
  using Keys = std::vector<std::string_view>;

  /// The tables [[key]], which share one set of names: "WHAT 1", ... if none are given.
  template <class Item, class ReadOne>
  void read_family(std::string_view key, std::vector<Item>& family, ReadOne read_one) {
    const std::vector<TomlTable> tables = root_.tables(key);
    const std::vector<std::string> names = names_of(tables, numbered(spaced(key), tables.size()), {});
    for (std::size_t i = 0; i < tables.size(); ++i) add(tables[i], names[i], family, read_one);
  }

  template <class Item, class ReadOne>
  void add(const TomlTable& table, const std::string& name, std::vector<Item>& family, ReadOne read_one) {
    Item item = std::invoke(read_one, this, table);
    item.name = name;
    item.line = table.place().line;
    family.push_back(std::move(item));
  }

  template <class... L>
  void read_laws(std::type_identity<std::variant<L...>>) {
    (read_tables_of<L>(), ...);
  }

  template <class L>
  void read_tables_of() {
    for (const LawTable& written : L::tables) {
      read_family(written.key, scene_.elements,
                  [&](const ElementReader*, const TomlTable& table) { return read_element<L>(table, written); });
    }
  }

  template <class L>
  Element read_element(const TomlTable& table, const LawTable& written) const {
    const MeasureKeys measures = written.angles_only ? MeasureKeys{"bodies"} : all_measures();
    const bool is_angle = written.angles_only || MeasureReader::reads_angle(table, measures);
    Keys allowed;
    for (const Number& number : L::numbers) {
      allowed.push_back(is_angle && !number.angle_key.empty() ? number.angle_key : number.key);
    }
    if constexpr (requires { L::choices; }) {
      for (const LawChoice& choice : L::choices) allowed.push_back(choice.key);
    }
    Element element;
    element.table = written.key;
    element.on = measures_.read(table, measures, allowed);
    L law;
    read_numbers(table, L::numbers, &law, &element.on, units_);
    if constexpr (requires { L::choices; }) {
      for (const LawChoice& choice : L::choices) {
        if (const auto word = table.find_text(choice.key)) {
          choice.set(&law, choose(*word, {choice.words.begin(), choice.words.end()}));
        }
      }
    }
    element.law = law;
    return element;
  }

  void read_loads() {
    const std::vector<TomlTable> forces = root_.tables("force");
    const std::vector<TomlTable> torques = root_.tables("torque");
    // Forces and torques share one set of names, because load.NAME must be unique.
    std::vector<TomlTable> loads = forces;
    loads.insert(loads.end(), torques.begin(), torques.end());
    std::vector<std::string> defaults = numbered("force", forces.size());
    for (std::string& name : numbered("torque", torques.size())) defaults.push_back(std::move(name));
    const std::vector<std::string> names = names_of(loads, defaults, {});
    for (std::size_t i = 0; i < loads.size(); ++i) {
      if (i < forces.size())
        add(loads[i], names[i], scene_.forces, &ElementReader::read_force);
      else
        add(loads[i], names[i], scene_.torques, &ElementReader::read_torque);
    }
  }

  Force read_force(const TomlTable& table) const {
    table.allow_keys({"name", "at", "vector", "follows"});
    Force force;
    const TomlText at = table.text("at");
    force.at = names_.point(at);
    if (force.at.body == 0) at.place.fail("expected a point of a body that can move, found one of the ground");
    force.vector = table.vector("vector", units_.force);
    if (const auto follows = table.find_text("follows")) force.follows = names_.movable_body(*follows);
    return force;
  }

  Torque read_torque(const TomlTable& table) const {
    table.allow_keys({"name", "on", "value"});
    Torque torque;
    torque.body = names_.movable_body(table.text("on"));
    torque.value = table.number("value", dimension::torque.unit(units_), Range::finite);
    return torque;
  }

  Drive read_drive(const TomlTable& table) const {
    Drive drive;
    Keys keys;
    for (const Number& number : Drive::numbers) keys.push_back(number.key);
    drive.on = measures_.read(table, {"bodies", "slide"}, keys);
    read_numbers(table, Drive::numbers, &drive, &drive.on, units_);
    return drive;
  }

  Stop read_stop(const TomlTable& table) const {
    Stop stop;
    stop.on = measures_.read(table, all_measures(), {"min", "max"});
    const double unit = stop.on.dimension().unit(units_);
    stop.min = table.find_number("min", unit, stop.on.range()).value_or(stop.min);
    stop.max = table.find_number("max", unit, stop.on.range()).value_or(stop.max);
    if (!table.has("min") && !table.has("max")) {
      table.place().fail("expected the key min, max or both; add max = NUMBER");
    }
    if (!(stop.min <= stop.max)) table.place_of("max").fail("expected max >= min; exchange them");
    return stop;
  }

  const TomlTable& root_;
  const SceneNames& names_;
  MeasureReader measures_;
  Scene& scene_;
  const Units& units_;
};

}  // namespace

std::vector<std::string> numbered(std::string_view what, std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= count; ++i) names.push_back(std::string(what) + " " + std::to_string(i));
  return names;
}

void read_numbers(const TomlTable& table, std::span<const Number> numbers, void* item, const Measure* on,
                  const Units& units) {
  for (const Number& number : numbers) {
    const std::string_view key = number.key_on(on);
    const double unit = number.dimension_on(on).unit(units);
    const Range range = number.range_on(on);
    if (number.needed_on(on))
      number.set(item, table.number(key, unit, range));
    else if (const auto value = table.find_number(key, unit, range))
      number.set(item, *value);
  }
}

std::vector<std::string_view> element_tables() {
  std::vector<std::string_view> keys;
  const auto add = [&]<class... L>(std::type_identity<std::variant<L...>>) {
    const auto add_law = [&](const auto& tables) {
      for (const LawTable& table : tables) keys.emplace_back(table.key);
    };
    (add_law(L::tables), ...);
  };
  add(std::type_identity<Law>{});
  return keys;
}

void read_elements(const TomlTable& root, const SceneNames& names, Scene& scene) {
  ElementReader(root, names, scene).read();
}

}  // namespace poise

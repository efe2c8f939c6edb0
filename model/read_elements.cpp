#include "model/read_elements.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>

#include "model/gas_struts.hpp"
#include "model/one_line.hpp"
#include "model/read_controllers.hpp"
#include "model/read_curve.hpp"
#include "model/read_measure.hpp"
#include "model/read_time_function.hpp"

namespace poise {
namespace {

/// Springs and dampers whose numbers may be multiplied by functions of time.
template <class L>
constexpr bool varies_in_time =
    std::is_same_v<L, LinearSpring> || std::is_same_v<L, CubicSpring> || std::is_same_v<L, PreloadedSpring> ||
    std::is_same_v<L, Damper> || std::is_same_v<L, DragDamper> || std::is_same_v<L, CurveDamper>;

class ElementReader {
 public:
  ElementReader(const TomlTable& root, const SceneNames& names, Scene& scene)
      : root_(root), names_(names), measures_(names), scene_(scene) {}

  void read() {
    for (const std::string_view key : element_tables()) {
      read_family(key, scene_.elements,
                  [key](const ElementReader* self, const TomlTable& table) { return self->read_element(table, key); });
    }
    add_friction_of_struts();
    // Before controllers, which may set them; functions of loads come last.
    const auto first = std::ssize(scene_.time_functions);
    read_loads();
    const auto behind = std::ssize(scene_.time_functions);
    read_family("drive", scene_.drives, &ElementReader::read_drive);
    ControllerReader(root_, measures_, scene_).read();
    read_times_of_springs();
    read_times_of_drives();
    const auto functions = scene_.time_functions.begin();
    std::rotate(functions + first, functions + behind, scene_.time_functions.end());
    read_stops();
    add_stops_of_struts();
    read_family("blade", scene_.blades, &ElementReader::read_blade);
  }

 private:
  using Keys = std::vector<std::string_view>;

  /// The tables [[key]], which share one set of names: "WHAT 1", ... if none are given.
  template <class Item, class ReadOne>
  void read_family(std::string_view key, std::vector<Item>& family, ReadOne read_one) {
    const std::vector<TomlTable> tables = root_.tables(key);
    const std::vector<std::string> names = names_of(tables, numbered(words_of_key(key), tables.size()), {});
    for (std::size_t i = 0; i < tables.size(); ++i) add(tables[i], names[i], family, read_one);
  }

  template <class Item, class ReadOne>
  void add(const TomlTable& table, const std::string& name, std::vector<Item>& family, ReadOne read_one) {
    Item item = std::invoke(read_one, this, table);
    item.name = name;
    item.line = table.place().line_in_document();
    family.push_back(std::move(item));
  }

  /// Calls use(type of the law, its table) for all laws that tables [[key]] declare.
  template <class Use>
  static void each_law_of(std::string_view key, Use use) {
    const auto each = [&]<class... L>(std::type_identity<std::variant<L...>>) {
      const auto each_table = [&]<class One>(std::type_identity<One> law) {
        for (const LawTable& written : One::tables) {
          if (written.key == key) use(law, written);
        }
      };
      (each_table(std::type_identity<L>{}), ...);
    };
    each(std::type_identity<Law>{});
  }

  Element read_element(const TomlTable& table, std::string_view key) const {
    if (key == "controller") return read_what_controller_acts_on(table, measures_);
    bool angles_only = false;
    each_law_of(key, [&](auto, const LawTable& written) { angles_only = written.angles_only; });
    const MeasureKeys measures = angles_only ? MeasureKeys{"bodies"} : all_measures();
    const bool is_angle = angles_only || MeasureReader::reads_angle(table, measures);
    const std::string_view told = law_told_by(table, key, is_angle);
    Element element;
    each_law_of(key, [&]<class L>(std::type_identity<L>, const LawTable& written) {
      if (written.told_on(is_angle) == told) element = read_element_of<L>(table, measures, written, is_angle);
    });
    return element;
  }

  /// The key that tells which law of the tables [[key]] this one declares; empty for the one without such a key.
  static std::string_view law_told_by(const TomlTable& table, std::string_view key, bool is_angle) {
    std::vector<std::string_view> told;
    each_law_of(key, [&](auto, const LawTable& written) {
      const std::string_view by = written.told_on(is_angle), other = written.told_on(!is_angle);
      if (by != other && table.has(other)) {
        table.place_of(other).fail("expected the key " + std::string(by) + " on " +
                                   (is_angle ? "an angle" : "a length") + "; rename it");
      }
      if (!by.empty() && table.has(by)) told.push_back(by);
    });
    if (told.size() > 1) {
      table.place().fail("expected one of the keys " + std::string(told[0]) + " and " + std::string(told[1]) +
                         ", found both; leave one out");
    }
    return told.empty() ? "" : told.front();
  }

  template <class L>
  Element read_element_of(const TomlTable& table, const MeasureKeys& measures, const LawTable& written,
                          bool is_angle) const {
    Keys allowed;
    for (const Number& number : L::numbers) {
      allowed.push_back(is_angle && !number.angle_key.empty() ? number.angle_key : number.key);
    }
    if constexpr (std::is_same_v<L, GasStrut>) allowed.clear();  // they are in its own table
    if constexpr (std::is_same_v<L, DryFriction>) {
      for (const Number& number : DryFriction::numbers_of_falling) allowed.push_back(number.key);
      allowed.push_back("stribeck");
    }
    if constexpr (varies_in_time<L>) allowed.push_back("time");
    if constexpr (requires { L::choices; }) {
      for (const LawChoice& choice : L::choices) allowed.push_back(choice.key);
    }
    const std::string_view told = written.told_on(is_angle);
    if (!told.empty() && std::find(allowed.begin(), allowed.end(), told) == allowed.end()) allowed.push_back(told);
    Element element;
    element.table = written.key;
    element.on = measures_.read(table, measures, allowed);
    L law;
    if constexpr (std::is_same_v<L, GasStrut>) {
      read_gas(table, element.on, law);
    } else {
      if constexpr (std::is_same_v<L, CurveSpring>) law = read_curve(*table.find_table(told), element.on);
      if constexpr (std::is_same_v<L, CurveDamper>) law = read_damper_curve(*table.find_table(told), element.on);
      read_numbers(table, L::numbers, &law, &element.on);
      if constexpr (std::is_same_v<L, DryFriction>) read_fall(table, element.on, law);
    }
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

  /// Friction whose static force is above that of sliding.
  static void read_fall(const TomlTable& table, const Measure& on, DryFriction& law) {
    using Falls = DryFriction::Falls;
    const bool with_rate = table.has("stribeck_rate");
    if (!table.has("static")) {
      for (const std::string_view key : {"stribeck_rate", "stribeck", "stribeck_exponent"}) {
        if (table.has(key)) table.place_of(key).fail("expected the key static beside it, the force at rest; add it");
      }
      return;
    }
    law.falls = Falls::drop;
    if (const auto shape = table.find_text("stribeck")) {
      law.falls = choose(*shape, {"exponential", "hyperbolic"}) == 0 ? Falls::exponential : Falls::hyperbolic;
    } else if (with_rate) {
      law.falls = Falls::exponential;
    }
    if (law.falls != Falls::drop && !with_rate) {
      table.place_of("stribeck").fail("expected the key stribeck_rate beside it, over which friction falls; add it");
    }
    if (table.has("stribeck_exponent") && law.falls != Falls::exponential) {
      table.place_of("stribeck_exponent")
          .fail("expected an exponent with stribeck = \"exponential\" alone; leave it out");
    }
    if (law.falls == Falls::drop && !law.sticks()) {
      table.place_of("static").fail(
          "expected width = 0 beside it, or stribeck_rate: a static force that drops at once acts where friction "
          "sticks");
    }
    // Not above any static force before that is read.
    law.static_force = law.force;
    read_numbers(table, law.all_numbers().subspan(2), &law, &on);
  }

  /// Key of a number of a gas strut in the table `gas`.
  static std::string_view key_in_gas(const Number& number) {
    return number.key.substr(std::string_view("gas.").size());
  }

  void read_gas(const TomlTable& spring, const Measure& on, GasStrut& law) const {
    const TomlTable table = *spring.find_table("gas");
    if (on.is_angle()) {
      spring.place_of("gas").fail(
          "expected a measure that is a length, for example points; a gas strut pushes along it");
    }
    Keys keys{"friction", "friction_width"};
    law.damps = true;
    std::vector<Number> numbers(law.all_numbers().begin(), law.all_numbers().end());
    for (Number& number : numbers) {
      number.key = key_in_gas(number);
      keys.push_back(number.key);
    }
    table.allow_keys(keys);
    law.damps = table.has("damping") || table.has("end_damping");
    for (const auto& [key, other] : {std::pair{"end_damping", "end_stroke"}, std::pair{"end_stroke", "end_damping"}}) {
      if (table.has(key) && !table.has(other)) {
        table.place_of(key).fail("expected the key " + std::string(other) + " beside it; add it");
      }
    }
    read_numbers(table, numbers, &law, &on);
    if (!contains(on.range(), law.length - law.stroke)) {
      table.place_of("stroke").fail(
          "expected a stroke of at most the length; a strut with its rod in is not shorter than 0");
    }
    if (!table.has("end_stroke")) law.end_stroke = law.stroke;
    if (law.end_stroke > law.stroke) {
      table.place_of("end_stroke").fail("expected at most the stroke, of which it is the last part; make it shorter");
    }
  }

  /// use(its table `gas`, the element) for all gas struts.
  template <class Use>
  void each_strut(Use use) {
    const std::vector<TomlTable> tables = root_.tables("spring");
    for (std::size_t i = 0, next = 0; i < scene_.elements.size(); ++i) {
      if (scene_.elements[i].table != "spring") continue;
      const TomlTable& table = tables[next++];
      if (std::holds_alternative<GasStrut>(scene_.elements[i].law)) use(*table.find_table("gas"), i);
    }
  }

  void add_friction_of_struts() {
    each_strut([&](const TomlTable& gas, std::size_t strut) {
      if (!gas.has("friction")) {
        if (gas.has("friction_width")) gas.place().fail("expected the key friction beside friction_width; add it");
        return;
      }
      Element element{
          "friction", scene_.elements[strut].name, scene_.elements[strut].on, {}, gas.place().line_in_document()};
      DryFriction law;
      std::array<Number, 2> numbers = DryFriction::numbers;
      numbers[0].key = "friction";
      numbers[1].key = "friction_width";
      read_numbers(gas, numbers, &law, &element.on);
      element.law = law;
      for (const Element& other : scene_.elements) {
        if (other.table == element.table && other.name == element.name) {
          fail_taken(gas.place_of("friction"), element.name, other.line);
        }
      }
      scene_.elements.push_back(std::move(element));
    });
  }

  void add_stops_of_struts() {
    each_strut([&](const TomlTable& gas, std::size_t strut) {
      const Element& element = scene_.elements[strut];
      const auto& law = std::get<GasStrut>(element.law);
      for (const Stop& other : scene_.stops) {
        if (other.name == element.name) fail_taken(gas.place(), element.name, other.line);
      }
      Stop stop{.name = element.name, .on = element.on, .line = gas.place().line_in_document()};
      hold_in_stroke(stop, law);
      scene_.stops.push_back(std::move(stop));
    });
  }

  void read_loads() {
    const std::vector<TomlTable> forces = root_.tables("force");
    const std::vector<TomlTable> distributed = root_.tables("distributed_load");
    const std::vector<TomlTable> torques = root_.tables("torque");
    // All loads share one set of names, because load.NAME must be unique.
    std::vector<TomlTable> loads = forces;
    loads.insert(loads.end(), distributed.begin(), distributed.end());
    loads.insert(loads.end(), torques.begin(), torques.end());
    std::vector<std::string> defaults = numbered("force", forces.size());
    for (std::string& name : numbered("distributed load", distributed.size())) defaults.push_back(std::move(name));
    for (std::string& name : numbered("torque", torques.size())) defaults.push_back(std::move(name));
    const std::vector<std::string> names = names_of(loads, defaults, {});
    for (std::size_t i = 0; i < loads.size(); ++i) {
      if (i < forces.size() + distributed.size())
        read_time(loads[i], TimeFunction::Of::force, scene_.forces.size(), nullptr);
      else
        read_time(loads[i], TimeFunction::Of::torque, scene_.torques.size(), nullptr);
      if (i < forces.size())
        add(loads[i], names[i], scene_.forces, &ElementReader::read_force);
      else if (i < forces.size() + distributed.size())
        add(loads[i], names[i], scene_.forces, &ElementReader::read_distributed_load);
      else
        add(loads[i], names[i], scene_.torques, &ElementReader::read_torque);
    }
  }

  void read_time(const TomlTable& table, TimeFunction::Of of, std::size_t item, const Measure* on) {
    if (std::optional<TimeLaw> law = read_time_law(table, "time", on)) {
      scene_.time_functions.push_back({of, static_cast<int>(item), std::move(*law), table.place_of("time").line});
    }
  }

  /// In the table `time` of a spring a factor for each of its numbers that varies.
  void read_times_of_springs() {
    std::map<std::string_view, std::size_t> next;  // of each list of tables
    for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
      const Element& element = scene_.elements[e];
      const std::vector<TomlTable> tables = root_.tables(element.table);
      const std::size_t at = next[element.table]++;
      if (at >= tables.size() || !tables[at].has("time")) continue;
      if (!tables[at].holds_table("time")) {
        tables[at].place_of("time").fail(
            "expected a table, say time = { stiffness = { sine = { amplitude = 0.1, frequency = 2, offset = 1 } } }");
      }
      const TomlTable time = *tables[at].find_table("time");
      const std::span<const Number> numbers = numbers_of(element.law);
      Keys keys;
      for (const Number& number : numbers) {
        // Numbers of points of a curve do not vary, nor do the period and the delay of a controller, which are behind
        // those that do.
        const bool is_of_past = element.feedback && (number.key == "period" || number.key == "delay");
        if (number.key.find('.') == std::string_view::npos && !is_of_past) keys.push_back(number.key_on(&element.on));
      }
      time.allow_keys(keys);
      for (std::size_t k = 0; k < keys.size(); ++k) {
        if (std::optional<TimeLaw> law = read_time_law(time, keys[k], nullptr)) {
          TimeFunction function{TimeFunction::Of::element, static_cast<int>(e), std::move(*law),
                                time.place_of(keys[k]).line};
          function.part = static_cast<int>(k);
          scene_.time_functions.push_back(std::move(function));
        }
      }
    }
  }

  void read_times_of_drives() {
    const std::vector<TomlTable> tables = root_.tables("drive");
    for (std::size_t i = 0; i < tables.size(); ++i) {
      read_time(tables[i], TimeFunction::Of::drive, i, &scene_.drives[i].on);
    }
  }

  /// Either vector, or direction and size.
  void read_vector(const TomlTable& table, const Dimension& dimension, Force& force) const {
    if (!table.has("direction") && !table.has("size")) {
      force.vector = table.vector("vector", table.unit(dimension));
      return;
    }
    if (table.has("vector")) {
      table.place_of("vector").fail("expected vector, or direction and size, found both; leave one out");
    }
    const Vec2 along = table.vector("direction", 1.0);
    if (along == Vec2{}) {
      table.place_of("direction").fail("expected a direction, found [0, 0]; give for example [0, 1]");
    }
    force.along = direction<double>(along);
    force.vector = table.number("size", table.unit(dimension), Range::finite) * force.along;
  }

  Force read_force(const TomlTable& table) const {
    table.allow_keys({"name", "at", "vector", "direction", "size", "follows", "time"});
    Force force;
    const TomlText at = table.text("at");
    force.at = names_.point(at);
    if (force.at.body == 0) at.place.fail("expected a point of a body that can move, found one of the ground");
    read_vector(table, Force::concentrated[0].dimension, force);
    if (const auto follows = table.find_text("follows")) force.follows = names_.movable_body(*follows);
    return force;
  }

  Force read_distributed_load(const TomlTable& table) const {
    table.allow_keys({"name", "points", "vector", "direction", "size", "follows", "time"});
    Force force;
    const std::array<TomlText, 2> points = table.two_texts("points");
    force.at = names_.point(points[0]);
    force.to = names_.point(points[1]);
    if (force.at.body == 0) points[0].place.fail("expected points of a body that can move, found one of the ground");
    for (const FlexibleLink& link : scene_.flexible_links) {
      if (std::find(link.bodies.begin(), link.bodies.end(), force.at.body) == link.bodies.end()) continue;
      points[0].place.fail("expected points of a rigid body; \"" + link.name +
                           "\" is flexible and carries forces at its points, and its own weight along its line");
    }
    if (force.to->body != force.at.body) {
      points[1].place.fail("expected two points of one body, the ends of the line that the load is on");
    }
    if (scene_.local(force.at) == scene_.local(*force.to)) {
      points[1].place.fail("expected two points that are apart, the ends of the line that the load is on");
    }
    read_vector(table, Force::distributed[0].dimension, force);
    if (const auto follows = table.find_text("follows")) force.follows = names_.movable_body(*follows);
    return force;
  }

  Torque read_torque(const TomlTable& table) const {
    table.allow_keys({"name", table.has("at") ? "at" : "on", "value", "time"});
    Torque torque;
    if (table.has("at")) {
      const TomlText at = table.text("at");
      const PointRef point = names_.point(at);
      if (point.body == 0) at.place.fail("expected a point of a body that can move, found one of the ground");
      torque.body = point.body;
      torque.point = point.point;
    } else {
      torque.body = names_.movable_body(table.text("on"));
    }
    torque.value = table.number("value", table.unit(dimension::torque), Range::finite);
    return torque;
  }

  Drive read_drive(const TomlTable& table) const {
    Drive drive;
    Keys keys;
    for (const Number& number : Drive::numbers) {
      keys.push_back(number.key);
      if (!table.has("time") || !table.has(number.key)) continue;
      table.place_of(number.key)
          .fail("expected no " + std::string(number.key) +
                " beside time, which gives the value at every time; leave one out");
    }
    keys.push_back("time");
    drive.on = measures_.read(table, all_measures(), keys);
    read_numbers(table, Drive::numbers, &drive, &drive.on);
    return drive;
  }

  /// Stops with a stiffness yield: they are force elements.
  void read_stops() {
    const std::vector<TomlTable> tables = root_.tables("stop");
    const std::vector<std::string> names = names_of(tables, numbered("stop", tables.size()), {});
    for (std::size_t i = 0; i < tables.size(); ++i) {
      if (tables[i].has("stiffness")) {
        add(tables[i], names[i], scene_.elements, &ElementReader::read_compliant_stop);
        continue;
      }
      for (const std::string_view key : {"damping", "exponent"}) {
        if (tables[i].has(key)) {
          tables[i].place_of(key).fail("expected the key stiffness beside it, of a stop that yields; add it");
        }
      }
      add(tables[i], names[i], scene_.stops, &ElementReader::read_stop);
    }
  }

  Element read_compliant_stop(const TomlTable& table) const {
    CompliantStop law;
    law.has_min = table.has("min");
    law.has_max = table.has("max");
    if (!law.has_min && !law.has_max) table.place().fail("expected the key min, max or both; add max = NUMBER");
    Element element;
    element.table = "stop";
    Keys keys;
    for (const Number& number : CompliantStop::numbers) keys.push_back(number.key);
    element.on = measures_.read(table, all_measures(), keys);
    law.unit = table.unit(element.on.dimension());
    constexpr double unlimited = std::numeric_limits<double>::infinity();
    law.min = -unlimited;
    law.max = unlimited;
    read_numbers(table, law.all_numbers(), &law, &element.on);
    if (!law.has_min) law.min = 0.0;
    if (!law.has_max) law.max = 0.0;
    element.law = law;
    return element;
  }

  Stop read_stop(const TomlTable& table) const {
    Stop stop;
    stop.on = measures_.read(table, all_measures(), {"min", "max", "restitution", "law", "friction"});
    const double unit = table.unit(stop.on.dimension());
    stop.min = table.find_number("min", unit, stop.on.range()).value_or(stop.min);
    stop.max = table.find_number("max", unit, stop.on.range()).value_or(stop.max);
    if (!table.has("min") && !table.has("max")) {
      table.place().fail("expected the key min, max or both; add max = NUMBER");
    }
    if (!(stop.min <= stop.max)) table.place_of("max").fail("expected max >= min; exchange them");
    read_numbers(table, std::span(Stop::limits).subspan(2), &stop, &stop.on);
    read_impact(table, stop);
    if (stop.friction && !stop.tangent()) {
      table.place_of("friction")
          .fail(
              "expected a stop on x or y of a point, which has a direction to slide in; give the friction of its "
              "joints");
    }
    return stop;
  }

  Blade read_blade(const TomlTable& table) const {
    table.allow_keys({"name", "at", "angle", "on"});
    Blade blade;
    const TomlText at = table.text("at");
    blade.at = names_.point(at);
    if (blade.at.body == 0) at.place.fail("expected a point of a body that can move, found one of the ground");
    read_numbers(table, Blade::numbers, &blade, nullptr);
    const auto on = table.find_text("on");
    if (!on) return blade;
    blade.on = names_.body(*on);
    if (blade.on == blade.at.body) on->place.fail("expected another body than that of the blade's point");
    if (blade.on != 0 && scene_.bodies[static_cast<std::size_t>(blade.on)].points.empty()) {
      on->place.fail("expected a body with a point, from which the blade's place is measured; give it one");
    }
    return blade;
  }

  const TomlTable& root_;
  const SceneNames& names_;
  MeasureReader measures_;
  Scene& scene_;
};

}  // namespace

std::vector<std::string> numbered(std::string_view what, std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= count; ++i) names.push_back(std::string(what) + " " + std::to_string(i));
  return names;
}

void read_numbers(const TomlTable& table, std::span<const Number> numbers, void* item, const Measure* on) {
  for (const Number& number : numbers) {
    const std::string_view key = number.key_on(on);
    const double unit = table.unit(number.dimension_on(on));
    const Range range = number.range_on(on);
    const std::optional<double> value =
        number.needed_on(on) ? table.number(key, unit, range) : table.find_number(key, unit, range);
    if (value) located(table.place_of(key), [&] { number.set(item, *value); });
  }
}

void read_impact(const TomlTable& table, Stop& stop) {
  // A value that is not known yet is that of both limits.
  const bool holds = stop.holds() || (std::isnan(stop.min) && std::isnan(stop.max));
  for (const std::string_view key : {"restitution", "law"}) {
    if (stop.table == "cam" && key == "law") continue;  // it is that of its lift
    if (holds && table.has(key)) {
      table.place_of(key).fail("expected no " + std::string(key) +
                               " of what holds its measure on both sides, so that nothing hits; leave it out");
    }
  }
  if (stop.table == "cam") return;
  if (const std::optional<TomlText> law = table.find_text("law")) {
    stop.impact_law = static_cast<ImpactLaw>(choose(*law, {"energetic", "newton", "poisson"}));
  }
}

std::vector<std::string_view> element_tables() {
  std::vector<std::string_view> keys;
  const auto add = [&]<class... L>(std::type_identity<std::variant<L...>>) {
    const auto add_law = [&](const auto& tables) {
      for (const LawTable& table : tables) {
        if (std::find(keys.begin(), keys.end(), table.key) == keys.end()) keys.emplace_back(table.key);
      }
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

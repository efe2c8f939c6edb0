#include "model/read_elements.hpp"

#include <tuple>
#include <utility>

#include "model/quantities.hpp"

namespace poise {
namespace {

std::vector<std::string> numbered(const std::string& what, std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= count; ++i) names.push_back(what + " " + std::to_string(i));
  return names;
}

class ElementReader {
 public:
  ElementReader(const TomlTable& root, const SceneNames& names, Scene& scene)
      : root_(root), names_(names), scene_(scene), units_(scene.units) {}

  void read() {
    read_family("spring", "spring", scene_.springs, &ElementReader::read_spring);
    read_family("torsion_spring", "torsion spring", scene_.torsion_springs, &ElementReader::read_torsion_spring);
    read_family("damper", "damper", scene_.dampers, &ElementReader::read_damper);
    read_family("torsion_damper", "torsion damper", scene_.torsion_dampers, &ElementReader::read_torsion_damper);
    read_family("friction", "friction", scene_.frictions, &ElementReader::read_friction);
    read_family("drive", "drive", scene_.drives, &ElementReader::read_drive);
    read_loads();
    read_family("stop", "stop", scene_.stops, &ElementReader::read_stop);
  }

 private:
  /// The tables [[key]], which share one family of names: "WHAT 1", ... where none are given.
  template <class Element>
  void read_family(std::string_view key, const std::string& what, std::vector<Element>& family,
                   Element (ElementReader::*read_one)(const TomlTable&) const) {
    const std::vector<TomlTable> tables = root_.tables(key);
    const std::vector<std::string> names = names_of(tables, numbered(what, tables.size()), {});
    for (std::size_t i = 0; i < tables.size(); ++i) add(tables[i], names[i], family, read_one);
  }

  template <class Element>
  void add(const TomlTable& table, const std::string& name, std::vector<Element>& family,
           Element (ElementReader::*read_one)(const TomlTable&) const) {
    Element element = (this->*read_one)(table);
    element.name = name;
    element.line = table.place().line;
    family.push_back(std::move(element));
  }

  Spring read_spring(const TomlTable& table) const {
    table.allow_keys({"name", "points", "stiffness", "free_length", "acts"});
    Spring spring;
    std::tie(spring.a, spring.b) = names_.two_points(table);
    spring.stiffness = table.number("stiffness", stiffness_unit(units_), Range::not_negative);
    spring.free_length = table.number("free_length", units_.length, Range::not_negative);
    if (const auto acts = table.find_text("acts")) {
      constexpr Spring::Acts meanings[] = {Spring::Acts::both, Spring::Acts::tension, Spring::Acts::compression};
      spring.acts = meanings[choose(*acts, {"both", "tension", "compression"})];
    }
    return spring;
  }

  TorsionSpring read_torsion_spring(const TomlTable& table) const {
    table.allow_keys({"name", "bodies", "stiffness", "free_angle"});
    TorsionSpring spring;
    std::tie(spring.a, spring.b) = names_.two_bodies(table);
    spring.stiffness = table.number("stiffness", torsional_stiffness_unit(units_), Range::not_negative);
    spring.free_angle = table.find_number("free_angle", units_.angle, Range::finite).value_or(0.0);
    return spring;
  }

  Damper read_damper(const TomlTable& table) const {
    table.allow_keys({"name", "points", "coefficient"});
    Damper damper;
    std::tie(damper.a, damper.b) = names_.two_points(table);
    damper.coefficient = table.number("coefficient", damping_unit(units_), Range::not_negative);
    return damper;
  }

  TorsionDamper read_torsion_damper(const TomlTable& table) const {
    table.allow_keys({"name", "bodies", "coefficient"});
    TorsionDamper damper;
    std::tie(damper.a, damper.b) = names_.two_bodies(table);
    damper.coefficient = table.number("coefficient", torsional_damping_unit(units_), Range::not_negative);
    return damper;
  }

  Friction read_friction(const TomlTable& table) const {
    table.allow_keys({"name", "bodies", "torque", "width"});
    Friction friction;
    std::tie(friction.a, friction.b) = names_.two_bodies(table);
    friction.torque = table.number("torque", torque_unit(units_), Range::not_negative);
    friction.width = table.find_number("width", units_.angle, Range::positive).value_or(friction.width);
    return friction;
  }

  Drive read_drive(const TomlTable& table) const {
    table.allow_keys({"name", "bodies", "slide", "start", "rate", "acceleration", "amplitude", "frequency", "phase"});
    if (table.has("bodies") == table.has("slide")) {
      table.place().fail("expected one of the keys bodies (relative angle), slide (travel)");
    }
    Drive drive;
    if (table.has("bodies")) {
      drive.kind = Drive::Kind::angle;
      std::tie(drive.body_a, drive.body_b) = names_.two_bodies(table);
    } else {
      drive.kind = Drive::Kind::travel;
      drive.joint = names_.travelling_joint(table.text("slide"));
    }
    const double unit = drive_unit(drive.kind, units_);
    drive.start = table.find_number("start", unit, Range::finite);
    drive.rate = table.find_number("rate", unit, Range::finite).value_or(0.0);
    drive.acceleration = table.find_number("acceleration", unit, Range::finite).value_or(0.0);
    drive.amplitude = table.find_number("amplitude", unit, Range::finite).value_or(0.0);
    drive.frequency = table.find_number("frequency", 1.0, Range::not_negative).value_or(0.0);
    drive.phase = table.find_number("phase", units_.angle, Range::finite).value_or(0.0);
    return drive;
  }

  void read_loads() {
    const std::vector<TomlTable> forces = root_.tables("force");
    const std::vector<TomlTable> torques = root_.tables("torque");
    // One family of names, for load.NAME must mean one load.
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
    torque.value = table.number("value", torque_unit(units_), Range::finite);
    return torque;
  }

  Stop read_stop(const TomlTable& table) const {
    table.allow_keys({"name", "bodies", "points", "slide", "min", "max"});
    Stop stop = read_stopped(table);
    const double unit = stop_unit(stop.kind, units_);
    const Range range = stop_range(stop.kind);
    stop.min = table.find_number("min", unit, range).value_or(stop.min);
    stop.max = table.find_number("max", unit, range).value_or(stop.max);
    if (!table.has("min") && !table.has("max")) {
      table.place().fail("expected the key min, max or both; add max = NUMBER");
    }
    if (!(stop.min <= stop.max)) table.place_of("max").fail("expected max >= min; exchange them");
    return stop;
  }

  /// The quantity that a stop limits.
  Stop read_stopped(const TomlTable& table) const {
    if (table.has("bodies") + table.has("points") + table.has("slide") != 1) {
      table.place().fail("expected one of the keys bodies (relative angle), points (distance), slide (travel)");
    }
    Stop stop;
    if (table.has("bodies")) {
      stop.kind = Stop::Kind::angle;
      std::tie(stop.body_a, stop.body_b) = names_.two_bodies(table);
    } else if (table.has("points")) {
      stop.kind = Stop::Kind::distance;
      std::tie(stop.a, stop.b) = names_.two_points(table);
    } else {
      stop.kind = Stop::Kind::travel;
      stop.joint = names_.travelling_joint(table.text("slide"));
    }
    return stop;
  }

  const TomlTable& root_;
  const SceneNames& names_;
  Scene& scene_;
  const Units& units_;
};

}  // namespace

void read_elements(const TomlTable& root, const SceneNames& names, Scene& scene) {
  ElementReader(root, names, scene).read();
}

}  // namespace poise

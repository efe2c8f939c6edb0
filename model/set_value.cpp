#include <array>
#include <string>
#include <vector>

#include "model/nearest_name.hpp"
#include "model/quantities.hpp"
#include "model/scene.hpp"

namespace poise {
namespace {

/// The path of a number, "kind.name.point.field"; parts that are empty are left out.
struct ValuePath {
  std::array<std::string_view, 4> parts;

  std::string text() const {
    std::string joined;
    for (const std::string_view part : parts) {
      if (!part.empty()) joined += (joined.empty() ? "" : ".") + std::string(part);
    }
    return joined;
  }

  /// text() == path, without making the text: names may hold dots, so the path is not taken apart.
  bool is(std::string_view path) const {
    bool first = true;
    for (const std::string_view part : parts) {
      if (part.empty()) continue;
      if (!first) {
        if (!path.starts_with('.')) return false;
        path.remove_prefix(1);
      }
      first = false;
      if (!path.starts_with(part)) return false;
      path.remove_prefix(part.size());
    }
    return path.empty();
  }
};

ValuePath path_of(std::string_view kind, std::string_view name, std::string_view field = "") {
  return {{kind, name, "", field}};
}

[[noreturn]] void fail(const ValuePath& path, const std::string& message) {
  throw InputError(path.text() + ": " + message);
}

// Ways in which a scene keeps a number, SI. What they refer to may be const as long as nobody writes.

template <class Number>
struct Plain {
  Number& number;

  double read(const ValuePath&) const { return number; }
  void write(double value, const ValuePath&) const { number = value; }
};

template <class AnyForce>
struct Magnitude {
  AnyForce& force;

  double read(const ValuePath&) const { return norm(force.vector); }
  void write(double value, const ValuePath& path) const {
    const double magnitude = norm(force.vector);
    if (magnitude == 0.0) fail(path, "expected a force with a direction, its vector is [0, 0]; give another vector");
    force.vector = {force.vector.x / magnitude * value, force.vector.y / magnitude * value};
  }
};

template <class AnyStop>
struct Limit {
  AnyStop& stop;
  bool is_max;

  double read(const ValuePath&) const { return is_max ? stop.max : stop.min; }
  void write(double value, const ValuePath& path) const {
    const double min = is_max ? stop.min : value;
    const double max = is_max ? value : stop.max;
    if (!(min <= max)) fail(path, "expected min <= max; set the other limit first");
    stop.min = min;
    stop.max = max;
  }
};

template <class Optional>
struct Guess {
  Optional& guess;

  double read(const ValuePath&) const { return guess.value_or(0.0); }
  void write(double value, const ValuePath&) const { guess = value; }
};

template <class Optional>
struct DriveStart {
  Optional& start;

  double read(const ValuePath& path) const {
    if (!start) fail(path, "expected a drive with a start, this one begins where the mechanism stands; give it one");
    return *start;
  }
  void write(double value, const ValuePath&) const { start = value; }
};

template <class Number>
Plain(Number&) -> Plain<Number>;
template <class AnyForce>
Magnitude(AnyForce&) -> Magnitude<AnyForce>;
template <class AnyStop>
Limit(AnyStop&, bool) -> Limit<AnyStop>;
template <class Optional>
Guess(Optional&) -> Guess<Optional>;
template <class Optional>
DriveStart(Optional&) -> DriveStart<Optional>;

/// Calls visit(path, unit, range, number) for every number of the scene that has a path, with one of the above.
template <class AnyScene, class Visit>
void visit_values(AnyScene& scene, Visit visit) {
  const Units& units = scene.units;
  const auto visit_vector = [&](std::string_view kind, std::string_view name, std::string_view point, auto& vector,
                                std::string_view x, std::string_view y) {
    visit(ValuePath{{kind, name, point, x}}, units.length, Range::finite, Plain{vector.x});
    visit(ValuePath{{kind, name, point, y}}, units.length, Range::finite, Plain{vector.y});
  };
  visit_vector("gravity", "", "", scene.gravity, "x", "y");
  for (auto& force : scene.forces) {
    visit(path_of("load", force.name), units.force, Range::not_negative, Magnitude{force});
  }
  for (auto& torque : scene.torques) {
    visit(path_of("load", torque.name), torque_unit(units), Range::finite, Plain{torque.value});
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    auto& body = scene.bodies[i];
    for (auto& point : body.points) visit_vector("point", body.name, point.name, point.at, "x", "y");
    if (i == 0) continue;
    visit(path_of("body", body.name, "mass"), units.mass, Range::not_negative, Plain{body.mass});
    visit(path_of("body", body.name, "inertia"), inertia_unit(units), Range::not_negative, Plain{body.inertia});
    visit_vector("body", body.name, "", body.center, "center.x", "center.y");
    visit(path_of("start", body.name), units.angle, Range::finite, Guess{scene.start.angle.at(i)});
  }
  for (auto& spring : scene.springs) {
    visit(path_of("spring", spring.name, "stiffness"), stiffness_unit(units), Range::not_negative,
          Plain{spring.stiffness});
    visit(path_of("spring", spring.name, "free_length"), units.length, Range::not_negative, Plain{spring.free_length});
  }
  for (auto& spring : scene.torsion_springs) {
    visit(path_of("torsion_spring", spring.name, "stiffness"), torsional_stiffness_unit(units), Range::not_negative,
          Plain{spring.stiffness});
    visit(path_of("torsion_spring", spring.name, "free_angle"), units.angle, Range::finite, Plain{spring.free_angle});
  }
  for (auto& damper : scene.dampers) {
    visit(path_of("damper", damper.name, "coefficient"), damping_unit(units), Range::not_negative,
          Plain{damper.coefficient});
  }
  for (auto& damper : scene.torsion_dampers) {
    visit(path_of("torsion_damper", damper.name, "coefficient"), torsional_damping_unit(units), Range::not_negative,
          Plain{damper.coefficient});
  }
  for (auto& friction : scene.frictions) {
    visit(path_of("friction", friction.name, "torque"), torque_unit(units), Range::not_negative,
          Plain{friction.torque});
    visit(path_of("friction", friction.name, "width"), units.angle, Range::positive, Plain{friction.width});
  }
  for (auto& drive : scene.drives) {
    const double unit = drive_unit(drive.kind, units);
    visit(path_of("drive", drive.name, "start"), unit, Range::finite, DriveStart{drive.start});
    visit(path_of("drive", drive.name, "rate"), unit, Range::finite, Plain{drive.rate});
    visit(path_of("drive", drive.name, "acceleration"), unit, Range::finite, Plain{drive.acceleration});
    visit(path_of("drive", drive.name, "amplitude"), unit, Range::finite, Plain{drive.amplitude});
    visit(path_of("drive", drive.name, "frequency"), 1.0, Range::not_negative, Plain{drive.frequency});
    visit(path_of("drive", drive.name, "phase"), units.angle, Range::finite, Plain{drive.phase});
  }
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    auto& joint = scene.joints[i];
    if (joint.kind == Joint::Kind::bar) {
      visit(path_of("bar", joint.name, "length"), units.length, Range::positive, Plain{joint.length});
    }
    if (joint.has_travel()) {
      visit(path_of("start", joint.name), units.length, Range::finite, Guess{scene.start.travel.at(i)});
    }
  }
  for (auto& stop : scene.stops) {
    const double unit = stop_unit(stop.kind, units);
    const Range range = stop_range(stop.kind);
    visit(path_of("stop", stop.name, "min"), unit, range, Limit{stop, false});
    visit(path_of("stop", stop.name, "max"), unit, range, Limit{stop, true});
  }
}

/// Calls use(path, unit, range, number) for the one number that has this path.
template <class AnyScene, class Use>
void at_path(AnyScene& scene, std::string_view path, Use use) {
  int found = 0;
  visit_values(scene, [&](const ValuePath& candidate, auto...) { found += candidate.is(path); });
  // Only a scene built in code can have two of the same name.
  if (found > 1) throw InputError(std::string(path) + ": expected one value, found several; give them different names");
  if (found == 0) {
    std::vector<std::string> valid;
    visit_values(scene, [&](const ValuePath& candidate, auto...) { valid.push_back(candidate.text()); });
    throw InputError(std::string(path) + ": expected the path of a number of the scene" + did_you_mean(path, valid));
  }
  visit_values(scene, [&](const ValuePath& candidate, double unit, Range range, auto number) {
    if (candidate.is(path)) use(candidate, unit, range, number);
  });
}

}  // namespace

void set_value(Scene& scene, std::string_view path, double value) {
  at_path(scene, path, [&](const ValuePath& at, double unit, Range range, auto number) {
    if (!contains(range, value * unit)) fail(at, out_of_range(range, value));
    number.write(value * unit, at);
  });
}

double get_value(const Scene& scene, std::string_view path) {
  double value = 0.0;
  at_path(scene, path, [&](const ValuePath& at, double unit, Range, auto number) { value = number.read(at) / unit; });
  return value;
}

double value_unit(const Scene& scene, std::string_view path) {
  double result = 0.0;
  at_path(scene, path, [&](const ValuePath&, double unit, Range, auto) { result = unit; });
  return result;
}

}  // namespace poise

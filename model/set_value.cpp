#include <functional>
#include <string>
#include <vector>

#include "model/nearest_name.hpp"
#include "model/quantities.hpp"
#include "model/scene.hpp"

namespace poise {
namespace {

/// The path "kind.name.field" of a number, or "kind.name" when the field is empty.
struct ValuePath {
  std::string_view kind;
  std::string_view name;
  std::string_view field;

  std::string text() const {
    return std::string(kind) + "." + std::string(name) + (field.empty() ? "" : "." + std::string(field));
  }

  /// text() == path, without making the text: names may hold dots, so the path is not taken apart.
  bool is(std::string_view path) const {
    const std::size_t tail = field.empty() ? 0 : field.size() + 1;
    const std::size_t head = kind.size() + 1;
    return path.size() == head + name.size() + tail && path.starts_with(kind) && path[kind.size()] == '.' &&
           path.substr(head, name.size()) == name && path.ends_with(field) &&
           (tail == 0 || path[head + name.size()] == '.');
  }
};

[[noreturn]] void fail(const ValuePath& path, const std::string& message) {
  throw InputError(path.text() + ": " + message);
}

void set_magnitude(Force& force, double value, const ValuePath& path) {
  const double magnitude = norm(force.vector);
  if (magnitude == 0.0) fail(path, "expected a force with a direction, its vector is [0, 0]; give another vector");
  force.vector = {force.vector.x / magnitude * value, force.vector.y / magnitude * value};
}

void set_limits(Stop& stop, double min, double max, const ValuePath& path) {
  if (!(min <= max)) fail(path, "expected min <= max; set the other limit first");
  stop.min = min;
  stop.max = max;
}

/// Calls visit(path, unit, range, set) for every number of the scene that has a path; set(value) takes it in SI.
template <class Visit>
void visit_values(Scene& scene, Visit visit) {
  const Units& units = scene.units;
  const auto visit_number = [&](const ValuePath& path, double unit, Range range, double& number) {
    visit(path, unit, range, [&number](double value) { number = value; });
  };
  for (Force& force : scene.forces) {
    const ValuePath path{"load", force.name, ""};
    visit(path, units.force, Range::not_negative, [&force, path](double value) { set_magnitude(force, value, path); });
  }
  for (Torque& torque : scene.torques) {
    visit_number({"load", torque.name, ""}, torque_unit(units), Range::finite, torque.value);
  }
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    Body& body = scene.bodies[i];
    visit_number({"body", body.name, "mass"}, units.mass, Range::not_negative, body.mass);
    visit_number({"body", body.name, "inertia"}, inertia_unit(units), Range::not_negative, body.inertia);
    visit({"start", body.name, ""}, units.angle, Range::finite,
          [&scene, i](double value) { scene.start.angle.at(i) = value; });
  }
  for (Spring& spring : scene.springs) {
    visit_number({"spring", spring.name, "stiffness"}, stiffness_unit(units), Range::not_negative, spring.stiffness);
    visit_number({"spring", spring.name, "free_length"}, units.length, Range::not_negative, spring.free_length);
  }
  for (TorsionSpring& spring : scene.torsion_springs) {
    visit_number({"torsion_spring", spring.name, "stiffness"}, torsional_stiffness_unit(units), Range::not_negative,
                 spring.stiffness);
    visit_number({"torsion_spring", spring.name, "free_angle"}, units.angle, Range::finite, spring.free_angle);
  }
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    Joint& joint = scene.joints[i];
    if (joint.kind == Joint::Kind::bar) {
      visit_number({"bar", joint.name, "length"}, units.length, Range::positive, joint.length);
    }
    if (joint.has_travel()) {
      visit({"start", joint.name, ""}, units.length, Range::finite,
            [&scene, i](double value) { scene.start.travel.at(i) = value; });
    }
  }
  for (Stop& stop : scene.stops) {
    const double unit = stop_unit(stop.kind, units);
    const Range range = stop_range(stop.kind);
    const ValuePath min{"stop", stop.name, "min"};
    const ValuePath max{"stop", stop.name, "max"};
    visit(min, unit, range, [&stop, min](double value) { set_limits(stop, value, stop.max, min); });
    visit(max, unit, range, [&stop, max](double value) { set_limits(stop, stop.min, value, max); });
  }
}

}  // namespace

void set_value(Scene& scene, std::string_view path, double value) {
  int found = 0;
  std::function<void()> set_found;
  visit_values(scene, [&](const ValuePath& candidate, double unit, Range range, auto set) {
    if (!candidate.is(path)) return;
    if (!contains(range, value * unit)) fail(candidate, out_of_range(range, value));
    ++found;
    set_found = [set, si = value * unit] { set(si); };
  });
  if (found == 1) return set_found();
  // Only a scene built in code can have two of the same name.
  if (found > 1) throw InputError(std::string(path) + ": expected one value, found several; give them different names");
  std::vector<std::string> valid;
  visit_values(scene, [&](const ValuePath& candidate, double, Range, auto) { valid.push_back(candidate.text()); });
  throw InputError(std::string(path) + ": expected the path of a number of the scene" + did_you_mean(path, valid));
}

}  // namespace poise

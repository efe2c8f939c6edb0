#include "app/forces_files.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "app/csv_file.hpp"
#include "app/json_parts.hpp"
#include "app/kinematics_files.hpp"
#include "app/report/parts.hpp"

namespace poise::app {
namespace {

constexpr std::size_t most_curves = 12;

std::vector<double> shown(const ForceCourse& course, const Units& units) {
  return in_unit(course.value, course.quantity, units);
}

std::vector<double> places(const ForcesAnswer& answer, const Units& units) {
  return answer.measure ? in_unit(answer.at, *answer.measure, units) : answer.at;
}

/// What a stop carries in one pose: 0 where it does not press.
double stop_force(const Stop& stop, const Forces& forces) {
  for (const Reaction& r : forces.reactions) {
    if (r.kind == "stop" && r.name == stop.name) return stop.on.is_angle() ? r.moment : r.axial;
  }
  return 0.0;
}

}  // namespace

bool ForcesAnswer::balanced() const {
  return std::all_of(poses.begin(), poses.end(),
                     [&](const Forces& f) { return f.imbalance <= tolerance * f.largest_force; });
}

std::vector<ForceCourse> force_courses(const Scene& scene, const ForcesAnswer& answer) {
  std::vector<ForceCourse> out;
  const auto add = [&](const std::string& name, Quantity quantity, auto value) {
    ForceCourse course{name, quantity, {}};
    for (const Forces& forces : answer.poses) course.value.push_back(value(forces));
    out.push_back(std::move(course));
  };
  if (answer.poses.empty()) return out;
  const std::vector<DriveEffort>& drives = answer.poses.front().drives;
  for (std::size_t k = 0; k < drives.size(); ++k) {
    add("effort." + drives[k].name, drives[k].is_angle ? Quantity::moment : Quantity::force,
        [k](const Forces& f) { return f.drives[k].value; });
    add("power." + drives[k].name, Quantity::energy, [k](const Forces& f) { return f.drives[k].power; });
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const std::string name = "reaction." + scene.joints[j].name;
    add(name + ".x", Quantity::force, [j](const Forces& f) { return f.reactions[j].force.x; });
    add(name + ".y", Quantity::force, [j](const Forces& f) { return f.reactions[j].force.y; });
    if (!scene.joints[j].keeps_angle()) continue;
    add(name + ".moment", Quantity::moment, [j](const Forces& f) { return f.reactions[j].moment; });
  }
  for (const Stop& stop : scene.stops) {
    add("stop." + stop.name, effort_of(stop.on), [&stop](const Forces& f) { return stop_force(stop, f); });
  }
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const Element& element = scene.elements[i];
    const double sign = element.on.is_angle() ? -1.0 : 1.0;
    add(element.table + "." + element.name, effort_of(element.on),
        [i, sign](const Forces& f) { return sign * f.element_force[i]; });
  }
  add("imbalance", Quantity::force, [](const Forces& f) { return f.imbalance; });
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    if (std::none_of(answer.poses.begin(), answer.poses.end(), [s](const Forces& f) { return f.overrun[s] > 0.0; })) {
      continue;
    }
    add("overrun." + scene.stops[s].name, quantity_of(scene.stops[s].on),
        [s](const Forces& f) { return f.overrun[s]; });
  }
  return out;
}

std::string forces_csv(const Scene& scene, const ForcesAnswer& answer) {
  std::vector<std::string> header;
  std::vector<std::vector<double>> columns;
  if (!answer.at.empty()) {
    header.push_back(answer.along);
    columns.push_back(places(answer, scene.units));
  }
  for (const ForceCourse& course : force_courses(scene, answer)) {
    header.push_back(course.name);
    columns.push_back(shown(course, scene.units));
  }
  return csv_text(header, columns);
}

std::vector<LoadedParallel> loaded_parallels(const MotionModel& model, const ForcesAnswer& answer) {
  std::vector<LoadedParallel> out;
  const std::vector<ForceCourse> courses = force_courses(model.scene(), answer);
  for (const ParallelElement& parallel : parallel_elements(model, model.scene().drives)) {
    const Element& element = model.scene().elements[parallel.element];
    const auto course = std::find_if(courses.begin(), courses.end(), [&](const ForceCourse& c) {
      return c.name == element.table + "." + element.name;
    });
    if (course == courses.end()) continue;
    if (std::any_of(course->value.begin(), course->value.end(), [](double v) { return v != 0.0; })) {
      out.push_back({element, parallel.drive, *course});
    }
  }
  return out;
}

std::string forces_json(const MotionModel& model, const ForcesAnswer& answer,
                        const std::vector<std::string>& settings) {
  const Scene& scene = model.scene();
  const auto numbers = [](const std::vector<double>& values) {
    Json out = Json::array();
    for (double v : values) out.push_back(json_number(v));
    return out;
  };
  Json out = {{"poise", POISE_VERSION},
              {"scene", json_scene(scene, settings)},
              {"units", json_units(scene.units)},
              {"how", answer.how},
              {"complete", answer.complete},
              {"why", answer.why},
              {"stop", json_stop(answer.stop, scene)},
              {"parallel", Json::array()},
              {"balanced", answer.balanced()},
              {"along", answer.along},
              {"at", numbers(places(answer, scene.units))},
              {"forces", Json::object()}};
  for (const ForceCourse& course : force_courses(scene, answer)) {
    out["forces"][course.name] = numbers(shown(course, scene.units));
  }
  for (const LoadedParallel& parallel : loaded_parallels(model, answer)) {
    out["parallel"].push_back({{"element", parallel.course.name}, {"drive", parallel.drive}});
  }
  std::set<std::string> undetermined, idle;
  double work = 0.0, power = 0.0;
  for (const Forces& forces : answer.poses) {
    for (const Reaction& r : forces.reactions) {
      if (!r.determined) undetermined.insert(r.name);
    }
    for (const DriveEffort& d : forces.drives) {
      if (!d.determined) undetermined.insert(d.name);
    }
    idle.insert(forces.idle_stops.begin(), forces.idle_stops.end());
    work = std::max(work, forces.work_error);
    power = std::max(power, forces.power.error);
  }
  out["undetermined"] = std::vector(undetermined.begin(), undetermined.end());
  out["idle_stops"] = std::vector(idle.begin(), idle.end());
  out["work_error"] = work;
  out["power_error"] = power;
  return json_text(out, scene);
}

std::vector<Panel> forces_panels(const Scene& scene, const ForcesAnswer& answer) {
  const std::vector<double> x = places(answer, scene.units);
  const std::string x_label =
      (answer.measure ? with_unit(answer.along, *answer.measure, scene.units) : answer.along + " (s)") +
      up_to_stop(answer.stop, scene);
  std::vector<Panel> panels;
  const auto panel = [&](const std::string& title, Quantity quantity) -> Panel& {
    for (Panel& p : panels) {
      if (p.title == title) return p;
    }
    panels.push_back({.title = title,
                      .x_label = x_label,
                      .y_label = with_unit(quantity == Quantity::moment ? "torque" : "force", quantity, scene.units)});
    return panels.back();
  };
  for (const ForceCourse& course : force_courses(scene, answer)) {
    if (!course.name.starts_with("effort.")) continue;
    const bool turns = course.quantity == Quantity::moment;
    panel(turns ? "torques of drives" : "forces of drives", course.quantity)
        .curves.push_back({.name = course.name.substr(7), .x = x, .y = shown(course, scene.units)});
  }
  std::vector<Curve> sizes;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    Curve curve{.name = scene.joints[j].name, .x = x};
    for (const Forces& f : answer.poses) {
      curve.y.push_back(in_unit(norm(f.reactions[j].force), Quantity::force, scene.units));
    }
    sizes.push_back(std::move(curve));
  }
  const auto largest = [](const Curve& c) { return *std::max_element(c.y.begin(), c.y.end()); };
  if (sizes.size() > most_curves) {
    std::stable_sort(sizes.begin(), sizes.end(),
                     [&](const Curve& a, const Curve& b) { return largest(a) > largest(b); });
    sizes.resize(most_curves);
  }
  if (!sizes.empty()) panel("reactions of joints, their size", Quantity::force).curves = std::move(sizes);
  return panels;
}

}  // namespace poise::app

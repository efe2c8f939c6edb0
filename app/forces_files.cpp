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
  return answer.found.measure ? in_unit(answer.found.at, *answer.found.measure, units) : answer.found.at;
}

}  // namespace

std::string forces_csv(const Scene& scene, const ForcesAnswer& answer) {
  std::vector<std::string> header;
  std::vector<std::vector<double>> columns;
  if (!answer.found.at.empty()) {
    header.push_back(answer.found.along);
    columns.push_back(places(answer, scene.units));
  }
  for (const ForceCourse& course : force_courses(scene, answer.found)) {
    header.push_back(course.name);
    columns.push_back(shown(course, scene.units));
  }
  return csv_text(header, columns);
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
              {"complete", answer.found.complete},
              {"why", answer.found.why},
              {"stop", json_stop(answer.found.stop, scene)},
              {"parallel", Json::array()},
              {"balanced", answer.found.balanced()},
              {"along", answer.found.along},
              {"at", numbers(places(answer, scene.units))},
              {"forces", Json::object()}};
  for (const ForceCourse& course : force_courses(scene, answer.found)) {
    out["forces"][course.name] = numbers(shown(course, scene.units));
  }
  for (const LoadedParallel& parallel : loaded_parallels(model, answer.found)) {
    out["parallel"].push_back({{"element", parallel.course.name}, {"drive", parallel.drive}});
  }
  out["dead_points"] = Json::array();
  for (const std::vector<double>& point : answer.found.dead_points) {
    Json place = Json::object();
    for (std::size_t k = 0; k < point.size(); ++k) {
      const Drive& drive = scene.drives[k];
      place[drive.name] = json_number(in_unit(point[k], quantity_of(drive.on), scene.units));
    }
    out["dead_points"].push_back(std::move(place));
  }
  std::set<std::string> undetermined, idle;
  double work = 0.0, power = 0.0;
  for (const Forces& forces : answer.found.poses) {
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
  const std::string x_label = (answer.found.measure ? with_unit(answer.found.along, *answer.found.measure, scene.units)
                                                    : answer.found.along + " (s)") +
                              up_to_stop(answer.found.stop, scene);
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
  for (const ForceCourse& course : force_courses(scene, answer.found)) {
    if (!course.name.starts_with("effort.")) continue;
    const bool turns = course.quantity == Quantity::moment;
    panel(turns ? "torques of drives" : "forces of drives", course.quantity)
        .curves.push_back({.name = course.name.substr(7), .x = x, .y = shown(course, scene.units)});
  }
  std::vector<Curve> sizes;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    Curve curve{.name = scene.joints[j].name, .x = x};
    for (const Forces& f : answer.found.poses) {
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

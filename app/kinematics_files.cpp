#include "app/kinematics_files.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "app/csv_file.hpp"
#include "app/json_parts.hpp"

namespace poise::app {
namespace {

constexpr std::size_t most_curves = 12;

Quantity quantity_of(const Scene& scene, const DriveRange& range) {
  return poise::quantity_of(find_drive(scene, range.name).on);
}

Json in_json(Vec2 si, const Units& units) {
  return {json_number(in_unit(si.x, Quantity::length, units)), json_number(in_unit(si.y, Quantity::length, units))};
}

Json points(const Scene& scene, const KinematicSample& sample) {
  Json out = Json::object();
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    for (const NamedPoint& p : scene.bodies[i].points) {
      const BodyMotion& body = sample.bodies[i];
      out[scene.bodies[i].name + "." + p.name] = {{"position", in_json(body.pose.world(p.at), scene.units)},
                                                  {"velocity", in_json(body.velocity_of(p.at), scene.units)},
                                                  {"acceleration", in_json(body.acceleration_of(p.at), scene.units)}};
    }
  }
  return out;
}

Json drive_values(const Scene& scene, const std::vector<DriveRange>& ranges, const std::vector<double>& values) {
  Json out = Json::object();
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    out[ranges[k].name] = json_number(in_unit(values[k], quantity_of(scene, ranges[k]), scene.units));
  }
  return out;
}

}  // namespace

std::string kinematics_csv(const Scene& scene, const KinematicsResult& result, const std::vector<DriveRange>& ranges) {
  std::vector<std::string> header;
  std::vector<std::vector<double>> columns;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const Course course = drive_course(scene, result, k, ranges);
    header.push_back("drive." + course.name);
    columns.push_back(in_unit(course.value, course.quantity, scene.units));
  }
  std::vector<Course> courses = coordinate_courses(scene, result);
  for (Course& course : point_courses(scene, result)) courses.push_back(std::move(course));
  for (const Course& course : courses) {
    header.insert(header.end(), {course.name, course.name + ".rate", course.name + ".second"});
    for (const auto* values : {&course.value, &course.rate, &course.acceleration}) {
      columns.push_back(in_unit(*values, course.quantity, scene.units));
    }
  }
  header.emplace_back("closeness_to_singular");
  columns.emplace_back();
  for (const KinematicSample& sample : result.samples) columns.back().push_back(sample.closeness_to_singular);
  return csv_text(header, columns);
}

Json json_stop(const std::optional<MetStop>& met, const Scene& scene) {
  if (!met) return nullptr;
  const Stop& stop = scene.stops[met->stop];
  return {{"name", stop.name},
          {"limit", met->at_max ? "max" : "min"},
          {"value", json_number(in_unit(met->at_max ? stop.max : stop.min, quantity_of(stop.on), scene.units))}};
}

std::string up_to_stop(const std::optional<MetStop>& met, const Scene& scene) {
  return met ? fmt::format(", up to the stop \"{}\"", scene.stops[met->stop].name) : "";
}

std::string kinematics_json(const Scene& scene, const KinematicsResult& result, const std::vector<DriveRange>& ranges,
                            const std::vector<std::string>& settings) {
  Json out = {{"poise", POISE_VERSION}, {"scene", json_scene(scene, settings)}, {"units", json_units(scene.units)}};
  out["complete"] = result.complete;
  out["why"] = result.why;
  out["stop"] = json_stop(result.stop, scene);
  out["drives"] = Json::array();
  for (const DriveRange& range : ranges) {
    const Quantity quantity = quantity_of(scene, range);
    out["drives"].push_back({{"name", range.name},
                             {"from", json_number(in_unit(range.from, quantity, scene.units))},
                             {"to", json_number(in_unit(range.to, quantity, scene.units))}});
  }
  const std::vector<Course> courses = coordinate_courses(scene, result);
  out["samples"] = Json::array();
  for (std::size_t s = 0; s < result.samples.size(); ++s) {
    const KinematicSample& sample = result.samples[s];
    Json row = {{"drive", drive_values(scene, ranges, sample.drive)},
                {"angles", Json::object()},
                {"lengths", Json::object()},
                {"points", points(scene, sample)},
                {"closeness_to_singular", json_number(sample.closeness_to_singular)}};
    for (const Course& course : courses) {
      Json& values = row[course.quantity == Quantity::angle ? "angles" : "lengths"][course.name];
      for (const double si : {course.value[s], course.rate[s], course.acceleration[s]}) {
        values.push_back(json_number(in_unit(si, course.quantity, scene.units)));
      }
    }
    out["samples"].push_back(std::move(row));
  }
  out["singular"] = Json::array();
  for (const SingularPose& pose : result.singular) {
    out["singular"].push_back({{"kind", pose.kind == SingularPose::Kind::change_point ? "change point" : "dead centre"},
                               {"before_range", pose.before_range},
                               {"drive", drive_values(scene, ranges, pose.drive)},
                               {"text", pose.text}});
  }
  return json_text(out, scene);
}

std::vector<Panel> kinematics_panels(const Scene& scene, const KinematicsResult& result,
                                     const std::vector<DriveRange>& ranges) {
  struct Sight {
    const char* angles;
    const char* lengths;
    const char* per;
    std::vector<double> Course::*values;
  };
  static constexpr std::array<Sight, 3> sights = {
      {{"Angles", "Lengths", "", &Course::value},
       {"Angular velocities", "Speeds", "/s", &Course::rate},
       {"Angular accelerations", "Accelerations along the joints", "/s²", &Course::acceleration}}};
  const std::vector<Course> courses = coordinate_courses(scene, result);
  const Course drive = drive_course(scene, result, 0, ranges);
  const std::vector<double> x = in_unit(drive.value, drive.quantity, scene.units);
  const std::string label =
      fmt::format("{} ({}){}", drive.name, unit_name(drive.quantity, scene.units), up_to_stop(result.stop, scene));
  std::vector<Panel> panels;
  for (const Quantity quantity : {Quantity::angle, Quantity::length}) {
    for (const Sight& sight : sights) {
      Panel panel{.title = quantity == Quantity::angle ? sight.angles : sight.lengths,
                  .x_label = label,
                  .y_label = unit_name(quantity, scene.units) + sight.per};
      for (const Course& course : courses) {
        if (course.quantity != quantity || panel.curves.size() == most_curves) continue;
        panel.curves.push_back(
            {.name = course.name, .x = x, .y = in_unit(course.*sight.values, quantity, scene.units)});
      }
      if (!panel.curves.empty()) panels.push_back(std::move(panel));
    }
  }
  return panels;
}

}  // namespace poise::app

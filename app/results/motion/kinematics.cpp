#include "app/results/motion/kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/quantities.hpp"
#include "model/nearest_name.hpp"
#include "motion/driven_quantities.hpp"
#include "statics/model/cam_contact.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_values = 8;
constexpr int digits_of_rates = 6;
constexpr double vanishing = 1e-12;  // of the largest value of a table: rounding, shown as 0

Quantity quantity_of_drive(const Scene& scene, const DriveRange& range) {
  return poise::quantity_of(find_drive(scene, range.name).on);
}

/// What is below 1e-12 of `largest`, SI, the largest value of the table, is rounding.
void add_values(Table& table, const std::string& title, const std::string& unit, const std::vector<double>& si,
                Quantity quantity, const Units& units, int digits, double largest) {
  table.numbers("", title, unit, in_unit(si, quantity, units),
                {.digits = digits, .zero_below = in_unit(vanishing * largest, quantity, units)});
}

void add_drive(Table& table, const Course& drive, const Units& units) {
  add_values(table, drive.name, unit_name(drive.quantity, units), drive.value, drive.quantity, units, digits_of_values,
             largest_size(drive.value));
}

Table& course_table(Group& group, const std::string& title, Verbosity level) {
  Table& table = group.table("", title, Rows::list, level);
  table.shown = Table::Shown::spread;
  return table;
}

struct Derivative {
  const char* title;
  const char* per;
  std::vector<double> Course::*values;
  int digits;
};
constexpr Derivative derivative_columns[] = {{"Positions", "", &Course::value, digits_of_values},
                                             {"Velocities", "/s", &Course::rate, digits_of_rates},
                                             {"Accelerations", "/s²", &Course::acceleration, digits_of_rates}};

/// Second derivatives of what turns evenly are nothing against the square of its speed, not against themselves.
double scale_of(const std::vector<Course>& courses, std::vector<double> Course::*values, const Course& drive) {
  double largest = values == &Course::acceleration ? std::pow(largest_size(drive.rate), 2) : 0.0;
  for (const Course& course : courses) largest = std::max(largest, largest_size(course.*values));
  return largest;
}

/// A table of positions, one of velocities and one of accelerations, of all angles and lengths. Positions are shown at
/// one level, the others at another.
void add_courses(Group& group, const Scene& scene, const std::vector<Course>& courses, const Course& drive,
                 Verbosity positions, Verbosity others) {
  const auto of = [&](Quantity quantity) {
    return chosen_of(courses, [&](const Course& course) { return course.quantity == quantity; });
  };
  const std::vector<std::vector<Course>> kinds = {merge_welded(scene, of(Quantity::angle)), of(Quantity::length)};
  for (const Derivative& d : derivative_columns) {
    Table& table = course_table(group, d.title, d.values == &Course::value ? positions : others);
    add_drive(table, drive, scene.units);
    for (const std::vector<Course>& kind : kinds) {
      const double largest = scale_of(kind, d.values, drive);
      for (const Course& course : kind) {
        if (d.values == &Course::value && course.name == drive.name) continue;
        add_values(table, course.name, unit_name(course.quantity, scene.units) + d.per, course.*d.values,
                   course.quantity, scene.units, d.digits, largest);
      }
    }
  }
}

/// A section for each point: where it is, its velocity and its acceleration.
void add_points(Group& group, const Scene& scene, const std::vector<std::string>& points,
                const std::vector<Course>& courses, const Course& drive) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < courses.size(); i += 2) {
    names.push_back(courses[i].name.substr(0, courses[i].name.size() - 2));
  }
  for (const std::string& point : points) {
    const auto found = std::find(names.begin(), names.end(), point);
    if (found == names.end()) {
      throw InputError(
          fmt::format("--point {}: expected a point of a moving body{}", point, did_you_mean_or_list(point, names)));
    }
    const auto first = courses.begin() + 2 * (found - names.begin());
    const std::vector<Course> both(first, first + 2);
    Table& table = course_table(group, "Point " + point, Verbosity::normal);
    add_drive(table, drive, scene.units);
    const char* const symbols[] = {"", "v", "a"};
    for (std::size_t k = 0; k < std::size(derivative_columns); ++k) {
      const Derivative& d = derivative_columns[k];
      const double largest = scale_of(both, d.values, drive);
      for (std::size_t c = 0; c < 2; ++c) {
        add_values(table, fmt::format("{}{}", symbols[k], c == 0 ? "x" : "y"), scene.units.length_name + d.per,
                   both[c].*d.values, Quantity::length, scene.units, d.digits, largest);
      }
    }
  }
}

/// Values and rates of all drives.
void add_drives(Group& group, const Scene& scene, const std::vector<Course>& drives) {
  Table& table = course_table(group, "Driven", Verbosity::normal);
  for (const Course& drive : drives) add_drive(table, drive, scene.units);
  for (const Course& drive : drives) {
    add_values(table, "rate of " + drive.name, unit_name(drive.quantity, scene.units) + "/s", drive.rate,
               drive.quantity, scene.units, digits_of_rates, largest_size(drive.rate));
  }
}

/// Pressure angles of cams that are guided, rad: only these hold here. Not a number where there is none.
std::vector<Course> pressure_angles(const Scene& scene, const KinematicsResult& found) {
  std::vector<Course> out;
  for (std::size_t i = 0; i < found.samples.size(); ++i) {
    const std::vector<BodyPose<double>> poses = poses_of(found.samples[i].bodies);
    const std::vector<CamReading> cams = cam_readings(scene, poses, {});
    if (i == 0) {
      for (const CamReading& cam : cams) out.push_back({cam.name, Quantity::angle, {}, {}, {}});
    }
    for (std::size_t k = 0; k < cams.size(); ++k) {
      out[k].value.push_back(cams[k].contact ? cams[k].contact->pressure_angle
                                             : std::numeric_limits<double>::quiet_NaN());
    }
  }
  std::erase_if(out, [](const Course& cam) {
    return std::all_of(cam.value.begin(), cam.value.end(), [](double angle) { return std::isnan(angle); });
  });
  return out;
}

/// The largest of each, and where.
void add_pressure_angles(Group& group, const Scene& scene, const std::vector<Course>& cams,
                         const std::vector<Course>& drives, std::size_t pace) {
  for (const Course& cam : cams) {
    std::size_t most = 0;
    for (std::size_t i = 1; i < cam.value.size(); ++i) {
      // Any is more than what is not a number.
      if (!(std::abs(cam.value[i]) <= std::abs(cam.value[most])) && !std::isnan(cam.value[i])) most = i;
    }
    const auto shown = [&](double si, Quantity quantity) {
      return significant(in_unit(si, quantity, scene.units), 6) + " " + unit_name(quantity, scene.units);
    };
    const Course& drive = drives[pace];
    group.fact("cam", fmt::format("\"{}\" has a pressure angle up to {} among the samples, at {} = {}", cam.name,
                                  shown(std::abs(cam.value[most]), Quantity::angle), drive.name,
                                  shown(drive.value[most], drive.quantity)));
  }
}

/// Every number, for JSON and CSV.
Table& add_samples(Group& group, const Scene& scene, const KinematicsResult& found, const std::vector<Course>& drives,
                   const std::vector<Course>& courses, const std::vector<Course>& points,
                   const std::vector<Course>& cams) {
  Table& table = group.table("samples", "", Rows::columns, Verbosity::data);
  table.csv = true;
  const auto add = [&](const std::string& name, const std::vector<double>& si, Quantity quantity, const char* per) {
    table.data(name, in_unit(si, quantity, scene.units)).unit = unit_name(quantity, scene.units) + per;
  };
  for (const Course& drive : drives) add("drive." + drive.name, drive.value, drive.quantity, "");
  for (const std::vector<Course>* kind : {&courses, &points}) {
    for (const Course& course : *kind) {
      add(course.name, course.value, course.quantity, "");
      add(course.name + ".rate", course.rate, course.quantity, "/s");
      add(course.name + ".acceleration", course.acceleration, course.quantity, "/s²");
    }
  }
  for (const Course& cam : cams) add("cam." + cam.name + ".pressure_angle", cam.value, cam.quantity, "");
  table.data("closeness_to_singular", each(found.samples, &KinematicSample::closeness_to_singular));
  return table;
}

/// Of each sample.
std::vector<std::vector<QuantityValue>> quantities_in_samples(const Scene& scene, const KinematicsResult& found,
                                                              const std::vector<DriveRange>& ranges,
                                                              const std::vector<SoughtQuantity>& show) {
  if (show.empty()) return {};
  std::vector<Drive> held;
  for (const DriveRange& range : ranges) held.push_back(find_drive(scene, range.name));
  std::vector<std::vector<QuantityValue>> out;
  for (const KinematicSample& sample : found.samples) {
    out.push_back(driven_quantities(scene, held, sample.bodies, show));
  }
  return out;
}

std::string place_in_words(const Scene& scene, const std::vector<DriveRange>& ranges,
                           const std::vector<double>& values) {
  std::string out;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const Quantity quantity = quantity_of_drive(scene, ranges[k]);
    double shown = in_unit(values[k], quantity, scene.units);
    if (std::abs(shown) < 1e-9) shown = 0.0;  // singular poses are found to 1e-10
    out += fmt::format("{}{} = {} {}", out.empty() ? "" : ", ", ranges[k].name, significant(shown, 10),
                       unit_name(quantity, scene.units));
  }
  return out;
}

void add_singular(Group& group, const Scene& scene, const KinematicsResult& found,
                  const std::vector<DriveRange>& ranges) {
  Branch& poses = group.array("singular");
  std::vector<std::string> words;
  for (const SingularPose& pose : found.singular) {
    Group& one = poses.parts.emplace_back();
    one.data("kind", pose.kind == SingularPose::Kind::change_point ? "change point" : "dead centre");
    one.data("before_range", pose.before_range);
    Group& drive = one.group("drive", "", Verbosity::data);
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      drive.data(ranges[k].name, in_unit(pose.drive[k], quantity_of_drive(scene, ranges[k]), scene.units));
    }
    one.data("text", pose.text);
    words.push_back(fmt::format("{}{}: {}", place_in_words(scene, ranges, pose.drive),
                                pose.before_range ? " (on the way to the range)" : "", pose.text));
  }
  group.list("", "Singular positions", std::move(words));
}

void add_range_data(Group& group, const Scene& scene, const KinematicsResult& found,
                    const std::vector<DriveRange>& ranges) {
  group.data("complete", found.complete);
  group.data("why", found.why);
  add_met_stop(group, found.stop, scene);
  group.data("degrees_of_freedom", ranges.size());
  const auto end = [&](double DriveRange::*si) {
    return each(ranges, [&](const DriveRange& r) { return in_unit(r.*si, quantity_of_drive(scene, r), scene.units); });
  };
  Table& table = group.table("drives", "", Rows::list, Verbosity::data);
  table.words("name", "", each(ranges, &DriveRange::name));
  table.words("measure", "", each(ranges, [&](const DriveRange& r) { return drive_in_words(scene, r.name); }));
  table.data("from", end(&DriveRange::from));
  table.data("to", end(&DriveRange::to));
}

Line verdict(const KinematicsResult& found) {
  if (found.complete) return good("Driven through the whole range.");
  if (found.stop) return doubtful("Driven up to a stop: " + found.why + ".");
  return bad("Not driven through the whole range: " + found.why + ".");
}

}  // namespace

void add_met_stop(Group& group, const std::optional<MetStop>& met, const Scene& scene) {
  if (!met) {
    group.data("stop", nullptr);
    return;
  }
  const Stop& stop = scene.stops[met->stop];
  Group& out = group.group("stop", "", Verbosity::data);
  out.data("name", stop.name);
  out.data("limit", met->at_max ? "max" : "min");
  out.data("value", in_unit(met->at_max ? stop.max : stop.min, poise::quantity_of(stop.on), scene.units));
}

std::vector<std::string> drives_in_words(const Scene& scene, const std::vector<std::string>& names) {
  return each(names, [&](const std::string& name) { return fmt::format("{}: {}", name, drive_in_words(scene, name)); });
}

Result kinematics_result(const Scene& scene, const KinematicsResult& found, const std::vector<DriveRange>& ranges,
                         double rate, const KinematicsView& view, const std::vector<std::string>& settings) {
  Result out = scene_result(scene, settings);
  Group& content = out.content;
  out.verdict = verdict(found);
  add_range_data(content, scene, found, ranges);
  std::vector<Course> drives;
  for (std::size_t k = 0; k < ranges.size(); ++k) drives.push_back(drive_course(scene, found, k, ranges));
  const std::vector<Course> courses = coordinate_courses(scene, found);
  const std::vector<Course> points = point_courses(scene, found);
  const std::size_t pace = first_moving(ranges);
  const Quantity quantity = drives[pace].quantity;
  content.fact(
      "mobility",
      fmt::format("{}, driven by {}", count(static_cast<int>(ranges.size()), "degree of freedom", "degrees of freedom"),
                  listed(each(ranges, &DriveRange::name))));
  for (const std::string& drive : drives_in_words(scene, each(ranges, &DriveRange::name))) content.fact("drive", drive);
  content.fact("rate",
               fmt::format("{} at {} {}/s, {}", ranges[pace].name, significant(in_unit(rate, quantity, scene.units), 6),
                           unit_name(quantity, scene.units),
                           count(static_cast<int>(found.samples.size()), "sample", "samples")));
  const std::vector<Course> cams = pressure_angles(scene, found);
  add_pressure_angles(content, scene, cams, drives, pace);
  add_singular(content, scene, found, ranges);
  if (drives.size() > 1) add_drives(content, scene, drives);
  add_points(content, scene, view.points, points, drives.front());
  const std::vector<std::vector<QuantityValue>> shown = quantities_in_samples(scene, found, ranges, view.show);
  if (!view.show.empty()) {
    Table& table = course_table(content, "Quantities, at rest in each position", Verbosity::normal);
    add_drive(table, drives[pace], scene.units);
    add_quantity_columns(table, view.show, shown, scene.units, false);
  }
  const bool asks_nothing = view.points.empty() && view.show.empty();
  add_courses(content, scene, courses, drives.front(),
              view.all || asks_nothing ? Verbosity::normal : Verbosity::verbose,
              view.all ? Verbosity::normal : Verbosity::verbose);
  add_quantity_columns(add_samples(content, scene, found, drives, courses, points, cams), view.show, shown, scene.units,
                       true, false);
  if (!found.samples.empty()) {
    double closest = 1.0;
    for (const KinematicSample& sample : found.samples) closest = std::min(closest, sample.closeness_to_singular);
    content.group("", "Numerics", Verbosity::verbose)
        .fact("closeness", significant(closest, 3) +
                               " at worst (0: singular position, 1: farthest from one): smallest over largest singular "
                               "value of the closures");
  }
  return out;
}

}  // namespace poise::app

#include "app/results/motion/forces.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/cams.hpp"
#include "app/results/motion/kinematics.hpp"
#include "app/results/parts.hpp"
#include "motion/force_courses.hpp"
#include "motion/joint_friction.hpp"
#include "statics/pose_values.hpp"
#include "statics/readings.hpp"

namespace poise::app {
namespace {

constexpr int place_digits = 8;

std::string power_unit(const Units& units) {
  const std::string energy = unit_name(Quantity::energy, units);
  return energy == "J" ? "W" : energy + "/s";
}

/// The pose that is worst out of balance.
const Forces& worst(const ForcesAlong& found) {
  return *std::max_element(found.poses.begin(), found.poses.end(), [](const Forces& a, const Forces& b) {
    return a.imbalance * b.largest_force < b.imbalance * a.largest_force;
  });
}

bool moves(const ForcesAlong& found) {
  return std::any_of(found.poses.begin(), found.poses.end(), [](const Forces& forces) {
    return std::any_of(forces.motions.begin(), forces.motions.end(),
                       [](const BodyMotion& m) { return m.rate != 0.0 || norm(m.velocity) > 0.0; });
  });
}

/// "at ram = 300 mm no finite force of the drive holds the load"; nothing where there is no dead point.
std::string dead_points(const MotionModel& model, const ForcesAlong& found) {
  const std::vector<Drive>& drives = model.scene().drives;
  std::vector<std::string> places;
  for (const std::vector<double>& point : found.dead_points) {
    std::vector<std::string> values;
    for (std::size_t k = 0; k < point.size(); ++k) {
      values.push_back(
          fmt::format("{} = {}", drives[k].name, with_unit(model, point[k], quantity_of(drives[k].on), place_digits)));
    }
    places.push_back("at " + listed(values));
  }
  if (places.empty()) return "";
  const char* const effort = drives.size() > 1              ? "finite efforts of the drives hold"
                             : drives.front().on.is_angle() ? "finite torque of the drive holds"
                                                            : "finite force of the drive holds";
  return fmt::format("{} no {} the load", listed(places), effort);
}

Line verdict(const ForcesAlong& found, const std::string& dead) {
  const bool ended = !found.complete && !found.stop;
  if (ended) return bad("Driven in part only: " + found.why + ".");
  if (!dead.empty() && !found.balanced()) return bad("Dead point: " + dead + ".");
  if (found.poses.empty()) return bad("No pose was reached.");
  if (!found.balanced()) {
    return bad(found.poses.front().drives.empty()
                   ? "Out of balance: the forces below do not hold the load; name a drive by --drive."
                   : "Out of balance: the drives cannot hold the load, nor do the forces below.");
  }
  if (!dead.empty()) return doubtful("Every body is in balance. Dead point: " + dead + ".");
  return good("Every body is in balance.");
}

/// Stops that are passed, and elements parallel to a drive, whose forces are part of its effort.
void add_warnings(Result& result, const MotionModel& model, const ForcesAlong& found, const std::string& dead,
                  const std::vector<ForceCourse>& courses, const std::vector<LoadedParallel>& parallels) {
  const auto warn = [&](std::string text) { result.warnings.push_back(doubtful(std::move(text))); };
  const std::vector<std::string> rubbing = joints_with_friction(model.scene());
  if (!rubbing.empty()) warn(fmt::format("Friction in {} is left out of all forces.", listed(rubbing)));
  if (!dead.empty() && !found.complete && !found.stop) warn("Dead point: " + dead + ".");
  if (found.stop) warn("The range ends early: " + found.why + ".");
  for (const ForceCourse& course : courses) {
    if (!course.name.starts_with("overrun.")) continue;
    const auto passed = std::count_if(course.value.begin(), course.value.end(), [](double v) { return v > 0.0; });
    warn(fmt::format("Stop \"{}\" is passed in {} of {} poses, by up to {}.", course.name.substr(8), passed,
                     course.value.size(), with_unit(model, largest_size(course.value), course.quantity)));
  }
  for (const auto& [element, drive, course] : parallels) {
    warn(
        fmt::format("{} acts in parallel with the drive \"{}\", whose effort includes it (up to {}); --set "
                    "\"{}.{}=0\" leaves it out.",
                    course.name, drive, with_unit(model, largest_size(course.value), course.quantity), course.name,
                    numbers_of(element.law).front().key_on(&element.on)));
  }
}

/// Drives of a single pose.
void add_drives(Group& group, const MotionModel& model, const Forces& forces, bool moving) {
  const Units& units = model.scene().units;
  const auto effort = [&](const DriveEffort& drive) {
    return with_unit(model, drive.value, drive.is_angle ? Quantity::moment : Quantity::force);
  };
  Table& table = group.table("", "Drives, positive where they drive forwards", Rows::list);
  table.words("", "drive", each(forces.drives, &DriveEffort::name));
  table.words("", "effort", each(forces.drives, effort));
  if (moving) {
    table.numbers("", "power", power_unit(units),
                  in_unit(each(forces.drives, &DriveEffort::power), Quantity::energy, units),
                  format_of(model, Quantity::energy, force_digits));
  }
  table.remarks(each(forces.drives, [](const DriveEffort& drive) { return drive.determined ? "" : "undetermined"; }),
                Tone::doubtful);
}

/// Angles and slides of a single pose, bodies that welds join in one row.
void add_position(Group& group, const MotionModel& model, const Forces& forces) {
  const Scene& scene = model.scene();
  const Readings pose = readings_of(scene, poses_of(forces.motions));
  const std::vector<int> groups = rigid_groups(scene);
  std::vector<NamedValue> angles, slides;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    if (groups[i] != 0) angles.push_back({scene.bodies[i].name, pose.poses[i].angle});
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (scene.joints[j].has_travel()) slides.push_back({scene.joints[j].name, pose.travel[j]});
  }
  const auto add = [&](const std::string& title, const std::string& noun, Quantity quantity,
                       const std::vector<NamedValue>& rows) {
    Table& table = group.table("", title, Rows::list);
    table.words("", noun, each(rows, &NamedValue::name));
    add_column(table, model, "", "value", quantity, each(rows, &NamedValue::value), place_digits);
  };
  add("Angles", "body", Quantity::angle, merge_welded(scene, angles));
  add("Slides", "joint", Quantity::length, slides);
}

bool is_element(const ForceCourse& course) {
  const std::string kind = course.name.substr(0, course.name.find('.'));
  return kind != "effort" && kind != "power" && kind != "reaction" && kind != "stop" && kind != "imbalance" &&
         kind != "overrun" && kind != "cam";
}

/// Springs, dampers and friction of one pose.
void add_elements(Group& group, const MotionModel& model, const std::vector<ForceCourse>& courses) {
  const std::vector<ForceCourse> elements = chosen_of(courses, is_element);
  Table& table = group.table("", "Springs and dampers, tension positive, moments on the second body", Rows::list);
  table.words("", "element", each(elements, &ForceCourse::name));
  table.words("", "carries", each(elements, [&](const ForceCourse& course) {
                return with_unit(model, course.value.front(), course.quantity);
              }));
}

struct Places {
  std::string title, unit;
  std::vector<double> values;
};

Places places_of(const ForcesAlong& found, const Units& units) {
  if (!found.measure) return {found.along, "s", found.at};
  return {found.along, unit_name(*found.measure, units), in_unit(found.at, *found.measure, units)};
}

/// Efforts, and powers where it moves, from place to place.
void add_efforts(Group& group, const MotionModel& model, const ForcesAlong& found,
                 const std::vector<ForceCourse>& courses, bool moving) {
  if (model.scene().drives.empty()) return;
  const Units& units = model.scene().units;
  const Places places = places_of(found, units);
  Table& table = group.table("", "Drives, positive where they drive forwards", Rows::list);
  table.shown = Table::Shown::spread;
  table.numbers("", places.title, places.unit, places.values, {.digits = place_digits});
  for (const ForceCourse& course : courses) {
    const std::string name = course.name.substr(course.name.find('.') + 1);
    if (course.name.starts_with("effort.")) {
      add_column(table, model, "", "effort of " + name, course.quantity, course.value, force_digits);
    } else if (moving && course.name.starts_with("power.")) {
      table.numbers("", "power", power_unit(units), in_unit(course.value, course.quantity, units),
                    format_of(model, course.quantity, force_digits));
    }
  }
}

/// The largest of everything that is no drive, pressure angles of cams included, by size, and where.
void add_largest(Group& group, const MotionModel& model, const ForcesAlong& found,
                 const std::vector<ForceCourse>& courses) {
  const Scene& scene = model.scene();
  std::vector<ForceCourse> shown;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    ForceCourse size{"reaction." + scene.joints[j].name, Quantity::force, {}};
    for (const Forces& f : found.poses) size.value.push_back(norm(f.reactions[j].force));
    shown.push_back(std::move(size));
  }
  for (const ForceCourse& course : courses) {
    const bool moment = course.name.starts_with("reaction.") && course.name.ends_with(".moment");
    const bool is_of_stop = course.name.starts_with("stop.") || course.name.starts_with("cam.");
    if (!moment && !is_of_stop && !is_element(course)) continue;
    const auto is_none = [](double value) { return std::isnan(value); };
    if (std::all_of(course.value.begin(), course.value.end(), is_none)) continue;
    shown.push_back(course);
    // In poses in which a cam has lifted off.
    std::replace_if(shown.back().value.begin(), shown.back().value.end(), is_none, 0.0);
  }
  double rounding = 0.0;
  for (const Forces& f : found.poses) rounding = std::max(rounding, found.tolerance * f.largest_force);
  const Places places = places_of(found, scene.units);
  std::vector<std::string> names, values;
  std::vector<double> where;
  for (const ForceCourse& course : shown) {
    const auto largest = largest_by_size(course.value);
    const double unit = course.quantity == Quantity::moment  ? model.scales().length
                        : course.quantity == Quantity::angle ? 0.0
                                                             : 1.0;
    names.push_back(course.name);
    values.push_back(with_unit(model, std::abs(*largest) <= rounding * unit ? 0.0 : *largest, course.quantity));
    where.push_back(places.values[static_cast<std::size_t>(largest - course.value.begin())]);
  }
  Table& table = group.table("", "Largest forces by size, tension positive", Rows::list);
  table.words("", "force", std::move(names));
  table.words("", "largest", std::move(values));
  table.numbers("", "at " + places.title, places.unit, std::move(where), {.digits = place_digits});
}

void add_numerics(Group& group, const MotionModel& model, const ForcesAlong& found) {
  const Forces& f = worst(found);
  double work = 0.0, power = 0.0;
  for (const Forces& forces : found.poses) {
    work = std::max(work, forces.work_error);
    power = std::max(power, forces.power.error);
  }
  group.data("work_error", work);
  group.data("power_error", power);
  Group& numerics = group.group("", "Numerics");
  numerics.fact("imbalance", fmt::format("{} {} at \"{}\" (largest force {})",
                                         small_number(in_unit(f.imbalance, Quantity::force, model.scene().units)),
                                         model.scene().units.force_name, f.worst_body,
                                         with_unit(model, f.largest_force, Quantity::force, 4)));
  numerics.fact("cross-check", fmt::format("virtual work of the compiled model leaves {} of the largest force{}",
                                           small_number(work), moves(found) ? "; power: " + small_number(power) : ""));
}

void add_data(Group& group, const MotionModel& model, const ForcesAnswer& answer,
              const std::vector<ForceCourse>& courses, const std::vector<LoadedParallel>& parallels) {
  const Scene& scene = model.scene();
  const ForcesAlong& found = answer.found;
  group.data("how", answer.how);
  group.data("complete", found.complete);
  group.data("why", found.why);
  add_met_stop(group, found.stop, scene);
  Branch& dead = group.array("dead_points");
  for (const std::vector<double>& point : found.dead_points) {
    Group& place = dead.parts.emplace_back();
    for (std::size_t k = 0; k < point.size(); ++k) {
      place.data(scene.drives[k].name, in_unit(point[k], quantity_of(scene.drives[k].on), scene.units));
    }
  }
  group.data("balanced", found.balanced());
  Branch& parallel = group.array("parallel");
  for (const LoadedParallel& one : parallels) {
    Group& pair = parallel.parts.emplace_back();
    pair.data("element", one.course.name);
    pair.data("drive", one.drive);
  }
  group.data("along", found.along);
  Table& forces = group.table("forces", "", Rows::columns, Verbosity::data);
  forces.csv = !found.poses.empty();
  if (!found.at.empty()) forces.data(found.along, places_of(found, scene.units).values);
  for (const ForceCourse& course : courses) {
    forces.data(course.name, in_unit(course.value, course.quantity, scene.units));
  }
  std::set<std::string> undetermined, idle;
  for (const Forces& pose : found.poses) {
    for (const Reaction& r : pose.reactions) {
      if (!r.determined) undetermined.insert(r.name);
    }
    for (const DriveEffort& d : pose.drives) {
      if (!d.determined) undetermined.insert(d.name);
    }
    idle.insert(pose.idle_stops.begin(), pose.idle_stops.end());
  }
  group.data("undetermined", std::vector<std::string>(undetermined.begin(), undetermined.end()));
  group.data("idle_stops", std::vector<std::string>(idle.begin(), idle.end()));
  for (const std::string& stop : idle) {
    group.fact("stop", fmt::format("\"{}\" is in contact without force: the drives alone hold the load", stop));
  }
}

}  // namespace

Result forces_result(const MotionModel& model, const ForcesAnswer& answer, const std::vector<std::string>& settings) {
  const ForcesAlong& found = answer.found;
  Result out = scene_result(model.scene(), settings);
  Group& content = out.content;
  const std::string dead = dead_points(model, found);
  const std::vector<ForceCourse> courses = force_courses(model.scene(), found);
  const std::vector<LoadedParallel> parallels = loaded_parallels(model, courses);
  out.verdict = verdict(found, dead);
  add_warnings(out, model, found, dead, courses, parallels);
  content.fact("pose", answer.how);
  if (!found.complete && !found.stop) content.fact("range", found.why);
  add_data(content, model, answer, courses, parallels);
  if (found.poses.empty()) return out;
  const bool moving = moves(found);
  if (found.at.empty()) {
    const Forces& forces = found.poses.front();
    add_drives(content, model, forces, moving);
    add_position(content, model, forces);
    add_elements(content, model, courses);
    add_reactions(content, model, forces.reactions, forces.redundancy);
    add_cams(content, model, cam_readings(model.scene(), poses_of(forces.motions), forces.reactions));
  } else {
    add_efforts(content, model, found, courses, moving);
    add_largest(content, model, found, courses);
  }
  add_numerics(content, model, found);
  return out;
}

}  // namespace poise::app

#include "app/results/motion/forces_in_time.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/motion/forces.hpp"
#include "app/results/parts.hpp"
#include "motion/force_courses.hpp"

namespace poise::app {
namespace {

const Format format_of_times{.style = Format::Style::significant, .digits = force_digits};

/// The largest by size of the numbers of a course, and when.
struct LargestInTime {
  double value = std::numeric_limits<double>::quiet_NaN(), at = value;
};

LargestInTime largest_in_time(const std::vector<double>& values, const std::vector<double>& times) {
  LargestInTime out;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isnan(values[k]) || std::abs(values[k]) <= std::abs(out.value)) continue;
    out = {values[k], times[k]};
  }
  return out;
}

std::string names_of_motors(const MotorsInTime& motors) { return listed(each(motors.motors, &Drive::name)); }

/// In words, how motors share what they have to do.
std::string how_shared(const MotionModel& model, const MotorsInTime& motors) {
  if (static_cast<int>(motors.motors.size()) <= motors.freedoms) return "the only efforts that do";
  const auto turns =
      std::count_if(motors.motors.begin(), motors.motors.end(), [](const Drive& motor) { return motor.on.is_angle(); });
  if (turns == 0) return "those with the least sum of the squares of forces";
  if (turns == static_cast<std::ptrdiff_t>(motors.motors.size()))
    return "those with the least sum of the squares of torques";
  return fmt::format("those with the least sum of the squares of forces and of torques over {}",
                     with_unit(model, motors.size, Quantity::length));
}

void add_motors(Group& group, const MotionModel& model, const ForceHistory& found) {
  if (!found.motors) {
    group.data("motors", nullptr);
    return;
  }
  const MotorsInTime& motors = *found.motors;
  const Units& units = model.scene().units;
  const auto conditions = static_cast<int>(model.scene().drives.size());
  Group& data = group.group("motors", "Motion made by motors");
  data.data("names", each(motors.motors, &Drive::name));
  data.data("conditions", conditions);
  data.data("freedoms", motors.freedoms);
  data.data("made", motors.is_made);
  data.data("left", motors.left);
  data.data("followed", motors.followed);
  data.fact("conditions", fmt::format("{} on {}, which agree with the joints and each other", conditions,
                                      count(motors.freedoms, "freedom", "freedoms")));
  if (motors.is_made) {
    data.fact("motors", fmt::format("{}: {}", names_of_motors(motors), how_shared(model, motors)));
    data.fact("fed back", motors.followed
                              ? fmt::format("in free motion these efforts lead through the same positions, to {} of "
                                            "the range of what moves most",
                                            small_number(*motors.followed))
                              : "not tried: the free motion has other coordinates, fails, or a motor is no load of it");
  }
  Table& table = data.table("unbalanced",
                            motors.is_made ? ""
                                           : fmt::format("Generalized forces that stay unbalanced at {} s",
                                                         significant(motors.at, force_digits)),
                            Rows::list);
  table.words("name", "coordinate", each(motors.unbalanced, &UnbalancedForce::name));
  table
      .numbers("value", "unbalanced", "",
               each(motors.unbalanced,
                    [&](const UnbalancedForce& one) {
                      return in_unit(one.value, one.is_angle ? Quantity::moment : Quantity::force, units);
                    }))
      .texts = each(motors.unbalanced, [&](const UnbalancedForce& one) {
    return with_unit(model, one.value, one.is_angle ? Quantity::moment : Quantity::force);
  });
  if (!motors.is_made) table.footnotes = {"of the motion in which this coordinate changes and the others here do not"};
  data.data("unbalanced_at", motors.is_made ? std::nullopt : std::optional<double>(motors.at));
}

void add_driven(Group& group, const MotionModel& model, const ForceHistory& found) {
  const Units& units = model.scene().units;
  const ForcesAlong& along = found.found;
  const std::vector<DriveEffort>& drives = along.poses.front().drives;
  std::vector<std::string> names, texts;
  std::vector<double> largest, largest_at, power, power_at, work;
  for (std::size_t d = 0; d < drives.size(); ++d) {
    const Quantity quantity = drives[d].is_angle ? Quantity::moment : Quantity::force;
    const auto of = [&](double DriveEffort::*member) {
      return largest_in_time(
          each(along.poses,
               [&](const Forces& f) { return f.friction.has_no_forces() ? std::nan("") : f.drives[d].*member; }),
          along.at);
    };
    const LargestInTime effort = of(&DriveEffort::value), most = of(&DriveEffort::power);
    names.push_back(drives[d].name);
    texts.push_back(std::isnan(effort.value) ? "-" : with_unit(model, effort.value, quantity));
    largest.push_back(in_unit(effort.value, quantity, units));
    largest_at.push_back(effort.at);
    power.push_back(in_unit(most.value, Quantity::energy, units));
    power_at.push_back(most.at);
    work.push_back(in_unit(found.work[d].back(), Quantity::energy, units));
  }
  Table& table = group.table(
      "drives",
      found.motors ? "Motors, positive where they drive forwards" : "Drives, positive where they drive forwards",
      Rows::list);
  table.words("name", found.motors ? "motor" : "drive", std::move(names));
  table.numbers("largest", "largest force or torque", "", std::move(largest)).texts = std::move(texts);
  table.numbers("largest_at", "at", "s", std::move(largest_at), format_of_times);
  table.numbers("power", "largest power", power_unit(units), std::move(power),
                format_of(model, Quantity::energy, force_digits, Format::Style::significant));
  table.numbers("power_at", "at", "s", std::move(power_at), format_of_times);
  table.numbers("work", "work in all", unit_name(Quantity::energy, units), std::move(work),
                format_of(model, Quantity::energy, force_digits, Format::Style::significant));
}

/// Sizes of the forces of joints and of inertia, and everything else that is one number.
std::vector<ForceCourse> sizes_in_time(const Scene& scene, const ForcesAlong& along) {
  std::vector<ForceCourse> out;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    out.push_back({"reaction." + scene.joints[j].name, Quantity::force, each(along.poses, [&](const Forces& f) {
                     return f.friction.has_no_forces() ? std::nan("") : norm(f.reactions[j].force);
                   })});
  }
  for (const ForceCourse& course : force_courses(scene, along)) {
    const bool is_moment = course.name.starts_with("reaction.") && course.name.ends_with(".moment");
    const bool is_wanted = is_moment || course.name.starts_with("blade.") || course.element >= 0 ||
                           course.name.starts_with("joint_friction.") ||
                           (course.name.starts_with("cam.") && course.name.ends_with("_force"));
    const bool is_coupling = course.name.starts_with("stop.") &&
                             std::any_of(course.value.begin(), course.value.end(), [](double v) { return v != 0.0; });
    if (is_wanted || is_coupling) out.push_back(course);
  }
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.mass > 0.0) {
      out.push_back({"inertia." + body.name, Quantity::force, each(along.poses, [&](const Forces& f) {
                       return body.mass * norm(f.motions[i].acceleration_of(body.center));
                     })});
    }
  }
  for (const ForceCourse& course : inertia_courses(scene, along)) {
    if (course.quantity == Quantity::moment) out.push_back(course);
  }
  return out;
}

void add_largest_in_time(Group& group, const MotionModel& model, const ForceHistory& found) {
  const Scene& scene = model.scene();
  double rounding = 0.0;
  for (const Forces& f : found.found.poses) rounding = std::max(rounding, 1e-9 * f.largest_force);
  std::vector<std::string> names, texts, of_units;
  std::vector<double> values, times;
  for (const ForceCourse& course : sizes_in_time(scene, found.found)) {
    LargestInTime largest = largest_in_time(course.value, found.found.at);
    const double unit = course.quantity == Quantity::moment ? model.scales().length : 1.0;
    if (std::abs(largest.value) <= rounding * unit) largest.value = 0.0;
    names.push_back(course.name);
    texts.push_back(std::isnan(largest.value) ? "-" : with_unit(model, largest.value, course.quantity));
    of_units.push_back(unit_name(course.quantity, scene.units));
    values.push_back(in_unit(largest.value, course.quantity, scene.units));
    times.push_back(largest.at);
  }
  Table& table = group.table("largest", "Largest forces by size, tension positive", Rows::list);
  table.words("name", "force", std::move(names));
  table.numbers("value", "largest", "", std::move(values)).texts = std::move(texts);
  table.words("unit", "", std::move(of_units)).shown = false;
  table.numbers("at", "at", "s", std::move(times), format_of_times);
  table.footnotes = {"reaction and inertia: sizes; inertia.BODY: -m a of its centre of mass, .moment: -I alpha"};
}

void add_links_in_time(Group& group, const MotionModel& model, const ForceHistory& found) {
  const Units& units = model.scene().units;
  std::vector<LinkCourse> links;
  for (const LinkCourse& one : found.links) {
    if (!std::isnan(one.value[one.largest].value)) links.push_back(one);
  }
  Table& table = group.table("links", "Largest internal loads of links", Rows::list);
  table.words("name", "link", each(links, &LinkCourse::link));
  table.words("load", "load", each(links, &LinkCourse::key));
  table.numbers(
      "value", "largest", "",
      each(links, [&](const LinkCourse& one) { return one.value[one.largest].value / one.dimension.unit(units); }),
      {.style = Format::Style::significant, .digits = force_digits});
  table.words("unit", "unit", each(links, [&](const LinkCourse& one) { return one.dimension.unit_name(units); }));
  table.numbers("at", "at", "s", each(links, [&](const LinkCourse& one) { return found.found.at[one.largest]; }),
                format_of_times);
  table.numbers(
      "s", "s", unit_name(Quantity::length, units),
      each(links, [&](const LinkCourse& one) { return in_unit(one.value[one.largest].s, Quantity::length, units); }),
      format_of_times);
  if (!links.empty()) table.footnotes = {"s: along the line of the link"};
  group.data("links_without", found.without_loads);
  for (const std::string& why : found.without_loads) group.fact("no loads", why, Tone::doubtful);
}

}  // namespace

void add_forces_in_time(Group& group, const MotionModel& model, const ForceHistory& found) {
  Group& forces = group.group("forces");
  forces.data("balanced", found.balanced());
  forces.data("imbalance", found.imbalance);
  forces.data("power_error", found.power_error);
  forces.data("energy_error", found.energy_error);
  add_motors(forces, model, found);
  if (found.found.poses.empty()) return;
  add_driven(forces, model, found);
  add_largest_in_time(forces, model, found);
  add_links_in_time(forces, model, found);
}

void add_force_columns(Table& table, const Scene& scene, const ForceHistory& found, std::size_t rows) {
  const Units& units = scene.units;
  const auto add = [&](const std::string& name, std::vector<double> values, const std::string& unit) {
    values.resize(rows, std::numeric_limits<double>::quiet_NaN());
    table.data(name, std::move(values)).unit = unit;
  };
  const auto add_courses = [&](const std::vector<ForceCourse>& courses) {
    for (const ForceCourse& course : courses) {
      const bool is_power = course.name.starts_with("power.") || course.name.starts_with("lost.");
      add(course.name, in_unit(course.value, course.quantity, units),
          is_power ? power_unit(units) : unit_name(course.quantity, units));
    }
  };
  if (found.found.poses.empty()) return;
  add_courses(force_courses(scene, found.found));
  const std::vector<DriveEffort>& drives = found.found.poses.front().drives;
  for (std::size_t d = 0; d < drives.size(); ++d) {
    add("work." + drives[d].name, in_unit(found.work[d], Quantity::energy, units), unit_name(Quantity::energy, units));
  }
  add_courses(inertia_courses(scene, found.found));
  for (const LinkCourse& one : found.links) {
    const std::string name = "link." + one.link + "." + one.key;
    add(name, each(one.value, [&](const LargestOnLink& at) { return at.value / one.dimension.unit(units); }),
        one.dimension.unit_name(units));
    add(name + ".s", in_unit(each(one.value, &LargestOnLink::s), Quantity::length, units),
        unit_name(Quantity::length, units));
  }
}

std::string objection_to_forces(const MotionModel& model, const ForceHistory& found) {
  if (!found.found.complete) return ", but not all forces: " + found.found.why;
  if (found.motors && !found.motors->is_made) {
    const auto most = std::max_element(found.motors->unbalanced.begin(), found.motors->unbalanced.end(),
                                       [&](const UnbalancedForce& a, const UnbalancedForce& b) {
                                         const double size = found.motors->size;
                                         return std::abs(a.value) / (a.is_angle ? size : 1.0) <
                                                std::abs(b.value) / (b.is_angle ? size : 1.0);
                                       });
    if (most == found.motors->unbalanced.end()) return ", but nothing is left that motors could move";
    return fmt::format(
        ", but {} cannot make this motion: at t = {} s a generalized force of {} along {} stays unbalanced",
        names_of_motors(*found.motors), significant(found.motors->at, force_digits),
        with_unit(model, most->value, most->is_angle ? Quantity::moment : Quantity::force), most->name);
  }
  if (found.balanced()) return "";
  return fmt::format(", but its forces are out of balance: {} of the largest force at \"{}\"",
                     small_number(found.imbalance), found.worst_body);
}

}  // namespace poise::app

#include "app/results/motion/forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/cams.hpp"
#include "app/results/motion/contacts.hpp"
#include "app/results/motion/kinematics.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/quantities.hpp"
#include "model/couplings.hpp"
#include "model/joint_friction.hpp"
#include "motion/driven_quantities.hpp"
#include "motion/force_courses.hpp"
#include "statics/model/pose_values.hpp"
#include "statics/model/readings.hpp"

namespace poise::app {
namespace {

constexpr int place_digits = 8;

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
  const char* const effort = drives.size() > 1              ? "finite forces and torques of the drives hold"
                             : drives.front().on.is_angle() ? "finite torque of the drive holds"
                                                            : "finite force of the drive holds";
  return fmt::format("{} no {} the load", listed(places), effort);
}

std::size_t count_of(const ForcesAlong& found, SlidingFriction::State state) {
  return static_cast<std::size_t>(std::count_if(found.poses.begin(), found.poses.end(),
                                                [&](const Forces& f) { return f.friction.state == state; }));
}

/// "in this pose", "in 3 of 73 poses".
std::string in_poses(std::size_t number, const ForcesAlong& found) {
  return found.at.empty() ? "in this position" : fmt::format("in {} of {} positions", number, found.poses.size());
}

/// What friction leaves without forces; nothing where there is none.
std::string without_forces(const Scene& scene, const ForcesAlong& found) {
  using State = SlidingFriction::State;
  std::vector<std::string> out;
  const auto say = [&](State state, const std::string& why) {
    const std::size_t number = count_of(found, state);
    if (number > 0) out.push_back(in_poses(number, found) + " " + why);
  };
  say(State::locked, "friction locks it, so that no finite force or torque of the drives moves it on");
  say(State::several, "the forces with friction are not unique, or none were found");
  const auto first = std::find_if(found.poses.begin(), found.poses.end(),
                                  [](const Forces& f) { return f.friction.state == State::undetermined; });
  if (first != found.poses.end()) {
    say(State::undetermined, fmt::format("friction depends on the force in \"{}\", which statics does not determine",
                                         scene.joints[static_cast<std::size_t>(first->friction.because_of)].name));
  }
  return listed(out);
}

Line verdict(const Scene& scene, const ForcesAlong& found, const std::string& dead, const std::string& pulls) {
  const bool ended = !found.complete && !found.stop;
  if (ended) return bad("Driven in part only: " + found.why + ".");
  if (!dead.empty() && !found.balanced()) return bad("Dead point: " + dead + ".");
  if (found.poses.empty()) return bad("No position was reached.");
  if (!pulls.empty()) return bad("It would take a contact that pulls: " + pulls + ".");
  if (!found.balanced()) {
    return bad(found.poses.front().drives.empty()
                   ? "Out of balance: the forces below do not hold the load; name a drive by --drive."
                   : "Out of balance: the drives cannot hold the load, nor do the forces below.");
  }
  if (!dead.empty()) return doubtful("Every body is in balance. Dead point: " + dead + ".");
  const std::string locked = without_forces(scene, found);
  if (!locked.empty()) return doubtful(fmt::format("No forces everywhere: {}.", locked));
  return good("Every body is in balance.");
}

/// Joints whose friction is left out where they stand still, though others move.
void warn_of_rest(Result& result, const Scene& scene, const ForcesAlong& found) {
  if (!rubs(found)) return;
  std::vector<std::size_t> poses(scene.joints.size(), 0);
  for (const Forces& forces : found.poses) {
    for (const int joint : forces.friction.at_rest) ++poses[static_cast<std::size_t>(joint)];
  }
  for (std::size_t j = 0; j < poses.size(); ++j) {
    if (poses[j] == 0) continue;
    result.warnings.push_back(
        doubtful(fmt::format("Friction in \"{}\" is left out {}, where the joint stands still: which way it resists is "
                             "not known.",
                             scene.joints[j].name, in_poses(poses[j], found))));
  }
}

/// Stops that are passed, and elements parallel to a drive, whose forces are part of its effort.
void add_warnings(Result& result, const MotionModel& model, const ForcesAlong& found, const std::string& dead,
                  const std::vector<ForceCourse>& courses, const std::vector<LoadedParallel>& parallels) {
  const auto warn = [&](std::string text) { result.warnings.push_back(doubtful(std::move(text))); };
  const std::vector<std::string> rubbing = joints_with_friction(model.scene());
  if (!rubbing.empty() && !rubs(found)) warn(fmt::format("Friction in {} is left out of all forces.", listed(rubbing)));
  warn_of_rest(result, model.scene(), found);
  if (rubs(found)) warn_of_unloaded_bearings(result, model.scene());
  for (const Stop& stop : model.scene().stops) {
    // The parts of a contact share their name.
    if (stop.friction.value_or(0.0) != 0.0 && !stop.table.starts_with("contact_part"))
      warn(fmt::format("Friction of the {} is left out of all forces.", stop.title()));
    if (rubbing_rims(stop.on).empty()) continue;
    warn(fmt::format("Friction of the rope \"{}\" on its pulleys is left out of all forces.", stop.name));
  }
  if (!dead.empty() && !found.complete && !found.stop) warn("Dead point: " + dead + ".");
  if (found.stop) warn("The range ends early: " + found.why + ".");
  for (const ForceCourse& course : courses) {
    if (!course.name.starts_with("overrun.")) continue;
    const auto passed = std::count_if(course.value.begin(), course.value.end(), [](double v) { return v > 0.0; });
    warn(fmt::format("Stop \"{}\" is passed in {} of {} positions, by up to {}.", course.name.substr(8), passed,
                     course.value.size(), with_unit(model, largest_size(course.value), course.quantity)));
  }
  for (const auto& [element, drive, course] : parallels) {
    warn(
        fmt::format("{} acts in parallel with the drive \"{}\", whose force or torque includes it (up to {}); --set "
                    "\"{}.{}=0\" leaves it out.",
                    course.name, drive, with_unit(model, largest_size(course.value), course.quantity), course.name,
                    numbers_of(element.law).front().key_on(&element.on)));
  }
}

/// Friction of joints that slide or turn, or would.
bool has_efforts_without(const Forces& forces) {
  using State = SlidingFriction::State;
  return forces.friction.state != State::none && forces.friction.state != State::still && !forces.drives.empty();
}

/// Drives of a single pose.
void add_drives(Group& group, const MotionModel& model, const Forces& forces, bool moving) {
  const Units& units = model.scene().units;
  const auto effort = [&](const DriveEffort& drive) {
    return with_unit(model, drive.value, drive.is_angle ? Quantity::moment : Quantity::force);
  };
  Table& table = group.table("", "Drives, positive where they drive forwards", Rows::list);
  table.words("", "drive", each(forces.drives, &DriveEffort::name));
  const bool has_none = forces.friction.has_no_forces();
  table.words("", "force or torque",
              has_none ? std::vector<std::string>(forces.drives.size(), "-") : each(forces.drives, effort));
  if (has_efforts_without(forces)) {
    std::vector<std::string> without;
    for (std::size_t k = 0; k < forces.drives.size(); ++k) {
      without.push_back(with_unit(model, forces.friction.efforts_without[k],
                                  forces.drives[k].is_angle ? Quantity::moment : Quantity::force));
    }
    table.words("", "without friction", std::move(without));
  }
  if (moving && !has_none) {
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

bool is_element(const ForceCourse& course) { return course.element >= 0; }

std::vector<double> efficiencies(const ForcesAlong& found, bool back) {
  return each(found.poses,
              [&](const Forces& f) { return back ? f.friction.efficiency_back() : f.friction.efficiency(); });
}

/// "0.3677", "0.31 to 0.45"; nothing where there is none.
std::string span_of(const std::vector<double>& values) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  if (least > most) return "";
  const std::string from = significant(least, force_digits), to = significant(most, force_digits);
  return from == to ? from : from + " to " + to;
}

/// What every joint loses in friction: of one pose at that moment, of several on average over the poses.
void add_friction(Group& group, const MotionModel& model, const ForcesAlong& found) {
  if (!rubs(found)) return;
  const Scene& scene = model.scene();
  struct Row {
    std::string joint, kind, effort;
    double lost = 0.0;
  };
  std::vector<Row> rows;
  double all = 0.0, elements = 0.0;
  std::size_t solved = 0;
  for (const Forces& forces : found.poses) {
    if (forces.friction.has_no_forces()) continue;
    ++solved;
    all += forces.friction.lost();
    elements += forces.friction.lost_in_elements;
  }
  if (solved == 0) return;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& joint = scene.joints[j];
    if (!joint.friction) continue;
    Row row{joint.name, std::string(joint.traits().key), {}, 0.0};
    double largest = 0.0;
    for (const Forces& forces : found.poses) {
      if (forces.friction.has_no_forces()) continue;
      for (const SlidingJoint& one : forces.friction.joints) {
        if (one.joint != static_cast<int>(j)) continue;
        row.lost += one.lost();
        if (std::abs(one.effort) >= std::abs(largest)) largest = one.effort;
      }
    }
    row.effort = with_unit(model, largest, joint.has_travel() ? Quantity::force : Quantity::moment);
    rows.push_back(std::move(row));
  }
  if (elements > 0.0) rows.push_back({"others", "friction", "", elements});
  const bool single = found.at.empty();
  const auto mean = [&](const Row& row) {
    return in_unit(row.lost / static_cast<double>(solved), Quantity::energy, scene.units);
  };
  Table& table =
      group.table("", single ? "Friction" : "Friction: largest forces and torques, and mean power lost", Rows::list);
  table.words("", "joint", each(rows, &Row::joint));
  table.words("", "kind", each(rows, &Row::kind));
  table.words("", "force or torque", each(rows, &Row::effort));
  table.numbers("", "lost", power_unit(scene.units), each(rows, mean), {.style = Format::Style::significant});
  table.numbers("", "share", "%", each(rows, [&](const Row& row) { return all > 0.0 ? 100 * row.lost / all : 0.0; }),
                {.style = Format::Style::significant, .digits = 4});
  const std::string forwards = span_of(efficiencies(found, false)), back = span_of(efficiencies(found, true));
  if (!forwards.empty()) group.fact("efficiency", forwards + " where the drives do work");
  if (!back.empty()) {
    group.fact("driven back", back == "0" ? "not at all: without the drives it would stop by itself"
                                          : back + " of the power arrives at the drives");
  }
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
      add_column(table, model, "", (course.quantity == Quantity::moment ? "torque of " : "force of ") + name,
                 course.quantity, course.value, force_digits);
    } else if (moving && course.name.starts_with("power.")) {
      table.numbers("", "power", power_unit(units), in_unit(course.value, course.quantity, units),
                    format_of(model, course.quantity, force_digits));
    } else if (course.name.starts_with("effort_without_friction.")) {
      add_column(table, model, "", "without friction", course.quantity, course.value, force_digits);
    }
  }
  if (rubs(found)) {
    table.numbers("", "efficiency", "", efficiencies(found, false), {.style = Format::Style::significant, .digits = 5});
  }
}

/// The largest of everything that is no drive, pressure angles of cams included, by size, and where.
void add_largest(Group& group, const MotionModel& model, const ForcesAlong& found,
                 const std::vector<ForceCourse>& courses) {
  const Scene& scene = model.scene();
  std::vector<ForceCourse> shown;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    ForceCourse size{"reaction." + scene.joints[j].name, Quantity::force};
    for (const Forces& f : found.poses) {
      size.value.push_back(f.friction.has_no_forces() ? std::numeric_limits<double>::quiet_NaN()
                                                      : norm(f.reactions[j].force));
    }
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

/// The torque over the period and the flywheel that holds the speed.
void add_fluctuation(Group& group, const MotionModel& model, const Fluctuation& found, double coefficient) {
  const Units& units = model.scene().units;
  const double angle_unit = unit_value(Quantity::angle, units), inertia_unit = dimension::inertia.unit(units);
  const std::string angle_name = unit_name(Quantity::angle, units);
  const auto at = [&](const Fluctuation::Place& place) {
    return fmt::format("{} at {} {}", with_unit(model, place.value, Quantity::moment),
                       significant(place.angle / angle_unit, force_digits), angle_name);
  };
  Group& data = group.group("fluctuation", "Fluctuation of the torque, and flywheel");
  data.data("drive", found.drive);
  data.data("speed", found.speed / angle_unit);
  data.data("coefficient", coefficient);
  for (const auto& [key, label, place] : {std::tuple("greatest_torque", "greatest", &found.greatest),
                                          std::tuple("least_torque", "least", &found.least)}) {
    data.data(key, in_unit(place->value, Quantity::moment, units));
    data.data(std::string(key) + "_at", place->angle / angle_unit);
    data.fact(label, at(*place));
  }
  data.data("mean_torque", in_unit(found.mean, Quantity::moment, units));
  data.data("mean_torque_error", in_unit(found.mean_error, Quantity::moment, units));
  data.fact("mean", with_unit(model, found.mean, Quantity::moment, force_digits, found.mean_error));
  data.data("energy_swing", in_unit(found.swing, Quantity::energy, units));
  data.data("energy_swing_error", in_unit(found.swing_error, Quantity::energy, units));
  data.data("fastest_at", found.fastest_at / angle_unit);
  data.data("slowest_at", found.slowest_at / angle_unit);
  data.fact("energy", fmt::format("swings by {}; a flywheel is fastest at {} {}, slowest at {} {}",
                                  with_unit(model, found.swing, Quantity::energy, force_digits, found.swing_error),
                                  significant(found.fastest_at / angle_unit, 4), angle_name,
                                  significant(found.slowest_at / angle_unit, 4), angle_name));
  const double inertia = found.flywheel(coefficient) / inertia_unit;
  const double error = found.flywheel_error(coefficient) / inertia_unit;
  data.entry("flywheel", "flywheel", inertia, dimension::inertia.unit_name(units),
             {.style = Format::Style::significant, .digits = force_digits, .radius = error},
             fmt::format("holds (largest - least speed) / mean at {}", coefficient));
  data.data("flywheel_error", error);
  data.data("poses", found.poses);
  data.fact("accuracy",
            fmt::format("the swing changes by {} of it from half of {} positions to these",
                        small_number(found.swing > 0.0 ? found.swing_error / found.swing : 0.0), found.poses));
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
  Group& numerics = group.group("", "Numerics", Verbosity::verbose);
  numerics.fact("imbalance", fmt::format("{} {} at \"{}\" (largest force {})",
                                         small_number(in_unit(f.imbalance, Quantity::force, model.scene().units)),
                                         model.scene().units.force_name, f.worst_body,
                                         with_unit(model, f.largest_force, Quantity::force, 4)));
  numerics.fact("cross-check", fmt::format("virtual work of the compiled model leaves {} of the largest force{}",
                                           small_number(work), moves(found) ? "; power: " + small_number(power) : ""));
}

std::string_view word_of(SlidingFriction::State state) {
  using State = SlidingFriction::State;
  switch (state) {
    case State::none:
      return "none";
    case State::still:
      return "still";
    case State::solved:
      return "solved";
    case State::locked:
      return "locked";
    case State::several:
      return "not unique";
    case State::undetermined:
      return "undetermined";
    case State::unbalanced:
      return "out of balance";
  }
  return "";
}

/// Per pose what became of friction, and which joints it was left out of.
void add_friction_data(Group& group, const Scene& scene, const ForcesAlong& found) {
  Branch& friction = group.array("friction");
  for (const Forces& forces : found.poses) {
    Group& pose = friction.parts.emplace_back();
    pose.data("state", std::string(word_of(forces.friction.state)));
    std::vector<std::string> still;
    for (const int joint : forces.friction.at_rest) still.push_back(scene.joints[static_cast<std::size_t>(joint)].name);
    pose.data("at_rest", std::move(still));
  }
}

Table& add_data(Group& group, const MotionModel& model, const ForcesAnswer& answer,
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
  if (!found.at.empty()) {
    const Places places = places_of(found, scene.units);
    forces.data(found.along, places.values).unit = places.unit;
  }
  for (const ForceCourse& course : courses) {
    const bool is_power = course.name.starts_with("power.") || course.name.starts_with("lost.");
    forces.data(course.name, in_unit(course.value, course.quantity, scene.units)).unit =
        is_power ? power_unit(scene.units) : unit_name(course.quantity, scene.units);
  }
  if (rubs(found)) {
    forces.data("efficiency", efficiencies(found, false));
    forces.data("efficiency_back", efficiencies(found, true));
    add_friction_data(group, scene, found);
  }
  std::vector<std::vector<SourcedForce>> on_bodies;
  for (std::size_t k = 0; k < found.poses.size(); ++k) {
    const double time = found.along == "time" ? found.at[k] : 0.0;
    on_bodies.push_back(scene.time_functions.empty() ? forces_on_bodies(scene, found.poses[k])
                                                     : forces_on_bodies(at_time(scene, time), found.poses[k]));
  }
  add_forces_on_bodies(group, model, on_bodies);
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
  return forces;
}

/// Of each pose. What friction leaves without forces has none.
std::vector<std::vector<QuantityValue>> quantities_in_poses(const Scene& scene, const ForcesAlong& found,
                                                            const std::vector<SoughtQuantity>& show) {
  if (show.empty()) return {};
  std::vector<std::vector<QuantityValue>> out;
  for (std::size_t k = 0; k < found.poses.size(); ++k) {
    const double time = found.along == "time" ? found.at[k] : 0.0;
    const Forces& forces = found.poses[k];
    out.push_back(scene.time_functions.empty() ? driven_quantities(scene, forces, show)
                                               : driven_quantities(at_time(scene, time), forces, show));
    if (!forces.friction.has_no_forces()) continue;
    const QuantityValue none{std::numeric_limits<double>::quiet_NaN(), "friction leaves the forces open here"};
    for (std::size_t q = 0; q < show.size(); ++q) {
      if (show[q].kind != SoughtQuantity::Kind::measure) out.back()[q] = none;
    }
  }
  return out;
}

/// Along the range, or in one pose.
void add_shown(Group& group, const MotionModel& model, const ForcesAlong& found,
               const std::vector<SoughtQuantity>& show, const std::vector<std::vector<QuantityValue>>& shown) {
  const Units& units = model.scene().units;
  if (show.empty()) return;
  if (found.at.empty()) {
    add_quantities(group, show, shown.front(), units);
    return;
  }
  const Places places = places_of(found, units);
  Table& table = group.table("", "Quantities", Rows::list);
  table.shown = Table::Shown::spread;
  table.numbers("", places.title, places.unit, places.values, {.digits = place_digits});
  add_quantity_columns(table, show, shown, units, false);
}

}  // namespace

std::string power_unit(const Units& units) {
  const std::string energy = unit_name(Quantity::energy, units);
  return energy == "J" ? "W" : energy + "/s";
}

Result forces_result(const MotionModel& model, const ForcesAnswer& answer, const std::vector<SoughtQuantity>& show,
                     const std::vector<std::string>& settings) {
  const ForcesAlong& found = answer.found;
  Result out = scene_result(model.scene(), settings);
  Group& content = out.content;
  const std::string dead = dead_points(model, found);
  const std::vector<ForceCourse> courses = force_courses(model.scene(), found);
  const std::vector<LoadedParallel> parallels = loaded_parallels(model, courses);
  out.verdict = verdict(model.scene(), found, dead, pulls_in_words(model, answer));
  add_warnings(out, model, found, dead, courses, parallels);
  content.fact("position", answer.how);
  content.data("drives", answer.drives);
  for (const std::string& drive : answer.drives) content.fact("drive", drive);
  if (!found.complete && !found.stop) content.fact("range", found.why);
  const std::vector<std::vector<QuantityValue>> shown = quantities_in_poses(model.scene(), found, show);
  add_quantity_columns(add_data(content, model, answer, courses, parallels), show, shown, model.scene().units, true,
                       false);
  if (found.poses.empty()) return out;
  add_contacts(content, model, answer);
  const bool moving = moves(found);
  if (found.at.empty()) {
    const Forces& forces = found.poses.front();
    add_drives(content, model, forces, moving);
    add_position(content, model, forces);
    add_elements(content, model, courses);
    add_shown(content, model, found, show, shown);
    add_friction(content, model, found);
    if (!forces.friction.has_no_forces()) {
      add_reactions(content, model, reaction_rows(forces.reactions), forces.redundancy);
      add_cams(content, model, cam_readings(model.scene(), poses_of(forces.motions), forces.reactions));
    }
  } else {
    add_efforts(content, model, found, courses, moving);
    if (answer.fluctuation) add_fluctuation(content, model, *answer.fluctuation, answer.coefficient);
    add_shown(content, model, found, show, shown);
    add_friction(content, model, found);
    add_largest(content, model, found, courses);
  }
  add_numerics(content, model, found);
  return out;
}

}  // namespace poise::app

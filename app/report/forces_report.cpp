#include "app/report/forces_report.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "app/report/parts.hpp"
#include "app/shown_values.hpp"
#include "app/table.hpp"

namespace poise::app {
namespace {

constexpr int place_digits = 8;

std::string force_text(const MotionModel& model, double value, Quantity quantity) {
  return significant(in_units(model, quantity, {value}).front(), force_digits);
}

std::string power_unit(const Units& units) {
  const std::string energy = unit_name(Quantity::energy, units);
  return energy == "J" ? "W" : energy + "/s";
}

/// The pose that is worst out of balance.
const Forces& worst(const ForcesAnswer& answer) {
  return *std::max_element(answer.found.poses.begin(), answer.found.poses.end(), [](const Forces& a, const Forces& b) {
    return a.imbalance * b.largest_force < b.imbalance * a.largest_force;
  });
}

/// "at ram = 300 mm": where no effort of the drives holds the load; nothing where there is no such place.
std::string dead_points(const MotionModel& model, const ForcesAnswer& answer) {
  const Scene& scene = model.scene();
  std::vector<std::string> places;
  for (const std::vector<double>& point : answer.found.dead_points) {
    std::vector<std::string> values;
    for (std::size_t k = 0; k < point.size(); ++k) {
      const Quantity quantity = quantity_of(scene.drives[k].on);
      values.push_back(fmt::format("{} = {} {}", scene.drives[k].name,
                                   significant(in_units(model, quantity, {point[k]}).front(), place_digits),
                                   unit_name(quantity, scene.units)));
    }
    places.push_back("at " + listed(values));
  }
  if (places.empty()) return "";
  return fmt::format("{} no finite effort of the {} holds the load", listed(places),
                     scene.drives.size() == 1 ? "drive" : "drives");
}

std::string verdict(const MotionModel& model, const ForcesAnswer& answer, const Palette& palette) {
  const ForcesAlong& found = answer.found;
  const std::string dead = dead_points(model, answer);
  const bool ended = !found.complete && !found.stop;
  if (!dead.empty() && (ended || !found.balanced())) return palette.paint(Tone::bad, "Dead point: " + dead + ".");
  if (ended) return palette.paint(Tone::bad, fmt::format("Driven in part only: {}.", found.why));
  if (found.poses.empty()) return palette.paint(Tone::bad, "There is no pose to look at.");
  if (!found.balanced()) {
    const bool driven = !found.poses.front().drives.empty();
    return palette.paint(Tone::bad, driven ? "Out of balance: the drives cannot give what this takes."
                                           : "Out of balance: nothing holds it so; name a drive by --drive.");
  }
  if (!dead.empty()) return palette.paint(Tone::doubtful, "Every body is in balance. Dead point: " + dead + ".");
  return palette.paint(Tone::good, "Every body is in balance.");
}

/// Where stops have a say, or should have.
std::string stop_facts(const MotionModel& model, const ForcesAnswer& answer, const Palette& palette) {
  std::string out;
  if (!answer.found.complete && !answer.found.stop) out += fact("range", answer.found.why, palette);
  if (answer.found.stop)
    out += fact("range", palette.paint(Tone::doubtful, "ends early: " + answer.found.why), palette);
  std::set<std::string> idle;
  for (const Forces& forces : answer.found.poses) idle.insert(forces.idle_stops.begin(), forces.idle_stops.end());
  for (const std::string& stop : idle) {
    out += fact("stop", fmt::format("\"{}\" is touched; the drive carries all, the stop nothing", stop), palette);
  }
  for (const ForceCourse& course : force_courses(model.scene(), answer.found)) {
    if (!course.name.starts_with("overrun.")) continue;
    const auto passed = std::count_if(course.value.begin(), course.value.end(), [](double v) { return v > 0.0; });
    out += fact("stop",
                palette.paint(Tone::bad,
                              fmt::format("\"{}\" is passed in {} of {} poses, by up to {} {}", course.name.substr(8),
                                          passed, course.value.size(),
                                          force_text(model, *std::max_element(course.value.begin(), course.value.end()),
                                                     course.quantity),
                                          unit_name(course.quantity, model.scene().units))),
                palette);
  }
  return out;
}

/// What the drives work against though the mechanism's load does not ask for it.
std::string parallel_facts(const MotionModel& model, const ForcesAnswer& answer, const Palette& palette) {
  std::string out;
  for (const auto& [element, drive, course] : loaded_parallels(model, answer.found)) {
    const double largest = *std::max_element(course.value.begin(), course.value.end(),
                                             [](double a, double b) { return std::abs(a) < std::abs(b); });
    out += fact("in parallel",
                palette.paint(Tone::doubtful,
                              fmt::format("{} acts on what the drive \"{}\" moves, so that it bears this too (up to {} "
                                          "{}); --set \"{}.{}=0\" leaves it out",
                                          course.name, drive, force_text(model, std::abs(largest), course.quantity),
                                          unit_name(course.quantity, model.scene().units), course.name,
                                          numbers_of(element.law).front().key_on(&element.on))),
                palette);
  }
  return out;
}

std::string facts(const MotionModel& model, const ForcesAnswer& answer, const Palette& palette) {
  std::string out =
      fact("pose", answer.how, palette) + stop_facts(model, answer, palette) + parallel_facts(model, answer, palette);
  if (answer.found.poses.empty()) return out;
  const Units& units = model.scene().units;
  const Forces& f = worst(answer);
  out += fact("imbalance",
              fmt::format("{} {} at \"{}\" (largest force {} {})",
                          small_number(in_unit(f.imbalance, Quantity::force, units)), units.force_name, f.worst_body,
                          significant(in_unit(f.largest_force, Quantity::force, units), 4), units.force_name),
              palette);
  double work = 0.0, power = 0.0;
  bool moves = false;
  for (const Forces& forces : answer.found.poses) {
    work = std::max(work, forces.work_error);
    power = std::max(power, forces.power.error);
    moves = moves || std::any_of(forces.motions.begin(), forces.motions.end(),
                                 [](const BodyMotion& m) { return m.rate != 0.0 || norm(m.velocity) > 0.0; });
  }
  std::string cross =
      fmt::format("virtual work of the phasor model left over: {} of the largest force", small_number(work));
  if (moves) cross += fmt::format("; power: {}", small_number(power));
  return out + fact("cross-check", cross, palette);
}

std::string drive_section(const MotionModel& model, const Forces& forces, const Palette& palette) {
  const Units& units = model.scene().units;
  std::vector<std::string> names, efforts, of, powers;
  std::vector<Cell> notes;
  for (const DriveEffort& drive : forces.drives) {
    const Quantity quantity = drive.is_angle ? Quantity::moment : Quantity::force;
    names.push_back(drive.name);
    efforts.push_back(force_text(model, drive.value, quantity));
    of.push_back(unit_name(quantity, units));
    powers.push_back(force_text(model, drive.power, Quantity::energy));
    notes.push_back({drive.determined ? "" : "undetermined", Tone::doubtful});
  }
  if (names.empty()) return "";
  Table table;
  table.add_text_column("drive", names);
  table.add_number_column("gives", efforts);
  table.add_text_column("", of);
  table.add_number_column(fmt::format("power ({})", power_unit(units)), powers);
  table.add_text_column("", notes);
  return section("Drives, positive where they drive forwards", table.print(palette), palette);
}

/// Springs, dampers and friction of one pose.
std::string element_section(const MotionModel& model, const ForcesAnswer& answer, const Palette& palette) {
  std::vector<std::string> names, values, of;
  for (const ForceCourse& course : force_courses(model.scene(), answer.found)) {
    const std::string kind = course.name.substr(0, course.name.find('.'));
    if (kind == "effort" || kind == "power" || kind == "reaction" || kind == "stop" || kind == "imbalance" ||
        kind == "overrun") {
      continue;
    }
    names.push_back(course.name);
    values.push_back(force_text(model, course.value.front(), course.quantity));
    of.push_back(unit_name(course.quantity, model.scene().units));
  }
  if (names.empty()) return "";
  Table table;
  table.add_text_column("element", names);
  table.add_number_column("carries", values);
  table.add_text_column("", of);
  return section("Springs and dampers, tension positive, moments on the second body", table.print(palette), palette);
}

/// Rows of a long range that are shown: evenly spread, the last always.
std::vector<std::size_t> shown_rows(std::size_t count) {
  const std::size_t stride = std::max<std::size_t>(1, (count + Table::shown_rows - 1) / Table::shown_rows);
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < count; k += stride) rows.push_back(k);
  if (!rows.empty() && rows.back() != count - 1) rows.push_back(count - 1);
  return rows;
}

std::vector<std::string> place_column(const MotionModel& model, const ForcesAnswer& answer,
                                      const std::vector<std::size_t>& rows) {
  std::vector<double> values;
  for (std::size_t k : rows) {
    values.push_back(answer.found.measure ? in_units(model, *answer.found.measure, {answer.found.at[k]}).front()
                                          : answer.found.at[k]);
  }
  return aligned(values, place_digits);
}

std::string place_title(const MotionModel& model, const ForcesAnswer& answer) {
  return answer.found.measure ? with_unit(answer.found.along, *answer.found.measure, model.scene().units)
                              : answer.found.along + " (s)";
}

std::string course_section(const MotionModel& model, const ForcesAnswer& answer, const Palette& palette) {
  const Units& units = model.scene().units;
  const std::vector<std::size_t> rows = shown_rows(answer.found.at.size());
  Table table;
  table.add_number_column(place_title(model, answer), place_column(model, answer, rows));
  bool any = false;
  for (const ForceCourse& course : force_courses(model.scene(), answer.found)) {
    const bool effort = course.name.starts_with("effort.");
    if (!effort && !course.name.starts_with("power.")) continue;
    std::vector<double> values;
    for (std::size_t k : rows) values.push_back(course.value[k]);
    const std::string name = course.name.substr(course.name.find('.') + 1);
    table.add_number_column(
        effort ? with_unit(name, course.quantity, units) : fmt::format("its power ({})", power_unit(units)),
        aligned(in_units(model, course.quantity, values), force_digits));
    any = true;
  }
  return any ? section("Drives, positive where they drive forwards", table.print(palette), palette) : "";
}

/// The largest of everything that is no drive, by size, and where.
std::string largest_section(const MotionModel& model, const ForcesAnswer& answer, const Palette& palette) {
  const Scene& scene = model.scene();
  std::vector<ForceCourse> courses;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    ForceCourse size{"reaction." + scene.joints[j].name, Quantity::force, {}};
    for (const Forces& f : answer.found.poses) size.value.push_back(norm(f.reactions[j].force));
    courses.push_back(std::move(size));
  }
  for (ForceCourse& course : force_courses(scene, answer.found)) {
    const bool is_moment = course.name.ends_with(".moment");
    if (course.name.starts_with("effort.") || course.name.starts_with("power.") || course.name == "imbalance" ||
        course.name.starts_with("overrun.") || (course.name.starts_with("reaction.") && !is_moment)) {
      continue;
    }
    courses.push_back(std::move(course));
  }
  double rounding = 0.0;
  for (const Forces& f : answer.found.poses) rounding = std::max(rounding, answer.found.tolerance * f.largest_force);
  std::vector<std::string> names, values, of;
  std::vector<std::size_t> rows;
  for (const ForceCourse& course : courses) {
    const auto largest = std::max_element(course.value.begin(), course.value.end(),
                                          [](double a, double b) { return std::abs(a) < std::abs(b); });
    names.push_back(course.name);
    const double unit = course.quantity == Quantity::moment ? model.scales().length : 1.0;
    const double shown = std::abs(*largest) <= rounding * unit ? 0.0 : *largest;
    values.push_back(force_text(model, shown, course.quantity));
    of.push_back(unit_name(course.quantity, scene.units));
    rows.push_back(static_cast<std::size_t>(largest - course.value.begin()));
  }
  if (names.empty()) return "";
  Table table;
  table.add_text_column("what", names);
  table.add_number_column("largest", values);
  table.add_text_column("", of);
  table.add_number_column("at " + place_title(model, answer), place_column(model, answer, rows));
  return section("Largest forces by size, tension positive", table.print(palette), palette);
}

}  // namespace

std::string forces_report(const MotionModel& model, const ForcesAnswer& answer, const Palette& palette) {
  std::string out = heading(model, palette) + verdict(model, answer, palette) + "\n" + facts(model, answer, palette);
  if (answer.found.poses.empty()) return out;
  if (!answer.found.at.empty())
    return out + course_section(model, answer, palette) + largest_section(model, answer, palette);
  const Forces& forces = answer.found.poses.front();
  return out + drive_section(model, forces, palette) + element_section(model, answer, palette) +
         reaction_section(model, forces.reactions, forces.redundancy, palette);
}

}  // namespace poise::app

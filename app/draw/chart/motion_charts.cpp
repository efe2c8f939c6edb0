#include "app/draw/chart/motion_charts.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "motion/courses.hpp"
#include "motion/force_courses.hpp"

namespace poise::app {
namespace {

constexpr std::size_t most_curves = 12;

std::string titled(const std::string& title, Quantity quantity, const Units& units) {
  return fmt::format("{} ({})", title, unit_name(quantity, units));
}

/// What an axis says of it: `, up to the stop "cowl"`, or nothing.
std::string up_to_stop(const std::optional<MetStop>& met, const Scene& scene) {
  return met ? fmt::format(", up to the stop \"{}\"", scene.stops[met->stop].name) : "";
}

struct Extent {
  double low = 0.0, high = 0.0;
  double size() const { return high - low; }
};

Extent extent_of(const std::vector<double>& values) {
  if (values.empty()) return {};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {*low, *high};
}

/// What is drawn as one curve: the channels of one coordinate, bodies that keep parallel.
struct MovingParts {
  std::size_t channel = 0;  // the first of them
  std::string names;
  Extent extent;
};

std::vector<MovingParts> moving(const MotionRecord& record, Quantity quantity) {
  std::vector<MovingParts> out;
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    const Channel& channel = record.channels[c];
    if (channel.quantity != quantity) continue;
    const auto same = std::find_if(out.begin(), out.end(), [&](const MovingParts& m) {
      return record.channels[m.channel].coordinate == channel.coordinate;
    });
    if (same == out.end())
      out.push_back({c, channel.name, extent_of(record.value[c])});
    else
      same->names += ", " + channel.name;
  }
  return out;
}

/// Curves of one quantity; no curves where nothing of the kind moves.
Panel panel_of(const MotionRecord& record, Quantity quantity, const Units& units) {
  const std::string noun = quantity == Quantity::angle ? "angle" : "travel";
  std::vector<MovingParts> chosen = moving(record, quantity);
  if (chosen.empty()) return {};
  Extent all = chosen.front().extent;
  double widest = 0.0;
  for (const MovingParts& m : chosen) {
    all = {std::min(all.low, m.extent.low), std::max(all.high, m.extent.high)};
    widest = std::max(widest, m.extent.size());
  }
  Panel panel{.title = noun + "s", .y_label = titled(noun, quantity, units)};
  if (chosen.size() > most_curves) {
    panel.title = fmt::format("the {} of {} {}s that change most", most_curves, chosen.size(), noun);
    std::stable_sort(chosen.begin(), chosen.end(),
                     [&](const MovingParts& a, const MovingParts& b) { return a.extent.size() > b.extent.size(); });
    chosen.resize(most_curves);
  }
  constexpr double little = 0.15;
  const bool from_start = widest < little * all.size();
  if (from_start) panel.title += ", from where they start";
  for (const MovingParts& m : chosen) {
    Curve curve{.name = m.names, .x = record.time, .y = in_unit(record.value[m.channel], quantity, units)};
    const double start = from_start && !curve.y.empty() ? curve.y.front() : 0.0;
    for (double& y : curve.y) y -= start;
    panel.curves.push_back(std::move(curve));
  }
  return panel;
}

Panel energy_panel(const MotionRecord& record, const Units& units) {
  std::vector<double> kinetic = in_unit(record.kinetic, Quantity::energy, units);
  std::vector<double> potential = in_unit(record.potential, Quantity::energy, units);
  std::vector<double> sum = kinetic;
  const double start = potential.empty() ? 0.0 : potential.front();
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += potential[k] -= start;
  Panel panel{.title = "energies, the potential from its start", .y_label = titled("energy", Quantity::energy, units)};
  panel.curves = {{.name = "kinetic", .x = record.time, .y = std::move(kinetic)},
                  {.name = "potential", .x = record.time, .y = std::move(potential)},
                  {.name = "sum", .x = record.time, .y = std::move(sum), .style = Curve::Style::dashed}};
  return panel;
}

void mark_events(Panel& panel, const std::vector<ContactEvent>& events) {
  const Curve& sum = panel.curves.back();
  for (std::size_t k = 0; k < std::min(events.size(), shown_contact_events); ++k) {
    const auto at = std::lower_bound(sum.x.begin(), sum.x.end(), events[k].t);
    if (at == sum.x.end()) return;
    panel.marks.push_back(
        {.x = events[k].t, .y = sum.y[static_cast<std::size_t>(at - sum.x.begin())], .label = std::to_string(k + 1)});
  }
}

std::string label_of_drive(const Scene& scene, const KinematicsResult& found, const Course& drive) {
  return fmt::format("{} ({}){}", drive.name, unit_name(drive.quantity, scene.units), up_to_stop(found.stop, scene));
}

}  // namespace

std::string words_of(const ContactEvent& event, const Stop& stop) {
  const bool pulls = stop.table == "rope" || stop.table == "chain";
  if (!pulls) return to_string(event.kind);
  if (event.kind == ContactEvent::Kind::impact) return "taut";
  return event.kind == ContactEvent::Kind::lift_off ? "slack" : to_string(event.kind);
}

std::string side_of(const ContactEvent& event, const Stop& stop) {
  return fmt::format("{} ({})", stop.name, event.at.upper ? "max" : "min");
}

std::vector<Panel> kinematics_panels(const Scene& scene, const KinematicsResult& found,
                                     const std::vector<DriveRange>& ranges) {
  struct Derivative {
    const char* angles;
    const char* lengths;
    const char* per;
    std::vector<double> Course::*values;
  };
  static constexpr std::array<Derivative, 3> derivatives = {
      {{"Angles", "Slides", "", &Course::value},
       {"Angular velocities", "Slide velocities", "/s", &Course::rate},
       {"Angular accelerations", "Slide accelerations", "/s²", &Course::acceleration}}};
  const std::vector<Course> courses = coordinate_courses(scene, found);
  const Course drive = drive_course(scene, found, 0, ranges);
  const std::vector<double> x = in_unit(drive.value, drive.quantity, scene.units);
  const std::string label = label_of_drive(scene, found, drive);
  std::vector<Panel> panels;
  for (const Quantity quantity : {Quantity::angle, Quantity::length}) {
    for (const Derivative& d : derivatives) {
      Panel panel{.title = quantity == Quantity::angle ? d.angles : d.lengths,
                  .x_label = label,
                  .y_label = unit_name(quantity, scene.units) + d.per};
      for (const Course& course : courses) {
        if (course.quantity != quantity) continue;
        const std::vector<double> y = in_unit(course.*d.values, quantity, scene.units);
        // Bodies that remain parallel share a curve.
        const auto same =
            std::find_if(panel.curves.begin(), panel.curves.end(), [&](const Curve& c) { return c.y == y; });
        if (same != panel.curves.end())
          same->name += ", " + course.name;
        else if (panel.curves.size() < most_curves)
          panel.curves.push_back({.name = course.name, .x = x, .y = y});
      }
      if (!panel.curves.empty()) panels.push_back(std::move(panel));
    }
  }
  return panels;
}

std::vector<Panel> point_panels(const Scene& scene, const KinematicsResult& found,
                                const std::vector<DriveRange>& ranges, const std::vector<std::string>& points) {
  const std::string& unit = scene.units.length_name;
  const Course drive = drive_course(scene, found, 0, ranges);
  const std::vector<double> over = in_unit(drive.value, drive.quantity, scene.units);
  const std::string label = label_of_drive(scene, found, drive);
  std::vector<Panel> panels = {
      {.title = points.size() > 1 ? "Paths" : "Path of " + listed(points),
       .x_label = fmt::format("x ({})", unit),
       .y_label = fmt::format("y ({})", unit),
       .tall = true},
      {.title = points.size() > 1 ? "Speeds" : "Its speed", .x_label = label, .y_label = unit + "/s"},
      {.title = points.size() > 1 ? "Accelerations" : "Its acceleration", .x_label = label, .y_label = unit + "/s²"}};
  const auto sizes = [&](const std::vector<double>& x, const std::vector<double>& y) {
    std::vector<double> out;
    for (std::size_t k = 0; k < x.size(); ++k) {
      out.push_back(in_unit(std::hypot(x[k], y[k]), Quantity::length, scene.units));
    }
    return out;
  };
  const std::vector<Course> courses = point_courses(scene, found);
  for (const std::string& point : points) {
    const auto x =
        std::find_if(courses.begin(), courses.end(), [&](const Course& c) { return c.name == point + ".x"; });
    if (x == courses.end()) continue;  // a point of the ground, which stays
    const Course& y = *std::next(x);
    const std::string name = points.size() > 1 ? point : "";
    panels[0].curves.push_back({.name = name,
                                .x = in_unit(x->value, Quantity::length, scene.units),
                                .y = in_unit(y.value, Quantity::length, scene.units)});
    panels[1].curves.push_back({.name = name, .x = over, .y = sizes(x->rate, y.rate)});
    panels[2].curves.push_back({.name = name, .x = over, .y = sizes(x->acceleration, y.acceleration)});
  }
  return panels;
}

std::vector<Panel> motion_panels(const Scene& scene, const MotionRecord& record,
                                 const std::vector<ContactEvent>& events) {
  std::vector<Panel> panels;
  for (const Quantity quantity : {Quantity::angle, Quantity::length}) {
    Panel panel = panel_of(record, quantity, scene.units);
    if (!panel.curves.empty()) panels.push_back(std::move(panel));
  }
  panels.push_back(energy_panel(record, scene.units));
  if (!events.empty()) mark_events(panels.back(), events);
  for (Panel& panel : panels) {
    char& first = panel.title.front();
    first = static_cast<char>(std::toupper(static_cast<unsigned char>(first)));
  }
  panels.back().x_label = "time (s)";
  return panels;
}

std::vector<Panel> forces_panels(const Scene& scene, const ForcesAlong& found) {
  const std::vector<double> x = found.measure ? in_unit(found.at, *found.measure, scene.units) : found.at;
  const std::string x_label =
      (found.measure ? titled(found.along, *found.measure, scene.units) : found.along + " (s)") +
      up_to_stop(found.stop, scene);
  std::vector<Panel> panels;
  const auto panel = [&](const std::string& title, Quantity quantity) -> Panel& {
    for (Panel& p : panels) {
      if (p.title == title) return p;
    }
    panels.push_back({.title = title,
                      .x_label = x_label,
                      .y_label = titled(quantity == Quantity::moment ? "torque" : "force", quantity, scene.units)});
    return panels.back();
  };
  for (const ForceCourse& course : force_courses(scene, found)) {
    if (!course.name.starts_with("effort.")) continue;
    const bool turns = course.quantity == Quantity::moment;
    panel(turns ? "torques of drives" : "forces of drives", course.quantity)
        .curves.push_back(
            {.name = course.name.substr(7), .x = x, .y = in_unit(course.value, course.quantity, scene.units)});
  }
  std::vector<Curve> sizes;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    Curve curve{.name = scene.joints[j].name, .x = x};
    for (const Forces& f : found.poses) {
      curve.y.push_back(f.friction.has_no_forces() ? std::numeric_limits<double>::quiet_NaN()
                                                   : in_unit(norm(f.reactions[j].force), Quantity::force, scene.units));
    }
    sizes.push_back(std::move(curve));
  }
  const auto largest = [](const Curve& c) {
    double out = 0.0;
    for (const double y : c.y) out = std::isnan(y) ? out : std::max(out, y);
    return out;
  };
  if (sizes.size() > most_curves) {
    std::stable_sort(sizes.begin(), sizes.end(),
                     [&](const Curve& a, const Curve& b) { return largest(a) > largest(b); });
    sizes.resize(most_curves);
  }
  if (!sizes.empty()) panel("sizes of joint forces", Quantity::force).curves = std::move(sizes);
  return panels;
}

std::vector<Panel> forces_in_time_panels(const Scene& scene, const ForceHistory& found) {
  std::vector<Panel> panels = forces_panels(scene, found.found);
  if (found.found.poses.empty()) return panels;
  const std::vector<double>& times = found.found.at;
  Panel work{
      .title = "work of drives", .x_label = "time (s)", .y_label = titled("work", Quantity::energy, scene.units)};
  for (std::size_t d = 0; d < std::min(found.work.size(), most_curves); ++d) {
    work.curves.push_back({.name = found.found.poses.front().drives[d].name,
                           .x = times,
                           .y = in_unit(found.work[d], Quantity::energy, scene.units)});
  }
  if (!work.curves.empty()) panels.push_back(std::move(work));
  Panel bending{.title = "largest bending moments of links",
                .x_label = "time (s)",
                .y_label = titled("moment", Quantity::moment, scene.units)};
  for (const LinkCourse& one : found.links) {
    if (one.key != "moment" || bending.curves.size() == most_curves) continue;
    Curve curve{.name = one.link, .x = times};
    for (const LargestOnLink& at : one.value) curve.y.push_back(in_unit(at.value, Quantity::moment, scene.units));
    bending.curves.push_back(std::move(curve));
  }
  if (!bending.curves.empty()) panels.push_back(std::move(bending));
  if (found.motors) {
    for (Panel& panel : panels) {
      if (const std::size_t at = panel.title.find("drives"); at != std::string::npos)
        panel.title.replace(at, 6, "motors");
    }
  }
  return panels;
}

}  // namespace poise::app

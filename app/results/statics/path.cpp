#include "app/results/statics/path.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/quantities.hpp"
#include "app/results/statics/snap_motions.hpp"
#include "statics/model/pose_values.hpp"
#include "statics/paths/over_path.hpp"
#include "statics/paths/path_words.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_points = 8;

/// A point with the branch on which it lies.
struct PathRow {
  const PathPoint* point = nullptr;
  int branch = 0;
};

/// What every part of the report needs.
struct PathReport {
  const VariedScene& varied;
  const Path& found;
  const PathView& view;
  PathReader reader{varied, other_quantity};
  std::unordered_map<const PathPoint*, std::vector<double>> found_measures{};

  const Scene& scene() const { return varied.scene(); }
  const Units& units() const { return varied.scene().units; }
  double parameter(double si) const { return si / varied.unit(); }
  double effort(double si) const { return si / varied.effort_dimension().unit(units()); }
  /// The quantities that are shown, in units, in their order; found once for each point.
  const std::vector<double>& measures(const PathPoint& point) {
    std::vector<double>& out = found_measures[&point];
    if (!out.empty() || view.measures.empty()) return out;
    const std::vector<QuantityValue> values = reader.values(view.measures, point);
    for (std::size_t k = 0; k < values.size(); ++k) {
      out.push_back(values[k].value / view.measures[k].dimension.unit(units()));
    }
    return out;
  }
  /// "load.P = 4.2 kN".
  std::string at(double si, int digits = digits_of_points) const { return varied.name() + " = " + amount(si, digits); }
  /// "4.2 kN".
  std::string amount(double si, int digits = digits_of_points) const {
    const std::string unit = varied.unit_name();
    return significant(parameter(si), digits) + (unit.empty() ? "" : " " + unit);
  }
  std::string energy(double si) const {
    return significant(in_unit(si, Quantity::energy, units()), force_digits) + " " +
           unit_name(Quantity::energy, units());
  }
};

std::vector<PathRow> rows_of(const Path& found) {
  std::vector<PathRow> rows;
  for (std::size_t b = 0; b < found.branches.size(); ++b) {
    for (const PathPoint& point : found.branches[b].points) rows.push_back({&point, static_cast<int>(b)});
  }
  return rows;
}

// ---- Data ----

std::vector<std::string> names_of(const std::vector<int>& items, auto&& name) {
  std::vector<std::string> out;
  for (const int item : items) out.push_back(name(static_cast<std::size_t>(item)));
  return out;
}

/// Where the mechanism is at a point.
void add_pose_data(Group& group, PathReport& report, const PathPoint& point) {
  const Readings readings = report.reader.read(point);
  const StaticModel& model = report.reader.model(point);
  add_named(group, "angles", angles_of(model, readings), Quantity::angle, report.units());
  add_named(group, "slides", travels_of(model, readings), Quantity::length, report.units());
  const std::vector<std::size_t> bodies = free_bodies(model.layout());
  Table& places = group.table("positions", "", Rows::values, Verbosity::data);
  const auto length = [&](double si) { return in_unit(si, Quantity::length, report.units()); };
  places.words("name", "", each(bodies, [&](std::size_t i) { return report.scene().bodies[i].name; }));
  places.data("[]", each(bodies, [&](std::size_t i) { return length(readings.poses[i].origin.x); }));
  places.data("[]", each(bodies, [&](std::size_t i) { return length(readings.poses[i].origin.y); }));
  Table& measures = group.table("measures", "", Rows::values, Verbosity::data);
  measures.words("name", "", each(report.view.measures, &SoughtQuantity::name));
  measures.data("value", report.measures(point));
}

std::optional<double> energy_of(const PathReport& report, const PathPoint& point) {
  if (!point.energy) return std::nullopt;
  return in_unit(*point.energy, Quantity::energy, report.units());
}

std::optional<double> effort_of(const PathReport& report, const PathPoint& point) {
  if (!report.varied.is_driven()) return std::nullopt;
  return report.effort(point.effort);
}

std::optional<double> radius_of(const PathPoint& point) {
  if (point.proof != PointProof::proved) return std::nullopt;
  return point.radius;
}

void add_point_data(Group& group, PathReport& report, const PathPoint& point) {
  group.data("parameter", report.parameter(point.parameter));
  group.data("stability", to_string(point.stability));
  group.data("unstable_directions", point.unstable_directions);
  group.data("energy", energy_of(report, point));
  group.data("effort", effort_of(report, point));
  group.data("active_stops", names_of(point.active_stops, [&](std::size_t i) { return report.scene().stops[i].name; }));
  group.data("slack_springs",
             names_of(point.slack_springs, [&](std::size_t i) { return report.scene().elements[i].name; }));
  group.data("proof", to_string(point.proof));
  group.data("statement", point.statement);
  group.data("radius", radius_of(point));
  add_pose_data(group, report, point);
}

/// Name of the stop or spring of an event; empty where it has none.
std::string item_of(const PathReport& report, const PathEvent& event) {
  if (event.item < 0) return "";
  const auto item = static_cast<std::size_t>(event.item);
  return event.kind == PathEvent::Kind::slack ? report.scene().elements[item].name : report.scene().stops[item].name;
}

std::optional<double> energy_released(const PathEvent& event) {
  if (!event.landing || !event.at.energy || !event.landing->energy) return std::nullopt;
  return *event.at.energy - *event.landing->energy;
}

/// A word, or null.
Value word_of(const std::optional<Stability>& stability) { return stability ? Value(to_string(*stability)) : Value(); }

void add_event_data(Group& content, PathReport& report) {
  Branch& events = content.array("events");
  for (std::size_t e = 0; e < report.found.events.size(); ++e) {
    const PathEvent& event = report.found.events[e];
    const EventPlace place = place_of(report.found, static_cast<int>(e), report.varied.to() - report.varied.from());
    Group& out = events.parts.emplace_back();
    out.data("kind", to_string(event.kind));
    out.data("digits", event.digits());
    out.data("error", event.error);
    out.data("rounding_effect", event.rounding_effect);
    out.data("branch", place.branch < 0 ? Value() : Value(place.branch + 1));
    const std::string item = item_of(report, event);
    out.data("item", item.empty() ? Value() : Value(item));
    out.data("on", item.empty() ? Value() : Value(event.on));
    out.data("before", word_of(place.before));
    out.data("after", word_of(place.after));
    out.data("why", event.why);
    add_point_data(out, report, event.at);
    if (!event.landing) {
      out.data("landing", nullptr);
      out.data("energy_released", nullptr);
      continue;
    }
    add_point_data(out.group("landing", "", Verbosity::data), report, *event.landing);
    const std::optional<double> released = energy_released(event);
    out.data("energy_released", released ? Value(in_unit(*released, Quantity::energy, report.units())) : Value());
  }
}

void add_path_data(Group& content, PathReport& report) {
  const Path& found = report.found;
  content.data("status", to_string(found.status));
  content.data("why", found.why);
  Group& parameter = content.group("parameter", "", Verbosity::data);
  parameter.data("name", report.varied.name());
  parameter.data("from", report.parameter(report.varied.from()));
  parameter.data("to", report.parameter(report.varied.to()));
  parameter.data("unit", report.varied.unit_name());
  parameter.data("driven", report.varied.is_driven() ? Value(report.varied.driven_words()) : Value());
  Branch& points = content.array("points");
  Branch& branches = content.array("branches");
  for (std::size_t b = 0; b < found.branches.size(); ++b) {
    const PathBranch& branch = found.branches[b];
    Group& out = branches.parts.emplace_back();
    out.data("from_event", branch.from < 0 ? Value() : Value(branch.from + 1));
    out.data("first_point", points.parts.size() + 1);
    out.data("points", branch.points.size());
    out.data("events", [&] {
      std::vector<std::int64_t> numbers;
      for (const int event : branch.events) numbers.push_back(event + 1);
      return numbers;
    }());
    out.data("end", to_string(branch.end));
    out.data("why", branch.why);
    for (const PathPoint& point : branch.points) {
      Group& of_point = points.parts.emplace_back();
      of_point.data("branch", b + 1);
      add_point_data(of_point, report, point);
    }
  }
  add_event_data(content, report);
  Branch& wanted = content.array("at");
  for (std::size_t k = 0; k < report.view.at.size(); ++k) {
    Group& out = wanted.parts.emplace_back();
    out.data("parameter", report.parameter(report.view.at[k]));
    Branch& equilibria = out.array("equilibria");
    if (k >= found.wanted.size()) continue;
    for (const PathPoint& point : found.wanted[k]) add_point_data(equilibria.parts.emplace_back(), report, point);
  }
  content.data("unproved", found.unproved());
  content.data("steps", found.steps);
  content.data("evaluations", found.evaluations);
  content.data("microseconds", found.microseconds);
}

/// One line for each point.
void add_csv(Group& content, PathReport& report, const std::vector<PathRow>& rows) {
  Table& table = content.table("", "", Rows::list, Verbosity::data);
  table.csv = true;
  std::set<std::string> taken;
  const auto add = [&](const std::string& name, std::vector<double> values, const std::string& unit = "") {
    if (taken.insert(name).second) table.data(name, std::move(values)).unit = unit;
  };
  add("branch", each(rows, [](const PathRow& row) { return row.branch + 1; }));
  add("parameter", each(rows, [&](const PathRow& row) { return report.parameter(row.point->parameter); }),
      report.varied.unit_name());
  if (report.varied.is_driven())
    add("effort", each(rows, [&](const PathRow& row) { return report.effort(row.point->effort); }),
        report.varied.effort_dimension().unit_name(report.units()));
  table.words("stability", "", each(rows, [](const PathRow& row) { return to_string(row.point->stability); }));
  table.words("proof", "", each(rows, [](const PathRow& row) { return to_string(row.point->proof); }));
  taken.insert({"stability", "proof"});
  add("unstable_directions", each(rows, [](const PathRow& row) { return row.point->unstable_directions; }));
  add("energy", each(rows, [&](const PathRow& row) { return energy_of(report, *row.point); }),
      unit_name(Quantity::energy, report.units()));
  add("radius", each(rows, [](const PathRow& row) { return radius_of(*row.point); }));
  std::vector<std::vector<double>> columns;
  std::vector<std::string> names, of_units;
  for (const PathRow& row : rows) {
    const Readings readings = report.reader.read(*row.point);
    const StaticModel& model = report.reader.model(*row.point);
    std::size_t column = 0;
    const auto put = [&](const std::vector<NamedValue>& values, Quantity quantity) {
      for (const NamedValue& value : values) {
        if (&row == &rows.front()) {
          names.push_back(value.name);
          of_units.push_back(unit_name(quantity, report.units()));
          columns.emplace_back();
        }
        columns[column++].push_back(in_unit(value.value, quantity, report.units()));
      }
    };
    put(angles_of(model, readings), Quantity::angle);
    put(travels_of(model, readings), Quantity::length);
    put(places_of(model, readings), Quantity::length);
  }
  for (std::size_t c = 0; c < columns.size(); ++c) add(names[c], std::move(columns[c]), of_units[c]);
  for (std::size_t k = 0; k < report.view.measures.size(); ++k) {
    const SoughtQuantity& measure = report.view.measures[k];
    add(measure.name, each(rows, [&](const PathRow& row) { return report.measures(*row.point)[k]; }),
        measure.dimension.unit_name(report.units()));
  }
}

// ---- Text ----

std::string proof_in_words(const PathPoint& point) {
  switch (point.proof) {
    case PointProof::proved:
      return "";
    case PointProof::critical:
      return "critical";
    case PointProof::failed:
      return "not proved";
    case PointProof::not_tried:
      return "not checked";
  }
  return "";
}

/// What is below 1e-13 of the mechanism's size, or of a radian, is rounding; in the units of the measure.
double rounding_of(const PathReport& report, const SoughtQuantity& measure) {
  constexpr double rounding = 1e-13;
  const double size = 1.0 / measure.dimension.per_scale(report.varied.scales());
  return rounding * size / measure.dimension.unit(report.units());
}

/// Columns of the measures, and of a driven measure the effort, at the points of the rows.
void add_measures(Table& table, PathReport& report, const std::vector<const PathPoint*>& points) {
  for (std::size_t k = 0; k < report.view.measures.size(); ++k) {
    const SoughtQuantity& measure = report.view.measures[k];
    table.numbers("", measure.name, measure.dimension.unit_name(report.units()),
                  each(points, [&](const PathPoint* point) { return report.measures(*point)[k]; }),
                  {.digits = digits_of_points, .zero_below = rounding_of(report, measure)});
  }
  if (!report.varied.is_driven()) return;
  const std::vector<double> efforts =
      each(points, [&](const PathPoint* point) { return report.effort(point->effort); });
  table.numbers(
      "", effort_name(report.varied), report.varied.effort_dimension().unit_name(report.units()), efforts,
      {.digits = force_digits,
       .zero_below = std::max(1e-12 * largest_size(efforts), report.effort(rounding_of_effort(report.varied)))});
}

void add_stability(Table& table, const std::vector<const PathPoint*>& points) {
  const auto words = [](const PathPoint* point) {
    std::string text = to_string(point->stability);
    if (point->unstable_directions > 1) text += fmt::format(", {} directions", point->unstable_directions);
    return text;
  };
  table.words("", "stability", each(points, words)).tones =
      each(points, [](const PathPoint* point) { return tone_of(point->stability); });
  std::vector<std::string> proofs = each(points, [](const PathPoint* point) { return proof_in_words(*point); });
  if (std::all_of(proofs.begin(), proofs.end(), [](const std::string& proof) { return proof.empty(); })) return;
  table.remarks(std::move(proofs)).tones = each(points, [](const PathPoint* point) {
    if (point->proof == PointProof::proved) return Tone::plain;
    return point->proof == PointProof::failed ? Tone::bad : Tone::doubtful;
  });
}

/// The first measure shown, in its units; 0 where it is rounding.
double first_measure(PathReport& report, const PathPoint& point) {
  const SoughtQuantity& measure = report.view.measures.front();
  const double value = report.measures(point).front();
  return std::abs(value) < rounding_of(report, measure) ? 0.0 : value;
}

/// "guide = -0.548 m": the first measure shown; empty where there is none.
std::string place_in_words(PathReport& report, const PathPoint& point) {
  if (report.view.measures.empty()) return "";
  const SoughtQuantity& measure = report.view.measures.front();
  return fmt::format("{} = {} {}", measure.name, significant(first_measure(report, point), digits_of_points),
                     measure.dimension.unit_name(report.units()));
}

/// "load.P = 42.9 N, guide = -0.548 m".
std::string point_in_words(PathReport& report, const PathPoint& point) {
  const std::string place = place_in_words(report, point);
  return report.at(point.parameter) + (place.empty() ? "" : ", " + place);
}

std::string landing_in_words(PathReport& report, const PathEvent& event) {
  if (!event.landing) return event.why.empty() ? "comes to rest nowhere" : event.why;
  const std::string place = place_in_words(report, *event.landing);
  // The column of the measure names it, and that of what comes after says whether it is stable.
  std::string text = place.empty() ? "lands elsewhere" : "to " + place.substr(place.find('=') + 2);
  if (event.landing->proof == PointProof::failed) text += ", not proved";
  if (const std::optional<double> released = energy_released(event)) text += ", releases " + report.energy(*released);
  return text;
}

std::string remark_on(PathReport& report, const PathEvent& event) {
  std::string text;
  switch (event.kind) {
    case PathEvent::Kind::stop:
      text = fmt::format("\"{}\" comes {}", item_of(report, event), event.on ? "on" : "off");
      break;
    case PathEvent::Kind::slack:
      text = fmt::format("\"{}\" {}", item_of(report, event), event.on ? "acts from here" : "goes slack");
      break;
    case PathEvent::Kind::snap:
      text = landing_in_words(report, event);
      break;
    case PathEvent::Kind::fold:
    case PathEvent::Kind::branch:
    case PathEvent::Kind::flutter:
    case PathEvent::Kind::hysteresis_end:
      break;
  }
  // Events are critical as a rule.
  const std::string proof = event.at.proof == PointProof::critical ? "" : proof_in_words(event.at);
  for (const std::string& more : {proof, event.why}) {
    if (!more.empty() && more != text) text += (text.empty() ? "" : "; ") + more;
  }
  return text;
}

/// Of the parameter; where nothing is known of its error, as of any number.
int shown_digits(const PathEvent& event) {
  return std::isfinite(event.error) ? std::max(1, event.digits()) : force_digits;
}

std::string title_of(PathEvent::Kind kind) {
  switch (kind) {
    case PathEvent::Kind::branch:
      return "branch point";
    case PathEvent::Kind::slack:
      return "one-way spring";
    case PathEvent::Kind::fold:
    case PathEvent::Kind::stop:
    case PathEvent::Kind::flutter:
    case PathEvent::Kind::snap:
    case PathEvent::Kind::hysteresis_end:
      break;
  }
  return to_string(kind);
}

void add_events(Group& content, PathReport& report) {
  const std::vector<PathEvent>& events = report.found.events;
  if (events.empty()) return;
  const std::string unit = report.varied.unit_name();
  std::vector<const PathPoint*> points;
  for (const PathEvent& event : events) points.push_back(&event.at);
  std::vector<EventPlace> sides;
  for (std::size_t e = 0; e < events.size(); ++e) {
    sides.push_back(place_of(report.found, static_cast<int>(e), report.varied.to() - report.varied.from()));
  }
  Table& table = content.table("", "Events", Rows::list);
  table.counts("", "no.", each(points, [n = 0](const PathPoint*) mutable { return ++n; }));
  table.words("", "event", each(events, [](const PathEvent& event) { return title_of(event.kind); }));
  // As many digits as are known.
  table.words("", report.varied.name() + (unit.empty() ? "" : " (" + unit + ")"),
              each(events, [&](const PathEvent& event) {
                return significant(report.parameter(event.at.parameter), shown_digits(event));
              }));
  add_measures(table, report, points);
  const auto side = [](const std::optional<Stability>& stability) {
    return stability ? to_string(*stability) : std::string("-");
  };
  table.words("", "before", each(sides, [&](const EventPlace& place) { return side(place.before); }));
  table.words("", "after", each(sides, [&](const EventPlace& place) { return side(place.after); }));
  table.remarks(each(events, [&](const PathEvent& event) { return remark_on(report, event); }));
}

void add_points(Group& content, PathReport& report, const std::vector<PathRow>& rows) {
  Table& table = content.table("", "Points of the curve", Rows::list);
  table.shown = Table::Shown::spread;
  const std::vector<const PathPoint*> points = [&] {
    std::vector<const PathPoint*> out;
    for (const PathRow& row : rows) out.push_back(row.point);
    return out;
  }();
  table.numbers("", report.varied.name(), report.varied.unit_name(),
                each(points, [&](const PathPoint* point) { return report.parameter(point->parameter); }),
                {.digits = digits_of_points});
  if (report.found.branches.size() > 1)
    table.counts("", "branch", each(rows, [](const PathRow& row) { return row.branch + 1; }));
  add_measures(table, report, points);
  add_stability(table, points);
}

void add_wanted(Group& content, PathReport& report) {
  std::vector<const PathPoint*> points;
  for (const std::vector<PathPoint>& at : report.found.wanted) {
    for (const PathPoint& point : at) points.push_back(&point);
  }
  if (!points.empty()) {
    Table& table = content.table("", "Equilibria at the values asked for", Rows::list);
    table.numbers("", report.varied.name(), report.varied.unit_name(),
                  each(points, [&](const PathPoint* point) { return report.parameter(point->parameter); }),
                  {.digits = digits_of_points});
    add_measures(table, report, points);
    add_stability(table, points);
  }
  for (std::size_t k = 0; k < report.view.at.size(); ++k) {
    if (k < report.found.wanted.size() && !report.found.wanted[k].empty()) continue;
    content.note(fmt::format("The curve has no equilibrium at {}.", report.at(report.view.at[k])), Tone::doubtful);
  }
}

/// "at angle.crank = 30 deg", "attained twice: at ..., at ...".
std::string where_in_words(const PathReport& report, const OverPathValue& value) {
  if (!value.why.empty()) return value.why;
  std::vector<std::string> places;
  for (const double at : value.at) places.push_back("at " + report.at(at, force_digits));
  constexpr std::size_t most = 4;
  if (places.size() > most) {
    const std::size_t others = places.size() - most;
    places.resize(most);
    places.push_back(fmt::format("at {} other places", others));
  }
  return (value.is_attained_twice ? "attained more than once, so that its derivatives are one-sided: " : "") +
         listed(places);
}

/// Quantities over each branch.
void add_over_path(Group& content, PathReport& report) {
  if (report.view.over_path.empty()) return;
  Branch& data = content.array("over_path");
  std::vector<double> branches;
  std::vector<std::string> names, values, units, where;
  for (std::size_t b = 0; b < report.found.branches.size(); ++b) {
    for (const SoughtQuantity& of : report.view.over_path) {
      const OverPathValue value = over_path(report.varied, report.found.branches[b], of, other_quantity);
      const double shown = value.value / of.dimension.unit(report.units());
      branches.push_back(static_cast<double>(b + 1));
      names.push_back(of.name);
      values.push_back(significant(shown, digits_of_points));
      units.push_back(of.dimension.unit_name(report.units()));
      where.push_back(where_in_words(report, value));
      Group& one = data.parts.emplace_back();
      one.data("branch", b + 1);
      one.data("name", of.name);
      one.data("value", value.why.empty() ? Value(shown) : Value());
      one.data("unit", units.back());
      one.data("why", value.why.empty() ? Value() : Value(value.why));
      one.data("at", each(value.at, [&](double si) { return report.parameter(si); }));
      one.data("attained_twice", value.is_attained_twice);
    }
  }
  Table& table = content.table("", "Over the curve", Rows::list);
  if (report.found.branches.size() > 1) table.counts("", "branch", branches);
  table.words("", "quantity", names);
  table.words("", "value", values);
  table.words("", "unit", units);
  table.remarks(where);
}

std::string end_of_branch(const PathBranch& branch) {
  switch (branch.end) {
    case PathBranch::End::range:
      return "at an end of the range";
    case PathBranch::End::closed:
      return "where it began";
    case PathBranch::End::blocked:
      return "at a stop";
    case PathBranch::End::snapped:
      return "in a snap";
    case PathBranch::End::singular:
      return "in a singular position";
    case PathBranch::End::stuck:
      return "where no step succeeds";
    case PathBranch::End::limit:
      return "at the limit of points";
    case PathBranch::End::interrupted:
      return "where it was interrupted";
  }
  return "";
}

void add_branches(Group& content, PathReport& report) {
  const std::vector<PathBranch>& branches = report.found.branches;
  if (branches.size() < 2) return;
  Table& table = content.table("", "Branches", Rows::list);
  table.counts("", "no.", each(branches, [n = 0](const PathBranch&) mutable { return ++n; }));
  table.words("", "begins", each(branches, [&](const PathBranch& branch) {
                if (branch.from >= 0) return fmt::format("at event {}", branch.from + 1);
                // Loading turns where the branch before ends.
                return &branch == &branches.front() ? std::string("at the start")
                                                    : fmt::format("where {} ends", &branch - branches.data());
              }));
  table.counts("", "points", each(branches, [](const PathBranch& branch) { return branch.points.size(); }));
  const auto end = [&](const PathBranch& branch) {
    if (branch.points.empty()) return std::numeric_limits<double>::quiet_NaN();
    return report.parameter(branch.points.back().parameter);
  };
  table.numbers("", "ends at " + report.varied.name(), report.varied.unit_name(), each(branches, end),
                {.digits = digits_of_points});
  table.words("", "", each(branches, end_of_branch));
}

bool is_cut_short(const PathBranch& branch) {
  return branch.end == PathBranch::End::stuck || branch.end == PathBranch::End::limit ||
         branch.end == PathBranch::End::singular;
}

void warn(Result& out, PathReport& report, const std::vector<PathRow>& rows) {
  const auto unproved =
      std::find_if(rows.begin(), rows.end(), [](const PathRow& row) { return row.point->proof == PointProof::failed; });
  if (unproved != rows.end()) {
    const int number = report.found.unproved();
    const PathPoint& first = *unproved->point;
    out.warnings.push_back(
        bad(fmt::format("{} not proved, the first at {}: {}", count(number, "point is", "points are"),
                        point_in_words(report, first), first.statement)));
  }
  for (std::size_t b = 0; b < report.found.branches.size(); ++b) {
    const PathBranch& branch = report.found.branches[b];
    if (!is_cut_short(branch) || branch.points.empty()) continue;
    const PathPoint& last = branch.points.back();
    out.warnings.push_back(doubtful(fmt::format("Branch {} ends at {}, {}{}.", b + 1, point_in_words(report, last),
                                                end_of_branch(branch), branch.why.empty() ? "" : ": " + branch.why)));
  }
  for (const std::string& note : report.found.notes) out.warnings.push_back(doubtful(note));
  warn_of_friction(out, report.scene());
}

/// "2 folds, 1 stop"; empty where there are none.
std::string events_in_words(const Path& found) {
  std::vector<std::string> parts;
  const auto add = [&](PathEvent::Kind kind, const char* one, const char* many) {
    const auto number = std::count_if(found.events.begin(), found.events.end(),
                                      [&](const PathEvent& event) { return event.kind == kind; });
    if (number > 0) parts.push_back(count(static_cast<int>(number), one, many));
  };
  add(PathEvent::Kind::fold, "fold", "folds");
  add(PathEvent::Kind::branch, "branch point", "branch points");
  add(PathEvent::Kind::flutter, "onset of flutter", "onsets of flutter");
  add(PathEvent::Kind::snap, "snap", "snaps");
  return parts.empty() ? "no folds" : listed(parts);
}

/// "from 0 N to 60 N, and back to 0 N".
std::string cycle_in_words(const PathReport& report, const std::vector<PathRow>& rows) {
  const double rises = report.varied.to() > report.varied.from() ? 1.0 : -1.0;
  const auto farthest = std::max_element(rows.begin(), rows.end(), [&](const PathRow& a, const PathRow& b) {
    return rises * a.point->parameter < rises * b.point->parameter;
  });
  std::string text = fmt::format("from {} to {}", report.amount(rows.front().point->parameter, force_digits),
                                 report.amount(farthest->point->parameter, force_digits));
  if (rows.back().branch > farthest->branch)
    text += ", and back to " + report.amount(rows.back().point->parameter, force_digits);
  return text;
}

/// How far the first curve goes: "from 0 N to 60 N", with its extremes where they lie beyond its ends.
std::string extent_in_words(const PathReport& report, const std::vector<PathPoint>& points) {
  const double first = points.front().parameter, last = points.back().parameter;
  const auto [least, most] = std::minmax_element(
      points.begin(), points.end(), [](const PathPoint& a, const PathPoint& b) { return a.parameter < b.parameter; });
  const double rounding = 1e-9 * std::abs(report.varied.to() - report.varied.from());
  std::string text =
      fmt::format("from {} to {}", report.amount(first, force_digits), report.amount(last, force_digits));
  if (most->parameter > std::max(first, last) + rounding)
    text += ", as high as " + report.amount(most->parameter, force_digits);
  if (least->parameter < std::min(first, last) - rounding)
    text += ", as low as " + report.amount(least->parameter, force_digits);
  return text;
}

std::string followed_in_words(const PathReport& report, const std::vector<PathRow>& rows) {
  return report.view.follow == PathOptions::Follow::jump
             ? cycle_in_words(report, rows)
             : extent_in_words(report, report.found.branches.front().points);
}

std::string proof_of_all(const Path& found, const std::vector<PathRow>& rows) {
  const auto number_of = [&](PointProof proof) {
    return static_cast<int>(
        std::count_if(rows.begin(), rows.end(), [&](const PathRow& row) { return row.point->proof == proof; }));
  };
  const int all = static_cast<int>(rows.size());
  const int failed = found.unproved(), critical = number_of(PointProof::critical);
  const int not_tried = number_of(PointProof::not_tried);
  if (failed > 0) return fmt::format("{} of {} not proved", failed, count(all, "point", "points"));
  if (not_tried > 0) return fmt::format("{} of {} not checked", not_tried, count(all, "point", "points"));
  if (critical > 0) {
    return fmt::format("{} of {} points are proved, the {} critical", all - critical, all,
                       critical == 1 ? "other is" : "others are");
  }
  return all == 1 ? "its point is proved" : fmt::format("all {} points are proved", all);
}

/// "P" of "load.P": in a sentence, which says what moves, a name goes without its kind.
std::string short_name(const std::string& name) {
  for (const char* kind : {"load.", "angle.", "travel."}) {
    if (name.starts_with(kind) && name.find('.', std::strlen(kind)) == std::string::npos) {
      return name.substr(std::strlen(kind));
    }
  }
  return name;
}

constexpr int digits_of_verdict = 4;

/// ": handle 93.61 to 23.41 deg", of the first measure shown; empty where there is none.
std::string move_in_words(PathReport& report, const PathPoint& from, const PathPoint& to) {
  if (report.view.measures.empty()) return "";
  const SoughtQuantity& measure = report.view.measures.front();
  const std::string unit = measure.dimension.unit_name(report.units());
  const std::string first = significant(first_measure(report, from), digits_of_verdict);
  const std::string last = significant(first_measure(report, to), digits_of_verdict);
  const std::string values = first == last ? "stays at " + first : first + " to " + last;
  return fmt::format(": {} {}{}{}", short_name(measure.name), values, unit.empty() ? "" : " ", unit);
}

/// ", leaving stop over_centre": what comes off where the mechanism snaps.
std::string stops_left(const PathReport& report, const PathEvent& snap) {
  constexpr double same = 1e-6;  // parts of the range, rad, mechanism sizes
  const double range = std::abs(report.varied.to() - report.varied.from());
  const auto is_there = [&](const PathPoint& at) {
    const auto near = [](double a, double b) { return std::abs(a - b) <= same; };
    return std::abs(at.parameter - snap.at.parameter) <= same * range &&
           std::equal(at.x.begin(), at.x.end(), snap.at.x.begin(), snap.at.x.end(), near);
  };
  std::vector<std::string> names;
  for (const PathEvent& event : report.found.events) {
    if (event.kind != PathEvent::Kind::stop || event.on || !is_there(event.at)) continue;
    names.push_back(item_of(report, event));
  }
  return names.empty() ? "" : ", leaving stop " + listed(names);
}

/// "at P = 37.09 N, leaving stop over_centre, onto stop open: handle 93.61 to 23.41 deg".
std::string snap_in_words(PathReport& report, const PathEvent& event) {
  std::string text = fmt::format("at {} = {}", short_name(report.varied.name()),
                                 report.amount(event.at.parameter, digits_of_verdict)) +
                     stops_left(report, event);
  if (!event.landing) return text + ", and " + landing_in_words(report, event);
  const std::vector<std::string> onto =
      names_of(event.landing->active_stops, [&](std::size_t i) { return report.scene().stops[i].name; });
  if (!onto.empty()) text += ", onto stop " + listed(onto);
  text += move_in_words(report, event.at, *event.landing);
  return text + (event.landing->proof == PointProof::failed ? ", which is not proved" : "");
}

/// What the mechanism does while the number changes: its snaps, or that there is none.
std::string course_in_words(PathReport& report, const std::vector<PathRow>& rows) {
  std::vector<std::string> snaps;
  for (const PathEvent& event : report.found.events) {
    if (event.kind == PathEvent::Kind::snap) snaps.push_back(snap_in_words(report, event));
  }
  constexpr std::size_t most = 2;
  const int others = static_cast<int>(snaps.size()) - static_cast<int>(most);
  if (others > 0) {
    snaps.resize(most);
    snaps.push_back(count(others, "more snap", "more snaps"));
  }
  if (!snaps.empty()) return fmt::format("Snaps {}", fmt::join(snaps, "; "));
  return fmt::format("Follows {} {} without a snap{}", short_name(report.varied.name()),
                     followed_in_words(report, rows), move_in_words(report, *rows.front().point, *rows.back().point));
}

/// What is not proved; empty where everything is.
std::string doubts_in_words(const Path& found, const std::vector<PathRow>& rows) {
  const bool all_tried = std::none_of(rows.begin(), rows.end(), [](const PathRow& row) {
    return row.point->proof == PointProof::failed || row.point->proof == PointProof::not_tried;
  });
  return all_tried && found.unproved() == 0 ? "" : "; " + proof_of_all(found, rows);
}

Line verdict(PathReport& report, const std::vector<PathRow>& rows) {
  const Path& found = report.found;
  if (found.status == Path::Status::no_start || rows.empty()) {
    if (found.status == Path::Status::interrupted) return bad("Interrupted before the first point.");
    return bad(found.why.empty() ? fmt::format("No equilibrium found at {}.", report.at(report.varied.from()))
                                 : sentence_of(found.why));
  }
  const std::string text = course_in_words(report, rows) + doubts_in_words(found, rows) + ".";
  if (found.status == Path::Status::interrupted) return bad("Interrupted. " + text);
  if (found.status == Path::Status::incomplete) return bad("Not followed to the end. " + text);
  return {"", text, found.unproved() == 0 ? Tone::good : Tone::bad};
}

/// How far the curve was followed, and what of it is proved.
void add_extent(Group& content, const PathReport& report, const std::vector<PathRow>& rows) {
  const Path& found = report.found;
  std::string followed = fmt::format("{} {}", report.varied.name(), followed_in_words(report, rows));
  const int further = static_cast<int>(found.branches.size()) - 1;
  if (further > 0 && report.view.follow == PathOptions::Follow::unstable) {
    followed += fmt::format(", with {}", count(further, "further branch", "further branches"));
  }
  content.fact("followed", fmt::format("{}: {}", followed, events_in_words(found)));
  content.fact("proof", proof_of_all(found, rows) + "; other curves of equilibria may exist");
}

}  // namespace

Result path_result(const VariedScene& varied, const Path& found, const PathView& view,
                   const std::vector<std::string>& settings) {
  PathReport report{varied, found, view};
  const std::vector<PathRow> rows = rows_of(found);
  Result out = scene_result(varied.scene(), settings);
  out.verdict = verdict(report, rows);
  warn(out, report, rows);
  add_path_data(out.content, report);
  add_csv(out.content, report, rows);
  if (rows.empty()) return out;
  add_extent(out.content, report, rows);
  if (varied.is_driven()) {
    out.content.fact("driven", fmt::format("{}: {}; the {} is positive where it tends to increase it", varied.name(),
                                           varied.driven_words(), effort_name(varied)));
  }
  add_events(out.content, report);
  add_snap_motions(out.content, varied, found, view);
  add_wanted(out.content, report);
  add_points(out.content, report, rows);
  add_over_path(out.content, report);
  add_branches(out.content, report);
  out.content.group("", "Numerics", Verbosity::verbose)
      .fact("effort", fmt::format("{}, {}, {}", count(found.steps, "step", "steps"),
                                  count(found.evaluations, "evaluation", "evaluations"), duration(found.microseconds)));
  return out;
}

}  // namespace poise::app

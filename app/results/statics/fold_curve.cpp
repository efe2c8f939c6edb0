#include "app/results/statics/fold_curve.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "statics/model/pose_values.hpp"
#include "statics/model/readings.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_folds = 8;

/// A point with the curve on which it lies.
struct FoldRow {
  const FoldPoint* point = nullptr;
  int curve = 0;
};

/// What every part of the report needs.
struct FoldReport {
  const VariedPair& pair;
  const FoldCurve& found;

  const Scene& scene() const { return pair.first().scene(); }
  const Units& units() const { return scene().units; }
  double first(const FoldPoint& point) const { return point.first / pair.first().unit(); }
  double second(const FoldPoint& point) const { return point.second / pair.second().unit(); }
  double coefficient(const FoldPoint& point) const { return in_unit(point.coefficient, Quantity::energy, units()); }
};

std::vector<FoldRow> rows_of(const FoldCurve& found) {
  std::vector<FoldRow> rows;
  for (std::size_t c = 0; c < found.curves.size(); ++c) {
    for (const FoldPoint& point : found.curves[c].points) rows.push_back({&point, static_cast<int>(c)});
  }
  return rows;
}

std::string to_string(FoldCurve::Status status) {
  switch (status) {
    case FoldCurve::Status::not_started:
      return "not started";
    case FoldCurve::Status::traced:
      return "traced";
    case FoldCurve::Status::incomplete:
      return "incomplete";
    case FoldCurve::Status::no_fold:
      return "no fold";
    case FoldCurve::Status::no_start:
      return "no start";
    case FoldCurve::Status::too_large:
      return "too large";
    case FoldCurve::Status::interrupted:
      return "interrupted";
  }
  return "";
}

std::string to_string(FoldBranch::End end) {
  switch (end) {
    case FoldBranch::End::range:
      return "range";
    case FoldBranch::End::closed:
      return "closed";
    case FoldBranch::End::piece:
      return "piece";
    case FoldBranch::End::stuck:
      return "stuck";
    case FoldBranch::End::limit:
      return "limit";
    case FoldBranch::End::interrupted:
      return "interrupted";
  }
  return "";
}

// ---- Data ----

void add_number_data(Group& content, const std::string& key, const VariedScene& varied) {
  Group& group = content.group(key, "", Verbosity::data);
  group.data("name", varied.name());
  group.data("from", varied.from() / varied.unit());
  group.data("to", varied.to() / varied.unit());
  group.data("unit", varied.unit_name());
}

void add_point_data(Group& group, const FoldReport& report, const FoldPoint& point) {
  group.data("first", report.first(point));
  group.data("second", report.second(point));
  group.data("coefficient", report.coefficient(point));
  group.data("unstable_directions", point.unstable_directions);
  group.data("active_stops", each(point.active_stops,
                                  [&](int stop) { return report.scene().stops[static_cast<std::size_t>(stop)].name; }));
  group.data("slack_springs", each(point.slack_springs, [&](int element) {
               return report.scene().elements[static_cast<std::size_t>(element)].name;
             }));
  const auto model = report.pair.model_at(point.first, point.second);
  const Readings readings = read_off(*model, point.x);
  add_named(group, "angles", angles_of(*model, readings), Quantity::angle, report.units());
  add_named(group, "slides", travels_of(*model, readings), Quantity::length, report.units());
}

void add_data(Group& content, const FoldReport& report) {
  const FoldCurve& found = report.found;
  content.data("status", to_string(found.status));
  content.data("why", found.why);
  add_number_data(content, "first", report.pair.first());
  add_number_data(content, "second", report.pair.second());
  Branch& cusps = content.array("cusps");
  for (const FoldCusp& cusp : found.cusps) {
    Group& out = cusps.parts.emplace_back();
    out.data("digits", cusp.digits());
    out.data("error", cusp.error);
    out.data("rounding_effect", cusp.rounding_effect);
    add_point_data(out, report, cusp.at);
  }
  Branch& points = content.array("points");
  Branch& curves = content.array("curves");
  for (std::size_t c = 0; c < found.curves.size(); ++c) {
    const FoldBranch& curve = found.curves[c];
    Group& out = curves.parts.emplace_back();
    out.data("first_point", points.parts.size() + 1);
    out.data("points", curve.points.size());
    std::vector<std::int64_t> numbers;
    for (const int cusp : curve.cusps) numbers.push_back(cusp + 1);
    out.data("cusps", numbers);
    out.data("begins", to_string(curve.end[0]));
    out.data("ends", to_string(curve.end[1]));
    out.data("why", std::vector<std::string>(curve.why.begin(), curve.why.end()));
    for (const FoldPoint& point : curve.points) {
      Group& of_point = points.parts.emplace_back();
      of_point.data("curve", c + 1);
      add_point_data(of_point, report, point);
    }
  }
  content.data("kinks", found.kinks);
  content.data("symmetric", found.symmetric);
  content.data("failed", found.failed);
  content.data("slices_without_start", found.slices_without_start);
  content.data("steps", found.steps);
  content.data("microseconds", found.microseconds);
}

/// One line for each point.
void add_csv(Group& content, const FoldReport& report, const std::vector<FoldRow>& rows) {
  Table& table = content.table("", "", Rows::list, Verbosity::data);
  table.csv = true;
  table.data("curve", each(rows, [](const FoldRow& row) { return static_cast<double>(row.curve + 1); }));
  const VariedScene &first = report.pair.first(), &second = report.pair.second();
  table.data(first.name(), each(rows, [&](const FoldRow& row) { return report.first(*row.point); })).unit =
      first.unit_name();
  table.data(second.name(), each(rows, [&](const FoldRow& row) { return report.second(*row.point); })).unit =
      second.unit_name();
  table.data("coefficient", each(rows, [&](const FoldRow& row) { return report.coefficient(*row.point); })).unit =
      unit_name(Quantity::energy, report.units());
  table.data("unstable_directions",
             each(rows, [](const FoldRow& row) { return static_cast<double>(row.point->unstable_directions); }));
}

// ---- Text ----

std::string title_of(const VariedScene& varied) {
  return varied.name() + (varied.unit_name().empty() ? "" : " (" + varied.unit_name() + ")");
}

void add_cusps(Group& content, const FoldReport& report) {
  const std::vector<FoldCusp>& cusps = report.found.cusps;
  if (cusps.empty()) return;
  Table& table = content.table("", "Cusps", Rows::list);
  table.counts("", "no.", each(cusps, [n = 0](const FoldCusp&) mutable { return ++n; }));
  // As many digits as are known of the range.
  const auto column = [&](const VariedScene& varied, auto value) {
    table.words("", title_of(varied), each(cusps, [&](const FoldCusp& cusp) {
                  const double range = std::abs(varied.to() - varied.from()) / varied.unit();
                  const double number = value(cusp.at);
                  const double doubt = std::max(cusp.error, cusp.rounding_effect) * range;
                  return significant(number, 15, doubt);
                }));
  };
  column(report.pair.first(), [&](const FoldPoint& point) { return report.first(point); });
  column(report.pair.second(), [&](const FoldPoint& point) { return report.second(point); });
  table.words("", "where folds meet", each(cusps, [](const FoldCusp& cusp) {
                const int directions = cusp.at.unstable_directions;
                if (directions < 0) return std::string("under follower loads");
                return directions == 0 ? std::string("a stable equilibrium is among them")
                                       : fmt::format("all unstable, {}", count(directions, "direction", "directions"));
              }));
}

void add_points(Group& content, const FoldReport& report, const std::vector<FoldRow>& rows) {
  Table& table = content.table("", "Points of the curve of folds", Rows::list);
  table.shown = Table::Shown::spread;
  table.numbers("", report.pair.first().name(), report.pair.first().unit_name(),
                each(rows, [&](const FoldRow& row) { return report.first(*row.point); }), {.digits = digits_of_folds});
  table.numbers("", report.pair.second().name(), report.pair.second().unit_name(),
                each(rows, [&](const FoldRow& row) { return report.second(*row.point); }), {.digits = digits_of_folds});
  if (report.found.curves.size() > 1)
    table.counts("", "curve", each(rows, [](const FoldRow& row) { return row.curve + 1; }));
}

std::string end_of_curve(const FoldBranch& curve, std::size_t side) {
  switch (curve.end[side]) {
    case FoldBranch::End::range:
      return "at an end of a range";
    case FoldBranch::End::closed:
      return "closed";
    case FoldBranch::End::limit:
      return "at the limit of points";
    case FoldBranch::End::interrupted:
      return "where it was interrupted";
    case FoldBranch::End::piece:
    case FoldBranch::End::stuck:
      break;
  }
  return curve.why[side];
}

void add_curves(Group& content, const FoldReport& report) {
  const std::vector<FoldBranch>& curves = report.found.curves;
  Table& table = content.table("", "Curves", Rows::list);
  table.counts("", "no.", each(curves, [n = 0](const FoldBranch&) mutable { return ++n; }));
  table.counts("", "points", each(curves, [](const FoldBranch& curve) { return curve.points.size(); }));
  table.counts("", "cusps", each(curves, [](const FoldBranch& curve) { return curve.cusps.size(); }));
  table.words("", "begins", each(curves, [](const FoldBranch& curve) { return end_of_curve(curve, 0); }));
  table.words("", "ends", each(curves, [](const FoldBranch& curve) { return end_of_curve(curve, 1); }));
}

Line verdict(const FoldReport& report) {
  const FoldCurve& found = report.found;
  const std::string names = report.pair.first().name() + " and " + report.pair.second().name();
  if (found.curves.empty()) return bad(fmt::format("No curve of folds in {}: {}.", names, found.why));
  const std::string what =
      fmt::format("{} with {}; other curves of folds may exist.",
                  count(static_cast<int>(found.curves.size()), "curve of folds", "curves of folds"),
                  found.cusps.empty() ? "no cusp" : count(static_cast<int>(found.cusps.size()), "cusp", "cusps"));
  if (found.status == FoldCurve::Status::interrupted) return bad(fmt::format("Interrupted; in {}: {}", names, what));
  if (found.status == FoldCurve::Status::incomplete) {
    return bad(fmt::format("Not followed to the end, {}; in {}: {}", found.why, names, what));
  }
  return {"", fmt::format("Folds followed in {}: {}", names, what), Tone::good};
}

void warn(Result& out, const FoldReport& report) {
  const FoldCurve& found = report.found;
  const auto warn_of = [&](int number, const std::string& one, const std::string& many, const std::string& rest) {
    if (number > 0) out.warnings.push_back(doubtful(count(number, one, many) + rest));
  };
  warn_of(found.kinks, "fold", "folds", " at which a stop or a one-way spring comes on or off: not followed.");
  warn_of(found.symmetric, "branch point", "branch points", " that neither number disturbs: not followed.");
  warn_of(found.failed, "fold or branch point", "folds or branch points", " from which no curve could be begun.");
  if (!found.curves.empty()) {
    warn_of(found.slices_without_start, "value", "values",
            " of one of both numbers at which no equilibrium was found to begin with.");
  }
  warn_of_friction(out, report.scene());
}

}  // namespace

Result fold_curve_result(const VariedPair& pair, const FoldCurve& found, const std::vector<std::string>& settings) {
  const FoldReport report{pair, found};
  const std::vector<FoldRow> rows = rows_of(found);
  Result out = scene_result(report.scene(), settings);
  out.verdict = verdict(report);
  warn(out, report);
  add_data(out.content, report);
  add_csv(out.content, report, rows);
  if (rows.empty()) return out;
  add_cusps(out.content, report);
  add_points(out.content, report, rows);
  add_curves(out.content, report);
  out.content.group("", "Numerics", Verbosity::verbose)
      .fact("effort", fmt::format("{}, {}", count(found.steps, "step", "steps"), duration(found.microseconds)));
  return out;
}

Panel fold_curve_panel(const VariedPair& pair, const FoldCurve& found) {
  const FoldReport report{pair, found};
  Panel out{.title = report.scene().title + ": curve of folds",
            .x_label = title_of(pair.first()),
            .y_label = title_of(pair.second()),
            .tall = true};
  for (const FoldBranch& curve : found.curves) {
    out.curves.push_back({.name = "",
                          .x = each(curve.points, [&](const FoldPoint& point) { return report.first(point); }),
                          .y = each(curve.points, [&](const FoldPoint& point) { return report.second(point); }),
                          .colour = 0});
  }
  for (std::size_t c = 0; c < found.cusps.size(); ++c) {
    const FoldPoint& at = found.cusps[c].at;
    out.marks.push_back({.x = report.first(at), .y = report.second(at), .label = std::to_string(c + 1)});
  }
  return out;
}

}  // namespace poise::app

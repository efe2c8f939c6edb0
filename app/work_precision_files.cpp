#include "app/work_precision_files.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/csv_file.hpp"
#include "app/json_parts.hpp"
#include "app/quantity.hpp"

namespace poise::app {
namespace {

using comparison::Ending;
using comparison::KnownRest;
using comparison::ToleranceSpan;
using comparison::WorkPrecision;
using comparison::WorkPrecisionRow;
constexpr double least_drawn_error = 1e-17;

Json json_rest(const StaticModel& model, const KnownRest& rest) {
  Json out = {{"digits", rest.digits},     {"stability", to_string(rest.stability)},
              {"neutral", rest.neutral},   {"accuracy", json_number(rest.accuracy)},
              {"found_by", Json::array()}, {"coordinates", Json::array()}};
  for (const Method method : rest.found_by) out["found_by"].push_back(to_string(method));
  for (std::size_t i = 0; i < rest.x.size(); ++i) {
    const Coordinate& c = model.layout().coordinates[i];
    const bool angle = c.kind == Coordinate::Kind::angle;
    out["coordinates"].push_back({{"name", c.name},
                                  {"unit", angle ? "rad" : "m"},
                                  {"value", json_number(rest.x[i] * (angle ? 1.0 : model.scales().length))}});
  }
  return out;
}

Json json_row(const WorkPrecisionRow& row) {
  return {{"tolerance", row.tolerance},
          {"status", status_of(row)},
          {"claimed", row.claimed},
          {"confirmed", row.confirmed},
          {"rest", row.rest < 0 ? Json(nullptr) : Json(row.rest + 1)},
          {"error", json_number(row.error)},
          {"microseconds", json_number(row.microseconds)},
          {"repeats", row.repeats},
          {"iterations", row.iterations},
          {"evaluations", row.evaluations},
          {"why", row.why}};
}

}  // namespace

std::string work_precision_csv(const WorkPrecision& result) {
  std::vector<std::string> methods, statuses;
  std::vector<std::vector<double>> columns(9);
  for (const WorkPrecisionRow& row : result.rows) {
    methods.push_back(to_string(row.method));
    statuses.push_back(status_of(row));
    const double values[] = {row.tolerance,
                             row.microseconds,
                             or_gap(row.error),
                             static_cast<double>(row.iterations),
                             static_cast<double>(row.evaluations),
                             row.claimed ? 1.0 : 0.0,
                             row.confirmed ? 1.0 : 0.0,
                             static_cast<double>(row.repeats),
                             or_gap(row.rest < 0 ? std::nullopt : std::optional(row.rest + 1.0))};
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c].push_back(values[c]);
  }
  return csv_text({"method", "status", "tolerance", "microseconds", "error", "iterations", "evaluations", "claimed",
                   "confirmed", "repeats", "rest"},
                  columns, {methods, statuses});
}

std::string work_precision_json(const StaticModel& model, const WorkPrecision& result,
                                const std::vector<std::string>& settings) {
  Json out = {{"poise", POISE_VERSION},
              {"scene", json_scene(model.scene(), settings)},
              {"left_out", model.layout().dropped},
              {"rests", Json::array()},
              {"refused", Json::array()},
              {"methods", Json::array()}};
  for (const KnownRest& rest : result.rests) out["rests"].push_back(json_rest(model, rest));
  for (const comparison::Refusal& refusal : result.refused) {
    out["refused"].push_back({{"method", to_string(refusal.method)}, {"why", refusal.why}});
  }
  for (auto row = result.rows.begin(); row != result.rows.end();) {
    const Method method = row->method;
    Json runs = Json::array();
    for (; row != result.rows.end() && row->method == method; ++row) runs.push_back(json_row(*row));
    out["methods"].push_back({{"method", to_string(method)}, {"runs", runs}});
  }
  return json_text(out, model.scene());
}

std::vector<Panel> work_precision_panels(const StaticModel& model, const WorkPrecision& result) {
  const Scene& scene = model.scene();
  Panel panel{.title = scene.title.empty() ? scene.file : scene.title,
              .x_label = "error from the 50-digit reference (rad, or length over size): better to the right",
              .y_label = "median time (µs)",
              .log_x = true,
              .log_y = true,
              .x_falls = true,
              .tall = true};
  std::vector<std::string> absent;
  for (const std::vector<ToleranceSpan>& spans : tolerance_spans(result)) {
    const Method method = spans.front().loosest->method;
    Curve curve{.name = to_string(method), .style = Curve::Style::marked, .colour = static_cast<int>(method)};
    bool any = false;
    for (const ToleranceSpan& span : spans) {
      const bool arrived = span.loosest->ending == Ending::arrived;
      any = any || arrived;
      curve.x.push_back(arrived ? std::max(span.loosest->error.value(), least_drawn_error) : or_gap({}));
      curve.y.push_back(arrived ? span.microseconds : or_gap({}));
    }
    if (any)
      panel.curves.push_back(std::move(curve));
    else
      absent.push_back(to_string(method));
  }
  if (!absent.empty()) panel.title += ": " + listed(absent) + " never arrived";
  return {panel};
}

}  // namespace poise::app

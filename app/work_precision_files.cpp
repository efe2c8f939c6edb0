#include "app/work_precision_files.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "app/csv_file.hpp"
#include "app/json_parts.hpp"
#include "app/quantity.hpp"

namespace poise::app {
namespace {

using comparison::Ending;
using comparison::KnownRest;
using comparison::MeasuredRun;
using comparison::WorkPrecision;
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

Json json_run(const MeasuredRun& run) {
  return {{"tolerance", run.tolerance},
          {"status", status_of(run)},
          {"claimed", run.claimed},
          {"confirmed", run.confirmed},
          {"rest", run.rest < 0 ? Json(nullptr) : Json(run.rest + 1)},
          {"error", json_number(run.error)},
          {"microseconds", json_number(run.microseconds)},
          {"repeats", run.repeats},
          {"iterations", run.iterations},
          {"evaluations", run.evaluations},
          {"why", run.why}};
}

bool same_run(const MeasuredRun& a, const MeasuredRun& b) {
  const bool same_error = a.error == b.error || (std::isnan(a.error) && std::isnan(b.error));
  return same_error && a.rest == b.rest && a.iterations == b.iterations && a.evaluations == b.evaluations &&
         a.ending == b.ending && a.confirmed == b.confirmed;
}

SharedRun shared(const MeasuredRun* first, const MeasuredRun* end) {
  std::vector<double> times;
  for (const MeasuredRun* run = first; run != end; ++run) times.push_back(run->microseconds);
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return {first, end - 1, *middle};
}

}  // namespace

std::vector<std::vector<SharedRun>> shared_runs(const WorkPrecision& result) {
  std::vector<std::vector<SharedRun>> out;
  const MeasuredRun* const end = result.runs.data() + result.runs.size();
  for (const MeasuredRun* first = result.runs.data(); first != end;) {
    const MeasuredRun* next = first + 1;
    while (next != end && next->method == first->method && same_run(*first, *next)) ++next;
    if (out.empty() || out.back().front().loosest->method != first->method) out.emplace_back();
    out.back().push_back(shared(first, next));
    first = next;
  }
  return out;
}

std::string status_of(const MeasuredRun& run) {
  switch (run.ending) {
    case Ending::arrived:
      return run.confirmed ? "confirmed" : "claimed";
    case Ending::elsewhere:
      return "another place";
    case Ending::gave_up:
      break;
  }
  return "gave up";
}

std::string work_precision_csv(const WorkPrecision& result) {
  std::vector<std::string> methods, statuses;
  std::vector<std::vector<double>> columns(9);
  for (const MeasuredRun& run : result.runs) {
    methods.push_back(to_string(run.method));
    statuses.push_back(status_of(run));
    const double values[] = {run.tolerance,
                             run.microseconds,
                             run.error,
                             static_cast<double>(run.iterations),
                             static_cast<double>(run.evaluations),
                             run.claimed ? 1.0 : 0.0,
                             run.confirmed ? 1.0 : 0.0,
                             static_cast<double>(run.repeats),
                             run.rest < 0 ? std::numeric_limits<double>::quiet_NaN() : run.rest + 1.0};
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
  for (auto run = result.runs.begin(); run != result.runs.end();) {
    const Method method = run->method;
    Json runs = Json::array();
    for (; run != result.runs.end() && run->method == method; ++run) runs.push_back(json_run(*run));
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
  for (const std::vector<SharedRun>& runs : shared_runs(result)) {
    const Method method = runs.front().loosest->method;
    Curve curve{.name = to_string(method), .style = Curve::Style::marked, .colour = static_cast<int>(method)};
    bool any = false;
    for (const SharedRun& run : runs) {
      const bool arrived = run.loosest->ending == Ending::arrived;
      const double gap = std::numeric_limits<double>::quiet_NaN();
      any = any || arrived;
      curve.x.push_back(arrived ? std::max(run.loosest->error, least_drawn_error) : gap);
      curve.y.push_back(arrived ? run.microseconds : gap);
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

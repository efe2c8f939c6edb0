#include "app/results/identification/charts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "app/draw/chart/interval_chart.hpp"
#include "app/draw/frames.hpp"
#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "identification/assessment/residuals.hpp"
#include "identification/fit/autocorrelation.hpp"
#include "model/input_error.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/scaled_model.hpp"

namespace poise::app {
namespace {

constexpr std::size_t most_sensors_drawn = 6;
constexpr std::size_t most_runs_drawn = 4;
constexpr std::size_t most_parameters_drawn = 8;
// Of a page: records drawn, all sensors of all runs together, runs, and lags of autocorrelations.
constexpr std::size_t most_records_drawn = 12;
constexpr std::size_t most_runs_of_a_page = 8;
constexpr std::size_t most_lags = 40;

std::vector<double> shown(std::vector<double> si, const Sensor& sensor, const Units& units) {
  for (double& value : si) value /= sensor.dimension().unit(units);
  return si;
}

std::string axis(const std::string& what, const Sensor& sensor, const Units& units) {
  return fmt::format("{} ({})", what, sensor.dimension().unit_name(units));
}

/// What the readings of run r are drawn over.
std::string along(const FitProblem& problem, std::size_t r) { return problem.run(r).is_at_rest() ? "row" : "time (s)"; }

/// The runs whose residuals are drawn over one axis, the worst first: in motion or at rest, as the worst of all.
std::vector<std::size_t> worst_of_a_kind(const FitProblem& problem, const Fit& fitted) {
  const std::vector<std::size_t> worst = worst_first(fitted);
  return chosen_of(
      worst, [&](std::size_t r) { return problem.run(r).is_at_rest() == problem.run(worst.front()).is_at_rest(); });
}

/// The runs, of these, in which sensor k is read.
std::vector<std::size_t> reading(const std::vector<std::size_t>& runs, const Identification& answer, std::size_t k) {
  return chosen_of(runs, [&](std::size_t r) { return !answer.records[r].sensors[k].value.empty(); });
}

/// Which sensors of the worst run are drawn, those of one unit together: all, or those whose residuals are largest over
/// their noise.
std::vector<std::size_t> drawn_sensors(const FitProblem& problem, const Identification& answer) {
  const Fit& fitted = answer.fit;
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  const auto size = [&](std::size_t k) {
    const double over_noise = fitted.rms[k] / fitted.weighting.noise[k];
    return std::isnan(over_noise) ? 0.0 : over_noise;  // a sensor without readings
  };
  const std::vector<std::size_t> worst = {worst_first(fitted).front()};
  std::vector<std::size_t> order =
      chosen_of(places(sensors.size()), [&](std::size_t k) { return !reading(worst, answer, k).empty(); });
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
  if (order.size() > most_sensors_drawn) order.resize(most_sensors_drawn);
  std::sort(order.begin(), order.end());
  const auto unit = [&](std::size_t k) { return sensors[k].dimension().unit_name(problem.experiment().scene.units); };
  const auto first_of_unit = [&](std::size_t k) {
    return std::find_if(order.begin(), order.end(), [&](std::size_t other) { return unit(other) == unit(k); });
  };
  const std::vector<std::size_t> before = order;
  std::vector<std::size_t> out;
  for (const std::size_t k : before) {
    if (*first_of_unit(k) != k) continue;
    std::copy_if(before.begin(), before.end(), std::back_inserter(out),
                 [&](std::size_t other) { return unit(other) == unit(k); });
  }
  return out;
}

/// Which parameters of a run are drawn, as places among its unknowns: all, or those with the largest relative standard
/// errors.
std::vector<std::size_t> drawn_parameters(const FitProblem& problem, const Fit& fitted, std::size_t r) {
  const std::vector<int>& all = problem.parameters_of(r);
  const auto error = [&](std::size_t c) {
    const Estimate& estimate = fitted.estimates[static_cast<std::size_t>(all[c])];
    const double relative = std::abs(estimate.standard_error / estimate.value);
    return std::isfinite(relative) ? relative : INFINITY;
  };
  std::vector<std::size_t> order = places(all.size());
  if (order.size() <= most_parameters_drawn) return order;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return error(a) > error(b); });
  order.resize(most_parameters_drawn);
  std::sort(order.begin(), order.end());
  return order;
}

/// "6 of 15 sensors, those with the largest residuals; not drawn: a, b"; empty where all are drawn.
std::string left_out(std::size_t drawn, const std::vector<std::string>& others, const std::string& what,
                     const std::string& chosen) {
  if (others.empty()) return "";
  return fmt::format("{} of {} {}, {}; not drawn: {}", drawn, drawn + others.size(), what, chosen,
                     fmt::join(others, ", "));
}

/// The runs of a fit with their residuals, each computed once.
class FittedRuns {
 public:
  FittedRuns(const FitProblem& problem, const Identification& answer) : problem_(problem), answer_(answer) {}

  const RunResiduals& of(std::size_t r) {
    const auto known = found_.find(r);
    if (known != found_.end()) return known->second;
    return found_.emplace(r, residuals_of(problem_, answer_.fit, answer_.records, r)).first->second;
  }

 private:
  const FitProblem& problem_;
  const Identification& answer_;
  std::map<std::size_t, RunResiduals> found_;
};

Panel fitted_panel(const FitProblem& problem, const Identification& answer, FittedRuns& runs, std::size_t r,
                   std::size_t k) {
  const Sensor& sensor = problem.experiment().sensors[k];
  const Units& units = problem.experiment().scene.units;
  const Series& read = answer.records[r].sensors[k];
  std::vector<double> predicted = runs.of(r).prediction[k];
  Panel panel{.title = fmt::format("{}: {}, the worst run", sensor.name, problem.run(r).run().name),
              .y_label = axis("reading", sensor, units)};
  panel.curves = {
      {.name = "read", .x = read.time, .y = shown(read.value, sensor, units), .style = Curve::Style::points},
      {.name = "fitted", .x = read.time, .y = shown(std::move(predicted), sensor, units)}};
  return panel;
}

Panel residual_panel(const FitProblem& problem, const Identification& answer, FittedRuns& runs,
                     const std::vector<std::size_t>& worst, std::size_t k) {
  const Sensor& sensor = problem.experiment().sensors[k];
  const Units& units = problem.experiment().scene.units;
  Panel panel{.title = fmt::format("{}: residuals of the {}", sensor.name, worst.size() > 1 ? "worst runs" : "run"),
              .y_label = axis("read - fitted", sensor, units)};
  for (std::size_t i = 0; i < std::min(most_runs_drawn, worst.size()); ++i) {
    panel.curves.push_back({.name = problem.run(worst[i]).run().name,
                            .x = answer.records[worst[i]].sensors[k].time,
                            .y = shown(runs.of(worst[i]).residual[k], sensor, units),
                            .style = answer.fit.runs[worst[i]].is_white() ? Curve::Style::points : Curve::Style::line});
  }
  const double two = 2 * answer.fit.weighting.noise[k] / sensor.dimension().unit(units);
  panel.bands = {{.low = -two, .high = two, .name = "2 sigma of the noise"}};
  return panel;
}

/// Each curve of FitProblem::sensitivities() over the largest value of its parameter in any sensor drawn, which its
/// name gives: parameters whose curves are alike in all of them cannot be identified separately.
std::vector<Panel> sensitivity_panels(const FitProblem& problem, const Identification& answer, std::size_t r,
                                      const std::vector<std::size_t>& sensors) {
  const auto curves = problem.sensitivities(r, answer.fit.parameters, answer.fit.runs[r].nuisances);
  const std::vector<std::size_t> parameters = drawn_parameters(problem, answer.fit, r);
  std::vector<Panel> panels;
  for (const std::size_t k : sensors) {
    panels.push_back({.title = fmt::format("{}: relative sensitivities", problem.experiment().sensors[k].name),
                      .y_label = "sensitivity over its largest"});
    for (std::size_t i = 0; i < parameters.size() && !curves.empty(); ++i) {
      const std::size_t c = parameters[i];
      const auto p = static_cast<std::size_t>(problem.parameters_of(r)[c]);
      double largest = 0.0;
      for (const std::size_t any : sensors) largest = std::max(largest, largest_size(curves[any][c]));
      Curve curve{.name = fmt::format("{}, up to {} σ", problem.parameters()[p].name, significant(largest, 2)),
                  .x = answer.records[r].sensors[k].time,
                  .y = curves[k][c],
                  .colour = static_cast<int>(i)};
      for (double& y : curve.y) y = largest > 0 ? y / largest : 0.0;
      panels.back().curves.push_back(std::move(curve));
    }
  }
  return panels;
}

/// Readings as fitted and residuals of one run, sensor by sensor.
Figure run_figure(const FitProblem& problem, const Identification& answer, FittedRuns& runs, std::size_t r,
                  const std::vector<std::size_t>& sensors) {
  Figure figure{.title = fmt::format("Run \"{}\"", problem.run(r).run().name), .charts = {.columns = 2}};
  for (const std::size_t k : sensors) {
    if (answer.records[r].sensors[k].value.empty()) continue;
    Panel fitted = fitted_panel(problem, answer, runs, r, k), residuals = residual_panel(problem, answer, runs, {r}, k);
    fitted.title = problem.experiment().sensors[k].name;
    residuals.title = fitted.title + ": residuals";
    residuals.curves.front().name.clear();
    figure.charts.panels.push_back(std::move(fitted));
    figure.charts.panels.push_back(std::move(residuals));
  }
  for (std::size_t i = figure.charts.panels.size(); i > 0 && i + 2 > figure.charts.panels.size(); --i) {
    figure.charts.panels[i - 1].x_label = along(problem, r);
  }
  return figure;
}

/// Where a measure is read on the mechanism, m in the world.
Vec2 place_read(const Scene& scene, const Measure& on, const Poses& poses) {
  const auto world = [&](PointRef at) { return poses[static_cast<std::size_t>(at.body)].world(scene.local(at)); };
  switch (on.kind) {
    case Measure::Kind::angle:
      return poses[static_cast<std::size_t>(on.body_b)].origin;
    case Measure::Kind::travel:
      return world(scene.joints[static_cast<std::size_t>(on.joint)].a);
    case Measure::Kind::x:
    case Measure::Kind::y:
    case Measure::Kind::clearance:
    case Measure::Kind::along_outline:
    case Measure::Kind::slip_on_cam:
      return world(on.b);
    case Measure::Kind::rope:
      return poses[static_cast<std::size_t>(on.contacts.front().at.body)].origin;
    case Measure::Kind::sum:
      return place_read(scene, on.terms.front().measure, poses);
    case Measure::Kind::distance:
    case Measure::Kind::component:
      break;
  }
  return 0.5 * (world(on.a) + world(on.b));
}

/// The mechanism as run r begins, with its sensors where they are read. Without frames where it cannot be assembled.
Drawing drawing_with_sensors(const FitProblem& problem, std::size_t r) {
  const Scene& scene = problem.run(r).scene();
  const ScaledModel model(scene, Purpose::dynamics);
  std::vector<double> x;
  try {
    x = close_loops(model);
  } catch (const InputError&) {
    return {};
  }
  Position position{.scene = &scene, .picture = {.poses = model.poses(x)}};
  auto& crosses = position.picture.crosses;
  for (const Sensor& sensor : problem.experiment().sensors) {
    if (sensor.quantity) continue;  // which may be anywhere
    const Vec2 at = place_read(scene, sensor.on, position.picture.poses);
    const auto there = std::find_if(crosses.begin(), crosses.end(), [&](const auto& one) {
      return norm(one.first - at) < 1e-6 * problem.run(r).size();
    });
    if (there == crosses.end())
      crosses.emplace_back(at, "sensor " + sensor.name);
    else
      there->second += ", " + sensor.name;
  }
  return draw_frames({position}, "The mechanism with its sensors");
}

/// Of a sensor in these runs, by lag; with the band in which 95 % of those of white noise would be.
Panel autocorrelation_panel(const FitProblem& problem, const Identification& answer, FittedRuns& runs,
                            const std::vector<std::size_t>& drawn, std::size_t k) {
  Panel panel{.title = problem.experiment().sensors[k].name, .x_label = "lag (readings)", .y_label = "autocorrelation"};
  std::size_t fewest = 0;
  for (const std::size_t r : reading(drawn, answer, k)) {
    const std::vector<double>& time = answer.records[r].sensors[k].time;
    Curve curve{.name = problem.run(r).run().name, .style = Curve::Style::marked};
    for (std::size_t lag = 1; lag <= std::min(most_lags, time.size() / 4); ++lag) {
      curve.x.push_back(static_cast<double>(lag));
      curve.y.push_back(autocorrelation(time, runs.of(r).residual[k], lag).value);
    }
    fewest = fewest == 0 ? time.size() : std::min(fewest, time.size());
    panel.curves.push_back(std::move(curve));
  }
  const double within = 1.96 / std::sqrt(static_cast<double>(std::max<std::size_t>(1, fewest)));
  panel.bands = {{.low = -within, .high = within, .name = "95 % of white noise"}};
  return panel;
}

}  // namespace

int fit_columns(const Experiment& experiment) { return experiment.sensors.size() > 1 ? 3 : 1; }

std::vector<std::string> not_drawn(const FitProblem& problem, const Identification& answer) {
  if (answer.fit.runs.empty()) return {};
  const std::vector<std::size_t> sensors = drawn_sensors(problem, answer);
  std::vector<std::string> others;
  for (std::size_t k = 0; k < problem.experiment().sensors.size(); ++k) {
    if (std::find(sensors.begin(), sensors.end(), k) != sensors.end()) continue;
    others.push_back(problem.experiment().sensors[k].name);
  }
  const std::size_t r = worst_first(answer.fit).front();
  const std::vector<std::size_t> parameters = drawn_parameters(problem, answer.fit, r);
  std::vector<std::string> other_parameters;
  for (std::size_t c = 0; c < problem.parameters_of(r).size(); ++c) {
    if (std::find(parameters.begin(), parameters.end(), c) != parameters.end()) continue;
    other_parameters.push_back(problem.parameters()[static_cast<std::size_t>(problem.parameters_of(r)[c])].name);
  }
  std::vector<std::string> lines = {
      left_out(sensors.size(), others, "sensors", "those with the largest residuals over their noise"),
      left_out(parameters.size(), other_parameters, "sensitivities",
               "those of the parameters with the largest relative standard errors")};
  std::erase(lines, "");
  return lines;
}

std::vector<Panel> fit_panels(const FitProblem& problem, const Identification& answer) {
  if (answer.fit.runs.empty()) return {};
  const std::vector<std::size_t> worst = worst_of_a_kind(problem, answer.fit);
  const std::vector<std::size_t> sensors = drawn_sensors(problem, answer);
  std::vector<Panel> sensitivities = sensitivity_panels(problem, answer, worst.front(), sensors);
  FittedRuns runs(problem, answer);
  std::vector<Panel> panels;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    panels.push_back(fitted_panel(problem, answer, runs, worst.front(), sensors[i]));
    panels.push_back(residual_panel(problem, answer, runs, reading(worst, answer, sensors[i]), sensors[i]));
    panels.push_back(std::move(sensitivities[i]));
  }
  // One legend and one time axis for each column.
  const std::size_t last = panels.size() - 3;
  for (std::size_t i = 0; i < last; ++i) {
    for (Curve& curve : panels[i].curves) curve.name.clear();
    for (Band& band : panels[i].bands) band.name.clear();
  }
  for (std::size_t i = fit_columns(problem.experiment()) > 1 ? last : last + 2; i < panels.size(); ++i)
    panels[i].x_label = along(problem, worst.front());
  const std::size_t others = problem.experiment().sensors.size() - sensors.size();
  if (others > 0) panels[last].curves.push_back({.name = fmt::format("{} more not drawn, see the report", others)});
  return panels;
}

std::vector<Figure> fit_figures(const FitProblem& problem, const Identification& answer) {
  if (answer.fit.runs.empty()) return {};
  std::vector<std::size_t> worst = worst_first(answer.fit);
  const std::vector<std::size_t> sensors = drawn_sensors(problem, answer);
  if (sensors.empty()) return {};
  FittedRuns runs(problem, answer);
  worst.resize(
      std::min({worst.size(), most_runs_of_a_page, std::max<std::size_t>(1, most_records_drawn / sensors.size())}));
  std::vector<Figure> figures;
  for (const std::size_t r : worst) {
    Figure figure = run_figure(problem, answer, runs, r, sensors);
    if (r == worst.front()) {
      figure.drawing = drawing_with_sensors(problem, r);
      if (!figure.drawing.frames.empty()) figure.charts.columns = 1;
    }
    if (!figure.charts.panels.empty()) figures.push_back(std::move(figure));
  }
  const std::size_t others = answer.fit.runs.size() - worst.size();
  if (others > 0)
    figures.back().title +=
        fmt::format("; {} with smaller residuals are not drawn", count(static_cast<int>(others), "run", "runs"));
  Figure correlated{.title = "Autocorrelation of the residuals", .charts = {.columns = sensors.size() > 1 ? 2 : 1}};
  for (const std::size_t k : sensors) {
    correlated.charts.panels.push_back(autocorrelation_panel(problem, answer, runs, worst, k));
  }
  figures.push_back(std::move(correlated));
  Figure sensitive{.title = fmt::format("What the readings of run \"{}\" tell of each parameter",
                                        problem.run(worst.front()).run().name)};
  sensitive.charts.panels = sensitivity_panels(problem, answer, worst.front(), sensors);
  sensitive.charts.panels.back().x_label = along(problem, worst.front());
  figures.push_back(std::move(sensitive));
  return figures;
}

std::vector<Figure> estimate_figures(const FitProblem& problem, const Fit& fitted) {
  if (!fitted.usable() || !fitted.identifiability.ok) return {};
  const bool simulated = problem.experiment().is_simulated();
  std::vector<Interval> intervals;
  bool any = false;
  for (const Estimate& e : fitted.estimates) {
    const double error = e.withheld || e.standard_error == 0.0 ? NAN : e.standard_error;
    if (simulated) {
      intervals.push_back({e.name, (e.low - e.truth) / error, (e.value - e.truth) / error, (e.high - e.truth) / error});
    } else {
      const double half = 100.0 * (e.high - e.low) / (2.0 * std::abs(e.value)) * (error / error);
      intervals.push_back({fmt::format("{}, ±{} %", e.name, significant(half, 2)), half, half, half});
    }
    any = any || std::isfinite(intervals.back().value);
  }
  if (!any) return {};
  Panel panel{.title = simulated ? "95 % intervals of the estimates about their truths"
                                 : "Half of the 95 % intervals, in per cent of the estimates",
              .x_label = "parameter, by its number",
              .y_label = simulated ? "estimate less truth, in its standard errors" : "per cent of the estimate",
              .log_y = !simulated,
              .curves = interval_curves(intervals)};
  if (simulated) panel.levels = {{0.0, "truth"}};
  return {{.title = "Estimates", .charts = {.panels = {std::move(panel)}}}};
}

}  // namespace poise::app

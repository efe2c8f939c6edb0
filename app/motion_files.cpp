#include "app/motion_files.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "app/csv_file.hpp"
#include "app/json_parts.hpp"
#include "app/report/parts.hpp"

namespace poise::app {
namespace {

constexpr std::size_t most_curves = 12;

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
struct Moving {
  std::size_t channel = 0;  // the first of them
  std::string names;
  Extent extent;
};

std::vector<Moving> moving(const MotionRecord& record, Quantity quantity) {
  std::vector<Moving> out;
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    const Channel& channel = record.channels[c];
    if (channel.quantity != quantity) continue;
    const auto same = std::find_if(out.begin(), out.end(), [&](const Moving& m) {
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
  std::vector<Moving> chosen = moving(record, quantity);
  if (chosen.empty()) return {};
  Extent all = chosen.front().extent;
  double widest = 0.0;
  for (const Moving& m : chosen) {
    all = {std::min(all.low, m.extent.low), std::max(all.high, m.extent.high)};
    widest = std::max(widest, m.extent.size());
  }
  Panel panel{.title = noun + "s", .y_label = with_unit(noun, quantity, units)};
  if (chosen.size() > most_curves) {
    panel.title = fmt::format("the {} of {} {}s that change most", most_curves, chosen.size(), noun);
    std::stable_sort(chosen.begin(), chosen.end(),
                     [&](const Moving& a, const Moving& b) { return a.extent.size() > b.extent.size(); });
    chosen.resize(most_curves);
  }
  constexpr double little = 0.15;
  const bool from_start = widest < little * all.size();
  if (from_start) panel.title += ", from where they start";
  for (const Moving& m : chosen) {
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
  Panel panel{.title = "energies, the potential from its start",
              .y_label = with_unit("energy", Quantity::energy, units)};
  panel.curves = {{.name = "kinetic", .x = record.time, .y = std::move(kinetic)},
                  {.name = "potential", .x = record.time, .y = std::move(potential)},
                  {.name = "sum", .x = record.time, .y = std::move(sum), .style = Curve::Style::dashed}};
  return panel;
}

Json moved(const MotionModel& model, const MotionAnswer& answer, Quantity quantity) {
  const Trajectory& path = answer.found.motion.trajectory;
  const Units& units = model.scene().units;
  Json out = Json::object();
  if (path.nodes() == 0) return out;
  const std::size_t last = (path.nodes() - 1) * static_cast<std::size_t>(path.coordinates);
  for (const Channel& channel : answer.record.channels) {
    if (channel.quantity != quantity) continue;
    const auto i = static_cast<std::size_t>(channel.coordinate);
    const auto shown = [&](double si) { return json_number(in_unit(si, quantity, units)); };
    out[channel.name] = {{"start", shown(path.q[i] + channel.offset)},
                         {"end", shown(path.q[last + i] + channel.offset)},
                         {"rate_start", shown(path.v[i])},
                         {"rate_end", shown(path.v[last + i])}};
  }
  return out;
}

}  // namespace

std::string motion_csv(const MotionModel& model, const MotionRecord& record) {
  const Units& units = model.scene().units;
  std::vector<std::string> header = {"time"};
  std::vector<std::vector<double>> columns = {record.time};
  for (const bool rates : {false, true}) {
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
      const Channel& channel = record.channels[c];
      header.push_back(channel.name + (rates ? ".rate" : ""));
      columns.push_back(in_unit(rates ? record.rate[c] : record.value[c], channel.quantity, units));
    }
  }
  header.insert(header.end(), {"energy.kinetic", "energy.potential"});
  columns.push_back(in_unit(record.kinetic, Quantity::energy, units));
  columns.push_back(in_unit(record.potential, Quantity::energy, units));
  return csv_text(header, columns);
}

std::vector<Panel> motion_panels(const MotionModel& model, const MotionRecord& record) {
  const Scene& scene = model.scene();
  std::vector<Panel> panels;
  for (const Quantity quantity : {Quantity::angle, Quantity::length}) {
    Panel panel = panel_of(record, quantity, scene.units);
    if (!panel.curves.empty()) panels.push_back(std::move(panel));
  }
  panels.push_back(energy_panel(record, scene.units));
  const std::string title = one_line(scene.title.empty() ? scene.file : scene.title);
  panels.front().title = title + ": " + panels.front().title;
  for (std::size_t i = 1; i < panels.size(); ++i) {
    char& first = panels[i].title.front();
    first = static_cast<char>(std::toupper(static_cast<unsigned char>(first)));
  }
  panels.back().x_label = "time (s)";
  return panels;
}

LargestForce largest_force(const Motion& motion, std::size_t drive) {
  LargestForce largest;
  const std::vector<double>& force = motion.drive_force[drive];
  for (std::size_t node = 0; node < force.size(); ++node) {
    if (std::abs(force[node]) > std::abs(largest.value)) largest = {force[node], motion.trajectory.t[node]};
  }
  return largest;
}

std::string motion_json(const MotionModel& model, const MotionAnswer& answer,
                        const std::vector<std::string>& settings) {
  const Scene& scene = model.scene();
  const Motion& motion = answer.found.motion;
  Json out = {{"poise", POISE_VERSION}, {"scene", json_scene(scene, settings)}, {"units", json_units(scene.units)}};
  out["status"] = to_string(motion.status);
  out["why"] = motion.why;
  out["confirmed"] = answer.found.confirmed();
  out["start"] = answer.start;
  out["duration"] = answer.duration;
  out["reached"] = motion.trajectory.t.empty() ? 0.0 : motion.trajectory.t.back();
  out["accuracy"] = answer.accuracy;
  out["error"] = answer.found.error ? json_number(*answer.found.error) : Json(nullptr);
  out["energy_error"] = json_number(motion.energy_error);
  out["freedoms"] = motion.freedoms;
  out["steps"] = motion.steps;
  out["rejected"] = motion.rejected;
  out["evaluations"] = motion.evaluations;
  out["microseconds"] = json_number(motion.microseconds);
  const auto energies = [&](std::size_t node) -> Json {
    const auto shown = [&](double si) { return json_number(in_unit(si, Quantity::energy, scene.units)); };
    return {{"kinetic", shown(motion.kinetic[node])},
            {"potential", shown(motion.potential[node])},
            {"work", shown(motion.work[node])}};
  };
  out["energies"] = motion.kinetic.empty() ? Json(nullptr)
                                           : Json{{"start", energies(0)}, {"end", energies(motion.kinetic.size() - 1)}};
  out["angles"] = moved(model, answer, Quantity::angle);
  out["slides"] = moved(model, answer, Quantity::length);
  out["drives"] = Json::array();
  for (std::size_t d = 0; d < motion.drive_force.size(); ++d) {
    const Quantity quantity = effort_of(scene.drives[d].on);
    const LargestForce largest = largest_force(motion, d);
    out["drives"].push_back({{"name", scene.drives[d].name},
                             {"largest", json_number(in_unit(largest.value, quantity, scene.units))},
                             {"at", json_number(largest.at)}});
  }
  out["singular"] = motion.singular;
  out["overrun"] = motion.overrun;
  return json_text(out, scene);
}

}  // namespace poise::app

#include "app/results/statics/beside.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "statics/paths/path_words.hpp"

namespace poise::app {
namespace {

constexpr int digits_beside = 8;
constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// A quantity that all scenes show, in the units of the scenes.
struct Compared {
  std::string name, unit;
  std::vector<std::vector<std::vector<double>>> values;  ///< by scene, value asked for and equilibrium

  double of(std::size_t scene, std::size_t at, std::size_t equilibrium) const {
    const std::vector<double>& found = values[scene][at];
    return equilibrium < found.size() ? found[equilibrium] : no_value;
  }
};

template <class Read>
Compared compared(std::string name, std::string unit, const std::vector<SceneBeside>& scenes, std::size_t places,
                  Read read) {
  Compared out{std::move(name), std::move(unit), {}};
  for (const SceneBeside& scene : scenes) {
    PathReader reader(scene.varied);
    std::vector<std::vector<double>>& of_scene = out.values.emplace_back(places);
    for (std::size_t k = 0; k < std::min(places, scene.found.wanted.size()); ++k) {
      for (const PathPoint& point : scene.found.wanted[k]) of_scene[k].push_back(read(scene, reader, point));
    }
  }
  return out;
}

double effort_beside(const SceneBeside& scene, const PathPoint& point) {
  return point.effort / scene.varied.effort_dimension().unit(scene.varied.scene().units);
}

double measure_beside(const SceneBeside& scene, PathReader& reader, std::size_t k, const PathPoint& point) {
  const SoughtQuantity& measure = scene.measures[k];
  return reader.value(measure, point) / measure.dimension.unit(scene.varied.scene().units);
}

std::vector<Compared> all_compared(const std::vector<SceneBeside>& scenes, std::size_t places) {
  const SceneBeside& first = scenes.front();
  const Units& units = first.varied.scene().units;
  std::vector<Compared> out;
  if (first.varied.is_driven()) {
    out.push_back(compared(
        effort_name(first.varied), first.varied.effort_dimension().unit_name(units), scenes, places,
        [](const SceneBeside& scene, PathReader&, const PathPoint& point) { return effort_beside(scene, point); }));
  }
  for (std::size_t k = 0; k < first.measures.size(); ++k) {
    out.push_back(compared(first.measures[k].name, first.measures[k].dimension.unit_name(units), scenes, places,
                           [k](const SceneBeside& scene, PathReader& reader, const PathPoint& point) {
                             return measure_beside(scene, reader, k, point);
                           }));
  }
  return out;
}

/// The rows of a table of values: a value asked for, and one of its equilibria.
struct PlaceBeside {
  std::size_t at, equilibrium;
};

std::vector<PlaceBeside> places_beside(const std::vector<SceneBeside>& scenes, std::size_t values) {
  std::vector<PlaceBeside> out;
  for (std::size_t k = 0; k < values; ++k) {
    std::size_t most = 1;
    for (const SceneBeside& scene : scenes) {
      if (k < scene.found.wanted.size()) most = std::max(most, scene.found.wanted[k].size());
    }
    for (std::size_t e = 0; e < most; ++e) out.push_back({k, e});
  }
  return out;
}

int points_followed(const Path& found) {
  int out = 0;
  for (const PathBranch& branch : found.branches) out += static_cast<int>(branch.points.size());
  return out;
}

/// The value of the varied number at the first fold; not a number without one.
double first_fold(const SceneBeside& scene) {
  for (const PathEvent& event : scene.found.events) {
    if (event.kind == PathEvent::Kind::fold) return event.at.parameter / scene.varied.unit();
  }
  return no_value;
}

void add_scenes_beside(Group& content, const std::vector<SceneBeside>& scenes) {
  Table& table = content.table("scenes", "Scenes", Rows::list);
  table.words("label", "scene", each(scenes, &SceneBeside::label));
  table.words("file", "file", each(scenes, [](const SceneBeside& one) { return one.varied.scene().file; }));
  table.words("set", "set", each(scenes, [](const SceneBeside& one) {
                return one.settings.empty() ? std::string("-") : fmt::format("{}", fmt::join(one.settings, ", "));
              }));
  table.counts("points", "points", each(scenes, [](const SceneBeside& one) { return points_followed(one.found); }));
  table.counts("unproved", "not proved", each(scenes, [](const SceneBeside& one) { return one.found.unproved(); }));
  table.words("status", "status", each(scenes, [](const SceneBeside& one) { return to_string(one.found.status); }));
  table.numbers("first_fold", "first fold at", scenes.front().varied.unit_name(), each(scenes, first_fold),
                {.style = Format::Style::significant, .digits = digits_beside});
}

void add_values_beside(Group& content, const std::vector<SceneBeside>& scenes, const std::vector<double>& at) {
  const VariedScene& varied = scenes.front().varied;
  const std::vector<PlaceBeside> rows = places_beside(scenes, at.size());
  const std::vector<double> parameters = each(rows, [&](const PlaceBeside& row) { return at[row.at] / varied.unit(); });
  Branch& quantities = content.array("quantities");
  for (const Compared& one : all_compared(scenes, at.size())) {
    Table& table = content.table("", one.name + (one.unit.empty() ? "" : " (" + one.unit + ")"), Rows::list);
    const Format format{.style = Format::Style::significant, .digits = digits_beside};
    table.numbers("", varied.name(), varied.unit_name(), parameters, format);
    Group& data = quantities.parts.emplace_back();
    data.data("name", one.name);
    data.data("unit", one.unit);
    Branch& values = data.array("values");
    const auto value = [&](std::size_t scene) {
      return each(rows, [&](const PlaceBeside& row) { return one.of(scene, row.at, row.equilibrium); });
    };
    const std::vector<double> reference = value(0);
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      const std::vector<double> own = value(s);
      std::vector<double> difference = own;
      for (std::size_t k = 0; k < own.size(); ++k) difference[k] -= reference[k];
      table.numbers("", scenes[s].label, "", own, format);
      if (s > 0) {
        Format of_difference = format;
        for (const double size : reference) {
          if (std::isfinite(size))
            of_difference.zero_below = std::max(of_difference.zero_below, 1e-12 * std::abs(size));
        }
        table.numbers("", scenes[s].label + " - " + scenes[0].label, "", difference, of_difference);
      }
      for (std::size_t k = 0; k < rows.size(); ++k) {
        Group& row = values.parts.emplace_back();
        row.data("scene", scenes[s].label);
        row.data("parameter", parameters[k]);
        row.data("equilibrium", rows[k].equilibrium + 1);
        row.data("value", std::isfinite(own[k]) ? Value(own[k]) : Value());
        row.data("difference", std::isfinite(difference[k]) ? Value(difference[k]) : Value());
      }
    }
  }
}

/// One line for each point of each scene.
void add_points_beside(Group& content, const std::vector<SceneBeside>& scenes) {
  std::vector<std::string> labels, stability, proof;
  std::vector<double> branches, parameters, efforts;
  std::vector<std::vector<double>> measures(scenes.front().measures.size());
  for (const SceneBeside& scene : scenes) {
    PathReader reader(scene.varied);
    for (std::size_t b = 0; b < scene.found.branches.size(); ++b) {
      for (const PathPoint& point : scene.found.branches[b].points) {
        labels.push_back(scene.label);
        branches.push_back(static_cast<double>(b + 1));
        parameters.push_back(point.parameter / scene.varied.unit());
        efforts.push_back(scene.varied.is_driven() ? effort_beside(scene, point) : no_value);
        stability.push_back(to_string(point.stability));
        proof.push_back(to_string(point.proof));
        for (std::size_t k = 0; k < measures.size(); ++k)
          measures[k].push_back(measure_beside(scene, reader, k, point));
      }
    }
  }
  Table& table = content.table("", "", Rows::list, Verbosity::data);
  table.csv = true;
  table.words("scene", "", std::move(labels));
  table.data("branch", std::move(branches));
  const VariedScene& varied = scenes.front().varied;
  const Units& units = varied.scene().units;
  table.data("parameter", std::move(parameters)).unit = varied.unit_name();
  if (varied.is_driven()) {
    table.data("effort", std::move(efforts)).unit = varied.effort_dimension().unit_name(units);
  }
  table.words("stability", "", std::move(stability));
  table.words("proof", "", std::move(proof));
  for (std::size_t k = 0; k < measures.size(); ++k) {
    const SoughtQuantity& measure = scenes.front().measures[k];
    table.data(measure.name, std::move(measures[k])).unit = measure.dimension.unit_name(units);
  }
}

Line verdict_beside(const std::vector<SceneBeside>& scenes) {
  const VariedScene& varied = scenes.front().varied;
  const std::string unit = varied.unit_name().empty() ? "" : " " + varied.unit_name();
  const std::string range =
      fmt::format("over {} = {} to {}{}", varied.name(), significant(varied.from() / varied.unit(), digits_beside),
                  significant(varied.to() / varied.unit(), digits_beside), unit);
  const auto failed = chosen_of(scenes, [](const SceneBeside& one) { return !one.is_proved(); });
  if (failed.empty()) {
    int points = 0, critical = 0;
    for (const SceneBeside& one : scenes) {
      points += points_followed(one.found);
      for (const PathBranch& branch : one.found.branches) {
        critical += static_cast<int>(std::count_if(branch.points.begin(), branch.points.end(), [](const PathPoint& at) {
          return at.proof == PointProof::critical;
        }));
      }
    }
    const std::string proved = critical == 0
                                   ? fmt::format("all {} are proved", count(points, "point", "points"))
                                   : fmt::format("{} of {} points are proved, the {} critical", points - critical,
                                                 points, critical == 1 ? "other is" : "others are");
    return good(fmt::format("Equilibria of {} scenes followed {}: {}; other curves of equilibria may exist.",
                            scenes.size(), range, proved));
  }
  const SceneBeside& first = failed.front();
  const std::string why = !first.found.why.empty() ? first.found.why
                          : first.found.status == Path::Status::traced
                              ? count(first.found.unproved(), "point", "points") + " not proved"
                              : to_string(first.found.status);
  return bad(fmt::format("Equilibria of {} scenes not all followed {}: {}: {}", scenes.size(), range, first.label,
                         sentence_of(why)));
}

}  // namespace

Result beside_result(const std::vector<SceneBeside>& scenes, const std::vector<double>& at) {
  const VariedScene& varied = scenes.front().varied;
  Result out = scene_result(varied.scene(), scenes.front().settings);
  out.verdict = verdict_beside(scenes);
  Group& content = out.content;
  Group& parameter = content.group("parameter", "", Verbosity::data);
  parameter.data("name", varied.name());
  parameter.data("from", varied.from() / varied.unit());
  parameter.data("to", varied.to() / varied.unit());
  parameter.data("unit", varied.unit_name());
  parameter.data("driven", varied.is_driven() ? Value(varied.driven_words()) : Value());
  if (varied.is_driven()) content.fact("driven", fmt::format("{}: {}", varied.name(), varied.driven_words()));
  add_scenes_beside(content, scenes);
  add_values_beside(content, scenes, at);
  add_points_beside(content, scenes);
  return out;
}

}  // namespace poise::app

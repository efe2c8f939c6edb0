#include "app/results/identification/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

// With more parameters than this, a table of correlations is too large to read; the largest are listed.
constexpr std::size_t most_in_table = 12;
constexpr double close = 0.9;

std::vector<std::size_t> identifiable_ones(const Identifiability& known) {
  return chosen_of(places(known.identifiable.size()), [&](std::size_t i) -> bool { return known.identifiable[i]; });
}

std::vector<std::string> close_pairs(const FitProblem& problem, const Identifiability& known,
                                     const std::vector<std::size_t>& identifiable) {
  std::vector<std::string> out;
  for (const std::size_t i : identifiable) {
    for (const std::size_t j : identifiable) {
      if (j >= i) continue;
      const double r = known.correlation[i][j].value();
      if (!(std::abs(r) > close)) continue;
      out.push_back(fmt::format("{:+.3f}  {}, {}", r, problem.parameters()[j].name, problem.parameters()[i].name));
    }
  }
  if (out.empty()) out.push_back(fmt::format("none beyond {}", close));
  return out;
}

double unit_of(const FitProblem& problem, const Identifiability::Combination& combination) {
  const double unit = problem.unknown_of(static_cast<std::size_t>(combination.unit_of)).unit;
  return combination.over < 0 ? unit : unit / problem.unknown_of(static_cast<std::size_t>(combination.over)).unit;
}

std::string runs_in_words(const Experiment& experiment) {
  const auto measured =
      std::count_if(experiment.runs.begin(), experiment.runs.end(), [](const Run& run) { return !run.is_simulated(); });
  const int runs = static_cast<int>(experiment.runs.size());
  if (measured > 0 && measured < runs) return fmt::format("{} runs, {} of them measured", runs, measured);
  const std::string kind = measured == 0 ? "simulated " : "measured ";
  return count(runs, kind + "run", kind + "runs");
}

std::string nuisances_in_words(const FitProblem& problem) {
  bool equilibria = false;
  bool starts = false;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    equilibria = equilibria || problem.run(r).equilibrium_is_unknown();
    starts = starts || problem.run(r).start_is_unknown();
  }
  if (!equilibria && !starts) return "";
  return fmt::format(", {} ({} of each run)", count(problem.nuisances(), "nuisance", "nuisances"),
                     equilibria && starts ? "equilibrium and start"
                     : equilibria         ? "equilibrium"
                                          : "start");
}

/// The sum of a count over the runs.
std::size_t sum_of(const FitProblem& problem, std::size_t (RunModel::*count)() const) {
  std::size_t sum = 0;
  for (std::size_t r = 0; r < problem.runs(); ++r) sum += (problem.run(r).*count)();
  return sum;
}

}  // namespace

Result experiment_result(const FitProblem& problem, const std::vector<std::string>& settings) {
  const Experiment& experiment = problem.experiment();
  Result out{.title = experiment.title.empty() ? experiment.file : experiment.title, .source = experiment.source};
  Group& of_experiment = out.content.group("experiment", "", Verbosity::data);
  of_experiment.data("file", experiment.file);
  of_experiment.data("title", experiment.title);
  of_experiment.data("source", experiment.source);
  of_experiment.data("scene", experiment.parts.empty() ? experiment.scene.file : "");
  Branch& parts = of_experiment.array("parts");
  for (const ExperimentPart& part : experiment.parts) {
    Group& one = parts.parts.emplace_back();
    one.data("file", part.file);
    one.data("scene", part.scene.file);
  }
  of_experiment.data("changes", each(experiment.changes, [](const ParameterChange& change) {
                       return fmt::format("{}={}", change.path, change.value);
                     }));
  of_experiment.data("set", settings);
  of_experiment.data("simulated", experiment.is_simulated());
  add_units(out.content, experiment.scene.units);
  out.content.data("runs", problem.runs());
  out.content.data("readings", problem.readings());
  const std::size_t less = sum_of(problem, &RunModel::left_out);
  out.content.data("readings_left_out", less);
  if (less > 0) {
    out.content.fact("left out", count(static_cast<int>(less), "reading", "readings") + " for the delays of sensors");
  }
  const std::size_t repeated = sum_of(problem, &RunModel::repeated);
  out.content.data("readings_at_rest", repeated);
  if (repeated > 0) {
    out.content.fact("at rest", count(static_cast<int>(repeated), "reading that differs", "readings that differ") +
                                    " by no more than one step of the sensor from the last, which counts for all");
  }
  out.content.data("parameters", problem.parameters().size());
  out.content.data("nuisances", problem.nuisances());
  return out;
}

std::string data_in_words(const FitProblem& problem) {
  const Experiment& experiment = problem.experiment();
  const std::size_t less = sum_of(problem, &RunModel::left_out);
  return fmt::format("{}; {} readings of {}{}; {}{}", runs_in_words(experiment), problem.readings(),
                     count(static_cast<int>(experiment.sensors.size()), "sensor", "sensors"),
                     less > 0 ? fmt::format(", {} left out for their delays", less) : "",
                     count(static_cast<int>(problem.parameters().size()), "parameter", "parameters"),
                     nuisances_in_words(problem));
}

std::vector<std::string> parameter_units(const FitProblem& problem) {
  return each(places(problem.parameters().size()), [&](std::size_t i) {
    return problem.dimension(static_cast<int>(i)).unit_name(problem.experiment().scene.units);
  });
}

std::vector<std::string> combination_units(const FitProblem& problem,
                                           const std::vector<Identifiability::Combination>& combinations) {
  const std::vector<std::string> units = parameter_units(problem);
  return each(combinations, [&](const Identifiability::Combination& combination) {
    const std::string& unit = units[static_cast<std::size_t>(combination.unit_of)];
    if (combination.over < 0) return unit;
    const std::string& by = units[static_cast<std::size_t>(combination.over)];
    if (by == unit) return std::string();
    return by.find_first_of(" /") == std::string::npos ? unit + " / " + by : unit + " / (" + by + ")";
  });
}

std::string rounded_to(double value, double standard_error) {
  if (!(standard_error > 0) || !std::isfinite(standard_error) || !std::isfinite(value)) return significant(value, 6);
  const int order = static_cast<int>(std::floor(std::log10(standard_error)));
  const double size = std::max(std::abs(value), standard_error);
  const int digits = static_cast<int>(std::floor(std::log10(size))) - order + 1;
  const bool plain = size >= 1e-4 && size < 1e7 && digits < 16;
  std::string text = plain ? fmt::format("{:.{}f}", value, std::max(0, 1 - order))
                           : fmt::format("{:.{}e}", value, std::clamp(digits, 0, 15));
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  return is_zero && value < 0 ? text.substr(1) : text;
}

std::string per_cent(double standard_error, double value) {
  if (value == 0) return "";
  if (!std::isfinite(standard_error)) return "-";
  return significant(100 * standard_error / std::abs(value), 2);
}

void add_null_directions(Group& group, const Identifiability& known) {
  if (known.null_directions.empty()) return;
  Group& section = group.group("", "Not identifiable from these data");
  for (std::size_t k = 0; k < known.null_directions.size(); ++k) {
    const Identifiability::Direction& direction = known.null_directions[k];
    section.note("  " + direction.words, Tone::bad);
    // One remedy for all directions in a row that have the same.
    const bool last = k + 1 == known.null_directions.size() || known.null_directions[k + 1].remedy != direction.remedy;
    if (last) section.note("    remedy: " + direction.remedy);
  }
}

void add_combinations(Group& group, const FitProblem& problem, const Identifiability& known) {
  if (known.combinations.empty()) return;
  const std::vector<Identifiability::Combination>& rows = known.combinations;
  Table& table = group.table("", "Combinations that are identifiable", Rows::list);
  table.words("", "combination", each(rows, &Identifiability::Combination::words));
  table.numbers("", "value", "", {}).texts = each(rows, [&](const auto& row) {
    const double unit = unit_of(problem, row);
    return rounded_to(row.value / unit, row.standard_error / unit);
  });
  table.numbers("", "standard error", "", {}).texts =
      each(rows, [&](const auto& row) { return significant(row.standard_error / unit_of(problem, row), 2); });
  table.numbers("", "per cent", "", {}).texts =
      each(rows, [](const auto& row) { return per_cent(row.standard_error, row.value); });
  table.words("", "unit", combination_units(problem, rows));
}

void add_correlations(Group& group, const FitProblem& problem, const Identifiability& known) {
  const std::vector<std::size_t> identifiable = identifiable_ones(known);
  if (!known.ok || identifiable.size() < 2) return;
  const std::string title = "Correlations of the identifiable parameters";
  if (identifiable.size() > most_in_table) {
    group.list("", title, close_pairs(problem, known, identifiable));
    return;
  }
  Table& table = group.table("", title, Rows::list);
  std::vector<std::string> names, numbers;
  for (const std::size_t i : identifiable) {
    names.push_back(problem.parameters()[i].name);
    numbers.push_back(fmt::format("{}", names.size()));
  }
  table.words("", "", names);
  // The columns are numbered by their rows: names would make the table too wide.
  table.numbers("", "", "", {}).texts = numbers;
  for (std::size_t j = 0; j + 1 < identifiable.size(); ++j) {
    const std::vector<std::size_t> rows = places(identifiable.size());
    const auto r = [&](std::size_t i) { return known.correlation[identifiable[i]][identifiable[j]].value(); };
    table.words("", numbers[j], each(rows, [&](std::size_t i) { return i > j ? fmt::format("{:+.3f}", r(i)) : ""; }))
        .tones =
        each(rows, [&](std::size_t i) { return i > j && std::abs(r(i)) > close ? Tone::doubtful : Tone::plain; });
  }
}

void add_identifiability_data(Group& group, const FitProblem& problem, const Identifiability& known) {
  Group& out = group.group("identifiability", "", Verbosity::data);
  out.data("ok", known.ok);
  out.data("why", known.why);
  out.data("rank", known.rank);
  out.data("structural_nulls", known.structural_nulls);
  out.data("other_nulls", known.other_nulls);
  out.data("unclear", known.unclear);
  out.data("gap", known.gap);
  out.data("singular_values", known.singular_values);
  const std::vector<Parameter>& parameters = problem.parameters();
  const std::vector<std::string> names =
      each(places(known.correlation.size()), [&](std::size_t i) { return parameters[i].name; });
  Table& correlation = out.table("correlation", "", Rows::by_name, Verbosity::data);
  correlation.words("name", "", names);
  for (std::size_t j = 0; j < names.size(); ++j) {
    correlation.data(names[j], each(places(names.size()), [&](std::size_t i) {
                       return known.identifiable[i] && known.identifiable[j] ? known.correlation[i][j] : std::nullopt;
                     }));
  }
  Branch& combinations = out.array("combinations");
  const std::vector<std::string> combined_units = combination_units(problem, known.combinations);
  for (std::size_t k = 0; k < known.combinations.size(); ++k) {
    const Identifiability::Combination& combination = known.combinations[k];
    Group& one = combinations.parts.emplace_back();
    one.data("words", combination.words);
    const double unit = unit_of(problem, combination);
    one.data("value", combination.value / unit);
    one.data("standard_error", combination.standard_error / unit);
    one.data("unit", combined_units[k]);
    one.data("over",
             combination.over < 0 ? Value() : Value(parameters[static_cast<std::size_t>(combination.over)].name));
    Group& terms = one.group("coefficient", "", Verbosity::data);
    for (std::size_t i = 0; i < combination.coefficient.size(); ++i) {
      const double by =
          problem.unknown_of(i).unit / problem.unknown_of(static_cast<std::size_t>(combination.unit_of)).unit;
      if (combination.coefficient[i] != 0) terms.data(parameters[i].name, combination.coefficient[i] * by);
    }
  }
  Branch& directions = out.array("not_identifiable");
  for (const Identifiability::Direction& direction : known.null_directions) {
    Group& one = directions.parts.emplace_back();
    one.data("words", direction.words);
    one.data("remedy", direction.remedy);
    one.data("exact", direction.exact);
    one.data("structural", direction.structural);
    one.data("scale", direction.scale);
    one.data("singular_value", direction.singular_value);
    Group& part = one.group("part", "", Verbosity::data);
    for (std::size_t i = 0; i < direction.part.size(); ++i) part.data(parameters[i].name, direction.part[i]);
  }
}

}  // namespace poise::app

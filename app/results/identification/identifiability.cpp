#include "app/results/identification/identifiability.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/draw/chart/interval_chart.hpp"
#include "app/result/numbers.hpp"
#include "app/results/identification/experiment.hpp"

namespace poise::app {
namespace {

Line verdict(const FitProblem& problem, const Identifiability& known) {
  if (!known.ok) return bad("Identifiability is not known: " + known.why + ".");
  const int all = static_cast<int>(problem.parameters().size());
  const int not_identifiable =
      static_cast<int>(std::count(known.identifiable.begin(), known.identifiable.end(), false));
  const auto poorly = std::count(known.poorly_determined.begin(), known.poorly_determined.end(), true);
  if (not_identifiable == 0 && poorly > 0) {
    return doubtful(fmt::format("{} of {} {} poorly determined by these data.", poorly,
                                count(all, "parameter", "parameters"), poorly == 1 ? "is" : "are"));
  }
  if (not_identifiable == 0) {
    return good(all == 1 ? "The parameter is identifiable from these data."
                         : fmt::format("All {} parameters are identifiable from these data.", all));
  }
  return bad(fmt::format("{} of {} {} not identifiable from these data.", not_identifiable,
                         count(all, "parameter", "parameters"), not_identifiable == 1 ? "is" : "are"));
}

void add_predicted(Group& group, const FitProblem& problem, const Identifiability& known) {
  const std::vector<std::size_t> rows = places(known.ok ? problem.parameters().size() : 0);
  const auto unit = [&](std::size_t i) { return problem.unknown_of(i).unit; };
  const auto value = [&](std::size_t i) { return problem.parameters()[i].truth + problem.unknown_of(i).includes; };
  const auto error = [&](std::size_t i) { return known.identifiable[i] ? known.standard_error[i] / unit(i) : NAN; };
  const auto if_identifiable = [&](auto&& text) {
    return each(rows, [&](std::size_t i) { return known.identifiable[i] ? text(i) : std::string(); });
  };
  Table& table = group.table("predicted", "Least standard errors (Cramer-Rao bound)", Rows::list);
  table.words("name", "parameter", each(rows, [&](std::size_t i) { return problem.parameters()[i].name; }));
  table.words("path", "", each(rows, [&](std::size_t i) { return problem.unknown_of(i).path; })).shown = false;
  table.numbers("value", "in the scene", "", each(rows, [&](std::size_t i) { return value(i) / unit(i); })).texts =
      each(rows, [&](std::size_t i) { return significant(value(i) / unit(i), 6); });
  table.numbers("standard_error", "standard error", "", each(rows, error)).texts =
      if_identifiable([&](std::size_t i) { return significant(error(i), 2); });
  table.numbers("", "per cent", "", {}).texts =
      if_identifiable([&](std::size_t i) { return per_cent(known.standard_error[i], value(i)); });
  table.words("unit", "unit", known.ok ? parameter_units(problem) : std::vector<std::string>{});
  table.flags("identifiable", each(rows, [&](std::size_t i) -> bool { return known.identifiable[i]; }));
  table.flags("poorly_determined", each(rows, [&](std::size_t i) -> bool { return known.poorly_determined[i]; }));
  table.remarks(
      each(rows,
           [&](std::size_t i) {
             return !known.identifiable[i] ? "not identifiable" : known.poorly_determined[i] ? "poorly determined" : "";
           }),
      Tone::bad);
}

/// "24 of 38: 13 directions change no motion of this mechanism (structural, from its equations of motion), 1 changes no
/// reading of these runs; singular values drop there by a factor of 2.1e+08".
std::string rank_in_words(const FitProblem& problem, const Identifiability& known) {
  const int all = static_cast<int>(known.singular_values.size());
  std::string text = fmt::format("{} of {}", known.rank, all);
  const auto directions = [](int n, const char* what) {
    return n == 1 ? fmt::format("1 direction changes no {}", what) : fmt::format("{} directions change no {}", n, what);
  };
  if (known.structural_nulls > 0) {
    text += ": " + directions(known.structural_nulls,
                              problem.all_at_rest()
                                  ? "equilibrium of this mechanism (structural, at its inputs and at random ones)"
                                  : "motion of this mechanism (structural, from its equations of motion)");
  }
  if (known.other_nulls > 0) {
    text += (known.structural_nulls > 0 ? ", " : ": ") + directions(known.other_nulls, "reading of these runs");
  }
  if (known.rank < all && known.gap < INFINITY)
    text += fmt::format("; singular values drop there by a factor of {}", significant(known.gap, 2));
  if (known.unclear > 0) {
    text += fmt::format("; of {} of the others the readings of these runs show nothing above errors of computation",
                        known.unclear);
  }
  const auto weak = std::count_if(known.null_directions.begin(), known.null_directions.end(),
                                  [](const auto& direction) { return direction.singular_value > 0; });
  if (weak > 0) {
    text += fmt::format("; {} with singular values too small for the parameters in {}",
                        count(static_cast<int>(weak), "direction", "directions"), weak == 1 ? "it" : "them");
  }
  return text;
}

void add_numerics(Group& content, const FitProblem& problem, const Identifiability& known, const BaseParameters& base,
                  bool list_base) {
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.fact("data", data_in_words(problem));
  if (known.ok) {
    numerics.fact("rank", rank_in_words(problem, known));
    std::string values;
    for (const double s : known.singular_values) values += (values.empty() ? "" : ", ") + significant(s, 3);
    numerics.fact("singular", values +
                                  ": change of the readings, in standard deviations of the noise, for 100 % along "
                                  "each direction");
  }
  std::string mechanism =
      fmt::format("a motion can depend on {} combinations of the {} inertial parameters", base.rank, base.parameters);
  if (base.gap > 0)
    mechanism += fmt::format("; singular values drop there by a factor of {}", significant(base.gap, 2));
  numerics.fact("mechanism", mechanism + (list_base ? "" : "; --base lists them"));
}

}  // namespace

Result identifiability_result(const FitProblem& problem, const Identifiability& known, const BaseParameters& base,
                              bool list_base, const std::vector<std::string>& settings) {
  Result out = experiment_result(problem, settings);
  out.verdict = verdict(problem, known);
  Group& content = out.content;
  add_predicted(content, problem, known);
  add_null_directions(content, known);
  add_combinations(content, problem, known);
  add_correlations(content, problem, known);
  add_identifiability_data(content, problem, known);
  add_numerics(content, problem, known, base, list_base);
  const Verbosity level = list_base ? Verbosity::normal : Verbosity::data;
  Group& parameters = content.group("base_parameters", "", level);
  parameters.data("parameters", base.parameters);
  parameters.data("rank", base.rank);
  parameters.data("gap", base.gap);
  parameters.list("base",
                  "Base parameters, SI: masses m, first moments m x and m y, inertias J about the bodies' origins",
                  each(base.sums, &BaseParameters::Sum::words), level);
  parameters.list("without_effect", "Inertial parameters without effect", base.without, level);
  return out;
}

std::vector<Panel> identifiability_panels(const FitProblem& problem, const Identifiability& known) {
  if (!known.ok) return {};
  std::vector<Interval> intervals;
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    const double value = problem.parameters()[i].truth + problem.unknown_of(i).includes;
    const double half = known.identifiable[i] ? 1.96 * std::abs(known.standard_error[i] / value) : NAN;
    intervals.push_back({problem.parameters()[i].name, 1.0 - half, 1.0, 1.0 + half});
  }
  std::vector<Curve> curves = interval_curves(intervals);
  if (curves.empty()) return {};
  return {{.title = "95 % intervals that estimates would have at best",
           .x_label = "parameter, by its number",
           .y_label = "over the value in the scene",
           .curves = std::move(curves)}};
}

}  // namespace poise::app

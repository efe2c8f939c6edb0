#include "app/results/identification/identifiability.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/identification/experiment.hpp"

namespace poise::app {
namespace {

Line verdict(const FitProblem& problem, const Identifiability& known) {
  if (!known.ok) return {.text = "Identifiability is not known: " + known.why + ".", .tone = Tone::bad};
  const int all = static_cast<int>(problem.parameters().size());
  const int not_identifiable =
      static_cast<int>(std::count(known.identifiable.begin(), known.identifiable.end(), false));
  if (not_identifiable == 0) {
    return {.text = all == 1 ? "The parameter is identifiable from these data."
                             : fmt::format("All {} parameters are identifiable from these data.", all),
            .tone = Tone::good};
  }
  return {.text = fmt::format("{} of {} {} not identifiable from these data.", not_identifiable,
                              count(all, "parameter", "parameters"), not_identifiable == 1 ? "is" : "are"),
          .tone = Tone::bad};
}

void add_predicted(Group& group, const FitProblem& problem, const Identifiability& known) {
  std::vector<std::string> names, paths, relative, notes;
  std::vector<double> values, standard_errors, identifiable;
  std::vector<std::string> value_texts, error_texts;
  for (std::size_t i = 0; known.ok && i < problem.parameters().size(); ++i) {
    const Unknown& unknown = problem.unknown_of(i);
    const double value = problem.parameters()[i].truth + unknown.includes;
    const bool is_identifiable = known.identifiable[i];
    names.push_back(problem.parameters()[i].name);
    paths.push_back(unknown.path);
    values.push_back(value / unknown.unit);
    value_texts.push_back(significant(values.back(), 6));
    standard_errors.push_back(is_identifiable ? known.standard_error[i] / unknown.unit : NAN);
    error_texts.push_back(is_identifiable ? significant(standard_errors.back(), 2) : "");
    relative.push_back(is_identifiable ? per_cent(known.standard_error[i], value) : "");
    identifiable.push_back(is_identifiable ? 1.0 : 0.0);
    notes.emplace_back(is_identifiable ? "" : "not identifiable");
  }
  Table& table = group.table("predicted", "Least standard errors (Cramer-Rao bound)", Rows::list);
  table.words("name", "parameter", std::move(names));
  table.words("path", "", std::move(paths)).shown = false;
  table.numbers("value", "in the scene", "", std::move(values)).texts = std::move(value_texts);
  table.numbers("standard_error", "standard error", "", std::move(standard_errors)).texts = std::move(error_texts);
  table.numbers("", "per cent", "", {}).texts = std::move(relative);
  std::vector<std::string> units = parameter_units(problem);
  if (!known.ok) units.clear();
  table.words("unit", "unit", std::move(units));
  table.flags("identifiable", std::move(identifiable));
  table.remarks(std::move(notes), Tone::bad);
}

/// "3 of 4; singular values drop by 2.1e+08 there; 1 of them below 3, the limit of identifiability".
std::string rank_in_words(const Identifiability& known) {
  const int all = static_cast<int>(known.singular_values.size());
  std::string text = fmt::format("{} of {}", known.rank, all);
  if (known.rank < all) {
    text += known.gap < INFINITY
                ? fmt::format("; singular values drop there by a factor of {}", significant(known.gap, 2))
                : "; the next singular value is zero";
  }
  const auto weak = std::count_if(known.null_directions.begin(), known.null_directions.end(),
                                  [](const auto& direction) { return !direction.exact; });
  if (weak > 0) {
    text += fmt::format("; {} of these singular values below {}, too small to identify its direction", weak,
                        identifiable_from);
  }
  return text;
}

void add_numerics(Group& content, const FitProblem& problem, const Identifiability& known, const BaseParameters& base,
                  bool list_base) {
  Group& numerics = content.group("", "Numerics");
  numerics.fact("data", data_in_words(problem));
  if (known.ok) {
    numerics.fact("rank", rank_in_words(known));
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
                  base.base, level);
  parameters.list("without_effect", "Inertial parameters without effect", base.without, level);
  return out;
}

}  // namespace poise::app

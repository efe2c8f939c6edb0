#include "app/report/identifiability_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/identifiability_json.hpp"
#include "app/json_parts.hpp"
#include "app/report/experiment_parts.hpp"
#include "app/report/parts.hpp"
#include "app/table.hpp"

namespace poise::app {
namespace {

/// Value in the scene, with what other bodies add to it, SI.
double shown_value(const FitProblem& problem, std::size_t i) {
  return problem.parameters()[i].truth + problem.unknown_of(i).includes;
}

std::string verdict(const FitProblem& problem, const Identifiability& known, const Palette& palette) {
  const int all = static_cast<int>(problem.parameters().size());
  if (!known.ok) return palette.paint(Tone::bad, "Not known what it tells: " + known.why + ".");
  const int untold = static_cast<int>(std::count(known.identifiable.begin(), known.identifiable.end(), false));
  if (untold == 0) {
    return palette.paint(Tone::good,
                         all == 1 ? "The parameter can be told." : fmt::format("All {} parameters can be told.", all));
  }
  return palette.paint(Tone::bad,
                       fmt::format("{} of {} cannot be told.", untold, count(all, "parameter", "parameters")));
}

std::string facts(const FitProblem& problem, const IdentifiabilityAnswer& answer, const Palette& palette) {
  const Identifiability& known = answer.known;
  std::string out = fact("planned", what_is_read(problem), palette) + fact("asked", what_is_asked(problem), palette);
  if (known.ok) {
    const int all = static_cast<int>(known.singular_values.size());
    std::string rank = fmt::format("{} of {}", known.rank, all);
    if (known.rank < all) {
      rank += "; singular values fall by " + (known.gap < INFINITY ? significant(known.gap, 2) : "all") + " there";
    }
    const auto weak = std::count_if(known.null_directions.begin(), known.null_directions.end(),
                                    [](const auto& d) { return !d.exact; });
    if (weak > 0) rank += fmt::format("; {} of them below {}, which tells nothing", weak, identifiable_from);
    out += fact("rank", rank, palette);
    std::string values;
    for (const double s : known.singular_values) values += (values.empty() ? "" : ", ") + significant(s, 3);
    out += fact("singular", values + ": deviations of noise that 100 % along a direction makes", palette);
  }
  const BaseParameters& base = answer.base;
  std::string mechanism =
      fmt::format("{} of its {} inertial parameters can matter to any motion", base.rank, base.parameters);
  if (base.gap > 0) mechanism += fmt::format("; singular values fall by {} there", significant(base.gap, 2));
  return out + fact("mechanism", mechanism + (answer.list_base ? "" : "; --base lists them"), palette);
}

std::string predicted_section(const FitProblem& problem, const Identifiability& known, const Palette& palette) {
  std::vector<std::string> names, values, deviations, relative;
  std::vector<Cell> notes;
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    const double unit = problem.unknown_of(i).unit;
    const double value = shown_value(problem, i);
    const bool told = known.identifiable[i];
    names.push_back(problem.parameters()[i].name);
    values.push_back(significant(value / unit, 6));
    deviations.push_back(told ? significant(known.standard_error[i] / unit, 2) : "");
    relative.push_back(told ? per_cent(known.standard_error[i], value) : "");
    notes.push_back({told ? "" : "not told", Tone::bad});
  }
  Table table;
  table.add_text_column("parameter", names);
  table.add_number_column("in the scene", values);
  table.add_number_column("deviation", deviations);
  table.add_number_column("per cent", relative);
  table.add_text_column("unit", parameter_units(problem));
  table.add_text_column("", notes);
  return section("Least standard deviations", table.print(palette), palette);
}

std::string base_section(const BaseParameters& base, const Palette& palette) {
  std::string body;
  for (const std::string& one : base.base) body += "  " + one + "\n";
  if (!base.without.empty()) {
    body +=
        "  " + palette.paint(Tone::faint, fmt::format("without any effect: {}", fmt::join(base.without, ", "))) + "\n";
  }
  return section("Base parameters, SI: masses m, first moments m x and m y, inertias J about the bodies' origins", body,
                 palette);
}

}  // namespace

std::string identifiability_report(const FitProblem& problem, const IdentifiabilityAnswer& answer,
                                   const Palette& palette) {
  const Identifiability& known = answer.known;
  std::string out = heading(problem.experiment(), palette) + verdict(problem, known, palette) + "\n";
  out += facts(problem, answer, palette);
  if (known.ok) {
    out += predicted_section(problem, known, palette);
    out += correlation_section(problem, known, palette) + untold_section(known, palette);
  }
  return out + (answer.list_base ? base_section(answer.base, palette) : "");
}

std::string identifiability_json(const FitProblem& problem, const IdentifiabilityAnswer& answer,
                                 const std::vector<std::string>& settings) {
  Json out = json_experiment(problem, settings);
  const Identifiability& known = answer.known;
  const std::vector<std::string> units = parameter_units(problem);
  out["predicted"] = Json::array();
  for (std::size_t i = 0; known.ok && i < problem.parameters().size(); ++i) {
    const Unknown& unknown = problem.unknown_of(i);
    const bool told = known.identifiable[i];
    out["predicted"].push_back(
        {{"name", problem.parameters()[i].name},
         {"path", unknown.path},
         {"unit", units[i]},
         {"value", json_number(shown_value(problem, i) / unknown.unit)},
         {"told", told},
         {"deviation", told ? json_number(known.standard_error[i] / unknown.unit) : Json(nullptr)}});
  }
  out["identifiability"] = json_identifiability(problem, known);
  out["base_parameters"] = {{"parameters", answer.base.parameters},
                            {"rank", answer.base.rank},
                            {"gap", json_number(answer.base.gap)},
                            {"base", answer.base.base},
                            {"without", answer.base.without}};
  return json_text(out, problem.experiment().scene);
}

}  // namespace poise::app

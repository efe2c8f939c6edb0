#include "app/identifiability_json.hpp"

#include "app/json_parts.hpp"
#include "app/report/experiment_parts.hpp"

namespace poise::app {

Json json_experiment(const FitProblem& problem, const std::vector<std::string>& settings) {
  const Experiment& experiment = problem.experiment();
  return {{"poise", POISE_VERSION},
          {"experiment",
           {{"file", experiment.file},
            {"title", experiment.title},
            {"source", experiment.source},
            {"scene", experiment.scene.file},
            {"set", settings},
            {"simulated", experiment.is_simulated()}}},
          {"units", json_units(experiment.scene.units)},
          {"runs", problem.runs()},
          {"readings", problem.readings()},
          {"parameters", problem.parameters().size()},
          {"nuisances", problem.nuisances()}};
}

Json json_identifiability(const FitProblem& problem, const Identifiability& known) {
  Json out = {{"ok", known.ok}, {"why", known.why}, {"rank", known.rank}, {"gap", json_number(known.gap)}};
  out["singular_values"] = Json::array();
  for (const double s : known.singular_values) out["singular_values"].push_back(json_number(s));
  const std::vector<Parameter>& parameters = problem.parameters();
  out["correlation"] = Json::array();
  for (std::size_t i = 0; i < known.correlation.size(); ++i) {
    Json row = Json::array();
    for (std::size_t j = 0; j < known.correlation.size(); ++j) {
      const bool told = known.identifiable[i] && known.identifiable[j];
      row.push_back(told ? json_number(known.correlation[i][j]) : Json(nullptr));
    }
    out["correlation"].push_back(std::move(row));
  }
  out["untold"] = Json::array();
  for (const Identifiability::Direction& direction : known.null_directions) {
    Json part = Json::object();
    for (std::size_t i = 0; i < direction.part.size(); ++i) part[parameters[i].name] = json_number(direction.part[i]);
    out["untold"].push_back({{"words", direction.words},
                             {"remedy", direction.remedy},
                             {"exact", direction.exact},
                             {"scale", direction.scale},
                             {"singular_value", json_number(direction.singular_value)},
                             {"part", part}});
  }
  return out;
}

}  // namespace poise::app

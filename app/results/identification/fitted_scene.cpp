#include "app/results/identification/fitted_scene.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/identification/experiment.hpp"
#include "model/one_line.hpp"
#include "model/rewritten_scene.hpp"
#include "model/text_file.hpp"

namespace poise::app {
namespace {

std::string shown(const FitProblem& problem, const Fit& fitted, std::size_t p) {
  const Estimate& e = fitted.estimates[p];
  if (e.at_bound) return fmt::format("{} {}, its bound", significant(e.value / e.unit, 9), parameter_units(problem)[p]);
  const double error = fitted.identifiability.ok ? e.standard_error / e.unit : 0.0;
  return fmt::format("{}{} {}", rounded_to(e.value / e.unit, error),
                     error > 0 ? " ± " + significant(error, 2) : std::string(), parameter_units(problem)[p]);
}

}  // namespace

FittedScene fitted_scene(const FitProblem& problem, const Identification& answer) {
  const Fit& fitted = answer.fit;
  const Experiment& experiment = problem.experiment();
  FittedScene out;
  if (!fitted.usable()) {
    out.left.emplace_back("not written, since there is no fit");
    return out;
  }
  Scene scene = experiment.scene;
  std::string written;
  for (std::size_t u = 0; u < experiment.unknowns.size(); ++u) {
    const Unknown& unknown = experiment.unknowns[u];
    const std::vector<std::size_t> values = chosen_of(places(problem.parameters().size()), [&](std::size_t p) {
      return problem.parameters()[p].unknown == static_cast<int>(u);
    });
    if (unknown.of_sensor) {
      std::string list;
      for (const std::size_t p : values) {
        const bool known = !fitted.estimates[p].withheld || fitted.estimates[p].at_bound;
        list += fmt::format("{}{}{}", list.empty() ? "" : ", ", values.size() > 1 ? fitted.estimates[p].name + " " : "",
                            known ? shown(problem, fitted, p) : "withheld");
      }
      out.left.push_back(fmt::format("{} is a number of the experiment, for its [[sensor]]: {}", unknown.path, list));
      continue;
    }
    if (values.size() > 1) {
      std::string list;
      for (const std::size_t p : values) {
        const std::string value = fitted.estimates[p].withheld ? "withheld" : shown(problem, fitted, p);
        list += fmt::format("{}{} {}", list.empty() ? "" : ", ", fitted.estimates[p].name, value);
      }
      out.left.push_back(fmt::format("{} keeps its value, since it differs between the runs: {}", unknown.path, list));
      continue;
    }
    for (const std::size_t p : values) {
      if (fitted.estimates[p].withheld && !fitted.estimates[p].at_bound) {
        out.left.push_back(fmt::format("{} keeps its value, since the estimate is withheld: {}", unknown.path,
                                       fitted.estimates[p].why));
        continue;
      }
      problem.number(static_cast<int>(p))->set(scene, fitted.parameters[p]);
      const double includes = unknown.includes / unknown.unit;
      written +=
          fmt::format("#   {} = {}{}\n", one_line(unknown.path), shown(problem, fitted, p),
                      includes != 0 ? fmt::format(", of which {} in other bodies", significant(includes, 9)) : "");
    }
  }
  std::vector<std::string> by_equilibrium;
  for (const Run& run : experiment.runs) {
    if (!run.equilibrium || std::count(by_equilibrium.begin(), by_equilibrium.end(), run.equilibrium->by) > 0) continue;
    by_equilibrium.push_back(run.equilibrium->by);
    out.left.push_back(by_equilibrium.back() + " keeps its value, since the equilibrium of each run sets it");
  }
  if (written.empty()) {
    out.left.emplace_back("not written, since there is no estimate to write");
    return out;
  }
  out.text = fmt::format("# {} with estimates of poise identify {}:\n{}# Residuals {} times the noise, rms {}.\n",
                         one_line(scene.file), one_line(experiment.file), written,
                         significant(fitted.residual_over_noise, 4), rms_in_words(fitted.rms, experiment));
  for (const std::string& line : out.left) out.text += "# " + one_line(line) + ".\n";
  out.text += "\n" + rewritten_scene(read_text_file(scene.file), scene.file, scene);
  return out;
}

}  // namespace poise::app

#pragma once

#include <string>
#include <vector>

#include "app/palette.hpp"
#include "identification/base_parameters.hpp"
#include "identification/fit_problem.hpp"
#include "identification/identifiability.hpp"

namespace poise::app {

/// What an experiment can tell, before any data. Values are those of the scene.
struct IdentifiabilityAnswer {
  Identifiability known;
  BaseParameters base;  ///< of the mechanism as in the first run
  bool list_base = false;
};

std::string identifiability_report(const FitProblem& problem, const IdentifiabilityAnswer& answer,
                                   const Palette& palette);
std::string identifiability_json(const FitProblem& problem, const IdentifiabilityAnswer& answer,
                                 const std::vector<std::string>& settings);

}  // namespace poise::app

#pragma once

// What the results on experiments have in common. Values are given in SI and are shown in the units of the
// scene.

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "identification/identifiability/identifiability.hpp"
#include "identification/prediction/fit_problem.hpp"

namespace poise::app {

/// A result with title and source of the experiment, and in its data: experiment {file, title, source, scene,
/// changes, set, simulated}, units, and the numbers of runs, readings, parameters and nuisances.
Result experiment_result(const FitProblem& problem, const std::vector<std::string>& settings);

/// "6 simulated runs; 12000 readings of 1 sensor; 4 parameters, 18 nuisances (equilibrium and start of each run)".
std::string data_in_words(const FitProblem& problem);

/// Names of the units of the parameters.
std::vector<std::string> parameter_units(const FitProblem& problem);
/// Units of combinations: "kg m²", "N/m / kg".
std::vector<std::string> combination_units(const FitProblem& problem,
                                           const std::vector<Identifiability::Combination>& combinations);

/// A value with as many decimals as its standard error has with two digits: 64.692 where that is 0.024.
std::string rounded_to(double value, double standard_error);
/// "0.036": a standard error in per cent of the value; empty of zero.
std::string per_cent(double standard_error, double value);

/// As text: which parameters are not identifiable, and the remedies.
void add_null_directions(Group& group, const Identifiability& known);
/// As text: the combinations of these that are identifiable, with values and standard errors.
void add_combinations(Group& group, const FitProblem& problem, const Identifiability& known);
/// As text: correlations of the identifiable parameters; of many parameters the pairs beyond 0.9.
void add_correlations(Group& group, const FitProblem& problem, const Identifiability& known);
/// As data: identifiability {ok, why, rank, structural_nulls, other_nulls, unclear, gap, singular_values[],
/// correlation{}, not_identifiable[], combinations[]}, without the value of any parameter that is not identifiable.
/// Correlations of parameters that are not identifiable are null.
void add_identifiability_data(Group& group, const FitProblem& problem, const Identifiability& known);

}  // namespace poise::app

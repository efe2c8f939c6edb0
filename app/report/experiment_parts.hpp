#pragma once

// What the reports on experiments are put together from.

#include <string>
#include <vector>

#include "app/palette.hpp"
#include "identification/fit_problem.hpp"
#include "identification/identifiability.hpp"

namespace poise::app {

/// Title and source of the experiment, and an empty line.
std::string heading(const Experiment& experiment, const Palette& palette);

/// "4 parameters, and 18 nuisances: where the runs rest and start".
std::string what_is_asked(const FitProblem& problem);
/// "6 simulated runs, 12000 readings of 1 sensor".
std::string what_is_read(const FitProblem& problem);

/// Names of the units of the parameters.
std::vector<std::string> parameter_units(const FitProblem& problem);

/// A value with as many decimals as its standard deviation has with two digits: 64.692 where that is 0.024.
std::string with_deviation(double value, double deviation);
/// "0.036": a deviation in per cent of the value; "-" of zero.
std::string per_cent(double deviation, double value);

/// How parameters that are told go together: their table, or, where they are many, the pairs beyond 0.9.
std::string correlation_section(const FitProblem& problem, const Identifiability& known, const Palette& palette);
/// Every direction that the readings do not tell, with what would.
std::string untold_section(const Identifiability& known, const Palette& palette);

}  // namespace poise::app

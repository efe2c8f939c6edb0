#pragma once

#include <string>
#include <vector>

#include "app/commands/command.hpp"
#include "app/commands/commands.hpp"
#include "identification/fit_problem.hpp"

namespace poise::app {

/// What was asked of an experiment.
struct ExperimentRequest {
  Request common;    ///< its `scene` is the experiment's file
  std::string data;  ///< file that takes the place of the runs' own
};

/// What every command that reads an experiment takes: EXPERIMENT, --data and --set. `request` must outlive the command.
void add_experiment_options(Command& command, ExperimentRequest& request);

/// Throws InputError, also where the experiment has no unknowns.
Experiment load_experiment(const ExperimentRequest& request);

/// All files that an experiment was read from.
std::vector<std::string> files_read(const Experiment& experiment);

}  // namespace poise::app

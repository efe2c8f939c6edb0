#include "app/commands/experiment_options.hpp"

#include "app/commands/scene_options.hpp"
#include "identification/fit.hpp"

namespace poise::app {

void add_experiment_options(Command& command, ExperimentRequest& request) {
  request.common.kind = "experiment";
  command.add({"EXPERIMENT", &request.common.scene, "", "Experiment file (TOML)", Presence::required});
  command.add({"--data", &request.data, "FILE",
               "Read this CSV file in place of the one that the experiment's\nruns name (all the same)"});
  add_settings(command, request.common);
}

Experiment load_experiment(const ExperimentRequest& request) {
  quiet_ceres();
  Experiment experiment =
      read_experiment(request.common.scene, {.data = request.data, .settings = request.common.settings});
  if (experiment.unknowns.empty()) {
    throw InputError(experiment.file +
                     ": it has no unknowns; expected at least one [[unknown]] with a path, say \"body.arm.mass\"");
  }
  return experiment;
}

std::vector<std::string> files_read(const Experiment& experiment) {
  std::vector<std::string> files = {experiment.scene.file};
  for (const Run& run : experiment.runs) {
    if (!run.data.empty() && run.data.string() != files.back()) files.push_back(run.data.string());
  }
  return files;
}

}  // namespace poise::app

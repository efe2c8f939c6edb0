#include "tests/judge/prediction_campaign.hpp"

#include <filesystem>
#include <memory>
#include <optional>

#include "identification/assessment/carried_numbers.hpp"
#include "identification/assessment/identify.hpp"
#include "identification/experiment/experiment.hpp"
#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/sensitivity/fitted_numbers.hpp"
#include "tests/support/toggle_rig.hpp"

namespace poise::judge {
CarriedFit carried_fit(std::uint64_t seed) {
  CarriedFit out;
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "poise_rig" / "experiment.toml";
  ExperimentOptions reading;
  Scene as_written = parse_scene(test::rig_scene(), (file.parent_path() / "rig.toml").string());
  reading.scene = std::make_shared<const Scene>(as_written);
  const Experiment experiment = parse_experiment(test::rig_experiment(seed), file, reading);
  const FitProblem problem(experiment);
  const Identification answer = identify(problem);
  const std::optional<FittedNumbers> carried = carried_numbers(problem, answer);
  if (!carried) {
    out.why = "no fit: " + answer.fit.why;
    return out;
  }
  const FittedNumbers numbers = carried->of(as_written);
  numbers.put_into(as_written);
  const StaticModel model(as_written);
  const PredictedResult found =
      predict(numbers, model, solve(model), {find_quantity(as_written, "fold.load.P")}).front();
  out.why = found.why.empty() ? found.undetermined : found.why;
  out.value = found.value;
  out.low = found.low;
  out.high = found.high;
  out.first_low = found.first_low;
  out.first_high = found.first_high;
  out.is_linear = found.is_linear;
  return out;
}

}  // namespace poise::judge

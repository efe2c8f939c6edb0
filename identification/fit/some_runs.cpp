#include "identification/fit/some_runs.hpp"

#include <utility>

namespace poise {

SomeRuns::SomeRuns(const FitProblem& whole, const std::vector<Record>& records, std::vector<std::size_t> runs)
    : runs_(std::move(runs)), experiment_(whole.experiment()) {
  experiment_.runs.clear();
  experiment_.records.clear();
  for (const std::size_t r : runs_) {
    experiment_.runs.push_back(whole.experiment().runs[r]);
    experiment_.records.push_back(records[r]);
  }
  problem_.emplace(experiment_);
  for (const Parameter& p : problem_->parameters()) {
    for (std::size_t i = 0; i < whole.parameters().size(); ++i) {
      if (whole.parameters()[i].name == p.name) places_.push_back(i);
    }
  }
}

Fit SomeRuns::seed(const Fit& of_whole) const {
  Fit out;
  out.weighting = of_whole.weighting;
  out.weighting.inputs.clear();
  for (const std::size_t r : runs_) {
    if (r < of_whole.weighting.inputs.size()) out.weighting.inputs.push_back(of_whole.weighting.inputs[r]);
  }
  for (const std::size_t p : places_) out.parameters.push_back(of_whole.parameters[p]);
  for (const std::size_t r : runs_) out.runs.push_back(of_whole.runs[r]);
  return out;
}

}  // namespace poise

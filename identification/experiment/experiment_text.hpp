#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "identification/experiment/experiment.hpp"

namespace poise {

/// A run that may be made.
struct PlannedRun {
  std::size_t like = 0;        ///< its template, one of ExperimentText::templates()
  std::vector<double> values;  ///< of PlanLimits::vary, in the units of the file

  auto operator<=>(const PlannedRun&) const = default;
};

/// The text of an experiment file with planned runs in the place of its simulated ones: what a plan computes with, and
/// what it writes, so that both are the same. Const after construction.
class ExperimentText {
 public:
  /// `experiment` has a plan and was read with these options.
  ExperimentText(const Experiment& experiment, const ExperimentOptions& options);
  ~ExperimentText();

  /// Names of the simulated runs that are templates: those that differ in more than name, seed, what is varied, and
  /// labels by which no number differs.
  const std::vector<std::string>& templates() const { return names_; }
  /// s
  double duration(const PlannedRun& run) const;
  /// The experiment for a file in `folder`, with the runs that have been measured (where asked) and the planned ones.
  /// Common choices are those of the first run.
  std::string with(const std::vector<PlannedRun>& runs, bool measured, const std::filesystem::path& folder) const;
  /// The name that the planned run `number`, from 1, has there.
  std::string name_of(std::size_t number) const { return prefix_ + std::to_string(number); }

 private:
  struct Tables;
  std::unique_ptr<const Tables> tables_;
  PlanLimits limits_;
  std::vector<std::string> names_;
  std::string prefix_ = "planned ";
};

}  // namespace poise

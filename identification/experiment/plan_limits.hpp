#pragma once

#include <optional>
#include <string>
#include <vector>

namespace poise {

/// What a plan makes small, of the covariance C of the parameters, each over its `scale` where it has one, else over
/// its value.
enum class PlanCriterion {
  determinant,  ///< "D": det C, the volume of the confidence ellipsoid
  trace,        ///< "A": trace C, the sum of the squared relative standard errors
  largest       ///< "E": the largest eigenvalue of C, that of the worst combination of parameters
};

/// A number of planned runs that may be chosen, in the unit of the file.
struct PlanChoice {
  std::string what;             ///< as written: "release.obd", "duration"
  std::string table, key;       ///< "release", "obd": where a run has it; no table: a key of the run itself
  bool common = false;          ///< one value for all runs, in the `set` of the experiment
  double min = 0.0, max = 0.0;  ///< the range
  std::vector<double> values;   ///< where not empty: these alone
  int line = 0;

  bool is_list() const { return !values.empty(); }
};

/// The limits within which runs are planned. The simulated runs of the experiment are their templates, measured runs
/// have been made and count.
struct PlanLimits {
  int runs = 1;  ///< at most
  PlanCriterion criterion = PlanCriterion::largest;
  std::optional<double> time;  ///< s: of all planned runs together, at most
  int candidates = 200;        ///< runs to choose from, about
  std::vector<PlanChoice> vary;
  int line = 0;
};

}  // namespace poise

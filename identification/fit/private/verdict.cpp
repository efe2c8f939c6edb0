#include "identification/fit/private/verdict.hpp"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "identification/fit/private/alternatives.hpp"
#include "identification/fit/private/noise_estimate.hpp"

namespace poise {
namespace {

/// Residuals that are compared with a stated noise.
struct TestedNoise {
  std::string of;  ///< " of phi in run "free""
  NoiseTest test;
};

/// Tests the residuals of each sensor whose noise is stated.
std::vector<TestedNoise> tests_in_total(const FitProblem& problem, const Fit& fitted) {
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  std::vector<TestedNoise> out;
  for (std::size_t k = 0; k < sensors.size() && k < fitted.errors.sensors.size(); ++k) {
    if (estimates_noise(problem, fitted.weighting, k)) continue;
    out.push_back({sensors.size() > 1 ? " of " + sensors[k].name : "", fitted.errors.sensors[k]});
  }
  return out;
}

/// Tests them in each of several runs.
std::vector<TestedNoise> tests_by_run(const FitProblem& problem, const Fit& fitted) {
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  std::vector<TestedNoise> out;
  for (std::size_t k = 0; k < sensors.size() && k < fitted.errors.sensors.size(); ++k) {
    if (estimates_noise(problem, fitted.weighting, k)) continue;
    for (std::size_t r = 0; problem.runs() > 1 && r < problem.runs(); ++r) {
      const NoiseTest& test = fitted.errors.runs_noise[r][k];
      if (std::isnan(test.ratio)) continue;
      out.push_back({fmt::format(" of {} in run \"{}\"", sensors[k].name, problem.run(r).run().name), test});
    }
  }
  return out;
}

/// Residuals that are not as large as stated.
struct WrongSizes {
  std::string words;  ///< "1.4 times the stated noise, expected 0.998 ± 0.1 (95 %)"; empty where there are none
  bool any_larger = false;
};

/// Says which of the residuals differ so by chance with a probability below `least`.
WrongSizes wrong_sizes(const std::vector<TestedNoise>& tests, double least) {
  WrongSizes out;
  for (const TestedNoise& one : tests) {
    if (one.test.chance() >= least) continue;
    out.any_larger = out.any_larger || one.test.ratio > 1;
    out.words +=
        fmt::format("{}{:.3g} times the stated noise{}, expected {:.3g} ± {:.2g} (95 %)", out.words.empty() ? "" : "; ",
                    one.test.size, one.of, one.test.expected(), one.test.expected() * one.test.reach());
  }
  return out;
}

/// Says "the model is incomplete, or the noise is larger than stated; ..."
std::string reason_in_words(const FitProblem& problem, const Fit& fitted, bool larger) {
  if (!larger) {
    return "the noise is smaller than stated, or the readings have been smoothed; standard errors are those of "
           "the stated noise";
  }
  const std::vector<std::string> inputs = exact_inputs(problem.experiment());
  std::string out = fmt::format(
      "the model is incomplete, {}; standard errors are multiplied by what is found over what is expected",
      inputs.empty() ? "or the noise is larger than stated"
                     : fmt::format("the noise is larger than stated, or inputs that count as exact have errors ({})",
                                   fmt::join(inputs, ", ")));
  const std::vector<std::string> noisy = noisy_inputs(problem.experiment());
  if (!noisy.empty() && fitted.weighting.input_noise > 1) {
    out += fmt::format("; noise of {} that is {:.2g} times what is stated would explain it", fmt::join(noisy, ", "),
                       fitted.weighting.input_noise);
  }
  if (fitted.residual_over_noise > doubtful_from) {
    out += fmt::format("; or a better minimum exists, {} tried",
                       fitted.tries == 1 ? "1 start was" : fmt::format("{} starts were", fitted.tries));
  }
  return out;
}

}  // namespace

FitVerdict verdict_on(const FitProblem& problem, const Fit& fitted, bool is_aliased) {
  if (!fitted.alternatives.empty()) return {FitStatus::ambiguous, ambiguity_in_words(fitted.alternatives)};
  const std::vector<TestedNoise> totals = tests_in_total(problem, fitted), parts = tests_by_run(problem, fitted);
  const double least = chance_level / static_cast<double>(totals.size() + parts.size());
  WrongSizes wrong = wrong_sizes(totals, least);
  if (wrong.words.empty()) wrong = wrong_sizes(parts, least);
  if (wrong.words.empty()) return {FitStatus::converged, ""};
  if (is_aliased && fitted.residual_over_noise > suspicious_from) {
    return {FitStatus::failed,
            fmt::format("the residuals are {:.3g} times the stated noise, and the readings allow other frequencies, "
                        "none of which explains them better; read faster, or start closer to the parameters",
                        fitted.residual_over_noise)};
  }
  return {FitStatus::misfit,
          "the residuals are " + wrong.words + ": " + reason_in_words(problem, fitted, wrong.any_larger)};
}

}  // namespace poise

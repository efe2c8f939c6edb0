#include "identification/assessment/identify.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "identification/assessment/check_spans.hpp"
#include "identification/assessment/input_readings.hpp"
#include "identification/assessment/residuals.hpp"
#include "identification/fit/first_readings.hpp"
#include "model/named_item.hpp"
#include "model/nearest_name.hpp"

namespace poise {

const Estimate& Identification::estimate(const std::string& name) const {
  const NamedItem found = find_item(fit.estimates, name);
  if (found) return fit.estimates[static_cast<std::size_t>(found.index)];
  throw InputError(name + ": expected the name of an estimate" +
                   (found.known.empty() ? "; the fit has none" : did_you_mean_or_list(name, found.known)));
}

std::vector<int> parameters_named(const FitProblem& problem, const std::string& name) {
  std::vector<int> out;
  std::vector<std::string> valid;
  for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
    valid.push_back(problem.parameters()[p].name);
    if (valid.back() == name || problem.unknown_of(p).name == name) out.push_back(static_cast<int>(p));
  }
  if (!out.empty()) return out;
  throw InputError(name + ": expected the name of an unknown" + did_you_mean_or_list(name, valid));
}

Identification identify(const FitProblem& problem, const IdentifyOptions& options) {
  const Experiment& experiment = problem.experiment();
  const FitOptions& shared = options.fit;
  const auto say = [&](const std::string& doing) {
    if (shared.progress) shared.progress(doing);
  };
  std::vector<int> profiled;
  for (const std::string& name : options.profiles) {
    for (const int p : parameters_named(problem, name)) profiled.push_back(p);
  }

  if (const std::vector<std::string> noisy = noisy_inputs(experiment); options.bootstrap > 0 && !noisy.empty()) {
    throw InputError(fmt::format(
        "a bootstrap has the errors of sensors alone: expected inputs without noise, found that of {}; leave one out",
        noisy.front()));
  }

  // The fit.
  Identification out;
  say("simulating the runs");
  out.records = problem.records();
  out.faults = record_faults(experiment);
  say("fitting");
  out.fit = fit(problem, out.records, shared);
  out.misfit = gross_misfit(problem, out.fit, out.records);
  if ((out.misfit || out.fit.status == FitStatus::failed) && !out.has_wrong_records() &&
      shared.checks != Checks::none) {
    say("seeking the cause of the misfit");
    out.causes = misfit_causes(problem, out.fit, out.records, {.jobs = shared.jobs, .interrupt = shared.interrupt});
    const bool interrupted = shared.interrupt != nullptr && shared.interrupt->load();
    out.sought = interrupted ? Identification::Sought::interrupted : Identification::Sought::yes;
  }
  if (!out.fit.usable()) return out;

  // What its starts have to do with it.
  if (!experiment.is_simulated()) {
    say("moving the runs from their first readings");
    out.rms_from_readings = rms_from_first_readings(problem, out.fit, out.records);
  }

  // What is uncertain besides the readings.
  if (out.fit.identifiability.ok) {
    say("propagating the uncertainty of known numbers and inputs");
    out.inputs = input_effects(problem, out.fit, out.records);
    if (!experiment.known.empty()) out.known = known_effects(problem, out.fit, out.records);
    add_known_effects(out.known, out.fit);
    add_known_effects(out.inputs, out.fit);
  }

  // Intervals and standard errors by other ways.
  const std::vector<double>& errors = out.fit.identifiability.standard_error;
  std::erase_if(profiled, [&](int p) { return errors.empty() || !std::isfinite(errors[static_cast<std::size_t>(p)]); });
  out.profiles = profiles(problem, out.records, out.fit, profiled,
                          {.jobs = shared.jobs, .interrupt = shared.interrupt, .progress = shared.progress});
  if (options.bootstrap > 0) {
    const auto done = [&](int samples) { say(fmt::format("bootstrap: {} of {} samples", samples, options.bootstrap)); };
    out.bootstrap =
        bootstrap(problem, out.records, out.fit,
                  {.samples = options.bootstrap, .jobs = shared.jobs, .interrupt = shared.interrupt, .progress = done});
  }
  return out;
}

Identification identify(const Experiment& experiment, const IdentifyOptions& options) {
  expect_no_markers(experiment);
  const FitProblem problem(experiment);
  check_spans(problem);
  return identify(problem, options);
}

}  // namespace poise

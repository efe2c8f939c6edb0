#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// What the residuals of each sensor are compared with, SI: the noise that is stated or, where none is, the largest
/// that the readings can have: noise_at_most() of the runs, their root mean square by readings. It is never what a fit
/// has estimated, for which any misfit is noise. Infinite where there are too few readings.
std::vector<double> compared_noise(const Experiment& experiment, const std::vector<Record>& records);

/// A misfit that no noise makes, of the sensor where it is worst.
struct GrossMisfit {
  std::size_t sensor = 0;
  /// Root mean square residual over compared_noise(). Of robust losses the scale of the residuals in place of their
  /// root mean square.
  double over_noise = 0.0;
  double of_signal = 0.0;  ///< the same over the standard deviation of the readings about their means in each run
  std::string words;       ///< "residuals of phi2 are 8.2 times the stated noise"
};

/// Residuals above 3 times compared_noise(); or, where the noise is stated so large that it hides a misfit, above a
/// tenth of the signal, 3 times the largest noise that the readings can have, and correlated from one reading to the
/// next. Noise alone makes neither, be it white or with correlations up to 0.9. None of a fit that is not usable.
std::optional<GrossMisfit> gross_misfit(const FitProblem& problem, const Fit& fitted,
                                        const std::vector<Record>& records);

/// One plain thing that may be wrong with what was read or written, and what then is left of a misfit.
struct MisfitCause {
  std::string words;        ///< "sensor "phi2" counts the other way"
  std::string cure;         ///< what to write: "factor = -1 in the sensor "phi2""
  double over_noise = 0.0;  ///< root mean square of all residuals over the noise, with it
  bool cures = false;       ///< no residuals are above 3 times the noise then
};

struct CauseOptions {
  int jobs = 0;  ///< threads; 0: all cores. The result does not depend on it.
  const std::atomic<bool>* interrupt = nullptr;
};

/// Causes of a misfit of what was measured, the likeliest first: those that cure it, or that lower the residuals to
/// less than a third, in the units that the columns were taken to have (with a factor of 1/1000 any readings are
/// noise). Tried are, one at a time: sign, usual factors, an unknown factor, zero, drift and delay of each sensor; sign
/// and factors of all sensors of a kind; two columns exchanged; angles counted from another body; sign, factors, zero,
/// delay and a largest value (a motor that saturates) of each input; other units of time, a clock that is fast or slow;
/// the beginning or the end of the records, unless they fit without either; a run without which the others fit; and
/// another minimum. Of runs at rest nothing of times: sign, factors and zero of inputs, which may be exchanged with a
/// sensor's column. Nothing is tried where residuals are white and no larger than the readings' own noise can be: then
/// the noise is stated too small.
///
/// Each is judged by a few steps of Levenberg and Marquardt's method from the experiment's starts and from the
/// estimates of the fit, over the first 12 % of the records. The best 24 go on over 30 %, the best 8 over 60 %, the
/// best 6 over all: at most some 250 evaluations of all runs with derivatives in sum. An unknown number of a cause is
/// one more unknown.
std::vector<MisfitCause> misfit_causes(const FitProblem& problem, const Fit& fitted, const std::vector<Record>& records,
                                       const CauseOptions& options = {});

}  // namespace poise

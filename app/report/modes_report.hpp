#pragma once

#include <string>
#include <vector>

#include "app/palette.hpp"
#include "motion/modes.hpp"
#include "statics/equilibrium.hpp"

namespace poise::app {

/// What `poise modes` answers: where the mechanism rests, and how it moves about it.
struct ModesAnswer {
  Equilibrium rest;
  std::vector<double> x;  ///< the rest in the motion model's scaled coordinates; empty where none was found
  Modes modes;
};

/// What `poise modes` prints: the rest, what the linear model leaves out, and one line for each mode.
std::string modes_report(const MotionModel& model, const ModesAnswer& answer, const Palette& palette);

/// A JSON object: poise, scene {file, title, source, set}, units {...}, status, why, stability of the rest,
/// coordinates [{name, kind (angle, length), rest}], freedoms, massless, held, known, why_unknown,
/// modes [{kind, frequency (Hz), damping_ratio, damped_frequency (Hz), growth (1/s), roots [[re, im], [re, im]] (1/s),
/// shape [[re, im] per coordinate, of unit modal mass, SI]}].
std::string modes_json(const MotionModel& model, const ModesAnswer& answer, const std::vector<std::string>& settings);

}  // namespace poise::app

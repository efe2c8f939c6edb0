#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "motion/confirmed_motion.hpp"
#include "motion/motion_record.hpp"

namespace poise::app {

/// What `poise motion` answers.
struct MotionAnswer {
  std::string start;      ///< how it began, in words
  double duration = 0.0;  ///< asked for, s
  double accuracy = 0.0;  ///< asked for
  ConfirmedMotion found;
  MotionRecord record;  ///< without noise
};

// What `poise motion` writes. All values in the units of the scene, time in seconds.

/// Columns: time; NAME of everything that moves (angle, travel); NAME.rate; energy.kinetic, energy.potential.
std::string motion_csv(const MotionModel& model, const MotionRecord& record);

/// The charts: angles, travels, energies over time. At most twelve curves each, those that move most; where all move
/// little for how far apart they are, counted from where they start.
std::vector<Panel> motion_panels(const MotionModel& model, const MotionRecord& record);

/// A JSON object: poise, scene {file, title, source, set}, units {...}, status, why, confirmed, start (words),
/// duration, reached, accuracy, error, energy_error, freedoms, steps, rejected, evaluations, microseconds, energies
/// {start, end: {kinetic, potential, work}}, angles and slides {name: {start, end, rate_start, rate_end}}, drives
/// [{name, largest, at}], singular [times], overrun [texts]. What is not known, or no finite number, is null.
std::string motion_json(const MotionModel& model, const MotionAnswer& answer, const std::vector<std::string>& settings);

/// The largest force of a drive, by size: N m or N, and when, s.
struct LargestForce {
  double value = 0.0, at = 0.0;
};
LargestForce largest_force(const Motion& motion, std::size_t drive);

}  // namespace poise::app

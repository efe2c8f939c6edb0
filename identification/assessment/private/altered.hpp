#pragma once

// Experiments whose readings or inputs are taken for other ones than were written.

#include <functional>

#include "identification/experiment/experiment.hpp"

namespace poise {

/// The input with the points (t, v) of its curve moved to (time(t), value(v)), by increasing `time`: lines of a load,
/// the spline of degree 5 of a drive.
void move_input(RunInput& input, const std::function<double(double)>& time, const std::function<double(double)>& value);

/// Lets `factor` seconds pass for each of the clock of run r: of its readings, of impacts that were read, and of its
/// inputs. Delays stay.
void stretch_clock(Experiment& experiment, std::size_t r, double factor);

/// Cuts the records of runs whose starts are estimated into pieces of about that length, s, with starts of their own.
void cut_into_pieces(Experiment& experiment, double length);

}  // namespace poise

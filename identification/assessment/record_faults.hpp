#pragma once

#include <string>
#include <vector>

#include "identification/experiment/experiment.hpp"

namespace poise {

/// What is wrong with a record whatever the model is.
struct RecordFault {
  std::size_t run = 0;
  std::size_t sensor = 0;  ///< the one in which it is seen best
  std::string words;       ///< "readings of "phi" are cut off at 0.8 rad, 40 of them, first at 0.31 s of run "free""
  std::string cure;        ///< "add skip = [[0.31, 0.35]] to the run"
  /// The readings are no measurement of the quantity there: an estimate from them is none.
  bool is_wrong = true;
};

/// Throws InputError, which names file, column, reading and remedy, for marker values: numbers that loggers write where
/// they read nothing. Such a number m was read where the readings before and after it differ from it by more than 3
/// times the largest step between any two successive others, and by 20 times the noise, and either is made of nines,
/// 0, or an end of the range of 16 or 32 bits, or was read exactly so at three places at least. A sensor that states
/// `missing` is believed. So it is with measured loads. Of readings at rest, which are in no order, such a number but 0
/// is one where it is farther from all others than ten times their range and their sizes.
void expect_no_markers(const Experiment& experiment);

/// Finds in the records of measured runs
///   constant:  all of at least 10 readings are alike, while others of the run change: not is_wrong by itself;
///   clipped:   readings alike at the largest or least value, where those around them would make a smooth curve exceed
///              it: by (slope before - slope behind) readings / 8, more than 4 times noise and resolution, and 3 times
///              the steps at both ends, 1.5 where several stretches have that value;
///   stuck:     readings alike elsewhere, 10 or more of them, with a jump behind or a sudden halt before; these and
///   those
///              that are clipped where no stop or drive halts the mechanism itself;
///              So are measured loads, but at 0 and at their limits, that change from each other reading to the next;
///   wild:      single readings differ from the median of five around them by more than 20 times the noise and 3 times
///              the largest step of those medians, of positions and rates; where the loss does not limit them;
///   lost:      between two readings the quantity jumps by what `lost` seconds of motion make, at least 0.7 of the
///              usual spacing: samples were lost, the clock jumped, or (lost < 0) it stopped. Of positions, where
///              no stop or drive makes the motion jump and the slopes on both sides agree: parabolas through 6 readings
///              on each side, whose values between the two differ by more than 10 times the median of such differences,
///              and of the rounding of readings;
///   idle:      a free run stands still for its first readings and moves then. The times T at which it has left its
///              place by 8, 32 and 128 times the noise tell when it began: from rest places grow as the square of the
///              time since, at 2 T_8 - T_32, which must be 3 (T_32 - T_8) at least; those of an unstable equilibrium
///              grow exponentially, T_128 - T_32 = T_32 - T_8, and are none;
/// and of readings at rest
///   copied:    a quarter of the rows or more repeat others in all digits, where these are finer than the noise.
std::vector<RecordFault> record_faults(const Experiment& experiment);

}  // namespace poise

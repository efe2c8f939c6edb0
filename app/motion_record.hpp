#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/quantity.hpp"
#include "motion/simulate.hpp"

namespace poise::app {

/// Something that moves and has a name: the angle of a body, the travel of a joint, or a coordinate of a body that no
/// chain of joints ties to the ground. Its value is q[coordinate] + offset, SI.
struct Channel {
  std::string name;
  Quantity quantity = Quantity::angle;
  int coordinate = 0;
  double offset = 0.0;
};

/// Everything that moves, angles first.
std::vector<Channel> channels_of(const MotionModel& model);

/// A motion read at equal steps of time; SI.
struct MotionRecord {
  std::vector<Channel> channels;
  std::vector<double> time;
  std::vector<std::vector<double>> value, rate;  ///< per channel, per time
  std::vector<double> kinetic, potential;        ///< per time, J
};

/// Reads the motion at t = 0, 1/rate, 2/rate, ... as far as it came.
MotionRecord record(const MotionModel& model, const Motion& motion, double rate);

/// Adds independent Gaussian noise to all values (not to rates and energies); its standard deviation is given in the
/// units of the scene. The same seed gives the same noise.
void add_noise(MotionRecord& record, const Units& units, double sigma, std::uint64_t seed);

/// What `poise motion` answers.
struct MotionAnswer {
  std::string start;      ///< how it began, in words
  double duration = 0.0;  ///< asked for, s
  double accuracy = 0.0;  ///< asked for
  Motion motion;
  std::optional<double> error;  ///< estimated: difference to a motion at a stricter accuracy
  MotionRecord record;          ///< without noise

  /// The largest error and energy deviation at which the answer still says where the mechanism goes.
  static constexpr double useful = 1e-2;
  bool confirmed() const { return motion.completed() && motion.energy_error < useful && error && *error < useful; }
};

}  // namespace poise::app

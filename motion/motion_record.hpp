#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/quantity.hpp"
#include "motion/simulate.hpp"

namespace poise {

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

/// The channel so named. Throws InputError with the nearest name where there is none.
const Channel& channel_named(const std::string& where, const std::string& name, const std::vector<Channel>& channels);

/// A point of a moving body, "boom.tip", in the world; per time, m.
struct PointRecord {
  std::string name;
  std::vector<double> x{}, y{};
};

/// A motion read at equal steps of time; SI.
struct MotionRecord {
  std::vector<Channel> channels;
  std::vector<double> time;
  std::vector<std::vector<double>> value, rate;  ///< per channel, per time
  std::vector<PointRecord> points;               ///< of all moving bodies
  std::vector<double> kinetic, potential;        ///< per time, J
};

/// Reads the motion at t = 0, 1/rate, 2/rate, ... as far as it came.
MotionRecord record(const MotionModel& model, const Motion& motion, double rate);

/// Adds independent Gaussian noise to all values (not to rates, points and energies); `sigma`, its standard deviation,
/// is given in `units`. The same seed gives the same noise.
void add_noise(MotionRecord& record, const Units& units, double sigma, std::uint64_t seed);

}  // namespace poise

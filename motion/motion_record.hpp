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

/// A point of a moving body, "boom.tip", in the world, or the centre of mass of one that has mass, "boom.center",
/// unless one of its points has this name; per time, m, m/s and m/s^2.
struct PointRecord {
  std::string name;
  int body = 0;
  Vec2 at{};  ///< in its frame
  std::vector<Vec2> place{}, velocity{}, acceleration{};
};

/// A motion read at equal steps of time; SI.
struct MotionRecord {
  std::vector<Channel> channels;
  std::vector<double> time;
  std::vector<std::vector<double>> value, rate;   ///< per channel, per time
  std::vector<std::vector<double>> acceleration;  ///< the same; of a whole record only, as the points are
  std::vector<PointRecord> points;                ///< of all moving bodies
  std::vector<double> kinetic, potential;         ///< per time, J
};

/// The points of a record, without places.
std::vector<PointRecord> points_of(const Scene& scene);

/// Reads the motion at t = 0, 1/rate, 2/rate, ... as far as it came; `whole`: with accelerations, those of the
/// equations of motion at these times (StatesAlong), and points.
MotionRecord record(const MotionModel& model, const Motion& motion, double rate, bool whole = true);

/// Adds independent Gaussian noise to all values (not to rates, points and energies); `sigma`, its standard deviation,
/// is given in `units`. The same seed gives the same noise.
void add_noise(MotionRecord& record, const Units& units, double sigma, std::uint64_t seed);

}  // namespace poise

#include "motion/stop_room.hpp"

namespace poise {

std::vector<StopRoom> stop_rooms(const MotionModel& model, std::span<const double> x) {
  const Mechanism<double>& m = model.mechanism();
  if (m.stops() == 0) return {};
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> c(m.constraints());
  m.place(x.data(), pose.data());
  m.constraint(x.data(), pose.data(), c.data());
  std::vector<StopRoom> rooms;
  for (int s = 0; s < m.stops(); ++s) {
    const double g = c[m.stop_row(s)];
    rooms.push_back({g - m.upper()[s], m.lower()[s] - g});
  }
  return rooms;
}

}  // namespace poise

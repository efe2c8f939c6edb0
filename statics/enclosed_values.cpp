#include "statics/enclosed_values.hpp"

#include <cmath>

#include "statics/balance_system.hpp"

namespace poise {

ValueRadii enclose_values(const StaticModel& model, const Certificate& certificate) {
  const Mechanism<double>& m = model.mechanism();
  const std::vector<double>& x = certificate.x;
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> shown(m.constraints());
  m.place(x.data(), pose.data());
  m.constraint(x.data(), pose.data(), shown.data());
  const Mechanism<Ball>& exact = model.balls().exact;
  std::vector<Ball> q;
  for (const double value : x) q.push_back(Ball(value).widened(certificate.radius));
  std::vector<Planar<Ball>> places(exact.pose_size());
  std::vector<Ball> enclosed(exact.constraints());
  exact.place(q.data(), places.data());
  exact.constraint(q.data(), places.data(), enclosed.data());
  const auto radius = [](const Ball& ball, double value) {
    const double greatest = (ball - Ball(value)).greatest();
    return std::isfinite(greatest) ? greatest : 0.0;
  };
  ValueRadii out;
  out.energy = radius(exact.energy(q.data(), places.data()), m.energy(x.data(), pose.data())) * model.scales().energy();
  for (int s = 0; s < m.stops(); ++s) {
    const auto row = static_cast<std::size_t>(m.stop_row(s));
    const double unit = model.scene().stops[static_cast<std::size_t>(s)].on.is_angle() ? 1.0 : model.scales().length;
    out.stops.push_back(radius(enclosed[row], shown[row]) * unit);
  }
  return out;
}

}  // namespace poise

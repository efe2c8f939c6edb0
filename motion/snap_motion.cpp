#include "motion/snap_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "model/controllers.hpp"
#include "model/joint_friction.hpp"
#include "motion/equilibrium_pose.hpp"

namespace poise {
namespace {

/// Kinetic energy below this part of its largest is rest.
constexpr double at_rest = 1e-6;
constexpr double first_duration = 0.01;  // s
constexpr int most_doublings = 24;
/// What has not come to rest within so many times the time of the first peak is not damped.
constexpr double many_peaks = 200.0;

/// The time from which on the kinetic energy stays that of rest; the end where it does not.
double time_of_rest(const Motion& motion) {
  const double most = *std::max_element(motion.kinetic.begin(), motion.kinetic.end());
  std::size_t k = motion.kinetic.size();
  while (k > 1 && motion.kinetic[k - 1] < at_rest * most) --k;
  return motion.trajectory.t[std::min(k, motion.kinetic.size() - 1)];
}

double time_of_first_peak(const Motion& motion) {
  for (std::size_t k = 1; k + 1 < motion.kinetic.size(); ++k) {
    if (motion.kinetic[k] > motion.kinetic[k + 1]) return motion.trajectory.t[k];
  }
  return 0.0;
}

}  // namespace

SnapMotion snap_motion(const StaticModel& statics, const std::vector<double>& x, const SnapMotionOptions& options) {
  SnapMotion out;
  try {
    refuse_controllers(statics.scene(), "motions from one equilibrium to the next");
    const MotionModel model(resisted_by_joints(statics.scene()));
    const std::vector<double> q = model.to_si(coordinates_in(model, statics, x));
    const MotionState start{q, std::vector<double>(q.size(), 0.0)};
    MotionOptions how;
    how.accuracy = options.accuracy;
    how.interrupt = options.interrupt;
    how.duration = first_duration;
    double peak = 0.0;
    for (int k = 0; k < most_doublings; ++k, how.duration *= 2) {
      out.motion = simulate(model, start, how);
      if (!out.motion.completed()) {
        out.why = out.motion.why;
        return out;
      }
      peak = peak > 0.0 ? peak : time_of_first_peak(out.motion);
      out.time = time_of_rest(out.motion);
      out.rests = peak > 0.0 && out.time < how.duration / 2;
      if (out.rests || (peak > 0.0 && how.duration > many_peaks * peak)) break;
    }
    out.channels = channels_of(model);
    const std::vector<double>& all = out.motion.trajectory.q;
    for (const Channel& channel : out.channels) {
      out.end.push_back(all[all.size() - q.size() + static_cast<std::size_t>(channel.coordinate)] + channel.offset);
    }
    for (const ContactEvent& event : out.motion.events) {
      if (event.kind == ContactEvent::Kind::impact && (!out.hit || event.energy_lost > out.hit->energy_lost)) {
        out.hit = event;
      }
    }
    if (!out.motion.touched.empty()) {
      for (const Touch& touch : out.motion.touched.back().touching) out.touched.push_back(touch.stop);
    }
  } catch (const InputError& error) {
    out.why = error.what();
  }
  return out;
}

}  // namespace poise

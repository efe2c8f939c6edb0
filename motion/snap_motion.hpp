#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "motion/motion_record.hpp"
#include "motion/simulate.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// The motion of a mechanism that snaps, with its inertia, dampers, friction and stops; SI.
struct SnapMotion {
  std::string why;     ///< one sentence where it is not known; empty otherwise
  Motion motion{};     ///< from the pose given, at rest
  bool rests = false;  ///< it comes to rest: the kinetic energy falls below a millionth of its largest value for good
  double time = 0.0;   ///< at which it does, or that simulated
  std::optional<ContactEvent> hit{};  ///< the impact that takes the most energy
  std::vector<int> touched{};         ///< at the end, indices of Scene::stops
  std::vector<Channel> channels{};    ///< what moves
  std::vector<double> end{};          ///< where it is at the end, of each
};

struct SnapMotionOptions {
  double accuracy = 1e-8;  ///< as of MotionOptions
  const std::atomic<bool>* interrupt = nullptr;
};

/// Releases the static model's scene at its scaled coordinates x, which must lie off the equilibrium it snaps from, and
/// follows it over times twice as long until it rests, or for 200 times that in which the kinetic energy first peaks.
SnapMotion snap_motion(const StaticModel& statics, const std::vector<double>& x, const SnapMotionOptions& options = {});

}  // namespace poise

#include "motion/confirmed_motion.hpp"

#include <algorithm>
#include <utility>

namespace poise {

ConfirmedMotion simulate_and_confirm(const MotionModel& model, const MotionState& start, MotionOptions options,
                                     std::function<void(double)> checking) {
  ConfirmedMotion out{simulate(model, start, options), std::nullopt};
  if (!out.motion.completed()) return out;
  options.accuracy /= 10;
  options.progress = std::move(checking);
  const Motion stricter = simulate(model, start, options);
  // No coordinate is known better than the joints are closed.
  if (stricter.completed()) out.error = std::max(difference(out.motion, stricter), out.motion.gap);
  out.why_unknown = stricter.why;
  return out;
}

}  // namespace poise

#include "motion/dynamic_stability.hpp"

#include "motion/equilibrium_pose.hpp"
#include "motion/modes.hpp"

namespace poise {

Stability dynamic_stability(const StaticModel& model, const std::vector<double>& x) {
  const MotionModel motion(model.scene());
  const Modes modes = modes_of(motion, motion_coordinates(motion, model, x));
  if (!modes.known || modes.massless > 0) return Stability::unknown;
  Stability out = Stability::stable;
  for (const Vibration& vibration : modes.vibrations) {
    if (vibration.kind == Vibration::Kind::diverges || vibration.kind == Vibration::Kind::flutters) {
      return Stability::unstable;
    }
    if (vibration.kind == Vibration::Kind::neutral) out = Stability::neutral;
  }
  return out;
}

}  // namespace poise

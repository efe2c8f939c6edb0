#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/dimension.hpp"
#include "motion/forces_along.hpp"
#include "motion/loads_in_motion.hpp"
#include "motion/motion_record.hpp"
#include "motion/motor_efforts.hpp"

namespace poise {

/// A load of a link over time, SI.
struct LinkCourse {
  std::string link, key;  ///< normal, shear, moment, tension, compression: the members of LinkLoads
  Dimension dimension{};
  std::vector<LargestOnLink> value{};  ///< per time: largest by size in the link, and where on its line
  std::size_t largest = 0;             ///< the time at which it is largest by size, of those at which it is known
};

/// Motors in place of the drives that prescribe a motion.
struct MotorsInTime {
  std::vector<Drive> motors;
  int freedoms = 0;                           ///< of the mechanism without drives
  bool is_made = false;                       ///< these motors make the motion
  std::vector<UnbalancedForce> unbalanced{};  ///< where not: what they leave, where it is most
  double at = 0.0;                            ///< when, s
  double left = 0.0;                          ///< the largest generalized force left, over the largest asked for
  double size = 1.0;                          ///< m: efforts of least norm count torques over it
  std::optional<double> followed{};           ///< fed_back()
};

/// All forces over a simulated motion at the times of its record.
struct ForceHistory {
  /// They are those of the drives of the scene, or of motors in their place, with all joint forces that belong to them.
  ForcesAlong found;
  /// Work of each drive or motor since the start, per time, J.
  std::vector<std::vector<double>> work;
  std::vector<LinkCourse> links;
  std::vector<std::string> without_loads;  ///< why nothing is said of a link, of the first time at which
  std::optional<MotorsInTime> motors;
  /// Largest difference of the rate of the kinetic energy, and the power of drives, loads and elements less that lost
  /// in joints, over the largest sum of the sizes of these. Joint forces do no work: their power is the difference.
  double power_error = 0.0;
  /// Largest difference of the kinetic energy, by the phasor model, and the integral of these powers, over the largest
  /// energy exchanged.
  double energy_error = 0.0;
  double imbalance = 0.0;  ///< largest imbalance of a body at any of the times, over the largest force
  std::string worst_body{};

  bool balanced() const { return imbalance <= found.tolerance; }
};

/// Names that can be driven by motors; see find_motor().
struct ForcesInTimeOptions {
  std::vector<Drive> motors{};
  double accuracy = 1e-10;  ///< of the free motion that motors are checked by
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(double)> progress{};
};

/// Calls forces_in_motion() with the states of StatesAlong and the loads of each instant. `scene` is the one before
/// resisted_by_joints(), of the bodies, joints and drives of the model; the record is one of the motion, which has two
/// nodes at least.
ForceHistory forces_in_time(const Scene& scene, const MotionModel& model, const Motion& motion,
                            const MotionRecord& record, const ForcesInTimeOptions& options);

/// The force of a stop that is touched, on the second body of its measure, with the opposite on the first; SI.
struct TouchingForce {
  std::size_t stop = 0;  ///< index into Scene::stops
  int body_a = 0, body_b = 0;
  Vec2 at{};              ///< where it is touched, in the world
  Vec2 force{};           ///< with its friction
  double pressing = 0.0;  ///< size of the force without friction, N
  double moment = 0.0;    ///< of one on an angle, N m
};

/// The forces of what is touched at these times of a simulated motion, which ascend; none at a time at which they are
/// not determined by statics and the laws of friction. `scene` is the one before resisted_by_joints(); the motion has
/// two nodes at least.
std::vector<std::vector<TouchingForce>> touching_forces(const Scene& scene, const MotionModel& model,
                                                        const Motion& motion, const std::vector<double>& times);

}  // namespace poise

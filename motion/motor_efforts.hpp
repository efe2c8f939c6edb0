#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "motion/inverse_dynamics.hpp"
#include "motion/simulate.hpp"
#include "motion/states_along.hpp"

namespace poise {

// Motors that make a motion whose conditions the drives of a scene prescribe: torques in pins, forces along slides, or
// efforts on any measure. The efforts f of the conditions, on measures g, do in every motion N that the joints allow,
// J N = 0, the work that motors on measures m have to do with their efforts u:
//
//   (Dm N)^T u = (Dg N)^T f.
//
// As many motors as freedoms, in a position in which they can move all of them, have one solution. Of several solutions
// the one is taken that has the least sum of squares, torques over the size of the mechanism's model (Scales::length).
// Where there is none, what is left of the generalized forces on the right is unbalanced: these motors cannot make this
// motion.

/// A motor by its name: that of a pin, whose torque it is, on the body of its second point and the opposite on the
/// first; of a slide or pin in a slot, the force along its travel; or the name of a measure (model/named_measures.hpp).
/// Throws InputError, which begins with `where`, for other names.
Drive find_motor(const std::string& where, const Scene& scene, const std::string& name);

/// What motors leave of a generalized force: of the motion in which this coordinate changes and the other ones, of all
/// that are named, do not.
struct UnbalancedForce {
  std::string name;
  bool is_angle = true;
  double value = 0.0;  ///< N m or N
};

/// The efforts of motors at one state.
struct MotorsFound {
  std::vector<double> efforts;              ///< N m or N, positive where they tend to increase their measures
  std::vector<UnbalancedForce> unbalanced;  ///< one for each freedom of the mechanism without its drives
  double needed = 0.0, left = 0.0;  ///< N m per rad, or size: largest generalized force asked for, and left unbalanced
};

/// Finds them for one scene.
class MotorEfforts {
 public:
  /// The scene of the model has the drives that prescribe the motion. It must outlive this.
  MotorEfforts(const MotionModel& model, std::vector<Drive> motors);

  const std::vector<Drive>& motors() const { return motors_; }
  /// `forces` are those in the state with the drives of the scene.
  MotorsFound at(const MovingState& state, const Forces& forces) const;
  /// Freedoms of the mechanism without drives at a state.
  int freedoms(const MovingState& state) const;

 private:
  const MotionModel& model_;
  std::vector<Drive> motors_;
  std::vector<std::string> names_;  // of the coordinates
};

/// How the mechanism moves freely, without drives, from the start of the motion on, under efforts of motors as
/// functions of time: the largest difference of both motions, of a coordinate over its range (difference()). Efforts
/// are read by `efforts_at` at Chebyshev's points of each step of the motion. None where a motor's effort is no load of
/// a scene (of a length, place or rope), where the free mechanism has other coordinates, or where the free motion
/// fails.
std::optional<double> fed_back(const MotionModel& model, const Motion& motion, const std::vector<Drive>& motors,
                               const std::function<std::vector<double>(double)>& efforts_at, double accuracy,
                               const std::atomic<bool>* interrupt);

}  // namespace poise

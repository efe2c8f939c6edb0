#pragma once

#include <memory>
#include <vector>

#include "model/mechanism.hpp"
#include "motion/time_curve.hpp"

namespace poise {

/// A load or a drive of the scene that follows a curve of time during a motion: the magnitude of a force along its
/// direction, N, a torque, N m, or the value of a driven measure, rad or m. It takes the place of the scene's numbers;
/// or, of a load, its curve c(t), a number, multiplies the scene's:  load = c(t) times the load of the scene.
struct MotionInput {
  enum class Of { force, torque, drive };
  Of of = Of::torque;
  int item = 0;  ///< index into Scene::forces, torques or drives
  std::shared_ptr<const TimeCurve> curve;
  double unit = 1.0;  ///< of the curve, in the units of the scene that the motion is computed in
  bool multiplies = false;
};

/// Inputs of a scene in SI, for the same scene scaled().
std::vector<MotionInput> scaled(std::vector<MotionInput> inputs, const Scene& scene, const Scales& scales);

/// The load of an input, less the constant load that the compiled mechanism has in its place.
template <class T>
class InputLoad {
 public:
  /// `scene` is the one that `mechanism` is compiled from; a force must have a direction.
  InputLoad(const Scene& scene, const Mechanism<T>& mechanism, const MotionInput& input);

  /// Sets the load to that of the time t.
  void set(double t) {
    value_ = static_cast<T>(unit_ * curve_->at(t));
    extra_ = (multiplies_ ? static_cast<T>(written_) * value_ : value_) - static_cast<T>(written_);
  }
  /// d(load)/d(number) at that time, of numbers that are other loads' or elements' as without inputs: 1.
  T by(const ForceNumber& number) const {
    if (number.of != number_.of || number.item != number_.item) return T(1);
    return multiplies_ ? value_ : T(0);
  }
  /// g -= generalized force in the pose, n values.
  void add(const Planar<T>* pose, T* g) const;
  /// g -= its change along dq.
  void add_change(const Planar<T>* pose, const T* dq, T* g) const;

 private:
  const Phasors<T>& phasors_;
  std::shared_ptr<const TimeCurve> curve_;
  double unit_, written_ = 0.0;
  bool multiplies_;
  ForceNumber number_;  // of the load
  T value_{}, extra_{};
  int torque_coordinate_ = -1;
  PhasorSum<T> path_;      // to the point of a force
  Planar<T> direction_{};  // of the force, at zero angle of its frame
  int frame_ = -1;
  mutable std::vector<Planar<T>> derivative_;  // of the path
};

}  // namespace poise

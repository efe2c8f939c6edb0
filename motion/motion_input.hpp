#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "model/mechanism.hpp"
#include "motion/time_curve.hpp"

namespace poise {

/// A load or a drive of the scene that follows a curve of time during a motion: the magnitude of a force along its
/// direction, N, a torque, N m, a number of a force element, SI, or the value of a driven measure, rad or m. It takes
/// the place of the scene's numbers; or, but for drives, its curve c(t), a number, multiplies the scene's:
///   load = c(t) times the load of the scene.
struct MotionInput {
  /// Or, as TimeFunction says, the frame: that of the scene alone.
  using Of = TimeFunction::Of;
  Of of = Of::torque;
  int item = 0;  ///< index into Scene::forces, torques, drives or elements
  std::shared_ptr<const TimeCurve> curve;
  double unit = 1.0;  ///< of the curve, in the units of the scene that the motion is computed in
  bool multiplies = false;
  std::shared_ptr<const TimeFunction> function{};  ///< of the scene, SI, in place of a curve
  int part = 0;                      ///< of an element that follows a curve: which of the numbers of its law does
  std::optional<double> own_near{};  ///< its own `near`, whatever that of the others is

  /// The value or a derivative by time, times the unit; `near` as of TimeFunction.
  double at(double t, int derivative, double near) const {
    return unit * (function ? function->at(t, derivative, own_near.value_or(near)) : curve->at(t, derivative));
  }
  bool is_load() const { return of == Of::force || of == Of::torque; }
  /// An element has several numbers: the index of the one of its law that this is of.
  int number() const { return function ? function->part : part; }
  /// Times at which a motion must not be smooth.
  std::vector<double> breaks() const { return function ? function->breaks() : curve->breaks(); }
  /// Whether accelerations may jump there.
  bool jumps() const {
    if (!function) return false;
    return of == Of::drive ? function->law.smoothness() < 2 : function->jumps();
  }
};

/// A function of time without a value, or one of the derivatives that motion needs, at t or just behind it; null where
/// all have them.
const TimeFunction* without_value(const std::vector<MotionInput>& inputs, double t, double behind);

/// The functions of time of a scene, SI: of loads they multiply what the scene gives.
std::vector<MotionInput> inputs_of(const Scene& scene);
/// These, and those of the scene for the loads and drives that they are not of.
std::vector<MotionInput> with_inputs_of(const Scene& scene, std::vector<MotionInput> inputs);

/// Inputs of a scene in SI, for the same scene scaled().
std::vector<MotionInput> scaled(std::vector<MotionInput> inputs, const Scene& scene, const Scales& scales);

/// The load of an input, less the constant load that the compiled mechanism has in its place.
template <class T>
class InputLoad {
 public:
  /// `scene` is the one that `mechanism` is compiled from; a force must have a direction, unless it is multiplied.
  InputLoad(const Scene& scene, const Mechanism<T>& mechanism, const MotionInput& input);
  /// With the numbers that the mechanism has been given, a Numbers<T>.
  template <class NumbersOfScene>
  InputLoad(const NumbersOfScene& numbers, const Mechanism<T>& mechanism, const MotionInput& input);

  /// Sets the load to that of the time t; `near` as of TimeFunction.
  void set(double t, double near) {
    t_ = t;
    near_ = near;
    set_value(static_cast<T>(input_.at(t, 0, near)));
  }
  /// Sets the load by the value of its function or curve at the time, times the unit.
  void set_value(const T& value) {
    value_ = value;
    extra_ = (input_.multiplies ? written_ * value_ : value_) - written_;
  }
  /// d(load)/d(number) at that time, of numbers that are other loads' or elements' as without inputs: 1.
  T by(const ForceNumber& number) const {
    if (number.of != number_.of || number.item != number_.item) return T(1);
    if (number.time_number >= 0) {
      if (!input_.function) return T(0);  // a curve has taken the place of the function
      return written_ * static_cast<T>(input_.function->by(number.time_number, t_, 0, near_));
    }
    return input_.multiplies ? value_ : T(0);
  }
  /// g -= generalized force in the pose, n values.
  void add(const Planar<T>* pose, T* g) const;
  /// g -= its change along dq.
  void add_change(const Planar<T>* pose, const T* dq, T* g) const;

 private:
  Planar<T> extra_force(const Planar<T>* pose) const {
    // A force of zero has no direction, but derivatives by its components.
    const Planar<T> force = input_.multiplies ? T(value_ - T(1)) * whole_ : extra_ * direction_;
    return frame_ >= 0 ? force * pose[frame_] : force;
  }

  const Phasors<T>& phasors_;
  MotionInput input_;
  T written_{};  // the scene's
  double t_ = 0.0, near_ = 0.0;
  ForceNumber number_;  // of the load
  T value_{}, extra_{};
  int torque_coordinate_ = -1;
  PhasorSum<T> path_;                // to the point of a force
  Planar<T> whole_{}, direction_{};  // the scene's force at its points and along it, at zero angle of its frame
  int frame_ = -1;
  mutable std::vector<Planar<T>> derivative_;  // of the path
};

/// A force element of which numbers follow time. Of a spring its force, less that which the compiled mechanism has in
/// its place; the mechanism takes the law of a damper itself (InputForces::laws()).
template <class T>
class InputSpring {
 public:
  /// `inputs` are all of one element, one at least.
  InputSpring(const Mechanism<T>& mechanism, std::vector<MotionInput> inputs);

  int element() const { return inputs_.front().item; }
  /// The law with the numbers of the time.
  const LawIn<T>& law() const { return law_; }
  void set(double t, double near);
  /// Sets the numbers by value(input), what each input has at the time.
  template <class Value>
  void set_values(Value value);
  /// g += the generalized force in the pose, n values.
  void add(Planar<T>* pose, T* g) const;
  /// g += its change along dq.
  void add_change(Planar<T>* pose, const T* dq, T* g) const;
  /// d(number of the law at the time)/d(number), of the law itself or of a function of it.
  T by(const ForceNumber& number) const;
  /// g += by times the derivative of the whole force, at the rates v, by a number of the law, or of a function of it.
  void add_derivative(const ForceNumber& number, const T& by, Planar<T>* pose, const T* v, T* g) const;

 private:
  LawForce<T> extra_force(Planar<T>* pose) const;

  const Mechanism<T>& mechanism_;
  std::vector<MotionInput> inputs_;
  std::vector<NumberOfLaw<T>> written_, values_;  // numbers of the law
  LawIn<T> law_;                                  // with values_
  double t_ = 0.0, near_ = 0.0;
};

/// Torques that follow from the past of a motion.
class TorquesOfPast {
 public:
  struct One {
    int coordinate;  ///< an angle
    double torque;   ///< in the units of the scene that the motion is computed in
  };
  virtual ~TorquesOfPast() = default;
  /// Returns those at t; `near` is that of TimeFunction.
  virtual const std::vector<One>& at(double t, double near) const = 0;

  /// The derivatives of an acceleration by the columns of sensitivities.
  struct Change {
    int coordinate;
    std::vector<double> by;
  };
  virtual const std::vector<Change>& changes_at(double t, double near) const = 0;
};

/// All that follows functions of time but drives: loads, springs, dampers and the acceleration of the frame.
template <class T>
class InputForces {
 public:
  explicit InputForces(const Mechanism<T>& mechanism) : mechanism_(mechanism) {}
  template <class NumbersOfScene>
  void set_inputs(const NumbersOfScene& numbers, const std::vector<MotionInput>& inputs);

  /// Adds torques of the past, or none; they must outlive this.
  void set_past(const TorquesOfPast* past) { past_ = past; }
  const TorquesOfPast* past() const { return past_; }
  /// What controllers read of forces that follow from accelerations, by element; it must outlive this.
  void set_reactions(const T* reactions) { reactions_ = reactions; }

  void set(double t, double near);
  /// g += generalized forces less those that the mechanism has in their place, and their change along dq.
  void add(Planar<T>* pose, T* g) const;
  void add_change(Planar<T>* pose, const T* dq, T* g) const;
  /// g += by times the derivative of -Q by a number, at the rates v; `sliding` as of Mechanism::resist().
  void add_derivative(const ForceNumber& number, T by, Planar<T>* pose, const T* v, const int* sliding, T* g) const;
  /// d(number of an element's law at the time)/d(number), of the law itself or of a function of it.
  T by(const ForceNumber& number) const;
  /// For Mechanism::resist(): the laws of dampers and controllers that vary.
  ForcesInTime<T> in_time() const;
  /// The acceleration of the frame.
  const Planar<T>& frame() const { return frame_; }

 private:
  const Mechanism<T>& mechanism_;
  std::vector<InputLoad<T>> loads_;
  std::vector<InputSpring<T>> springs_;
  std::vector<MotionInput> frames_;
  mutable std::vector<const LawIn<T>*> laws_;  // by element, empty if none varies that resists
  Planar<T> frame_{};
  const TorquesOfPast* past_ = nullptr;
  const T* reactions_ = nullptr;
  double t_ = 0.0, near_ = 0.0;
};

}  // namespace poise

#pragma once

// What can be asked by name of a mechanism that moves: docs/quantities.md.

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "motion/inverse_dynamics.hpp"
#include "motion/simulate.hpp"
#include "motion/states_along.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// Throws InputError "NAME: why" for a quantity that has no meaning in a motion of the scene: a load at a fold, the
/// push where nothing is driven.
void refuse_at_rest_only(const Scene& scene, const SoughtQuantity& of);

/// Whether it has one value for a whole motion: max(Q) and the like, numbers, and what is made of these.
bool is_constant_in_time(const SoughtQuantity& of);

/// Values of quantities of bodies in motion, from their places, rates and accelerations and the forces between them.
///
/// d(A)/d(B), instant centres and transmission angles belong to the one motion that the joints and couplings allow, as
/// at rest; of several freedoms to the motion that takes place, d(A)/d(B) = (dA/dt) / (dB/dt). A push P along e at a
/// point p does the work of the drive, whose effort F on its measure g includes inertia, where there is one freedom:
///   P e . dp = F dg.
class MovingQuantities {
 public:
  /// `scene` is the one that the quantities were found in, of the bodies, joints and drives of the model, which must
  /// outlive this.
  MovingQuantities(const Scene& scene, const MotionModel& model);
  ~MovingQuantities();

  /// SI; `then` is the scene with the loads of the instant. Not a number where it is undefined: what is divided by
  /// zero, a joint force that joints which repeat each other leave open, forces that friction does not determine; and
  /// d(A)/dt unless A is made of measures and numbers.
  double value(const SoughtQuantity& of, const Forces& forces, const Scene& then) const;
  /// Where not, the `motions` of the forces are enough.
  static bool needs_forces(const SoughtQuantity& of);

 private:
  struct Place;

  double in_place(const SoughtQuantity& of, const std::vector<BodyMotion>& motions, bool of_one_freedom) const;
  double effort(const SoughtQuantity& of, const Forces& forces) const;
  double push(const SoughtQuantity& of, const Forces& forces) const;
  double in_link(const SoughtQuantity& of, const Forces& forces, const Scene& then) const;
  double rate(const SoughtQuantity& of, const Forces& forces, const Scene& then) const;

  const Scene& scene_;
  const MotionModel& model_;
  std::unique_ptr<Place> place_;
};

/// The forces in a motion that was simulated, by inverse dynamics of the bodies cut free (forces_of()), with scaled
/// coordinates x of the model, their rates v (per s) and accelerations a (per s^2). Of stops those act that are touched
/// and stay so. `then` is the scene of the instant, at_time(). Friction of joints that slide is their bound under the
/// joint forces that it makes itself. Friction where nothing slides, of joints and of [[friction]] of width 0, is what
/// the accelerations need it to be, undetermined where it shares a load with others: where rates are below 1e-9 of the
/// fastest of v and `fastest`. Of the checks there is the imbalance only. With `efforts` those of the drives of `then`
/// are given, N m or N, in place of being found.
Forces forces_in_motion(const Scene& then, const MotionModel& model, const std::vector<double>& x,
                        const std::vector<double>& v, const std::vector<double>& a, double fastest = 0.0,
                        const std::vector<double>* efforts = nullptr);

/// A time of a motion and the value of a quantity there.
struct ValueInTime {
  double time = 0.0, value = 0.0;
};

/// Where a quantity is least and greatest in a motion, and its mean over time; not a number where it is undefined at
/// one of the places looked at.
struct QuantityRange {
  ValueInTime least, greatest;
  double mean = 0.0;
};

/// Quantities as functions of time along a simulated motion, whose states are those of StatesAlong. One object per
/// thread: it holds the last state.
class QuantitiesAlong {
 public:
  /// `scene` is the one before resisted_by_joints(), in which the quantities are found. All must outlive this; the
  /// motion has two nodes at least.
  QuantitiesAlong(const Scene& scene, const MotionModel& model, const Motion& motion);

  /// At a time of the motion, where something jumps after the jump; SI. Rates d(A)/dt of what is no measure are those
  /// of the polynomial of degree 11 through the values of A at Chebyshev's points of the integrator's step.
  double value(const SoughtQuantity& of, double t);
  /// max(Q), min(Q), mean(Q) and span(Q) are those of ranges(), mean(Q) over time; work(Q) is the integral of the force
  /// Q over its measure, or the way of its point along its direction.
  ///
  /// The least and the greatest values within the motion, between the nodes too: the extremes of the values at all
  /// nodes and at points between them, refined by golden sections; jumps have their values on both sides. Means by
  /// Gauss's rule of five points in each step.
  std::vector<QuantityRange> ranges(const std::vector<SoughtQuantity>& of);

  /// The largest imbalance of a body over the largest force, of all states yet whose forces were asked for: how well
  /// accelerations between the steps are known.
  double imbalance() const { return largest_force_ > 0.0 ? imbalance_ / largest_force_ : 0.0; }

 private:
  struct Polynomial {
    std::string of;
    std::size_t interval = 0;
    std::vector<double> slopes;  // Chebyshev coefficients of the derivative
  };

  const Forces& state(double t, bool with_forces);
  const Scene& then(double t);
  std::size_t interval_at(double t) const;
  double rate(const SoughtQuantity& of, double t);
  double work(const SoughtQuantity& of, double t);
  double over_motion(const SoughtQuantity& of);
  ValueInTime extreme(const SoughtQuantity& of, const std::vector<double>& times, const std::vector<double>& values,
                      double sign);

  const Scene& scene_;
  const MotionModel& model_;
  const Trajectory& path_;
  MovingQuantities quantities_;
  StatesAlong states_;
  double at_;
  std::optional<Scene> then_;
  double then_at_ = 0.0;
  bool has_forces_ = false;
  Forces forces_;
  double imbalance_ = 0.0, largest_force_ = 0.0;  // N
  std::vector<Polynomial> polynomials_;
  std::vector<std::pair<std::string, double>> over_motion_;  // max(Q) and the like that are known
};

}  // namespace poise

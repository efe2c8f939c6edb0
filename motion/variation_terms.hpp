#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "motion/bearing_loads.hpp"
#include "motion/blade_row.hpp"
#include "motion/motion_input.hpp"
#include "motion/touch.hpp"
#include "motion/variation.hpp"
#include "motion/varied_model.hpp"

namespace poise {

/// A joint, or else a stop, whose friction grows with its force.
struct GripOf {
  int joint = -1, stop = -1;
};

/// A state of a ReducedMotion, for the derivatives by numbers there.
struct VariedState {
  using Dual = VariedModel::Dual;

  double t = 0.0, near = std::numeric_limits<double>::quiet_NaN();  ///< s; `near` as of TimeFunction
  const int* sliding = nullptr;                                     ///< as of Mechanism::resist()
  bool jumps = false;                                               ///< `a` is a jump of rates: loads have no part in G
  std::vector<Dual> q, v, a;                                        ///< n values each
  std::vector<Planar<Dual>> pose, second;  ///< phasors with room behind them, and their second time derivatives
  std::vector<Dual> multipliers;           ///< of the closures' rows
  std::vector<Dual> drive_multipliers;     ///< of the rows of drives
  std::vector<Dual> contact_efforts;       ///< of BearingLoads::contacts()
  std::vector<Dual> grip_efforts;          ///< of the grips, as far as they are across stops
  std::vector<Dual> blade_multipliers;
  std::vector<Dual> reactions;
};

/// What changes with a number of a scene at fixed coordinates, rates, accelerations, multipliers and efforts: the gaps
/// c of closures and drives, J v less the rates of drives, J a + D2c[v, v] less their accelerations; A v and
/// h of blades; and G + J^T multipliers. By the number as it moves geometry, inertia and forces: numbers of drives and
/// of functions of time are left to the caller.
class VariationTerms {
 public:
  using Dual = VariedModel::Dual;

  /// Rows of drives are those of the scene, stops whose limits are equal, limits that are touched, and the elements
  /// `held`. The friction of `grips` grows with their forces, `growing` are the joints where it does. All must outlive
  /// this.
  VariationTerms(const Variation& variation, const std::vector<MotionInput>& inputs, const std::vector<Touch>& touching,
                 const std::vector<int>& held, const std::vector<GripOf>& grips, const std::vector<int>& growing);

  /// Room that VariedState::pose must have.
  std::size_t pose_size() const { return pose_size_; }
  /// Adds the derivatives of rows and forces, equalities() and drives, and n values, and of each blade those of A v
  /// and h.
  template <class T>
  void add(VariedState& state, T* gap, T* rate, T* acceleration, T* force, T* blade_rate, T* blade) {
    evaluate(state);
    for (std::size_t r = 0; r < gap_.size(); ++r) {
      gap[r] += T(gap_[r].v[0]);
      rate[r] += T(rate_[r].v[0]);
      acceleration[r] += T(acceleration_[r].v[0]);
    }
    for (std::size_t i = 0; i < force_.size(); ++i) force[i] += T(force_[i].v[0]);
    for (std::size_t b = 0; b < blade_.size(); ++b) {
      blade_rate[b] += T(blade_rate_[b].v[0]);
      blade[b] += T(blade_[b].v[0]);
    }
  }

  /// The derivatives of grip_factor() of the joint grips[i], or of its stop's coefficient, and of the direction of its
  /// line at zero angle of the frame in which that is fixed.
  double factor_by(std::size_t i) const { return factors_[i]; }
  const Vec2& axis_by(std::size_t i) const { return axes_[i]; }

 private:
  struct Row {
    CompiledMeasure<Dual> on;
    Dual limit{0.0};  // of a stop
  };
  void evaluate(VariedState& state);
  void add_forces(VariedState& state);
  void add_rows(VariedState& state);
  void add_blades(VariedState& state);

  Variation variation_;
  std::vector<Row> rows_;
  std::size_t first_stop_ = 0;
  struct Rub {
    std::size_t grip;
    CompiledMeasure<Dual> on;
  };
  std::vector<Rub> rubs_;  // across stops
  InputForces<Dual> input_forces_;
  BearingLoads<Dual, Numbers<Dual>> bearing_loads_;
  std::vector<double> factors_;
  std::vector<Vec2> axes_;
  std::size_t pose_size_ = 0;
  std::vector<BladeRow<Dual>> blades_;
  std::vector<Dual> gap_, rate_, acceleration_, force_, blade_rate_, blade_, jacobian_, resistances_;
  std::vector<Planar<Dual>> work_;
};

/// Those of all variations of a ReducedMotion, with the state that they are evaluated at.
struct MotionVariations {
  std::vector<VariationTerms> terms;
  VariedState state;
};

}  // namespace poise

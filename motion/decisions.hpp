#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/varied_model.hpp"

namespace poise {

/// How what controllers decide changes (ControllerOf::decide). Private to simulate().
class Decisions {
 public:
  /// The model must outlive this.
  Decisions(const MotionModel& model, const std::vector<Variation>& variations,
            const std::vector<Influence>& influences);

  /// u, s' and the input of the filter or transfer function, in SI, and their derivatives.
  struct Decided {
    std::array<double, 3> value, by;
  };
  /// Sets rates and their derivatives, n values each, of which the controllers behind the `k`-th know.
  using Use = std::function<void(std::size_t k, const Decided&, std::vector<double>& v, std::vector<double>& dv)>;

  /// Gives to `use` what these elements decide, one after the other, at t, to which `motion` is evaluated, where places
  /// and rates change by dq and dv, n values each, and by an influence if its index is not negative. Where controllers
  /// read forces that follow from accelerations, `motion` is linearized.
  void change(ReducedMotion<double>& motion, double t, std::span<const int> elements, const std::vector<double>& dq,
              const std::vector<double>& dv, int influence, const Use& use);

 private:
  using Dual = VariedModel::Dual;

  const MotionModel& model_;
  std::vector<Variation> variations_;
  std::vector<Influence> influences_;
  std::vector<Planar<double>> pose_;
};

/// Returns u, s' and the input of what is decided, in SI, as Decisions::Decided has them.
template <class T>
std::array<T, 3> in_si(const ControlOutputs<T>& decided, double effort_unit) {
  return {decided.effort * (1.0 / effort_unit), decided.integral, decided.input};
}

}  // namespace poise

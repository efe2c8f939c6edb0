#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "motion/motion_input.hpp"
#include "motion/motion_model.hpp"
#include "motion/quantities_along.hpp"

namespace poise {

/// A force or another quantity of a mechanism that moves, which follows from its state by inverse dynamics.
class QuantityReader {
 public:
  /// `inputs` are the curves of a run, SI.
  QuantityReader(std::shared_ptr<const MotionModel> model, SoughtQuantity of, std::vector<MotionInput> inputs);

  /// SI, at a time and the state there, scaled coordinates of the model with their rates and accelerations. Not a
  /// number where it is undefined.
  double read(double t, const MovingState& state);
  /// Whether it follows time itself, as a load does.
  bool is_timed() const { return !inputs_.empty() || !model_->scene().time_functions.empty(); }

 private:
  const Scene& at(double t);

  std::shared_ptr<const MotionModel> model_;
  SoughtQuantity of_;
  std::vector<MotionInput> inputs_;
  std::unique_ptr<const MovingQuantities> quantities_;
  std::optional<Scene> then_;
  double then_at_ = 0.0;
};

/// The same with derivatives, by differences of fourth order of what is exact to rounding: good to 1e-9 of its terms.
class VariedQuantity {
 public:
  /// One number with the scenes in which it is changed by so much.
  struct Number {
    double step = 0.0;
    bool one_sided = false;               ///< moved by 1 to 4 steps, of a number that is at the end of its range
    std::vector<QuantityReader> moved{};  ///< else by step, -step, 2 step, -2 step
  };

  VariedQuantity(QuantityReader here, std::vector<Number> numbers);

  double read(double t, const MovingState& state) { return here_.read(t, state); }
  /// Returns the derivative along a change of the state, which may have any size.
  double along(double t, const MovingState& state, const MovingState& change);
  /// Returns the derivative by time along a motion whose accelerations have these derivatives.
  double by_time(double t, const MovingState& state, std::vector<double> jerk);
  /// Returns the derivative by number i at a fixed state.
  double by_number(std::size_t i, double t, const MovingState& state);

 private:
  QuantityReader here_;
  std::vector<Number> numbers_;
};

}  // namespace poise

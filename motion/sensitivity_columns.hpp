#pragma once

#include <cstddef>
#include <vector>

#include "motion/simulate.hpp"

namespace poise {

/// What the sensitivities of a motion are by: the initial independent coordinates, their rates, and the influences of
/// its options. Private to simulate().
class SensitivityColumns {
 public:
  /// The motion begins with these independent coordinates; `model` and `options` must outlive this.
  SensitivityColumns(const MotionModel& model, const MotionOptions& options, std::vector<int> independent);

  int count() const { return count_; }
  /// Degrees of freedom at the start.
  int freedoms() const { return static_cast<int>(independent_.size()); }
  const std::vector<int>& independent() const { return independent_; }
  /// SI value of each coordinate's unit.
  const std::vector<double>& units() const { return unit_; }
  /// SI value of the initial coordinate that a column refers to; influences are per the caller's own unit.
  double unit_of(int column) const {
    return column < 2 * freedoms() ? unit_[static_cast<std::size_t>(independent_[column % freedoms()])] : 1.0;
  }
  /// Index of the influence that a column is of; negative of initial values.
  int influence_of(int column) const { return column - 2 * freedoms(); }
  int column_of(std::size_t influence) const { return 2 * freedoms() + static_cast<int>(influence); }
  /// Index of the variation that a column is of; -1 of others.
  int variation_of(std::size_t column) const;
  /// Columns whose errors count in the length of steps: all where options ask for that. Dry friction turns with the
  /// rate over a width: where its size is small, or even 0, the state tells nothing of that, but its sensitivities to
  /// the size do.
  const std::vector<int>& that_switch() const { return that_switch_; }

 private:
  const MotionOptions& options_;
  std::vector<int> independent_;
  std::vector<double> unit_;
  int count_;
  std::vector<int> that_switch_;
};

}  // namespace poise

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/recorded.hpp"
#include "statics/many/private/lane_kernel.hpp"

namespace poise {

/// What Newton's method needs of a recording, and what is to come of it.
struct RecordedNewton {
  std::vector<Recorded> numbers;  ///< inputs
  std::vector<Recorded> x;        ///< inputs
  std::vector<double> start;      ///< of x
  std::vector<Recorded> first_step, next_step;
  RecordedMask first_mask{true}, last_mask{true};
  std::vector<Recorded> values;
  RecordedMask values_mask{true};
};

/// Newton's method as programs for lanes: nodes of the recording in the order in which they were made, each with a
/// place in memory, which nodes share where one is no longer needed. What depends on numbers alone is computed once,
/// a product with a sum is one instruction, and so are sine and cosine.
class LaneCode {
 public:
  /// Makes code of what was recorded to `recording` on this thread; `units` are those of x.
  LaneCode(Recording& recording, const RecordedNewton& newton, std::vector<double> units);
  LaneCode(const LaneCode&) = delete;
  LaneCode& operator=(const LaneCode&) = delete;

  /// Without its tolerances. Refers to this.
  const LaneNewton& newton() const { return newton_; }
  LaneNewton& newton() { return newton_; }
  /// False where there are more places than instructions can name.
  bool fits() const { return fits_; }
  std::size_t instructions() const { return once_.size() + step_.size() + check_.size() + values_.size(); }

 private:
  class Generator;

  std::vector<LaneInstruction> once_, step_, check_, values_;
  std::vector<double> constants_, start_, units_;
  std::vector<std::uint16_t> first_step_, next_step_, value_;
  LaneNewton newton_{};
  bool fits_ = true;
};

}  // namespace poise

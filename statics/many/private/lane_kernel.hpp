#pragma once

// What runs in lanes: a plain interface, since each set of instructions has an object of its own, whose symbols must
// not be those of other sources. Nothing that may have a definition of its own there is included: no templates, no
// inline functions of the standard library or of Poise.

#include <stddef.h>
#include <stdint.h>

namespace poise {

/// Of places in a memory of numbers for all lanes of a block: to = a op b, and so on (LaneOp).
struct LaneInstruction {
  uint16_t op, to, also, a, b, c;
};

struct LaneProgram {
  const LaneInstruction* first;
  size_t count;
};

/// Newton's method from one start, as programs over places: constants first.
struct LaneNewton {
  LaneProgram once;    ///< from the numbers: what depends on them alone, and the first step with its mask
  LaneProgram step;    ///< from x: a step
  LaneProgram check;   ///< behind it: the mask of lanes in which it may be the last
  LaneProgram values;  ///< from the x found: what else is asked for
  const double* constants;
  size_t constant_count;
  size_t places;
  size_t numbers, first_number;
  size_t coordinates, first_x;
  const double* start;
  const double* units;         ///< of coordinates: by which they are multiplied in the end
  const uint16_t* first_step;  ///< places of the first step
  const uint16_t* next_step;   ///< and of the others
  uint16_t first_mask, last_mask, values_mask;
  const uint16_t* value;  ///< places of values
  size_t value_count;
  double tolerance;    ///< of the last step
  double longest;      ///< no step may be longer
  double contraction;  ///< each step is at most this part of the one before
  int most_steps;
};

/// Variants to solve at a time, at most as many as a block has lanes.
struct LaneBlock {
  const double* const* numbers;  ///< one array for each
  const size_t* strides;         ///< of each: 1, or 0 of one for all variants
  size_t first;                  ///< variant
  size_t count;
  double* x;        ///< count x coordinates; written where solved
  double* values;   ///< count x value_count; written where solved
  uint8_t* solved;  ///< count: 1 of the lanes that are, 3 where the values are known too
};

struct LaneKernel {
  size_t lanes;  ///< of a block
  /// Fills in the constants; memory has places x lanes numbers and is aligned to 64 bytes.
  void (*prepare)(const LaneNewton* newton, double* memory);
  void (*solve)(const LaneNewton* newton, double* memory, const LaneBlock* block);
};

}  // namespace poise

extern "C" {
const poise::LaneKernel* poise_lanes_plain();
const poise::LaneKernel* poise_lanes_avx2();
const poise::LaneKernel* poise_lanes_avx512();
}

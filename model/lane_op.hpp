#pragma once

#include <stdint.h>

namespace poise {

/// An operation on lanes. A comparison is a mask: all bits of a lane, or none.
enum class LaneOp : uint16_t {
  constant,
  input,
  add,
  subtract,
  multiply,
  divide,
  negate,
  multiply_add,       ///< a b + c
  multiply_subtract,  ///< a b - c
  subtract_product,   ///< c - a b
  square_root,
  absolute,
  floor,
  least,
  greatest,
  sine,
  cosine,
  sine_and_cosine,  ///< of a: the sine, and `also` the cosine
  tangent,
  arc_tangent,
  arc_tangent_of,  ///< atan2(a, b)
  exponential,
  exponential_less_one,
  logarithm,
  logarithm_of_more,  ///< log(1 + a)
  power,
  hyperbolic_sine,
  hyperbolic_cosine,
  hyperbolic_tangent,
  less,
  less_or_equal,
  equal,
  both,
  either,
  opposite,
  choice  ///< b where a, else c
};

}  // namespace poise

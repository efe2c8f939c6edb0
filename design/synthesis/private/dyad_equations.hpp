#pragma once

#include <cstddef>
#include <span>

#include "design/synthesis/dyads.hpp"
#include "design/synthesis/private/exact_algebra.hpp"

namespace poise::synthesis {

/// The unknowns in which the condition of a dyad is linear, all times the first one.
enum DyadUnknown : std::size_t { one, moving_x, moving_y, fixed_x, fixed_y, squares, scalar, vector, unknowns_of_dyad };

/// The middle of the positions, from which pivots are counted, and their size, in which all lengths are.
struct DyadFrame {
  Vec2 middle{};
  double size = 0.0;
};
DyadFrame frame_of(std::span<const BodyPosition> positions);

/// The condition of a dyad in each position, a row each.
BallRows dyad_equations(std::span<const BodyPosition> positions, const DyadFrame& frame);

/// The slide of a solution with its pivot (on the ground) or its pin (on the body) at infinity in the direction `far`:
/// its finite end follows from `products`, the scalar and the vector product, with `far` in the place of the infinite
/// one.
GuidingDyad slide_of(bool on_ground, const Vec2& far, const Vec2& products, const DyadFrame& frame);

}  // namespace poise::synthesis

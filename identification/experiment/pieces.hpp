#pragma once

#include <vector>

#include "identification/experiment/record.hpp"

namespace poise {

/// What a run is made of: readings of sensors and inputs, SI, from `zero` on its record's clock on.
struct Piece {
  double zero = 0.0;
  Record record;
  std::vector<Series> inputs;
};

/// Pieces of equal length, about as long as `length`, of what lasts until `end`, s; each begins at a reading. Inputs
/// have some readings beyond their ends, which a smooth curve needs.
std::vector<Piece> pieces_of(Piece whole, double length, double end);

}  // namespace poise

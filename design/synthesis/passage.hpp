#pragma once

#include <span>
#include <string>
#include <vector>

#include "design/synthesis/dyads.hpp"
#include "design/synthesis/four_bar.hpp"

namespace poise {

/// What keeps a four-bar that has all positions from passing them one after the other while its input turns.
enum class Defect {
  none,
  circuit,   ///< the positions are on two circuits: it has to be taken apart to come from one to the other
  branch,    ///< it has to pass a dead point of the input
  order,     ///< it passes them, but in another order
  undecided  ///< a position is a dead point, or the linkage a change-point linkage, to rounding
};
/// "none", "circuit", ...
std::string to_string(Defect defect);

/// A position of a four-bar by its input: FourBarPose of `closure` at the angle, rad.
struct InputPosition {
  double angle = 0.0;
  int closure = 0;
};

/// How a four-bar passes its positions in their order while its input turns one way.
struct Passage {
  Defect defect = Defect::none;
  int turn = 0;                 ///< without a defect: +1 where the input turns counter-clockwise, else -1
  double from = 0.0, to = 0.0;  ///< without a defect: angle of the input at the first and the last, not wrapped, rad
  /// Without a defect: least angle between the coupler and the output on the way, or what is missing of it to 180
  /// degrees, rad.
  double transmission = 0.0;
};

/// Decided by the angles at which the linkage ceases to close, those of the input where coupler and output are in line,
///
///   cos(angle - angle of the ground) = (input^2 + ground^2 - (coupler -+ output)^2) / (2 input ground),
///
/// and thus for all of the motion between the positions, not at samples of it.
Passage passage_of(const FourBar& linkage, std::span<const InputPosition> positions);

/// The same where the input turns from an angle to another one, which may be more than a turn away, in one closure:
/// `branch` where it meets a dead point on the way.
Passage passage_over(const FourBar& linkage, double from, double to, int closure);

/// The four-bar of two links that guide a body, the first one its input, with the origin of the body's frame as its
/// point.
FourBar four_bar_of(const GuidingDyad& input, const GuidingDyad& output);

/// Where the four-bar of two links is in a position of the body.
InputPosition input_position(const GuidingDyad& input, const GuidingDyad& output, const BodyPosition& position);

}  // namespace poise

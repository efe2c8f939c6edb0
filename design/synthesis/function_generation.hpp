#pragma once

#include <optional>
#include <vector>

#include "design/synthesis/four_bar.hpp"
#include "design/synthesis/passage.hpp"
#include "model/expression.hpp"

namespace poise {

/// A function y(x) that the output of a four-bar is to follow while its input turns, on linear scales: the input turns
/// by `input_turn` as x goes from `from` to `to`, the output by `output_turn` as y goes from y(from) to y(to), rad.
struct WantedFunction {
  Expression y;  ///< of x, the only name
  double from = 0.0, to = 0.0;
  double input_turn = 0.0, output_turn = 0.0;

  double value(double x) const;
  /// Turns of input and output at x from where they start, rad.
  Vec2 turns_at(double x) const;
};

/// n places in a range at which a polynomial of degree n - 1 follows a smooth function best: the zeros of Chebyshev's
/// polynomial.
std::vector<double> chebyshev_points(double from, double to, int n);

/// Pairs of angles that input and output of a four-bar are to have together.
struct FunctionTask {
  double ground = 1.0;        ///< from the pivot of the input, at the origin, to that of the output, along x, m
  std::vector<Vec2> turns{};  ///< of input and output from where they start, rad: three, and one more for each start
                              ///< that is not given
  std::optional<double> input_start{}, output_start{};  ///< angles from the ground line, rad
  double first = 0.0, last = 0.0;                       ///< turns of the input between which it has to move, rad
};

/// A four-bar that has all pairs. The input of `linkage` is at the angle input_start + turn, or half a turn from there
/// where `input` is negative; so is its output.
struct FunctionLinkage {
  double input_start = 0.0, output_start = 0.0;  ///< in [-pi, pi]
  double input = 0.0, output = 0.0;              ///< signed lengths, m: the link is drawn half a turn on where negative
  FourBar linkage;
  bool proved = false;
  double misfit = 0.0;  ///< greatest difference of the output's angle at the pairs, rad
  int closure = 0;      ///< 0 where the pairs have different ones
  Passage passage;      ///< of all of the range
};

struct FunctionLinkages {
  bool complete = false;   ///< these are proved to be all
  bool dependent = false;  ///< the pairs do not determine the linkage: none is given
  std::vector<FunctionLinkage> linkages;
  int complex = 0;   ///< solutions that are not real, where complete
  int infinite = 0;  ///< solutions with a link of infinite length
};

/// All four-bars through the pairs, by the equation of F. Freudenstein ("Approximate synthesis of four-bar linkages",
/// Trans. ASME 77, 1955)
///
///   K1 cos psi - K2 cos phi + K3 = cos(phi - psi),   K1 = ground / input, K2 = ground / output,
///   K3 = (input^2 - coupler^2 + output^2 + ground^2) / (2 input output).
///
/// With both starts given it is linear in K. A start that is free makes its cosine and sine and their products with K
/// unknowns of a linear system, which leaves a line of solutions; on it a polynomial of degree 2, or 3 where both are
/// free, says that the products are what they are.
FunctionLinkages linkages_for(const FunctionTask& task);

/// Output angle less the wanted one, over the range.
struct StructuralError {
  std::vector<Vec2> curve;  ///< x, error in rad
  double largest = 0.0;     ///< by size, rad
  double at = 0.0;          ///< x there
  double bound = 0.0;       ///< it is nowhere larger: proved in ball arithmetic where `proved`
  bool proved = false;
};

/// Of a linkage without a defect; empty otherwise. Where the error turns is found by Newton's method between 400
/// places.
std::optional<StructuralError> structural_error(const FunctionLinkage& linkage, const WantedFunction& wanted);

}  // namespace poise

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "statics/model/scaled_model.hpp"

namespace poise {

/// Degrees of freedom, closure and redundancy of a scene at its assembled start; `poise check` prints them.
struct Mobility {
  int bodies = 0;       ///< moving ones, bars left out
  int joints = 0;       ///< bars included
  int gruebler = 0;     ///< 3 bodies - 2 pins - 2 slides - 1 pin in slot - 3 welds - 1 bar - 1 coupling
  int coordinates = 0;  ///< of the compiled model
  int closures = 0;     ///< scalar closure equations of the compiled model, and couplings
  int rank = 0;         ///< of the closure Jacobian at the assembled start
  int freedoms = 0;     ///< coordinates - rank
  bool assembled = false;
  bool impossible = false;  ///< not assembled, and no pose can be: lengths of a loop, or stops, contradict each other
  std::string gap;          ///< which loop (or stop) remains open and by how much, if not assembled
  int gap_line = 0;         ///< its line in the scene file
  std::vector<double> x;    ///< scaled coordinates, assembled or with the smallest gap found
  std::vector<std::string> redundant;      ///< joints and couplings whose closure is a consequence of others
  std::vector<std::string> kept, dropped;  ///< of the compiled model, and why
};

/// A mechanism was not assembled from its start, and another start may do it: a failure of the search. The command line
/// then ends with exit code 1.
class AssemblyError : public InputError {
 public:
  using InputError::InputError;
};

Mobility analyse_mobility(const ScaledModel& model);

/// Degrees of freedom in a position in which the loops are closed. A mechanism can leave it by more than an
/// infinitesimal amount with fewer of them where loops repeat each other there only (a shaky structure, a change
/// point).
struct Freedoms {
  enum class By {
    rank,            ///< its closures are independent, so that every freedom is finite
    curvature,       ///< to second order none is: see freedoms_at()
    closing_beside,  ///< loops were closed again at places beside it, which is no proof
    nothing          ///< it was not looked for, in mechanisms of more than 400 closures
  };
  int infinitesimal = 0;      ///< coordinates - rank of the closure Jacobian J
  std::optional<int> finite;  ///< at most `infinitesimal`
  By by = By::nothing;

  bool is_shaky() const { return finite && *finite < infinitesimal; }
};

/// "rank", "curvature", "closing beside", "nothing".
std::string to_string(Freedoms::By by);

/// The freedoms at closed scaled coordinates x. `repeating`: the number of rows that repeat others, where it is known.
///
/// Let the rows of Z span the motions z with J z = 0, and w^T J = 0 for the self-stresses w. The rows c can stay closed
/// along a motion only if  sum w_r z^T c_r'' z = 0  for all w. Where that sum is positive for some w and all z, nothing
/// moves (R. Connelly, W. Whiteley, "Second-order rigidity and prestress stability for tensegrity frameworks", 1996):
/// a proof to rounding, with a margin of 1e-6. Elsewhere the loops are closed again at places 0.05 (rad, sizes) away
/// along random tangents, and the largest number of freedoms met there is taken.
Freedoms freedoms_at(const ScaledModel& model, const std::vector<double>& x, std::optional<int> repeating = {});

/// Throws AssemblyError if the loops are not closed, InputError if no pose can close them.
void expect_closed(const ScaledModel& model, const Mobility& mobility);

/// Throws InputError if the mechanism has no coordinate, or, by its mobility, no freedom, and names what a structure
/// can be asked for.
void expect_movable(const ScaledModel& model);
void expect_movable(const ScaledModel& model, const Mobility& mobility);

/// "file:line: mechanism: ", the beginning of messages about a whole mechanism; line 0: that of its first body.
std::string where(const ScaledModel& model, int line = 0);

/// Closes the loops from the scene's start: closed scaled coordinates. Throws as expect_closed() if that fails, naming
/// the loop and its gap.
std::vector<double> close_loops(const ScaledModel& model);

}  // namespace poise

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "statics/scaled_model.hpp"

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

/// Degrees of freedom with which it can move from its assembled start by more than an infinitesimal amount: fewer than
/// mobility.freedoms where loops repeat each other at the start only (a shaky structure, a change point). Where
/// closures are independent both are equal; else found by closing the loops again at places 0.05 (rad, sizes) away
/// along random tangents, which is no proof. Nothing of mechanisms of more than 400 closures.
std::optional<int> finite_freedoms(const ScaledModel& model, const Mobility& mobility);

/// Throws AssemblyError if the loops are not closed, InputError if no pose can close them.
void expect_closed(const ScaledModel& model, const Mobility& mobility);

/// "file:line: mechanism: ", the beginning of messages about a whole mechanism; line 0: that of its first body.
std::string where(const ScaledModel& model, int line = 0);

/// Closes the loops from the scene's start: closed scaled coordinates. Throws as expect_closed() if that fails, naming
/// the loop and its gap.
std::vector<double> close_loops(const ScaledModel& model);

}  // namespace poise

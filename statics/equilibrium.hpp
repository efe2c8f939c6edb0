#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "solvers/newton.hpp"
#include "statics/check.hpp"
#include "statics/method.hpp"
#include "statics/static_model.hpp"

namespace poise {

enum class Seek {
  nearest,  ///< any equilibrium near the start
  stable    ///< minima only
};

enum class Status {
  not_solved,
  confirmed,  ///< the independent check confirms the answer
  refuted,    ///< the solver claimed success and the check denies it
  not_found,  ///< the solver gave up, and where it stopped is no equilibrium (or not the kind sought)
  refused,    ///< the method cannot answer this scene: a load without potential in the energy method
  interrupted
};

/// "confirmed", "not found", ...
std::string to_string(Status status);

struct SolveOptions {
  Method method = Method::virtual_work;
  Seek seek = Seek::nearest;
  std::optional<double> tolerance{};  ///< of the method; its own (MethodTraits) where not given
  CheckTolerances check{};
  solvers::Safeguards safeguards{};  ///< of virtual work
  bool scaling = true;  ///< off: the search sees m and N, as the scene has them; to show what scaling is worth
  const std::atomic<bool>* interrupt = nullptr;
};

/// Where a mechanism rests, or how far the search came. Starts as not solved.
struct Equilibrium {
  Method method = Method::virtual_work;
  Seek seek = Seek::nearest;
  Status status = Status::not_solved;
  bool claimed = false;  ///< the solver's own word
  /// The search met a pose where closures lose rank and no finite joint forces hold the loads (virtual work only).
  bool met_singular = false;
  std::string why;  ///< one sentence: the solver's own word, and the objection where there is one
  int iterations = 0;
  int evaluations = 0;
  double microseconds = 0.0;  ///< of the search alone: reading, compiling, closing loops and check left out
  std::vector<double> x;      ///< scaled coordinates
  /// V, J; dead loads count from an arbitrary zero. Empty with follower loads, which have none, and before any search.
  std::optional<double> energy;
  Check check;

  bool found() const { return status == Status::confirmed; }
};

/// Finds an equilibrium from the scene's start (or from x, scaled coordinates) and checks it.
/// Throws InputError where the mechanism cannot be assembled or has no freedom left.
Equilibrium solve(const StaticModel& model, const SolveOptions& options = {});
Equilibrium solve(const StaticModel& model, const std::vector<double>& x, const SolveOptions& options = {});

/// Throws InputError where the loops of the scene cannot be closed from its start, naming the loop and its gap, or
/// where nothing is left to move. Returns closed scaled coordinates.
std::vector<double> assemble(const StaticModel& model);

}  // namespace poise

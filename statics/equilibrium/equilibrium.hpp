#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "solvers/newton.hpp"
#include "statics/equilibrium/method.hpp"
#include "statics/equilibrium/settle.hpp"
#include "statics/model/check.hpp"
#include "statics/model/static_model.hpp"
#include "statics/proof/certificate.hpp"

namespace poise {

enum class Seek {
  settle,  ///< the one that the mechanism reaches from the start when released with heavy damping
           ///< (statics/equilibrium/settle.hpp)
  any,     ///< any equilibrium near the start
  stable   ///< minima only
};

/// "settle", "any", "stable".
std::string to_string(Seek seek);

enum class Status {
  not_solved,
  confirmed,       ///< the certificate proves an equilibrium at the result
  checked,         ///< free-body statics finds it in balance, but a proof would take too long
  not_confirmed,   ///< the solver claims success and nothing could be proved
  elsewhere,       ///< Seek::settle: an equilibrium is proved, but not the one in which the mechanism settles
  not_found,       ///< the search failed, or its result is an equilibrium of the wrong kind
  not_applicable,  ///< the method does not apply: a load without potential in the energy method, too many coordinates
  interrupted
};

/// "confirmed", "not found", ...
std::string to_string(Status status);

struct SolveOptions {
  Method method = Method::virtual_work;
  Seek seek = Seek::settle;
  std::optional<double> tolerance{};  ///< of the method; its default (MethodTraits) if not given
  std::optional<int> iterations{};    ///< at most, of the method; where it is less than its own limit (MethodTraits)
  LagrangianWeights lagrangian{};
  CheckTolerances check{};
  CertificateOptions certificate{};
  bool prove = true;                 ///< off: what the search finds is checked by free bodies alone, which is no proof
  solvers::Safeguards safeguards{};  ///< of virtual work
  bool scaling = true;               ///< off: the search runs in m and N, to measure the effect of scaling
  const std::atomic<bool>* interrupt = nullptr;
};

/// An equilibrium of a mechanism, or the last point of a search that found none. Starts as not solved.
struct Equilibrium {
  Method method = Method::virtual_work;
  Seek seek = Seek::settle;
  Status status = Status::not_solved;
  bool claimed = false;  ///< the solver reports success
  /// The search reached a pose where closures lose rank and no finite joint forces balance the loads (virtual work
  /// only).
  bool met_singular = false;
  std::string why;  ///< one sentence: the solver's report, and the objection of the check if there is one
  int iterations = 0;
  int evaluations = 0;
  double microseconds = 0.0;    ///< of the search alone, without reading, compiling, closing loops, settling and check
  std::vector<double> x;        ///< scaled coordinates: Certificate::x if it is confirmed, else `reached`
  std::vector<double> reached;  ///< where the method itself ended, scaled coordinates
  /// V, J; of dead loads from an arbitrary zero. Empty with follower loads, which have no potential, and before any
  /// search.
  std::optional<double> energy;
  Certificate certificate;
  Check check;
  /// Seek::settle: where the mechanism settles. The method begins there, and only the equilibrium there is an answer;
  /// where it does not come to rest no method is asked.
  std::optional<Settling> settling;

  bool found() const { return status == Status::confirmed; }
};

/// Finds the equilibrium in which the mechanism settles from the scene's start (or from x, scaled coordinates), or,
/// with another SolveOptions::seek, one near it, and checks it.
/// Throws InputError if the mechanism cannot be assembled or has no degree of freedom left.
Equilibrium solve(const StaticModel& model, const SolveOptions& options = {});
Equilibrium solve(const StaticModel& model, const std::vector<double>& x, const SolveOptions& options = {});

/// V at the scaled coordinates x, J; of dead loads from an arbitrary zero. Empty with follower loads, which have no
/// potential.
std::optional<double> energy_at(const StaticModel& model, const std::vector<double>& x);

/// Closes the loops from the scene's start and returns the scaled coordinates. Throws InputError if they cannot be
/// closed, naming the loop and its gap, or if nothing can move.
std::vector<double> assemble(const StaticModel& model);

}  // namespace poise

#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "design/goals/check_goals.hpp"
#include "design/goals/goal_evaluation.hpp"
#include "solvers/nonlinear_program.hpp"

namespace poise {

struct GoalSearchOptions {
  std::uint64_t seed = 1;
  int starts = 100;  ///< searches, at most
  int jobs = 0;      ///< threads; 0: as many as there are cores. The same answer for any number
  solvers::ProgramMethod method = solvers::ProgramMethod::slsqp;
  int trade_off = 0;   ///< points of the trade-off of two aims; 0: none
  int samples = 1000;  ///< of tolerances, by which a robust design is verified
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string& what)> progress{};
};

/// What became of the rows of catalogues.
struct CatalogueCounts {
  double combinations = 1.0;
  long tried = 0;      ///< of these: all goals were evaluated
  long by_length = 0;  ///< excluded: a length that is needed is outside of the row's
  long by_proof = 0;   ///< excluded: a row blocks the path by its own stop, whatever the rows of other catalogues are
  long left = 0;       ///< not tried
};

/// A limit, or an end of a variable's range, that holds the one aim back.
struct ActiveLimit {
  std::string name;
  bool is_bound = false;  ///< of a variable's range
  int goal = -1;
  double gain = 0.0;      ///< of the aim for each unit by which the limit is loosened, SI
  Dimension dimension{};  ///< of the limit
};

/// What tolerances leave of the goals.
struct RobustCheck {
  bool asked = false;
  std::vector<Tolerance> tolerances;  ///< of the numbers found, of which percentages are
  std::vector<double> tightened;  ///< of each goal, SI: the most by which tolerances move its quantity, to first order
  int samples = 0, kept = 0;      ///< samples, and those that keep all limits
  bool corners_kept = true;       ///< of the worst corners of all limits, evaluated
  /// Of each tolerance the half width that keeps the limits at least reciprocal cost, SI; infinite where, to first
  /// order, it moves nothing that is limited.
  std::vector<double> widest;
};

struct TradeOff {
  std::vector<int> goals{};           ///< the two aims
  std::vector<double> first, second;  ///< their values, SI
  std::vector<DesignPoint> points;
};

struct GoalDesign {
  enum class Status {
    met,            ///< all limits, confirmed by check_goals()
    not_met,        ///< no numbers were found that meet all limits; the best are given
    not_robust,     ///< the numbers themselves meet them, not all that the tolerances allow
    not_confirmed,  ///< the search meets them, the check does not
    no_start,       ///< at no start could the mechanism be assembled, or reach the positions
    interrupted
  };
  Status status = Status::no_start;
  std::string why;
  DesignPoint point;
  std::optional<Scene> scene;
  GoalCheck before, check;         ///< of the scene as given, and of the one found
  double missed = 0.0;             ///< what limits miss, over their sizes: the root of the sum of squares
  std::vector<double> aims;        ///< their values, over their sizes
  int starts = 0, met_starts = 0;  ///< searches, and those that meet all limits
  int best_again = 0;              ///< searches that ended at the best value of the aims
  EvaluationCounts counts;
  CatalogueCounts catalogue;
  std::vector<int> conflict;          ///< goals that could not be met together, while all but one of them could
  bool conflict_is_smallest = false;  ///< no smaller set of goals was found to conflict
  std::vector<ActiveLimit> active;
  RobustCheck robust;
  TradeOff trade_off;
};

/// Searches numbers for which all limits are kept and the aims are as good as possible: from the scene's own and from
/// random starts by least squares on what limits miss, with exact derivatives (solvers/bounded_least_squares.hpp), and
/// from there by NLopt on the aims (solvers/nonlinear_program.hpp). Rows of catalogues are tried one after the other.
/// What is found is checked by check_goals(); places between positions at which a limit is missed become positions, and
/// the search goes on. A local search proves nothing of what it did not find.
GoalDesign design_for_goals(const GoalProblem& problem, const GoalSearchOptions& options = {});

}  // namespace poise

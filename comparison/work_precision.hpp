#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "statics/equilibrium/equilibrium.hpp"

namespace poise::comparison {

struct WorkPrecisionOptions {
  std::vector<Method> methods{};     ///< in the order shown; all when empty
  std::vector<double> tolerances{};  ///< SolveOptions::tolerance of the runs
  int repeats = 7;                   ///< runs per method and tolerance, > 0; more if they take microseconds
  Seek seek = Seek::any;
  LagrangianWeights lagrangian{};
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string& doing)> progress{};  ///< called before every row; may be empty
};

/// An equilibrium that errors are measured from, known in 50 digits.
struct ReferenceEquilibrium {
  std::vector<double> x;  ///< scaled coordinates, rounded from 50 digits
  int digits = 0;         ///< to which the refinement converged
  Stability stability = Stability::unknown;
  /// One of a continuum of equilibria (only one is kept), so that the distance to this one is no error.
  bool neutral = false;
  double rounding_effect = 0.0;  ///< of the scene's numbers, same units as errors (Certificate::rounding_effect)
  std::vector<Method> found_by;  ///< methods whose default runs confirmed here; may be empty
};

/// How a run ended, independent of its own tolerance.
enum class Ending {
  converged,     ///< the solver claims success within 0.5 rad (or mechanism sizes) of a known equilibrium
  elsewhere,     ///< the solver claims success, with no known equilibrium that near
  not_converged  ///< the solver does not claim success
};

/// One method at one tolerance.
struct WorkPrecisionRow {
  Method method{};
  double tolerance = 0.0;
  Ending ending = Ending::not_converged;
  bool claimed = false;    ///< the solver reports success
  bool confirmed = false;  ///< by statics/model/check with its default bounds, independent of the tolerance of the run
  int equilibrium = -1;    ///< index of the nearest in WorkPrecision::equilibria, -1 if none is within 0.5
  std::optional<double> error{};  ///< from that equilibrium; empty if there is none
  double microseconds = 0.0;
  int repeats = 0;  ///< runs the median is taken over
  int iterations = 0;
  int evaluations = 0;
  std::vector<double> x;  ///< scaled coordinates of the result
  std::string why;        ///< the solver's report, and the objection of the check
};

/// A method that does not apply to the scene.
struct NotApplicable {
  Method method{};
  std::string why;
};

struct WorkPrecision {
  std::vector<ReferenceEquilibrium> equilibria;
  std::vector<NotApplicable> not_applicable;
  std::vector<WorkPrecisionRow> rows;  ///< method by method, in the order of the tolerances
  bool interrupted = false;            ///< unfinished rows are left out
};

/// Work-precision data of each method: time, achieved error and effort of runs from the scene's assembled start.
///
/// equilibria  The known ones; no run is measured against its own method. The default runs of the methods and of the
/// two
///             independent ones (virtual work, energy) that the check confirms are refined by Newton in 50 digits
///             (statics/model/reference.hpp), and each distinct one is kept (differences above 1e-9). A run at some
///             tolerance that the check confirms far from all of them adds its own refinement.
/// error       Largest difference of a scaled coordinate (rad, or length over mechanism size) from the nearest known
///             equilibrium, without whole turns if nothing counts them. For a neutral equilibrium, one of a continuum,
///             the 50-digit solution next to the run itself is taken, because no other of the continuum is better.
/// time        Median of Equilibrium::microseconds, the search alone. A row makes `repeats` runs, if they are short as
///             many more as fit into 1 ms times `repeats`, and fewer only if they take more than 3 s together.
///
/// The tolerance has a different meaning for every method (a step, a gradient, a residual), hence error on the other
/// axis. Virtual work bounds its last Newton step d and still applies it, which leaves an error of about d^2: near the
/// square of its tolerance. Throws InputError as solve() does.
WorkPrecision work_precision(const StaticModel& model, const WorkPrecisionOptions& options);

}  // namespace poise::comparison

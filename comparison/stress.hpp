#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "comparison/catalogue.hpp"

namespace poise::comparison {

struct StressOptions {
  std::vector<Method> methods{};  ///< in the order shown; all when empty
  int starts = 0;                 ///< per case; the case's own number when 0
  /// Work limit of a method for one case, in evaluations of a small mechanism (work_of_an_evaluation(); closing,
  /// proof and check of a start are `work_of_a_start` of them): no further starts after it, and a single one ends after
  /// `patience` times the limit. Virtual work with all its safeguards has no limit.
  double work = 2e5;
  std::optional<double> seconds{};  ///< no further starts after it; where a person asks for it, in place of `work`
  static constexpr double patience = 10.0;
  static constexpr double work_of_a_start = 100.0;
  /// Threads, which take the cases; 0: all cores. More than one share the machine, so that times are longer; all else
  /// does not depend on it.
  int jobs = 1;
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string& doing)> progress{};  ///< called before every cell, by one thread at a time
};

/// One method on one case. Every start counts as converged, false claim or denied by the check, or as none of these if
/// the method failed or found an equilibrium of the wrong kind.
struct Cell {
  Method method{};
  bool applies = true;  ///< the method applies to the case; if not, `why` gives the reason
  int starts = 0;       ///< tried
  /// Converged: proved, of the kind sought, and known (in open lists: or confirmed by 50 digits). If
  /// the joints lock: reported as locked. If there is no equilibrium: neither claimed nor confirmed.
  int converged = 0;
  int false_claims = 0;     ///< confirmed, but no equilibrium or of another stability; must be 0
  int denied_by_check = 0;  ///< claimed by the solver and not proved
  // Empty if no start converged, or no equilibrium is known:
  std::optional<double> iterations{};    ///< median over converged starts
  std::optional<double> microseconds{};  ///< median over converged starts
  /// Largest distance of converged starts from the known equilibrium, rad or mechanism sizes.
  std::optional<double> error{};
  /// What the proved radius and the rounding of the scene's numbers allow there (CaseCheck), same units.
  std::optional<double> allowed{};
  std::string why;  ///< of the first false claim, otherwise of the first that did not converge
};

struct CaseResult {
  HardCase hard;
  std::vector<Cell> cells;  ///< those of methods not reached before an interrupt are missing
};

/// Runs methods over cases from the same seeded starts. Start k of a case is the same for all methods, on every
/// machine: the scene's own start plus reach times uniform numbers in [-1, 1), seeded by the name of the case. Throws
/// InputError if a case does not fit its scene.
std::vector<CaseResult> stress(const std::vector<HardCase>& cases, const StressOptions& options);

/// A variant of virtual work.
struct Variant {
  std::string name;  ///< the safeguard that is off: "line search"
  solvers::Safeguards safeguards{};
  bool scaling = true;  ///< of coordinates and equations
};

/// Everything on ("all on"), and then each safeguard off in turn.
const std::vector<Variant>& safeguard_variants();

/// Runs virtual work in all safeguard_variants(): one cell for each. options.methods is ignored.
std::vector<CaseResult> stress_safeguards(const std::vector<HardCase>& cases, const StressOptions& options);

/// Share of starts that have to converge for a case to count as solved by a method.
inline constexpr double enough = 0.999;

/// Whether at least that share converged.
bool solved(const Cell& cell);

/// Median of the values, for an even number the mean of the middle two; empty if there are none.
std::optional<double> median(std::vector<double> values);

}  // namespace poise::comparison

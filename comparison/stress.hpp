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
  /// A method stops trying further starts of a case after so long, and gives up the one under way after `patience`
  /// times as long; virtual work with all its safeguards never does.
  double seconds = 1.0;
  static constexpr double patience = 10.0;
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string& doing)> progress{};  ///< told before every cell; may be empty
};

/// One method on one case. Every start ends in one way: arrived, inexact, wrong, denied, or none of these, when the
/// method gave up, or was not confirmed to be of the kind sought.
struct Cell {
  Method method{};
  bool refused = false;  ///< the method cannot take the case; `why` says so
  int starts = 0;        ///< tried
  /// Confirmed by the check, of the kind sought, and known (in open lists: or met by 50 digits). Where the joints lock:
  /// said to lock. Where there is no equilibrium: neither claimed nor confirmed.
  int arrived = 0;
  /// Confirmed beside a known equilibrium of that stability, closer than what the check lets pass, yet farther than
  /// rounding explains.
  int inexact = 0;
  int wrong = 0;   ///< confirmed by the check and yet no equilibrium, or of another stability: must be 0
  int denied = 0;  ///< claimed by the solver and denied by the check
  // Empty where there is no arrival, or no equilibrium to be known:
  std::optional<double> iterations{};    ///< median over arrivals
  std::optional<double> microseconds{};  ///< median over arrivals
  /// Largest over arrivals from the known equilibrium, rad or mechanism sizes.
  std::optional<double> error{};
  /// What the condition of that equilibrium lets rounding do, same units (Check::accuracy).
  std::optional<double> allowed{};
  std::string why;  ///< of the first start that was wrong, or else of the first that did not arrive
};

struct CaseResult {
  HardCase hard;
  std::vector<Cell> cells;  ///< those of methods not reached before an interrupt are missing
};

/// Runs methods over cases from the same seeded starts. Start k of a case is the same for all methods, on every
/// machine: the scene's own start plus reach times uniform numbers in [-1, 1), seeded by the name of the case. Throws
/// InputError where a case does not fit its scene.
std::vector<CaseResult> stress(const std::vector<HardCase>& cases, const StressOptions& options);

/// Virtual work in one form.
struct Variant {
  std::string name;  ///< what is off: "line search"
  solvers::Safeguards safeguards{};
  bool scaling = true;  ///< of coordinates and equations
};

/// Everything on ("all on"), and then each safeguard off in turn.
const std::vector<Variant>& safeguard_variants();

/// Runs virtual work in all safeguard_variants(): one cell for each. options.methods does not count.
std::vector<CaseResult> stress_safeguards(const std::vector<HardCase>& cases, const StressOptions& options);

/// The part of starts in which a method has to arrive to have mastered a case.
inline constexpr double enough = 0.999;

/// Whether it arrived in at least that part.
bool mastered(const Cell& cell);

/// The middle of the values, or the mean of the two in the middle; empty where there are none.
std::optional<double> median(std::vector<double> values);

}  // namespace poise::comparison

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "comparison/catalogue.hpp"

namespace poise::comparison {

/// Comparison of one result with the known equilibria of a case.
struct Verdict {
  enum class Kind {
    converged,
    false_claim,      ///< confirmed, but contradicted by the known equilibria
    denied_by_check,  ///< claimed by the solver, not proved
    failed            ///< nothing claimed
  };
  Kind kind = Kind::failed;
  /// Distance from the nearest known equilibrium, rad or mechanism sizes; empty if there is none.
  std::optional<double> error{};
  std::optional<double> allowed{};  ///< what radius and rounding allow there
  std::string why{};                ///< reason, if it did not converge to a known equilibrium
};

/// Compares results with the known equilibria of a case.
///
/// list         The nearest known equilibrium must be near enough and of the stability that is proved. Near enough is
///              max(1e-9, radius + 4 rounding_effect) of the certificate, at most 1e-3. Beyond that a complete list
///              contradicts the result.
/// open list    A result near no known equilibrium is refined in 50 digits, which must find an equilibrium as near.
/// everywhere   The result must be neutral.
/// locked       The method must report that the joints lock, also if it goes on to an equilibrium elsewhere, which 50
///              digits must confirm.
/// none         Nothing may be confirmed; a method that does not claim an equilibrium either counts as converged.
class CaseCheck {
 public:
  /// `hard` and `model` must outlive this. Throws InputError if a known equilibrium names an unknown body or travel.
  CaseCheck(const HardCase& hard, const StaticModel& model);

  Verdict verdict_on(const Equilibrium& equilibrium) const;

 private:
  struct Value {
    int index;  ///< of the body, or the coordinate
    double value;
  };
  struct Target {
    std::vector<Value> angles, travels;
    Stability stability;
  };
  Target target_of(const KnownEquilibrium& known) const;
  double distance(const std::vector<double>& x, const std::vector<BodyPose<double>>& poses, const Target& target) const;
  Verdict verdict_on_confirmed(const Equilibrium& equilibrium) const;
  Verdict verdict_by_list(const Equilibrium& equilibrium) const;
  Verdict verdict_by_reference(const Equilibrium& equilibrium) const;
  static Verdict verdict_by_distance(double apart, const Equilibrium& equilibrium);

  const HardCase& hard_;
  const StaticModel& model_;
  std::vector<Target> known_;
};

}  // namespace poise::comparison
